//! The stage `hydraulic_cells`.

use super::{HydraulicCells, HydraulicCellsParams};
use crate::{
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage, cell_size, in_words, peak},
    },
    grid::{Field, Grid},
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Clocks, Layer, World},
};

impl HydraulicCellsParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage::new(self, placement, steps))
    }
}

impl FamilyParams for HydraulicCellsParams {
    type Solver = HydraulicCells;
    const WRITES: &'static [Layer] =
        &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Water, Layer::Wear, Layer::Deposit, Layer::Flow];
    const PEAKS: &'static [Layer] = &[Layer::Flow];
    const WATER: bool = true;
    const STEPS: u64 = 50;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn duration_yr(&self) -> f64 {
        self.elapsed_yr()
    }

    fn clocks(&self) -> Option<Clocks> {
        Some(Clocks { water_s: 3600.0 * self.duration_h, morphological_factor: self.morphological_factor })
    }

    fn check(&self, grid: &Grid) -> Result<(), String> {
        HydraulicCellsParams::check(self, grid)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        cell_size(grid, 1.0, 1000.0).into_iter().chain(self.clocks().map(in_words)).collect()
    }

    fn solver(&self, bed: &Bed, world: &World, _key: Key) -> Result<HydraulicCells, ProcessError> {
        let water = world.layer(Layer::Water).map_or_else(|| vec![0.0; bed.start.len()], |water| water.data.clone());
        Ok(HydraulicCells::new(self, &bed.grid).on(water))
    }

    fn show(&self, solver: &HydraulicCells, bed: &Bed, world: &mut World) {
        world.set_layer(Layer::Water, Field { grid: bed.grid, data: solver.water().to_vec() });
        peak(world, Layer::Flow, &solver.discharge());
    }
}
