//! How much of the area stands how high (Strahler 1952; Pike and Wilson 1971).

use rayon::prelude::*;
use serde::Serialize;

use crate::grid::sum_f64;

/// Points on the curve: every 5 % of the area.
const POINTS: usize = 21;

/// The hypsometric curve and its integral.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hypsometry {
    /// (mean − lowest)/(highest − lowest): 1/2 for a plane, 1/3 for a cone, 2/3 for a hemisphere; `None` where it is
    /// flat.
    pub integral: Option<f64>,
    /// `[share of the area, height]`: that share of the area stands at this height or higher, m.
    pub curve: Vec<[f64; 2]>,
}

/// The hypsometry of a sample of heights; `None` of none.
pub fn hypsometry(heights: &[f32]) -> Option<Hypsometry> {
    if heights.is_empty() {
        return None;
    }
    let mut sorted = heights.to_vec();
    sorted.par_sort_unstable_by(|a, b| b.total_cmp(a));
    let (high, low) = (sorted[0] as f64, sorted[sorted.len() - 1] as f64);
    let mean = sum_f64(heights) / heights.len() as f64;
    let curve = (0..POINTS)
        .map(|i| {
            let share = i as f64 / (POINTS - 1) as f64;
            [share, rank(&sorted, share)]
        })
        .collect();
    Some(Hypsometry { integral: (high > low).then(|| (mean - low) / (high - low)), curve })
}

/// The value at a share of a sorted sample, linear between neighbours.
pub(super) fn rank(sorted: &[f32], share: f64) -> f64 {
    let at = share * (sorted.len() - 1) as f64;
    let (i, t) = (at as usize, at.fract());
    let (a, b) = (sorted[i] as f64, sorted[(i + 1).min(sorted.len() - 1)] as f64);
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 401;

    /// Heights over the unit disc, sampled at cell centres.
    fn disc(height: impl Fn(f64) -> f64) -> Hypsometry {
        let at = |i: usize| (i as f64 + 0.5) / N as f64 * 2.0 - 1.0;
        let cells = (0..N * N).map(|i| (at(i % N).powi(2) + at(i / N).powi(2)).sqrt());
        hypsometry(&cells.filter(|&r| r <= 1.0).map(|r| height(r) as f32).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn integrals_of_known_bodies() {
        let plane: Vec<f32> = (0..N * N).map(|i| (i % N) as f32).collect();
        let plane = hypsometry(&plane).unwrap();
        assert!((plane.integral.unwrap() - 0.5).abs() < 1e-12);
        // The rim cuts cells of size 2/N: an error of that order.
        assert!((disc(|r| 1.0 - r).integral.unwrap() - 1.0 / 3.0).abs() < 2.0 / N as f64);
        // The lowest sample stands sqrt(4/N) high at worst, which lifts the bottom of the scale.
        let hemisphere = disc(|r| (1.0 - r * r).max(0.0).sqrt()).integral.unwrap();
        assert!((hemisphere - 2.0 / 3.0).abs() < 0.01, "{hemisphere}");
        assert_eq!(hypsometry(&[3.0, 3.0]).unwrap().integral, None);
        assert_eq!(hypsometry(&[]), None);
    }

    #[test]
    fn the_curve_of_a_cone_is_one_minus_a_root() {
        for [share, height] in disc(|r| 1.0 - r).curve {
            assert!((height - (1.0 - share.sqrt())).abs() < 2.0 / N as f64, "{share} {height}");
        }
    }
}
