//! The stage `lava`.

use super::{
    eruption::{COLUMNS, Eruption},
    law::Law,
    params::LavaParams,
};
use crate::{
    bake::{Column, Subject},
    grid::Grid,
    process::{Context, Placement, Process, ProcessError, State, Step},
    volcano::{outlet::check, over_rim},
    world::{Layer, Matter, Table, World},
};

/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;
/// Longest step of the stage where the recipe does not say, s: a look for films and checkpoints.
const STEP_S: f64 = 1.0;
/// Most steps of the stage where the recipe does not say.
const MOST_STEPS: f64 = 600.0;
/// The table of what flows.
const TABLE: &str = "particles";
/// Cells up to which a particle is a lump of lava, m.
const MADE_FOR_M: f64 = 20.0;

impl LavaParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        let usual = (60.0 * self.duration_min / STEP_S).ceil().clamp(1.0, MOST_STEPS) as u64;
        let steps = steps.unwrap_or(usual).max(1);
        Box::new(Lava { params: self, placement, steps, done: 0, run: None, saved: None, gone: Vec::new() })
    }
}

struct Lava {
    params: LavaParams,
    placement: Placement,
    steps: u64,
    done: u64,
    run: Option<Eruption>,
    saved: Option<State>,
    /// What there is to say when it is over.
    gone: Vec<String>,
}

impl Lava {
    fn begin(&self, world: &mut World, context: &Context) -> Result<Eruption, ProcessError> {
        let run = Eruption::new(&self.params, world, self.placement.mask.as_ref(), context.key);
        let run = run.map_err(ProcessError::Unfit)?;
        world.ledger.open(context.stage, Matter::Lava, 0.0);
        world.add_plumes(&self.params.plumes(&run.sources, &run.schedule, world, context.key));
        Ok(run)
    }

    /// The years between two of its steps.
    fn span_yr(&self) -> f64 {
        60.0 * self.params.duration_min / YEAR_S / self.steps as f64
    }
}

/// Writes what has frozen, and books what has come out and gone.
fn write(run: &mut Eruption, hardness: f64, world: &mut World, stage: &str) {
    run.land.write(world, hardness as f32, stage);
    let each = run.particle_m3();
    let [drawn, froze, left] = run.counts().map(|count| count as f64 * each);
    world.ledger.set(stage, Matter::Lava, drawn, froze + left);
    world.ledger.close(stage, Matter::Lava, run.flow.swarm.len() as f64 * each);
}

/// Shows how deep and how hot lava flows.
fn lay(run: &Eruption, world: &mut World) {
    let seen = run.seen();
    let [x, y, _] = seen.place_m;
    let [depth, degc] = run.land.depth_m([x, y], &seen.degc, run.particle_m3(), 1.2 * run.law.spacing);
    world.set_layer(Layer::MoltenLava, depth);
    world.set_layer(Layer::MoltenTemperature, degc);
}

/// Shows the particles where there are any.
fn show(run: &Eruption, world: &mut World) {
    let cloud = &run.flow.swarm.cloud;
    world.remove_table(TABLE);
    if cloud.is_empty() {
        return;
    }
    let seen = run.seen();
    let wide = |values: &[f32], by: f64, off: f64| values.iter().map(|&v| f64::from(v) * by + off).collect::<Vec<_>>();
    let [x, y, z] = seen.place_m;
    let [vx, vy, vz] = seen.velocity_m_per_s;
    let table = Table::new(TABLE)
        .number("id", "1", seen.born.iter().map(|&id| id as f64).collect())
        .number("x_km", "km", wide(x, 1e-3, 0.0))
        .number("y_km", "km", wide(y, 1e-3, 0.0))
        .number("z_m", "m", wide(z, 1.0, f64::from(seen.datum_m)))
        .number("vx_m_per_s", "m/s", wide(vx, 1.0, 0.0))
        .number("vy_m_per_s", "m/s", wide(vy, 1.0, 0.0))
        .number("vz_m_per_s", "m/s", wide(vz, 1.0, 0.0))
        .number("temperature_degc", "degC", seen.degc.clone())
        .number("age_s", "s", wide(seen.age_s, 1.0, 0.0));
    world.set_table(table);
}

impl Process for Lava {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[
            Layer::Bedrock,
            Layer::Lava,
            Layer::Sediment,
            Layer::Hardness,
            Layer::MoltenLava,
            Layer::MoltenTemperature,
            Layer::LavaTemperature,
            Layer::LavaDate,
        ]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        let law = Law::new(&self.params, grid);
        let vents = || check(&self.params.vent, grid);
        let all = law.check(grid).and_then(|()| vents()).and_then(|()| self.params.schedule().map(|_| ()));
        all.map_err(ProcessError::Unfit)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        let law = Law::new(&self.params, grid);
        let coarse = (grid.cell_m > MADE_FOR_M).then(|| {
            format!(
                "cells of {:.0} m are too coarse for particles of lava (up to {MADE_FOR_M} m): each is a lump of {:.0} m3",
                grid.cell_m,
                law.volume_m3()
            )
        });
        let factor = self.params.cooling_factor;
        let clocks = (factor != 1.0).then(|| {
            format!("lava cools {factor} times as fast as it flows, to be rock within {} min", self.params.duration_min)
        });
        coarse.into_iter().chain(clocks).chain(law.shortened()).collect()
    }

    fn subject(&self, grid: &Grid) -> Option<Subject> {
        let volume_m3 = Law::new(&self.params, grid).volume_m3();
        let columns = COLUMNS.iter().map(|[name, unit]| Column::new(name, unit)).collect();
        Some(Subject { columns, duration_s: 60.0 * self.params.duration_min, volume_m3 })
    }

    fn findings(&self) -> Vec<String> {
        self.gone.clone()
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mut run = match (self.run.take(), &self.saved) {
            (Some(run), _) => run,
            (None, Some(state)) => {
                Eruption::restored(&self.params, state, world.grid, context.key).ok_or_else(broken)?
            }
            (None, None) => self.begin(world, context)?,
        };
        self.saved = None;
        let whole = 60.0 * self.params.duration_min;
        let [from, to] = [self.done, self.done + 1].map(|k| whole * (k as f64 / self.steps as f64));
        run.run_on(from, to, context.tape()).map_err(ProcessError::Failed)?;
        self.done += 1;
        if self.done >= self.steps {
            run.settle();
        }
        write(&mut run, self.params.hardness, world, context.stage);
        lay(&run, world);
        self.run = Some(run);
        Ok(Step { done: self.done as f64 / self.steps as f64, elapsed_yr: self.span_yr() })
    }

    fn publish(&mut self, world: &mut World, context: &Context) -> Result<(), ProcessError> {
        if let (None, Some(state)) = (&self.run, &self.saved) {
            let run = Eruption::restored(&self.params, state, world.grid, context.key).ok_or_else(broken)?;
            (self.run, self.saved) = (Some(run), None);
        }
        let Some(run) = &self.run else { return Ok(()) };
        show(run, world);
        if self.done >= self.steps {
            self.gone = told(run);
        }
        Ok(())
    }

    fn save(&self) -> State {
        match (&self.run, &self.saved) {
            (Some(run), _) => run.save(self.done),
            (None, Some(state)) => state.clone(),
            (None, None) => State { fields: Vec::new(), blob: self.done.to_le_bytes().to_vec() },
        }
    }

    fn restore(&mut self, state: State, _context: &Context) -> Result<(), ProcessError> {
        let done = state.blob.first_chunk::<8>().map(|bytes| u64::from_le_bytes(*bytes)).ok_or_else(broken)?;
        self.done = done;
        self.saved = (done > 0).then_some(state);
        Ok(())
    }
}

/// What became of lava that is not on the map.
fn told(run: &Eruption) -> Vec<String> {
    let each = run.particle_m3();
    let owed = (run.owed() >= 1.0).then(|| {
        let m3 = run.owed().floor() * each;
        format!(
            "{m3:.0} m3 of the schedule found no room at the vents; widen them, raise max_particles, or erupt slower"
        )
    });
    let over = (run.over_rim() > 0).then(|| over_rim(run.over_rim() as f64 * each));
    owed.into_iter().chain(over).collect()
}

fn broken() -> ProcessError {
    ProcessError::Failed("the saved state of this stage is broken".to_owned())
}
