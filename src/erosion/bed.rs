//! The ground under a family of erosion, in single precision and structure of arrays, and what every family does to it.
//!
//! A height is what it was when the stage began plus what has changed since. The two are kept apart: a micrometre laid
//! down on a mountain of 4 km is lost in their sum, but not in the change.

use crate::grid::Grid;

/// The ground that a family of erosion works on.
#[derive(Clone, Debug)]
pub struct Bed {
    /// The raster.
    pub grid: Grid,
    /// Height when the stage began, above the datum, m.
    pub start: Vec<f32>,
    /// What has been laid down since, less what was worn off, m.
    pub change: Vec<f32>,
    /// Share of every rate that a cell has, 0 to 1: the mask, and 1 less its hardness. Empty where that is 1 everywhere.
    pub rate: Vec<f32>,
    /// The sea above the datum, m.
    pub sea_m: f32,
    /// Whether land stays land, and sea sea.
    pub locked: bool,
}

impl Bed {
    /// Height above the datum, m.
    #[inline]
    pub fn height(&self, i: usize) -> f32 {
        self.start[i] + self.change[i]
    }

    /// Share of every rate that a cell has.
    #[inline]
    pub fn rate(&self, i: usize) -> f32 {
        self.rate.get(i).copied().unwrap_or(1.0)
    }

    /// The most that a height may change at once, m: half the way to the sea's level where land and sea are to stay.
    #[inline]
    pub fn room(&self, height: f32) -> f32 {
        if self.locked { 0.5 * (height - self.sea_m).abs() } else { f32::INFINITY }
    }
}

/// One of the steps that a stage is divided into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Steps taken before.
    pub step: u64,
    /// Steps in all.
    pub steps: u64,
}

impl Part {
    /// Where it begins and ends in something that the whole stage has `whole` of.
    pub fn of(self, whole: f64) -> [f64; 2] {
        [self.step, self.step + 1].map(|step| whole * (step as f64 / self.steps as f64))
    }
}

/// What a step moved over the borders of a world, m³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Rock and sediment that left over the rim.
    pub rock_left_m3: f64,
    /// Water that came in: rain, springs and rivers.
    pub water_in_m3: f64,
    /// Water that left: evaporated, over the rim, into the sea.
    pub water_left_m3: f64,
}

impl std::ops::AddAssign for Moved {
    fn add_assign(&mut self, more: Self) {
        self.rock_left_m3 += more.rock_left_m3;
        self.water_in_m3 += more.water_in_m3;
        self.water_left_m3 += more.water_left_m3;
    }
}

/// What a family needs to go on later, besides its parameters and the bed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Saved {
    /// Values by cell.
    pub fields: Vec<(&'static str, Vec<f32>)>,
    /// Everything else.
    pub blob: Vec<u8>,
}

/// One family of erosion: a solver bound to its parameters and a bed.
pub trait Family: Send {
    /// Takes one step of the stage. The bed's `change` alone is written to.
    fn advance(&mut self, bed: &mut Bed, part: Part) -> Moved;

    /// Rock that is on its way at the moment, m³: worn off, not yet laid down, not gone either.
    fn carried_m3(&self) -> f64 {
        0.0
    }

    /// Lays down all that is on its way, and says what left with that: the stage is over.
    fn settle(&mut self, _bed: &mut Bed) -> Moved {
        Moved::default()
    }

    /// What it has besides the bed.
    fn save(&self) -> Saved {
        Saved::default()
    }

    /// Puts back what `save` gave; `None` where that is broken. `field` gives saved values by name.
    fn restore(&mut self, _field: &dyn Fn(&str) -> Option<Vec<f32>>, _blob: &[u8]) -> Option<()> {
        Some(())
    }
}
