//! What every solver looks like from outside: it steps a world, says how far it is, and can be stopped and continued
//! between any two steps.

mod shape;

pub use shape::Shape;

use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use crate::{
    bake::{Subject, Tape},
    grid::{Field, Grid, sum_f64},
    noise::Key,
    world::{Layer, Mask, MaskError, Matter, World},
};

/// One solver bound to its parameters.
///
/// A process keeps to the layers it declares. It must give the same bits for any number of threads, and after
/// `save` and `restore`.
pub trait Process: Send {
    /// Layers it needs to find.
    fn reads(&self) -> &'static [Layer] {
        &[]
    }

    /// Layers it may change or make.
    fn writes(&self) -> &'static [Layer];

    /// Whether its parameters go together with each other, with their files and with a map of this grid. Asked while a
    /// recipe is read, so that a run does not begin that cannot end.
    fn fit(&self, _grid: &Grid) -> Result<(), ProcessError> {
        Ok(())
    }

    /// What a person should know before it runs on a map of this grid, a line each: that cells are not of the size it is
    /// made for, or how its clocks go.
    fn remarks(&self, _grid: &Grid) -> Vec<String> {
        Vec::new()
    }

    /// What a person should know of what it met while it ran, a line each: cells of a file that had no height. Asked when
    /// it is over; a stage that can be stopped before that keeps it in its state.
    fn findings(&self) -> Vec<String> {
        Vec::new()
    }

    /// The grid it leaves behind, for those that change it. Asked while a recipe is read, so that the stages behind are
    /// asked about the right one.
    fn grid_after(&self, grid: &Grid) -> Grid {
        *grid
    }

    /// What it has to be recorded on a map of this grid, for those that move particles: they hand frames to
    /// [`Context::tape`] while they step.
    fn subject(&self, _grid: &Grid) -> Option<Subject> {
        None
    }

    /// Whether the ground is that of the present after every step, also without [`Process::publish`].
    fn up_to_date(&self) -> bool {
        true
    }

    /// Runs one step, whole or not at all: one that ends with [`ProcessError::Cancelled`] has changed nothing, so that
    /// the run can be taken up where it was.
    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError>;

    /// Brings the world's layers up to date with the process. The timeline calls it before a frame is taken and when
    /// the process has finished, so that a step need not write what nobody looks at.
    fn publish(&mut self, _world: &mut World, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }

    /// Runs as many steps of its own as cover the years that the stage it is coupled to has just taken. It cannot be
    /// cancelled: what the other stage did stands already.
    fn follow(&mut self, _world: &mut World, _context: &Context, _span_yr: f64) -> Result<(), ProcessError> {
        Err(ProcessError::Unfit("cannot step in turn with another stage".to_owned()))
    }

    /// What it needs to go on later, besides its parameters and the world.
    fn save(&self) -> State;

    /// Puts a saved state back. Called on a fresh process, before its first step.
    fn restore(&mut self, state: State, context: &Context) -> Result<(), ProcessError>;
}

/// What a step says of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Share of the stage that is done, 0 to 1; 1 ends the stage.
    pub done: f64,
    /// Years that passed in the world.
    pub elapsed_yr: f64,
}

impl Step {
    /// The only step of a stage that takes no time.
    pub const WHOLE: Step = Step { done: 1.0, elapsed_yr: 0.0 };

    /// Whether the stage is over.
    pub fn finished(&self) -> bool {
        self.done >= 1.0
    }
}

/// The saved state of a process.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Named fields.
    pub fields: Vec<(String, Field<f32>)>,
    /// Everything else, in the process's own form.
    pub blob: Vec<u8>,
}

/// What a process is given from outside.
pub struct Context<'a> {
    /// Root of all its random numbers: the seed and the stage's name.
    pub key: Key,
    /// The stage's name in the ledger.
    pub stage: &'a str,
    cancel: &'a AtomicBool,
    tape: Option<&'a dyn Tape>,
}

impl<'a> Context<'a> {
    /// A context for the stage called `stage` of a recipe with this seed.
    pub fn new(seed: u64, stage: &'a str, cancel: &'a AtomicBool) -> Self {
        Self { key: Key::new(seed).named(stage), stage, cancel, tape: None }
    }

    /// The same with a tape on which particles are recorded.
    pub fn recording(self, tape: Option<&'a dyn Tape>) -> Self {
        Self { tape, ..self }
    }

    /// Where frames of particles go, if anybody wants them. What a step does must not depend on it.
    pub fn tape(&self) -> Option<&'a dyn Tape> {
        self.tape
    }

    /// An error if the user asked to stop; long steps ask between their passes.
    pub fn check(&self) -> Result<(), ProcessError> {
        if self.cancel.load(Ordering::Relaxed) { Err(ProcessError::Cancelled) } else { Ok(()) }
    }
}

/// Why a process stopped.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    /// The user asked for it.
    #[error("stopped on request")]
    Cancelled,
    /// The mask cannot be used.
    #[error(transparent)]
    Mask(#[from] MaskError),
    /// The parameters and this world do not go together, or a file cannot be used.
    #[error("{0}")]
    Unfit(String),
    /// The solver found itself in a state it cannot leave; says where and what helps.
    #[error("{0}")]
    Failed(String),
}

/// How a stage's heights join what is there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Blend {
    /// The sum of both.
    Add,
    /// The new heights alone.
    #[default]
    Replace,
    /// The higher of both.
    Max,
    /// The lower of both.
    Min,
}

impl Blend {
    /// The blended height.
    pub fn of(self, old: f32, new: f32) -> f32 {
        match self {
            Blend::Add => old + new,
            Blend::Replace => new,
            Blend::Max => old.max(new),
            Blend::Min => old.min(new),
        }
    }
}

/// Where and how a stage's heights are put: its `blend` and `mask` in the recipe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placement {
    /// How heights join.
    pub blend: Blend,
    /// Where, and how strongly.
    pub mask: Option<Mask>,
}

impl Placement {
    /// The ground as a stage finds it, mask and all. Evaluated once, before the stage changes what the mask looks at.
    pub fn over(&self, world: &World) -> Result<Ground, ProcessError> {
        let base = world.layer(Layer::Bedrock).cloned().unwrap_or_else(|| Field::filled(world.grid, 0.0));
        let mask = self.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        Ok(Ground { blend: self.blend, base, mask })
    }
}

/// The bedrock before a stage, and how the stage's heights join it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Bedrock before the stage, m.
    pub base: Field<f32>,
    blend: Blend,
    mask: Option<Field<f32>>,
}

impl Ground {
    /// Writes the bedrock that these heights make over the base, and books what they changed since then: once or many
    /// times over.
    pub fn put(&self, heights: &Field<f32>, world: &mut World, context: &Context) {
        let width = world.grid.width;
        let bedrock = world.layer_mut(Layer::Bedrock);
        crate::grid::map_cells(&mut bedrock.data, width, |x, y| {
            let old = self.base.at(x, y);
            let new = self.blend.of(old, heights.at(x, y));
            match &self.mask {
                Some(mask) => old + (new - old) * mask.at(x, y),
                None => new,
            }
        });
        let gained_m3 = (sum_f64(&bedrock.data) - sum_f64(&self.base.data)) * world.grid.cell_area_m2();
        world.ledger.set(context.stage, Matter::Rock, gained_m3.max(0.0), (-gained_m3).max(0.0));
    }

    /// The fields to be saved with a stage.
    pub fn save(&self) -> Vec<(String, Field<f32>)> {
        let mask = self.mask.iter().map(|mask| ("mask".to_owned(), mask.clone()));
        std::iter::once(("base".to_owned(), self.base.clone())).chain(mask).collect()
    }

    /// The ground from saved fields; `None` where they lack it.
    pub fn restore(blend: Blend, fields: &[(String, Field<f32>)]) -> Option<Self> {
        let field = |wanted: &str| fields.iter().find(|(name, _)| name == wanted).map(|(_, field)| field.clone());
        Some(Self { blend, base: field("base")?, mask: field("mask") })
    }
}
