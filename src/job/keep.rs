//! Keeping the timeline of a run in its store, to be filmed or studied later.

use std::path::{Path, PathBuf};

use crate::{
    grid::Grid,
    relief,
    timeline::{Interest, Moment, Sink},
    world::{
        Layer, World,
        store::{Frame, Recorder, StoreError},
    },
};

/// Frames that a whole run gives, where its steps are fine enough.
const FRAMES: f64 = 150.0;

/// Recorders as a sink of a timeline: frames at even shares of the run, and one at the end of each stage. A stage that
/// changes the map's raster begins another recorder.
pub(crate) struct KeepSink {
    folder: PathBuf,
    layers: Vec<Layer>,
    recorders: Vec<Recorder>,
    next: Option<f64>,
}

impl KeepSink {
    /// Records the height and `layers` into a folder; goes on behind a frame's stage and step in a resumed run.
    pub fn begin(folder: &Path, grid: Grid, layers: &[Layer], from: Option<(usize, u64)>) -> Result<Self, StoreError> {
        let others = layers.iter().copied().filter(|&layer| layer != Layer::Height);
        let layers: Vec<Layer> = std::iter::once(Layer::Height).chain(others).collect();
        let mut keep = Self { folder: folder.to_owned(), layers, recorders: Vec::new(), next: None };
        while from.is_some()
            && let Some(grid) = Recorder::left_grid(&keep.place())
        {
            let recorder = Recorder::begin(&keep.place(), grid, &keep.layers, from)?;
            if recorder.frames().is_empty() {
                break;
            }
            keep.recorders.push(recorder);
        }
        if keep.recorders.is_empty() {
            keep.add(grid)?;
        }
        Ok(keep)
    }

    /// Where the next recorder works.
    fn place(&self) -> PathBuf {
        self.folder.join((self.recorders.len() + 1).to_string())
    }

    fn add(&mut self, grid: Grid) -> Result<(), StoreError> {
        self.recorders.push(Recorder::begin(&self.place(), grid, &self.layers, None)?);
        Ok(())
    }

    /// Puts the frames into the finished store.
    pub fn finish(self, store: &Path) -> Result<(), StoreError> {
        self.recorders.into_iter().enumerate().try_for_each(|(nth, recorder)| recorder.finish(store, nth))
    }
}

/// The next share of a run at which a frame is kept: they are fixed, so that a resumed run keeps the same moments.
pub(super) fn after(overall: f64) -> f64 {
    ((overall * FRAMES).floor() + 1.0) / FRAMES
}

impl Sink for KeepSink {
    fn wants(&mut self, moment: &Moment) -> Interest {
        let next = *self.next.get_or_insert_with(|| {
            // A resumed run goes on with the frames of the one before.
            let last = self.recorders.last().and_then(|recorder| recorder.frames().last());
            last.map_or(0.0, |frame| after((frame.stage as f64 + frame.done) / moment.stages as f64))
        });
        // Weather as the last step found it, as in a film; lava is laid with every step.
        let ground =
            |layer: &Layer| *layer == Layer::Height || relief::CLIMATE.contains(layer) || relief::LAVA.contains(layer);
        let wanted = if self.layers.iter().all(ground) { Interest::Ground } else { Interest::Whole };
        wanted.when(moment.stage_over() || moment.overall() >= next)
    }

    fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String> {
        self.next = Some(after(moment.overall()));
        let frame = Frame {
            stage: moment.stage,
            step: moment.step,
            done: moment.done,
            time_yr: moment.time_yr,
            sea_level_m: world.sea_level_m,
        };
        let said = |e: StoreError| e.to_string();
        if self.recorders.last().is_none_or(|recorder| recorder.grid() != world.grid) {
            self.add(world.grid).map_err(said)?;
        }
        self.recorders.last_mut().map_or(Ok(()), |recorder| recorder.push(world, frame)).map_err(said)
    }
}
