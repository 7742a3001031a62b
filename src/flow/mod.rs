//! Where water goes over a surface: depressions filled, every cell's receiver, and what gathers along the way.
//!
//! Numerics only: this room knows heights, not worlds. [`Drainage`] is one surface's answer, plain to read; [`Router`] is the
//! same for solvers that ask at every step. Heights are `f64`, since a fill of `f32` stalls on long flats.

mod compass;
mod drainage;
mod fan;
#[cfg(test)]
mod flood;
mod lakes;
mod network;
mod router;
mod spill;

pub use compass::{Compass, LENGTHS, STEPS, opposite};
pub use drainage::Drainage;
pub use fan::FREEMAN;
pub use lakes::Lake;
pub use network::NONE;
pub use router::{ROOT, Router};

use crate::grid::{Edges, Field, Grid};

/// The cells where water leaves: the sea, which is all that does not lie above its level, and the rim of an open map. A map
/// that has none of either drains to its lowest cell.
pub fn outlets(height: &Field<f32>, sea_level_m: f64) -> Vec<bool> {
    let grid = height.grid;
    let (w, h) = (grid.width, grid.height);
    let rim = |i: usize| {
        let (x, y) = grid.cell_of(i);
        grid.edges == Edges::Open && (x == 0 || y == 0 || x + 1 == w || y + 1 == h)
    };
    let mut outlet: Vec<bool> =
        height.data.iter().enumerate().map(|(i, &z)| (z as f64) <= sea_level_m || rim(i)).collect();
    if !outlet.contains(&true) {
        let lowest = (0..height.data.len()).min_by(|&a, &b| height.data[a].total_cmp(&height.data[b]));
        if let Some(i) = lowest {
            outlet[i] = true;
        }
    }
    outlet
}

/// The same without `gates`: cells of the rim where rivers come in. Where they are the only ways out they stay.
pub fn outlets_but(height: &Field<f32>, sea_level_m: f64, gates: &[usize]) -> Vec<bool> {
    let all = outlets(height, sea_level_m);
    let mut some = all.clone();
    for &i in gates {
        some[i] &= (height.data[i] as f64) <= sea_level_m;
    }
    if some.contains(&true) { some } else { all }
}

/// The neighbours of a cell that lie on the map, with the distance in cells.
pub fn neighbours(grid: Grid, i: usize) -> impl Iterator<Item = (usize, f64)> {
    Compass::new(grid).around(i).map(|(way, j)| (j, LENGTHS[way as usize]))
}
