//! Taking the stairs out of heights stored in few bits.
//!
//! A stored height is the true one rounded: the truth lies within half a step of it. So the heights are smoothed, widely
//! first and then ever more narrowly, and after each time put back within a bound of what was stored. Slopes between
//! stairs become straight; nothing moves further than the bound, so no ridge is lost.

use crate::grid::for_each_row;

/// Standard deviations of the Gaussians, cells.
const WIDTHS: [f64; 7] = [24.0, 16.0, 11.0, 7.0, 4.0, 2.0, 1.0];

/// Smooths heights by at most `bound_m` each.
pub(super) fn unstep(heights: &mut Vec<f32>, width: usize, bound_m: f32) {
    let stored = heights.clone();
    for sigma in WIDTHS {
        let kernel = gaussian(sigma);
        let across = blurred_rows(heights, width, &kernel);
        let both = blurred_columns(&across, width, &kernel);
        *heights = both.iter().zip(&stored).map(|(v, s)| v.clamp(s - bound_m, s + bound_m)).collect();
    }
}

/// Half of a Gaussian's weights to three standard deviations, the middle first.
fn gaussian(sigma: f64) -> Vec<f32> {
    let reach = libm::ceil(3.0 * sigma) as usize;
    let weights: Vec<f64> = (0..=reach).map(|i| libm::exp(-0.5 * (i as f64 / sigma).powi(2))).collect();
    let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.iter().map(|w| (w / sum) as f32).collect()
}

fn blurred_rows(data: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() - 1;
    let mut out = vec![0.0; data.len()];
    for_each_row(&mut out, width, |y, row| {
        let from = &data[y * width..][..width];
        // The rim's height is continued beyond it.
        let (first, last) = (from[0], from[width - 1]);
        let mut wide = vec![first; reach];
        wide.extend_from_slice(from);
        wide.resize(width + 2 * reach, last);
        for (k, &weight) in kernel.iter().enumerate() {
            let (west, east) = (&wide[reach - k..][..width], &wide[reach + k..][..width]);
            for ((v, w), e) in row.iter_mut().zip(west).zip(east) {
                *v += if k == 0 { weight * w } else { weight * (w + e) };
            }
        }
    });
    out
}

fn blurred_columns(data: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let rows = data.len() / width;
    let mut out = vec![0.0; data.len()];
    for_each_row(&mut out, width, |y, row| {
        for (k, &weight) in kernel.iter().enumerate() {
            let north = &data[y.saturating_sub(k) * width..][..width];
            let south = &data[(y + k).min(rows - 1) * width..][..width];
            for ((v, n), s) in row.iter_mut().zip(north).zip(south) {
                *v += if k == 0 { weight * n } else { weight * (n + s) };
            }
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hills(x: usize, y: usize) -> f64 {
        let (x, y) = (x as f64, y as f64);
        900.0 * (x / 83.0).sin() * (y / 61.0).cos() + 3.0 * x
    }

    #[test]
    fn most_of_the_error_of_8_bits_goes_and_nothing_leaves_its_step() {
        let (w, h, step) = (320, 240, 12.0f64);
        let truth: Vec<f64> = (0..w * h).map(|i| hills(i % w, i / w)).collect();
        let stored: Vec<f32> = truth.iter().map(|v| ((v / step).round() * step) as f32).collect();
        let mut smooth = stored.clone();
        unstep(&mut smooth, w, 0.5 * step as f32);
        let rms = |heights: &[f32]| {
            let sum: f64 = heights.iter().zip(&truth).map(|(a, b)| (*a as f64 - b).powi(2)).sum();
            (sum / truth.len() as f64).sqrt()
        };
        // Rounding alone errs by step / sqrt(12).
        assert!((rms(&stored) - step / 12f64.sqrt()).abs() < 0.02 * step);
        assert!(rms(&smooth) < 0.4 * rms(&stored), "{} of {}", rms(&smooth), rms(&stored));
        assert!(smooth.iter().zip(&stored).all(|(a, b)| (a - b).abs() <= 0.5001 * step as f32));
    }
}
