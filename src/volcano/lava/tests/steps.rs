//! Steps in time on lava itself: how fast the error of each scheme falls with the step.

use super::*;
use crate::sph::Scheme;

/// Speed of sound, m/s: that of stiffness 400 m²/s².
const SOUND: f64 = 20.0;
/// How long the lump is followed: sound goes through it, s.
const SPAN_S: f64 = 0.25;

/// A lump of lava that falls, spins, is pressed together and rings: where everyone is in the end, by birth.
fn flown(scheme: Scheme, steps: u32) -> Vec<[f64; 3]> {
    let grid = Grid::new(16, 16, 16.0, Edges::Open);
    let params = LavaParams {
        spacing_m: 1.0,
        ground: Contact::Off,
        stiffness_m2_per_s2: SOUND * SOUND,
        viscosity_pa_s: 2000.0,
        viscosity_solver: Solver::Explicit,
        integrator: scheme,
        time_step_s: SPAN_S / f64::from(steps),
        force_time_step: true,
        ..LavaParams::default()
    };
    let (mut flow, land) = cold(&params, &world(grid, |_, _| 0.0));
    // About the origin, where single precision is finest.
    fill(&mut flow, [-4.0; 3], [8; 3], 0.1);
    let cloud = &mut flow.swarm.cloud;
    for i in 0..cloud.len() {
        for at in [&mut cloud.x[i], &mut cloud.y[i], &mut cloud.z[i]] {
            *at *= 0.96;
        }
        let [x, y, z] = [cloud.x[i], cloud.y[i], cloud.z[i]];
        (cloud.vx[i], cloud.vy[i], cloud.vz[i]) = (-0.3 * x - 0.5 * y, 0.5 * x - 0.3 * y, -0.3 * z);
    }
    flow_for(&mut flow, &land, SPAN_S);
    let (cloud, born) = (&flow.swarm.cloud, &flow.swarm.born);
    let mut places = vec![[0.0; 3]; cloud.len()];
    for (i, &id) in born.iter().enumerate() {
        places[id as usize] = [cloud.x[i], cloud.y[i], cloud.z[i]].map(f64::from);
    }
    places
}

/// The root of the mean square of the ways between two outcomes, m.
fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>();
    (a.iter().zip(b).map(square).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn schemes_have_their_orders_on_lava() {
    // Sixteen times as many steps of second order: its own error is a two-hundredth of the least that is measured.
    let true_places = flown(Scheme::Midpoint, 1024);
    let off = |scheme: Scheme, steps: u32| apart(&flown(scheme, steps), &true_places);
    let mut coarse = Vec::new();
    for (scheme, order) in
        [(Scheme::SymplecticEuler, 1.0), (Scheme::Euler, 1.0), (Scheme::Rk2Document, 1.0), (Scheme::Midpoint, 2.0)]
    {
        let errors = [16, 32, 64].map(|steps| off(scheme, steps));
        let measured = libm::log2(errors[1] / errors[2]);
        eprintln!("{scheme:?}: {errors:?} m, order {measured}");
        // The next term of the series is smaller by what a step is of the time in which sound crosses a smoothing length:
        // 0.06 at 64 steps.
        assert!((measured - order).abs() < 0.15, "{scheme:?}: {errors:?} m, order {measured}");
        coarse.push(errors[1]);
    }
    let [_, euler, document, midpoint] = coarse[..] else { panic!("four schemes") };
    // The document's second look buys what two half steps of Euler do; the same look used rightly is worth far more.
    assert!((1.8..2.2).contains(&(euler / document)), "{euler} m, {document} m");
    assert!(document > 10.0 * midpoint, "{document} m, {midpoint} m");
}
