//! Area exceedance: the share of a basin that drains more than an area, `P(A > a) ∝ a^(−β)` (Rodriguez-Iturbe et al. 1992).
//!
//! Basin by basin, the twelve largest, and the median of their exponents: over a whole map the many small basins of the
//! coast would bend the law. Read at ten areas a decade from the channels' threshold to a twentieth of the basin, near
//! whose own size its shape speaks, not the network.

use super::Network;
use crate::measure::{
    fit::{Line, median},
    metric::Missing,
    streams::TRUNKS,
};

const STEPS_PER_DECADE: f64 = 10.0;
/// Half a decade.
const LEAST_STEPS: usize = 6;
/// Basins that are looked at, from the largest.
const MOST_BASINS: usize = 12;

/// Shares of basins by catchment.
#[derive(Clone, Debug)]
pub struct Exceedance {
    /// The exponent β, the median of the basins'.
    pub beta: f64,
    /// Basins counted.
    pub basins: usize,
    /// The law of the largest basin, in decimal logarithms of km².
    pub line: Line,
    /// Of the largest basin: `[area, km²; share of it that drains more]`, beyond the fit as well.
    pub curve: Vec<[f64; 2]>,
    /// Areas between which its law was fitted, km².
    pub fitted_km2: [f64; 2],
}

/// The exponent of a network.
pub fn exceedance(network: &Network) -> Result<Exceedance, Missing> {
    let mouths = network.mouths();
    let mut cells: Vec<(u32, f64)> =
        (0..mouths.len()).filter_map(|i| mouths[i].map(|mouth| (mouth, network.area_m2[i]))).collect();
    if cells.is_empty() {
        return Err(Missing::NoLand);
    }
    cells.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut basins: Vec<&[(u32, f64)]> = cells.chunk_by(|a, b| a.0 == b.0).collect();
    basins.sort_by_key(|basin| (std::cmp::Reverse(basin.len()), basin[0].0));
    basins.truncate(MOST_BASINS);
    let mut found: Vec<Exceedance> = Vec::new();
    let mut longest = 0;
    for basin in basins {
        match of_basin(basin, network.cell_m2, network.threshold_m2) {
            Ok(one) => found.push(one),
            Err(steps) => longest = longest.max(steps),
        }
    }
    let beta = median(&found.iter().map(|one| one.beta).collect::<Vec<_>>());
    let basins = found.len();
    let few = Missing::TooFew { what: "tenths of a decade of catchments", found: longest, needed: LEAST_STEPS };
    let largest = found.into_iter().next().ok_or_else(|| few.clone())?;
    Ok(Exceedance { beta: beta.ok_or(few)?, basins, ..largest })
}

/// The law of one basin, its cells by mouth and rising area; else how many steps it has.
fn of_basin(basin: &[(u32, f64)], cell_m2: f64, threshold_m2: f64) -> Result<Exceedance, usize> {
    let largest = basin[basin.len() - 1].1;
    let share = |a: f64| (basin.len() - basin.partition_point(|cell| cell.1 <= a)) as f64 / basin.len() as f64;
    let steps = (libm::log10(largest / cell_m2) * STEPS_PER_DECADE).floor() as i32;
    let area = |step: i32| cell_m2 * libm::exp10(step as f64 / STEPS_PER_DECADE);
    let curve: Vec<[f64; 2]> = (0..=steps).map(|s| [area(s) * 1e-6, share(area(s))]).filter(|p| p[1] > 0.0).collect();
    let fitted_km2 = [threshold_m2 * 1e-6, TRUNKS * largest * 1e-6];
    let inside = |p: &&[f64; 2]| p[0] >= fitted_km2[0] && p[0] <= fitted_km2[1];
    let fitted: Vec<[f64; 2]> = curve.iter().filter(inside).copied().collect();
    match Line::through_logs(&fitted) {
        Some(line) if fitted.len() >= LEAST_STEPS => {
            Ok(Exceedance { beta: -line.slope, basins: 1, line, curve, fitted_km2 })
        }
        _ => Err(fitted.len()),
    }
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
