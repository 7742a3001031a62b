//! Sliding on rasters of larger cells first.
//!
//! A level has cells twice as large as the one below. Its ground is the mean of theirs; what it gains is spread back
//! over them by bilinear weights, sixteenths that make up a whole. A level moves quanta sixteen times as large, so that
//! every sixteenth is a whole quantum below, and nothing is lost between levels.

use super::{
    cells,
    flux::{Slope, Terms},
    params::ThermalMethod,
    raster::Raster,
};
use crate::grid::{Edges, Field, Grid, map_cells};

/// Which form, on a raster of which terms, and how many passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slide {
    pub(super) method: ThermalMethod,
    pub(super) terms: Terms,
    pub(super) passes: u64,
}

impl Slide {
    /// Takes the passes.
    pub(super) fn run(&self, slope: &mut Slope, start: &[f32], change: &mut [f32]) {
        match self.method {
            ThermalMethod::Flux => (0..self.passes).for_each(|_| slope.pass(&self.terms, start, change)),
            ThermalMethod::Spread | ThermalMethod::Cells => {
                let mut shed = Raster::filled(&slope.grid, 0.0);
                let to_all = self.method == ThermalMethod::Spread;
                (0..self.passes).for_each(|_| cells::pass(slope, (&mut shed, to_all), &self.terms, start, change));
            }
        }
    }

    /// The same on cells twice as large.
    fn coarser(&self) -> Self {
        let mut slide = *self;
        slide.terms.drop_m = self.terms.drop_m.map(|drop| 2.0 * drop);
        slide.terms.quantum_m = 16.0 * self.terms.quantum_m;
        slide
    }
}

/// What lies on a raster: heights, loose ground, and shares of the rate, empty where they are 1 everywhere.
pub(super) struct Ground {
    pub(super) grid: Grid,
    pub(super) height: Vec<f32>,
    pub(super) loose: Vec<f32>,
    pub(super) rate: Vec<f32>,
}

/// Lets the ground slide on `levels` rasters of larger cells, the coarsest first, and gives what each cell gains.
pub(super) fn slide_coarse(ground: &Ground, slide: &Slide, levels: u32) -> Vec<f32> {
    let fine = ground.grid;
    let none = vec![0.0; fine.cells()];
    // A raster of an odd side has no half.
    if levels == 0 || !fine.width.is_multiple_of(2) || !fine.height.is_multiple_of(2) || fine.width.min(fine.height) < 8
    {
        return none;
    }
    let grid = Grid { width: fine.width / 2, height: fine.height / 2, cell_m: 2.0 * fine.cell_m, edges: fine.edges };
    let mean = |values: &[f32]| blocks(&fine, &grid, values, |[a, b, c, d]| 0.25 * ((a + b) + (c + d)));
    let rate = match ground.rate.is_empty() {
        true => Vec::new(),
        // What is spread reaches the neighbours too: none of them may be held fast.
        false => around(&grid, &blocks(&fine, &grid, &ground.rate, |[a, b, c, d]| a.min(b).min(c.min(d)))),
    };
    let coarse = Ground { grid, height: mean(&ground.height), loose: mean(&ground.loose), rate };
    let slide_here = slide.coarser();
    let mut change = slide_coarse(&coarse, &slide_here, levels - 1);
    let height: Vec<f32> = coarse.height.iter().zip(&change).map(|(z, gained)| z + gained).collect();
    let mut slope = Slope::new(grid, &height, coarse.loose.clone(), &coarse.rate, &slide_here.terms);
    slide_here.run(&mut slope, &coarse.height, &mut change);
    spread(&fine, &Field { grid, data: change })
}

/// `f` of the four cells that make up each cell of a raster half as fine.
fn blocks(fine: &Grid, grid: &Grid, values: &[f32], f: impl Fn([f32; 4]) -> f32 + Sync + Send) -> Vec<f32> {
    let mut out = vec![0.0; grid.cells()];
    map_cells(&mut out, grid.width, |x, y| {
        let i = fine.index(2 * x, 2 * y);
        f([values[i], values[i + 1], values[i + fine.width], values[i + fine.width + 1]])
    });
    out
}

/// The least of each cell and those around it.
fn around(grid: &Grid, values: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; grid.cells()];
    map_cells(&mut out, grid.width, |x, y| {
        let rows = [-1, 0, 1].map(|dy| grid.row(y, dy));
        let columns = [-1, 0, 1].map(|dx| grid.column(x, dx));
        rows.iter().flat_map(|&y| columns.map(|x| values[grid.index(x, y)])).fold(f32::INFINITY, f32::min)
    });
    out
}

/// What each of the fine cells gets: nine, three, three and one sixteenth of the four cells around it. Beyond a rim lies
/// what lies on it.
fn spread(fine: &Grid, change: &Field<f32>) -> Vec<f32> {
    let mut out = vec![0.0; fine.cells()];
    let side = |at: usize| if at.is_multiple_of(2) { -1 } else { 1 };
    debug_assert!(fine.edges == change.grid.edges || fine.edges != Edges::Wrap);
    map_cells(&mut out, fine.width, |x, y| {
        let grid = &change.grid;
        let (cx, cy) = (x / 2, y / 2);
        let (bx, by) = (grid.column(cx, side(x)), grid.row(cy, side(y)));
        let sixteenth = |v: f32| v * (1.0 / 16.0);
        sixteenth(change.at(cx, cy)) * 9.0
            + (sixteenth(change.at(bx, cy)) * 3.0 + sixteenth(change.at(cx, by)) * 3.0)
            + sixteenth(change.at(bx, by))
    });
    out
}
