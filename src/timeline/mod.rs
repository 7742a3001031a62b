//! Runs a plan: its stages in order over one world, step by step.
//!
//! Keeps the books of each stage, the world's clock, and the watch for values that are no numbers; stops between any two
//! steps and keeps checkpoints from which it goes on; shows frames to sinks. It draws nothing.

mod checkpoint;
mod group;
mod run;

pub use checkpoint::{Checkpoint, CheckpointError, Checkpoints, EVERY};
pub use run::{Timeline, TimelineError};

use crate::{
    bake::Tape,
    world::{Clocks, World},
};

/// Where a run is.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment<'a> {
    /// Which of the running stages, from 0.
    pub stage: usize,
    /// How many stages run.
    pub stages: usize,
    /// The stage's name for people.
    pub label: &'a str,
    /// Steps done in this stage.
    pub step: u64,
    /// Share of the stage that is done, 0 to 1.
    pub done: f64,
    /// Years since the recipe began.
    pub time_yr: f64,
}

impl Moment<'_> {
    /// Whether the stage is over.
    pub fn stage_over(&self) -> bool {
        self.done >= 1.0
    }

    /// Share of the whole run that is done, each stage counted alike.
    pub fn overall(&self) -> f64 {
        (self.stage as f64 + self.done.clamp(0.0, 1.0)) / self.stages.max(1) as f64
    }
}

/// How much of the world a sink wants to see at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Interest {
    /// Nothing.
    None,
    /// The ground, if it is up to date anyway.
    Passing,
    /// The ground as it is now; what lies on it may be as the last step found it.
    Ground,
    /// Every layer and table as it is now.
    Whole,
}

impl Interest {
    /// This, where it is due.
    pub fn when(self, due: bool) -> Self {
        if due { self } else { Self::None }
    }
}

/// What takes frames from a running timeline: a film, a store, a preview.
pub trait Sink {
    /// What it wants of the world at this moment. Asked after every step; a stage brings its layers up to date only for
    /// a frame that somebody wants, and when it is over.
    fn wants(&mut self, moment: &Moment) -> Interest;

    /// Takes a frame; an error, said in one line, stops the run.
    fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String>;
}

/// What records the particles of stages while they step.
pub trait Recorder: Sync {
    /// The tape of one of the running stages, counted from 0, if it is recorded.
    fn tape(&self, stage: usize) -> Option<&dyn Tape>;

    /// A step of a recorded stage is done, and its frames have been taken. A checkpoint may be kept after this.
    fn step(&self, moment: &Moment) -> Result<(), String>;
}

/// What a finished stage cost.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StageRecord {
    /// Its name in the ledger.
    pub stage: String,
    /// Its kind.
    pub kind: String,
    /// Steps taken.
    pub steps: u64,
    /// Time taken.
    pub seconds: f64,
    /// Years that passed in the world.
    pub elapsed_yr: f64,
    /// How its water's clock and its bed's went, where it has two.
    #[serde(flatten)]
    pub clocks: Option<Clocks>,
    /// What a person should know of what it met.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<String>,
}
