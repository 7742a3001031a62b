//! Weights of ground materials (splat maps): how much sand, grass, rock and snow lies at a place, by height and slope.
//!
//! Sand fills the sea floor and the beaches, rock the steep, snow what is high and not too steep, grass the rest. Slopes
//! of a coarse map are gentle everywhere, so rock begins at 30 degrees or where the steepest quarter of the land begins,
//! whichever is gentler. The four always sum to one, in 8 bits to exactly 255.

use rayon::prelude::*;
use serde::Serialize;

use crate::grid::Field;

/// The materials, in the order of a picture's channels.
pub const MATERIALS: [&str; 4] = ["sand", "grass", "rock", "snow"];

/// Where one material gives way to another: begins, complete.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WeightRules {
    /// Heights above the sea over which sand ends, m.
    pub sand_ends_m: [f64; 2],
    /// Slopes over which rock comes out, degrees.
    pub rock_deg: [f64; 2],
    /// Heights above the sea over which snow lies, m.
    pub snow_m: [f64; 2],
}

impl WeightRules {
    /// The rules for a world of these heights and slopes (degrees).
    pub fn of(height: &Field<f32>, slope: &Field<f32>, sea_level_m: f64) -> Self {
        let land = height.data.iter().zip(&slope.data).filter(|&(&h, _)| h as f64 > sea_level_m);
        let mut slopes: Vec<f32> = land.map(|(_, &slope)| slope).collect();
        slopes.par_sort_unstable_by(f32::total_cmp);
        let at = |share: f64| slopes.get((share * slopes.len() as f64) as usize).map_or(90.0, |&deg| deg as f64);
        let begins_deg = at(0.75).min(30.0);
        // A world without slopes still needs a range that is one.
        let complete_deg = at(0.95).min(45.0).max(begins_deg + 0.01);
        Self { sand_ends_m: [5.0, 40.0], rock_deg: [begins_deg, complete_deg], snow_m: [2400.0, 3000.0] }
    }

    /// Weights at one place, in the order of [`MATERIALS`].
    fn at(&self, above_sea_m: f64, slope_deg: f64) -> [f64; 4] {
        let rise = |[from, to]: [f64; 2], v: f64| {
            let t = ((v - from) / (to - from)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        let dry = rise(self.sand_ends_m, above_sea_m);
        let rock = dry * rise(self.rock_deg, slope_deg);
        let soil = dry - rock;
        let snow = soil * rise(self.snow_m, above_sea_m);
        [1.0 - dry, soil - snow, rock, snow]
    }

    /// Weights in 8 bits at every place, four side by side.
    pub fn weights(&self, height: &Field<f32>, slope: &Field<f32>, sea_level_m: f64) -> Vec<u8> {
        let all = Field::from_fn(height.grid, |x, y| {
            bytes_of(self.at(height.at(x, y) as f64 - sea_level_m, slope.at(x, y) as f64))
        });
        all.data.into_iter().flatten().collect()
    }
}

/// Shares of one as bytes that sum to 255: rounded down, and what is missing goes to the largest remainders.
fn bytes_of(shares: [f64; 4]) -> [u8; 4] {
    let exact = shares.map(|share| share * 255.0);
    let mut bytes = exact.map(|v| v as u8);
    let missing = 255 - bytes.iter().map(|&b| b as usize).sum::<usize>().min(255);
    let mut order = [0, 1, 2, 3];
    let rest = |i: usize| exact[i] - exact[i].floor();
    order.sort_by(|&a, &b| rest(b).total_cmp(&rest(a)));
    for &i in order.iter().cycle().take(missing) {
        bytes[i] += 1;
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn they_sum_to_exactly_255() {
        let rules = WeightRules { sand_ends_m: [5.0, 40.0], rock_deg: [20.0, 35.0], snow_m: [2400.0, 3000.0] };
        let grid = Grid::new(400, 60, 400.0, Edges::Open);
        let height = Field::from_fn(grid, |x, _| x as f32 * 9.7 - 100.0);
        let slope = Field::from_fn(grid, |_, y| y as f32);
        let weights = rules.weights(&height, &slope, 0.0);
        assert!(weights.chunks(4).all(|w| w.iter().map(|&b| b as u32).sum::<u32>() == 255));
        assert_eq!(bytes_of([0.25; 4]).iter().map(|&b| b as u32).sum::<u32>(), 255);
    }

    #[test]
    fn each_material_has_its_place() {
        let rules = WeightRules { sand_ends_m: [5.0, 40.0], rock_deg: [20.0, 35.0], snow_m: [2400.0, 3000.0] };
        assert_eq!(rules.at(-500.0, 50.0), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(rules.at(500.0, 5.0), [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(rules.at(500.0, 50.0), [0.0, 0.0, 1.0, 0.0]);
        assert_eq!(rules.at(3500.0, 5.0), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn rock_comes_out_on_gentle_maps_too() {
        let grid = Grid::new(100, 1, 100.0, Edges::Open);
        let height = Field::filled(grid, 100.0);
        let gentle = Field::from_fn(grid, |x, _| x as f32 / 100.0);
        assert_eq!(WeightRules::of(&height, &gentle, 0.0).rock_deg, [0.75, 0.95f32 as f64]);
        let steep = gentle.map(|deg| deg * 80.0);
        assert_eq!(WeightRules::of(&height, &steep, 0.0).rock_deg, [30.0, 45.0]);
        let sea = WeightRules::of(&height, &gentle, 1000.0);
        assert!(sea.rock_deg[0] < sea.rock_deg[1]);
    }
}
