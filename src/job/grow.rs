//! `grow`: one recipe, one world, one folder.

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::Instant,
};

use crate::{
    export, measure,
    recipe::Plan,
    relief,
    timeline::{Moment, StageRecord, Timeline, TimelineError},
    world::{
        World,
        store::{self, Provenance},
    },
};

use super::{
    Event, HEIGHT, JobError, Manifest, RELIEF, STORE,
    folder::{Partial, free},
    picture::write_png,
};

/// What is to be grown, and where to.
#[derive(Clone, Debug)]
pub struct Request {
    /// The recipe.
    pub plan: Plan,
    /// The folder; a new one under `worlds/` if absent.
    pub out: Option<PathBuf>,
    /// Replace a world that is there.
    pub force: bool,
    /// End after this stage.
    pub until: Option<String>,
}

/// What was grown.
#[derive(Clone, Debug)]
pub struct Grown {
    /// Where it is.
    pub folder: PathBuf,
    /// What is in it.
    pub manifest: Manifest,
}

/// Runs the recipe and writes the folder; nothing is left of a run that fails or is stopped.
pub fn grow(request: &Request, cancel: &AtomicBool, tell: &mut dyn FnMut(Event)) -> Result<Grown, JobError> {
    let plan = &request.plan;
    let until = request.until.as_deref().map(|name| last_stage(plan, name)).transpose()?;
    let out = match &request.out {
        Some(out) => out.clone(),
        None => free(&Path::new("worlds").join(format!("{}-{}", plan.name, plan.world.seed))),
    };
    let partial = Partial::begin(&out, request.force)?;
    let started = Instant::now();
    let (world, stages) = run(plan, until, cancel, &mut |moment| tell(Event::Step(moment)))?;
    let height_png = write(plan, &world, partial.path(), cancel, tell)?;
    let mut manifest = Manifest::new(plan, &world, measure::inspect(&world), height_png);
    manifest.stages = stages;
    manifest.until = until.map(|stage| plan.stages[stage].label.clone());
    manifest.seconds = started.elapsed().as_secs_f64();
    manifest.write(partial.path())?;
    check(cancel)?;
    Ok(Grown { folder: partial.finish()?, manifest })
}

/// Runs a plan without writing anything.
pub(crate) fn run(
    plan: &Plan,
    until: Option<usize>,
    cancel: &AtomicBool,
    progress: &mut dyn FnMut(&Moment),
) -> Result<(World, Vec<StageRecord>), JobError> {
    let mut timeline = Timeline::new(plan, cancel).until(until);
    let world = timeline.run(&mut [], progress)?;
    Ok((world, timeline.records().to_vec()))
}

fn last_stage(plan: &Plan, name: &str) -> Result<usize, JobError> {
    plan.find_stage(name).ok_or_else(|| {
        JobError::Refused(format!("--until {name}: no such stage (this recipe has: {})", plan.stage_names()))
    })
}

fn write(
    plan: &Plan,
    world: &World,
    folder: &Path,
    cancel: &AtomicBool,
    tell: &mut dyn FnMut(Event),
) -> Result<export::HeightRange, JobError> {
    let provenance = Provenance {
        name: plan.name.clone(),
        recipe: plan.text.clone(),
        seed: plan.world.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    tell(Event::Writing(STORE));
    store::write(world, &provenance, &folder.join(STORE))?;
    check(cancel)?;
    tell(Event::Writing(HEIGHT));
    let range = export::write_height_png(world, &folder.join(HEIGHT))?;
    check(cancel)?;
    tell(Event::Writing(RELIEF));
    let options = relief::Options { title: Some(plan.title.clone()), ..Default::default() };
    let map = relief::map(world, &relief::View::Relief, &options)?;
    write_png(&map, &folder.join(RELIEF))?;
    check(cancel)?;
    Ok(range)
}

fn check(cancel: &AtomicBool) -> Result<(), JobError> {
    match cancel.load(std::sync::atomic::Ordering::Relaxed) {
        true => Err(TimelineError::Cancelled.into()),
        false => Ok(()),
    }
}
