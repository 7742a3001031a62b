//! Sliding on rasters of larger cells first.
//!
//! A level has half as many cells a side as the one below, rounded up: where that is not a half, its cells are a little
//! narrower than two. Its ground is the mean of what lies under it; what it gains is spread back over that by the
//! line through the middles of its cells, in whole quanta, of which none is lost on the way.

use super::{
    axis::Axis,
    cells,
    flux::{Shares, Slope, Terms},
    params::ThermalMethod,
    raster::Raster,
};
use crate::grid::{Edges, Grid, for_each_row, map_cells};

/// Cells a side below which a raster is not halved.
const LEAST_SIDE: usize = 8;

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
        slide
    }
}

/// What lies on a raster: heights, loose ground, and shares of the rate.
pub(super) struct Ground {
    pub(super) grid: Grid,
    pub(super) height: Vec<f32>,
    pub(super) loose: Vec<f32>,
    pub(super) shares: Shares,
}

/// Lets the ground slide on `levels` rasters of larger cells, the coarsest first, and gives what each cell gains.
pub(super) fn slide_coarse(ground: &Ground, slide: &Slide, levels: u32) -> Vec<f32> {
    let fine = ground.grid;
    if levels == 0 || fine.width.min(fine.height) < LEAST_SIDE {
        return vec![0.0; fine.cells()];
    }
    let wraps = fine.edges == Edges::Wrap;
    let axes = [fine.width, fine.height].map(|fine| Axis { fine, coarse: fine.div_ceil(2), wraps });
    let grid = Grid { width: axes[0].coarse, height: axes[1].coarse, cell_m: 2.0 * fine.cell_m, edges: fine.edges };
    let mean = |values: &[f32]| under(&axes, values, 0.0, |sum, value, weight| sum + weight * value);
    // What is spread reaches the neighbours too: none of them may be held fast.
    let least =
        |values: &[f32]| around(&grid, &under(&axes, values, f32::INFINITY, |least, value, _| least.min(value)));
    let shares = match ground.shares.none() {
        true => Shares::default(),
        false => Shares { soft: least(&ground.shares.soft), mask: least(&ground.shares.mask) },
    };
    let coarse = Ground { grid, height: mean(&ground.height), loose: mean(&ground.loose), shares };
    let slide_here = slide.coarser();
    let mut change = slide_coarse(&coarse, &slide_here, levels - 1);
    let height: Vec<f32> = coarse.height.iter().zip(&change).map(|(z, gained)| z + gained).collect();
    let mut slope = Slope::new(grid, &height, coarse.loose.clone(), &coarse.shares, &slide_here.terms);
    slide_here.run(&mut slope, &coarse.height, &mut change);
    spread(&axes, &change, slide.terms.quantum_m)
}

/// For each cell of a raster half as fine, `f` of the cells that lie under it, one after another, each with its share of the
/// whole.
fn under(axes: &[Axis; 2], values: &[f32], first: f32, f: impl Fn(f32, f32, f32) -> f32 + Sync + Send) -> Vec<f32> {
    let [across, down] = axes;
    let mut out = vec![0.0; across.coarse * down.coarse];
    map_cells(&mut out, across.coarse, |x, y| {
        let columns = across.under(x);
        let mut all = first;
        for (y, part) in down.under(y) {
            for &(x, share) in &columns {
                all = f(all, values[y * across.fine + x], (part * share) as f32);
            }
        }
        all
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

/// What each of the fine cells gets of what the coarse ones gained: along rows, along columns, and then in whole quanta. What
/// rounding leaves is handed on from cell to cell, so that the sum stays what it is: nothing.
fn spread(axes: &[Axis; 2], change: &[f32], quantum_m: f32) -> Vec<f32> {
    let [across, down] = axes;
    let mut wide = vec![0.0; across.fine * down.coarse];
    for_each_row(&mut wide, across.fine, |y, row| {
        let of = &change[y * across.coarse..][..across.coarse];
        across.spread(|k| f64::from(of[k]), |x, v| row[x] = v);
    });
    // Columns as rows, so that they run side by side.
    let mut tall = vec![0.0; across.fine * down.fine];
    for_each_row(&mut tall, down.fine, |x, column| {
        down.spread(|k| wide[k * across.fine + x], |y, v| column[y] = v);
    });
    let per_quantum = 1.0 / f64::from(quantum_m);
    let (mut out, mut sum, mut given) = (vec![0.0; tall.len()], 0.0, 0.0);
    for (i, out) in out.iter_mut().enumerate() {
        sum += tall[i % across.fine * down.fine + i / across.fine] * per_quantum;
        let now = (sum + 0.5).floor();
        *out = (now - given) as f32 * quantum_m;
        given = now;
    }
    out
}
