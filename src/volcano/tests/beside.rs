//! Particles and sheet side by side: the same lava down the same slope.

use std::{sync::atomic::AtomicBool, time::Instant};

use super::super::{LavaParams, LavaSheetParams, VentParams, schedule};
use crate::{
    grid::{Edges, Field, Grid},
    process::{Context, Placement, Process},
    world::{Layer, World},
};

/// Cells, m.
const CELL_M: f64 = 1.5;
/// The vent's middle and radius, m.
const VENT_M: [f64; 2] = [30.0, 20.0];
const WIDE_M: f64 = 6.0;
/// Lava counts from this depth on, m: the particles' edges are spread over a spacing.
const SEEN_M: f64 = 0.2;

/// What became of a flow.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    /// How far down from the vent it lies, m.
    run_out_m: f64,
    mean_m: f64,
    area_m2: f64,
    volume_m3: f64,
}

/// Runs a stage on a plane of 10 degrees and measures what froze.
fn flown(mut process: Box<dyn Process>) -> Outcome {
    let began = Instant::now();
    let grid = Grid::new(40, 120, 40.0 * CELL_M, Edges::Closed);
    let mut world = World::new(grid, -1e4);
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, |_, y| 40.0 - 0.1763 * CELL_M as f32 * (y as f32 + 0.5)));
    let stay = AtomicBool::new(false);
    let context = Context::new(1, "lava", &stay);
    process.fit(&world.grid).unwrap();
    while !process.step(&mut world, &context).unwrap().finished() {}
    let lava = world.layer(Layer::Lava).unwrap();
    let thick: Vec<usize> = (0..grid.cells()).filter(|&i| f64::from(lava.data[i]) > SEEN_M).collect();
    let lowest = thick.iter().map(|&i| grid.cell_of(i).1).max().unwrap();
    let area_m2 = thick.len() as f64 * grid.cell_area_m2();
    let volume_m3 = crate::grid::sum_f64(&lava.data) * grid.cell_area_m2();
    let run_out_m = (lowest + 1) as f64 * CELL_M - VENT_M[1];
    let outcome = Outcome { run_out_m, mean_m: volume_m3 / area_m2, area_m2, volume_m3 };
    eprintln!("{outcome:?} in {:.2} s", began.elapsed().as_secs_f64());
    outcome
}

#[test]
fn particles_and_sheet_run_as_far_down_a_slope() {
    // 1200 m³ in half a minute, followed for two: 10 kPa·s, a yield stress of 4 kPa, no heat. It rests where it is
    // τ/(ρ g sin α) = 0.9 m deep.
    let vent = vec![VentParams { at_km: VENT_M.map(|m| 1e-3 * m), to_km: None, radius_m: Some(WIDE_M), part: None }];
    let (viscosity_pa_s, yield_pa) = (1e4, 4e3);
    let particles = LavaParams {
        duration_min: 2.0,
        vent: vent.clone(),
        schedule: vec![schedule::Key::volume(0.0, 30.0, 40.0)],
        spacing_m: 0.75,
        viscosity_pa_s,
        viscosity_per_k: 0.0,
        yield_pa,
        yield_per_k: 0.0,
        cooling_factor: 0.0,
        ..LavaParams::default()
    };
    let hour_s = 3600.0;
    let sheet = LavaSheetParams {
        duration_h: 120.0 / hour_s,
        vent,
        schedule: vec![schedule::SheetKey { start_h: 0.0, duration_h: Some(30.0 / hour_s), m3_per_s: 40.0 }],
        viscosity_pa_s,
        viscosity_per_k: 0.0,
        yield_pa,
        yield_growth_pa: 0.0,
        emissivity: 0.0,
        air_w_per_m2_k: 0.0,
        ground_w_per_m2_k: 0.0,
        sea_w_per_m2_k: 0.0,
        ..LavaSheetParams::default()
    };
    let sheet = flown(sheet.process(Placement::default(), None));
    let particles = flown(particles.process(Placement::default(), None));
    for one in [sheet, particles] {
        assert!((one.volume_m3 / 1200.0 - 1.0).abs() < 1e-3, "{one:?}");
    }
    // A front is known to a cell, and particles as they freeze are spread over 1.2 spacings, most of another.
    assert!((particles.run_out_m - sheet.run_out_m).abs() <= 2.0 * CELL_M, "{particles:?} {sheet:?}");
    // A cell more or less around two thirds of the edge, 60 m long.
    assert!((particles.area_m2 - sheet.area_m2).abs() <= 60.0 * CELL_M, "{particles:?} {sheet:?}");
    // Both rest a little deeper than the critical depth: it is reached in endless time.
    for one in [sheet, particles] {
        assert!((0.9..1.3).contains(&one.mean_m), "{one:?}");
    }
}
