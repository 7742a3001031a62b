//! What can be seen only from inside the engine: where momentum comes from, and what solid contacts would do.

use super::*;
use crate::{
    noise::Key,
    tectonics::tests::{domain, halves, pair, settings},
};

fn momentum(engine: &Engine) -> DVec2 {
    let body = |handle: &RigidBodyHandle| &engine.world.bodies[*handle];
    engine.plates.iter().map(|h| double(body(h).linvel()) * body(h).mass() as f64).sum()
}

/// Impulse that drag gives all plates in the next step.
fn drag_impulse(engine: &Engine) -> DVec2 {
    (0..engine.plates())
        .map(|p| {
            let body = &engine.world.bodies[engine.plates[p]];
            (engine.target_velocity(p) - double(body.linvel())) * (body.mass() as f64 * DRAG_PER_S * DT)
        })
        .sum()
}

/// Impulse that the beams gave all plates in the last step.
fn beam_impulse(engine: &Engine) -> DVec2 {
    let mut sum = DVec2::ZERO;
    for pair in engine.world.contact_pairs() {
        let beam = [pair.collider1, pair.collider2].map(|c| engine.world.colliders[c].user_data == BEAM);
        // The normal points from the first collider to the second; the impulse pushes them apart.
        let sign = match beam {
            [true, false] => 1.0,
            [false, true] => -1.0,
            _ => continue,
        };
        for manifold in pair.manifolds() {
            let impulse: f32 = manifold.points.iter().map(|p| p.data.impulse).sum();
            sum += double(manifold.data.normal) * (sign * impulse as f64);
        }
    }
    sum
}

/// Σ m·Δv is what drag and beams give; what plates do to each other cancels.
#[test]
fn momentum_comes_from_drag_and_beams() {
    let outlines = partition::cut(domain().square_engine(), 12, Key::new(3));
    let mantle = Mantle::new(0.6, Key::new(3).named("mantle"));
    let settings = Settings { resistance: 1.0, ..settings() };
    let mut engine = Engine::new(domain(), &outlines, vec![Drive::Mantle; 12], mantle, settings).unwrap();
    let (mut explained, mut moved, mut beams) = (momentum(&engine), 0.0, 0.0);
    for step in 0..300 {
        let drag = drag_impulse(&engine);
        engine.step(|_, _| Grip { continental: 1.0, sinking: None });
        let beam = beam_impulse(&engine);
        explained += drag + beam;
        moved += drag.length() + beam.length();
        beams += beam.length();
        let error = explained.distance(momentum(&engine));
        // f32 velocities of 12 bodies: a few 1e-7 of the whole momentum a step, adding up.
        assert!(error < 1e-3 * moved.max(1.0), "step {step}: {error} of {moved}");
    }
    assert!(beams > 1.0, "no plate met a beam: {beams}");
}

/// A free plate takes up a new velocity by a factor 1 - c·Δt a step, which is explicit Euler's exponential.
#[test]
fn a_free_plate_nears_the_flow_below_it_exponentially() {
    let mut engine = pair([DVec2::ZERO; 2], settings());
    let wanted = DVec2::new(-0.8, 0.1);
    engine.drives[0] = Drive::Own(wanted);
    for step in 1..=30 {
        engine.step(|_, _| Grip::default());
        let missing = wanted.length() * (1.0 - DRAG_PER_S * DT).powi(step);
        let velocity = double(engine.world.bodies[engine.plates[0]].linvel());
        assert!((velocity.distance(wanted) - missing).abs() < 1e-5, "step {step}: {velocity}");
        assert_eq!(engine.world.bodies[engine.plates[1]].linvel(), Vector::ZERO);
    }
}

/// Why contacts between plates are not solved: solid plates stop each other at the first touch, so that 30 My of pushing
/// close nothing that a range could be raised from.
#[test]
fn solid_plates_would_close_nothing() {
    let mut engine = pair([DVec2::X * 0.2, DVec2::X * -0.2], settings());
    let driven_m = 0.4 * engine.domain.unit_m() * 30.0;
    let mut closed_m = 0.0;
    for _ in 0..(30.0 / DT) as usize {
        engine.drag();
        engine.world.step_with_events(&(), &());
        closed_m += engine.contacts().iter().map(|c| c.closing_m_per_yr()).sum::<f64>() * engine.step_yr();
    }
    let overlap_m = engine.contacts()[0].overlap_m;
    assert!(closed_m.abs() < 0.01 * driven_m && overlap_m.abs() < 0.01 * driven_m, "{closed_m} {overlap_m}");
}

/// The thesis's style is the same: two plates that touch stay apart.
#[test]
fn shaken_plates_do_not_overlap() {
    let settings = Settings { style: Style::Shaken, ..settings() };
    let block = halves().map(|outline| outline.into_iter().map(|v| v * 1.05).collect::<Polygon>());
    let mantle = Mantle::new(0.0, Key::new(0));
    let mut engine = Engine::new(domain(), &block, vec![Drive::Mantle; 2], mantle, settings).unwrap();
    let (mut deepest_m, mut begun) = (f64::NEG_INFINITY, 0);
    for _ in 0..900 {
        engine.step(|_, _| Grip::default());
        begun += engine.take_begun().len();
        deepest_m = engine.contacts().iter().map(|c| c.overlap_m).fold(deepest_m, f64::max);
    }
    assert!(begun > 0, "nothing collided");
    assert!(deepest_m < 0.2 * engine.domain.unit_m(), "{deepest_m}");
}
