//! A massif by repeated magnification and probing with lines: cut the map by random lines, raise the face that holds the peak
//! and the next few faces around it, repeat.
//!
//! Faces are taken breadth first (a compact massif) or depth first (a chain that wanders off), each `damping` times as much
//! as the one before. For the first face alone the expected profile is `2^(−d/B)` with `B = P·ln 2/(2c)`, `c` lines on a map
//! of perimeter `P`: the chance that no line parts two points. The peak itself rises to `height_m` exactly. Straight lines
//! average to a round cone, so all outlines are bent by one noise that leaves the peak where it is.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{longer_side_m, place_m};
use crate::{
    grid::{Field, Grid},
    noise::{Fbm, Key},
    process::{Context, ProcessError, Shape},
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
    /// How far the faces' outlines are bent, as a standard deviation over the map's longer side.
    #[schemars(range(min = 0.0, max = 0.1), extend("x-unit" = "1", "x-effect" = "a less regular massif with spurs"))]
    pub bend: f64,
}

impl Default for RmpGraphParams {
    fn default() -> Self {
        Self {
            at_km: None,
            height_m: 3000.0,
            cuts: 14,
            faces: 5,
            order: Order::Breadth,
            damping: 0.9,
            iterations: 200,
            bend: 0.035,
        }
    }
}

impl Shape for RmpGraphParams {
    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        let (peak_m, [w, h]) = (place_m(self.at_km, grid), grid.extent_m());
        if !((0.0..=w).contains(&peak_m[0]) && (0.0..=h).contains(&peak_m[1])) {
            return Err(ProcessError::Unfit(format!(
                "at_km = [{}, {}] lies outside the map, which is {} x {} km",
                peak_m[0] / 1e3,
                peak_m[1] / 1e3,
                w / 1e3,
                h / 1e3
            )));
        }
        Ok(())
    }

    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let peak_m = place_m(self.at_km, &grid);
        let key = context.key.named("rmp-graph");
        let bent = self.bending(&grid, peak_m, key);
        let mut heights = Field::filled(grid, 0.0);
        for first in (0..self.iterations).step_by(64) {
            context.check()?;
            let draws: Vec<Vec<Raised>> = (first..(first + 64).min(self.iterations))
                .into_par_iter()
                .map(|draw| self.draw(&grid, peak_m, &bent, key.with(draw as u64)))
                .collect();
            raise(&mut heights, &draws.concat());
        }
        Ok(heights)
    }
}

impl RmpGraphParams {
    /// Where the noise moves a point.
    fn bending(&self, grid: &Grid, peak_m: [f64; 2], key: Key) -> impl Fn([f64; 2]) -> [f64; 2] + Sync + use<> {
        let side_m = longer_side_m(grid);
        let fbm = Fbm { octaves: Some(4.0), ..Fbm::new(0.25 * side_m, 1.0) };
        let noise = [fbm.octaves(key.named("east"), 0.0), fbm.octaves(key.named("south"), 0.0)];
        let reach_m = self.bend * side_m;
        let home = [noise[0].value(peak_m), noise[1].value(peak_m)];
        move |p| [0, 1].map(|i| p[i] + reach_m * (noise[i].value(p) - home[i]))
    }

    fn draw(&self, grid: &Grid, peak_m: [f64; 2], bent: &impl Fn([f64; 2]) -> [f64; 2], key: Key) -> Vec<Raised> {
        // Bent outlines may not show the rim that they began with: cut a wider rectangle, by as many lines more as fit its
        // perimeter.
        let [w, h] = grid.extent_m();
        let margin_m = 5.0 * self.bend * longer_side_m(grid);
        let wider = 1.0 + 4.0 * margin_m / (w + h);
        let cut = Arrangement::random(
            [w + 2.0 * margin_m, h + 2.0 * margin_m],
            (self.cuts as f64 * wider).round() as usize,
            key,
        );
        let peak_m = [peak_m[0] + margin_m, peak_m[1] + margin_m];
        // A peak on the map's rim belongs to no face by the half-open test; nothing rises then.
        let Some(start) = cut.face_at(peak_m) else { return Vec::new() };
        let faces = cut.first_faces(start, self.faces as usize, self.order);
        let mut amount = self.height_m / self.iterations as f64;
        let spacing_m = if self.bend > 0.0 { longer_side_m(grid) / 128.0 } else { f64::INFINITY };
        let raised = faces.into_iter().map(|face| {
            let outline = subdivided(&cut.faces[face].outline, spacing_m);
            let outline = outline.into_iter().map(|p| {
                let p = [p[0] - margin_m, p[1] - margin_m];
                if self.bend > 0.0 { bent(p) } else { p }
            });
            let raised = Raised {
                outline: outline.map(|p| [p[0] / grid.cell_m, p[1] / grid.cell_m]).collect(),
                amount: amount as f32,
            };
            amount *= self.damping;
            raised
        });
        raised.collect()
    }
}

/// The closed outline with corners at most `spacing_m` apart.
fn subdivided(outline: &[[f64; 2]], spacing_m: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        let parts = (libm::hypot(b[0] - a[0], b[1] - a[1]) / spacing_m).ceil().clamp(1.0, 512.0) as usize;
        points.extend((0..parts).map(|k| {
            let t = k as f64 / parts as f64;
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        }));
    }
    points
}
