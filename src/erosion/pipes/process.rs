//! The stage `pipes`.

use super::{Pipes, PipesParams};
use crate::{
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage, cell_size, clocks, peak},
    },
    grid::{Field, Grid, sum_f64},
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Layer, World},
};

/// Hours in a year.
const YEAR_H: f64 = 8766.0;

impl PipesParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage::new(self, placement, steps))
    }
}

impl FamilyParams for PipesParams {
    type Solver = Pipes;
    const WRITES: &'static [Layer] = &[
        Layer::Bedrock,
        Layer::Lava,
        Layer::Sediment,
        Layer::Water,
        Layer::Wear,
        Layer::Deposit,
        Layer::Flow,
        Layer::FlowSpeed,
        Layer::Suspended,
    ];
    const PEAKS: &'static [Layer] = &[Layer::Flow, Layer::FlowSpeed];
    const WATER: bool = true;
    const STEPS: u64 = 100;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn duration_yr(&self) -> f64 {
        self.duration_h * self.morphological_factor / YEAR_H
    }

    fn check(&self, grid: &Grid) -> Result<(), String> {
        PipesParams::check(self, grid)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        let clocks = clocks(self.duration_h, self.duration_yr(), self.morphological_factor);
        cell_size(grid, 1.0, 100.0).into_iter().chain([clocks]).collect()
    }

    fn solver(&self, bed: &Bed, world: &World, _key: Key) -> Result<Pipes, ProcessError> {
        let rain = world.layer(Layer::Rain).filter(|_| self.rain_by_map).and_then(|rain| {
            // Shares of the mean: how much falls is the parameters' to say.
            let mean = (sum_f64(&rain.data) / rain.data.len().max(1) as f64) as f32;
            (mean > 0.0).then(|| rain.map(|v| v.max(0.0) / mean))
        });
        let pipes =
            Pipes::new(self.clone(), bed, rain.as_ref().map(|rain| &rain.data[..])).at_sea(world.sea_level_m, bed);
        match world.layer(Layer::Water) {
            Some(water) => Ok(pipes.on(&water.data)),
            None => Ok(pipes),
        }
    }

    fn show(&self, solver: &Pipes, bed: &Bed, world: &mut World) {
        let grid = bed.grid;
        world.set_layer(Layer::Water, Field { grid, data: solver.water_m(bed) });
        world.set_layer(Layer::Suspended, Field { grid, data: solver.suspended_m().to_vec() });
        peak(world, Layer::Flow, &solver.discharge());
        peak(world, Layer::FlowSpeed, &solver.speed());
    }
}
