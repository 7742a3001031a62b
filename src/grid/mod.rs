//! The ground everything stands on: a raster of square cells in metres, fields over it, and loops that give the same
//! bits for any number of threads.
//!
//! Coordinates are metres from the map's north-west corner, x to the east and y to the **south**, so that row 0 is the
//! north and the centre of cell `(x, y)` lies at `((x + ½)·cell_m, (y + ½)·cell_m)`. Samples are cell centres.
//!
//! This room knows nothing of what a field means.

mod blur;
mod contour;
mod distance;
mod field;
mod mesh;
mod parallel;
mod resample;
mod sample;
mod transposed;

pub use blur::blur;
pub use contour::{Contour, contour_lines, contour_rings};
pub use distance::{Nearest, nearest_feature, nearest_from, nearest_within};
pub use field::Field;
pub use mesh::{Foot, Mesh};
pub use parallel::{for_each_row, map_cells, max_rows, sum_f64, sum_rows};
pub(crate) use resample::keys;
pub use resample::{Places, Points, resample, resample_at};
pub use sample::{Corners, Stencil, cubic, linear};
pub use transposed::transposed;

use serde::{Deserialize, Serialize};

/// What lies beyond the rim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edges {
    /// Matter leaves over the rim and is counted.
    #[default]
    Open,
    /// Nothing passes.
    Closed,
    /// East meets west and north meets south: a seamless world.
    Wrap,
}

/// A raster of `width` x `height` square cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Cells from west to east.
    pub width: usize,
    /// Cells from north to south.
    pub height: usize,
    /// Side of a cell, m.
    pub cell_m: f64,
    /// What lies beyond the rim.
    pub edges: Edges,
}

impl Grid {
    /// A grid of `width` x `height` cells whose west-east extent is `extent_m`.
    pub fn new(width: usize, height: usize, extent_m: f64, edges: Edges) -> Self {
        Self { width, height, cell_m: extent_m / width as f64, edges }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.width * self.height
    }

    /// West-east and north-south extent, m.
    pub fn extent_m(&self) -> [f64; 2] {
        [self.width as f64 * self.cell_m, self.height as f64 * self.cell_m]
    }

    /// Area of one cell, m².
    pub fn cell_area_m2(&self) -> f64 {
        self.cell_m * self.cell_m
    }

    /// Centre of cell `(x, y)`, m.
    pub fn center_m(&self, x: usize, y: usize) -> [f64; 2] {
        [(x as f64 + 0.5) * self.cell_m, (y as f64 + 0.5) * self.cell_m]
    }

    /// Row-major index of cell `(x, y)`.
    pub fn index(&self, x: usize, y: usize) -> usize {
        y * self.width + x
    }

    /// The cell `(x, y)` of a row-major index.
    pub fn cell_of(&self, index: usize) -> (usize, usize) {
        (index % self.width, index / self.width)
    }

    /// The column next to `x`, `step` cells on: wrapped, or stopped at the rim.
    pub fn column(&self, x: usize, step: isize) -> usize {
        neighbour(x, step, self.width, self.edges)
    }

    /// The row next to `y`, `step` cells on: wrapped, or stopped at the rim.
    pub fn row(&self, y: usize, step: isize) -> usize {
        neighbour(y, step, self.height, self.edges)
    }
}

fn neighbour(at: usize, step: isize, size: usize, edges: Edges) -> usize {
    let next = at as isize + step;
    match edges {
        Edges::Wrap => next.rem_euclid(size as isize) as usize,
        Edges::Open | Edges::Closed => next.clamp(0, size as isize - 1) as usize,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_and_extent_agree() {
        let grid = Grid::new(4, 2, 400.0, Edges::Open);
        assert_eq!(grid.cell_m, 100.0);
        assert_eq!(grid.extent_m(), [400.0, 200.0]);
        assert_eq!(grid.center_m(3, 0), [350.0, 50.0]);
        assert_eq!(grid.cell_of(grid.index(3, 1)), (3, 1));
    }

    #[test]
    fn neighbours_stop_or_wrap() {
        let open = Grid::new(4, 4, 4.0, Edges::Open);
        let wrap = Grid { edges: Edges::Wrap, ..open };
        assert_eq!((open.column(0, -1), open.row(3, 2)), (0, 3));
        assert_eq!((wrap.column(0, -1), wrap.row(3, 2)), (3, 1));
    }
}
