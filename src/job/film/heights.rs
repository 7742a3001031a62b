//! `--frames`: numbered 16-bit heightmaps of a run, all with one range in metres, for other people's film makers.

use std::{fs, path::PathBuf, sync::atomic::AtomicBool};

use serde::Serialize;

use super::range::range_over_sea;
use crate::{
    export::{self, HeightRange, video::NumberedFolder},
    job::JobError,
    recipe::Plan,
    timeline::{Interest, Moment, Sink},
    world::World,
};

/// The file beside the heightmaps that says what black and white stand for.
pub const HEIGHTS_RANGE: &str = "range.json";

/// Heightmaps as they are asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramesRequest {
    /// The folder, which is made.
    pub folder: PathBuf,
    /// Every so many steps of each stage; the end of a stage is always there.
    pub every: u64,
}

/// What `range.json` says.
#[derive(Serialize)]
struct Index {
    #[serde(flatten)]
    range: HeightRange,
    /// Cells that were lower or higher, in all files.
    cut_cells: u64,
    frames: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    file: String,
    stage: String,
    step: u64,
    time_yr: f64,
    sea_level_m: f64,
    cell_m: f64,
}

/// A folder of heightmaps being filled. Dropped before it is finished, it leaves nothing behind.
pub(crate) struct HeightFrames {
    folder: NumberedFolder,
    every: u64,
    index: Index,
    /// Why there are no more. It does not stop the world.
    failure: Option<JobError>,
}

impl HeightFrames {
    /// Begins the folder. The range stands before the first file: Earth's where plates move, else that of a small trial
    /// and some more.
    pub fn begin(
        request: &FramesRequest,
        plan: &Plan,
        until: Option<usize>,
        cancel: &AtomicBool,
    ) -> Result<Self, JobError> {
        let folder = NumberedFolder::begin(&request.folder)?;
        let [low, high] = range_over_sea(plan, until, cancel)?;
        let sea_m = plan.world.sea_level_m;
        let range = HeightRange { black_m: (low + sea_m).floor(), white_m: (high + sea_m).ceil() };
        Ok(Self {
            folder,
            every: request.every,
            index: Index { range, cut_cells: 0, frames: Vec::new() },
            failure: None,
        })
    }

    /// Writes what was cut and when each file is, and puts the folder in its place.
    pub fn finish(mut self) -> Result<PathBuf, JobError> {
        if let Some(failure) = self.failure.take() {
            return Err(failure);
        }
        let text = serde_json::to_string_pretty(&self.index).unwrap_or_default() + "\n";
        let path = self.folder.path().join(HEIGHTS_RANGE);
        fs::write(&path, text).map_err(|cause| JobError::Disk { path, cause })?;
        Ok(self.folder.finish()?)
    }

    fn write(&mut self, world: &World, moment: &Moment) -> Result<(), JobError> {
        let file = format!("{:05}.png", self.index.frames.len() + 1);
        let path = self.folder.path().join(&file);
        self.index.cut_cells += export::write_height_png_within(world, self.index.range, &path)?;
        self.index.frames.push(Entry {
            file,
            stage: moment.label.to_owned(),
            step: moment.step,
            time_yr: moment.time_yr,
            sea_level_m: world.sea_level_m,
            cell_m: world.grid.cell_m,
        });
        Ok(())
    }
}

impl Sink for HeightFrames {
    fn wants(&mut self, moment: &Moment) -> Interest {
        let due = moment.stage_over() || moment.step.is_multiple_of(self.every);
        Interest::Ground.when(due && self.failure.is_none())
    }

    fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String> {
        self.failure = self.write(world, moment).err();
        Ok(())
    }
}
