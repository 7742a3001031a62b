//! What a user sets, and what the passes need of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::erosion::{bed::Coast, stage::Lock};
use crate::grid::Grid;

use super::passes::Law;

/// More iterations than anyone waits for.
const MOST_ITERATIONS: f64 = 2e5;

/// How a slope resists being dissolved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Steepness {
    /// Every slope alike.
    #[default]
    Even,
    /// Flats are soft and cliffs hard: the cube of the cosine of the slope.
    HardCliffs,
    /// Cliffs are soft and flats hard: the cube of 1 less the cosine of the slope.
    SoftCliffs,
}

/// Rain dissolves rock, carries it and dries up, as a cellular automaton.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HydraulicCellsParams {
    /// How long it rains.
    #[schemars(range(min = 0.001, max = 100000.0), extend("x-unit" = "h", "x-effect" = "deeper gullies"))]
    pub duration_h: f64,
    /// Storms like this one that each storm stands for: it multiplies what is worn off, carried and laid down.
    #[schemars(
        range(min = 0.0, max = 1000000.0),
        extend("x-unit" = "", "x-effect" = "deeper gullies in the same rain")
    )]
    pub morphological_factor: f64,
    /// Rain.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "mm/h", "x-effect" = "more water, deeper gullies"))]
    pub rain_mm_per_h: f64,
    /// Speed of the water: it crosses a cell in an iteration.
    #[schemars(
        range(min = 0.01, max = 10.0),
        extend("x-unit" = "m/s", "x-effect" = "more iterations, water goes further")
    )]
    pub flow_m_per_s: f64,
    /// Share of the water that dries up or soaks in.
    #[schemars(
        range(min = 0.0, max = 1000.0),
        extend("x-unit" = "1/h", "x-effect" = "water ends sooner, fans lie higher")
    )]
    pub drying_per_h: f64,
    /// Depth of rock that a metre of water dissolves.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "m/m/h", "x-effect" = "water is laden sooner"))]
    pub dissolving_per_h: f64,
    /// Rock that water can carry on the steepest slope, by volume.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "m/m", "x-effect" = "more is carried further"))]
    pub capacity: f64,
    /// Share of the capacity that water keeps on level ground; with 1 slope does not matter.
    #[schemars(
        range(min = 0.0, max = 1.0),
        extend("x-unit" = "", "x-effect" = "less is laid down at the foot of slopes")
    )]
    pub flat_capacity: f64,
    /// Which slopes resist.
    #[schemars(extend("x-effect" = "hard cliffs stay, soft ones go"))]
    pub steepness: Steepness,
    /// What stays where it is.
    #[schemars(extend("x-effect" = "coast: land stays land, sea stays sea"))]
    pub lock: Lock,
}

impl Default for HydraulicCellsParams {
    fn default() -> Self {
        Self {
            duration_h: 4.0,
            morphological_factor: 10000.0,
            rain_mm_per_h: 20.0,
            flow_m_per_s: 0.5,
            drying_per_h: 2.0,
            dissolving_per_h: 0.02,
            capacity: 0.01,
            flat_capacity: 0.05,
            steepness: Steepness::Even,
            lock: Lock::None,
        }
    }
}

impl HydraulicCellsParams {
    /// Whether it can run on this grid; if not, why not and what would help.
    pub fn check(&self, grid: &Grid) -> Result<(), String> {
        let (iterations, cell_m) = (self.iterations(grid), grid.cell_m);
        if iterations < 1.0 {
            let least = cell_m / (3600.0 * self.flow_m_per_s);
            return Err(format!(
                "water does not cross a cell of {cell_m} m in this time: set duration_h to {least:.3} or more"
            ));
        }
        if iterations > MOST_ITERATIONS {
            let most = self.duration_h * MOST_ITERATIONS / iterations;
            return Err(format!(
                "cells of {cell_m} m need {iterations:.0} iterations: set duration_h to {most:.3} or less"
            ));
        }
        Ok(())
    }

    /// By how much the world's clock goes on, yr.
    pub fn elapsed_yr(&self) -> f64 {
        self.duration_h * self.morphological_factor / 8766.0
    }

    /// Iterations in all; not a whole number.
    pub fn iterations(&self, grid: &Grid) -> f64 {
        self.duration_h * 3600.0 * self.flow_m_per_s / grid.cell_m
    }

    /// What an iteration does on this grid.
    pub(super) fn law(&self, grid: &Grid) -> Law {
        let hours = grid.cell_m / (3600.0 * self.flow_m_per_s);
        let f = |value: f64| value as f32;
        Law {
            rain_m: f(1e-3 * self.rain_mm_per_h * hours),
            kept: f(libm::exp(-self.drying_per_h * hours)),
            dissolved: f(self.dissolving_per_h * self.morphological_factor * hours),
            capacity: f(self.capacity * self.morphological_factor),
            flat: f(self.flat_capacity),
            per_cell: f(1.0 / grid.cell_m),
            iteration_s: 3600.0 * hours,
            steepness: self.steepness,
            coast: Coast { sea_m: f32::NEG_INFINITY, margin_m: 0.0 },
            locked: false,
        }
    }
}
