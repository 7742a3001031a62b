//! The run itself.

use std::{sync::atomic::AtomicBool, time::Instant};

use crate::{
    process::{Context, Process, ProcessError, Step},
    recipe::{Plan, Stage},
    world::{Layer, Matter, World},
};

use super::{Moment, Sink, StageRecord};

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
}

/// A plan being run.
pub struct Timeline<'a> {
    plan: &'a Plan,
    cancel: &'a AtomicBool,
    until: Option<usize>,
    records: Vec<StageRecord>,
}

impl<'a> Timeline<'a> {
    /// A run of the whole plan; `cancel` stops it between two steps.
    pub fn new(plan: &'a Plan, cancel: &'a AtomicBool) -> Self {
        Self { plan, cancel, until: None, records: Vec::new() }
    }

    /// Ends after the stage of that place in the plan.
    pub fn until(mut self, stage: Option<usize>) -> Self {
        self.until = stage;
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
        let mut world = World::new(self.plan.world.grid(), self.plan.world.sea_level_m);
        let running: Vec<&Stage> =
            self.plan.running().filter(|(i, _)| self.until.is_none_or(|end| *i <= end)).map(|(_, s)| s).collect();
        for (index, stage) in running.iter().enumerate() {
            let started = Instant::now();
            let began_yr = world.time_yr;
            let mut watch = Watch { sinks, progress, index, stages: running.len(), label: &stage.label };
            let steps = self.stage(stage, &mut world, &mut watch)?;
            self.records.push(StageRecord {
                stage: stage.key.clone(),
                kind: stage.kind.kind.to_owned(),
                steps,
                seconds: started.elapsed().as_secs_f64(),
                elapsed_yr: world.time_yr - began_yr,
            });
        }
        // A world whose stages were all skipped still has a ground.
        world.layer_mut(Layer::Bedrock);
        Ok(world)
    }

    fn stage(&self, stage: &Stage, world: &mut World, watch: &mut Watch) -> Result<u64, TimelineError> {
        let context = Context::new(self.plan.world.seed, &stage.key, self.cancel);
        let at = |step: u64| move |error: ProcessError| stopped(stage, step, error);
        let mut process = stage.build().map_err(at(0))?;
        world.ledger.open(&stage.key, Matter::Rock, world.rock_m3());
        watch.tell(0, 0.0, world);
        for step in 1.. {
            context.check().map_err(at(step))?;
            let Step { done, elapsed_yr } = process.step(world, &context).map_err(at(step))?;
            world.time_yr += elapsed_yr;
            find_non_finite(stage, step, process.writes(), world)?;
            let over = done >= 1.0;
            watch.show(process.as_mut(), world, &context, step, done).map_err(|stop| match stop {
                Stop::Process(error) => stopped(stage, step, error),
                Stop::Sink(why) => TimelineError::Sink(why),
            })?;
            if over {
                // What the stage published last may be bad as well.
                find_non_finite(stage, step, process.writes(), world)?;
                world.ledger.close(&stage.key, Matter::Rock, world.rock_m3());
                watch.tell(step, 1.0, world);
                return Ok(step);
            }
            watch.tell(step, done, world);
        }
        unreachable!("no run has 2^64 steps")
    }
}

fn stopped(stage: &Stage, step: u64, error: ProcessError) -> TimelineError {
    match error {
        ProcessError::Cancelled => TimelineError::Cancelled,
        error => TimelineError::Process { stage: stage.label.clone(), step, why: error.to_string() },
    }
}

/// Looks only at what the process may have written; what it did not touch was looked at before.
fn find_non_finite(stage: &Stage, step: u64, written: &[Layer], world: &World) -> Result<(), TimelineError> {
    use rayon::prelude::*;
    const RUN: usize = 1 << 14;
    for field in written.iter().filter(|layer| !layer.derived()).filter_map(|&layer| world.layer(layer)) {
        if field.data.par_chunks(RUN).any(|run| !run.iter().all(|v| v.is_finite())) {
            let Some((layer, x, y)) = world.first_non_finite() else { continue };
            let stage = stage.label.clone();
            return Err(TimelineError::NonFinite { stage, step, layer: layer.name(), x, y });
        }
    }
    Ok(())
}

enum Stop {
    Process(ProcessError),
    Sink(String),
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
    fn show(
        &mut self,
        process: &mut dyn Process,
        world: &mut World,
        context: &Context,
        step: u64,
        done: f64,
    ) -> Result<(), Stop> {
        let moment = self.moment(step, done, world);
        let wanting: Vec<bool> = self.sinks.iter_mut().map(|sink| sink.wants(&moment)).collect();
        if moment.stage_over() || wanting.contains(&true) {
            process.publish(world, context).map_err(Stop::Process)?;
        }
        for (sink, _) in self.sinks.iter_mut().zip(wanting).filter(|(_, wants)| *wants) {
            sink.take(world, &moment).map_err(Stop::Sink)?;
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
        fn wants(&mut self, moment: &Moment) -> bool {
            moment.step.is_multiple_of(self.0)
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

    /// Runs one stage on ground with one parameter set; a refusal in words is fine, a panic or a bad value is not.
    fn survives(kind: &str, set: String, world: &str) {
        let base = "[[stage]]\nkind = \"fbm\"\nid = \"base\"\n";
        let text = format!("[world]\nsize = 16\n{world}\n{base}[[stage]]\nid = \"own\"\nkind = \"{kind}\"\n");
        let source = Source { name: "t".into(), file: "t.toml".into(), folder: PathBuf::new(), text };
        let plan = Plan::new(&source, &Overrides { set: vec![set.clone()], ..Overrides::default() });
        // What is in range may still not go together: said in a line, with its place.
        let plan = match plan {
            Ok(plan) => plan,
            Err(error) => return assert!(error.to_string().starts_with("t.toml:"), "{kind} with {set}: {error}"),
        };
        let stay = AtomicBool::new(false);
        match Timeline::new(&plan, &stay).run(&mut [], &mut |_| ()) {
            Ok(_) | Err(TimelineError::Process { .. }) => {}
            Err(error) => panic!("{kind} with {set} and {world}: {error}"),
        }
    }

    #[test]
    fn the_ends_of_every_range_are_safe() {
        for kind in crate::recipe::stage_kinds().iter().filter(|kind| kind.kind != "drip") {
            for (key, property) in kind.schema["properties"].as_object().unwrap() {
                for bound in ["minimum", "maximum"] {
                    if property[bound].is_number() {
                        // Schemas state the ranges of counts as fractions too.
                        let whole = property["type"].as_str() == Some("integer");
                        let value = property[bound].as_f64().unwrap();
                        let value = if whole { format!("{value:.0}") } else { format!("{value:?}") };
                        survives(kind.kind, format!("own.{key}={value}"), "");
                    }
                }
            }
            for world in ["extent_km = 0.01", "extent_km = 40075", "edges = \"wrap\"", "sea_level_m = 12000"] {
                survives(kind.kind, "own.enabled=true".into(), world);
            }
            survives(kind.kind, "world.size=[16, 1024]".into(), "");
            survives(kind.kind, "world.size=[1024, 16]".into(), "");
        }
    }
}
