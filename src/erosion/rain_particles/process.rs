//! The stage `rain_particles`.

use super::{RainParticles, RainParticlesParams, family::COLUMNS};
use crate::{
    bake::{Column, Subject},
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage, in_words, peak},
    },
    grid::Grid,
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Clocks, Layer, World},
};

/// Minutes in a year.
const YEAR_MIN: f64 = 60.0 * 8766.0;

impl RainParticlesParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage::new(self, placement, steps))
    }
}

impl FamilyParams for RainParticlesParams {
    type Solver = RainParticles;
    const WRITES: &'static [Layer] =
        &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Water, Layer::Wear, Layer::Deposit, Layer::Flow];
    const PEAKS: &'static [Layer] = &[Layer::Flow];
    const WATER: bool = true;
    const STEPS: u64 = 100;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn duration_yr(&self) -> f64 {
        self.duration_min * self.morphological_factor / YEAR_MIN
    }

    fn clocks(&self) -> Option<Clocks> {
        Some(Clocks { water_s: self.duration_s(), morphological_factor: self.morphological_factor })
    }

    fn check(&self, grid: &Grid) -> Result<(), String> {
        RainParticlesParams::check(self, grid)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        self.warning(grid).into_iter().chain(self.clocks().map(in_words)).collect()
    }

    fn subject(&self, grid: &Grid) -> Option<Subject> {
        let columns = COLUMNS.iter().map(|[name, unit]| Column::new(name, unit)).collect();
        let spacing_m = self.spacing(grid);
        Some(Subject { columns, duration_s: self.duration_s(), volume_m3: spacing_m * spacing_m * spacing_m })
    }

    fn solver(&self, bed: &Bed, _world: &World, key: Key) -> Result<RainParticles, ProcessError> {
        RainParticles::new(self, bed.grid, key).map_err(ProcessError::Unfit)
    }

    fn show(&self, solver: &RainParticles, _bed: &Bed, world: &mut World) {
        world.set_layer(Layer::Water, solver.depth_m());
        peak(world, Layer::Flow, &solver.discharge().data);
    }
}
