//! A raster with a rim of one cell around it, so that no loop asks where it is.

use crate::grid::{Edges, Grid, for_each_row};

/// Height of what lies beyond a rim that nothing passes: no number, so that no slope towards it exceeds anything.
pub(super) const BEYOND: f32 = f32::NAN;

/// Values with a rim around them.
#[derive(Clone, Debug)]
pub(super) struct Raster {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) data: Vec<f32>,
}

impl Raster {
    /// The same value in all cells and on the rim.
    pub(super) fn filled(grid: &Grid, value: f32) -> Self {
        let (width, height) = (grid.width, grid.height);
        Self { width, height, data: vec![value; (width + 2) * (height + 2)] }
    }

    /// Cells from one row to the next.
    pub(super) fn stride(&self) -> usize {
        self.width + 2
    }

    /// A row with the rim at its ends; row 0 is the northern rim.
    pub(super) fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.stride()..][..self.stride()]
    }

    /// Writes all cells: `f(y, row)` is given a row without its rim.
    pub(super) fn write(&mut self, f: impl Fn(usize, &mut [f32]) + Sync + Send) {
        let (stride, width, height) = (self.stride(), self.width, self.height);
        for_each_row(&mut self.data, stride, |y, row| {
            if (1..=height).contains(&y) {
                f(y - 1, &mut row[1..=width]);
            }
        });
    }

    /// Takes the rim from the other side where the map is seamless, and leaves it else.
    pub(super) fn join(&mut self, edges: Edges) {
        if edges != Edges::Wrap {
            return;
        }
        let (stride, w, h) = (self.stride(), self.width, self.height);
        for y in 1..=h {
            self.data[y * stride] = self.data[y * stride + w];
            self.data[y * stride + w + 1] = self.data[y * stride + 1];
        }
        self.data.copy_within(h * stride..(h + 1) * stride, 0);
        self.data.copy_within(stride..2 * stride, (h + 1) * stride);
    }
}
