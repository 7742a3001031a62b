//! A massif by repeated magnification and probing with lines: cut the map by random lines, raise the face that holds the peak
//! and the next few faces around it, repeat.
//!
//! Faces are taken breadth first (a compact massif) or depth first (a chain that wanders off), each `damping` times as much
//! as the one before. For the first face alone the expected profile is `2^(−d/B)` with `B = P·ln 2/(2c)`, `c` lines on a map
//! of perimeter `P`: the chance that no line parts two points. The peak itself rises to `height_m` exactly.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Shape, place_m};
use crate::{
    grid::{Field, Grid},
    noise::Key,
    process::{Context, ProcessError},
    rmp::{Arrangement, Order, Raised, raise},
};

/// A massif of the faces between random lines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RmpGraphParams {
    /// The summit, east and south of the map's north-west corner; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves the massif east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Height of the massif above its surroundings.
    #[schemars(range(min = -12000.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "a higher massif"))]
    pub height_m: f64,
    /// Cutting lines in each draw.
    #[schemars(range(min = 0, max = 100), extend("x-unit" = "1", "x-effect" = "a narrower, steeper massif"))]
    pub cuts: u32,
    /// Faces raised in each draw.
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1", "x-effect" = "a broader massif"))]
    pub faces: u32,
    /// The order in which faces are taken.
    #[schemars(extend("x-unit" = "1", "x-effect" = "breadth: compact; depth: a wandering chain"))]
    pub order: Order,
    /// How much a face rises over the one taken before it.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "slower decline from face to face"))]
    pub damping: f64,
    /// Draws.
    #[schemars(range(min = 1, max = 5000), extend("x-unit" = "1", "x-effect" = "smoother slopes, fewer visible polygons"))]
    pub iterations: u32,
}

impl Default for RmpGraphParams {
    fn default() -> Self {
        Self { at_km: None, height_m: 3000.0, cuts: 14, faces: 5, order: Order::Breadth, damping: 0.9, iterations: 200 }
    }
}

impl Shape for RmpGraphParams {
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let (peak_m, [w, h]) = (place_m(self.at_km, &grid), grid.extent_m());
        if !((0.0..=w).contains(&peak_m[0]) && (0.0..=h).contains(&peak_m[1])) {
            return Err(ProcessError::Unfit(format!(
                "at_km = [{}, {}] lies outside the map, which is {} x {} km",
                peak_m[0] / 1e3,
                peak_m[1] / 1e3,
                w / 1e3,
                h / 1e3
            )));
        }
        let key = context.key.named("rmp-graph");
        let mut heights = Field::filled(grid, 0.0);
        for first in (0..self.iterations).step_by(64) {
            context.check()?;
            let draws: Vec<Vec<Raised>> = (first..(first + 64).min(self.iterations))
                .into_par_iter()
                .map(|draw| self.draw(&grid, peak_m, key.with(draw as u64)))
                .collect();
            raise(&mut heights, &draws.concat());
        }
        Ok(heights)
    }
}

impl RmpGraphParams {
    fn draw(&self, grid: &Grid, peak_m: [f64; 2], key: Key) -> Vec<Raised> {
        let cut = Arrangement::random(grid.extent_m(), self.cuts as usize, key);
        // A peak on the map's rim belongs to no face by the half-open test; nothing rises then.
        let Some(start) = cut.face_at(peak_m) else { return Vec::new() };
        let faces = cut.first_faces(start, self.faces as usize, self.order);
        let mut amount = self.height_m / self.iterations as f64;
        let raised = faces.into_iter().map(|face| {
            let outline = cut.faces[face].outline.iter().map(|p| [p[0] / grid.cell_m, p[1] / grid.cell_m]).collect();
            let raised = Raised { outline, amount: amount as f32 };
            amount *= self.damping;
            raised
        });
        raised.collect()
    }
}
