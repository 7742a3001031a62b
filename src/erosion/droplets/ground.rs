//! A window's own copy of the ground. Rows are copied when a droplet first comes near, so that a window with few
//! droplets costs little.

use std::ops::Range;

use super::{
    super::bed::Bed,
    window::{Piece, runs},
};

/// Rows that are copied beyond those that a droplet needs at once.
const AHEAD: usize = 16;

/// The ground in a window, with columns on either side of it in which nothing changes.
#[derive(Default)]
pub struct Ground {
    /// Heights at the start, m.
    pub start: Vec<f32>,
    /// Changes, m.
    pub change: Vec<f32>,
    /// Shares of the rates, 0 in the frame: of every row, or one row for all.
    pub rate: Vec<f32>,
    /// Droplets that have passed cells in this phase, by the share of their water that was left; without the frame.
    pub passed: Vec<f32>,
    /// Cells in a row without the frame.
    pub columns: usize,
    /// Cells in a row with the frame.
    pub stride: usize,
    /// Rows.
    pub rows: usize,
    /// Cells from a row of `rate` to the next: 0 where one is for all.
    pub rate_stride: usize,
    /// Rows that have been copied.
    pub loaded: Range<usize>,
    /// Columns on either side.
    pub frame: usize,
}

impl Ground {
    /// Index of a cell of the window.
    #[inline(always)]
    pub fn framed(&self, x: usize, y: usize) -> usize {
        y * self.stride + x + self.frame
    }

    /// Heights of a cell and of the next in its row, m.
    #[inline(always)]
    pub fn heights(&self, i: usize) -> [f32; 2] {
        let (start, change) = (&self.start[i..][..2], &self.change[i..][..2]);
        [start[0] + change[0], start[1] + change[1]]
    }

    /// Makes room for a window. What was there before stays: in the rows until they are copied, and in the frame, where
    /// nothing weighs.
    pub fn open(&mut self, bed: &Bed, [columns, rows]: [Piece; 2], frame: usize) {
        (self.stride, self.rows, self.frame) = (columns.size + 2 * frame, rows.size, frame);
        self.columns = columns.size;
        self.passed.resize(columns.size * rows.size, 0.0);
        let cells = self.stride * rows.size;
        self.start.resize(cells, 0.0);
        self.change.resize(cells, 0.0);
        self.loaded = 0..0;
        if bed.rate.is_empty() {
            self.rate_stride = 0;
            self.rate.clear();
            self.rate.resize(self.stride, 0.0);
            self.rate[frame..][..columns.size].fill(1.0);
        } else {
            self.rate_stride = self.stride;
            self.rate.resize(cells, 0.0);
        }
    }

    /// Notes that water passes a cell.
    #[inline(always)]
    pub fn pass(&mut self, [x, y]: [usize; 2], water: f32) {
        if let Some(passed) = self.passed.get_mut(y * self.columns + x) {
            *passed += water;
        }
    }

    /// Copies what has not been copied of the rows within `margin` and more of row `y`.
    pub fn load(&mut self, bed: &Bed, pieces: [Piece; 2], y: usize, margin: usize) {
        let size = pieces[1].size;
        let near = y.saturating_sub(margin + AHEAD)..(y + margin + 2 + AHEAD).min(size);
        if self.loaded.is_empty() {
            self.loaded = near.start..near.start;
        }
        let old = self.loaded.clone();
        (near.start..old.start).chain(old.end..near.end).for_each(|y| self.load_row(bed, pieces, y));
        self.loaded = near.start.min(old.start)..near.end.max(old.end);
    }

    /// Copies one row.
    fn load_row(&mut self, bed: &Bed, [columns, rows]: [Piece; 2], y: usize) {
        let row = (rows.from + y) % bed.grid.height * bed.grid.width;
        let to = self.framed(0, y);
        self.passed[y * self.columns..][..self.columns].fill(0.0);
        for (at, from, size) in runs(columns, bed.grid.width) {
            self.start[to + at..][..size].copy_from_slice(&bed.start[row + from..][..size]);
            self.change[to + at..][..size].copy_from_slice(&bed.change[row + from..][..size]);
            if self.rate_stride > 0 {
                self.rate[to + at..][..size].copy_from_slice(&bed.rate[row + from..][..size]);
            }
        }
        if self.rate_stride > 0 {
            self.rate[to - self.frame..to].fill(0.0);
            self.rate[to + columns.size..][..self.frame].fill(0.0);
        }
    }
}
