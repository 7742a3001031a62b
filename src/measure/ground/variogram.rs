//! Fractal dimension from the variogram, `γ(d) = ½·mean (z(x+d) − z(x))² ∝ d^(2H)`, `D = 3 − H` (Mark and Aronson 1984).
//!
//! Lags of 2 to 50 cells along rows and columns, both ends on land. Biased for smooth ground: H = 0.8 reads 0.72 to 0.76.

use rayon::prelude::*;

use super::super::{fit::Line, metric::Missing};
use crate::grid::Field;

const LAGS: [usize; 11] = [2, 3, 4, 5, 7, 10, 14, 19, 26, 36, 50];
const LEAST_PAIRS: usize = 200;
const LEAST_LAGS: usize = 5;

/// Semivariance against distance.
#[derive(Clone, Debug)]
pub struct Variogram {
    /// Fractal dimension D.
    pub dimension: f64,
    /// The law, in decimal logarithms of km and m².
    pub line: Line,
    /// `[distance, km; semivariance, m²]`.
    pub points: Vec<[f64; 2]>,
}

/// The variogram of the land.
pub fn variogram(height: &Field<f32>, sea_level_m: f64) -> Result<Variogram, Missing> {
    let found: Vec<(usize, [f64; 2])> = LAGS.par_iter().map(|&lag| at(height, sea_level_m, lag)).collect();
    let counted = found.iter().filter(|(pairs, _)| *pairs >= LEAST_PAIRS);
    let points: Vec<[f64; 2]> = counted.map(|(_, point)| *point).collect();
    let few = Missing::TooFew { what: "distances with 200 pairs on land", found: points.len(), needed: LEAST_LAGS };
    if points.len() < LEAST_LAGS {
        return Err(few);
    }
    if points.iter().any(|p| p[1] <= 0.0) {
        return Err(Missing::Flat);
    }
    let line = Line::through_logs(&points).ok_or(few)?;
    Ok(Variogram { dimension: 3.0 - 0.5 * line.slope, line, points })
}

/// Pairs on land at a lag, and their point.
fn at(height: &Field<f32>, sea_level_m: f64, lag: usize) -> (usize, [f64; 2]) {
    let (w, h) = (height.grid.width, height.grid.height);
    let (mut pairs, mut sum) = (0usize, 0.0);
    let mut pair = |a: f32, b: f32| {
        let (a, b) = (a as f64, b as f64);
        if a > sea_level_m && b > sea_level_m {
            pairs += 1;
            sum += (a - b) * (a - b);
        }
    };
    for y in 0..h {
        let row = height.row(y);
        row.iter().zip(&row[lag.min(w)..]).for_each(|(&a, &b)| pair(a, b));
        if y + lag < h {
            row.iter().zip(height.row(y + lag)).for_each(|(&a, &b)| pair(a, b));
        }
    }
    (pairs, [lag as f64 * height.grid.cell_m * 1e-3, 0.5 * sum / pairs.max(1) as f64])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{grid::Grid, measure::ground::shapes::fbm};

    #[test]
    fn brownian_ground_has_its_dimension() {
        let mean = |hurst: f64| {
            let sum: f64 = (1..=4).map(|seed| variogram(&fbm(512, hurst, seed), -1e9).unwrap().dimension).sum();
            3.0 - sum / 4.0
        };
        let (half, smooth) = (mean(0.5), mean(0.8));
        assert!((half - 0.5).abs() < 0.05, "{half}");
        // Long waves are missing from any finite ground, which flattens the curve.
        assert!((0.70..0.80).contains(&smooth), "{smooth}");
    }

    #[test]
    fn a_plane_is_smooth_and_level_ground_has_none() {
        let grid = Grid::new(80, 60, 80.0, crate::grid::Edges::Open);
        let plane = Field::from_fn(grid, |x, y| (x + y + 1) as f32);
        assert!((variogram(&plane, 0.0).unwrap().dimension - 2.0).abs() < 1e-9);
        assert_eq!(variogram(&Field::filled(grid, 1.0), 0.0).unwrap_err(), Missing::Flat);
        assert!(matches!(variogram(&plane, 1e9).unwrap_err(), Missing::TooFew { found: 0, .. }));
    }
}
