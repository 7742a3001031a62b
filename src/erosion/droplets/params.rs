//! What a user sets, and what a droplet needs of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::erosion::stage::Lock;
use crate::grid::{Edges, Grid};

use super::{kernel, walk::Law};

/// Cells that the shortest path crosses.
const LEAST_PATH: f64 = 4.0;
/// Cells that the longest path crosses.
const MOST_PATH: f64 = 1e5;
/// Cells in the widest radius.
const MOST_RADIUS: f64 = 16.0;

/// Droplets run down slopes, cut gullies and lay down fans.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DropletsParams {
    /// How long it rains.
    #[schemars(range(min = 0.0, max = 10000000.0), extend("x-unit" = "yr", "x-effect" = "deeper gullies"))]
    pub duration_yr: f64,
    /// Rain.
    #[schemars(
        range(min = 0.0, max = 20000.0),
        extend("x-unit" = "mm/yr", "x-effect" = "deeper gullies in the same time")
    )]
    pub rain_mm_per_yr: f64,
    /// Years of land that each year of rain stands for: it multiplies what droplets wear, carry and lay down.
    #[schemars(
        range(min = 0.0, max = 100000.0),
        extend("x-unit" = "", "x-effect" = "deeper gullies from the same water")
    )]
    pub morphological_factor: f64,
    /// Droplets that the rain is parted into.
    #[schemars(range(min = 0.001, max = 100.0), extend("x-unit" = "1/cell", "x-effect" = "smoother valleys, slower"))]
    pub droplets_per_cell: f64,
    /// How far a droplet runs.
    #[schemars(range(min = 1.0, max = 1000000.0), extend("x-unit" = "m", "x-effect" = "longer valleys, slower"))]
    pub path_m: f64,
    /// How far from its path a droplet wears; one and a half cells at least.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "m", "x-effect" = "wider, smoother valleys, slower"))]
    pub radius_m: f64,
    /// Distance in which a droplet turns into the line of fall.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "m", "x-effect" = "straighter, smoother paths"))]
    pub turning_m: f64,
    /// Rock that water carries for each metre a second and sine of the slope, by volume.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "s/m", "x-effect" = "deeper gullies, larger fans"))]
    pub capacity: f64,
    /// Slope below which the capacity falls no further.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "", "x-effect" = "more is carried over level ground"))]
    pub least_slope: f64,
    /// Distance in which a droplet takes up 63 % of what it can.
    #[schemars(range(min = 0.01, max = 1000000.0), extend("x-unit" = "m", "x-effect" = "gullies begin further down"))]
    pub erosion_m: f64,
    /// Distance in which a droplet lays down 63 % of what is too much.
    #[schemars(range(min = 0.01, max = 1000000.0), extend("x-unit" = "m", "x-effect" = "longer, thinner fans"))]
    pub deposition_m: f64,
    /// Share of the water that dries up.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "1/km", "x-effect" = "valleys fade downstream"))]
    pub drying_per_km: f64,
    /// Gravity.
    #[schemars(range(min = 0.01, max = 100.0), extend("x-unit" = "m/s2", "x-effect" = "faster droplets"))]
    pub gravity_m_per_s2: f64,
    /// Drag of the ground: what a droplet loses of the square of its speed.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "1/m", "x-effect" = "slower droplets"))]
    pub drag_per_m: f64,
    /// What stays where it is.
    #[schemars(extend("x-effect" = "coast: land stays land, sea stays sea"))]
    pub lock: Lock,
}

impl Default for DropletsParams {
    fn default() -> Self {
        Self {
            duration_yr: 10_000.0,
            rain_mm_per_yr: 1000.0,
            morphological_factor: 1.0,
            droplets_per_cell: 1.0,
            path_m: 1500.0,
            radius_m: 16.0,
            turning_m: 6.0,
            capacity: 5e-4,
            least_slope: 0.01,
            erosion_m: 150.0,
            deposition_m: 50.0,
            drying_per_km: 0.3,
            gravity_m_per_s2: 9.81,
            drag_per_m: 1.0,
            lock: Lock::None,
        }
    }
}

impl DropletsParams {
    /// Whether it can run on this grid; if not, why not and what would help.
    pub fn check(&self, grid: &Grid) -> Result<(), String> {
        let (path, radius, cell_m) = (self.path_m / grid.cell_m, self.radius_m / grid.cell_m, grid.cell_m);
        let side = grid.width.min(grid.height);
        if path < LEAST_PATH {
            let least = LEAST_PATH * cell_m;
            return Err(format!("droplets cross only {path:.1} cells of {cell_m} m: set path_m to {least} or more"));
        }
        if path > MOST_PATH {
            let most = MOST_PATH * cell_m;
            return Err(format!("droplets cross {path:.0} cells of {cell_m} m: set path_m to {most} or less"));
        }
        if radius > MOST_RADIUS {
            let most = MOST_RADIUS * cell_m;
            return Err(format!("droplets are {radius:.0} cells wide: set radius_m to {most} or less"));
        }
        let least =
            if grid.edges == Edges::Wrap { 4 * super::margin(self.radius_cells(grid)) } else { super::LEAST_SIDE };
        if side < least {
            return Err(format!("a map of {side} cells a side is too small for droplets: set size to {least} or more"));
        }
        Ok(())
    }

    /// By how much the world's clock goes on, yr.
    pub fn elapsed_yr(&self) -> f64 {
        self.duration_yr * self.morphological_factor
    }

    /// Rain in all, m.
    pub(super) fn rain_m(&self) -> f64 {
        1e-3 * self.rain_mm_per_yr * self.duration_yr
    }

    /// The radius in cells, within what a kernel can be.
    pub(super) fn radius_cells(&self, grid: &Grid) -> f64 {
        (self.radius_m / grid.cell_m).clamp(kernel::LEAST_RADIUS, MOST_RADIUS)
    }

    /// What a droplet of so many metres of water on a cell does.
    pub(super) fn law(&self, grid: &Grid, depth_m: f64) -> Law {
        let step_m = grid.cell_m;
        let within = |length_m: f64| (1.0 - libm::exp(-step_m / length_m)) as f32;
        Law {
            kept_way: if self.turning_m > 0.0 { libm::exp(-step_m / self.turning_m) as f32 } else { 0.0 },
            twice_gravity: (2.0 * self.gravity_m_per_s2) as f32,
            slowed: (1.0 / (1.0 + self.drag_per_m * step_m)) as f32,
            capacity: (self.capacity * self.morphological_factor * depth_m) as f32,
            least_sine: (self.least_slope / (1.0 + self.least_slope * self.least_slope).sqrt()) as f32,
            taken: within(self.erosion_m),
            laid: within(self.deposition_m),
            kept_water: libm::exp(-1e-3 * self.drying_per_km * step_m) as f32,
            path: (self.path_m / step_m).clamp(1.0, MOST_PATH) as f32,
            per_cell: (1.0 / step_m) as f32,
        }
    }
}
