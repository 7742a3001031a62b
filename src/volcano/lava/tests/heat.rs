//! Conduction, radiation, and what surfaces take.

use super::super::heat::{Lost, Surfaces};
use super::*;
use crate::sph::Kernel;

/// A block of lava that rests in the air.
fn block(params: LavaParams, counts: [usize; 3]) -> (Flow, Land) {
    let grid = Grid::new(60, 60, 60.0, Edges::Open);
    let own = LavaParams {
        gravity: false,
        pressure: false,
        viscosity: Viscosity::Off,
        ground: Contact::Off,
        spacing_m: 1.0,
        time_step_s: 10.0,
        ..params
    };
    let mut flow = Flow::new(Law::new(&own, &grid), grid);
    fill(&mut flow, [10.0, 20.0, 10.0], counts, 0.0);
    (flow, Land::new(&world(grid, |_, _| 0.0)))
}

#[test]
fn heat_between_two_blocks_spreads_as_an_error_function_and_none_is_lost() {
    for smoothing in [1.3, 1.5] {
        let params = LavaParams {
            smoothing,
            latent_heat_j_per_kg: 0.0,
            lose_to_air: false,
            radiate: false,
            lose_to_ground: false,
            // D = κ/(ρ·c) = 1e-2 m²/s.
            conductivity_w_per_m_k: 1e-2 * 2600.0 * 1150.0,
            ..LavaParams::default()
        };
        let (mut flow, land) = block(params, [40, 7, 7]);
        let degc = |x: f32| if x < 30.0 { 1100.0 } else { 700.0 };
        for i in 0..flow.swarm.load.len() {
            flow.swarm.load[i] = flow.law.enthalpy(degc(flow.swarm.cloud.x[i]));
        }
        let whole = |flow: &Flow| flow.swarm.load.iter().sum::<f64>();
        let before = whole(&flow);
        let time = 800.0;
        flow_for(&mut flow, &land, time);
        assert!((whole(&flow) / before - 1.0).abs() < 1e-10);
        let (mut off, mut size) = (0.0, 0.0);
        for i in 0..flow.swarm.load.len() {
            let (x, y, z) = (flow.swarm.cloud.x[i], flow.swarm.cloud.y[i], flow.swarm.cloud.z[i]);
            if (y - 23.5).abs() < 0.1 && (z - 13.5).abs() < 0.1 {
                let want = 900.0 - 200.0 * libm::erf((f64::from(x) - 30.0) / (2.0 * (1e-2 * time).sqrt()));
                off += (flow.temperature(i) - want).powi(2);
                size += (want - 900.0).powi(2);
            }
        }
        assert!((off / size).sqrt() < 0.03, "{smoothing}: {}", (off / size).sqrt());
    }
}

#[test]
fn a_ball_in_space_radiates_and_another_in_air_cools_by_newtons_law() {
    let params = LavaParams {
        spacing_m: 1.0,
        ambient_degc: -273.15,
        latent_heat_j_per_kg: 0.0,
        crust_factor: 1.0,
        lose_to_air: false,
        ..LavaParams::default()
    };
    let grid = Grid::new(8, 8, 8.0, Edges::Open);
    let law = Law::new(&params, &grid);
    let at = Surfaces { free: 3.0, ground: 0.0 };
    let (mut heat, mut lost, dt) = (law.enthalpy(1150.0), Lost::default(), 20.0);
    for _ in 0..5000 {
        heat = law.cooled_by(heat, at, false, dt, &mut lost);
    }
    // T = (T₀⁻³ + 3·C·t)^(−1/3), C = ε·σ·A/(m·c).
    let c = 0.95 * 5.670_374e-8 * 3.0 / (2600.0 * 1150.0);
    let want = libm::pow(libm::pow(1423.15, -3.0) + 3.0 * c * 5000.0 * dt, -1.0 / 3.0);
    let kelvin = law.degc(heat) + 273.15;
    assert!((kelvin / want - 1.0).abs() < 1e-3, "{kelvin} {want}");
    assert!((lost.sky / ((law.enthalpy(1150.0) - heat) * 2600.0) - 1.0).abs() < 1e-9);

    let air = LavaParams { lose_to_air: true, radiate: false, ambient_degc: 20.0, ..params };
    let law = Law::new(&air, &grid);
    // In steps of any length.
    for steps in [1, 7, 1000] {
        let mut heat = law.enthalpy(1150.0);
        for _ in 0..steps {
            heat = law.cooled_by(heat, at, false, 5000.0 / f64::from(steps), &mut lost);
        }
        let want = 20.0 + 1130.0 * libm::exp(-50.0 * 3.0 * 5000.0 / (2600.0 * 1150.0));
        assert!((law.degc(heat) - want).abs() < 1e-6, "{steps}");
    }
}

#[test]
fn surfaces_add_up_to_the_slabs_own() {
    let grid = Grid::new(12, 12, 12.0, Edges::Wrap);
    let params = LavaParams {
        spacing_m: 0.5,
        pressure: false,
        gravity: false,
        viscosity: Viscosity::Off,
        ..LavaParams::default()
    };
    for layers in [1, 2, 6] {
        let mut flow = Flow::new(Law::new(&params, &grid), grid);
        let land = Land::new(&world(grid, |_, _| 0.0));
        fill(&mut flow, [0.0; 3], [24, 24, layers], 0.0);
        // What a second takes of lava that is as hot afterwards as before: fluxes.
        flow.law.params.cooling_factor = 1e-6;
        flow.law.params.radiate = false;
        flow.law.params.crust_factor = 1.0;
        flow_for(&mut flow, &land, 1.0);
        let flux = |gone: f64, per: f64| gone / (1e-6 * per * 1130.0 * 144.0);
        let (ground, air) = (flux(flow.lost.ground, 100.0), flux(flow.lost.air, 50.0));
        assert!((ground - 1.0).abs() < 0.02, "{layers}: ground {ground}");
        // A single layer under it is not what half a space would be.
        assert!((air - 1.0).abs() < 0.12, "{layers}: air {air}");
    }
    let lone = crate::sph::WendlandC2::shape(0.0);
    assert!(lone > 0.0);
    let mut flow = Flow::new(Law::new(&params, &grid), grid);
    flow.add([6.0, 6.0, 5.0], [0.0; 3], 1150.0, 0);
    flow.law.params.cooling_factor = 1e-6;
    flow.law.params.radiate = false;
    flow.law.params.crust_factor = 1.0;
    flow_for(&mut flow, &Land::new(&world(grid, |_, _| 0.0)), 1.0);
    let ball = flow.lost.air / (1e-6 * 50.0 * 1130.0);
    assert!((ball / (std::f64::consts::PI * 0.25) - 1.0).abs() < 1e-3, "{ball}");
}

#[test]
fn every_path_of_heat_can_be_switched_off() {
    let off = LavaParams {
        lose_to_air: false,
        lose_to_ground: false,
        radiate: false,
        conduct: false,
        cooling_factor: 1e4,
        ..LavaParams::default()
    };
    let grid = Grid::new(12, 12, 12.0, Edges::Closed);
    let on = |change: &dyn Fn(&mut LavaParams)| {
        let mut params = LavaParams { spacing_m: 0.5, ..off.clone() };
        change(&mut params);
        let mut flow = Flow::new(Law::new(&params, &grid), grid);
        let land = Land::new(&world(grid, |_, _| 0.0));
        fill(&mut flow, [4.0, 4.0, 0.0], [6, 6, 6], 0.05);
        flow.swarm.load[100] = flow.law.enthalpy(1050.0);
        flow_for(&mut flow, &land, 0.2);
        let Lost { ground, air, sky, sea } = flow.lost;
        let still = flow.swarm.load.iter().filter(|&&heat| heat == flow.law.enthalpy(1150.0)).count();
        ([ground, air, sky, sea].map(|lost| lost > 0.0), still)
    };
    assert_eq!(on(&|_| ()), ([false; 4], 215));
    assert_eq!(on(&|p| p.lose_to_ground = true).0, [true, false, false, false]);
    assert_eq!(on(&|p| p.lose_to_air = true).0, [false, true, false, false]);
    assert_eq!(on(&|p| p.radiate = true).0, [false, false, true, false]);
    let (lost, still) = on(&|p| p.conduct = true);
    assert!(lost == [false; 4] && still < 200, "{still}");
    // The document's own: the same switches.
    let document = |change: &dyn Fn(&mut LavaParams)| {
        on(&|p| {
            (p.cooling, p.cooling_factor) = (super::super::Cooling::Document, 1.0);
            change(p);
        })
    };
    assert_eq!(document(&|p| p.lose_to_ground = true).0, [true, false, false, false]);
    assert_eq!(document(&|p| p.lose_to_air = true).0, [false, true, false, false]);
}
