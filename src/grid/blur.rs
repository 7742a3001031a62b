//! Gaussian blur by three extended boxes (Gwosdek et al. 2011): the variance is exact, the cost does not grow with it.

use multiversion::multiversion;
use rayon::prelude::*;

use super::{Edges, Field, transposed};

/// Rows or columns that are smoothed side by side: a sum that runs down one of them waits for itself, sixteen do not.
const STRIP: usize = 16;

/// The field smoothed with a Gaussian of `sigma_px` cells; the rim's value continues beyond it.
pub fn blur(field: &Field<f32>, sigma_px: f64) -> Field<f32> {
    let (w, h) = (field.grid.width, field.grid.height);
    let wrap = field.grid.edges == Edges::Wrap;
    let boxes = Boxes::new(sigma_px);
    let along = boxes.across(&field.data, w, wrap);
    let turned = boxes.down_and_turn(&along, [w, h], wrap);
    Field { grid: field.grid, data: transposed(&turned, h, w) }
}

/// A box of `2·radius + 1` cells and the share `edge` of one more on either side, three times over.
struct Boxes {
    radius: usize,
    edge: f64,
    total: f64,
}

impl Boxes {
    fn new(sigma_px: f64) -> Self {
        let variance = sigma_px * sigma_px / 3.0;
        let r = libm::floor(0.5 * (12.0 * variance + 1.0).sqrt() - 0.5);
        let edge = (2.0 * r + 1.0) * (r * (r + 1.0) - 3.0 * variance) / (6.0 * (variance - (r + 1.0) * (r + 1.0)));
        Self { radius: r as usize, edge, total: 2.0 * r + 1.0 + 2.0 * edge }
    }

    /// Smooths along the rows, a strip of them turned into columns at a time.
    fn across(&self, data: &[f32], w: usize, wrap: bool) -> Vec<f32> {
        let mut out = vec![0.0; data.len()];
        let room = || [vec![[0.0f32; STRIP]; w], vec![[0.0f32; STRIP]; w]];
        let strips = out.par_chunks_mut((STRIP * w).max(1)).zip(data.par_chunks((STRIP * w).max(1)));
        strips.for_each_init(room, |[strip, other], (to, rows)| {
            for (i, row) in rows.chunks_exact(w).enumerate() {
                strip.iter_mut().zip(row).for_each(|(column, &v)| column[i] = v);
            }
            self.thrice(strip, other, wrap);
            for (i, row) in to.chunks_exact_mut(w).enumerate() {
                row.iter_mut().zip(other.iter()).for_each(|(to, column)| *to = column[i]);
            }
        });
        out
    }

    /// Smooths down the columns; rows become columns.
    fn down_and_turn(&self, data: &[f32], [w, h]: [usize; 2], wrap: bool) -> Vec<f32> {
        let mut out = vec![0.0; data.len()];
        let room = || [vec![[0.0f32; STRIP]; h], vec![[0.0f32; STRIP]; h]];
        out.par_chunks_mut((STRIP * h).max(1)).enumerate().for_each_init(room, |[strip, other], (block, columns)| {
            let wide = columns.len() / h;
            for (y, row) in strip.iter_mut().enumerate() {
                row[..wide].copy_from_slice(&data[y * w + block * STRIP..][..wide]);
            }
            self.thrice(strip, other, wrap);
            for (i, column) in columns.chunks_exact_mut(h).enumerate() {
                column.iter_mut().zip(other.iter()).for_each(|(to, row)| *to = row[i]);
            }
        });
        out
    }

    /// Smooths a strip down, from one room to the other.
    fn thrice(&self, strip: &mut [[f32; STRIP]], other: &mut [[f32; STRIP]], wrap: bool) {
        down(self, strip, other, wrap);
        down(self, other, strip, wrap);
        down(self, strip, other, wrap);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn down(boxes: &Boxes, from: &[[f32; STRIP]], to: &mut [[f32; STRIP]], wrap: bool) {
    let h = from.len() as isize;
    let reach = boxes.radius as isize;
    let row = |y: isize| {
        let y = if wrap { y.rem_euclid(h) } else { y.clamp(0, h - 1) };
        &from[y as usize]
    };
    let mut sum = [0.0f64; STRIP];
    for y in -reach..=reach {
        for (sum, &v) in sum.iter_mut().zip(row(y)) {
            *sum += v as f64;
        }
    }
    for (y, out) in to.iter_mut().enumerate() {
        let y = y as isize;
        let (before, first, after) = (row(y - reach - 1), row(y - reach), row(y + reach + 1));
        for i in 0..STRIP {
            let after = after[i] as f64;
            out[i] = ((sum[i] + boxes.edge * (before[i] as f64 + after)) / boxes.total) as f32;
            sum[i] += after - first[i] as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;

    #[test]
    fn variance_is_exact_and_nothing_is_lost() {
        for sigma in [0.4, 0.7, 1.5, 6.0] {
            let grid = Grid::new(81, 81, 81.0, Edges::Open);
            let mut spike = Field::filled(grid, 0.0f32);
            spike.data[grid.index(40, 40)] = 1.0;
            let soft = blur(&spike, sigma);
            let sum: f64 = soft.data.iter().map(|&v| v as f64).sum();
            let variance: f64 =
                (0..grid.cells()).map(|i| soft.data[i] as f64 * (grid.cell_of(i).0 as f64 - 40.0).powi(2)).sum();
            assert!((sum - 1.0).abs() < 1e-5 && (variance - sigma * sigma).abs() < 1e-4 * sigma * sigma.max(1.0));
        }
    }

    #[test]
    fn a_wrapped_world_has_no_seam() {
        let grid = Grid::new(32, 32, 32.0, Edges::Wrap);
        let wave = Field::from_fn(grid, |x, _| libm::sin(x as f64 / 32.0 * std::f64::consts::TAU) as f32);
        let soft = blur(&wave, 2.0);
        let ratio = soft.at(8, 0) / wave.at(8, 0);
        assert!((0..32).all(|x| (soft.at(x, 5) - ratio * wave.at(x, 5)).abs() < 1e-5));
    }
}
