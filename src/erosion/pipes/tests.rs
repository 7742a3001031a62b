//! What the solver must do, against what is known without it.

mod books;
mod calm;
mod held;
mod same;
mod staged;
mod traced;
mod waves;

use super::super::bed::{Bed, Family, Moved, Part};
use super::*;
use crate::grid::{Edges, Grid, sum_f64};

/// A bed over a raster of `width` x `height` cells.
fn bed(width: usize, height: usize, cell_m: f64, edges: Edges, z: impl Fn(usize, usize) -> f32) -> Bed {
    let grid = Grid { width, height, cell_m, edges };
    let start = (0..grid.cells()).map(|i| z(i % width, i / width)).collect();
    Bed { sea_m: -1e6, ..Bed::new(grid, start) }
}

/// Water alone: no rain, no friction, no exchange with the bed.
fn still() -> PipesParams {
    PipesParams {
        duration_h: 1.0,
        recession: 0.0,
        rain_mm_per_h: 0.0,
        evaporation_mm_per_h: 0.0,
        sea: false,
        manning_n: 0.0,
        dissolve_per_s: 0.0,
        settle_per_s: 0.0,
        slip_per_h: 0.0,
        ..PipesParams::default()
    }
}

/// Goes on for `seconds` in steps of its own.
fn run(pipes: &mut Pipes, bed: &mut Bed, seconds: f64, raining: bool) -> Moved {
    let (mut moved, mut now) = (Moved::default(), 0.0);
    while now < seconds {
        let dt = pipes.limit(raining).min(seconds - now);
        pipes.substep(bed, dt, raining, &mut moved);
        now += dt;
    }
    moved
}

/// A rough hill.
fn rough(x: usize, y: usize) -> f32 {
    let (x, y) = (x as f32, y as f32);
    40.0 + 12.0 * libm::sinf(0.21 * x + 0.4)
        + 9.0 * libm::cosf(0.17 * y - 0.03 * x)
        + 2.0 * libm::sinf(0.9 * x + 1.3 * y)
}

const WHOLE: Part = Part { step: 0, steps: 1 };
