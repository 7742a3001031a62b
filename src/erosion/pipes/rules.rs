//! Parameters as the loops want them, and where water comes from.

use crate::{
    erosion::bed::Bed,
    grid::{Edges, Grid},
};

use super::{
    flow::hi,
    params::{Flux, PipesParams, Sediment},
};

/// Gravity, m/s².
pub const GRAVITY: f32 = 9.81;
/// A pipe is at least this deep, m.
pub const PIPE_M: f32 = 1e-4;
/// Water shallower than this has no speed to speak of, m.
pub const STILL_M: f32 = 1e-3;
/// Water shallower than this has no say in how long a step may be, m.
pub const SHEET_M: f32 = 1e-2;
/// Running water is at most so many times as fast as its waves: steep beds are the rougher (Jarrett 1984; Grant 1997 finds
/// hardly more than 1).
pub const FROUDE: f32 = 1.5;
/// Water stands that is slower than this share of its waves' speed, the more the slower.
pub const SLOW: f32 = 0.3;
/// Shallower water is less and less what stands, m: a film goes with its ground.
pub const POND_M: f32 = 0.5;
/// Water's surface falls at least this steeply over an open rim.
pub const RIM_FALL: f32 = 1e-3;
/// Most rock in a volume of water and rock: beyond it nothing flows like water.
pub const THICKEST: f32 = 0.4;
/// Most of the way to a neighbour's height that a bed goes in one step.
pub const TIMID: f32 = 0.25;
/// Most that a bed changes in one step, in cells.
pub const STRIDE: f32 = 0.02;
/// Most that exchange with the water changes a bed in one step, in depths of that water: it has time to follow.
pub const CALM: f32 = 0.05;
/// How far above the mean of its neighbours a bed can be and still get sediment, in cells: what lies unevenly evens out.
pub const BUMP: f32 = 0.005;
/// Least way from the sea's level of heights that may not cross it, m.
const LEAST_MARGIN_M: f32 = 1e-4;
/// Most of an excess that slides over a face in one step; eight faces stay monotone to 0.146.
pub const SLIDE: f32 = 0.07;

/// What holds for a whole stage.
#[derive(Clone, Debug)]
pub struct Rules {
    pub width: usize,
    pub height: usize,
    pub edges: Edges,
    pub cell_m: f32,
    /// Sea level, m; below everything without a sea.
    pub sea_m: f32,
    pub locked: bool,
    /// How far from the sea's level heights stay that may not cross it, m.
    pub margin_m: f32,
    /// g·n², and 1/n or infinity.
    pub rough: f32,
    pub smooth: f32,
    pub capacity: f32,
    /// Least sin² of the tilt.
    pub tilt2: f32,
    pub per_film: f32,
    pub shallow_m: f32,
    pub per_deep: f32,
    pub factor: f32,
    /// Share of what a bed rises that standing water's depth loses, so that its surface stays.
    pub keep: f32,
    pub rock_softness: f32,
    pub softening: f32,
    /// Fall to a neighbour that loose ground can have, m.
    pub talus_m: f32,
    /// How much less it is in water, m.
    pub slack_m: f32,
    pub mei: bool,
    /// Whether sediment goes with the fluxes, in the sweep itself.
    pub fluxed: bool,
}

impl Rules {
    pub fn new(p: &PipesParams, grid: &Grid, sea_m: f32, locked: bool) -> Self {
        let cell_m = grid.cell_m as f32;
        let n = p.manning_n as f32;
        let dry = libm::tan(p.talus_angle_deg.to_radians());
        let wet = libm::tan(p.wet_talus_angle_deg.to_radians()).min(dry);
        let sine = libm::sin(p.tilt_floor_deg.to_radians());
        Self {
            width: grid.width,
            height: grid.height,
            edges: grid.edges,
            cell_m,
            sea_m: if p.sea { sea_m } else { f32::NEG_INFINITY },
            locked,
            margin_m: LEAST_MARGIN_M,
            rough: GRAVITY * n * n,
            smooth: if n > 0.0 { 1.0 / n } else { f32::MAX },
            capacity: p.capacity_s_per_m as f32,
            tilt2: (sine * sine) as f32,
            per_film: (1.0 / p.film_m.max(1e-6)) as f32,
            shallow_m: p.shallow_m as f32,
            per_deep: (1.0 / (p.deep_m - p.shallow_m).max(1e-3)) as f32,
            factor: p.morphological_factor as f32,
            keep: (1.0 - 1.0 / p.morphological_factor).max(0.0) as f32,
            rock_softness: p.rock_softness as f32,
            softening: p.softening_per_m as f32,
            talus_m: (grid.cell_m * dry) as f32,
            slack_m: (grid.cell_m * (dry - wet)) as f32,
            mei: p.flux == Flux::Mei,
            fluxed: p.sediment == Sediment::Flux,
        }
    }

    /// Keeps locked heights so far from a sea at `level_m` that the sum of a world's layers rounds to the same side.
    pub fn stay_clear(&mut self, level_m: f64, bed: &Bed) {
        let most = bed.start.iter().fold(bed.sea_m.abs(), |most, z| hi(z.abs(), most));
        // Four ulp of the highest column that there may be.
        self.margin_m = hi(4.0 * f32::EPSILON * (level_m.abs() as f32 + 2.0 * most), LEAST_MARGIN_M);
    }

    /// The row of memory that row `y` is, beyond the rim as well.
    pub fn row(&self, y: isize) -> usize {
        let h = self.height as isize;
        match self.edges {
            Edges::Wrap => y.rem_euclid(h) as usize,
            Edges::Open | Edges::Closed => y.clamp(0, h - 1) as usize,
        }
    }
}

/// What holds for one step.
#[derive(Clone, Copy, Debug)]
pub struct Beat {
    pub dt: f32,
    /// dt / cell, s/m.
    pub pace: f32,
    /// dt·g / cell, s/m·m/s².
    pub pull: f32,
    /// 4·dt·g·n².
    pub drag: f32,
    /// 4·dt / (cell·FROUDE²), s/m.
    pub steep: f32,
    /// Fastest that a cell can be crossed, m/s.
    pub fastest: f32,
    /// Rain everywhere, m, where there is no map of it.
    pub rain_m: f32,
    /// Seconds of what the map of sources says.
    pub source_s: f32,
    pub dry_m: f32,
    /// Shares of a step.
    pub dissolve: f32,
    pub settle: f32,
    pub slide: f32,
}

/// Water that falls or wells up, m/s a cell; empty where it is the same everywhere.
pub fn sources(p: &PipesParams, grid: &Grid, weights: Option<&[f32]>) -> Vec<f32> {
    if !p.uneven() && weights.is_none() {
        return Vec::new();
    }
    let rain = p.rain_mm_per_h / 3.6e6;
    let mut source: Vec<f32> = (0..grid.cells())
        .map(|i| {
            let (x, y) = grid.cell_of(i);
            let [x, y] = grid.center_m(x, y);
            let away = libm::hypot(x - 1e3 * p.rain_x_km, y - 1e3 * p.rain_y_km);
            let under = p.rain_radius_km <= 0.0 || away <= 1e3 * p.rain_radius_km;
            let weight = weights.and_then(|w| w.get(i)).map_or(1.0, |&w| w.max(0.0) as f64);
            if under { (rain * weight) as f32 } else { 0.0 }
        })
        .collect();
    for spring in &p.springs {
        let at = [1e3 * spring.x_km, 1e3 * spring.y_km];
        let cells = disc(grid, at, spring.radius_m);
        // As many cells as there are, not as the circle's area says: the river brings what it says.
        let rise = spring.flow_m3_per_s / (cells.len() as f64 * grid.cell_area_m2());
        cells.into_iter().for_each(|i| source[i] += rise as f32);
    }
    source
}

/// The cells with their centre in a disc, or the one that holds its middle.
fn disc(grid: &Grid, at: [f64; 2], radius_m: f64) -> Vec<usize> {
    let middle = |m: f64, size: usize| ((m / grid.cell_m).max(0.0) as usize).min(size - 1);
    let (cx, cy) = (middle(at[0], grid.width), middle(at[1], grid.height));
    let reach = (radius_m / grid.cell_m).ceil() as usize + 1;
    let around = |c: usize, size: usize| c.saturating_sub(reach)..c.saturating_add(reach + 1).min(size);
    let mut cells = Vec::new();
    for y in around(cy, grid.height) {
        for x in around(cx, grid.width) {
            let [mx, my] = grid.center_m(x, y);
            if libm::hypot(mx - at[0], my - at[1]) <= radius_m {
                cells.push(grid.index(x, y));
            }
        }
    }
    if cells.is_empty() { vec![grid.index(cx, cy)] } else { cells }
}
