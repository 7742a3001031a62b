//! Diffusion over a raster, whole by construction: what crosses a face leaves one cell and enters the other.
//!
//! `∂z/∂t = ∇·(κ∇z)`. A face between two cells lets through as much as its two cells allow. Explicit steps of at most a
//! fifth of a cell's area (they are stable to a quarter); where that takes many, lines of cells are solved implicitly, rows
//! first, then columns (backward Euler, split by direction: stable for any step, never beyond the highest and the lowest).
//! Nothing crosses the rim; an implicit line does not wrap.

use multiversion::multiversion;

use crate::grid::{Edges, Grid, for_each_row, transposed};

/// Most of `κ·t / cell²` in an explicit step.
const EXPLICIT: f64 = 0.2;
/// Explicit steps beyond which lines are cheaper.
const MOST_STEPS: f64 = 6.0;

/// How much a face lets through: it is open where one of its cells is.
fn face(a: f32, b: f32) -> f32 {
    a.max(b)
}

/// Diffuses `value` by `spread_m2` (diffusivity times time); `open` scales it cell by cell. `spare` is as long as `value`, and
/// written over.
pub(super) fn diffuse(grid: Grid, value: &mut Vec<f64>, spread_m2: f64, open: &[f32], spare: &mut Vec<f64>) {
    let share = spread_m2 / grid.cell_area_m2();
    if share <= 0.0 {
        return;
    }
    let steps = (share / EXPLICIT).ceil();
    if steps > MOST_STEPS {
        return implicit(grid, value, share, open);
    }
    for _ in 0..steps as usize {
        explicit(grid, value, spare, share / steps, open);
        std::mem::swap(value, spare);
    }
}

fn explicit(grid: Grid, value: &[f64], next: &mut [f64], share: f64, open: &[f32]) {
    let width = grid.width;
    for_each_row(next, width, |y, out| {
        // A row beyond the rim is the rim's own: nothing crosses.
        let rows = [grid.row(y, -1), y, grid.row(y, 1)].map(|y| y * width..(y + 1) * width);
        let (value, open) = (rows.clone().map(|row| &value[row]), rows.map(|row| &open[row]));
        if width > 2 {
            explicit_inside(value, open, share, out);
        }
        for x in [0, width - 1] {
            out[x] = spread(value, open, share, x, [grid.column(x, -1), grid.column(x, 1)]);
        }
    });
}

/// A row but for its ends.
#[multiversion(targets("x86_64+avx2"))]
fn explicit_inside(value: [&[f64]; 3], open: [&[f32]; 3], share: f64, out: &mut [f64]) {
    let width = out.len();
    // Said once for the row, so that no cell has to look whether it is there.
    let (value, open) = (value.map(|row| &row[..width]), open.map(|row| &row[..width]));
    for (x, out) in (1..width - 1).zip(&mut out[1..]) {
        *out = spread(value, open, share, x, [x - 1, x + 1]);
    }
}

/// A cell after a step; the rows are the one to the north, its own, and the one to the south.
#[inline(always)]
fn spread(value: [&[f64]; 3], open: [&[f32]; 3], share: f64, x: usize, [west, east]: [usize; 2]) -> f64 {
    let (v, a) = (value[1][x], open[1][x]);
    let flow = |row: usize, x: usize| face(a, open[row][x]) as f64 * (value[row][x] - v);
    v + share * (flow(0, x) + flow(1, west) + flow(1, east) + flow(2, x))
}

fn implicit(grid: Grid, value: &mut Vec<f64>, share: f64, open: &[f32]) {
    let flat = Grid { edges: Edges::Open, ..grid };
    let turned = Grid { width: flat.height, height: flat.width, ..flat };
    solve_rows(flat, value, share, open);
    let mut columns = transposed(value, flat.width, flat.height);
    let open = transposed(open, flat.width, flat.height);
    solve_rows(turned, &mut columns, share, &open);
    *value = transposed(&columns, turned.width, turned.height);
}

/// Thomas's algorithm on every row.
fn solve_rows(grid: Grid, value: &mut [f64], share: f64, open: &[f32]) {
    let width = grid.width;
    for_each_row(value, width, |y, row| {
        let open = &open[y * width..][..width];
        let weight = |x: usize| if x + 1 < width { share * face(open[x], open[x + 1]) as f64 } else { 0.0 };
        let mut factor = vec![0.0; width];
        let (mut west, mut before, mut last) = (0.0, 0.0, 0.0);
        for x in 0..width {
            let east = weight(x);
            let pivot = 1.0 + east + west * (1.0 - before);
            factor[x] = east / pivot;
            row[x] = (row[x] + west * last) / pivot;
            (west, before, last) = (east, factor[x], row[x]);
        }
        for x in (0..width.saturating_sub(1)).rev() {
            row[x] += factor[x] * row[x + 1];
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_decays_as_it_should() {
        // A whole wave between closed ends, over 64 cells; explicit below 6 steps of a fifth, implicit lines above.
        let grid = Grid { width: 64, height: 64, cell_m: 1.0, edges: Edges::Closed };
        let k = std::f64::consts::TAU / 64.0;
        for (spread, times, error) in [(1.0, 40, 2e-3), (4.0, 10, 2e-2)] {
            for across in [true, false] {
                let wave = |i: usize| (k * ((if across { i % 64 } else { i / 64 }) as f64 + 0.5)).cos();
                let mut z: Vec<f64> = (0..64 * 64).map(wave).collect();
                let open = vec![1.0; z.len()];
                let mut spare = z.clone();
                (0..times).for_each(|_| diffuse(grid, &mut z, spread, &open, &mut spare));
                let want = (-k * k * 40.0).exp();
                // Discrete in space, k² is 8e-4 short; a step that is implicit errs by half of k²·spread.
                assert!((z[5 * 64 + 5] / wave(5 * 64 + 5) / want - 1.0).abs() < error, "{} {want}", z[5 * 64 + 5]);
            }
        }
    }

    #[test]
    fn nothing_is_lost_or_overshot_at_any_step() {
        for edges in [Edges::Open, Edges::Wrap] {
            let grid = Grid { width: 37, height: 21, cell_m: 10.0, edges };
            for spread in [1.0, 100.0, 1e4, 1e9] {
                let mut z: Vec<f64> = (0..grid.cells()).map(|i| ((i * 7919) % 101) as f64).collect();
                let open: Vec<f32> = (0..grid.cells()).map(|i| if i % 5 == 0 { 0.0 } else { 0.7 }).collect();
                let before: f64 = z.iter().sum();
                diffuse(grid, &mut z, spread, &open, &mut vec![0.0; grid.cells()]);
                // A line whose faces weigh `spread / cell²` is solved to that many roundings.
                let roundings = 1e-13 + 1e-15 * spread / 100.0;
                assert!((z.iter().sum::<f64>() / before - 1.0).abs() < roundings, "{edges:?} {spread}");
                assert!(z.iter().all(|&z| (-1e-6..=100.0 + 1e-6).contains(&z)));
            }
        }
    }
}
