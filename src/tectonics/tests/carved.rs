//! Ground that others carve: it drifts with its plate, and rises where it is relieved.

use std::sync::atomic::AtomicBool;

use crate::{
    crust,
    grid::{Edges, Field, Grid},
    process::{Context, Placement},
    tectonics::PlatesParams,
    world::{Layer, World},
};

/// Height that is expected after the third step of slow plates, if `wear_m` was taken off before it.
fn expected(wear_m: f32, continental_share: f64) -> Field<f32> {
    let params = PlatesParams {
        continental_share,
        duration_myr: 10.0,
        speed_mm_per_yr: 2.0,
        cells: 64,
        ..PlatesParams::default()
    };
    let mut world = World::new(Grid::new(96, 96, 1_000e3, Edges::Open), -20_000.0);
    let stay = AtomicBool::new(false);
    let context = Context::new(3, "plates#1", &stay);
    let mut plates = params.process(Placement::default(), Some(20), true);
    let mut span_yr = 0.0;
    for step in 0..3 {
        if step == 2 {
            world.layer_mut(Layer::Bedrock).data.iter_mut().for_each(|z| *z -= wear_m);
        }
        span_yr = plates.step(&mut world, &context).unwrap().elapsed_yr;
    }
    let uplift = world.layer(Layer::Uplift).unwrap();
    Field::from_fn(world.grid, |x, y| world.height().at(x, y) + uplift.at(x, y) * (span_yr * 1e-3) as f32)
}

#[test]
fn land_that_is_relieved_comes_up_by_the_ratio_of_densities() {
    let wear_m = 500.0;
    let (left, worn) = (expected(0.0, 1.0), expected(wear_m, 1.0));
    // In the middle, where the rim beyond which nothing was taken off is far away.
    let lowered: Vec<f64> = (40..56)
        .flat_map(|y| (40..56).map(move |x| (x, y)))
        .map(|(x, y)| f64::from(left.at(x, y) - worn.at(x, y)))
        .collect();
    let want = f64::from(wear_m) * (1.0 - crust::CONTINENTAL / crust::MANTLE);
    for lowered in lowered {
        // Heights are f32, and what is worn off weighs on how the plates move by a hair.
        assert!((lowered - want).abs() < 0.02, "{lowered} m instead of {want} m");
    }
}

#[test]
fn ground_that_nobody_carves_keeps_its_hills_as_it_drifts() {
    // Plates alone, and the same plates drifting under ground that another stage could carve.
    let ground = expected(0.0, 1.0);
    let (low, high) = ground.range().unwrap();
    assert!(high - low > 200.0 && high < 9_000.0 && low > -12_000.0, "{low} to {high} m");
}
