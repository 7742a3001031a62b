//! The stage: volume, threads, bad input.

use std::sync::atomic::AtomicBool;

use super::*;
use crate::{
    grid::Field,
    process::{Context, Placement, ProcessError},
    volcano::{SheetKey, VentParams},
    world::{Layer, Matter, World},
};

/// A rough slope into the sea.
fn slope(edges: Edges) -> World {
    let grid = Grid::new(64, 48, 3200.0, edges);
    let mut world = World::new(grid, 0.0);
    let height = |x: usize, y: usize| {
        let bumps = 12.0 * ((x as f32 * 0.9).sin() * (y as f32 * 0.7).cos());
        400.0 - 8.0 * x as f32 + bumps
    };
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, height));
    world.set_layer(Layer::Sediment, Field::filled(grid, 0.5));
    world
}

fn eruption() -> LavaSheetParams {
    LavaSheetParams {
        duration_h: 12.0,
        schedule: vec![
            SheetKey { start_h: 3.0, duration_h: Some(2.0), m3_per_s: 60.0 },
            SheetKey { start_h: 0.0, duration_h: Some(4.0), m3_per_s: 40.0 },
        ],
        vent: vec![VentParams { at_km: [0.6, 1.2], to_km: None, radius_m: Some(60.0), part: None }],
        ..LavaSheetParams::default()
    }
}

fn erupt(params: LavaSheetParams, mut world: World) -> Result<World, ProcessError> {
    let stay = AtomicBool::new(false);
    let context = Context::new(1, "lava", &stay);
    let mut process = params.process(Placement::default(), Some(6));
    process.fit(&world.grid)?;
    world.ledger.open("lava", Matter::Rock, world.rock_m3());
    loop {
        let step = process.step(&mut world, &context)?;
        world.time_yr += step.elapsed_yr;
        assert!(world.first_non_finite().is_none());
        if step.finished() {
            world.ledger.close("lava", Matter::Rock, world.rock_m3());
            return Ok(world);
        }
    }
}

#[test]
fn what_came_out_lies_there_or_has_left() {
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        let before = slope(edges);
        let rock = before.rock_m3();
        let world = erupt(eruption(), before).unwrap();
        let lava = world.ledger.account("lava", Matter::Lava).unwrap();
        // Keys overlap between 3 h and 4 h.
        let erupted = (2.0 * 60.0 + 4.0 * 40.0) * 3600.0;
        assert!((lava.came_in_m3 / erupted - 1.0).abs() < 1e-12, "{lava:?}");
        assert!(lava.residual_share() < 1e-12 && lava.end_m3 == 0.0, "{lava:?}");
        let booked = world.ledger.account("lava", Matter::Rock).unwrap();
        assert!(booked.residual_share() < 1e-6, "{booked:?}");
        let gained = world.rock_m3() - rock;
        let left = lava.left_m3 - gained;
        assert!(left > -1.0 && (edges == Edges::Open || left.abs() < 1.0), "{edges:?}: {left}");
        let thickest = world.layer(Layer::Lava).unwrap().range().unwrap().1;
        assert!(thickest > 1.0 && thickest < 100.0, "{thickest}");
        let date = world.layer(Layer::LavaDate).unwrap().range().unwrap().1;
        assert!(date > 0.0 && date <= 12.0 / 8766.0 * 1.0001);
        // Sediment below the lava is bedrock now.
        let buried = |i: usize| world.layer(Layer::Sediment).unwrap().data[i] == 0.0;
        let lava = world.layer(Layer::Lava).unwrap();
        assert!((0..lava.data.len()).all(|i| buried(i) == (lava.data[i] > 0.0) || lava.data[i] < 1e-4));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grid = Grid::new(160, 120, 3200.0, Edges::Open);
            let mut world = World::new(grid, 0.0);
            let height = |x: usize, y: usize| 300.0 - 2.0 * x as f32 + 6.0 * (y as f32 * 0.3).sin();
            world.set_layer(Layer::Bedrock, Field::from_fn(grid, height));
            let wide = VentParams { at_km: [0.6, 0.3], to_km: Some([0.6, 2.0]), radius_m: Some(100.0), part: None };
            erupt(LavaSheetParams { vent: vec![wide], ..eruption() }, world).unwrap()
        })
    };
    let one = on(1);
    assert!(one == on(2) && one == on(8));
}

#[test]
fn lava_builds_land_out_of_the_sea() {
    let before = slope(Edges::Open);
    let land = |world: &World| world.height().data.iter().filter(|&&z| z > 0.0).count();
    let dry = land(&before);
    let params = LavaSheetParams {
        vent: vec![VentParams { at_km: [2.3, 1.2], to_km: None, radius_m: Some(60.0), part: None }],
        ..eruption()
    };
    let world = erupt(params, before).unwrap();
    assert!(land(&world) > dry + 10, "{dry} {}", land(&world));
}

#[test]
fn the_seas_chill_builds_a_delta() {
    // A plane of 8 degrees into the sea, 300 m from the vent to the shore, and half a million m³ of lava.
    let grid = Grid::new(40, 80, 800.0, Edges::Closed);
    let shore_m = 800.0;
    let outcome = |sea_w_per_m2_k: f64| {
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |_, y| 0.14 * (shore_m - 20.0 * (y as f32 + 0.5))));
        let params = LavaSheetParams {
            duration_h: 8.0,
            schedule: vec![SheetKey { start_h: 0.0, duration_h: Some(5.0), m3_per_s: 30.0 }],
            vent: vec![VentParams { at_km: [0.4, 0.5], to_km: None, radius_m: Some(40.0), part: None }],
            sea_w_per_m2_k,
            ..LavaSheetParams::default()
        };
        let world = erupt(params, world).unwrap();
        let (height, lava) = (world.height(), world.layer(Layer::Lava).unwrap());
        let south = |i: usize| grid.center_m(grid.cell_of(i).0, grid.cell_of(i).1)[1] - f64::from(shore_m);
        let cells = || (0..grid.cells()).filter(|&i| south(i) > 0.0 && lava.data[i] > 0.5);
        let land = cells().filter(|&i| height.data[i] > 0.0).count() as f64 * grid.cell_area_m2();
        let reach_m = cells().map(south).fold(0.0, f64::max);
        let volume: f64 = cells().map(|i| f64::from(lava.data[i]) * grid.cell_area_m2()).sum();
        (land, reach_m, volume)
    };
    let (chilled, warm) = (outcome(5000.0), outcome(50.0));
    // With the chill it stays within a quarter of how far it runs without, and rises above the water; without, it runs down to the wall and lies too thin to be land.
    assert!(chilled.1 < 0.3 * warm.1, "{chilled:?} {warm:?}");
    assert!(chilled.0 > 30_000.0 && warm.0 == 0.0, "{chilled:?} {warm:?}");
    // As much lava got there: it is not that it froze on land.
    assert!((chilled.2 / warm.2 - 1.0).abs() < 0.15, "{chilled:?} {warm:?}");
}

#[test]
fn what_cannot_be_is_refused_in_a_line_and_what_is_odd_is_survived() {
    let refused = |params: LavaSheetParams| match erupt(params, slope(Edges::Open)) {
        Err(ProcessError::Unfit(text)) => text,
        other => panic!("{:?}", other.map(|_| ())),
    };
    let base = eruption;
    let key = |m3_per_s: f64| vec![SheetKey { start_h: 0.0, duration_h: None, m3_per_s }];
    assert!(refused(LavaSheetParams { temperature_degc: 900.0, ..base() }).contains("solidus"));
    assert!(refused(LavaSheetParams { liquidus_degc: 1000.0, ..base() }).contains("liquidus"));
    assert!(refused(LavaSheetParams { ambient_degc: 1010.0, ..base() }).contains("ambient"));
    let off = VentParams { at_km: [9.0, 1.0], to_km: None, radius_m: None, part: None };
    assert!(refused(LavaSheetParams { vent: vec![off], ..base() }).contains("vent 1"));
    let none = VentParams { part: Some(0.0), at_km: [0.6, 1.2], to_km: None, radius_m: None };
    assert!(refused(LavaSheetParams { vent: vec![none], ..base() }).contains("part"));
    let negative = vec![SheetKey { start_h: 0.0, duration_h: Some(-1.0), m3_per_s: 1.0 }];
    assert!(refused(LavaSheetParams { schedule: negative, ..base() }).contains("at least 0"));
    assert!(refused(LavaSheetParams { schedule: key(f64::NAN), ..base() }).contains("at least 0"));
    assert!(refused(LavaSheetParams { duration_h: 1e6, ..base() }).contains("steps"));
    let flood = refused(LavaSheetParams { schedule: key(1e6), ..base() });
    assert!(flood.contains("m deep over the whole map") && flood.contains("lower m3_per_s"), "{flood}");
    let wide = LavaSheetParams { schedule: key(1e6), duration_h: 48.0, ..base() };
    let fine = Grid::new(1024, 1024, 51_200.0, Edges::Open);
    let long = wide.clone().process(Placement::default(), None).fit(&fine).unwrap_err().to_string();
    assert!(long.contains("hours of work") && long.contains("lower m3_per_s"), "{long}");
    // The same rate is nothing special on a map of a thousand kilometres.
    wide.process(Placement::default(), None).fit(&Grid::new(512, 512, 1.024e6, Edges::Open)).unwrap();
    // Nothing comes out, for no time, on flat ground, under the sea: nothing breaks.
    for odd in [
        LavaSheetParams { schedule: key(0.0), ..base() },
        LavaSheetParams { schedule: Vec::new(), ..base() },
        LavaSheetParams { duration_h: 0.0, ..base() },
        LavaSheetParams { schedule: key(1e-9), ..base() },
        LavaSheetParams { schedule: key(2e4), duration_h: 0.5, ..base() },
        LavaSheetParams { yield_pa: 1e7, duration_h: 1.0, ..base() },
    ] {
        for flat in [None, Some(10.0f32), Some(-3000.0)] {
            let mut world = slope(Edges::Open);
            if let Some(z) = flat {
                world.set_layer(Layer::Bedrock, Field::filled(world.grid, z));
            }
            let world = erupt(odd.clone(), world).unwrap();
            let lava = world.ledger.account("lava", Matter::Lava).unwrap();
            assert!(lava.residual_m3().abs() <= 1e-9 * lava.came_in_m3, "{lava:?}");
        }
    }
}
