//! How steep the land is. Slope is the arctangent of the gradient by central differences, one-sided at open rims.

use rayon::prelude::*;
use serde::Serialize;

use super::hypsometry::rank;
use crate::grid::{Field, sum_f64};

/// Width of a bin of the histogram, degrees.
const BIN_DEG: f64 = 5.0;
/// Bins up to the vertical.
const BINS: usize = 18;
const PERCENTILES: [u8; 7] = [5, 10, 25, 50, 75, 90, 95];

/// Slopes over the cells counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slopes {
    /// Mean slope, degrees.
    pub mean_deg: f64,
    /// Standard deviation of slope, degrees.
    pub deviation_deg: f64,
    /// Standard deviation over mean of the tangent of slope (Olsen 2004); absent where all is level.
    pub erosion_score: Option<f64>,
    /// Greatest slope, degrees.
    pub max_deg: f64,
    /// `(percent, slope)`: so many percent of the cells are flatter.
    pub percentiles_deg: Vec<(u8, f64)>,
    /// Shares of the cells by slope, in bins of 5 degrees from 0.
    pub histogram: Vec<f64>,
}

/// Slopes of the cells whose height is above `above_m`; `None` where there is none.
pub fn slopes(height: &Field<f32>, above_m: f64) -> Option<Slopes> {
    let slope = Field::from_fn(height.grid, |x, y| {
        let [gx, gy] = height.gradient(x, y);
        libm::atan((gx * gx + gy * gy).sqrt()).to_degrees() as f32
    });
    let land = slope.data.iter().zip(&height.data).filter(|&(_, &h)| h as f64 > above_m);
    let mut sorted: Vec<f32> = land.map(|(&s, _)| s).collect();
    if sorted.is_empty() {
        return None;
    }
    sorted.par_sort_unstable_by(f32::total_cmp);
    let count = sorted.len() as f64;
    let mut histogram = vec![0.0; BINS];
    for &s in &sorted {
        histogram[((s as f64 / BIN_DEG) as usize).min(BINS - 1)] += 1.0;
    }
    histogram.iter_mut().for_each(|bin| *bin /= count);
    let (mean_deg, deviation_deg) = moments(&sorted);
    let tangents: Vec<f32> = sorted.iter().map(|&s| libm::tan((s as f64).to_radians()) as f32).collect();
    let (mean, deviation) = moments(&tangents);
    Some(Slopes {
        mean_deg,
        deviation_deg,
        erosion_score: (mean > 0.0).then(|| deviation / mean),
        max_deg: sorted[sorted.len() - 1] as f64,
        percentiles_deg: PERCENTILES.map(|p| (p, rank(&sorted, p as f64 / 100.0))).to_vec(),
        histogram,
    })
}

/// Mean and standard deviation.
fn moments(values: &[f32]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = sum_f64(values) / n;
    (mean, (values.iter().map(|&v| (v as f64 - mean) * (v as f64 - mean)).sum::<f64>() / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn a_plane_has_one_slope() {
        let grid = Grid::new(50, 40, 5000.0, Edges::Open);
        let plane = Field::from_fn(grid, |x, _| (x as f32 - 10.0) * 100.0);
        let slopes = slopes(&plane, -1e9).unwrap();
        assert!((slopes.mean_deg - 45.0).abs() < 1e-5 && (slopes.max_deg - 45.0).abs() < 1e-5);
        assert!(slopes.deviation_deg < 1e-5 && slopes.erosion_score.unwrap() < 1e-6);
        assert!(slopes.percentiles_deg.iter().all(|(_, s)| (s - 45.0).abs() < 1e-5));
        assert_eq!(slopes.histogram.iter().sum::<f64>(), 1.0);
        assert_eq!(super::slopes(&plane, 1e9), None);
    }

    #[test]
    fn only_the_land_is_counted() {
        let grid = Grid::new(64, 8, 64.0, Edges::Open);
        // A flat sea floor in the west, a slope of 1 in the east.
        let shore = Field::from_fn(grid, |x, _| if x < 32 { -5.0 } else { (x - 31) as f32 });
        let slopes = slopes(&shore, 2.5).unwrap();
        assert_eq!((slopes.histogram[9], slopes.percentiles_deg[0].1), (1.0, 45.0));
    }
}
