//! The part of the tectonic raster that a map reads. The square reaches well beyond the map, and nobody sees the surface
//! there.

use glam::DVec2;

use crate::grid::{Edges, Grid};

use super::{domain::Domain, warp::Warp};

/// A box of tectonic cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its cells; the origin is its own corner.
    pub grid: Grid,
    /// Its north-west corner, map metres.
    pub corner_m: DVec2,
    /// The whole raster.
    pub square: Grid,
    first: [usize; 2],
}

impl Window {
    /// Around all that the map reads, and `room` cells more for what is read from beside a cell.
    pub fn around(domain: &Domain, warp: &Warp, room: f64) -> Self {
        let [low, high] = warp.reads_m().map(|at_m| domain.to_cells(at_m));
        let cells = domain.cells;
        let span = |low: f64, high: f64| {
            let first = ((low - room).max(0.0) as usize).min(cells - 1);
            [first, ((high + room).max(0.0).ceil() as usize).clamp(first + 1, cells)]
        };
        let ([left, right], [top, bottom]) = (span(low.x, high.x), span(low.y, high.y));
        let cell_m = domain.cell_m();
        Self {
            grid: Grid { width: right - left, height: bottom - top, cell_m, edges: Edges::Closed },
            corner_m: domain.corner_m + DVec2::new(left as f64, top as f64) * cell_m,
            square: domain.grid(),
            first: [left, top],
        }
    }

    /// The tectonic cell of one of its cells.
    pub fn cell(&self, x: usize, y: usize) -> usize {
        self.square.index(self.first[0] + x, self.first[1] + y)
    }
}
