//! A film of a timeline that was kept.

use std::{
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
};

use super::{Film, FilmPlan, FilmRequest, pace, range};
use crate::{
    job::{
        Event, JobError, open_world,
        scene::{self, View},
    },
    recipe::{Overrides, Plan, Source},
    relief::CLIMATE,
    timeline::{Interest, Moment, TimelineError},
    world::{
        World,
        store::{Frame, Provenance, Recording},
    },
};

/// Replays the timeline that was kept in the world at `path` into a film.
pub fn replay(
    path: &Path,
    request: &FilmRequest,
    cancel: &AtomicBool,
    tell: &mut dyn FnMut(Event),
) -> Result<PathBuf, JobError> {
    match View::parse(&request.view)? {
        View::Map(_) => request.scene.refuse_for_maps()?,
        View::Scene(_) => scene::check_build()?,
    }
    if let Some(seconds) = request.seconds {
        return super::turn::film(path, request, seconds, cancel, tell);
    }
    let (world, provenance) = open_world(path)?;
    let recording = Recording::open(path, world.grid)?.filter(|recording| !recording.frames().is_empty());
    let Some(recording) = recording else {
        let what = match View::parse(&request.view)? {
            View::Map(_) => {
                "no timeline was kept in it; grow it with --keep-timeline, or film it while it grows with --video"
            }
            View::Scene(_) => {
                "no timeline was kept in it; for the finished world and a camera that moves, say how long, such as \
                 --seconds 10"
            }
        };
        return Err(JobError::Refused(format!("{}: {what}", path.display())));
    };
    let planned = plan(request, &recording, &world, &provenance)?;
    let mut film = Film::new(&planned, recording.first_grid().unwrap_or(world.grid))?;
    let (stages, last) = (planned.clips.len(), recording.frames().len() - 1);
    for (i, frame) in recording.frames().iter().enumerate() {
        if cancel.load(Ordering::Relaxed) {
            return Err(TimelineError::Cancelled.into());
        }
        let label = planned.clips.get(frame.stage).map_or("", |clip| clip.caption.as_str());
        let moment =
            Moment { stage: frame.stage, stages, label, step: frame.step, done: frame.done, time_yr: frame.time_yr };
        if film.wants(&moment) > Interest::None {
            // The last frame is the finished world, of which the store has more.
            let mut kept = if i == last { None } else { Some(recording.world(i)?) };
            if let Some(kept) = &mut kept {
                smoke(&world, recording.frames(), i, kept);
            }
            film.frame(kept.as_ref().unwrap_or(&world), &moment)?;
        }
        tell(Event::Step(&moment));
    }
    film.finish()
}

/// Gives a kept moment the smoke that the finished world remembers. What ends with the moment belongs to the last stage of it.
fn smoke(world: &World, frames: &[Frame], i: usize, kept: &mut World) {
    let time_yr = frames[i].time_yr;
    let last = frames.get(i + 1).is_none_or(|next| next.time_yr > time_yr);
    if kept.grid == world.grid {
        let there: Vec<_> = world.plumes().into_iter().filter(|plume| last || plume.end_yr > time_yr).collect();
        kept.add_plumes(&there);
    }
}

/// The film that was asked for, as far as the kept layers allow it.
fn plan(
    request: &FilmRequest,
    recording: &Recording,
    world: &World,
    provenance: &Provenance,
) -> Result<FilmPlan, JobError> {
    let source = Source {
        name: provenance.name.clone(),
        file: provenance.name.clone(),
        folder: PathBuf::new(),
        text: provenance.recipe.clone(),
    };
    // A recipe whose files are gone by now only costs the film its captions and its pace.
    let recipe = Plan::new(&source, &Overrides::default()).ok();
    let title = recipe.as_ref().map_or(provenance.name.as_str(), |recipe| recipe.title.as_str());
    let (mut planned, view) = FilmPlan::of(request, title, request.scene.of_world(provenance)?)?;
    planned.settle(world);
    if let Some(layer) = view.layer()
        && !layer.derived()
        && !recording.layers().contains(&layer)
    {
        let kept: Vec<&str> = recording.layers().iter().map(|layer| layer.name()).collect();
        let name = layer.name();
        return Err(JobError::Refused(format!(
            "--view {}: that layer was not kept (there are: relief, {}); grow with --keep-timeline={name}",
            request.view,
            kept.join(", ")
        )));
    }
    planned.animation.climate = CLIMATE.iter().all(|layer| recording.layers().contains(layer));
    let per_second = planned.encoding.rate.per_second();
    let stages = recording.frames().last().map_or(0, |frame| frame.stage + 1);
    planned.clips = match &recipe {
        Some(recipe) => {
            let until = recipe.running().nth(stages.saturating_sub(1)).map(|(place, _)| place);
            pace::clips(recipe, until, per_second)
        }
        None => pace::equal(stages, per_second),
    };
    if !recipe.is_some_and(|recipe| recipe.running().any(|(_, stage)| stage.kind.leads)) {
        planned.animation.range_m = range::range_of(world);
    }
    Ok(planned)
}
