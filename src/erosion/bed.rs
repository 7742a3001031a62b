//! The ground under a family of erosion, in single precision and structure of arrays, and what every family does to it.
//!
//! A height is what it was when the stage began plus what has changed since. The two are kept apart: a micrometre laid
//! down on a mountain of 4 km is lost in their sum, but not in the change.

use crate::{bake::Tape, grid::Grid};

/// The ground that a family of erosion works on.
#[derive(Clone, Debug)]
pub struct Bed {
    /// The raster.
    pub grid: Grid,
    /// Height when the stage began, above the datum, m.
    pub start: Vec<f32>,
    /// What has been laid down since, less what was worn off, m.
    pub change: Vec<f32>,
    /// Share of every rate that a cell has, 0 to 1: its mask times 1 less its hardness. Empty where that is 1 everywhere.
    pub rate: Vec<f32>,
    /// The mask alone: nothing comes to lie where it is 0, though hard rock takes what falls on it. Empty where it is 1
    /// everywhere.
    pub mask: Vec<f32>,
    /// The sea above the datum, m.
    pub sea_m: f32,
    /// Whether land stays land, and sea sea.
    pub locked: bool,
    /// How far heights then stay from the sea's level, m: what the world's layers may round away.
    pub margin_m: f32,
}

impl Bed {
    /// Ground of these heights, m, far above any sea, that gives way everywhere.
    pub fn new(grid: Grid, start: Vec<f32>) -> Self {
        let change = vec![0.0; start.len()];
        let (rate, mask) = (Vec::new(), Vec::new());
        Self { grid, start, change, rate, mask, sea_m: f32::NEG_INFINITY, locked: false, margin_m: 0.0 }
    }

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

    /// How soft a cell is, 0 to 1, whatever its mask.
    #[inline]
    pub fn soft(&self, i: usize) -> f32 {
        let mask = self.mask.get(i).copied().unwrap_or(1.0);
        if mask > 0.0 { (self.rate(i) / mask).min(1.0) } else { 0.0 }
    }

    /// The sea's level and the margin around it, where land and sea are to stay.
    #[inline]
    pub fn coast(&self) -> Option<Coast> {
        self.locked.then_some(Coast { sea_m: self.sea_m, margin_m: self.margin_m })
    }

    /// The most that a height may change at once, m.
    #[inline]
    pub fn room(&self, height: f32) -> f32 {
        self.coast().map_or(f32::INFINITY, |coast| coast.room(height))
    }
}

/// Where land has to stay land and sea sea.
#[derive(Clone, Copy, Debug)]
pub struct Coast {
    /// The sea above the datum, m.
    pub sea_m: f32,
    /// How far heights stay from that, m.
    pub margin_m: f32,
}

impl Coast {
    /// How far a height is from where it has to stop, m.
    #[inline(always)]
    pub fn free(self, height: f32) -> f32 {
        ((height - self.sea_m).abs() - self.margin_m).max(0.0)
    }

    /// The most that a height may change at once, m: half of that.
    #[inline(always)]
    pub fn room(self, height: f32) -> f32 {
        0.5 * self.free(height)
    }

    /// Whether a height that becomes another changes sides.
    #[inline(always)]
    pub fn crosses(self, from: f32, to: f32) -> bool {
        (from < self.sea_m) != (to < self.sea_m)
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

    /// The same, and hands frames of its particles to a tape, if it has any.
    fn advance_on(&mut self, bed: &mut Bed, part: Part, _tape: Option<&dyn Tape>) -> Result<Moved, String> {
        Ok(self.advance(bed, part))
    }

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
