//! Squares of land to take spectra of: as large as fit, sides a power of two.

use crate::grid::Field;

/// Least side, cells: a spectrum of less has no decade.
pub const LEAST_SIDE: usize = 64;
/// Land that a square has at least, as a share.
const LAND: f64 = 0.95;
const MOST: usize = 16;

/// A square of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Square {
    /// Its western column.
    pub x: usize,
    /// Its northern row.
    pub y: usize,
    /// Cells a side.
    pub side: usize,
}

/// Up to 16 squares of one size that are nearly all land and hardly overlap; none where there is none of 64 cells.
pub fn squares(height: &Field<f32>, sea_level_m: f64) -> Vec<Square> {
    let (w, h) = (height.grid.width, height.grid.height);
    let sums = land_sums(height, sea_level_m);
    let land = |s: Square| {
        let at = |x: usize, y: usize| sums[y * (w + 1) + x] as i64;
        at(s.x + s.side, s.y + s.side) - at(s.x, s.y + s.side) - at(s.x + s.side, s.y) + at(s.x, s.y)
    };
    let mut side = LEAST_SIDE;
    while side * 2 <= w.min(h) {
        side *= 2;
    }
    while side >= LEAST_SIDE && side <= w.min(h) {
        let mut found: Vec<Square> = Vec::new();
        for &y in &starts(h, side) {
            for &x in &starts(w, side) {
                let square = Square { x, y, side };
                let apart = |o: &Square| o.x.abs_diff(x).max(o.y.abs_diff(y)) >= side * 3 / 4;
                if land(square) as f64 >= LAND * (side * side) as f64 && found.iter().all(apart) && found.len() < MOST {
                    found.push(square);
                }
            }
        }
        if !found.is_empty() {
            return found;
        }
        side /= 2;
    }
    Vec::new()
}

/// Where squares begin along an edge: every eighth of a side, and one at the end.
fn starts(length: usize, side: usize) -> Vec<usize> {
    let last = length - side;
    let mut starts: Vec<usize> = (0..last).step_by((side / 8).max(1)).collect();
    starts.push(last);
    starts
}

/// Land cells north-west of each corner.
fn land_sums(height: &Field<f32>, sea_level_m: f64) -> Vec<u32> {
    let (w, h) = (height.grid.width, height.grid.height);
    let mut sums = vec![0u32; (w + 1) * (h + 1)];
    for y in 0..h {
        let mut row = 0;
        for x in 0..w {
            row += u32::from(height.at(x, y) as f64 > sea_level_m);
            sums[(y + 1) * (w + 1) + x + 1] = sums[y * (w + 1) + x + 1] + row;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn the_largest_squares_on_land_are_found() {
        let grid = Grid::new(300, 200, 300.0, Edges::Open);
        let all = Field::filled(grid, 5.0);
        let sides = |found: Vec<Square>| found.iter().map(|s| s.side).collect::<Vec<_>>();
        assert_eq!(sides(squares(&all, 0.0)), [128, 128]);
        let east = Field::from_fn(grid, |x, _| x as f32 - 199.5);
        let found = squares(&east, 0.0);
        assert!(found.iter().all(|s| s.side == 64 && s.x >= 196) && found.len() == 3, "{found:?}");
        assert_eq!(squares(&all, 9.0), []);
        assert_eq!(squares(&Field::filled(Grid::new(63, 500, 63.0, Edges::Open), 5.0), 0.0), []);
    }
}
