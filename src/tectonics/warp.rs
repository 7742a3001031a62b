//! The one bend through which the map reads the plates, so that borders, ranges, trenches and coasts curve together.
//!
//! `q(p) = p + s·(f₁(p), f₂(p))` with two independent fractal sums. Fold-free where `det(I + s·J) > 0`; `s` is lowered until
//! the determinant is at least `LEAST_DETERMINANT` on a lattice that does not depend on the map's grid.

use glam::DVec2;

use crate::noise::{Basis, Fbm, Key, Octaves};

/// Longest bend as a share of the map's longer side.
const WAVELENGTH: f64 = 0.6;
/// Octaves of the bend: from a third of the map to its hundredth.
const OCTAVES: f64 = 6.0;
/// Smallest area factor left.
const LEAST_DETERMINANT: f64 = 0.15;
/// Points a side at which folding is looked for: a quarter of the shortest bend.
const PROBES: usize = 160;

/// A fold-free displacement of the plane.
#[derive(Clone, Debug)]
pub struct Warp {
    parts: [Octaves; 2],
    amplitude_m: f64,
}

impl Warp {
    /// Bends by about `bend` of the map's longer side, less where that would fold.
    pub fn new(map_m: DVec2, bend: f64, key: Key) -> Self {
        let side = map_m.max_element();
        let fbm = Fbm { octaves: Some(OCTAVES), basis: Basis::Gradient, ..Fbm::new(WAVELENGTH * side, 1.15) };
        let parts = [fbm.octaves(key.named("east"), 0.0), fbm.octaves(key.named("south"), 0.0)];
        let mut warp = Self { parts, amplitude_m: bend * side };
        let slopes: Vec<[DVec2; 2]> = (0..PROBES * PROBES)
            .map(|i| {
                let at = DVec2::new((i % PROBES) as f64 + 0.5, (i / PROBES) as f64 + 0.5) / PROBES as f64 * map_m;
                [0, 1].map(|k| DVec2::from(warp.parts[k].gradient(at.into()).1))
            })
            .collect();
        let folds = |s: f64| slopes.iter().any(|j| determinant(j, s) < LEAST_DETERMINANT);
        while warp.amplitude_m > 0.0 && folds(warp.amplitude_m) {
            warp.amplitude_m *= 0.97;
        }
        warp
    }

    /// Where the map at `at_m` reads the plates.
    pub fn read_at(&self, at_m: DVec2) -> DVec2 {
        let at = at_m.into();
        at_m + self.amplitude_m * DVec2::new(self.parts[0].value(at), self.parts[1].value(at))
    }

    /// `read_at`, and the slope that a surface of slope `slope_of(q)` in the plates has on the map.
    pub fn read_with_jacobian(&self, at_m: DVec2) -> (DVec2, [DVec2; 2]) {
        let (x, gx) = self.parts[0].gradient(at_m.into());
        let (y, gy) = self.parts[1].gradient(at_m.into());
        let s = self.amplitude_m;
        let rows = [DVec2::X + s * DVec2::from(gx), DVec2::Y + s * DVec2::from(gy)];
        (at_m + s * DVec2::new(x, y), rows)
    }

    /// The map point that reads a point of the plates; Newton's method, good to a metre.
    pub fn shown_at(&self, q_m: DVec2) -> DVec2 {
        let mut p = q_m;
        for _ in 0..20 {
            let (at, rows) = self.read_with_jacobian(p);
            let error = q_m - at;
            if error.length() < 1.0 {
                break;
            }
            let det = rows[0].perp_dot(rows[1]);
            let step = DVec2::new(rows[1].y * error.x - rows[0].y * error.y, rows[0].x * error.y - rows[1].x * error.x) / det;
            // A step longer than twice the error would be one across a near fold.
            p += step.clamp_length_max(2.0 * error.length());
        }
        p
    }
}

fn determinant(rows: &[DVec2; 2], s: f64) -> f64 {
    (1.0 + s * rows[0].x) * (1.0 + s * rows[1].y) - s * rows[0].y * s * rows[1].x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_folds_and_inverts() {
        for seed in 0..12 {
            let map = DVec2::new(1_000e3, 700e3);
            let warp = Warp::new(map, 0.2, Key::new(seed));
            let mut stream = Key::new(seed).stream();
            for _ in 0..3000 {
                let p = DVec2::new(stream.unit(), stream.unit()) * map;
                let (q, rows) = warp.read_with_jacobian(p);
                assert!(rows[0].x * rows[1].y - rows[0].y * rows[1].x > 0.0, "folds at {p}");
                assert_eq!(q, warp.read_at(p));
            }
            let p = map * 0.4;
            assert!((warp.shown_at(warp.read_at(p)) - p).length() < 20.0);
        }
    }
}
