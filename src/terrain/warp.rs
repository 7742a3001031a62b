//! Bends the land that is there: every point reads the height of a point nearby.
//!
//! `h'(p) = h(p + a·q(p))` with two independent noises `q = (q₁, q₂)` of unit standard deviation. The map `p → p + a·q(p)`
//! folds nowhere if `a·‖J‖ < 1` for the Jacobian `J` of `q`; with `fold_free`, `a` is held below 0.9 over the largest
//! `‖J‖` found on a fixed 128 x 128 raster over the map. Beyond the rim the map is read
//! mirrored.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::length_m;
use crate::{
    grid::{Edges, Field, Grid, cubic, for_each_row},
    noise::{Fbm, Octaves},
    process::{Context, ProcessError, Shape},
    world::Layer,
};

/// Bends the bedrock that is there, so that straight things curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WarpParams {
    /// How far points are moved, as a standard deviation in each direction; 4 % of the map's longer side if not given.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "km", "x-effect" = "stronger bends"))]
    pub amplitude_km: Option<f64>,
    /// Size of the largest bends; 40 % of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 100000.0), extend("x-unit" = "km", "x-effect" = "wider bends"))]
    pub wavelength_km: Option<f64>,
    /// Hurst exponent of the bends.
    #[schemars(range(min = 0.05, max = 1.2), extend("x-unit" = "1", "x-effect" = "smoother bends"))]
    pub hurst: f64,
    /// Octaves of the bends.
    #[schemars(range(min = 1.0, max = 12.0), extend("x-unit" = "1", "x-effect" = "bends within bends"))]
    pub octaves: f64,
    /// Holds the amplitude below what would fold the land over itself.
    #[schemars(extend("x-unit" = "1", "x-effect" = "off: the land may fold into swirls"))]
    pub fold_free: bool,
}

impl Default for WarpParams {
    fn default() -> Self {
        Self { amplitude_km: None, wavelength_km: None, hurst: 1.0, octaves: 4.0, fold_free: true }
    }
}

impl Shape for WarpParams {
    const READS: &'static [Layer] = &[Layer::Bedrock];

    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let (bends, amplitude) = self.bends(&grid, context);
        let mut heights = Field::filled(grid, 0.0);
        for_each_row(&mut heights.data, grid.width, |y, row| {
            let mut bends = [bends[0].sampler(), bends[1].sampler()];
            for (x, height) in row.iter_mut().enumerate() {
                let at = grid.center_m(x, y);
                let from = [0, 1].map(|i| at[i] + amplitude * bends[i].value(at));
                let from = if grid.edges == Edges::Wrap { from } else { mirrored(from, grid.extent_m()) };
                *height = cubic(ground, from) as f32;
            }
        });
        Ok(heights)
    }
}

impl WarpParams {
    /// The two components, and how far they move points, m. Octaves don't follow the grid: bends are smooth.
    fn bends(&self, grid: &Grid, context: &Context) -> ([Octaves; 2], f64) {
        let wavelength_m = length_m(self.wavelength_km, 0.4, grid);
        let fbm = Fbm { octaves: Some(self.octaves), ..Fbm::new(wavelength_m, self.hurst) };
        let key = context.key.named("warp");
        let bends = [fbm.octaves(key.with(0), 0.0), fbm.octaves(key.with(1), 0.0)];
        let wanted = length_m(self.amplitude_km, 0.04, grid);
        let limit = if self.fold_free { 0.9 / steepest(&bends, grid) } else { f64::INFINITY };
        (bends, wanted.min(limit))
    }
}

/// A place beyond the rim mirrored into the map: repeating the rim's height would draw streaks.
fn mirrored(at_m: [f64; 2], extent_m: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| {
        let turn = at_m[i].rem_euclid(2.0 * extent_m[i]);
        turn.min(2.0 * extent_m[i] - turn)
    })
}

/// The largest norm of the Jacobian on a raster that does not depend on the grid, 1/m.
fn steepest(bends: &[Octaves; 2], grid: &Grid) -> f64 {
    const SIDE: usize = 128;
    let [w, h] = grid.extent_m();
    let norm = |i: usize| {
        let at = [(i % SIDE) as f64 / SIDE as f64 * w, (i / SIDE) as f64 / SIDE as f64 * h];
        let ([a, b], [c, d]) = (bends[0].gradient(at).1, bends[1].gradient(at).1);
        // Largest singular value of a 2 x 2 matrix.
        let (square, det) = (a * a + b * b + c * c + d * d, a * d - b * c);
        (0.5 * (square + (square * square - 4.0 * det * det).max(0.0).sqrt())).sqrt()
    };
    (0..SIDE * SIDE).map(norm).fold(f64::MIN_POSITIVE, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn fold_free_warps_keep_their_orientation() {
        let grid = Grid::new(512, 300, 512e3, Edges::Open);
        let cancel = AtomicBool::new(false);
        for seed in 0..8 {
            let wild = WarpParams { amplitude_km: Some(1e4), ..WarpParams::default() };
            let (bends, a) = wild.bends(&grid, &Context::new(seed, "warp", &cancel));
            for i in 0..grid.cells() {
                let at = grid.center_m(i % 512, i / 512);
                let ([xx, xy], [yx, yy]) = (bends[0].gradient(at).1, bends[1].gradient(at).1);
                assert!((1.0 + a * xx) * (1.0 + a * yy) - a * a * xy * yx > 0.0);
            }
        }
    }
}
