//! What a rain of particles can be told.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{erosion::stage::Lock, grid::Grid};

/// Standard gravity, m/s².
pub(super) const GRAVITY: f64 = 9.80665;
/// Density of water, kg/m³.
const WATER: f64 = 1000.0;
/// Smoothing length over spacing: some 56 neighbours.
pub(super) const RATIO: f64 = 1.2;
/// How much faster sound is than anything else: a stop from full speed presses water together by 1/50, and so does a column
/// as high as a fall to that speed.
pub(super) const SOUND: f64 = 5.0;
/// Most of a smoothing length that sound and flow may cross in a sub-step.
pub(super) const COURANT: f64 = 0.3;
/// Speed at which large drops fall through air, m/s (Gunn and Kinzer 1949): falling water breaks up into them.
const DROPS: f64 = 9.2;
/// Share of `h·c` that the water has as viscosity at least, to wear off the ringing of a weakly compressible liquid:
/// Monaghan's α of 0.1 over 2(D + 2).
pub(super) const NUMERIC: f64 = 0.01;
/// Most sub-steps that a run may need.
const MOST_SUB_STEPS: f64 = 3e5;
/// Cells up to which a particle is a puddle, m.
const MADE_FOR_M: f64 = 5.0;

/// Rain as particles of water that push each other, run down, dig and lay down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RainParticlesParams {
    /// How long the water runs.
    #[schemars(range(min = 0.01, max = 1000.0), extend("x-unit" = "min", "x-effect" = "deeper rills, larger fans"))]
    pub duration_min: f64,
    /// Most particles alive at once; it rains no further while there are as many.
    #[schemars(range(min = 1.0, max = 1000000.0), extend("x-unit" = "1", "x-effect" = "more water at once, slower"))]
    pub particles: f64,
    /// Distance of particles in water at rest; 0 for half a cell.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "m", "x-effect" = "larger and fewer parcels of water"))]
    pub spacing_m: f64,
    /// Rain where it rains.
    #[schemars(range(min = 0.0, max = 100000.0), extend("x-unit" = "mm/h", "x-effect" = "more particles a second"))]
    pub rain_mm_per_h: f64,
    /// How long a particle lives; its power to carry fades over the last quarter.
    #[schemars(range(min = 1.0, max = 100000.0), extend("x-unit" = "s", "x-effect" = "longer ways, more water at once"))]
    pub lifespan_s: f64,
    /// Where the rain's disc is, from west to east.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "rain further east"))]
    pub rain_x: f64,
    /// Where the rain's disc is, from north to south.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "rain further south"))]
    pub rain_y: f64,
    /// Radius of the rain's disc over the map's shorter side; 0 for rain everywhere.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "rain over more land"))]
    pub rain_radius: f64,
    /// Kinematic viscosity: of the eddies that are too small for particles, or of mud. At least a hundredth of smoothing
    /// length times speed of sound, some 0.1 at half a metre: less rings.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "m2/s", "x-effect" = "smoother, stickier flow"))]
    pub viscosity_m2_per_s: f64,
    /// Surface tension; that of water, 0.073, is felt by particles of centimetres only.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "N/m", "x-effect" = "rounder drops"))]
    pub surface_tension_n_per_m: f64,
    /// Speed off the ground over speed onto it.
    #[schemars(range(min = 0.0, max = 0.2), extend("x-unit" = "1", "x-effect" = "livelier splashes"))]
    pub restitution: f64,
    /// Stress on the bed over density and square of speed: an eighth of Darcy and Weisbach's factor.
    #[schemars(range(min = 0.005, max = 10.0), extend("x-unit" = "1", "x-effect" = "slower water"))]
    pub friction: f64,
    /// Share of its own volume that water carries at a metre a second down a wall.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "s/m", "x-effect" = "more carried, deeper rills"))]
    pub capacity_s_per_m: f64,
    /// Share of what is missing to the capacity, or over it, that is dug or laid down in a second.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1/s", "x-effect" = "shorter ways between digging and laying down"))]
    pub acidity_per_s: f64,
    /// Speed below which water carries nothing; that of sand on its bed is 0.2 to 0.3 (Hjulstrom 1935).
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "m/s", "x-effect" = "less dug by slow water"))]
    pub least_speed_m_per_s: f64,
    /// Bed time over water time: how many such showers one stands for. Multiplies what the bed gives and takes.
    #[schemars(range(min = 0.0, max = 100000.0), extend("x-unit" = "1", "x-effect" = "more erosion by as much water"))]
    pub morphological_factor: f64,
    /// What stays where it is.
    #[schemars(extend("x-effect" = "coast: land stays land, sea stays sea"))]
    pub lock: Lock,
}

impl Default for RainParticlesParams {
    fn default() -> Self {
        Self {
            duration_min: 4.0,
            particles: 12e3,
            spacing_m: 0.0,
            rain_mm_per_h: 3000.0,
            lifespan_s: 60.0,
            rain_x: 0.5,
            rain_y: 0.5,
            rain_radius: 0.0,
            viscosity_m2_per_s: 0.02,
            surface_tension_n_per_m: 0.0,
            restitution: 0.0,
            friction: 0.1,
            capacity_s_per_m: 0.03,
            acidity_per_s: 0.5,
            least_speed_m_per_s: 0.3,
            morphological_factor: 10.0,
            lock: Lock::None,
        }
    }
}

impl RainParticlesParams {
    /// What keeps these parameters from running on a grid, and what to change.
    pub fn check(&self, grid: &Grid) -> Result<(), String> {
        let spacing = self.spacing(grid);
        let cells = spacing / grid.cell_m;
        if !(0.05..=1.0).contains(&cells) {
            return Err(format!(
                "particles {spacing:.3} m apart do not suit cells of {:.3} m; set spacing_m from {:.3} to {:.3}, or to 0",
                grid.cell_m,
                0.05 * grid.cell_m,
                grid.cell_m
            ));
        }
        let sub_steps = self.most_sub_steps(grid);
        if sub_steps > MOST_SUB_STEPS {
            let share = MOST_SUB_STEPS / sub_steps;
            return Err(format!(
                "particles {spacing:.3} m apart may need {sub_steps:.1e} sub-steps of {:.1e} s, {MOST_SUB_STEPS:.0e} at \
                 most; lower duration_min to {:.3}, viscosity_m2_per_s or surface_tension_n_per_m, or raise spacing_m \
                 or friction",
                self.least_step_s(spacing),
                self.duration_min * share
            ));
        }
        Ok(())
    }

    /// What to know before a run on a grid whose cells these particles are not made for.
    pub fn warning(&self, grid: &Grid) -> Option<String> {
        (grid.cell_m > MADE_FOR_M).then(|| {
            format!(
                "cells of {:.1} m are too coarse for particles of water (up to {MADE_FOR_M} m): each is a pond of {:.0} m3",
                grid.cell_m,
                libm::pow(self.spacing(grid), 3.0)
            )
        })
    }

    /// Sub-steps that a run needs if water goes as fast as it may all the time.
    pub fn most_sub_steps(&self, grid: &Grid) -> f64 {
        self.duration_s() / self.least_step_s(self.spacing(grid))
    }

    /// How long the water runs, s.
    pub(super) fn duration_s(&self) -> f64 {
        60.0 * self.duration_min
    }

    /// Distance of particles in water at rest, m.
    pub(super) fn spacing(&self, grid: &Grid) -> f64 {
        if self.spacing_m > 0.0 { self.spacing_m } else { 0.5 * grid.cell_m }
    }

    /// A speed that no particle exceeds, m/s: twice what friction lets a layer reach on a wall, or that of drops.
    pub(super) fn most_speed(&self, spacing: f64) -> f64 {
        DROPS.max(2.0 * (GRAVITY * spacing / self.friction).sqrt())
    }

    /// Cohesion with the wanted surface tension, 1/s²: for a pair force f, uniform density and a sharp surface the tension is
    /// `π/8·n²·∫r⁴·f dr` (Kirkwood and Buff 1949); the integral is that of Wendland's kernel.
    pub(super) fn cohesion(&self, h: f64) -> f64 {
        8.0 * self.surface_tension_n_per_m / (std::f64::consts::PI * WATER * h * h * h * 0.067_522)
    }

    /// Longest sub-step, s, at a speed and a speed of sound, for sound, viscosity and surface waves.
    pub(super) fn step_s(&self, spacing: f64, speed: f64, sound: f64) -> f64 {
        let h = RATIO * spacing;
        let viscosity = self.viscosity_m2_per_s.max(NUMERIC * h * sound);
        let flow = COURANT * h / (speed + sound);
        let creep = 0.125 * h * h / viscosity;
        let waves = 0.25 / self.cohesion(h).sqrt();
        flow.min(creep).min(waves)
    }

    /// The shortest that a sub-step can get, s.
    pub(super) fn least_step_s(&self, spacing: f64) -> f64 {
        let most = self.most_speed(spacing);
        self.step_s(spacing, most, SOUND * most)
    }
}
