//! Skewness of curvature ∇²z on land: valleys (positive) that are sharper than ridges give a positive one; noise gives 0.

use super::super::metric::Missing;
use crate::grid::{Field, sum_rows};

const LEAST_CELLS: usize = 100;

/// The skewness, over cells whose four neighbours are land too.
pub fn curvature_skewness(height: &Field<f32>, sea_level_m: f64) -> Result<f64, Missing> {
    let (w, h) = (height.grid.width, height.grid.height);
    let curvature = |x: usize, y: usize| {
        let around = [height.at(x - 1, y), height.at(x + 1, y), height.at(x, y - 1), height.at(x, y + 1)];
        let z = height.at(x, y) as f64;
        let land = z > sea_level_m && around.iter().all(|&n| n as f64 > sea_level_m);
        land.then(|| around.iter().map(|&n| n as f64).sum::<f64>() - 4.0 * z)
    };
    let sum = |f: &(dyn Fn(f64) -> f64 + Sync)| {
        sum_rows(h.saturating_sub(2), |row| (1..w.max(2) - 1).filter_map(|x| curvature(x, row + 1)).map(f).sum())
    };
    let n = sum(&|_| 1.0);
    if (n as usize) < LEAST_CELLS {
        return Err(Missing::TooFew { what: "inland cells", found: n as usize, needed: LEAST_CELLS });
    }
    let mean = sum(&|c| c) / n;
    let second = sum(&|c| (c - mean) * (c - mean)) / n;
    let third = sum(&|c| (c - mean) * (c - mean) * (c - mean)) / n;
    if second <= 0.0 { Err(Missing::Flat) } else { Ok(third / (second * second.sqrt())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Grid},
        measure::ground::shapes::fbm,
    };

    #[test]
    fn sharp_valleys_sharp_ridges_and_noise() {
        // Six valleys and six ridges within the rim, all alike.
        let grid = Grid::new(122, 40, 122.0, Edges::Open);
        let valleys = Field::from_fn(grid, |x, _| (x % 20).min(20 - x % 20) as f32 + 1.0);
        assert_eq!(curvature_skewness(&valleys, 0.0), Ok(0.0));
        let round = valleys.map(|z| z.min(8.0).sqrt());
        assert!(curvature_skewness(&round, 0.0).unwrap() > 2.0);
        let turned = round.map(|z| 10.0 - z);
        assert!(curvature_skewness(&turned, 0.0).unwrap() < -2.0);
        assert!(curvature_skewness(&fbm(256, 0.7, 3), -1e9).unwrap().abs() < 0.05);
    }

    #[test]
    fn small_and_level_ground() {
        for (w, h) in [(1, 1), (2, 500), (500, 1)] {
            let field = Field::filled(Grid::new(w, h, w as f64, Edges::Open), 1.0);
            assert!(matches!(curvature_skewness(&field, 0.0), Err(Missing::TooFew { found: 0, .. })));
        }
        let level = Field::filled(Grid::new(50, 50, 50.0, Edges::Open), 1.0);
        assert_eq!(curvature_skewness(&level, 0.0), Err(Missing::Flat));
    }
}
