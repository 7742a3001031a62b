//! Where water goes over a surface: depressions filled, every cell's receiver, and what gathers along the way.
//!
//! Numerics only: this room knows heights, not worlds. Heights are `f64`, since a fill of `f32` stalls on long flats.

mod drainage;
mod flood;

pub use drainage::Drainage;

use crate::grid::{Edges, Field, Grid};

/// The eight steps to a neighbour, in the order that decides ties: north-west first, row by row.
pub const STEPS: [(isize, isize); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

/// The cells where water leaves: everything below the sea, and the rim of an open map. A map that has none of either
/// drains to its lowest cell.
pub fn outlets(height: &Field<f32>, sea_level_m: f64) -> Vec<bool> {
    let grid = height.grid;
    let (w, h) = (grid.width, grid.height);
    let rim = |i: usize| {
        let (x, y) = grid.cell_of(i);
        grid.edges == Edges::Open && (x == 0 || y == 0 || x + 1 == w || y + 1 == h)
    };
    let mut outlet: Vec<bool> =
        height.data.iter().enumerate().map(|(i, &z)| (z as f64) < sea_level_m || rim(i)).collect();
    if !outlet.contains(&true) {
        let lowest = (0..height.data.len()).min_by(|&a, &b| height.data[a].total_cmp(&height.data[b]));
        if let Some(i) = lowest {
            outlet[i] = true;
        }
    }
    outlet
}

/// The neighbours of a cell that lie on the map, with the distance in cells.
pub fn neighbours(grid: Grid, i: usize) -> impl Iterator<Item = (usize, f64)> {
    let (x, y) = grid.cell_of(i);
    STEPS.into_iter().filter_map(move |(dx, dy)| {
        let next = match grid.edges {
            Edges::Wrap => (grid.column(x, dx), grid.row(y, dy)),
            _ => (
                x.checked_add_signed(dx).filter(|&x| x < grid.width)?,
                y.checked_add_signed(dy).filter(|&y| y < grid.height)?,
            ),
        };
        let length = if dx != 0 && dy != 0 { std::f64::consts::SQRT_2 } else { 1.0 };
        Some((grid.index(next.0, next.1), length)).filter(|&(j, _)| j != i)
    })
}
