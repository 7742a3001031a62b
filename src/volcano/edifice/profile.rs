//! The noise-free shape of a volcano: height over the distance from its axis, with its exact slope.
//!
//! Inside the crater, `h_c + (h_v − h_c)·S(r/r_c)` with `S(t) = 3t² − 2t³`. Outside, one of three flanks of height `h_v` at
//! the rim; all leave it level, so that the surface is continuous in height and slope and highest there:
//!
//! - smoothstep, `h_v·(1 − S((r − r_c)/(τ·r_v − r_c)))`, is 0 from `τ·r_v` on;
//! - Gaussian, `h_v·exp(−(2(r − r_c)/r_v)²)`;
//! - exponential, `h_v·exp(−4u/r_v)` with `u = √((r − r_c)² + w²) − w`: as steep towards the top as a stratocone, its rim
//!   rounded over `w`, a quarter of the crater's radius. The last two have 2 % of their height left at `r_v` from the rim.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The form of a volcano's flank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// Steepest half-way down, and ends: `transition` times the radius away there is nothing of it.
    Smoothstep,
    /// Steepest near the top, with a long foot: a bell.
    Gaussian,
    /// Steeper and steeper towards the rim, like a stratocone.
    #[default]
    Exponential,
}

/// A noise-free volcano, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Height of the rim above the foot.
    pub height_m: f64,
    /// Radius of the edifice.
    pub radius_m: f64,
    /// Height of the crater's floor above the foot.
    pub crater_height_m: f64,
    /// Radius of the rim; 0 for a volcano without a crater.
    pub crater_radius_m: f64,
    /// Where a smoothstep flank ends, in radii.
    pub transition: f64,
    /// The flank.
    pub profile: Profile,
}

/// Width over which the rim of an exponential volcano is rounded, in radii of its crater, and in its own at the least.
const RIM: f64 = 0.25;
const TOP: f64 = 0.01;

impl Cone {
    /// Height above the foot at a distance from the axis, and its derivative.
    #[inline]
    pub fn at(&self, r_m: f64) -> (f64, f64) {
        let (h, rim) = (self.height_m, self.crater_radius_m);
        if r_m < rim {
            let (s, rise) = step(r_m / rim);
            let deep = h - self.crater_height_m;
            return (self.crater_height_m + deep * s, deep * rise / rim);
        }
        let out = r_m - rim;
        match self.profile {
            Profile::Smoothstep => {
                let width = self.transition * self.radius_m - rim;
                let (s, rise) = step(out / width);
                (h * (1.0 - s), -h * rise / width)
            }
            Profile::Gaussian => {
                let t = 2.0 * out / self.radius_m;
                let z = h * libm::exp(-t * t);
                (z, -4.0 * t / self.radius_m * z)
            }
            Profile::Exponential => {
                let round = (RIM * rim).max(TOP * self.radius_m);
                let far = (out * out + round * round).sqrt();
                let z = h * libm::exp(-4.0 * (far - round) / self.radius_m);
                (z, -4.0 / self.radius_m * (out / far) * z)
            }
        }
    }

    /// The same shape, all lengths times `by`.
    pub fn scaled(self, by: f64) -> Self {
        Self {
            height_m: by * self.height_m,
            radius_m: by * self.radius_m,
            crater_height_m: by * self.crater_height_m,
            crater_radius_m: by * self.crater_radius_m,
            ..self
        }
    }

    /// How far from the axis its noise and most of its height end.
    pub fn reach_m(&self) -> f64 {
        self.transition * self.radius_m
    }
}

/// Smoothstep and its derivative.
fn step(t: f64) -> (f64, f64) {
    let t = t.clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Profile; 3] = [Profile::Smoothstep, Profile::Gaussian, Profile::Exponential];

    /// The document's example scene.
    fn example(profile: Profile) -> Cone {
        Cone { height_m: 43.0, radius_m: 59.0, crater_height_m: 34.0, crater_radius_m: 8.0, transition: 1.8, profile }
    }

    #[test]
    fn heights_at_floor_rim_and_end_are_those_asked_for() {
        for profile in ALL {
            let cone = example(profile);
            assert_eq!((cone.at(0.0), cone.at(8.0)), ((34.0, 0.0), (43.0, 0.0)), "{profile:?}");
        }
        assert_eq!(example(Profile::Smoothstep).at(1.8 * 59.0), (0.0, -0.0));
        assert!((example(Profile::Gaussian).at(8.0 + 59.0).0 - 43.0 * (-4.0f64).exp()).abs() < 1e-12);
        // Half-way down a smoothstep is half of the height.
        assert!((example(Profile::Smoothstep).at(8.0 + 0.5 * (1.8 * 59.0 - 8.0)).0 - 21.5).abs() < 1e-12);
    }

    #[test]
    fn height_and_slope_are_continuous_and_the_slope_is_exact() {
        for cone in ALL.map(example).into_iter().chain(ALL.map(|p| Cone { crater_radius_m: 0.0, ..example(p) })) {
            let ends = [cone.crater_radius_m, cone.radius_m, cone.reach_m()];
            let step = 1e-5;
            for r in ends.into_iter().chain((1..2000).map(|i| 0.1 * i as f64)).filter(|r| *r > step) {
                let ((below, before), (above, after)) = (cone.at(r - step), cone.at(r + step));
                // Curvature is at most 12·9/8² = 1.7 in the crater and 4·43/(59·2) = 1.5 at the rounded rim.
                assert!((above - below).abs() < 2.0 * step * 5.0, "{cone:?} at {r}");
                assert!((after - before).abs() < 2.0 * step * 5.0, "{cone:?} at {r}: {before}, {after}");
                assert!(((above - below) / (2.0 * step) - cone.at(r).1).abs() < 1e-4, "{cone:?} at {r}");
            }
        }
    }

    #[test]
    fn nothing_is_higher_than_the_rim() {
        for cone in ALL.map(example) {
            let highest = (0..4000).map(|i| 0.05 * i as f64).max_by(|a, b| cone.at(*a).0.total_cmp(&cone.at(*b).0));
            assert!((highest.unwrap() - cone.crater_radius_m).abs() < 1e-9, "{cone:?}: {highest:?}");
            // Down and nothing but down outside, up inside.
            assert!((1..160).all(|i| cone.at(0.05 * i as f64).1 > 0.0));
            assert!((161..4000).all(|i| cone.at(0.05 * i as f64).1 <= 0.0));
        }
    }
}
