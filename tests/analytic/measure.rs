//! Whole worlds through the survey: bodies whose numbers follow from geometry, and noise that is the same upside down.

use upthrust::{
    grid::{Edges, Field, Grid},
    measure::{Reading, survey},
    noise::{Fbm, Key},
    world::{Layer, World},
};

const SIDE: usize = 256;

fn world(f: impl Fn([f64; 2]) -> f64 + Sync) -> World {
    let grid = Grid::new(SIDE, SIDE, SIDE as f64 * 500.0, Edges::Open);
    let mut world = World::new(grid, 0.0);
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| f(grid.center_m(x, y)) as f32));
    world
}

fn value(readings: &[Reading], name: &str) -> f64 {
    readings.iter().find(|r| r.name == name).unwrap().value.unwrap()
}

#[test]
fn a_cone_in_the_sea() {
    let (middle, radius) = (SIDE as f64 * 250.0, 55_000.0);
    let cone = world(|[x, y]| (radius - (x - middle).hypot(y - middle)) * 0.05);
    let found = survey(&cone);
    let integral = found.land.as_ref().unwrap().integral.unwrap();
    // A third of the way up; the shore cuts cells, one in 110 along the radius.
    assert!((integral - 1.0 / 3.0).abs() < 0.01, "{integral}");
    let readings = found.readings();
    assert_eq!((value(&readings, "pits"), value(&readings, "rivers_arrive")), (0.0, 1.0));
    // Every slope is the same, so the land's spread has none; a central difference rounds the summit.
    let slope = 0.05f64.atan().to_degrees();
    assert!((value(&readings, "mean_slope") - slope).abs() < 0.01 && value(&readings, "slope_spread") < 0.05);
    // 5 km across, away from the summit.
    assert!((value(&readings, "local_relief") - 250.0).abs() < 20.0);
    // Upside down it is one hollow.
    assert_eq!(value(&readings, "inversion_fill"), 1.0);
}

#[test]
fn noise_is_told_from_rivers() {
    let fbm = Fbm::new(60_000.0, 0.7).octaves(Key::new(3), 500.0);
    let readings = survey(&world(|at| 3000.0 + 300.0 * fbm.value(at))).readings();
    assert!(value(&readings, "inversion_fill").abs() < 0.3);
    assert!(value(&readings, "pits") > 20.0 && value(&readings, "rivers_arrive") < 0.9);
}
