//! Hack's law: the longest stream of a basin grows with its area, `L = c·A^h` (Hack 1957; Rigon et al. 1996).
//!
//! Every channel cell closes a basin of its own: nested basins. L is the longest way of water down to the cell, its own
//! width included. Medians of L in five bins of area a decade, then a line through their logarithms, up to a twentieth of
//! the largest basin: beyond, all cells are of the same few trunks, and it is those that speak, not the law.

use super::Network;
use crate::measure::{
    fit::{Line, log_bins, thinned},
    metric::Missing,
    streams::TRUNKS,
};

const BINS_PER_DECADE: f64 = 5.0;
const LEAST_IN_BIN: usize = 20;
const LEAST_BINS: usize = 4;

/// Length against area.
#[derive(Clone, Debug)]
pub struct Hack {
    /// Hack's exponent h.
    pub exponent: f64,
    /// The law through the medians, in decimal logarithms of km² and km.
    pub line: Line,
    /// Medians: `[area, km²; length, km]`.
    pub medians: Vec<[f64; 2]>,
    /// Some basins: `[area, km²; length, km]`.
    pub sample: Vec<[f64; 2]>,
    /// Areas between which the law was fitted, km².
    pub fitted_km2: [f64; 2],
}

/// The law that the nested basins of a network follow.
pub fn hack(network: &Network) -> Result<Hack, Missing> {
    let mut length_m = vec![network.cell_m2.sqrt(); network.receiver.len()];
    for &i in network.order.iter().rev() {
        let i = i as usize;
        if let Some(r) = network.below(i) {
            length_m[r] = length_m[r].max(length_m[i] + network.step_m[i]);
        }
    }
    let channels = (0..length_m.len()).filter(|&i| network.is_channel(i));
    let points: Vec<[f64; 2]> = channels.map(|i| [network.area_m2[i] * 1e-6, length_m[i] * 1e-3]).collect();
    let medians = log_bins(points.iter().copied(), BINS_PER_DECADE, LEAST_IN_BIN);
    let largest = points.iter().map(|p| p[0]).fold(0.0, f64::max);
    let fitted_km2 = [network.threshold_m2 * 1e-6, TRUNKS * largest];
    let fitted: Vec<[f64; 2]> = medians.iter().copied().filter(|p| p[0] <= fitted_km2[1]).collect();
    let few = Missing::TooFew { what: "classes of basin area with 20 basins", found: fitted.len(), needed: LEAST_BINS };
    if fitted.len() < LEAST_BINS {
        return Err(few);
    }
    let line = Line::through_logs(&fitted).ok_or(few)?;
    Ok(Hack { exponent: line.slope, line, medians, sample: thinned(&points, 1200), fitted_km2 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::streams::shapes::{forest, scheidegger};

    #[test]
    fn scheideggers_network_has_two_thirds() {
        let mut network = scheidegger(2000, 1000);
        network.threshold_m2 = 20.0;
        let found = hack(&network).unwrap();
        // From class to class the slope falls from 0.70 at 20 cells, where basins are a few rows long, to 0.65.
        assert!((found.exponent - 2.0 / 3.0).abs() < 0.02, "{}", found.exponent);
    }

    #[test]
    fn a_single_thread_has_one() {
        // No side streams: the area is the length.
        let thread = forest((0..5000u32).map(|i| i.saturating_sub(1)).collect(), |_| 1.0);
        let found = hack(&thread).unwrap();
        assert!((found.exponent - 1.0).abs() < 0.01, "{}", found.exponent);
    }
}
