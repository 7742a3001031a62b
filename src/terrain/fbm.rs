//! Fractional Brownian land: every octave everywhere, equally rough on heights and in valleys.
//!
//! `h = base + height/2·f(x)` with [`Fbm`]'s `f` of unit standard deviation; spectrum `k^(−(2H+2))`. Octaves end at two cells.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{length_m, sampled};
use crate::{
    grid::Field,
    noise::{Basis, Fbm},
    process::{Context, ProcessError, Shape},
};

/// Fractal noise, equally rough everywhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FbmParams {
    /// Height of a high summit above the mean: two standard deviations.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "higher summits and deeper basins"))]
    pub height_m: f64,
    /// Mean height of the land.
    #[schemars(range(min = -12000.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "more land, less sea"))]
    pub base_m: f64,
    /// Size of the largest features; a third of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 100000.0), extend("x-unit" = "km", "x-effect" = "fewer, larger landmasses"))]
    pub wavelength_km: Option<f64>,
    /// Hurst exponent: 1 is smooth, 0.2 rough.
    #[schemars(range(min = 0.05, max = 1.2), extend("x-unit" = "1", "x-effect" = "smoother land"))]
    pub hurst: f64,
    /// Ratio of the sizes of successive octaves.
    #[schemars(range(min = 1.5, max = 4.0), extend("x-unit" = "1", "x-effect" = "fewer octaves, further apart"))]
    pub lacunarity: f64,
    /// Octaves at most, the last may be a fraction; as many as the cells resolve if not given.
    #[schemars(range(min = 1.0, max = 24.0), extend("x-unit" = "1", "x-effect" = "finer detail"))]
    pub octaves: Option<f64>,
    /// Turn from one octave to the next, so that no lattice shows.
    #[schemars(range(min = 0.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "turns the octaves' lattices further apart"))]
    pub rotation_deg: f64,
    /// The noise that is summed.
    #[schemars(extend("x-unit" = "1", "x-effect" = "value is blocky, gradient usual, simplex shows least of its lattice"))]
    pub noise: Basis,
}

impl Default for FbmParams {
    fn default() -> Self {
        Self {
            height_m: 2000.0,
            base_m: 0.0,
            wavelength_km: None,
            hurst: 0.8,
            lacunarity: 2.07,
            octaves: None,
            rotation_deg: 28.6,
            noise: Basis::Gradient,
        }
    }
}

impl Shape for FbmParams {
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let fbm = Fbm {
            wavelength_m: length_m(self.wavelength_km, 1.0 / 3.0, &grid),
            hurst: self.hurst,
            lacunarity: self.lacunarity,
            octaves: self.octaves,
            rotation_rad: self.rotation_deg.to_radians(),
            basis: self.noise,
        };
        let sum = fbm.octaves(context.key.named("fbm"), grid.cell_m);
        let (base, scale) = (self.base_m, 0.5 * self.height_m);
        Ok(sampled(grid, &sum, |noise, x, y| base + scale * noise.value(grid.center_m(x, y))))
    }
}
