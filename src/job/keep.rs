//! Keeping the timeline of a run in its store, to be filmed or studied later.

use std::path::Path;

use crate::{
    timeline::{Moment, Sink},
    world::{
        Layer, World,
        store::{Frame, Recorder, StoreError},
    },
};

/// Frames that a whole run gives, where its steps are fine enough.
const FRAMES: f64 = 150.0;

/// A recorder as a sink of a timeline: frames at even shares of the run, and one at the end of each stage.
pub(crate) struct KeepSink {
    recorder: Recorder,
    next: Option<f64>,
}

impl KeepSink {
    /// Records the height and `layers` into `folder`; goes on behind a frame's stage and step in a resumed run.
    pub fn begin(
        folder: &Path,
        grid: crate::grid::Grid,
        layers: &[Layer],
        from: Option<(usize, u64)>,
    ) -> Result<Self, StoreError> {
        let others = layers.iter().copied().filter(|&layer| layer != Layer::Height);
        let layers: Vec<Layer> = std::iter::once(Layer::Height).chain(others).collect();
        Ok(Self { recorder: Recorder::begin(folder, grid, &layers, from)?, next: None })
    }

    /// Puts the frames into the finished store.
    pub fn finish(self, store: &Path) -> Result<(), StoreError> {
        self.recorder.finish(store)
    }
}

/// The next share of a run at which a frame is kept: they are fixed, so that a resumed run keeps the same moments.
fn after(overall: f64) -> f64 {
    ((overall * FRAMES).floor() + 1.0) / FRAMES
}

impl Sink for KeepSink {
    fn wants(&mut self, moment: &Moment) -> bool {
        let next = *self.next.get_or_insert_with(|| {
            // A resumed run goes on with the frames of the one before.
            let last = self.recorder.frames().last();
            last.map_or(0.0, |frame| after((frame.stage as f64 + frame.done) / moment.stages as f64))
        });
        moment.stage_over() || moment.overall() >= next
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
        self.recorder.push(world, frame).map_err(|e| e.to_string())
    }
}
