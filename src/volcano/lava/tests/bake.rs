//! What a recording shows is what flows.

use std::sync::Mutex;

use super::*;
use crate::bake::{Frame, Tape, due_s};

/// Keeps all frames.
struct Roll {
    per_s: f64,
    frames: Mutex<Vec<Frame>>,
}

impl Roll {
    fn new(per_s: f64) -> Self {
        Self { per_s, frames: Mutex::default() }
    }

    fn frames(self) -> Vec<Frame> {
        self.frames.into_inner().unwrap()
    }
}

impl Tape for Roll {
    fn per_s(&self) -> f64 {
        self.per_s
    }

    fn take(&self, frame: Frame) -> Result<(), String> {
        self.frames.lock().unwrap().push(frame);
        Ok(())
    }
}

fn params() -> LavaParams {
    LavaParams {
        duration_min: 0.1,
        schedule: vec![Timed::particles(0.2, 1.5, 120.0), Timed::particles(2.5, 1.0, 60.0)],
        spacing_m: 1.0,
        cooling_factor: 3000.0,
        ..LavaParams::default()
    }
}

fn cone() -> World {
    world(Grid::new(40, 40, 60.0, Edges::Open), |x, y| 40.0 - 0.6 * (x - 30.0).hypot(y - 30.0))
}

/// What flows now, as a frame.
fn now(own: &Eruption, time_s: f64) -> Frame {
    let seen = own.seen();
    let mut order: Vec<usize> = (0..seen.born.len()).collect();
    order.sort_by_key(|&i| seen.born[i]);
    let [x, y, z] = seen.place_m;
    let wide = |values: &[f32], off: f64| order.iter().map(|&i| f64::from(values[i]) + off).collect::<Vec<f64>>();
    let heat = order.iter().map(|&i| seen.degc[i]).collect();
    let columns = vec![wide(x, 0.0), wide(y, 0.0), wide(z, f64::from(seen.datum_m)), heat, wide(seen.age_s, 0.0)];
    Frame { time_s, id: order.iter().map(|&i| seen.born[i] as u32).collect(), columns }
}

#[test]
fn frames_are_the_state_at_their_time_and_change_nothing() {
    let (mut own, mut plain, roll) = (eruption(&params(), &cone()), eruption(&params(), &cone()), Roll::new(20.0));
    let mut states = Vec::new();
    for step in 0..6 {
        let [from, to] = [step, step + 1].map(f64::from);
        own.run_on(from, to, Some(&roll)).unwrap();
        plain.run(from, to).unwrap();
        states.push(now(&own, to));
        assert_eq!(now(&plain, to), states[step as usize], "being looked at changes nothing");
    }
    let frames = roll.frames();
    // Six seconds of twenty, and the first moment.
    assert_eq!(
        frames.iter().map(|f| f.time_s).collect::<Vec<_>>(),
        (0..=120).map(|k| due_s(k, 20.0)).collect::<Vec<_>>()
    );
    for (step, state) in states.iter().enumerate() {
        assert_eq!(&frames[20 * (step + 1)], state, "second {}", step + 1);
    }
    // Nothing before the schedule begins; later some have frozen, and some flow.
    assert!(frames[..=4].iter().all(|frame| frame.id.is_empty()) && frames[40].id.len() > 50);
    assert!(own.counts()[1] > 0, "some froze: {:?}", own.counts());
    for pair in frames.windows(2) {
        for (i, id) in pair[0].id.iter().enumerate() {
            let Ok(j) = pair[1].id.binary_search(id) else { continue };
            // No particle goes faster than its limit, so that none can jump.
            let way = [0, 1, 2].map(|axis| pair[1].columns[axis][j] - pair[0].columns[axis][i]);
            assert!(way.iter().all(|way| way.abs() <= 60.0 / 20.0), "{way:?}");
            // Ages are sums in f32.
            let aged = pair[1].columns[4][j] - pair[0].columns[4][i];
            assert!((aged - 0.05).abs() < 1e-5, "{aged}");
            assert!(pair[1].columns[3][j] <= pair[0].columns[3][i] + 30.0, "it cools");
        }
    }
}

#[test]
fn frames_have_the_same_times_whatever_the_steps_are() {
    let at = |time_step_s: f64| {
        let roll = Roll::new(37.0);
        let mut own = eruption(&LavaParams { time_step_s, ..params() }, &cone());
        own.run_on(0.0, 2.0, Some(&roll)).unwrap();
        roll.frames()
    };
    let [long, short] = [0.0, 0.004].map(at);
    assert_eq!(long.len(), 75);
    assert!(long.iter().zip(&short).all(|(a, b)| a.time_s == b.time_s) && long.len() == short.len());
    // As many came out, within one that the steps of the schedule's sum shift.
    assert!(long.iter().zip(&short).all(|(a, b)| a.id.len().abs_diff(b.id.len()) <= 30), "blocks emit together");
}

#[test]
fn what_flies_freely_is_on_its_line_in_every_frame() {
    let free = LavaParams {
        schedule: vec![Timed::particles(0.0, 1.0, 200.0)],
        exit_speed_m_per_s: 9.0,
        gravity: false,
        pressure: false,
        viscosity: Viscosity::Off,
        ground: Contact::Off,
        cooling_factor: 0.0,
        time_step_s: 0.013,
        ..params()
    };
    let roll = Roll::new(29.0);
    eruption(&free, &cone()).run_on(0.0, 2.0, Some(&roll)).unwrap();
    let frames = roll.frames();
    let mut pairs = 0;
    for pair in frames.windows(2) {
        for (i, id) in pair[0].id.iter().enumerate() {
            let j = pair[1].id.binary_search(id).unwrap();
            let rise = pair[1].columns[2][j] - pair[0].columns[2][i];
            // Heights over the datum are f32 below 64 m, rounded each step: 4e-6 m a step, and there are three in a frame.
            assert!((rise - 9.0 / 29.0).abs() < 5e-5, "{rise}");
            pairs += 1;
        }
    }
    assert!(pairs > 5000, "{pairs}");
}

#[test]
fn a_tape_that_is_full_ends_the_run() {
    struct Full;
    impl Tape for Full {
        fn per_s(&self) -> f64 {
            5.0
        }
        fn take(&self, frame: Frame) -> Result<(), String> {
            if frame.time_s > 1.0 { Err("the disk is full".into()) } else { Ok(()) }
        }
    }
    assert_eq!(eruption(&params(), &cone()).run_on(0.0, 3.0, Some(&Full)), Err("the disk is full".into()));
}

#[test]
fn smoke_stands_over_vents_while_lava_comes_out() {
    let (own, mut world) = (eruption(&params(), &cone()), cone());
    world.time_yr = 100.0;
    let plumes = params().plumes(&own.sources, &own.schedule, &world, Key::new(1));
    let spans: Vec<[f64; 2]> =
        plumes.iter().map(|p| [p.begin_yr, p.end_yr].map(|yr| (yr - 100.0) * 365.25 * 86_400.0)).collect();
    // A year has 3.2e7 s, and a hundred of them are known to 4e-7 s.
    let want = [[0.2, 1.7], [2.5, 3.5]];
    assert!(spans.len() == 2 && spans.iter().flatten().zip(want.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-6));
    // On the summit, which is a cell's middle.
    assert!((plumes[0].at_m[2] - 40.0).abs() < 1.0 && (plumes[0].at_m[0] - 30.0).abs() < 1.5, "{plumes:?}");
    assert_ne!(plumes[0].seed, plumes[1].seed);
    let none = LavaParams { smoke_m_per_s: 0.0, ..params() };
    assert!(none.plumes(&own.sources, &own.schedule, &world, Key::new(1)).is_empty());
}
