//! A film of a world that stands still: the camera moves, and the sun.

use std::{
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
};

use super::{Film, FilmPlan, FilmRequest, painter::Stand};
use crate::{
    job::{Event, JobError, open_world, scene::View},
    relief::CLIMATE,
    scene::Movement,
    timeline::{Moment, TimelineError},
};

/// What a bar shows while it is made.
const LABEL: &str = "Scene";

/// Films the finished world at `path` for so many seconds.
pub(super) fn film(
    path: &Path,
    request: &FilmRequest,
    seconds: f64,
    cancel: &AtomicBool,
    tell: &mut dyn FnMut(Event),
) -> Result<PathBuf, JobError> {
    if let View::Map(_) = View::parse(&request.view)? {
        let what = "--seconds: a map of a finished world does not move; a scene does, with --view scene";
        return Err(JobError::Refused(what.to_owned()));
    }
    let (world, provenance) = open_world(path)?;
    let scene = request.scene.of_world(&provenance)?;
    // Whole turns go on where they began, so that the film can run in a circle.
    let camera = &scene.camera;
    let round = camera.movement == Movement::Orbit && camera.keys.is_empty() && camera.turn_deg % 360.0 == 0.0;
    let (mut planned, view) = FilmPlan::of(request, &provenance.name, scene)?;
    view.check(&request.view, &world)?;
    planned.settle(&world);
    planned.animation.climate = CLIMATE.iter().all(|&layer| world.layer(layer).is_some());
    let per_second = planned.encoding.rate.per_second();
    planned.encoding.hold_s = 1.0 / per_second;
    let pictures = (seconds * per_second).round().max(1.0);
    planned.clips = super::pace::standing(pictures);
    let mut film = Film::new(&planned, world.grid)?;
    let shot = film.painter.shot(&world)?;
    let last = if round { pictures } else { (pictures - 1.0).max(1.0) };
    let count = pictures as u64;
    for i in 0..count {
        if cancel.load(Ordering::Relaxed) {
            return Err(TimelineError::Cancelled.into());
        }
        let stand = Stand { share: i as f64 / last, seconds: i as f64 / per_second };
        film.draw([&shot, &shot], 1.0, 1.0, stand)?;
        let done = (i + 1) as f64 / pictures;
        let moment = Moment { stage: 0, stages: 1, label: LABEL, step: i + 1, done, time_yr: world.time_yr };
        tell(Event::Step(&moment));
    }
    film.finish()
}
