//! `grow`: one recipe, one world, one folder.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::{Duration, Instant},
};

use crate::{
    export, measure,
    recipe::Plan,
    relief,
    timeline::{Checkpoint, Checkpoints, Moment, Recorder, Sink, StageRecord, Timeline, TimelineError},
    world::{
        Layer, World,
        store::{self, Provenance},
    },
};

use super::{
    Event, Existing, HEIGHT, JobError, MANIFEST, Manifest, RELIEF, STORE,
    bake::BakePlan,
    film::{Film, FilmPlan, FilmRequest, FilmSink, FramesRequest, HeightFrames, made},
    folder::{Partial, free, newest},
    keep::KeepSink,
    picture::write_png,
    series::{PROFILES, ProfileSink, SERIES, SeriesSink},
};

/// What is to be grown, and where to.
#[derive(Clone, Debug)]
pub struct Request {
    /// The recipe.
    pub plan: Plan,
    /// The folder; a new one under `worlds/` if absent.
    pub out: Option<PathBuf>,
    /// What is to happen where something is already.
    pub existing: Existing,
    /// Time between checkpoints, unless they cost much.
    pub checkpoint_every: Duration,
    /// End after this stage.
    pub until: Option<String>,
    /// A film of the run.
    pub film: Option<FilmRequest>,
    /// Heightmaps of the run.
    pub frames: Option<FramesRequest>,
    /// Recordings of the particles of its stages, so many frames to a second of their time.
    pub bake_per_s: Option<f64>,
    /// Layers to keep along the run, in the store; the height always is one of them.
    pub keep: Option<Vec<Layer>>,
}

/// What was grown.
#[derive(Debug)]
pub struct Grown {
    /// Where it is.
    pub folder: PathBuf,
    /// Its `manifest.json`.
    pub manifest: String,
    /// What a person should know of what its stages met, a line each.
    pub notes: Vec<String>,
    /// Films and frames that were made outside the folder, and the film and the recordings in it.
    pub films: Vec<PathBuf>,
    /// Why films or frames that were asked for are not there; the world is, all the same.
    pub failures: Vec<JobError>,
}

/// Runs the recipe and writes the folder. Of a run that fails or is stopped only its checkpoints are left.
pub fn grow(request: &Request, cancel: &AtomicBool, tell: &mut dyn FnMut(Event)) -> Result<Grown, JobError> {
    let plan = &request.plan;
    let until = request.until.as_deref().map(|name| last_stage(plan, name)).transpose()?;
    let stem = Path::new("worlds").join(format!("{}-{}", plan.name, plan.world.seed));
    let out = match (&request.out, request.existing) {
        (Some(out), _) => out.clone(),
        (None, Existing::Resume) => newest(&stem),
        (None, _) => free(&stem),
    };
    let ended = until.map(|stage| plan.stages[stage].label.clone());
    let bake = request.bake_per_s.map(|per_s| BakePlan::new(plan, until, per_s)).transpose()?;
    if request.existing == Existing::Resume
        && let Some(grown) = finished(plan, ended.as_deref(), &out)?
    {
        bake.map_or(Ok(()), |bake| bake.stands_in(&out))?;
        return Ok(grown);
    }
    // What cannot be done is said before anything is begun.
    let film = request.film.as_ref().map(|film| FilmPlan::new(film, plan, until, cancel)).transpose()?;
    let partial = Partial::begin(&out, request.existing)?;
    let mut frames =
        request.frames.as_ref().map(|frames| HeightFrames::begin(frames, plan, until, cancel)).transpose()?;
    let film = film.map(|film| Film::new(&film.within(&partial.path()), plan.world.grid())).transpose();
    let film = film.map_err(|failure| failure.moved(&partial.path(), &out))?;
    let mut film = film.map(FilmSink::new);
    let started = Instant::now();
    let mut checkpoints = Checkpoints::new(&partial.checkpoints(), plan, request.checkpoint_every);
    let from = checkpoints.latest().map_err(TimelineError::from)?;
    if let Some(checkpoint) = &from {
        if let Some(film) = &mut film {
            film.begin_at(checkpoint);
        }
        tell(Event::Resumed { time_yr: checkpoint.time_yr(), filmed: film.is_some() });
    } else if request.existing == Existing::Resume {
        tell(Event::Anew);
    }
    let bakes = bake.map(|bake| bake.begin(&partial.bake(), from.as_ref())).transpose()?;
    let place = from.as_ref().map(Checkpoint::place);
    let keep = |layers| KeepSink::begin(&partial.timeline(), plan.world.grid(), layers, place);
    let mut keep = kept_layers(request, until)?.as_deref().map(keep).transpose()?;
    let mut series = SeriesSink::begin(partial.beside(), place)?;
    let mut profiles = ProfileSink::begin(partial.beside(), place, keep.is_some())?;
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut series, &mut profiles];
    sinks.extend(film.as_mut().map(|film| film as &mut dyn Sink));
    sinks.extend(frames.as_mut().map(|frames| frames as &mut dyn Sink));
    sinks.extend(keep.as_mut().map(|keep| keep as &mut dyn Sink));
    let recorder = bakes.as_ref().map(|bakes| bakes as &dyn Recorder);
    let mut timeline =
        Timeline::new(plan, cancel).until(until).keeping(&mut checkpoints).from(from).recording(recorder);
    let world = timeline.run(&mut sinks, &mut |moment| tell(Event::Step(moment)));
    let stages = timeline.records().to_vec();
    let kept = checkpoints.any();
    let stopped = |error: JobError| if kept && error.cancelled() { JobError::Stopped } else { error };
    let world = world.map_err(|error| stopped(error.into()))?;
    let (mut films, mut failures) = (Vec::new(), Vec::new());
    for end in [film.map(FilmSink::finish), frames.map(HeightFrames::finish)].into_iter().flatten() {
        match end {
            // What was made within the folder moves with it.
            Ok(made) => films.push(made.strip_prefix(partial.path()).map(|inner| out.join(inner)).unwrap_or(made)),
            Err(failure) => failures.push(failure.moved(&partial.path(), &out)),
        }
    }
    let height_png = write(plan, &world, &partial.path(), cancel, tell).map_err(stopped)?;
    keep.map_or(Ok(()), |keep| keep.finish(&partial.path().join(STORE)))?;
    let in_time = [(SERIES, series.finish(&partial.path())?), (PROFILES, profiles.finish(&partial.path())?)];
    let mut manifest = Manifest::new(plan, &world, measure::inspect(&world), height_png);
    let notes = findings(plan, &stages);
    manifest.stages = stages;
    manifest.in_time = in_time.into_iter().filter(|(_, made)| *made).map(|(file, _)| file).collect();
    manifest.baked = bakes.map_or(Ok(Vec::new()), |bakes| bakes.finish(&partial.path()))?;
    films.extend(manifest.baked.iter().map(|file| out.join(file)));
    manifest.until = ended;
    manifest.seconds = started.elapsed().as_secs_f64();
    manifest.write(&partial.path())?;
    Ok(Grown { folder: partial.finish()?, manifest: manifest.text(), notes, films, failures })
}

/// What stages have met that a person should know, under the names people have for them.
fn findings(plan: &Plan, records: &[StageRecord]) -> Vec<String> {
    let label = |key: &str| plan.with_coupled().find(|s| s.key == key).map_or(key, |stage| &stage.label).to_owned();
    let lines = |record: &StageRecord| {
        let name = label(&record.stage);
        record.findings.iter().map(|line| format!("stage '{name}': {line}")).collect::<Vec<_>>()
    };
    records.iter().flat_map(lines).collect()
}

/// The layers of the timeline, where one is kept: also those by which the land is coloured and lava is drawn, for films of it.
fn kept_layers(request: &Request, until: Option<usize>) -> Result<Option<Vec<Layer>>, JobError> {
    let Some(mut layers) = request.keep.clone() else { return Ok(None) };
    let made = made(&request.plan, until)?;
    for drawn in [&relief::CLIMATE[..], &relief::LAVA] {
        if drawn.iter().all(|layer| made.contains(layer)) {
            let missing: Vec<Layer> = drawn.iter().copied().filter(|layer| !layers.contains(layer)).collect();
            layers.extend(missing);
        }
    }
    Ok(Some(layers))
}

/// The finished world at `out`; an error if it is of another recipe.
fn finished(plan: &Plan, until: Option<&str>, out: &Path) -> Result<Option<Grown>, JobError> {
    let path = out.join(MANIFEST);
    let manifest = match fs::read_to_string(&path) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(cause) => return Err(JobError::Disk { path, cause }),
        Ok(text) => text,
    };
    let said: serde_json::Value = serde_json::from_str(&manifest).unwrap_or_default();
    if said["recipe"] != plan.text.as_str() || said["until"].as_str() != until {
        let shown = out.display();
        return Err(JobError::Refused(format!(
            "{shown}: the world there is of another recipe; choose another --out, or replace it with --force"
        )));
    }
    Ok(Some(Grown { folder: out.to_owned(), manifest, notes: Vec::new(), films: Vec::new(), failures: Vec::new() }))
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
