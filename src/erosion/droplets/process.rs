//! The stage `droplets`.

use super::{Droplets, DropletsParams, YEAR_S};
use crate::{
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage, cell_size, in_words},
    },
    grid::{Field, Grid},
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Clocks, Layer, World},
};

impl DropletsParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage::new(self, placement, steps))
    }
}

impl FamilyParams for DropletsParams {
    type Solver = Droplets;
    const WRITES: &'static [Layer] =
        &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit, Layer::Flow];
    const WATER: bool = false;
    /// Rounds in which the rain falls.
    const STEPS: u64 = 16;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn duration_yr(&self) -> f64 {
        self.elapsed_yr()
    }

    fn clocks(&self) -> Option<Clocks> {
        Some(Clocks { water_s: YEAR_S * self.duration_yr, morphological_factor: self.morphological_factor })
    }

    fn check(&self, grid: &Grid) -> Result<(), String> {
        DropletsParams::check(self, grid)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        let rain = format!(
            "{} mm of rain a year, {} droplets a cell; each stands for its share of all that rain",
            self.rain_mm_per_yr, self.droplets_per_cell
        );
        cell_size(grid, 1.0, 100.0).into_iter().chain(self.clocks().map(in_words)).chain([rain]).collect()
    }

    fn solver(&self, bed: &Bed, _world: &World, key: Key) -> Result<Droplets, ProcessError> {
        Ok(Droplets::new(self, &bed.grid, key))
    }

    fn show(&self, solver: &Droplets, bed: &Bed, world: &mut World) {
        world.set_layer(Layer::Flow, Field { grid: bed.grid, data: solver.discharge() });
    }
}
