//! The stage `droplets`.

use super::{Droplets, DropletsParams};
use crate::{
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage, cell_size},
    },
    grid::Grid,
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Layer, World},
};

impl DropletsParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage::new(self, placement, steps))
    }
}

impl FamilyParams for DropletsParams {
    type Solver = Droplets;
    const WRITES: &'static [Layer] = &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit];
    const WATER: bool = false;
    /// Rounds in which the rain falls.
    const STEPS: u64 = 16;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn duration_yr(&self) -> f64 {
        self.duration_yr
    }

    fn check(&self, grid: &Grid) -> Result<(), String> {
        DropletsParams::check(self, grid)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        cell_size(grid, 1.0, 100.0).into_iter().collect()
    }

    fn solver(&self, bed: &Bed, _world: &World, key: Key) -> Result<Droplets, ProcessError> {
        Ok(Droplets::new(self, &bed.grid, key))
    }
}
