//! Where the land's base level is: the sea, the rim of the map, and failing both the lowest cell.
//!
//! A free rim is drained as if the land went on beyond it with the slope it has there: where that is the steepest way down,
//! the water leaves at a mouth. A mouth is cut with that slope, but never with more than would reach the sea within the
//! length of the catchment, so that it sinks towards the sea and not below. Where the rim is held it sinks by no more than
//! uplift raised it.

use rayon::prelude::*;

use crate::{
    flow::{Compass, LENGTHS},
    grid::{Edges, Grid},
};

use super::Rim;

/// What a base level other than the sea does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Base {
    /// Keeps its height; what comes leaves the map.
    Fixed,
    /// Leaves the map down this slope.
    Mouth(f64),
}

/// The outlets of a surface.
#[derive(Default)]
pub(super) struct BaseLevel {
    /// Whether water leaves at a cell.
    pub(super) outlet: Vec<bool>,
    /// The outlets on the rim, or the lowest cell where there is no other; by their index.
    pub(super) edge: Vec<(usize, Base)>,
    /// Whether there is any sea.
    pub(super) sea: bool,
}

impl BaseLevel {
    /// Finds the outlets of a surface. On the rim's `gates`, in ascending order, rivers come in and no water leaves.
    pub(super) fn find(&mut self, grid: Grid, height_m: &[f64], sea_level_m: f64, (rim, gates): (Rim, &[usize])) {
        self.outlet.resize(height_m.len(), false);
        self.outlet.par_iter_mut().zip(height_m).for_each(|(outlet, &z)| *outlet = z < sea_level_m);
        self.sea = self.outlet.par_chunks(grid.width.max(1)).any(|row| row.contains(&true));
        self.edge.clear();
        if grid.edges == Edges::Open {
            let compass = Compass::new(grid);
            for i in rim_cells(grid).filter(|i| gates.binary_search(i).is_err()) {
                match rim {
                    Rim::Fixed => self.edge.push((i, Base::Fixed)),
                    Rim::Free | Rim::Held if self.outlet[i] => {}
                    Rim::Free | Rim::Held => {
                        self.edge.extend(mouth(&compass, height_m, i).map(|slope| (i, Base::Mouth(slope))))
                    }
                }
            }
        }
        if self.edge.is_empty() && !self.sea {
            let lowest = (0..height_m.len()).min_by(|&a, &b| height_m[a].total_cmp(&height_m[b]));
            self.edge.extend(lowest.map(|i| (i, Base::Fixed)));
        }
        for &(i, _) in &self.edge {
            self.outlet[i] = true;
        }
    }
}

/// The cells along the rim, row by row.
fn rim_cells(grid: Grid) -> impl Iterator<Item = usize> {
    let (w, h) = (grid.width, grid.height);
    (0..h).flat_map(move |y| {
        let step = if y == 0 || y + 1 == h { 1 } else { w - 1 };
        (0..w).step_by(step.max(1)).map(move |x| grid.index(x, y))
    })
}

/// The slope with which water leaves at a rim cell, if that is its steepest way down.
fn mouth(compass: &Compass, height_m: &[f64], i: usize) -> Option<f64> {
    let grid = compass.grid;
    let (x, y) = grid.cell_of(i);
    let inward = |at: usize, size: usize| match at {
        0 => 1.min(size - 1),
        at if at + 1 == size => at - 1,
        at => at,
    };
    let (ix, iy) = (inward(x, grid.width), inward(y, grid.height));
    let length = if ix != x && iy != y { std::f64::consts::SQRT_2 } else { 1.0 };
    let slope = (height_m[grid.index(ix, iy)] - height_m[i]) / (length * grid.cell_m);
    let steeper = |(way, j): (u8, usize)| (height_m[i] - height_m[j]) / (LENGTHS[way as usize] * grid.cell_m) > slope;
    (slope > 0.0 && !compass.around(i).any(steeper)).then_some(slope)
}
