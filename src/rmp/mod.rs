//! Numerics of "repeated magnification and probing" (Kamal and Uddin 2007): draw a new random partition of the plane,
//! raise the cells that a peak or a ridge line visits, repeat. Two partitions: a Poisson-Voronoi mosaic ([`cells_along`], [`Probe`])
//! and an arrangement of random lines ([`Arrangement`]). [`Brush`] and [`raise`] turn cells into raster values.
//!
//! This room draws partitions and covers raster cells. How high, how often and why is the caller's.
//!
//! What to expect of the Voronoi form, with `u = d·√λ` for a distance `d` and `λ` sites a square metre: the mean profile
//! is `p(u)`, the chance that two points a distance apart share a cell, close to `exp(−1.16 u − 0.96 u²)`; half of the
//! height is reached at `d = 0.442/√λ`; one draw at a point raises `1.28/λ` in the mean, one along a segment of length
//! `L` visits `1 + (4/π)·√λ·L` cells.

mod arrangement;
mod brush;
mod voronoi;

pub use arrangement::{Arrangement, Face, Order};
pub use brush::{Brush, Raised, raise};
pub use voronoi::{Probe, cells_along};

/// One cell of a random partition that is to be raised.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Corners of the convex cell in order, m.
    pub outline: Vec<[f64; 2]>,
    /// The cell's random weight in (0, 1], the length of a random colour as a share of white; its mean is
    /// [`MEAN_WEIGHT`].
    pub weight: f64,
}

/// Mean of a cell's weight: the mean distance of a point in the unit cube from a corner,
/// `√3/4 + ln(2 + √3)/2 − π/24`, over `√3`.
pub const MEAN_WEIGHT: f64 = 0.554_598_024;

/// `d·√λ` at which the mean profile of the Voronoi form has fallen to one half.
const HALF_HEIGHT_U: f64 = 0.442;

/// Sites per m² whose mountains fall to half their height at `half_width_m` from the peak or ridge line.
pub fn density_for_half_width(half_width_m: f64) -> f64 {
    (HALF_HEIGHT_U / half_width_m) * (HALF_HEIGHT_U / half_width_m)
}

/// The distance, m, at which mountains drawn with this density of sites fall to half their height.
pub fn half_width_for_density(sites_per_m2: f64) -> f64 {
    HALF_HEIGHT_U / sites_per_m2.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_and_density_are_inverse() {
        for width in [10.0, 4321.0, 250e3] {
            assert!((half_width_for_density(density_for_half_width(width)) / width - 1.0).abs() < 1e-14);
        }
        // 100 sites on a square map: the half width is 4.42 % of its side.
        assert!((half_width_for_density(100.0 / 1e10) - 4420.0).abs() < 1e-9);
    }

    #[test]
    fn mean_weight_is_the_closed_form() {
        let root = 3f64.sqrt();
        let mean = (root / 4.0 + (2.0 + root).ln() / 2.0 - std::f64::consts::PI / 24.0) / root;
        assert!((mean - MEAN_WEIGHT).abs() < 1e-8, "{mean}");
    }
}
