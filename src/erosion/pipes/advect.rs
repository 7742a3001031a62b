//! Sediment that is traced back along the velocity instead of riding on the fluxes: semi-Lagrangian, or MacCormack with
//! the values around the same traced point as its limits. The concentration travels; what the interpolation loses or
//! makes is put right in proportion, in all cells that carry any.

use crate::grid::{Edges, Grid, for_each_row, sum_f64};

/// Velocity and concentration, m/s and m of rock a metre of water.
#[derive(Clone, Debug, Default)]
pub struct Tracer {
    pub velocity: [Vec<f32>; 2],
    pub value: Vec<f32>,
    /// Room for sediment that has come to cells, m.
    pub brought: Vec<f32>,
    guess: Vec<f32>,
}

impl Tracer {
    /// Room for a raster.
    pub fn new(cells: usize) -> Self {
        let row = || vec![0.0; cells];
        Self { velocity: [row(), row()], value: row(), brought: row(), guess: row() }
    }

    /// Moves `value` for `dt` seconds; a cell is dry where `wet` says no.
    pub fn run(
        &mut self,
        grid: &Grid,
        dt: f32,
        mac_cormack: bool,
        wet: impl Fn(usize) -> bool + Sync,
        out: &mut [f32],
    ) {
        let Self { velocity, value, guess, .. } = self;
        let trace =
            |sign: f32| Trace { grid, velocity: [&velocity[0], &velocity[1]], span: sign * dt / grid.cell_m as f32 };
        let (back, ahead) = (trace(1.0), trace(-1.0));
        let w = grid.width;
        if !mac_cormack {
            return for_each_row(out, w, |y, row| {
                row.iter_mut().enumerate().for_each(|(x, out)| *out = back.place(x, y).read(value));
            });
        }
        for_each_row(guess, w, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, out)| *out = back.place(x, y).read(value));
        });
        for_each_row(out, w, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                let (from, to, i) = (back.place(x, y), ahead.place(x, y), y * w + x);
                let better = guess[i] + 0.5 * (value[i] - to.read(guess));
                let around = from.cells.map(|c| value[c]);
                let least = around.iter().fold(f32::MAX, |a, &b| a.min(b));
                let most = around.iter().fold(f32::MIN, |a, &b| a.max(b));
                let sound = !from.left && !to.left && from.cells.iter().chain(&to.cells).all(|&c| wet(c));
                *out = if sound { better.max(least).min(most) } else { guess[i] };
            }
        });
    }
}

struct Trace<'a> {
    grid: &'a Grid,
    velocity: [&'a [f32]; 2],
    /// Cells a metre in a second makes in the step.
    span: f32,
}

/// A place between four cells.
struct Place {
    cells: [usize; 4],
    across: f32,
    down: f32,
    /// Whether it had lain outside the map.
    left: bool,
}

impl Place {
    fn read(&self, value: &[f32]) -> f32 {
        let [a, b, c, d] = self.cells.map(|i| value[i]);
        let (top, bottom) = (a + (b - a) * self.across, c + (d - c) * self.across);
        // Rounding must not make a value that none of the four has.
        let (least, most) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        (top + (bottom - top) * self.down).max(least).min(most)
    }
}

impl Trace<'_> {
    /// Where what is in a cell comes from: the midpoint rule.
    fn place(&self, x: usize, y: usize) -> Place {
        let i = self.grid.index(x, y);
        let (x, y) = (x as f32, y as f32);
        let half = 0.5 * self.span;
        let middle = self.between(x - half * self.velocity[0][i], y - half * self.velocity[1][i]);
        let [u, v] = self.velocity.map(|all| middle.read(all));
        self.between(x - self.span * u, y - self.span * v)
    }

    fn between(&self, x: f32, y: f32) -> Place {
        let grid = self.grid;
        let axis = |at: f32, size: usize| {
            let last = (size - 1) as f32;
            let (at, left) = match grid.edges {
                Edges::Wrap => (at, false),
                Edges::Open | Edges::Closed => (at.clamp(0.0, last), at < 0.0 || at > last),
            };
            let base = libm::floorf(at);
            (base as i64, at - base, left)
        };
        let ((x, across, out_x), (y, down, out_y)) = (axis(x, grid.width), axis(y, grid.height));
        let pick = |at: i64, size: usize| match grid.edges {
            Edges::Wrap => at.rem_euclid(size as i64) as usize,
            Edges::Open | Edges::Closed => at.clamp(0, size as i64 - 1) as usize,
        };
        let (w, e) = (pick(x, grid.width), pick(x + 1, grid.width));
        let (n, s) = (pick(y, grid.height), pick(y + 1, grid.height));
        let cells = [grid.index(w, n), grid.index(e, n), grid.index(w, s), grid.index(e, s)];
        Place { cells, across, down, left: out_x || out_y }
    }
}

/// Makes the sum of `new` what that of `old` is, without a change of sign; without any `new`, what was there stays.
pub fn mend(width: usize, old: &[f32], new: &mut [f32]) {
    let (before, after) = (sum_f64(old), sum_f64(new));
    if before <= 0.0 {
        return;
    }
    if after < 1e-9 * before {
        return new.copy_from_slice(old);
    }
    let scale = before / after;
    for_each_row(new, width, |_, row| row.iter_mut().for_each(|v| *v = (*v as f64 * scale) as f32));
}
