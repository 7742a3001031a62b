//! Hypsometry basin by basin (Strahler 1952): a whole continent has plains around its ranges and reads low; Strahler's
//! numbers are of single catchments.

use super::super::{fit::median, hypsometry, metric::Missing, streams::Network};

/// Cells that a basin has at least.
const LEAST_CELLS: usize = 256;
/// Basins that are looked at, from the largest.
const MOST_BASINS: usize = 40;

/// Hypsometry of the largest basins.
#[derive(Clone, Debug)]
pub struct BasinHypsometry {
    /// Median over the basins of (mean − lowest)/(highest − lowest).
    pub integral: f64,
    /// Basins counted.
    pub basins: usize,
    /// Mean curve: `[share of a basin's area; share of its relief that it stands over]`.
    pub curve: Vec<[f64; 2]>,
}

/// The hypsometry of the basins of a network.
pub fn basin_hypsometry(network: &Network) -> Result<BasinHypsometry, Missing> {
    let mouths = network.mouths();
    let mut cells: Vec<(u32, u32)> =
        (0..mouths.len()).filter_map(|i| mouths[i].map(|mouth| (mouth, i as u32))).collect();
    if cells.is_empty() {
        return Err(Missing::NoLand);
    }
    cells.sort_unstable();
    let mut basins: Vec<&[(u32, u32)]> =
        cells.chunk_by(|a, b| a.0 == b.0).filter(|basin| basin.len() >= LEAST_CELLS).collect();
    basins.sort_by_key(|basin| (std::cmp::Reverse(basin.len()), basin[0].0));
    basins.truncate(MOST_BASINS);
    let found: Vec<_> = basins
        .iter()
        .map(|basin| basin.iter().map(|&(_, i)| network.height_m[i as usize] as f32).collect::<Vec<f32>>())
        .filter_map(|heights| hypsometry(&heights))
        .filter_map(|h| h.integral.map(|integral| (integral, h.curve)))
        .collect();
    let few = Missing::TooFew { what: "basins of 256 cells", found: found.len(), needed: 1 };
    let integrals: Vec<f64> = found.iter().map(|(integral, _)| *integral).collect();
    let integral = median(&integrals).ok_or(few)?;
    let mut curve: Vec<[f64; 2]> = found[0].1.iter().map(|p| [p[0], 0.0]).collect();
    for (_, heights) in &found {
        let (high, low) = (heights[0][1], heights[heights.len() - 1][1]);
        for (mean, [_, h]) in curve.iter_mut().zip(heights) {
            mean[1] += (h - low) / (high - low) / found.len() as f64;
        }
    }
    Ok(BasinHypsometry { integral, basins: found.len(), curve })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Field, Grid};

    #[test]
    fn a_tilted_plane_in_strips_has_one_half() {
        // Each row drains to the west on its own: basins of 400 cells that are planes.
        let grid = Grid::new(400, 5, 400.0, Edges::Open);
        let strips = Field::from_fn(grid, |x, _| x as f32 + 1.0);
        let network = Network::of(&strips, 0.0);
        let found = basin_hypsometry(&network).unwrap();
        // The northern and southern row, and the east, leave over the rim.
        assert_eq!(found.basins, 3);
        assert!((found.integral - 0.5).abs() < 1e-9, "{}", found.integral);
        assert!(found.curve.iter().all(|[share, h]| (1.0 - share - h).abs() < 1e-6));
        assert_eq!(basin_hypsometry(&Network::of(&strips, 1e6)).unwrap_err(), Missing::NoLand);
    }
}
