//! Gaussian blur by three extended boxes (Gwosdek et al. 2011): the variance is exact, the cost does not grow with it.

use rayon::prelude::*;

use super::{Edges, Field, for_each_row};

/// The field smoothed with a Gaussian of `sigma_px` cells; the rim's value continues beyond it.
pub fn blur(field: &Field<f32>, sigma_px: f64) -> Field<f32> {
    let (w, h) = (field.grid.width, field.grid.height);
    let wrap = field.grid.edges == Edges::Wrap;
    let mut data = field.data.clone();
    blur_rows(&mut data, w, sigma_px, wrap);
    let mut turned = transposed(&data, w, h);
    blur_rows(&mut turned, h, sigma_px, wrap);
    Field { grid: field.grid, data: transposed(&turned, h, w) }
}

/// The columns of a raster of `w` by `h` cells as rows.
pub fn transposed<T: Copy + Default + Send + Sync>(data: &[T], w: usize, h: usize) -> Vec<T> {
    // Several columns at a time, so that every line of memory is read once.
    const COLUMNS: usize = 16;
    let mut out = vec![T::default(); data.len()];
    out.par_chunks_mut((COLUMNS * h).max(1)).enumerate().for_each(|(block, columns)| {
        let wide = columns.len() / h;
        for y in 0..h {
            for (i, &v) in data[y * w + block * COLUMNS..][..wide].iter().enumerate() {
                columns[i * h + y] = v;
            }
        }
    });
    out
}

fn blur_rows(data: &mut [f32], width: usize, sigma_px: f64, wrap: bool) {
    const PASSES: f64 = 3.0;
    let variance = sigma_px * sigma_px / PASSES;
    // The whole part of the box, and the weight of one more cell on either side.
    let r = libm::floor(0.5 * (12.0 * variance + 1.0).sqrt() - 0.5);
    let edge = (2.0 * r + 1.0) * (r * (r + 1.0) - 3.0 * variance) / (6.0 * (variance - (r + 1.0) * (r + 1.0)));
    let total = 2.0 * r + 1.0 + 2.0 * edge;
    let radius = r as usize;
    for_each_row(data, width, |_, row| {
        let pad = radius + 1;
        let mut padded = vec![0.0f32; width + 2 * pad];
        for _ in 0..PASSES as usize {
            for (i, value) in padded.iter_mut().enumerate() {
                let at = i as isize - pad as isize;
                *value = row[if wrap {
                    at.rem_euclid(width as isize) as usize
                } else {
                    at.clamp(0, width as isize - 1) as usize
                }];
            }
            let mut sum: f64 = padded[1..2 * radius + 2].iter().map(|&v| v as f64).sum();
            for (x, value) in row.iter_mut().enumerate() {
                let (before, after) = (padded[x] as f64, padded[x + 2 * pad] as f64);
                *value = ((sum + edge * (before + after)) / total) as f32;
                sum += after - padded[x + 1] as f64;
            }
        }
    });
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
