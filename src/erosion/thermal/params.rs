//! What a recipe may say of slides.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::erosion::stage::Lock;

/// Most of `K·Δt` in a pass of the flux form: just below where a maximum could grow, `1 / (4 + 4/√2)`.
pub(super) const MOST_FLUX: f64 = 0.14;
/// Most of an excess that a cell sheds in a pass of the cellular form: a pit among eight donors stays below them.
pub(super) const MOST_CELLS: f64 = 0.11;

/// What is too steep slides down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ThermalParams {
    /// How long slopes have to come down.
    #[schemars(range(min = 0.001, max = 1e7), extend("x-unit" = "yr", "x-effect" = "longer screes, nearer to rest"))]
    pub duration_yr: f64,
    /// Share of what is too steep that slides in a year.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "1/yr", "x-effect" = "the same in less time"))]
    pub rate_per_yr: f64,
    /// How ground slides.
    #[schemars(extend("x-effect" = "spread: screes without ribs; flux: faster, but screes fall straight down the raster; cells: Olsen's automaton"))]
    pub method: ThermalMethod,
    /// Steepest slope on which loose ground rests: sand 30 to 35, scree 33 to 38, gravel 35 to 45.
    #[schemars(range(min = 1.0, max = 85.0), extend("x-unit" = "deg", "x-effect" = "steeper, shorter screes"))]
    pub talus_angle_deg: f64,
    /// Steepest slope on which rock stands; the angle of loose ground if that is steeper.
    #[schemars(range(min = 1.0, max = 89.0), extend("x-unit" = "deg", "x-effect" = "cliffs stand above their screes"))]
    pub rock_angle_deg: f64,
    /// Height above the sea from which on rock is harder.
    #[schemars(range(min = -1e4, max = 1e6), extend("x-unit" = "m", "x-effect" = "moves the hard rock up"))]
    pub hard_from_m: f64,
    /// Height above the sea from which on rock is as hard as it gets.
    #[schemars(range(min = -1e4, max = 1e6), extend("x-unit" = "m", "x-effect" = "a longer passage from soft to hard"))]
    pub hard_to_m: f64,
    /// Share of the rate that is left up there; 1 for the same rock everywhere.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "summits wear like the rest"))]
    pub hard_rate: f64,
    /// Rasters of larger cells, each twice the one before, on which the ground slides first.
    #[schemars(range(min = 0, max = 3), extend("x-unit" = "1", "x-effect" = "long slopes come to rest in fewer passes"))]
    pub coarse_levels: u32,
    /// Whether temperature and rain set the pace, where a climate is known; the rate is then that of 10 °C and 1000 mm.
    #[schemars(extend("x-effect" = "true: quick where it is warm and wet or freezes and thaws, slow where it is dry"))]
    pub weathering: bool,
    /// What stays where it is.
    #[schemars(extend("x-effect" = "coast: land stays land, sea stays sea"))]
    pub lock: Lock,
}

/// How ground slides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ThermalMethod {
    /// Over each face as much as its slope exceeds the talus.
    Flux,
    /// What a cell's steepest way down is too steep by goes to all lower neighbours.
    #[default]
    Spread,
    /// Olsen's cellular automaton.
    Cells,
}

impl Default for ThermalParams {
    fn default() -> Self {
        Self {
            duration_yr: 1000.0,
            rate_per_yr: 0.05,
            method: ThermalMethod::Spread,
            talus_angle_deg: 35.0,
            rock_angle_deg: 50.0,
            hard_from_m: 0.0,
            hard_to_m: 0.0,
            hard_rate: 1.0,
            coarse_levels: 0,
            weathering: true,
            lock: Lock::None,
        }
    }
}

impl ThermalParams {
    /// The most that a pass may move, as a share of what is too steep.
    pub(super) fn most(&self) -> f64 {
        match self.method {
            ThermalMethod::Flux => MOST_FLUX,
            ThermalMethod::Spread | ThermalMethod::Cells => MOST_CELLS,
        }
    }

    /// Passes over a number of years, and what each of them moves.
    pub(super) fn passes(&self, years: f64) -> (u64, f32) {
        let share = self.rate_per_yr * years;
        let passes = (share / self.most()).ceil();
        (passes as u64, (share / passes.max(1.0)) as f32)
    }

    /// Rise over run at which loose ground and rock begin to slide.
    pub(super) fn talus(&self) -> [f32; 2] {
        let rise = |deg: f64| libm::tan(deg.to_radians()) as f32;
        [rise(self.talus_angle_deg), rise(self.rock_angle_deg.max(self.talus_angle_deg))]
    }
}
