//! Lava sheets against what is worked out on paper.

mod books;
mod flows;
mod heat;

use super::{cells::Sheet, law::Law, params::LavaSheetParams};
use crate::grid::{Edges, Grid};

/// Lava that keeps its heat.
fn warm() -> LavaSheetParams {
    LavaSheetParams {
        yield_pa: 0.0,
        yield_growth_pa: 0.0,
        emissivity: 0.0,
        air_w_per_m2_k: 0.0,
        ground_w_per_m2_k: 0.0,
        sea_w_per_m2_k: 0.0,
        most_speed_m_per_s: 100.0,
        ..LavaSheetParams::default()
    }
}

/// A sheet on ground of this height.
fn on(grid: &Grid, bed: impl Fn(f64, f64) -> f64 + Sync + Send) -> Sheet {
    let at = |x: usize, y: usize| {
        let [px, py] = grid.center_m(x, y);
        bed(px, py)
    };
    Sheet::new(grid, at, -1e6)
}

/// Puts lava of a depth on a sheet, as hot as it comes out.
fn pool(sheet: &mut Sheet, grid: &Grid, law: &Law, depth: impl Fn(f64, f64) -> f64) {
    let cells: Vec<(usize, f64, f64)> = (0..grid.cells())
        .map(|i| {
            let (x, y) = grid.cell_of(i);
            let [px, py] = grid.center_m(x, y);
            let h = depth(px, py);
            (sheet.cell(grid, i), h, h * law.fresh)
        })
        .filter(|cell| cell.1 > 0.0)
        .collect();
    sheet.put(&cells);
}

/// Lets it run; returns the steps it took.
fn run(sheet: &mut Sheet, law: &Law, source: &[(usize, f64)], seconds: f64) -> usize {
    let (mut now, mut steps) = (0.0, 0);
    while now < seconds {
        now += sheet.advance(law, source, seconds - now);
        steps += 1;
        assert!(steps < 2_000_000);
    }
    steps
}

fn square(cells: usize, extent_m: f64) -> Grid {
    Grid::new(cells, cells, extent_m, Edges::Closed)
}

/// How far a flow reaches from a place in each of 32 directions: where its depth, interpolated, falls below a share of its
/// greatest.
fn reaches(sheet: &Sheet, grid: &Grid, from_m: [f64; 2], depth_m: f64) -> Vec<f64> {
    let depth = |i: usize, j: usize| sheet.molten[sheet.cell(grid, grid.index(i, j))];
    let at = |px: f64, py: f64| {
        let [fx, fy] = [px, py].map(|m| m / grid.cell_m - 0.5);
        let (x, y) = (fx.floor() as usize, fy.floor() as usize);
        let (tx, ty) = (fx.fract(), fy.fract());
        let row = |j: usize| depth(x, j) * (1.0 - tx) + depth(x + 1, j) * tx;
        row(y) * (1.0 - ty) + row(y + 1) * ty
    };
    (0..32)
        .map(|k| {
            let angle = k as f64 * std::f64::consts::TAU / 32.0;
            let step = 0.05 * grid.cell_m;
            let mut r = 0.0;
            while at(from_m[0] + r * angle.cos(), from_m[1] + r * angle.sin()) > depth_m {
                r += step;
            }
            r
        })
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
