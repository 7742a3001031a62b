//! The stage around the solver: what it shows, and what it asks of a world before it begins.

use std::sync::atomic::AtomicBool;

use super::*;
use crate::{
    erosion::stage::FamilyParams,
    grid::Field,
    process::{Context, Placement, ProcessError},
    world::{Layer, World},
};

/// A plane that falls to the east, and more gently to the south.
fn world(cell_m: f64) -> World {
    let grid = Grid { width: 48, height: 32, cell_m, edges: Edges::Open };
    let mut world = World::new(grid, -1e4);
    world.set_layer(
        Layer::Bedrock,
        Field::from_fn(grid, |x, y| 500.0 - cell_m as f32 * (0.2 * x as f32 + 0.05 * y as f32)),
    );
    world
}

#[test]
fn the_velocity_shown_is_that_of_the_greatest_speed() {
    let (stay, mut world) = (AtomicBool::new(false), world(8.0));
    let context = Context::new(1, "pipes", &stay);
    let params = PipesParams { duration_h: 0.3, morphological_factor: 1.0, ..Default::default() };
    let mut process = params.process(Placement::default(), Some(6));
    while !process.step(&mut world, &context).unwrap().finished() {}
    let [speed, east, south] = [Layer::FlowSpeed, Layer::FlowEast, Layer::FlowSouth].map(|l| world.layer(l).unwrap());
    let inner = |i: &usize| (6..42).contains(&(i % 48)) && (6..26).contains(&(i / 48));
    for i in (0..48 * 32).filter(inner) {
        let (v, e, s) = (speed.data[i], east.data[i], south.data[i]);
        // Products of single precision.
        assert!(v > 0.05 && (v - (e * e + s * s).sqrt()).abs() < 1e-5 * v, "{i}: {v} of {e} and {s}");
        assert!(e > 0.0 && s > 0.0, "{i}: water runs down the plane, {e} {s}");
    }
    // The plane falls four times as steeply to the east as to the south; rills that it cuts go their own way.
    let sum = |field: &Field<f32>| (0..48 * 32).filter(inner).map(|i| field.data[i]).sum::<f32>();
    assert!(sum(east) > sum(south), "{} {}", sum(east), sum(south));
}

#[test]
fn water_too_deep_for_anyone_to_wait_is_refused_with_the_fix() {
    let (stay, mut lake) = (AtomicBool::new(false), world(10.0));
    let grid = lake.grid;
    let context = Context::new(1, "pipes", &stay);
    let params = PipesParams { duration_h: 100.0, ..Default::default() };
    assert!(params.check(&grid).is_ok(), "{:?}", params.check(&grid));
    // Waves in 4000 m of water go 200 m/s: 11 million steps in 100 hours.
    lake.set_layer(Layer::Water, Field::filled(grid, 4000.0));
    let before = lake.clone();
    match params.clone().process(Placement::default(), None).step(&mut lake, &context) {
        Err(ProcessError::Unfit(line)) => {
            let want = "100 h of water 4000.000 m deep on cells of 10 m are 1.1e7 steps of it; lower duration_h to 8.";
            assert!(line.starts_with(want) && line.contains("raise morphological_factor"), "{line}");
        }
        other => panic!("{other:?}"),
    }
    assert!(lake == before);
    // As it says.
    let shorter = PipesParams { duration_h: 8.9, ..params };
    assert!(shorter.check_depth(&grid, 4000.0).is_ok());
}

#[test]
fn a_spring_that_fills_a_closed_map_without_end_is_refused() {
    let (stay, mut basin) = (AtomicBool::new(false), world(10.0));
    basin.grid.edges = Edges::Closed;
    basin.set_layer(Layer::Bedrock, Field::filled(basin.grid, 500.0));
    let context = Context::new(1, "pipes", &stay);
    let spring = Spring { x_km: 0.1, y_km: 0.1, radius_m: 100.0, flow_m3_per_s: 1e4 };
    let params = PipesParams { duration_h: 1000.0, springs: vec![spring], sea: false, ..Default::default() };
    let short = PipesParams { duration_h: 20.0, ..params.clone() };
    // 1e4 m3/s on 0.15 km2 are 4 km of water in 17 hours.
    assert!((short.depth_kept(&basin.grid) / (4.0 / 9.0 * 1e4 * 61_200.0 / 153_600.0) - 1.0).abs() < 1e-3);
    let wide = PipesParams { duration_h: 100.0, ..params };
    let line = match wide.clone().process(Placement::default(), None).step(&mut basin, &context) {
        Err(ProcessError::Unfit(line)) => line,
        other => panic!("{other:?}"),
    };
    assert!(line.contains("lower duration_h to"), "{line}");
    // With a sea that takes it, it runs.
    basin.layer_mut(Layer::Bedrock).data[5] = -20_000.0;
    assert!(PipesParams { sea: true, ..wide }.meets(&basin).is_ok());
}

#[test]
fn a_long_run_says_how_long() {
    let grid = Grid { width: 1024, height: 1024, cell_m: 1.0, edges: Edges::Open };
    let params = PipesParams { duration_h: 10.0, ..Default::default() };
    // 36,000 s in steps of 0.64 m over 3.13 m/s.
    let line = params.patience(&grid).unwrap();
    assert!(line.starts_with("about 176180 steps of water, some 18 min on two cores"), "{line}");
    assert_eq!(params.patience(&Grid { width: 64, height: 64, ..grid }), None);
}
