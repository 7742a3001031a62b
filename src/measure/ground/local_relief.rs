//! Local relief: highest less lowest ground within a disc of 5 km (Ahnert 1970; Montgomery and Brandon 2002).
//!
//! Discs stand on a lattice of a quarter of their radius, which sees every cell many times over; only discs that lie on
//! the map and on land altogether count.

use rayon::prelude::*;

use super::super::{fit::median, metric::Missing};
use crate::grid::Field;

/// Across a disc, m.
pub const DISC_M: f64 = 5000.0;
const LEAST_DISCS: usize = 10;

/// Relief over the discs.
#[derive(Clone, Debug)]
pub struct LocalRelief {
    /// Median, m.
    pub median_m: f64,
    /// Greatest, m.
    pub max_m: f64,
    /// Discs counted.
    pub discs: usize,
}

/// The relief of the land.
pub fn local_relief(height: &Field<f32>, sea_level_m: f64) -> Result<LocalRelief, Missing> {
    let grid = height.grid;
    let radius = DISC_M / 2.0 / grid.cell_m;
    let reach = radius.floor() as usize;
    // Half the width of each row of the disc, from the middle outwards.
    let halves: Vec<usize> = (0..=reach).map(|dy| (radius * radius - (dy * dy) as f64).sqrt() as usize).collect();
    let step = (reach / 4).max(1);
    let inner = |length: usize| (reach..length.saturating_sub(reach)).step_by(step);
    let rows: Vec<usize> = if reach == 0 { Vec::new() } else { inner(grid.height).collect() };
    let relief = |x: usize, y: usize| {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for row in y - reach..=y + reach {
            let half = halves[row.abs_diff(y)];
            for &h in &height.row(row)[x - half..=x + half] {
                (low, high) = (low.min(h), high.max(h));
            }
        }
        (low as f64 > sea_level_m).then_some((high - low) as f64)
    };
    let found: Vec<f64> =
        rows.par_iter().flat_map_iter(|&y| inner(grid.width).filter_map(move |x| relief(x, y))).collect();
    let few = Missing::TooFew { what: "discs of 5 km on land", found: found.len(), needed: LEAST_DISCS };
    if found.len() < LEAST_DISCS {
        return Err(few);
    }
    let max_m = found.iter().copied().fold(0.0, f64::max);
    Ok(LocalRelief { median_m: median(&found).ok_or(few)?, max_m, discs: found.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn a_plane_rises_by_its_slope_across_a_disc() {
        let grid = Grid::new(300, 200, 30_000.0, Edges::Open);
        let plane = Field::from_fn(grid, |x, _| x as f32 * 20.0 + 1.0);
        let found = local_relief(&plane, 0.0).unwrap();
        assert_eq!((found.median_m, found.max_m), (1000.0, 1000.0));
        let shore = local_relief(&plane, 3000.0).unwrap();
        assert!(shore.discs < found.discs * 6 / 10 && shore.max_m == 1000.0);
    }

    #[test]
    fn cells_of_ten_kilometres_have_no_disc() {
        let grid = Grid::new(100, 100, 1e6, Edges::Open);
        assert!(local_relief(&Field::filled(grid, 1.0), 0.0).is_err());
    }
}
