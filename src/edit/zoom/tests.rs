//! A window against the map it was cut from.

use std::sync::atomic::AtomicBool;

use super::*;
use crate::{
    flow::{Drainage, outlets},
    noise::{Fbm, Key},
};

const KM: f64 = 1e3;

/// Rough ground that falls to the west into the sea.
fn land(cells: usize) -> World {
    let grid = Grid::new(cells, cells, 200.0 * KM, Edges::Open);
    let mut world = World::new(grid, 0.0);
    let fbm = Fbm::new(60.0 * KM, 0.7).octaves(Key::new(5), grid.cell_m);
    let height = Field::from_fn(grid, |x, y| {
        let at_m = grid.center_m(x, y);
        (0.006 * (at_m[0] - 20.0 * KM) + 250.0 * fbm.value(at_m)) as f32
    });
    world.set_layer(Layer::Bedrock, height);
    world.set_layer(Layer::Uplift, Field::from_fn(grid, |x, _| x as f32 / cells as f32));
    world
}

fn zoomed(world: &World, params: ZoomParams) -> Result<World, ProcessError> {
    let stay = AtomicBool::new(false);
    let mut world = world.clone();
    let mut process = params.process(Placement::default())?;
    world.ledger.open("zoom#1", Matter::Rock, world.rock_m3());
    process.fit(&world.grid)?;
    let after = process.grid_after(&world.grid);
    process.step(&mut world, &Context::new(9, "zoom#1", &stay))?;
    assert_eq!(world.grid, after);
    world.ledger.close("zoom#1", Matter::Rock, world.rock_m3());
    Ok(world)
}

fn at(window_km: &[f64]) -> ZoomParams {
    ZoomParams { window_km: Some(window_km.to_vec()), ..Default::default() }
}

#[test]
fn a_window_matches_its_map() {
    let parent = land(200);
    let world = zoomed(&parent, at(&[80.0, 50.0, 40.0])).unwrap();
    assert_eq!((world.grid.width, world.grid.cell_m), (200, 200.0));
    let (old, new) = (parent.height(), world.height());
    // Means of five by five new cells are an old one.
    let (mut sums, mut n) = ([0.0f64; 5], 0.0);
    for y in 0..40 {
        for x in 0..40 {
            let block = (0..25).map(|i| new.at(5 * x + i % 5, 5 * y + i / 5) as f64).sum::<f64>() / 25.0;
            let was = old.at(80 + x, 50 + y) as f64;
            sums =
                [sums[0] + block, sums[1] + was, sums[2] + block * was, sums[3] + block * block, sums[4] + was * was];
            n += 1.0;
        }
    }
    let cov = sums[2] - sums[0] * sums[1] / n;
    let correlation = cov / ((sums[3] - sums[0] * sums[0] / n) * (sums[4] - sums[1] * sums[1] / n)).sqrt();
    assert!(correlation > 0.9999, "{correlation}");
    let account = world.ledger.account("zoom#1", Matter::Rock).unwrap();
    assert!(account.residual_share() < 1e-6 && account.left_m3 > 0.0, "{account:?}");
    // What finer sampling changed is far less than what went with the rest of the map.
    assert!((account.start_m3 - account.left_m3 - account.end_m3).abs() < 1e-3 * account.end_m3, "{account:?}");
    let uplift = world.layer(Layer::Uplift).unwrap();
    assert!((uplift.at(100, 0) - 0.5).abs() < 0.01);
}

#[test]
fn the_same_ground_at_every_size_and_from_any_window() {
    let parent = land(200);
    let [coarse, fine] = [64, 256]
        .map(|size| zoomed(&parent, ZoomParams { size: Some(size), ..at(&[80.0, 50.0, 40.0]) }).unwrap().height());
    let block = |x: usize, y: usize| (0..16).map(|i| fine.at(4 * x + i % 4, 4 * y + i / 4)).sum::<f32>() / 16.0;
    let off: f64 = (0..64 * 64).map(|i| (block(i % 64, i / 64) - coarse.data[i]).powi(2) as f64).sum::<f64>() / 4096.0;
    let range = coarse.range().unwrap();
    assert!(off.sqrt() < 0.01 * (range.1 - range.0) as f64, "{}", off.sqrt());
    // Two windows that share cells have the same ground where they do.
    let [one, other] =
        [80.0, 90.0].map(|x| zoomed(&parent, ZoomParams { size: Some(160), ..at(&[x, 50.0, 40.0]) }).unwrap().height());
    let apart = (0..60).map(|i| (one.at(40 + 40 + i, 80) - other.at(40 + i, 80)).abs()).fold(0.0, f32::max);
    assert!(apart < 1.0, "{apart}");
}

#[test]
fn what_comes_in_is_what_the_map_gathers_outside() {
    let mut parent = land(200);
    parent.set_layer(Layer::Rain, Field::from_fn(parent.grid, |x, y| (500 + (x * 7 + y * 3) % 1000) as f32));
    let world = zoomed(&parent, at(&[80.0, 50.0, 40.0])).unwrap();
    let inflows = world.inflows();
    assert!(!inflows.is_empty());
    for inflow in &inflows {
        let (x, y) = world.grid.cell_of(inflow.cell);
        assert!(x == 0 || y == 0 || x == 199 || y == 199, "{x} {y}");
    }
    // By hand: every cell outside that drains straight into the window hands over all it gathered.
    let height = parent.height();
    let z: Vec<f64> = height.data.iter().map(|&z| z as f64).collect();
    let drainage = Drainage::of(parent.grid, &z, &outlets(&height, 0.0));
    let inside = |i: usize| (80..120).contains(&(i % 200)) && (50..90).contains(&(i / 200));
    let crossing = |sum: &[f64]| -> f64 {
        (0..40_000)
            .filter(|&i| !drainage.is_outlet(i) && !inside(i) && inside(drainage.receiver[i] as usize))
            .map(|i| sum[i])
            .sum()
    };
    let area: f64 = inflows.iter().map(|inflow| inflow.area_m2).sum();
    let want = crossing(&drainage.area_m2());
    assert!((area / want - 1.0).abs() < 1e-12, "{area} {want}");
    let rain = parent.layer(Layer::Rain).unwrap().data.iter().map(|&mm| mm as f64 * 1e3 / (365.25 * 86_400.0));
    let want = crossing(&drainage.accumulate(&rain.collect::<Vec<_>>()));
    let discharge: f64 = inflows.iter().map(|inflow| inflow.discharge_m3_s).sum();
    assert!((discharge / want - 1.0).abs() < 1e-12, "{discharge} {want}");
    // The largest river comes in at a low place, where its bed was.
    let largest = inflows.iter().max_by(|a, b| a.area_m2.total_cmp(&b.area_m2)).unwrap();
    assert!((world.height().data[largest.cell] as f64 - largest.z_m).abs() < 150.0);
}

#[test]
fn a_window_of_a_window_keeps_its_place_and_its_rivers() {
    let parent = land(200);
    let first = zoomed(&parent, at(&[80.0, 50.0, 40.0])).unwrap();
    // The whole of it again: what came in comes in.
    let whole = zoomed(&first, at(&[0.0, 0.0, 40.0])).unwrap();
    let sum = |world: &World| world.inflows().iter().map(|inflow| inflow.area_m2).sum::<f64>();
    assert!((sum(&whole) / sum(&first) - 1.0).abs() < 1e-12);
    let second = zoomed(&first, at(&[10.0, 20.0, 8.0])).unwrap();
    let windows = second.table("windows").unwrap();
    assert_eq!(windows.numbers("first_x_km").unwrap(), [80.0, 90.0]);
    assert_eq!(windows.numbers("first_y_km").unwrap(), [50.0, 70.0]);
    assert_eq!(windows.numbers("width_km").unwrap(), [40.0, 8.0]);
}

#[test]
fn windows_are_found() {
    let parent = land(100);
    let place = |around| {
        let world = zoomed(&parent, ZoomParams { around, size_km: Some(20.0), ..Default::default() }).unwrap();
        let windows = world.table("windows").unwrap();
        [windows.numbers("first_x_km").unwrap()[0], windows.numbers("first_y_km").unwrap()[0]]
    };
    assert_eq!(place(Around::Middle), [90.0, 90.0]);
    let [x, y] = place(Around::Summit);
    let height = parent.height();
    let top = (0..10_000).reduce(|a, b| if height.data[b] > height.data[a] { b } else { a }).unwrap();
    let [px, py] = parent.grid.center_m(top % 100, top / 100).map(|m| m / KM);
    assert!((x..=x + 20.0).contains(&px) && (y..=y + 20.0).contains(&py));
    let [x, _] = place(Around::River);
    assert!((0.0..=180.0).contains(&x));
}

#[test]
fn windows_that_cannot_be_are_refused_in_a_line() {
    let parent = land(50);
    let refused = |params: ZoomParams| match zoomed(&parent, params) {
        Err(ProcessError::Unfit(line)) => line,
        other => panic!("{other:?}"),
    };
    let line = refused(at(&[180.0, 50.0, 40.0]));
    let want = "the window (40 x 40 km from 180, 50) reaches off the map, which is 200 x 200 km; \
                move it or make it smaller (window_km, size_km)";
    assert_eq!(line, want);
    assert!(refused(at(&[10.0, 10.0, 3.0])).contains("the window is 3 km wide, but the map's cells are 4 km"));
    assert!(refused(at(&[10.0, 10.0, 0.0])).contains("the window is 0 km wide"));
    let coarse = ZoomParams { size: Some(16), ..at(&[0.0, 0.0, 200.0]) };
    assert!(refused(coarse).contains("coarser than the map's"));
    assert!(refused(at(&[0.0, 0.0, 200.0, 20.0])).contains("50 x 5 cells"));
}
