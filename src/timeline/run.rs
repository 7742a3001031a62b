//! The run itself.

use std::{sync::atomic::AtomicBool, time::Instant};

use crate::{
    process::{ProcessError, State, Step},
    recipe::{Plan, Stage},
    world::{Layer, World},
};

use super::{
    Interest, Moment, Recorder, Sink, StageRecord,
    checkpoint::{Checkpoint, CheckpointError, Checkpoints, Position},
    group::{Failure, Group},
};

/// Why a run stopped.
#[derive(Debug, thiserror::Error)]
pub enum TimelineError {
    /// The user asked for it.
    #[error("stopped on request")]
    Cancelled,
    /// A stage could not go on.
    #[error("stage '{stage}', step {step}: {why}")]
    Process {
        /// The stage.
        stage: String,
        /// The step, from 1.
        step: u64,
        /// In the stage's own words.
        why: String,
        /// Whether what was asked for is wrong, rather than the run.
        unfit: bool,
    },
    /// A value is no number any more.
    #[error(
        "stage '{stage}', step {step}: the layer '{layer}' is not finite at cell {x}, {y}; \
         please report it with the recipe"
    )]
    NonFinite {
        /// The stage.
        stage: String,
        /// The step, from 1.
        step: u64,
        /// The layer.
        layer: &'static str,
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
    /// A sink could not take a frame.
    #[error("{0}")]
    Sink(String),
    /// A checkpoint could not be kept or taken up.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The stopped run is further than this one is to go.
    #[error("the stopped run is past the stage '{0}' already; leave out --until, or start anew with --force")]
    Past(String),
}

/// A plan being run.
pub struct Timeline<'a> {
    plan: &'a Plan,
    cancel: &'a AtomicBool,
    until: Option<usize>,
    checkpoints: Option<&'a mut Checkpoints>,
    start: Option<Checkpoint>,
    recorder: Option<&'a dyn Recorder>,
    records: Vec<StageRecord>,
}

impl<'a> Timeline<'a> {
    /// A run of the whole plan; `cancel` stops it between two steps.
    pub fn new(plan: &'a Plan, cancel: &'a AtomicBool) -> Self {
        Self { plan, cancel, until: None, checkpoints: None, start: None, recorder: None, records: Vec::new() }
    }

    /// Ends after the stage of that place in the plan.
    pub fn until(mut self, stage: Option<usize>) -> Self {
        self.until = stage;
        self
    }

    /// Keeps checkpoints: every now and then, and when it is stopped.
    pub fn keeping(mut self, checkpoints: &'a mut Checkpoints) -> Self {
        self.checkpoints = Some(checkpoints);
        self
    }

    /// Goes on where a stopped run of the same plan was.
    pub fn from(mut self, checkpoint: Option<Checkpoint>) -> Self {
        self.start = checkpoint;
        self
    }

    /// Has particles recorded.
    pub fn recording(mut self, recorder: Option<&'a dyn Recorder>) -> Self {
        self.recorder = recorder;
        self
    }

    /// What the finished stages cost.
    pub fn records(&self) -> &[StageRecord] {
        &self.records
    }

    /// Runs to the end and gives the world. `progress` hears of every step.
    pub fn run(
        &mut self,
        sinks: &mut [&mut dyn Sink],
        progress: &mut dyn FnMut(&Moment),
    ) -> Result<World, TimelineError> {
        let plan = self.plan;
        let running: Vec<&Stage> =
            plan.running().filter(|(i, _)| self.until.is_none_or(|end| *i <= end)).map(|(_, s)| s).collect();
        let (mut world, mut from, mut state) = match self.start.take() {
            Some(Checkpoint { position, world, state }) => (world, position, state),
            None => (World::new(plan.world.grid(), plan.world.sea_level_m), Position::default(), None),
        };
        if from.stage > running.len() {
            return Err(TimelineError::Past(running.last().map_or_else(String::new, |stage| stage.label.clone())));
        }
        self.records = std::mem::take(&mut from.records);
        for (index, stage) in running.iter().enumerate().skip(from.stage) {
            let mut watch = Watch { sinks, progress, index, stages: running.len(), label: &stage.label };
            if from.step == 0 {
                from = Position { stage: index, began_yr: world.time_yr, ..Position::default() };
            }
            let from = std::mem::take(&mut from);
            let records = self.stage(stage, &mut world, (from, state.take()), &mut watch)?;
            self.records.extend(records);
        }
        // A world whose stages were all skipped still has a ground.
        world.layer_mut(Layer::Bedrock);
        Ok(world)
    }

    /// Runs a stage, and those coupled to it, from where it is to its end.
    fn stage(
        &mut self,
        stage: &Stage,
        world: &mut World,
        (mut at, state): (Position, Option<State>),
        watch: &mut Watch,
    ) -> Result<Vec<StageRecord>, TimelineError> {
        let (started, before) = (Instant::now(), at.seconds);
        let recorder = self.recorder.and_then(|recorder| Some((recorder, recorder.tape(watch.index)?)));
        let group = Group::new(stage, self.plan.world.seed, self.cancel).map_err(|e| stopped(at.step, e))?;
        let mut group = group.recording(recorder.map(|(_, tape)| tape));
        match state {
            Some(state) => group.restore(state).map_err(|e| stopped(at.step, e))?,
            None => group.open(world),
        }
        watch.tell(at.step, at.done, world);
        while at.done < 1.0 {
            at.seconds = before + started.elapsed().as_secs_f64();
            let grid = world.grid;
            let taken = group.step(world);
            if let Err(Failure { why: ProcessError::Cancelled, .. }) = taken {
                self.keep(world, &at, &group)?;
            }
            let Step { done, elapsed_yr } = taken.map_err(|e| stopped(at.step + 1, e))?;
            (at.step, at.done) = (at.step + 1, done);
            world.time_yr += elapsed_yr;
            // A world on another grid has been made anew, layer by layer.
            let all = (world.grid != grid).then_some(Layer::ALL);
            find_non_finite(stage, at.step, group.writes().chain(all.into_iter().flatten().copied()), world)?;
            watch.show(&mut group, world, &at)?;
            if let Some((recorder, _)) = recorder {
                recorder.step(&watch.moment(at.step, done, world)).map_err(TimelineError::Sink)?;
            }
            if done < 1.0 {
                watch.tell(at.step, done, world);
                if self.checkpoints.as_ref().is_some_and(|checkpoints| checkpoints.due()) {
                    at.seconds = before + started.elapsed().as_secs_f64();
                    self.keep(world, &at, &group)?;
                }
            }
        }
        // What the stage published last may be bad as well.
        find_non_finite(stage, at.step, group.writes(), world)?;
        group.close(world);
        watch.tell(at.step, 1.0, world);
        let seconds = before + started.elapsed().as_secs_f64();
        Ok(group.records(at.step, seconds, world.time_yr - at.began_yr, &world.ledger))
    }

    /// Keeps a checkpoint, where there is anything yet to be kept.
    fn keep(&mut self, world: &World, at: &Position, group: &Group) -> Result<(), TimelineError> {
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        if at.stage == 0 && at.step == 0 {
            return Ok(());
        }
        let position = Position { records: self.records.clone(), ..at.clone() };
        // A stage that has not begun begins anew.
        let state = (at.step > 0).then(|| group.save());
        Ok(checkpoints.save(world, &position, state.as_ref())?)
    }
}

fn stopped(step: u64, Failure { stage, why }: Failure) -> TimelineError {
    match why {
        ProcessError::Cancelled => TimelineError::Cancelled,
        why => {
            let unfit = matches!(why, ProcessError::Unfit(_) | ProcessError::Mask(_));
            TimelineError::Process { stage: stage.label.clone(), step, why: why.to_string(), unfit }
        }
    }
}

/// Looks only at what the stage may have written; what it did not touch was looked at before.
fn find_non_finite(
    stage: &Stage,
    step: u64,
    written: impl Iterator<Item = Layer>,
    world: &World,
) -> Result<(), TimelineError> {
    use rayon::prelude::*;
    const RUN: usize = 1 << 14;
    for field in written.filter(|layer| !layer.derived()).filter_map(|layer| world.layer(layer)) {
        if field.data.par_chunks(RUN).any(|run| !run.iter().all(|v| v.is_finite())) {
            let Some((layer, x, y)) = world.first_non_finite() else { continue };
            let stage = stage.label.clone();
            return Err(TimelineError::NonFinite { stage, step, layer: layer.name(), x, y });
        }
    }
    Ok(())
}

/// Those who look on while a stage runs.
struct Watch<'w, 's> {
    sinks: &'w mut [&'s mut dyn Sink],
    progress: &'w mut dyn FnMut(&Moment),
    index: usize,
    stages: usize,
    label: &'w str,
}

impl<'w> Watch<'w, '_> {
    fn moment(&self, step: u64, done: f64, world: &World) -> Moment<'w> {
        Moment { stage: self.index, stages: self.stages, label: self.label, step, done, time_yr: world.time_yr }
    }

    fn tell(&mut self, step: u64, done: f64, world: &World) {
        let moment = self.moment(step, done, world);
        (self.progress)(&moment);
    }

    /// Publishes where a frame is wanted or the stage is over, and hands the frame on.
    fn show(&mut self, group: &mut Group, world: &mut World, at: &Position) -> Result<(), TimelineError> {
        let moment = self.moment(at.step, at.done, world);
        let wanted: Vec<Interest> = self.sinks.iter_mut().map(|sink| sink.wants(&moment)).collect();
        let current = if group.up_to_date() { Interest::Ground } else { Interest::None };
        let most = wanted.iter().copied().max().filter(|&most| most > Interest::Passing);
        let published = moment.stage_over() || most.is_some_and(|most| most > current);
        if published {
            group.publish(world).map_err(|e| stopped(at.step, e))?;
        }
        let least = if published || current == Interest::Ground { Interest::Passing } else { Interest::Ground };
        for (sink, wanted) in self.sinks.iter_mut().zip(wanted) {
            if wanted >= least {
                sink.take(world, &moment).map_err(TimelineError::Sink)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::{path::PathBuf, sync::atomic::Ordering};

    use super::*;
    use crate::recipe::{Overrides, Source};

    const TEXT: &str = "[world]\nsize = 16\n[[stage]]\nkind = \"probe\"\n[[stage]]\nkind = \"drip\"\ncount = 5\n";

    fn plan(text: &str) -> Plan {
        let source = Source { name: "t".into(), file: "t.toml".into(), folder: PathBuf::new(), text: text.into() };
        Plan::new(&source, &Overrides::default()).unwrap()
    }

    fn grown(text: &str) -> World {
        let stay = AtomicBool::new(false);
        Timeline::new(&plan(text), &stay).run(&mut [], &mut |_| ()).unwrap()
    }

    struct Every(u64, Vec<(usize, u64, f32)>);

    impl Sink for Every {
        fn wants(&mut self, moment: &Moment) -> Interest {
            Interest::Whole.when(moment.step.is_multiple_of(self.0))
        }

        fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String> {
            let depth = world.layer(Layer::Sediment).map_or(0.0, |field| field.at(0, 0));
            self.1.push((moment.stage, moment.step, depth));
            Ok(())
        }
    }

    #[test]
    fn stages_run_in_order_and_the_books_close() {
        let (plan, stay) = (plan(TEXT), AtomicBool::new(false));
        let mut timeline = Timeline::new(&plan, &stay);
        let mut sink = Every(2, Vec::new());
        let mut heard = Vec::new();
        let world = timeline.run(&mut [&mut sink], &mut |m| heard.push((m.stage, m.step, m.overall()))).unwrap();
        assert_eq!(sink.1, [(1, 2, 2.0), (1, 4, 4.0)]);
        assert_eq!((heard[0], heard[heard.len() - 1]), ((0, 0, 0.0), (1, 5, 1.0)));
        assert_eq!(world.time_yr, 5.0);
        let steps: Vec<_> = timeline.records().iter().map(|r| (r.stage.as_str(), r.steps, r.elapsed_yr)).collect();
        assert_eq!(steps, [("probe#1", 1, 0.0), ("drip#1", 5, 5.0)]);
        for (stage, _, account) in world.ledger.accounts() {
            assert!(account.came_in_m3 > 0.0 && account.residual_share() < 1e-6, "{stage}: {account:?}");
        }
    }

    #[test]
    fn disabling_a_stage_leaves_the_random_numbers_of_others() {
        let two = "[world]\nsize = 16\n[[stage]]\nkind = \"probe\"\n[[stage]]\nkind = \"probe\"\nblend = \"max\"\n";
        let off = two.replacen("\"probe\"\n", "\"probe\"\nenabled = false\n", 1);
        let height = |text: &str| grown(text).height().at(0, 0);
        let first = height("[world]\nsize = 16\n[[stage]]\nkind = \"probe\"\n");
        assert_ne!(height(&off), first);
        assert_eq!(height(two), first.max(height(&off)));
        let more = two.replace(
            "[[stage]]\nkind = \"probe\"\nblend",
            "[[stage]]\nkind = \"drip\"\ncount = 1\n[[stage]]\nkind = \"probe\"\nblend",
        );
        assert_eq!(height(&more), height(two) + 1.0);
    }

    #[test]
    fn a_bad_value_is_named() {
        let (plan, stay) = (plan(&TEXT.replace("count = 5", "break_at = 2")), AtomicBool::new(false));
        let error = Timeline::new(&plan, &stay).run(&mut [], &mut |_| ()).unwrap_err().to_string();
        let want =
            "stage 'drip', step 2: the layer 'sediment' is not finite at cell 3, 0; please report it with the recipe";
        assert_eq!(error, want);
    }

    #[test]
    fn it_stops_between_steps_and_at_a_stage() {
        let (plan, cancel) = (plan(TEXT), AtomicBool::new(false));
        let mut last = 0;
        let stopped = Timeline::new(&plan, &cancel).run(&mut [], &mut |m| {
            last = m.step;
            cancel.store(m.stage == 1 && m.step == 3, Ordering::Relaxed);
        });
        assert!(matches!(stopped, Err(TimelineError::Cancelled)));
        assert_eq!(last, 3);
        cancel.store(false, Ordering::Relaxed);
        let mut timeline = Timeline::new(&plan, &cancel).until(Some(0));
        let world = timeline.run(&mut [], &mut |_| ()).unwrap();
        assert!(world.layer(Layer::Sediment).is_none());
    }

    const PLATES: &str = "[[stage]]\nkind = \"plates\"\nduration_myr = 2\ncells = 64\nsteps = 6\n";
    const COUPLED: &str = "[[stage]]\nkind = \"drip\"\ncoupled = true\n";

    #[test]
    fn a_run_goes_on_from_any_step_to_the_same_bits() {
        goes_on(&format!("{TEXT}{PLATES}"));
    }

    #[test]
    fn stages_that_step_in_turn_go_on_to_the_same_bits() {
        goes_on(&format!("{TEXT}{PLATES}{COUPLED}"));
    }

    #[test]
    fn the_books_of_stages_that_take_turns_close_each() {
        let text = format!("[world]\nsize = 48\n{PLATES}{COUPLED}");
        let (plan, stay) = (plan(&text), AtomicBool::new(false));
        let mut timeline = Timeline::new(&plan, &stay);
        let world = timeline.run(&mut [], &mut |_| ()).unwrap();
        let kinds: Vec<_> = timeline.records().iter().map(|r| (r.kind.as_str(), r.steps, r.elapsed_yr)).collect();
        assert_eq!(kinds, [("plates", 6, 2e6), ("drip", 6, 2e6)]);
        let drip = world.ledger.account("drip#1", crate::world::Matter::Rock).unwrap();
        // 60 m over half the map.
        let want = 60.0 * 0.5 * world.grid.cells() as f64 * world.grid.cell_area_m2();
        assert!((drip.came_in_m3 / want - 1.0).abs() < 1e-6, "{drip:?}");
        for (stage, matter, account) in world.ledger.accounts() {
            assert!(account.residual_share() < 1e-6, "{stage} {matter:?}: {account:?}");
        }
        // The load went with the plates, and the crust below knows of it.
        assert!(world.layer(Layer::Sediment).unwrap().range().unwrap().1 > 50.0);
        assert_eq!(plan.find_stage("drip"), Some(0));
    }

    #[test]
    fn nothing_is_coupled_to_a_stage_that_cannot_lead() {
        let text = format!("[world]\nsize = 16\n[[stage]]\nkind = \"probe\"\n{COUPLED}");
        let source = Source { name: "t".into(), file: "t.toml".into(), folder: PathBuf::new(), text };
        let error = Plan::new(&source, &Overrides::default()).unwrap_err().to_string();
        assert!(error.starts_with("t.toml:5: stage 'drip': coupled = true"), "{error}");
    }

    fn goes_on(text: &str) {
        let (plan, cancel) = (plan(text), AtomicBool::new(false));
        let mut steps = Vec::new();
        let whole = Timeline::new(&plan, &cancel).run(&mut [], &mut |m| steps.push((m.stage, m.step))).unwrap();
        steps.dedup();
        assert!(steps.len() > 10, "{steps:?}");
        for &(stage, step) in &steps {
            let folder = tempfile::tempdir().unwrap();
            let mut checkpoints = Checkpoints::new(folder.path(), &plan, std::time::Duration::MAX);
            cancel.store(false, Ordering::Relaxed);
            let stopped = Timeline::new(&plan, &cancel).keeping(&mut checkpoints).run(&mut [], &mut |m| {
                cancel.fetch_or((m.stage, m.step) == (stage, step), Ordering::Relaxed);
            });
            cancel.store(false, Ordering::Relaxed);
            let from = checkpoints.latest().unwrap();
            match stopped {
                Err(TimelineError::Cancelled) => assert_eq!(from.is_none(), (stage, step) == (0, 0)),
                // The last step leaves nothing to be stopped.
                other => assert_eq!((other.unwrap() == whole, steps.last()), (true, Some(&(stage, step)))),
            }
            let mut again = Timeline::new(&plan, &cancel).keeping(&mut checkpoints).from(from);
            assert!(again.run(&mut [], &mut |_| ()).unwrap() == whole, "stopped at stage {stage}, step {step}");
            let records: Vec<_> = again.records().iter().map(|r| (r.steps, r.elapsed_yr)).collect();
            let members: usize = plan.stages.iter().map(|stage| 1 + stage.coupled.len()).sum();
            assert_eq!(records.len(), members, "{records:?}");
        }
    }

    #[test]
    fn a_run_goes_on_across_a_zoom() {
        let text = "[world]\nsize = 32\n[[stage]]\nkind = \"fbm\"\n[[stage]]\nkind = \"drip\"\ncount = 2\n\
                    [[stage]]\nkind = \"zoom\"\nsize_km = 400\nsize = 48\n[[stage]]\nkind = \"drip\"\ncount = 3\n";
        let (plan, cancel) = (plan(text), AtomicBool::new(false));
        let whole = Timeline::new(&plan, &cancel).run(&mut [], &mut |_| ()).unwrap();
        assert_eq!((whole.grid.width, whole.grid.extent_m()), (48, [400e3, 400e3]));
        assert_eq!(plan.grids().iter().map(|grid| grid.width).collect::<Vec<_>>(), [32, 32, 48, 48]);
        for (_, _, account) in whole.ledger.accounts() {
            assert!(account.residual_share() < 1e-6, "{account:?}");
        }
        for (stage, step) in [(1, 1), (2, 0), (2, 1), (3, 0), (3, 1), (3, 2)] {
            let folder = tempfile::tempdir().unwrap();
            let mut checkpoints = Checkpoints::new(folder.path(), &plan, std::time::Duration::MAX);
            let stopped = Timeline::new(&plan, &cancel).keeping(&mut checkpoints).run(&mut [], &mut |m| {
                cancel.fetch_or((m.stage, m.step) == (stage, step), Ordering::Relaxed);
            });
            assert!(matches!(stopped, Err(TimelineError::Cancelled)), "{stage} {step}");
            cancel.store(false, Ordering::Relaxed);
            let from = checkpoints.latest().unwrap();
            assert!(
                Timeline::new(&plan, &cancel).from(from).run(&mut [], &mut |_| ()).unwrap() == whole,
                "{stage} {step}"
            );
        }
    }

    #[test]
    fn a_damaged_checkpoint_gives_way_to_the_one_before() {
        let (plan, cancel) = (plan(TEXT), AtomicBool::new(false));
        let folder = tempfile::tempdir().unwrap();
        let mut checkpoints = Checkpoints::new(folder.path(), &plan, std::time::Duration::ZERO);
        let whole = Timeline::new(&plan, &cancel).keeping(&mut checkpoints).run(&mut [], &mut |_| ()).unwrap();
        let mut kept: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        kept.sort();
        assert_eq!(kept, ["000003", "000004", "latest"], "the last two of four");
        std::fs::write(folder.path().join("000004/process.bin"), "x").unwrap();
        let from = checkpoints.latest().unwrap();
        assert_eq!(from.as_ref().unwrap().position.step, 3);
        let mut again = Timeline::new(&plan, &cancel).from(from);
        assert!(again.run(&mut [], &mut |_| ()).unwrap() == whole);
        std::fs::remove_file(folder.path().join("000003/checkpoint.json")).unwrap();
        let line = checkpoints.latest().err().unwrap().to_string();
        assert!(line.contains("000004: the checkpoint is damaged") && !line.contains('\n'), "{line}");
    }

    /// Runs one stage on ground with one parameter set; a refusal in words is fine, a panic or a bad value is not.
    fn survives(kind: &str, set: &[String], world: &str) {
        let set = set.to_vec();
        let base = "[[stage]]\nkind = \"fbm\"\nid = \"base\"\n";
        let text = format!("[world]\nsize = 16\n{world}\n{base}[[stage]]\nid = \"own\"\nkind = \"{kind}\"\n");
        let source = Source { name: "t".into(), file: "t.toml".into(), folder: PathBuf::new(), text };
        let plan = Plan::new(&source, &Overrides { set: set.clone(), ..Overrides::default() });
        // What is in range may still not go together: said in a line, with its place.
        let plan = match plan {
            Ok(plan) => plan,
            Err(error) => return assert!(error.to_string().starts_with("t.toml:"), "{kind} with {set:?}: {error}"),
        };
        let stay = AtomicBool::new(false);
        match Timeline::new(&plan, &stay).run(&mut [], &mut |_| ()) {
            Ok(_) | Err(TimelineError::Process { .. }) => {}
            Err(error) => panic!("{kind} with {set:?} and {world}: {error}"),
        }
    }

    #[test]
    fn the_ends_of_every_range_are_safe() {
        for kind in crate::recipe::stage_kinds().iter().filter(|kind| kind.kind != "drip") {
            // How long lava is followed is a matter of patience too: a moment will do.
            let moment = match kind.kind {
                "lava" => Some("own.duration_min=0.005"),
                "lava_sheet" => Some("own.duration_h=0.01"),
                _ => None,
            };
            let survives = |set: &[String], world: &str| {
                let first = moment.map(str::to_owned);
                survives(kind.kind, &first.into_iter().chain(set.iter().cloned()).collect::<Vec<_>>(), world);
            };
            for (key, property) in kind.schema["properties"].as_object().unwrap() {
                for bound in ["minimum", "maximum"] {
                    let cells = property["x-unit"] == "cells" && bound == "maximum";
                    // The most cells a map may have are a matter of patience and memory, not of parameters.
                    let patience = moment.is_some() && bound == "maximum" && key.starts_with("duration_");
                    if !property[bound].is_number() || (cells && kind.kind == "zoom") || patience {
                        continue;
                    }
                    // Schemas state the ranges of counts as fractions too.
                    let whole = property["type"].to_string().contains("integer");
                    let value = property[bound].as_f64().unwrap();
                    let value = if whole { format!("{value:.0}") } else { format!("{value:?}") };
                    let mut set = vec![format!("own.{key}={value}")];
                    // So are the steps of the most cells that plates may have.
                    set.extend(cells.then(|| "own.steps=2".to_owned()));
                    survives(&set, "");
                }
            }
            for world in ["extent_km = 0.01", "extent_km = 40075", "edges = \"wrap\"", "sea_level_m = 12000"] {
                survives(&["own.enabled=true".into()], world);
            }
            survives(&["world.size=[16, 1024]".into()], "");
            survives(&["world.size=[1024, 16]".into()], "");
        }
    }
}
