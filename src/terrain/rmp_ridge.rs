//! A range by repeated magnification and probing: draw a random Voronoi partition, raise the cells that a drawn line visits,
//! repeat.
//!
//! The line is first bent by a noise of its own, so that a line of few points does not make a straight range. Whole cells
//! rise, also where they leave the map.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{length_m, massif::Massif};
use crate::{
    grid::{Field, Grid},
    noise::{Fbm, Key},
    process::{Context, ProcessError, Shape},
};

/// A range of random Voronoi cells along a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RmpRidgeParams {
    /// The line, point by point, east and south of the map's north-west corner; across the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "the range follows the line"))]
    pub points_km: Vec<[f64; 2]>,
    /// How far the line is bent, as a standard deviation over the half width.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1", "x-effect" = "a more winding range"))]
    pub bend: f64,
    /// Height of the range above its surroundings.
    #[schemars(range(min = -12000.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "a higher range"))]
    pub height_m: f64,
    /// Distance at which the widest octave has fallen to half its height; 6 % of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km", "x-effect" = "a broader range"))]
    pub half_width_km: Option<f64>,
    /// Draws of the widest octave; each narrower one makes half as many.
    #[schemars(range(min = 1, max = 5000), extend("x-unit" = "1", "x-effect" = "smoother slopes, fewer visible polygons"))]
    pub iterations: u32,
    /// Widths raised at once, each half as wide as the one before.
    #[schemars(range(min = 1, max = 8), extend("x-unit" = "1", "x-effect" = "a sharper range with finer detail"))]
    pub octaves: u32,
    /// Height of an octave over that of the one before.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "more of the height in the narrow octaves"))]
    pub octave_share: f64,
    /// Raises each cell by a random share, so that no flat top shows.
    #[schemars(extend("x-unit" = "1", "x-effect" = "off: every cell rises alike"))]
    pub random_weights: bool,
    /// Spurs that leave it to both sides, on each half width of its length.
    #[schemars(range(min = 0.0, max = 5.0), extend("x-unit" = "1", "x-effect" = "more spurs; 0 leaves a smooth dam"))]
    pub spurs: f64,
}

impl Default for RmpRidgeParams {
    fn default() -> Self {
        Self {
            points_km: Vec::new(),
            bend: 0.6,
            height_m: 3000.0,
            half_width_km: None,
            iterations: 120,
            octaves: 5,
            octave_share: 0.75,
            random_weights: true,
            spurs: 1.0,
        }
    }
}

impl Shape for RmpRidgeParams {
    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        let path_m = self.drawn_m(grid);
        if !path_m.iter().flatten().all(|v| v.is_finite()) {
            return Err(ProcessError::Unfit("points_km has a coordinate that is not a number".to_owned()));
        }
        self.massif(grid, path_m).check()
    }

    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let key = context.key.named("rmp-ridge");
        self.massif(&grid, self.path_m(&grid, key)).heights(grid, key, context)
    }
}

impl RmpRidgeParams {
    fn half_width_m(&self, grid: &Grid) -> f64 {
        length_m(self.half_width_km, 0.06, grid)
    }

    fn massif(&self, grid: &Grid, path_m: Vec<[f64; 2]>) -> Massif {
        let half_width_m = self.half_width_m(grid);
        Massif {
            path_m,
            height_m: self.height_m,
            half_width_m,
            iterations: self.iterations,
            octaves: self.octaves,
            octave_share: self.octave_share,
            random_weights: self.random_weights,
            spurs: self.spurs,
        }
    }

    /// The line as it was drawn, in metres.
    fn drawn_m(&self, grid: &Grid) -> Vec<[f64; 2]> {
        let [w, h] = grid.extent_m();
        match self.points_km.as_slice() {
            [] => vec![[0.15 * w, 0.6 * h], [0.5 * w, 0.42 * h], [0.85 * w, 0.5 * h]],
            points => points.iter().map(|[x, y]| [x * 1e3, y * 1e3]).collect(),
        }
    }

    /// The drawn line, bent.
    fn path_m(&self, grid: &Grid, key: Key) -> Vec<[f64; 2]> {
        let drawn = self.drawn_m(grid);
        if self.bend == 0.0 {
            return drawn;
        }
        let half_width_m = self.half_width_m(grid);
        let fbm = Fbm { octaves: Some(4.0), ..Fbm::new(6.0 * half_width_m, 0.9) };
        let noise = [fbm.octaves(key.named("east"), 0.0), fbm.octaves(key.named("south"), 0.0)];
        let reach_m = self.bend * half_width_m;
        let bent = |p: [f64; 2]| [p[0] + reach_m * noise[0].value(p), p[1] + reach_m * noise[1].value(p)];
        subdivided(&drawn, 0.25 * half_width_m).into_iter().map(bent).collect()
    }
}

/// The line with points at most `spacing_m` apart, and never more than some thousands of them.
fn subdivided(line: &[[f64; 2]], spacing_m: f64) -> Vec<[f64; 2]> {
    let mut points = vec![line[0]];
    for leg in line.windows(2) {
        let (a, b) = (leg[0], leg[1]);
        let parts = (libm::hypot(b[0] - a[0], b[1] - a[1]) / spacing_m).ceil().clamp(1.0, 4000.0) as usize;
        points.extend((1..=parts).map(|i| {
            let t = i as f64 / parts as f64;
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        }));
    }
    points
}
