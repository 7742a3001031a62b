//! χ: distance upstream, stretched so that a river at steady state is a straight line (Perron and Royden 2013).
//!
//! `χ = ∫ (A₀/A)^θ dx` from the mouth upwards with the reference concavity 0.45 and A₀ = 1 m², so that the slope of height
//! over χ is the steepness `k_sn` (Wobus et al. 2006). Basin by basin, all tributaries: medians over the largest basins.

use super::Network;
use crate::measure::{
    fit::{Line, median, thinned},
    metric::Missing,
};

/// Reference concavity.
pub const THETA_REF: f64 = 0.45;
/// Basins that are looked at, from the largest.
const MOST_BASINS: usize = 12;
/// Channel cells that a basin has at least.
const LEAST_CELLS: usize = 50;

/// Height against χ.
#[derive(Clone, Debug)]
pub struct Chi {
    /// Median over basins of the share of height's variance that χ explains.
    pub r2: f64,
    /// Median steepness, m^0.9.
    pub steepness: f64,
    /// Basins counted.
    pub basins: usize,
    /// Some channel cells of the largest basin: `[χ, m; height above the mouth, m]`.
    pub sample: Vec<[f64; 2]>,
    /// The line through all of that basin.
    pub line: Line,
}

/// χ of every channel cell, m; 0 at the mouths.
fn chi_m(network: &Network) -> Vec<f64> {
    let mut chi = vec![0.0; network.receiver.len()];
    for &i in &network.order {
        let i = i as usize;
        if network.is_channel(i)
            && let Some(r) = network.below(i)
        {
            chi[i] = chi[r] + libm::pow(network.area_m2[i], -THETA_REF) * network.step_m[i];
        }
    }
    chi
}

/// How straight the rivers are over χ, and how steep.
pub fn chi(network: &Network) -> Result<Chi, Missing> {
    let chi = chi_m(network);
    let mouths = network.mouths();
    let mut cells: Vec<(u32, u32)> = (0..chi.len() as u32)
        .filter(|&i| network.is_channel(i as usize))
        .filter_map(|i| mouths[i as usize].map(|mouth| (mouth, i)))
        .collect();
    cells.sort_unstable();
    let mut basins: Vec<&[(u32, u32)]> =
        cells.chunk_by(|a, b| a.0 == b.0).filter(|basin| basin.len() >= LEAST_CELLS).collect();
    basins.sort_by_key(|basin| (std::cmp::Reverse(basin.len()), basin[0].0));
    basins.truncate(MOST_BASINS);
    let mut found = Vec::new();
    for basin in &basins {
        let base = network.surface_m[basin[0].0 as usize];
        let points: Vec<[f64; 2]> =
            basin.iter().map(|&(_, i)| [chi[i as usize], network.surface_m[i as usize] - base]).collect();
        let level = points.iter().all(|p| p[1] == points[0][1]);
        if let Some(line) = Line::through(&points).filter(|_| !level) {
            found.push((line, points));
        }
    }
    let few = Missing::TooFew { what: "basins with 50 channel cells", found: found.len(), needed: 1 };
    let Some((line, points)) = found.first() else { return Err(few) };
    let middle = |of: fn(&Line) -> f64| median(&found.iter().map(|(line, _)| of(line)).collect::<Vec<_>>());
    let (r2, steepness) = (middle(|l| l.r2).unwrap_or(line.r2), middle(|l| l.slope).unwrap_or(line.slope));
    Ok(Chi { r2, steepness, basins: found.len(), sample: thinned(points, 1200), line: *line })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::streams::shapes::{peano, scheidegger};

    #[test]
    fn at_steady_state_chi_is_straight_and_its_slope_the_steepness() {
        let mut network = scheidegger(400, 400);
        for i in 0..network.receiver.len() {
            let r = network.receiver[i] as usize;
            let rise = if r == i { 0.0 } else { 7.0 * network.area_m2[i].powf(-THETA_REF) };
            network.surface_m[i] = network.surface_m[r] + rise;
        }
        network.threshold_m2 = 20.0;
        let found = chi(&network).unwrap();
        assert!(found.r2 > 1.0 - 1e-9 && (found.steepness - 7.0).abs() < 1e-9 && found.basins == MOST_BASINS);
    }

    #[test]
    fn level_rivers_have_no_steepness() {
        assert!(chi(&peano(4)).is_err());
    }
}
