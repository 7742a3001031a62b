//! The column as a sum of Gaussians on the ground, a size of grains and a height each.

use super::params::AshParams;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.80665;
/// Density of air half way up a usual column, kg/m³, and its viscosity, Pa·s.
const AIR: f64 = 0.8;
const AIR_PA_S: f64 = 1.7e-5;
/// Sizes of grains: so many a doubling, over so many standard deviations to either side.
const SIZES_PER_PHI: f64 = 2.0;
const DEVIATIONS: f64 = 2.5;
/// Heights that grains of a size are let go at, at least and at most.
const HEIGHTS: [usize; 2] = [24, 400];
/// Greatest distance of two Gaussians of a size beside each other, in their own widths.
const APART: f64 = 0.7;

/// What falls of one size from one height: a round Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fall {
    /// Its share of all.
    pub(super) share: f64,
    /// How far downwind its middle lies, m.
    pub(super) drift_m: f64,
    /// Its standard deviation, m.
    pub(super) sigma_m: f64,
}

/// Terminal velocity of a grain, m/s: the least of those of creeping, intermediate and turbulent flow about it (Kunii and
/// Levenspiel's laws, as Bonadonna and Phillips, J. Geophys. Res. 108 (2003), use them).
pub(super) fn terminal_m_per_s(size_m: f64, density: f64) -> f64 {
    let pull = density * GRAVITY;
    let creeping = pull * size_m * size_m / (18.0 * AIR_PA_S);
    let between = size_m * libm::cbrt(4.0 * pull * pull / (225.0 * AIR_PA_S * AIR));
    let turbulent = libm::sqrt(3.1 * pull * size_m / AIR);
    creeping.min(between).min(turbulent)
}

impl AshParams {
    /// All that falls; the shares' sum is 1.
    pub(super) fn falls(&self) -> Vec<Fall> {
        let mut falls = Vec::new();
        let sizes = self.sizes();
        let grains: f64 = sizes.iter().map(|size| size.1).sum();
        for (size_m, share) in sizes {
            self.of_size(terminal_m_per_s(size_m, self.grain_kg_per_m3), share / grains, &mut falls);
        }
        falls
    }

    /// Sizes of grains, m, and their weights.
    fn sizes(&self) -> Vec<(f64, f64)> {
        let steps = (DEVIATIONS * self.spread_phi * SIZES_PER_PHI).ceil() as i32;
        let phi = |k: i32| f64::from(k) / SIZES_PER_PHI;
        let weight = |k: i32| {
            let off = phi(k) / self.spread_phi.max(1e-9);
            libm::exp(-0.5 * off * off)
        };
        (-steps..=steps).map(|k| (1e-3 * self.median_mm * libm::exp2(phi(k)), weight(k))).collect()
    }

    fn of_size(&self, speed: f64, share: f64, falls: &mut Vec<Fall>) {
        let top_m = 1e3 * self.column_km;
        let sigma_m = |z: f64| {
            let spread = 2.0 * self.diffusivity_m2_per_s * z / speed;
            libm::sqrt(self.width * z * (self.width * z) + spread)
        };
        // As many as the way of the highest needs, at the width of one half way up.
        let way_m = self.wind_m_per_s * top_m / speed;
        let wanted = (way_m / (APART * sigma_m(0.5 * top_m))).ceil().min(HEIGHTS[1] as f64) as usize;
        let heights = wanted.max(HEIGHTS[0]);
        let weight = |k: usize| {
            let t = (k as f64 + 0.5) / heights as f64;
            (1.0 - t) * libm::exp(self.top_heavy * (t - 1.0))
        };
        let whole: f64 = (0..heights).map(weight).sum();
        for k in 0..heights {
            let z = top_m * (k as f64 + 0.5) / heights as f64;
            let drift_m = self.wind_m_per_s * z / speed;
            falls.push(Fall { share: share * weight(k) / whole, drift_m, sigma_m: sigma_m(z) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grains_fall_by_the_law_of_their_size() {
        // 30 µm creep, by Stokes; a bomb of 6 cm by the square root.
        let pull = 1000.0 * GRAVITY;
        let stokes = pull * 9e-10 / (18.0 * AIR_PA_S);
        assert!((terminal_m_per_s(3e-5, 1000.0) / stokes - 1.0).abs() < 1e-12);
        let newton = (3.1 * pull * 0.064 / AIR).sqrt();
        assert!((terminal_m_per_s(0.064, 1000.0) / newton - 1.0).abs() < 1e-12);
        // Half a millimetre: some 2 to 4 m/s.
        assert!((2.0..4.0).contains(&terminal_m_per_s(5e-4, 1000.0)), "{}", terminal_m_per_s(5e-4, 1000.0));
    }

    #[test]
    fn all_falls_and_finer_grains_fall_further() {
        let ash = AshParams::default();
        let falls = ash.falls();
        assert!((falls.iter().map(|fall| fall.share).sum::<f64>() - 1.0).abs() < 1e-12);
        let mean = |ash: &AshParams| ash.falls().iter().map(|fall| fall.share * fall.drift_m).sum::<f64>();
        assert!(mean(&AshParams { median_mm: 0.1, ..ash.clone() }) > 2.0 * mean(&ash));
        // One size: its mean drift is wind/speed times the mean of Suzuki's heights, here by Simpson's rule.
        let one = AshParams { spread_phi: 0.0, ..ash.clone() };
        let density = |t: f64| (1.0 - t) * (4.0 * (t - 1.0)).exp();
        let simpson = |f: &dyn Fn(f64) -> f64| {
            (0..=1000)
                .map(|k| f(k as f64 * 1e-3) * [1.0, 4.0, 2.0][if k % 1000 == 0 { 0 } else { 2 - k % 2 }])
                .sum::<f64>()
        };
        let height = 12e3 * simpson(&|t| t * density(t)) / simpson(&density);
        let want = 10.0 / terminal_m_per_s(5e-4, 1000.0) * height;
        assert!((mean(&one) / want - 1.0).abs() < 2e-3, "{} {want}", mean(&one));
    }
}
