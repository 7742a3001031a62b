//! One contract for every stage in the registry, none left out: it changes only the layers it declares and makes those,
//! gives the same bits when it is stopped, saved and continued, ends with finite heights and with closed books. And what
//! comes from outside (`hostile`) is refused in one line.

mod sampled;

use std::{path::PathBuf, sync::atomic::AtomicBool};

use upthrust::{
    grid::Field,
    process::{Context, Process, ProcessError},
    recipe::{Overrides, Plan, Source, Stage, stage_kinds},
    world::{Layer, Matter, World},
};

/// A stage to try: its kind, its parameters in TOML, and the layers it may declare without making them.
struct Case {
    kind: &'static str,
    params: &'static str,
    may_leave_out: &'static [Layer],
}

const fn case(kind: &'static str, params: &'static str) -> Case {
    Case { kind, params, may_leave_out: &[] }
}

/// At least one for each kind. Masks that read the ground catch a stage that looks at its own results.
const CASES: &[Case] = &[
    case("plates", "cells = 96\ncount = 5\nduration_myr = 4.0\nsteps = 7\n"),
    case("plates", "cells = 96\ncount = 5\nduration_myr = 4.0\nsteps = 7\nland_share = 0.4\nblend = 'add'\n"),
    case("plates", "cells = 96\ncount = 5\nduration_myr = 4.0\nsteps = 7\nmask = 'height > 0'\n"),
    Case {
        kind: "plates",
        params: "style = 'thesis'\ncount = 9\nduration_myr = 8.0\n",
        // The thesis knows no crust and classifies no border.
        may_leave_out: &[Layer::Uplift, Layer::CrustKind, Layer::CrustAge, Layer::CrustThickness, Layer::BoundaryKind],
    },
    case("fbm", ""),
    case("fbm", "blend = 'add'\nmask = 'height > 0'\n"),
    case("multifractal", ""),
    case("warp", ""),
    case("terrace", ""),
    case("diamond_square", ""),
    case("fault", "blend = 'add'\n"),
    case("rmp_peak", "blend = 'max'\n"),
    case("rmp_ridge", "mask = 'slope'\n"),
    case("rmp_graph", "blend = 'min'\n"),
    case("island", ""),
    case(
        "island",
        "blend = 'max'\nislands = [{ at_km = [300, 300] }, { at_km = [700, 500], radius_km = 90 }]\nmask = 'height > 0'\n",
    ),
    case("volcano", ""),
    case("volcano", "blend = 'add'\nage_myr = 3.0\nprofile = 'gaussian'\nmask = 'height > 0'\n"),
    case("volcano", "blend = 'max'\nplace = 'chain'\nradius_km = 80.0\n"),
    case("climate", ""),
    case("climate", "rain_mm_per_yr = 800.0\nmask = 'height > 0'\n"),
    case("lava_sheet", "steps = 4\nduration_h = 6\nschedule = [{ start_h = 0, duration_h = 3, m3_per_s = 2e4 }]\n"),
    case(
        "lava_sheet",
        "steps = 3\nduration_h = 3\nschedule = [{ start_h = 0, m3_per_s = 5e4 }]\nvent = [{ at_km = [500, 400], to_km = [600, 500] }]\nmask = 'height > -2000'\n",
    ),
    case("ash", "volume_km3 = 50\ncolumn_km = 30\n"),
    case("ash", "volume_km3 = 50\nat_km = [300, 300]\nmask = 'height > 0'\n"),
    case("import", ""),
    Case { kind: "stream_power", params: "duration_myr = 0.5\n", may_leave_out: &[Layer::Lava] },
    Case {
        kind: "stream_power",
        params: "duration_myr = 0.3\nn = 2.0\nmask = 'height > 0'\n",
        may_leave_out: &[Layer::Lava],
    },
    Case {
        kind: "stream_power",
        params: "duration_myr = 0.3\ndeposition = 1.0\nrim = 'fixed'\n",
        may_leave_out: &[Layer::Lava],
    },
    Case { kind: "hillslope", params: "steps = 3\nduration_kyr = 1e5\n", may_leave_out: &[Layer::Lava] },
    Case {
        kind: "hillslope",
        params: "steps = 3\nduration_kyr = 1e5\nmask = 'height > 0'\n",
        may_leave_out: &[Layer::Lava],
    },
    Case {
        kind: "thermal",
        params: "steps = 4\ntalus_angle_deg = 2.0\nrock_angle_deg = 3.0\n",
        may_leave_out: &[Layer::Lava],
    },
    Case {
        kind: "thermal",
        params: "steps = 3\nmethod = 'cells'\ntalus_angle_deg = 2.0\nrock_angle_deg = 2.0\nlock = 'coast'\nmask = 'height > 0'\n",
        may_leave_out: &[Layer::Lava],
    },
    Case {
        kind: "thermal",
        params: "steps = 3\ntalus_angle_deg = 2.0\ncoarse_levels = 2\nhard_rate = 0.2\nhard_to_m = 900.0\n",
        may_leave_out: &[Layer::Lava],
    },
    Case { kind: "hydraulic_cells", params: "steps = 3\nduration_h = 1000\n", may_leave_out: &[Layer::Lava] },
    Case {
        kind: "hydraulic_cells",
        params: "steps = 3\nduration_h = 1000\nsteepness = 'hard_cliffs'\nlock = 'coast'\nmask = 'height > 0'\n",
        may_leave_out: &[Layer::Lava],
    },
    Case { kind: "pipes", params: "steps = 3\nduration_h = 20\nrain_mm_per_h = 300\n", may_leave_out: &[Layer::Lava] },
    Case {
        kind: "pipes",
        params: "steps = 2\nduration_h = 10\nrain_mm_per_h = 300\nsediment = 'maccormack'\nflux = 'mei'\nlock = 'coast'\nmask = 'height > 0'\nrain_by_map = true\n",
        may_leave_out: &[Layer::Lava],
    },
    Case {
        kind: "rain_particles",
        params: "steps = 3\nduration_min = 1000\nparticles = 500\n",
        may_leave_out: &[Layer::Lava],
    },
    Case { kind: "droplets", params: "steps = 3\npath_m = 1e6\n", may_leave_out: &[Layer::Lava] },
    Case {
        kind: "droplets",
        params: "steps = 2\npath_m = 3e5\nlock = 'coast'\nmask = 'height > 0'\n",
        may_leave_out: &[Layer::Lava],
    },
    Case {
        kind: "lava",
        params: "steps = 3\nduration_min = 30\nschedule = [{ start_time = 0, duration = 900, particles_per_second = 0.3 }]\ncooling_factor = 3e5\n",
        may_leave_out: &[Layer::Sediment],
    },
    Case {
        kind: "lava",
        params: "steps = 2\nduration_min = 10\nschedule = [{ start_time = 0, particles_per_second = 0.3 }]\nfreeze = false\nsettle = false\nground = 'slip'\nyield_pa = 1e6\nvent = [{ at_km = [500, 400], to_km = [600, 450] }]\nmask = 'height > -3000'\n",
        may_leave_out: &[Layer::Sediment],
    },
    case("uplift", "mm_per_yr = 0.7\n"),
    case(
        "uplift",
        "shape = 'block'\noutline = 'disc'\nedge_km = 100\nchange = [{ from_myr = 2, mm_per_yr = 3 }]\nmask = 'height > 0'\n",
    ),
    case("uplift", "shape = 'image'\npath = 'sample:my-heights.png'\nadd = true\n"),
    case("hardness", "bands = 3\nwidth_km = 60\nfold_km = 20\nmask = 'slope'\n"),
    case("zoom", ""),
    case("zoom", "window_km = [300, 200, 500, 300]\nsize = 80\ndetail = 0\n"),
    case("zoom", "around = 'river'\nsize_km = 400\n"),
    case("import", "blend = 'max'\nsmooth = 1.0\nhigh_m = 3000.0\nmask = 'height > 100'\n"),
    Case { kind: "rivers", params: "", may_leave_out: &[Layer::Lava] },
    Case {
        kind: "rivers",
        params: "mask = 'height > 0'\nlake_loss_mm_per_yr = 900.0\ncarve = 3.0\n",
        may_leave_out: &[Layer::Lava],
    },
];

impl Case {
    fn name(&self) -> String {
        format!("{} {:?}", self.kind, self.params)
    }

    fn plan(&self) -> Plan {
        // The first stage stands for whatever made the ground; only the second is run.
        let text = format!(
            "[world]\nseed = 3\nsize = [48, 40]\n[[stage]]\nid = 'ground'\nkind = 'fbm'\n[[stage]]\nid = 'own'\nkind = '{}'\n{}",
            self.kind, self.params
        );
        let source = Source { name: "case".into(), file: "case.toml".into(), folder: PathBuf::new(), text };
        Plan::new(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{}: {e}", self.name()))
    }
}

/// A world with something in every layer that can be stored.
fn full_world(plan: &Plan) -> World {
    let grid = plan.world.grid();
    let mut world = World::new(grid, 0.0);
    for (i, &layer) in Layer::ALL.iter().enumerate().filter(|(_, layer)| !layer.derived()) {
        let wave = |x: usize, y: usize| ((x * 7 + y * 3 + i) % 11) as f32 / 11.0;
        world.set_layer(layer, Field::from_fn(grid, wave));
    }
    let hills = |x: usize, y: usize| 900.0 * ((x as f32 * 0.21).sin() + (y as f32 * 0.17).cos());
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, hills));
    world
}

/// Runs `process` from a step to the end and publishes there and after every step in `shown`; gives the steps taken.
fn go(process: &mut dyn Process, world: &mut World, context: &Context, mut step: u64, shown: &[u64]) -> u64 {
    loop {
        step += 1;
        if take(process, world, context, shown.contains(&step)) {
            return step;
        }
    }
}

/// One step as the timeline takes it.
fn take(process: &mut dyn Process, world: &mut World, context: &Context, show: bool) -> bool {
    let step = process.step(world, context).unwrap();
    world.time_yr += step.elapsed_yr;
    if show || step.finished() {
        process.publish(world, context).unwrap();
    }
    step.finished()
}

fn assert_only_declared(before: &World, after: &World, declared: &[Layer], name: &str) {
    if before.grid != after.grid {
        // On another raster every layer is another.
        return assert!(before.layers().map(|(layer, _)| layer).eq(after.layers().map(|(layer, _)| layer)), "{name}");
    }
    for &layer in Layer::ALL.iter().filter(|layer| !layer.derived() && !declared.contains(layer)) {
        assert_eq!(before.layer(layer), after.layer(layer), "{name}: {} is not declared", layer.name());
    }
}

fn assert_same_ground(a: &World, b: &World, what: &str) {
    for ((layer, a), (_, b)) in a.layers().zip(b.layers()) {
        let same = a.data.iter().zip(&b.data).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{what}: {} differs", layer.name());
    }
    assert!(a.tables().eq(b.tables()), "{what}: a table differs");
    assert_eq!(
        (a.sea_level_m.to_bits(), a.time_yr.to_bits()),
        (b.sea_level_m.to_bits(), b.time_yr.to_bits()),
        "{what}"
    );
}

fn keeps_the_contract(case: &Case, stage: &Stage, start: &World) {
    let name = case.name();
    let stay = AtomicBool::new(false);
    let context = Context::new(3, &stage.key, &stay);
    let mut world = start.clone();
    world.ledger.open(&stage.key, Matter::Rock, world.rock_m3());
    let opened = world.clone();

    let mut process = stage.build().unwrap();
    let steps = go(process.as_mut(), &mut world, &context, 0, &[]);
    let declared = process.writes();
    assert_only_declared(start, &world, declared, &name);
    assert!(world.first_non_finite().is_none(), "{name}");
    world.ledger.close(&stage.key, Matter::Rock, world.rock_m3());
    for (_, matter, account) in world.ledger.accounts() {
        assert!(account.residual_share() <= 1e-6, "{name}: {matter:?} {account:?}");
    }

    for stop in (0..steps).filter(|stop| [0, 1, steps / 2, steps - 1].contains(stop)) {
        // The same frame in the middle, with and without an interruption after it.
        let mut through = opened.clone();
        go(stage.build().unwrap().as_mut(), &mut through, &context, 0, &[stop]);
        let mut stopped = opened.clone();
        let mut first = stage.build().unwrap();
        for step in 1..=stop {
            take(first.as_mut(), &mut stopped, &context, step == stop);
            assert_only_declared(start, &stopped, declared, &name);
        }
        let saved = first.save();
        drop(first);
        let mut second = stage.build().unwrap();
        second.restore(saved.clone(), &context).unwrap();
        assert_eq!(second.save(), saved, "{name}: saved again after step {stop}");
        go(second.as_mut(), &mut stopped, &context, stop, &[]);
        assert_same_ground(&world, &through, &format!("{name}: a frame after step {stop}"));
        assert_same_ground(&through, &stopped, &format!("{name}: stopped after step {stop}"));
        assert_eq!(through.ledger, stopped.ledger, "{name}: stopped after step {stop}");
    }
}

/// A step that is cancelled, also one that first has to find the way back to a saved state, has changed nothing.
fn is_cancelled_whole(case: &Case, stage: &Stage, start: &World) {
    let (stay, stop) = (AtomicBool::new(false), AtomicBool::new(true));
    let [go_on, cancelled] = [&stay, &stop].map(|cancel| Context::new(3, &stage.key, cancel));
    let mut world = start.clone();
    let mut process = stage.build().unwrap();
    for _ in 0..2 {
        let (before, saved) = (world.clone(), process.save());
        match process.step(&mut world, &cancelled) {
            Err(ProcessError::Cancelled) => assert!(world == before && process.save() == saved, "{}", case.name()),
            other => assert!(other.is_ok(), "{}: {other:?}", case.name()),
        }
        if take(process.as_mut(), &mut world, &go_on, false) {
            return;
        }
        let state = process.save();
        process = stage.build().unwrap();
        process.restore(state, &go_on).unwrap();
    }
}

/// What a stage declares it makes, in a world that has only ground.
fn makes_what_it_declares(case: &Case, stage: &Stage, start: &World) {
    let stay = AtomicBool::new(false);
    let context = Context::new(3, &stage.key, &stay);
    let mut world = World::new(start.grid, 0.0);
    world.set_layer(Layer::Bedrock, start.layer(Layer::Bedrock).unwrap().clone());
    let mut process = stage.build().unwrap();
    for &layer in process.reads() {
        world.layer_mut(layer);
    }
    let before = world.clone();
    go(process.as_mut(), &mut world, &context, 0, &[]);
    for &layer in process.writes() {
        let made = world.layer(layer).is_some();
        assert_eq!(made, !case.may_leave_out.contains(&layer), "{}: {}", case.name(), layer.name());
    }
    let changed = process.writes().iter().any(|&layer| world.layer(layer) != before.layer(layer));
    assert!(changed, "{}: nothing happened", case.name());
}

#[test]
fn every_stage_keeps_the_contract() {
    for kind in stage_kinds() {
        let cases: Vec<&Case> = CASES.iter().filter(|case| case.kind == kind.kind).collect();
        assert!(!cases.is_empty(), "the stage '{}' has no case in this test", kind.kind);
        for case in cases {
            let plan = case.plan();
            let start = full_world(&plan);
            keeps_the_contract(case, &plan.stages[1], &start);
            is_cancelled_whole(case, &plan.stages[1], &start);
            makes_what_it_declares(case, &plan.stages[1], &start);
        }
    }
    for case in CASES {
        assert!(stage_kinds().iter().any(|kind| kind.kind == case.kind), "there is no stage '{}'", case.kind);
    }
}

/// Heights before and after a family of erosion on hills by the sea, a hundred metres high; those of particles are smaller.
fn eroded(kind: &str, params: &str) -> [Field<f32>; 2] {
    let [extent_km, height_m] = if kind == "rain_particles" { [0.096, 20.0] } else { [0.768, 100.0] };
    let text = format!(
        "[world]\nsize = 96\nextent_km = {extent_km}\n[[stage]]\nkind = 'fbm'\nheight_m = {height_m}\nwavelength_km = {}\n\
         [[stage]]\nkind = '{kind}'\n{params}",
        0.5 * extent_km
    );
    let source = Source { name: "case".into(), file: "case.toml".into(), folder: PathBuf::new(), text };
    let plan = Plan::new(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{kind} {params}: {e}"));
    let mut world = World::new(plan.world.grid(), 0.0);
    let stay = AtomicBool::new(false);
    [0, 1].map(|k| {
        let stage = &plan.stages[k];
        go(stage.build().unwrap().as_mut(), &mut world, &Context::new(3, &stage.key, &stay), 0, &[]);
        world.height()
    })
}

/// As much as each family does in a few seconds, with something that brings heights near to the sea.
const FAMILIES: [(&str, &str); 5] = [
    ("thermal", "talus_angle_deg = 10.0\nrock_angle_deg = 10.0\nmethod = 'flux'\n"),
    ("hydraulic_cells", ""),
    ("droplets", "duration_yr = 50000.0\n"),
    ("rain_particles", "duration_min = 1\nmorphological_factor = 500\n"),
    ("pipes", "duration_h = 0.5\n"),
];

fn coast_stays((kind, params): (&str, &str)) {
    let [before, after] = eroded(kind, &format!("{params}lock = 'coast'\n"));
    let crossed: Vec<_> = before.data.iter().zip(&after.data).filter(|(a, b)| (**a < 0.0) != (**b < 0.0)).collect();
    assert!(crossed.is_empty(), "{kind}: {} cells: {:?}", crossed.len(), &crossed[..crossed.len().min(3)]);
    assert!(before.data.iter().zip(&after.data).any(|(a, b)| (a - b).abs() > 0.5), "{kind} did nothing");
}

/// Heights as the world has them: single precision, parted into layers, rounds otherwise than what the stage works with.
#[test]
fn a_locked_coast_stays_in_the_world() {
    FAMILIES[..4].iter().for_each(|&family| coast_stays(family));
}

#[test]
fn a_locked_coast_stays_in_the_world_of_pipes() {
    coast_stays(FAMILIES[4]);
}

#[test]
fn nothing_changes_beyond_a_mask() {
    for (kind, params) in FAMILIES {
        let [before, after] = eroded(kind, &format!("{params}mask = 'height > 8'\n"));
        let changed = |within: bool| {
            let cells = before.data.iter().zip(&after.data).filter(|(a, _)| (**a > 8.0) == within);
            cells.filter(|(a, b)| a.to_bits() != b.to_bits()).count()
        };
        assert_eq!(changed(false), 0, "{kind} changed what is masked out");
        assert!(changed(true) > 100, "{kind} did nothing");
    }
}

#[test]
fn a_broken_state_is_refused() {
    let case = &CASES[0];
    let plan = case.plan();
    let stay = AtomicBool::new(false);
    let context = Context::new(3, "plates#1", &stay);
    let mut process = plan.stages[1].build().unwrap();
    let broken = upthrust::process::State { blob: vec![1, 2, 3], ..Default::default() };
    assert!(process.restore(broken, &context).is_err());
}
