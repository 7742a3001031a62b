//! Films of a run, and of a timeline that was kept.
//!
//! A [`Film`] takes worlds in time order and gives pictures at even distances of its own time. A process shows its world
//! only between two steps, which are often fewer than the pictures: heights and other quantities in between are in
//! proportion to time (`relief::film`). The first stage rises from flat ground, and the last picture is the finished
//! world.
//!
//! It draws and encodes nothing itself: that is for `relief`, `render` and `export::video`.

#[cfg(feature = "render")]
mod between;
mod clock;
mod heights;
mod pace;
mod painter;
mod range;
mod replay;
mod request;
#[cfg(feature = "render")]
mod scene;
mod sink;
mod turn;

pub(crate) use heights::HeightFrames;
pub use heights::{FramesRequest, HEIGHTS_RANGE};
pub use replay::replay;
pub(crate) use request::made;
pub use request::{FilmPlan, FilmRequest};
pub(crate) use sink::FilmSink;

use std::path::PathBuf;

use super::JobError;
use crate::{
    export::{ExportError, video::Encoder},
    grid::Grid,
    relief::film::Words,
    timeline::{Checkpoint, Interest, Moment},
    world::World,
};
use pace::Clip;
use painter::{Painter, Shot, Stand};

/// How long the last picture stands, s.
const HOLD_S: f64 = 1.0;
/// Steps are counted in floating point.
const SLACK: f64 = 1e-9;

/// A film being made. Dropped before [`Film::finish`], it leaves nothing behind.
pub struct Film {
    painter: Painter,
    /// The grid of the worlds; a stage may leave another one behind.
    grid: Grid,
    encoder: Encoder,
    clips: Vec<Clip>,
    per_second: f64,
    clock: bool,
    /// The stage being shown, and what its clip counts from.
    stage: usize,
    began_yr: f64,
    /// Where in the clip the last shot stands, and the next picture, in pictures.
    at: f64,
    next: f64,
    shot: Option<Shot>,
    /// The place it will have.
    file: PathBuf,
    /// Whether any picture was drawn.
    begun: bool,
    /// Whether the film begins with flat ground.
    flat_before: bool,
    /// Whether the last picture shows the last shot itself.
    shown: bool,
}

impl Film {
    /// Begins a film of worlds over `grid`; says before anything runs what cannot be done.
    pub fn new(plan: &FilmPlan, grid: Grid) -> Result<Self, JobError> {
        let painter = Painter::new(plan, grid)?;
        let encoder = Encoder::open(&plan.file, &plan.encoding)?;
        Ok(Self {
            painter,
            grid,
            encoder,
            clips: plan.clips.clone(),
            per_second: plan.encoding.rate.per_second(),
            clock: plan.clock,
            stage: 0,
            began_yr: 0.0,
            at: 0.0,
            next: 1.0,
            shot: None,
            file: plan.file.clone(),
            begun: false,
            flat_before: true,
            shown: false,
        })
    }

    /// Leaves out what a stopped run did before this checkpoint.
    pub fn begin_at(&mut self, checkpoint: &Checkpoint) {
        let (stage, began_yr) = (checkpoint.place().0, checkpoint.began_yr());
        let passed_yr = checkpoint.time_yr() - began_yr;
        (self.stage, self.began_yr) = (stage, began_yr);
        self.at = self.clips.get(stage).map_or(0.0, |clip| clip.place(checkpoint.done(), passed_yr));
        self.next = self.at.floor() + 1.0;
        self.flat_before = false;
    }

    /// What the film needs of the world at this moment: where a picture is due, and where a stage ends. Weather may be
    /// that which the last step found, before it carved.
    pub fn wants(&self, moment: &Moment) -> Interest {
        let (at, next) =
            if moment.stage == self.stage { (self.place(moment, self.began_yr), self.next) } else { (0.0, 0.0) };
        let wanted = if self.painter.shows_ground_alone() { Interest::Ground } else { Interest::Whole };
        wanted.when(moment.stage_over() || at + SLACK >= next)
    }

    /// Where a moment stands in its clip, in pictures.
    fn place(&self, moment: &Moment, began_yr: f64) -> f64 {
        self.clips.get(moment.stage).map_or(0.0, |clip| clip.place(moment.done, moment.time_yr - began_yr))
    }

    /// Takes the world of a moment, and draws the pictures since the last one.
    pub fn frame(&mut self, world: &World, moment: &Moment) -> Result<(), JobError> {
        if moment.stage != self.stage {
            self.stage = moment.stage;
            self.began_yr = self.shot.as_ref().map_or(0.0, Shot::time_yr);
            (self.at, self.next) = (0.0, 1.0);
        }
        if world.grid != self.grid {
            // Between two maps there is nothing to be drawn: the film cuts to the new one.
            self.painter.regrid(world.grid);
            self.grid = world.grid;
            self.flat_before = false;
            self.shot = None;
        }
        let to = self.painter.shot(world)?;
        let first = || if self.flat_before { to.before() } else { to.clone() };
        let from = self.shot.take().unwrap_or_else(first);
        let at = self.place(moment, self.began_yr);
        self.shown = false;
        while self.next <= at + SLACK {
            let share = ((self.next - self.at) / (at - self.at)).clamp(0.0, 1.0) as f32;
            let stand = self.stand();
            self.draw([&from, &to], share, at - self.at, stand)?;
            self.shown = share >= 1.0;
            self.next += 1.0;
        }
        self.at = at;
        self.shot = Some(to);
        Ok(())
    }

    /// Where the next picture stands in the whole film.
    fn stand(&self) -> Stand {
        let before: f64 = self.clips.iter().take(self.stage).map(Clip::pictures).sum();
        let all: f64 = self.clips.iter().map(Clip::pictures).sum();
        let at = before + self.next - 1.0;
        Stand { share: (at / (all - 1.0).max(1.0)).clamp(0.0, 1.0), seconds: at / self.per_second }
    }

    fn draw(&mut self, [from, to]: [&Shot; 2], share: f32, pictures: f64, stand: Stand) -> Result<(), JobError> {
        let clock = if self.clock {
            let passed_yr = to.time_yr() - from.time_yr();
            let time_yr = from.time_yr() + passed_yr * f64::from(share);
            clock::text(time_yr, time_yr - self.began_yr, passed_yr / pictures.max(1.0))
        } else {
            String::new()
        };
        let caption = self.clips.get(self.stage).map_or("", |clip| clip.caption.as_str());
        self.begun = true;
        let mut picture = self.encoder.blank();
        self.painter.draw([from, to], share, stand, Words { caption, clock: &clock }, &mut picture)?;
        Ok(self.encoder.push(picture)?)
    }

    /// Ends the film with the last world and puts it in its place.
    pub fn finish(mut self) -> Result<PathBuf, JobError> {
        if let Some(last) = self.shot.take()
            && !self.shown
        {
            let stand = Stand { share: 1.0, ..self.stand() };
            self.draw([&last, &last], 1.0, 1.0, stand)?;
        }
        if !self.begun {
            // The encoder is dropped and leaves nothing.
            let path = PathBuf::from(self.file.file_name().unwrap_or_default());
            let cause =
                "nothing was left to film: the stopped run had done its last step; --force grows and films it anew";
            return Err(ExportError::Film { path, cause: cause.to_owned() }.into());
        }
        Ok(self.encoder.finish()?)
    }
}
