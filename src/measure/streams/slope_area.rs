//! Concavity: how slope falls with catchment area, `S = k·A^(−θ)` (Flint 1974), over channels.
//!
//! Slope from a channel cell to its receiver over the ground as it is; cells under a fill and the last step into the sea
//! are left out. Medians in five bins of area a decade, then a line through their logarithms.

use super::Network;
use crate::measure::{
    fit::{Line, log_bins, thinned},
    metric::Missing,
};

const BINS_PER_DECADE: f64 = 5.0;
const LEAST_IN_BIN: usize = 10;
const LEAST_BINS: usize = 4;

/// Slope against area.
#[derive(Clone, Debug)]
pub struct SlopeArea {
    /// Concavity θ.
    pub theta: f64,
    /// The law through the medians, in decimal logarithms.
    pub line: Line,
    /// Medians: `[area, m²; slope]`.
    pub medians: Vec<[f64; 2]>,
    /// Some of the cells: `[area, m²; slope]`.
    pub sample: Vec<[f64; 2]>,
}

/// `[area, m²; slope]` of the channel cells that count.
pub fn slope_area_points(network: &Network) -> Vec<[f64; 2]> {
    let counts = |&i: &usize| network.is_channel(i) && !network.is_flooded(i);
    let point = |i: usize| {
        let r = network.below(i)?;
        let slope = (network.height_m[i] - network.height_m[r]) / network.step_m[i];
        (slope > 0.0).then_some([network.area_m2[i], slope])
    };
    (0..network.receiver.len()).filter(counts).filter_map(point).collect()
}

/// The concavity that such points show.
pub fn slope_area(points: &[[f64; 2]]) -> Result<SlopeArea, Missing> {
    let medians = log_bins(points.iter().copied(), BINS_PER_DECADE, LEAST_IN_BIN);
    let few =
        Missing::TooFew { what: "classes of channel area with 10 cells", found: medians.len(), needed: LEAST_BINS };
    if medians.len() < LEAST_BINS {
        return Err(few);
    }
    let line = Line::through_logs(&medians).ok_or(few)?;
    Ok(SlopeArea { theta: -line.slope, line, medians, sample: thinned(points, 1200) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::streams::shapes::scheidegger;

    #[test]
    fn a_river_profile_at_steady_state_shows_its_exponent() {
        for theta in [0.3, 0.45, 0.6] {
            let mut network = scheidegger(200, 200);
            // Upwards from the outlets, each step as steep as the law says.
            for i in 0..network.receiver.len() {
                let r = network.receiver[i] as usize;
                let rise = if r == i { 0.0 } else { 5.0 * network.area_m2[i].powf(-theta) };
                network.height_m[i] = network.height_m[r] + rise;
            }
            network.surface_m = network.height_m.clone();
            network.threshold_m2 = 20.0;
            let found = slope_area(&slope_area_points(&network)).unwrap();
            // Slopes are exact; only median against mean of the logarithms within a bin differ.
            assert!((found.theta - theta).abs() < 0.01, "{theta} {}", found.theta);
        }
    }

    #[test]
    fn a_few_cells_are_no_law() {
        let why = slope_area(&[[1e6, 0.1]; 5]).unwrap_err().to_string();
        assert_eq!(why, "too few classes of channel area with 10 cells: 0, at least 4 needed");
    }
}
