//! One mountain by repeated magnification and probing: draw a random Voronoi partition, raise the cell that holds the peak,
//! repeat.
//!
//! The expected profile of an octave is `p(u) ≈ exp(−1.16 u − 0.96 u²)`, `u = 0.442·d/half_width`. Whole cells rise, also
//! where they leave the map.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{length_m, massif::Massif, place_m};
use crate::{
    grid::{Field, Grid},
    process::{Context, ProcessError, Shape},
};

/// A mountain of random Voronoi cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RmpPeakParams {
    /// The summit, east and south of the map's north-west corner; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves the mountain east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Height of the mountain above its surroundings.
    #[schemars(range(min = -12000.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "a higher mountain"))]
    pub height_m: f64,
    /// Distance at which the widest octave has fallen to half its height; a tenth of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km", "x-effect" = "a broader mountain"))]
    pub half_width_km: Option<f64>,
    /// Draws of the widest octave; each narrower one makes half as many.
    #[schemars(range(min = 1, max = 5000), extend("x-unit" = "1", "x-effect" = "smoother slopes, fewer visible polygons"))]
    pub iterations: u32,
    /// Widths raised at once, each half as wide as the one before.
    #[schemars(range(min = 1, max = 8), extend("x-unit" = "1", "x-effect" = "a sharper mountain with finer detail"))]
    pub octaves: u32,
    /// Height of an octave over that of the one before.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "more of the height in the narrow octaves"))]
    pub octave_share: f64,
    /// Raises each cell by a random share, so that no flat top shows.
    #[schemars(extend("x-unit" = "1", "x-effect" = "off: every cell rises alike"))]
    pub random_weights: bool,
    /// Spurs around it, in fives.
    #[schemars(range(min = 0.0, max = 5.0), extend("x-unit" = "1", "x-effect" = "more spurs; 0 leaves a smooth cone"))]
    pub spurs: f64,
}

impl Default for RmpPeakParams {
    fn default() -> Self {
        Self {
            at_km: None,
            height_m: 3000.0,
            half_width_km: None,
            iterations: 200,
            octaves: 5,
            octave_share: 0.75,
            random_weights: true,
            spurs: 1.2,
        }
    }
}

impl Shape for RmpPeakParams {
    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.massif(grid).check()
    }

    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        self.massif(&ground.grid).heights(ground.grid, context.key.named("rmp-peak"), context)
    }
}

impl RmpPeakParams {
    fn massif(&self, grid: &Grid) -> Massif {
        Massif {
            path_m: vec![place_m(self.at_km, grid)],
            height_m: self.height_m,
            half_width_m: length_m(self.half_width_km, 0.1, grid),
            iterations: self.iterations,
            octaves: self.octaves,
            octave_share: self.octave_share,
            random_weights: self.random_weights,
            spurs: self.spurs,
        }
    }
}
