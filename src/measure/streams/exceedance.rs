//! Area exceedance: the share of the land that drains more than an area, `P(A > a) ∝ a^(−β)` (Rodriguez-Iturbe et al. 1992).
//!
//! Read at ten areas a decade from the channels' threshold to a twentieth of the largest catchment: near the largest the
//! size of the map speaks, not the network.

use super::Network;
use crate::measure::{fit::Line, metric::Missing, streams::TRUNKS};

const STEPS_PER_DECADE: f64 = 10.0;
/// Half a decade.
const LEAST_STEPS: usize = 6;

/// Shares of the land by catchment.
#[derive(Clone, Debug)]
pub struct Exceedance {
    /// The exponent β.
    pub beta: f64,
    /// The law, in decimal logarithms of km².
    pub line: Line,
    /// `[area, km²; share of the land that drains more]`, beyond the fit as well.
    pub curve: Vec<[f64; 2]>,
    /// Areas between which the law was fitted, km².
    pub fitted_km2: [f64; 2],
}

/// The exponent of a network.
pub fn exceedance(network: &Network) -> Result<Exceedance, Missing> {
    let cells = 0..network.receiver.len();
    let mut areas: Vec<f64> = cells.filter(|&i| network.land[i]).map(|i| network.area_m2[i]).collect();
    areas.sort_unstable_by(f64::total_cmp);
    let largest = *areas.last().ok_or(Missing::NoLand)?;
    let share = |a: f64| (areas.len() - areas.partition_point(|&x| x <= a)) as f64 / areas.len() as f64;
    let steps = (libm::log10(largest / network.cell_m2) * STEPS_PER_DECADE).floor() as i32;
    let area = |step: i32| network.cell_m2 * libm::exp10(step as f64 / STEPS_PER_DECADE);
    let curve: Vec<[f64; 2]> = (0..=steps).map(|s| [area(s) * 1e-6, share(area(s))]).filter(|p| p[1] > 0.0).collect();
    let fitted_km2 = [network.threshold_m2 * 1e-6, TRUNKS * largest * 1e-6];
    let inside = |p: &&[f64; 2]| p[0] >= fitted_km2[0] && p[0] <= fitted_km2[1];
    let fitted: Vec<[f64; 2]> = curve.iter().filter(inside).copied().collect();
    let few = Missing::TooFew { what: "tenths of a decade of catchments", found: fitted.len(), needed: LEAST_STEPS };
    if fitted.len() < LEAST_STEPS {
        return Err(few);
    }
    let line = Line::through_logs(&fitted).ok_or(few)?;
    Ok(Exceedance { beta: -line.slope, line, curve, fitted_km2 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::streams::shapes::{peano, scheidegger};

    #[test]
    fn peano_one_half_and_scheidegger_one_third() {
        let mut network = peano(10);
        network.threshold_m2 = 20.0;
        let found = exceedance(&network).unwrap();
        // Areas come in powers of 4, so the curve is a staircase.
        assert!((found.beta - 0.5).abs() < 0.03, "{}", found.beta);
        let mut network = scheidegger(2000, 1000);
        network.threshold_m2 = 20.0;
        // The upper rows have too few above them to gather much.
        (500 * 2000..1000 * 2000).for_each(|i| network.land[i] = false);
        let found = exceedance(&network).unwrap();
        assert!((found.beta - 1.0 / 3.0).abs() < 0.03, "{}", found.beta);
    }

    #[test]
    fn a_small_network_says_so() {
        let why = exceedance(&peano(2)).unwrap_err().to_string();
        assert!(why.starts_with("too few tenths of a decade"), "{why}");
    }
}
