//! Stream power over a world: reads the layers that steer it, steps, and writes the column back.

use crate::{
    erosion::column::{Change, Column, Ground},
    flow::Router,
    grid::{Field, Grid},
    noise::Key,
    world::{Inflow, Layer, World},
};

use super::{
    Routing, StreamPowerParams,
    carver::{Carver, Forcing, Law},
};

/// Stream power over worlds of one raster; what `f32` layers cannot hold stays in it from step to step.
pub struct Solver {
    law: Law,
    uniform_rain_mm_per_yr: f64,
    step_yr: f64,
    mask: Option<Field<f32>>,
    carver: Carver,
    column: Column,
    height_m: Vec<f64>,
}

impl Solver {
    /// A solver with these parameters for worlds over the grid of `world`; `mask` scales its rates, `key`
    /// is the stage's.
    pub fn new(params: &StreamPowerParams, world: &World, mask: Option<Field<f32>>, key: Key) -> Self {
        Self {
            law: params.law(),
            uniform_rain_mm_per_yr: params.rain_mm_per_yr,
            step_yr: params.step_kyr * 1e3,
            mask,
            carver: Carver::routed(params.routing.router(world.grid, key)),
            column: Column::new(world.grid),
            height_m: Vec::new(),
        }
    }

    /// What is to be saved beside the world: the part of heights that its layers cannot hold, and the mask.
    pub fn save(&self) -> Vec<(String, Field<f32>)> {
        let mask = self.mask.iter().map(|mask| ("mask".to_owned(), mask.clone()));
        std::iter::once(("rest".to_owned(), self.column.rest().clone())).chain(mask).collect()
    }

    /// The solver from what was saved; `None` where that is not whole.
    pub fn restored(params: &StreamPowerParams, fields: &[(String, Field<f32>)], key: Key) -> Option<Self> {
        let field = |wanted: &str| fields.iter().find(|(name, _)| name == wanted).map(|(_, field)| field.clone());
        let rest = field("rest")?;
        let world = World::new(rest.grid, 0.0);
        Some(Self { column: Column::restored(rest), ..Self::new(params, &world, field("mask"), key) })
    }

    /// Goes on by `span_yr`, in equal steps of at most the one asked for, and books under `stage`. Reads the layers
    /// `uplift`, `runoff` (or `rain`) and `hardness` where they are present, and the sea level.
    pub fn advance(&mut self, world: &mut World, span_yr: f64, stage: &str) {
        let steps = (span_yr / self.step_yr - 1e-9).ceil().max(1.0);
        let step_yr = span_yr / steps;
        for step in 0..steps as usize {
            let from_yr = world.time_yr + step as f64 * step_yr;
            self.step(world, from_yr, step_yr, stage);
        }
    }

    fn step(&mut self, world: &mut World, from_yr: f64, years: f64, stage: &str) {
        self.column.read(world, &mut self.height_m);
        let ease = self.ease(world);
        let (inflows, gates) = (self.inflows(world), world.inflow_gates());
        let layer = |layer: Layer| world.layer(layer).map(|field| field.data.as_slice());
        let forcing = Forcing {
            sea_level_m: world.sea_level_m,
            uplift_mm_per_yr: layer(Layer::Uplift),
            uplift_factor: world.uplift_factor(from_yr, from_yr + years),
            rain_mm_per_yr: layer(Layer::Runoff).or_else(|| layer(Layer::Rain)),
            uniform_rain_mm_per_yr: self.uniform_rain_mm_per_yr,
            inflows: &inflows,
            gates: &gates,
            ease: ease.as_ref().map(|field| field.data.as_slice()),
        };
        let moved = self.carver.step(&self.law, &forcing, &mut self.height_m, years);
        let cell_m2 = world.grid.cell_area_m2();
        let change = Change {
            ground: Ground::Heights([self.carver.raised_m(), &self.height_m]),
            lifted_m3: moved.lifted_m * cell_m2,
            left_m3: moved.left_m * cell_m2,
        };
        self.column.write(world, &change, stage);
    }

    /// Where rivers come in, with their water as catchment under a metre of rain a year.
    fn inflows(&self, world: &World) -> Vec<(usize, f64)> {
        /// A Julian year, s.
        const YEAR_S: f64 = 365.25 * 86_400.0;
        let rained = world.layer(Layer::Runoff).or_else(|| world.layer(Layer::Rain)).is_some();
        let water_m2 = |inflow: &Inflow| match rained {
            true => inflow.discharge_m3_s * YEAR_S,
            false => inflow.area_m2 * self.uniform_rain_mm_per_yr * 1e-3,
        };
        world.inflows().iter().map(|inflow| (inflow.cell, water_m2(inflow))).collect()
    }

    /// What scales the rates: softness and mask, where there is either.
    fn ease(&self, world: &World) -> Option<Field<f32>> {
        let soft = world.layer(Layer::Hardness).map(|hard| hard.map(|h| (1.0 - h).clamp(0.0, 1.0)));
        match (soft, &self.mask) {
            (Some(soft), Some(mask)) => Some(Field::from_fn(mask.grid, |x, y| soft.at(x, y) * mask.at(x, y))),
            (soft, mask) => soft.or_else(|| mask.clone()),
        }
    }
}

impl Routing {
    fn router(self, grid: Grid, key: Key) -> Router {
        let key = key.named("routing");
        match self {
            Self::Steepest => Router::new(grid),
            Self::Rho8 => Router::fair(grid, |x, y| unit(key.lattice(x as i32, y as i32))),
        }
    }
}

/// Uniform in [0, 1), of the upper 53 bits.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}
