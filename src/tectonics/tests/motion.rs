//! How two driven plates close, part, slide and hold each other.

use crate::tectonics::{
    contact::{Contact, Motion},
    domain::SIDE_UNITS,
    engine::Grip,
    partition,
};

use super::*;

const EAST: DVec2 = DVec2::X;

fn first_contact(drives: [DVec2; 2]) -> Contact {
    let mut engine = pair(drives, settings());
    engine.step(|_, _| Grip::default());
    let contacts = engine.contacts();
    assert_eq!(contacts.len(), 1);
    contacts[0]
}

#[test]
fn head_on_apart_and_shear_are_told_apart() {
    // What was driven, in units of 50 mm/yr, and the closing speed that follows.
    for (west, east, motion, closing) in [
        (EAST, -EAST, Motion::Convergent, 2.0),
        (EAST * 0.3, EAST * -0.1, Motion::Convergent, 0.4),
        (EAST * 0.6, EAST * 0.2, Motion::Convergent, 0.4),
        (-EAST * 0.2, EAST * 0.2, Motion::Divergent, -0.4),
        (DVec2::Y, -DVec2::Y, Motion::Transform, 0.0),
        (DVec2::new(0.1, 1.0), -DVec2::Y, Motion::Transform, 0.1),
        (DVec2::new(1.0, 1.0), DVec2::ZERO, Motion::Convergent, 1.0),
        (DVec2::ZERO, DVec2::ZERO, Motion::Quiet, 0.0),
    ] {
        let contact = first_contact([west, east]);
        assert_eq!(contact.motion(), motion, "{west} {east}");
        let driven = closing * SPEED_MM_PER_YR * 1e-3;
        // Velocities are f32 in the engine.
        assert!((contact.closing_m_per_yr() - driven).abs() < 1e-6 * SPEED_MM_PER_YR, "{west} {east}: {contact:?}");
        assert!(contact.normal.distance(EAST) < 1e-6 && contact.plates == [0, 1]);
    }
}

#[test]
fn the_contact_is_the_border() {
    let contact = first_contact([EAST * 0.1, -EAST * 0.1]);
    let (cell, length) = (CELL_M, 34.0 * 50e3);
    assert!((contact.length_m() - length).abs() < cell, "{}", contact.length_m());
    assert!(contact.ends_m.iter().all(|end| east_m(*end).abs() < cell));
}

#[test]
fn a_long_push_integrates_to_the_driven_convergence() {
    let myr = 30.0;
    let speed = 0.2;
    let run = run(simulation([EAST * speed, -EAST * speed], rules(myr), |_| ocean()));
    let driven_m = 2.0 * speed * KM_PER_MYR * 1e3 * myr;
    let closed_m = run.closings[0].closed_m;
    assert_eq!(run.closings.len(), 1);
    assert!((closed_m / driven_m - 1.0).abs() < 0.05, "closed {closed_m} of {driven_m}");
    // Two rigid outlines overlap by what they closed.
    let overlap_m = run.engine.contacts()[0].overlap_m;
    assert!((overlap_m / driven_m - 1.0).abs() < 0.05, "overlap {overlap_m} of {driven_m}");
    assert!((run.time_myr / myr - 1.0).abs() < 0.01, "{}", run.time_myr);
}

/// Continents stop where resistance times overlap (in 100 km) takes the whole drive.
#[test]
fn resistance_stops_a_collision() {
    for resistance in [0.5, 1.0, 2.0] {
        let mut engine = pair([EAST, -EAST], Settings { resistance, ..settings() });
        let both = Grip { continental: 1.0, sinking: None };
        // Overlap nears its end by a factor e every 1 / resistance My.
        for _ in 0..(20.0 / resistance * 30.0) as usize {
            engine.step(|_, _| both);
        }
        let contact = engine.contacts()[0];
        let stopped = contact.closing_m_per_yr() / (2.0 * SPEED_MM_PER_YR * 1e-3);
        assert!(stopped.abs() < 1e-3, "{resistance}: {stopped} of the closing is left");
        let overlap = contact.overlap_m / 100e3;
        assert!((resistance * overlap - 1.0).abs() < 0.01, "{resistance}: stopped at {overlap} of 100 km");
    }
}

#[test]
fn a_slab_pulls_its_own_plate_only() {
    let mut engine = pair([EAST * 0.2, -EAST * 0.2], Settings { slab_pull: 0.5, ..settings() });
    for _ in 0..150 {
        engine.step(|_, _| Grip { continental: 0.0, sinking: Some(0) });
    }
    let at = domain().center_m();
    let speed = |plate: usize| engine.velocity_at(plate, at).x / (SPEED_MM_PER_YR * 1e-3);
    // Pull over drag: a terminal velocity that is faster by the pull, five drag times over.
    assert!((speed(0) - 0.7).abs() < 1e-3, "{}", speed(0));
    assert!((speed(1) + 0.2).abs() < 1e-3, "{}", speed(1));
}

/// Bits of all poses and velocities after ten thousand steps of a dozen stirred plates.
fn ten_thousand_steps() -> Vec<[u64; 4]> {
    let h = SIDE_UNITS / 2.0;
    let square = vec![DVec2::new(-h, -h), DVec2::new(h, -h), DVec2::new(h, h), DVec2::new(-h, h)];
    let outlines = partition::cut(square, 12, Key::new(9));
    let mantle = Mantle::new(0.4, Key::new(9).named("mantle"));
    let settings = Settings { resistance: 0.3, slab_pull: 0.3, ..settings() };
    let mut engine = Engine::new(domain(), &outlines, vec![Drive::Mantle; 12], mantle, settings).unwrap();
    for _ in 0..10_000 {
        engine.step(|a, b| Grip { continental: 0.5, sinking: Some(a.max(b)) });
    }
    assert!(engine.finite());
    (0..12)
        .map(|p| {
            let (pose, velocity) = (engine.pose(p), engine.velocity_at(p, DVec2::ZERO));
            [pose.at_m.x, pose.at_m.y, pose.turn.y, velocity.x + velocity.y].map(f64::to_bits)
        })
        .collect()
}

#[test]
fn ten_thousand_steps_give_the_same_bits_for_any_number_of_threads() {
    let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let first = ten_thousand_steps();
    assert_eq!(first, ten_thousand_steps());
    for threads in [1, 8] {
        assert_eq!(first, pool(threads).install(ten_thousand_steps), "{threads} threads");
    }
}
