//! The stage `pipes`.

use super::{Pipes, PipesParams};
use crate::{
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage, cell_size, in_words, peak},
    },
    grid::{Edges, Field, Grid, for_each_row, sum_f64},
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Clocks, Layer, World},
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
        Layer::FlowEast,
        Layer::FlowSouth,
        Layer::Suspended,
    ];
    const PEAKS: &'static [Layer] = &[Layer::Flow, Layer::FlowSpeed, Layer::FlowEast, Layer::FlowSouth];
    const WATER: bool = true;
    const STEPS: u64 = 100;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn duration_yr(&self) -> f64 {
        self.duration_h * self.morphological_factor / YEAR_H
    }

    fn clocks(&self) -> Option<Clocks> {
        Some(Clocks { water_s: 3600.0 * self.duration_h, morphological_factor: self.morphological_factor })
    }

    fn check(&self, grid: &Grid) -> Result<(), String> {
        PipesParams::check(self, grid)
    }

    fn meets(&self, world: &World) -> Result<(), String> {
        let deepest = world.layer(Layer::Water).and_then(Field::range).map_or(0.0, |(_, most)| f64::from(most));
        self.check_depth(&world.grid, deepest)?;
        let sea = || world.height().data.iter().any(|&z| f64::from(z) < world.sea_level_m);
        // Nothing takes the water: it rises for as long as it rains and springs run.
        let rises = world.grid.edges != Edges::Open && !(self.sea && sea());
        if rises { self.check_depth(&world.grid, self.depth_kept(&world.grid)) } else { Ok(()) }
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        cell_size(grid, 1.0, 100.0).into_iter().chain(self.clocks().map(in_words)).chain(self.patience(grid)).collect()
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
        show_velocity(solver, world);
    }
}

/// Notes speed and velocity wherever water is faster than it has been.
fn show_velocity(solver: &Pipes, world: &mut World) {
    let (grid, speed) = (world.grid, solver.speed());
    let before = world.remove_layer(Layer::FlowSpeed).unwrap_or_else(|| Field::filled(grid, 0.0));
    for (axis, layer) in [Layer::FlowEast, Layer::FlowSouth].into_iter().enumerate() {
        let velocity = solver.velocity(axis);
        for_each_row(&mut world.layer_mut(layer).data, grid.width, |y, row| {
            for (x, kept) in row.iter_mut().enumerate() {
                let i = y * grid.width + x;
                *kept = if speed[i] > before.data[i] { velocity[i] } else { *kept };
            }
        });
    }
    world.set_layer(Layer::FlowSpeed, before);
    peak(world, Layer::FlowSpeed, &speed);
}
