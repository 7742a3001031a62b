//! Steps in the land that is there.
//!
//! With `k = ⌊h/W⌋` and `t = h/W − k`, `h' = W·(k + ½ + ½·tanh(α(2t − 1))/tanh α)`: monotone, so that what was higher stays
//! higher. A low-frequency noise is added to `h` before and taken off after, so that steps don't follow contours exactly.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{length_m, sampled};
use crate::{
    grid::Field,
    noise::Fbm,
    process::{Context, ProcessError, Shape},
    world::Layer,
};

/// Cuts steps into the bedrock that is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TerraceParams {
    /// Height of a step.
    #[schemars(range(min = 0.1, max = 5000.0), extend("x-unit" = "m", "x-effect" = "fewer, higher steps"))]
    pub step_m: f64,
    /// How sharp the edges are.
    #[schemars(range(min = 0.1, max = 12.0), extend("x-unit" = "1", "x-effect" = "flatter treads, steeper risers"))]
    pub sharpness: f64,
    /// How far the steps wander up and down, as a standard deviation.
    #[schemars(range(min = 0.0, max = 5000.0), extend("x-unit" = "m", "x-effect" = "steps that follow contours less"))]
    pub wander_m: f64,
    /// Over what distance they wander; a quarter of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 100000.0), extend("x-unit" = "km", "x-effect" = "slower wandering"))]
    pub wander_km: Option<f64>,
}

impl Default for TerraceParams {
    fn default() -> Self {
        Self { step_m: 300.0, sharpness: 3.0, wander_m: 120.0, wander_km: None }
    }
}

impl TerraceParams {
    /// The step function.
    fn stepped(&self, height_m: f64) -> f64 {
        let level = height_m / self.step_m;
        let k = level.floor();
        let bend = libm::tanh(self.sharpness * (2.0 * (level - k) - 1.0)) / libm::tanh(self.sharpness);
        self.step_m * (k + 0.5 + 0.5 * bend)
    }
}

impl Shape for TerraceParams {
    const READS: &'static [Layer] = &[Layer::Bedrock];

    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let fbm = Fbm { octaves: Some(3.0), ..Fbm::new(length_m(self.wander_km, 0.25, &grid), 0.9) };
        let wander = fbm.octaves(context.key.named("terrace"), 0.0);
        Ok(sampled(grid, &wander, |noise, x, y| {
            let phase = self.wander_m * noise.value(grid.center_m(x, y));
            self.stepped(ground.at(x, y) as f64 + phase) - phase
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_monotone_and_meet_their_edges() {
        for sharpness in [0.1, 1.0, 6.0, 12.0] {
            let params = TerraceParams { step_m: 100.0, sharpness, ..TerraceParams::default() };
            for k in -3..4 {
                assert!((params.stepped(100.0 * k as f64) - 100.0 * k as f64).abs() < 1e-9);
                assert!((params.stepped(100.0 * k as f64 + 50.0) - (100.0 * k as f64 + 50.0)).abs() < 1e-9);
            }
            let line: Vec<f64> = (0..4000).map(|i| params.stepped(i as f64 * 0.1 - 200.0)).collect();
            assert!(line.windows(2).all(|w| w[1] >= w[0] - 1e-12));
        }
        // Close to no sharpness, close to no step.
        let smooth = TerraceParams { step_m: 100.0, sharpness: 0.1, ..TerraceParams::default() };
        assert!((smooth.stepped(20.0) - 20.0).abs() < 0.2);
    }
}
