//! What the Voronoi stages share: a peak or a line raised again and again, in several widths at once.
//!
//! Octave `j` draws cells half as wide as octave `j − 1` (four times the sites) and gives them a smaller share of the height:
//! massif, chain, crest. Each of `n` draws raises the cells it visits by `share_j·height/n`, times their random weight over
//! its mean, so that the expected height on the path is `height`. Work follows the cells raised.

use rayon::prelude::*;

use crate::{
    grid::{Field, Grid},
    noise::Key,
    process::{Context, ProcessError},
    rmp::{MEAN_WEIGHT, Raised, cells_along, density_for_half_width, raise},
};

/// Longest path, in half widths of the narrowest octave.
const LONGEST: f64 = 20_000.0;

/// A peak or a line to raise.
pub(super) struct Massif {
    pub path_m: Vec<[f64; 2]>,
    pub height_m: f64,
    /// Distance at which the widest octave falls to half its height.
    pub half_width_m: f64,
    pub iterations: u32,
    pub octaves: u32,
    /// Height of an octave over that of the one before.
    pub octave_share: f64,
    pub random_weights: bool,
}

impl Massif {
    pub fn heights(&self, grid: Grid, key: Key, context: &Context) -> Result<Field<f32>, ProcessError> {
        self.check()?;
        let mut heights = Field::filled(grid, 0.0);
        let total: f64 = (0..self.octaves).map(|j| self.octave_share.powi(j as i32)).sum();
        for octave in 0..self.octaves {
            let share = self.octave_share.powi(octave as i32) / total;
            let density = density_for_half_width(self.half_width_m / libm::exp2(octave as f64));
            let step_m = share * self.height_m / self.iterations as f64;
            // A few draws at a time bound the memory.
            for first in (0..self.iterations).step_by(64) {
                context.check()?;
                let draws: Vec<Vec<Raised>> = (first..(first + 64).min(self.iterations))
                    .into_par_iter()
                    .map(|draw| self.draw(density, step_m, grid.cell_m, key.with(octave as u64).with(draw as u64)))
                    .collect();
                raise(&mut heights, &draws.concat());
            }
        }
        Ok(heights)
    }

    fn draw(&self, sites_per_m2: f64, step_m: f64, cell_m: f64, key: Key) -> Vec<Raised> {
        let cells = cells_along(&self.path_m, sites_per_m2, key);
        let raised = cells.into_iter().map(|cell| {
            let weight = if self.random_weights { cell.weight / MEAN_WEIGHT } else { 1.0 };
            let outline = cell.outline.iter().map(|p| [p[0] / cell_m, p[1] / cell_m]).collect();
            Raised { outline, amount: (weight * step_m) as f32 }
        });
        raised.collect()
    }

    fn check(&self) -> Result<(), ProcessError> {
        let narrowest_m = self.half_width_m / libm::exp2(self.octaves as f64 - 1.0);
        let length_m: f64 = self.path_m.windows(2).map(|s| libm::hypot(s[1][0] - s[0][0], s[1][1] - s[0][1])).sum();
        let furthest_m = self.path_m.iter().flatten().fold(0.0, |far: f64, v| far.max(v.abs()));
        if length_m.max(furthest_m) <= LONGEST * narrowest_m {
            return Ok(());
        }
        Err(ProcessError::Unfit(format!(
            "half_width_km = {} with {} octaves is too narrow for a mountain {:.0} km long or away (widen it, or use fewer \
             octaves)",
            self.half_width_m / 1e3,
            self.octaves,
            length_m.max(furthest_m) / 1e3
        )))
    }
}
