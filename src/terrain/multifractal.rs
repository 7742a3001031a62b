//! Land that is not equally rough everywhere: Musgrave's multifractals, ridges, billows and turbulence.
//!
//! The noise's range depends on the data, so it is measured: at 4096 places of the map, with octaves down to a 1024th of it
//! whatever the grid, the 1 % and 99 % values become `base_m` and `base_m + height_m`. Nothing is cut off beyond them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{length_m, longer_side_m, sampled};
use crate::{
    grid::{Field, Grid},
    noise::{Fbm, Key, Sampler},
    process::{Context, ProcessError, Shape},
};

/// How the octaves are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// Smooth valleys, rough heights.
    #[default]
    Hybrid,
    /// Sharp ridges with spurs over smooth ground.
    Ridged,
    /// Plains that rise to rough highlands.
    Hetero,
    /// Round hills between sharp valleys.
    Billow,
    /// Sharp valleys.
    Turbulence,
}

impl Form {
    /// Hurst exponent that suits the form.
    fn hurst(self) -> f64 {
        match self {
            Form::Hybrid => 0.25,
            Form::Ridged => 0.9,
            Form::Hetero => 0.8,
            Form::Billow | Form::Turbulence => 0.9,
        }
    }

    fn value(self, sum: &mut Sampler, at_m: [f64; 2], offset: f64) -> f64 {
        /// Musgrave's own: a signal of one half lets all of the next octave through.
        const GAIN: f64 = 2.0;
        match self {
            Form::Hybrid => sum.hybrid(at_m, offset),
            Form::Ridged => sum.ridged_multifractal(at_m, offset + 0.3, GAIN),
            Form::Hetero => sum.hetero(at_m, offset),
            Form::Billow => sum.billow(at_m),
            Form::Turbulence => sum.turbulence(at_m),
        }
    }
}

/// Fractal noise whose roughness depends on height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MultifractalParams {
    /// How the octaves are joined.
    #[schemars(extend("x-unit" = "1", "x-effect" = "hybrid: rough heights; ridged: crests; hetero: plains; billow: hills"))]
    pub form: Form,
    /// Rise from the lowest hundredth of the land to the highest.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "higher mountains"))]
    pub height_m: f64,
    /// Height of the lowest hundredth of the land.
    #[schemars(range(min = -12000.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "more land, less sea"))]
    pub base_m: f64,
    /// Size of the largest features; a third of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 100000.0), extend("x-unit" = "km", "x-effect" = "fewer, larger ranges"))]
    pub wavelength_km: Option<f64>,
    /// Hurst exponent; what suits the form if not given (hybrid 0.25, hetero 0.8, others 0.9).
    #[schemars(range(min = 0.05, max = 1.2), extend("x-unit" = "1", "x-effect" = "smoother land"))]
    pub hurst: Option<f64>,
    /// Ratio of the sizes of successive octaves.
    #[schemars(range(min = 1.5, max = 4.0), extend("x-unit" = "1", "x-effect" = "fewer octaves, further apart"))]
    pub lacunarity: f64,
    /// Added to the noise before octaves are multiplied (hybrid, ridged, hetero).
    #[schemars(range(min = 0.0, max = 2.0), extend("x-unit" = "1", "x-effect" = "detail reaches further down the slopes"))]
    pub offset: f64,
    /// Octaves at most, the last may be a fraction; as many as the cells resolve if not given.
    #[schemars(range(min = 1.0, max = 24.0), extend("x-unit" = "1", "x-effect" = "finer detail"))]
    pub octaves: Option<f64>,
}

impl Default for MultifractalParams {
    fn default() -> Self {
        Self {
            form: Form::Hybrid,
            height_m: 4000.0,
            base_m: -500.0,
            wavelength_km: None,
            hurst: None,
            lacunarity: 2.07,
            offset: 0.7,
            octaves: None,
        }
    }
}

impl Shape for MultifractalParams {
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let key = context.key.named("multifractal");
        let fbm = Fbm {
            lacunarity: self.lacunarity,
            octaves: self.octaves,
            ..Fbm::new(length_m(self.wavelength_km, 1.0 / 3.0, &grid), self.hurst.unwrap_or(self.form.hurst()))
        };
        let [low, high] = self.measured_range(&fbm, &grid, key);
        let scale = if high > low { self.height_m / (high - low) } else { 0.0 };
        let sum = fbm.octaves(key, grid.cell_m);
        Ok(sampled(grid, &sum, |noise, x, y| {
            self.base_m + scale * (self.form.value(noise, grid.center_m(x, y), self.offset) - low)
        }))
    }
}

impl MultifractalParams {
    /// The 1 % and 99 % values of the noise over the map, the same for every grid of this extent.
    fn measured_range(&self, fbm: &Fbm, grid: &Grid, key: Key) -> [f64; 2] {
        const PLACES: usize = 4096;
        let sum = fbm.octaves(key, longer_side_m(grid) / 1024.0);
        let mut sampler = sum.sampler();
        let [w, h] = grid.extent_m();
        let mut stream = key.named("range").stream();
        let mut values: Vec<f64> = (0..PLACES)
            .map(|_| self.form.value(&mut sampler, [w * stream.unit(), h * stream.unit()], self.offset))
            .collect();
        values.sort_by(f64::total_cmp);
        [values[PLACES / 100], values[PLACES - 1 - PLACES / 100]]
    }
}
