//! What a person can set, and whether it fits a map.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    erosion::stage::Lock,
    grid::{Edges, Grid},
};

/// More steps than anyone waits for.
const MOST_STEPS: f64 = 1e6;
/// Cells that two cores do in a minute, about.
const CELLS_PER_MIN: f64 = 1e10;
/// Depth of water that steps are counted for before anything is known of it, m.
const METRE: f64 = 1.0;
/// Gravity, m/s².
const GRAVITY: f64 = 9.81;

/// How fluxes are kept at the faces of cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Flux {
    /// One signed flux a face: waves run at their right speed.
    #[default]
    Signed,
    /// Two one-sided fluxes a face after Mei, Decaudin and Hu (2007): waves run faster by the root of two.
    Mei,
}

/// How sediment travels with the water.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sediment {
    /// On the water's own fluxes, upwind: nothing is lost, sharp fronts blur.
    #[default]
    Flux,
    /// Its concentration is traced back along the velocity; what that loses is put back in proportion.
    SemiLagrangian,
    /// The same, forth and back, so that it blurs less.
    Maccormack,
}

/// A place where a river enters the map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Distance from the west rim.
    #[schemars(extend("x-unit" = "km", "x-effect" = "further east"))]
    pub x_km: f64,
    /// Distance from the north rim.
    #[schemars(extend("x-unit" = "km", "x-effect" = "further south"))]
    pub y_km: f64,
    /// Radius of the disc that the water wells up in.
    #[schemars(range(min = 0.0, max = 100000.0), extend("x-unit" = "m", "x-effect" = "a wider, calmer source"))]
    pub radius_m: f64,
    /// Water that it brings.
    #[schemars(range(min = 0.0, max = 1000000.0), extend("x-unit" = "m3/s", "x-effect" = "a larger river"))]
    pub flow_m3_per_s: f64,
}

/// Storm water runs over the land, takes rock along and lays it down where it slows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PipesParams {
    /// How long water runs, with the time in which it drains.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "h", "x-effect" = "deeper gullies, larger fans"))]
    pub duration_h: f64,
    /// Share of the duration at its end without rain and springs, for water to drain and sediment to settle.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "share", "x-effect" = "drier land at the end"))]
    pub recession: f64,
    /// Rain.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "mm/h", "x-effect" = "more water, faster carving"))]
    pub rain_mm_per_h: f64,
    /// Middle of the disc that it rains in, from the west rim.
    #[schemars(range(min = 0.0, max = 100000.0), extend("x-unit" = "km", "x-effect" = "rain further east"))]
    pub rain_x_km: f64,
    /// Middle of the disc that it rains in, from the north rim.
    #[schemars(range(min = 0.0, max = 100000.0), extend("x-unit" = "km", "x-effect" = "rain further south"))]
    pub rain_y_km: f64,
    /// Radius of the disc that it rains in; 0 for rain everywhere.
    #[schemars(range(min = 0.0, max = 100000.0), extend("x-unit" = "km", "x-effect" = "a wider storm"))]
    pub rain_radius_km: f64,
    /// Whether more falls where the layer `rain` has more.
    #[schemars(extend("x-effect" = "rain shadows stay drier"))]
    pub rain_by_map: bool,
    /// Places where rivers enter the map.
    pub springs: Vec<Spring>,
    /// Water that dries up.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "mm/h", "x-effect" = "smaller lakes and streams"))]
    pub evaporation_mm_per_h: f64,
    /// Whether land below the sea's level is under a sea of that level.
    pub sea: bool,
    /// How fluxes are kept.
    pub flux: Flux,
    /// Whether water carries its momentum along: bores and jets, at several times the work.
    pub momentum: bool,
    /// Manning's roughness.
    #[schemars(range(min = 0.0, max = 0.5), extend("x-unit" = "s/m^(1/3)", "x-effect" = "slower, deeper water"))]
    pub manning_n: f64,
    /// Rock that a volume of water can carry, by its speed and the sine of the ground's tilt.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "s/m", "x-effect" = "more rock in the water"))]
    pub capacity_s_per_m: f64,
    /// Tilt that ground has at least for what water can carry.
    #[schemars(range(min = 0.0, max = 45.0), extend("x-unit" = "deg", "x-effect" = "sediment goes further on flats"))]
    pub tilt_floor_deg: f64,
    /// Depth below which water has little force.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "m", "x-effect" = "streams begin further downhill"))]
    pub film_m: f64,
    /// Depth from which water spares its bed.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "m", "x-effect" = "deeper rivers still carve"))]
    pub shallow_m: f64,
    /// Depth in which water carries nothing.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "m", "x-effect" = "deeper rivers still carve"))]
    pub deep_m: f64,
    /// Share of the missing sediment that water takes up from soft ground in a second.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1/s", "x-effect" = "faster carving"))]
    pub dissolve_per_s: f64,
    /// Share of the sediment in excess that settles in a second.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1/s", "x-effect" = "fans nearer to the gullies"))]
    pub settle_per_s: f64,
    /// Softness of the ground at the beginning; what has been laid down comes up to 1.
    #[schemars(range(min = 0.01, max = 1.0), extend("x-unit" = "share", "x-effect" = "rock gives way faster"))]
    pub rock_softness: f64,
    /// Softness that each metre laid down adds and each metre worn off takes away.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1/m", "x-effect" = "deposits are washed away sooner"))]
    pub softening_per_m: f64,
    /// How sediment travels.
    pub sediment: Sediment,
    /// Steepest slope of loose ground.
    #[schemars(range(min = 1.0, max = 89.0), extend("x-unit" = "deg", "x-effect" = "steeper banks can stand"))]
    pub talus_angle_deg: f64,
    /// Steepest slope of ground that stands in water; never more than that of dry ground.
    #[schemars(range(min = 1.0, max = 89.0), extend("x-unit" = "deg", "x-effect" = "narrower gullies"))]
    pub wet_talus_angle_deg: f64,
    /// How fast steeper ground slides, in the bed's time; 0 for never.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "1/h", "x-effect" = "banks give way faster"))]
    pub slip_per_h: f64,
    /// The bed's time over the water's: what an hour of water does to its bed counts for so many.
    #[schemars(range(min = 0.001, max = 1000.0), extend("x-unit" = "", "x-effect" = "more wear for the same water"))]
    pub morphological_factor: f64,
    /// What stays where it is.
    #[schemars(extend("x-effect" = "coast: land stays land, sea stays sea"))]
    pub lock: Lock,
}

impl Default for PipesParams {
    fn default() -> Self {
        Self {
            duration_h: 3.0,
            recession: 0.15,
            rain_mm_per_h: 60.0,
            rain_x_km: 0.0,
            rain_y_km: 0.0,
            rain_radius_km: 0.0,
            rain_by_map: false,
            springs: Vec::new(),
            evaporation_mm_per_h: 1.0,
            sea: true,
            flux: Flux::Signed,
            momentum: false,
            manning_n: 0.04,
            capacity_s_per_m: 0.12,
            tilt_floor_deg: 0.5,
            film_m: 0.03,
            shallow_m: 5.0,
            deep_m: 15.0,
            dissolve_per_s: 0.1,
            settle_per_s: 0.1,
            rock_softness: 0.5,
            softening_per_m: 0.5,
            sediment: Sediment::Flux,
            talus_angle_deg: 36.0,
            wet_talus_angle_deg: 18.0,
            slip_per_h: 4.0,
            morphological_factor: 80.0,
            lock: Lock::None,
        }
    }
}

impl PipesParams {
    /// Whether they fit a map; if not, what is wrong and how to mend it.
    pub fn check(&self, grid: &Grid) -> Result<(), String> {
        let [width, height] = grid.extent_m().map(|m| m / 1e3);
        for (i, spring) in self.springs.iter().enumerate() {
            let inside = (0.0..=width).contains(&spring.x_km) && (0.0..=height).contains(&spring.y_km);
            if !inside {
                return Err(format!(
                    "springs[{i}] at ({} km, {} km) is outside the map; x_km must be from 0 to {width}, y_km from 0 to \
                     {height}",
                    spring.x_km, spring.y_km
                ));
            }
            if !(spring.flow_m3_per_s >= 0.0 && spring.radius_m >= 0.0) {
                return Err(format!("springs[{i}]: flow_m3_per_s and radius_m must be 0 or more"));
            }
        }
        if self.momentum && self.flux == Flux::Mei {
            return Err("momentum needs flux = \"signed\"; set it, or momentum = false".to_owned());
        }
        if self.lock == Lock::Coast && !self.sea {
            return Err("lock = \"coast\" needs a sea; set sea = true, or lock = \"none\"".to_owned());
        }
        if self.deep_m < self.shallow_m {
            return Err(format!(
                "deep_m = {} is less than shallow_m = {}; raise deep_m or lower shallow_m",
                self.deep_m, self.shallow_m
            ));
        }
        self.check_depth(grid, METRE)?;
        for (i, spring) in self.springs.iter().enumerate() {
            let steps = self.steps_of(spring, grid.cell_m);
            if steps > MOST_STEPS {
                return Err(format!(
                    "springs[{i}] wells up so fast on cells of {} m that it takes {steps:.1e} steps of water; lower \
                     flow_m3_per_s or duration_h, or raise radius_m",
                    grid.cell_m
                ));
            }
        }
        if self.rain_radius_km > 0.0 {
            let [x, y] = [self.rain_x_km.clamp(0.0, width), self.rain_y_km.clamp(0.0, height)];
            let away = libm::hypot(x - self.rain_x_km, y - self.rain_y_km);
            if away >= self.rain_radius_km {
                return Err(format!(
                    "the rain at ({} km, {} km) with rain_radius_km = {} misses the map; x must be from 0 to {width}, y \
                     from 0 to {height}, or raise rain_radius_km",
                    self.rain_x_km, self.rain_y_km, self.rain_radius_km
                ));
            }
        }
        Ok(())
    }

    /// Whether it ends in a time that anyone waits for, with water of a depth; if not, what would help.
    pub(super) fn check_depth(&self, grid: &Grid, depth_m: f64) -> Result<(), String> {
        let steps = self.steps_in(grid, depth_m);
        if steps <= MOST_STEPS {
            return Ok(());
        }
        Err(format!(
            "{} h of water {depth_m:.3} m deep on cells of {} m are {steps:.1e} steps of it; lower duration_h to {:.3} and \
             raise morphological_factor instead",
            self.duration_h,
            grid.cell_m,
            self.duration_h * MOST_STEPS / steps
        ))
    }

    /// What to know of a run that takes long.
    pub(super) fn patience(&self, grid: &Grid) -> Option<String> {
        let steps = self.sub_steps(grid);
        let minutes = steps * grid.cells() as f64 / CELLS_PER_MIN;
        (minutes >= 1.0).then(|| {
            format!(
                "about {steps:.0} steps of water, some {minutes:.0} min on two cores; lakes deeper than a metre take more, \
                 by the root of their depth"
            )
        })
    }

    /// Steps of water that it takes, about: in water of a metre, at springs as deep as these make it, and within a rim that
    /// keeps all of it in water as deep as that.
    pub fn sub_steps(&self, grid: &Grid) -> f64 {
        let springs = self.springs.iter().map(|spring| self.steps_of(spring, grid.cell_m));
        let kept = if grid.edges == Edges::Open { 0.0 } else { self.depth_kept(grid) };
        springs.fold(self.steps_in(grid, METRE.max(kept)), f64::max)
    }

    /// Depth of water that takes as many steps as what rises evenly to where all of it stands on the map, m.
    pub(super) fn depth_kept(&self, grid: &Grid) -> f64 {
        let area = grid.cell_area_m2() * grid.cells() as f64;
        let springs: f64 = self.springs.iter().map(|spring| spring.flow_m3_per_s).sum();
        let rise = 1e-3 / 3600.0 * self.rain_mm_per_h + springs / area;
        // The mean of the root of a depth that rises to 1 is 2/3.
        4.0 / 9.0 * rise * 3600.0 * self.duration_h * (1.0 - self.recession)
    }

    /// Steps in water of a depth, by the speed of its waves.
    fn steps_in(&self, grid: &Grid, depth_m: f64) -> f64 {
        3600.0 * self.duration_h * (GRAVITY * depth_m).sqrt() / (0.64 * grid.cell_m)
    }

    /// Steps that a spring asks for, about: its water rises until it runs off to all sides as fast as waves.
    fn steps_of(&self, spring: &Spring, cell_m: f64) -> f64 {
        let disc = std::f64::consts::PI * spring.radius_m * spring.radius_m;
        let area = disc.max(cell_m * cell_m);
        let depth = libm::pow(spring.flow_m3_per_s / (4.0 * area.sqrt() * GRAVITY.sqrt()), 2.0 / 3.0).max(1e-4);
        // A step is a share of what a wave takes for a cell, and of what the water takes to double.
        let step_s =
            (0.64 * cell_m / (GRAVITY * depth).sqrt()).min(0.1 * depth * area / spring.flow_m3_per_s.max(1e-12));
        3600.0 * self.duration_h * (1.0 - self.recession) / step_s
    }

    /// Whether anything is ever rained on or sprung up in a place of its own.
    pub(super) fn uneven(&self) -> bool {
        !self.springs.is_empty() || self.rain_radius_km > 0.0
    }
}
