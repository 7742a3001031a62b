//! What pictures of water must show, on the adapter.

use glam::DVec3;
use image::RgbImage;

use super::{Camera, Moment, Renderer, hillshade::tests::adapter};
use crate::{
    grid::{Edges, Field, Grid},
    scene::{Quality, SceneParams, Surround},
    world::{Layer, Table, World},
};

const SIZE: [u32; 2] = [160, 90];

fn world(height: impl Fn(usize, usize) -> f32 + Sync) -> World {
    let grid = Grid::new(64, 64, 6400.0, Edges::Open);
    let mut world = World::new(grid, 0.0);
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, height));
    world
}

/// No haze, no foam, no glow: water and sky alone.
fn plain() -> SceneParams {
    let mut scene = SceneParams { surround: Surround::Sea, ..SceneParams::default() };
    scene.fog.on = false;
    scene.bloom.on = false;
    scene.sky.glare = false;
    scene.water.waves = 0.0;
    scene.water.foam = 0.0;
    scene.sun.azimuth_deg = Some(200.0);
    scene.sun.altitude_deg = Some(35.0);
    scene
}

fn from_above(distance_m: f64) -> Camera {
    Camera { target: DVec3::ZERO, from_deg: 180.0, down_deg: 90.0, distance_m, view_deg: 40.0 }
}

fn picture(renderer: &mut Renderer, world: &World, scene: &SceneParams, camera: &Camera) -> RgbImage {
    let mut land = renderer.land(world, scene).unwrap();
    let moment = Moment { size: SIZE, share: 0.0, seconds: 0.0, quality: Quality::Normal };
    renderer.picture(&mut land, scene, camera, &moment).unwrap()
}

/// Mean red, green, blue of a rectangle, 0 to 255.
fn mean(image: &RgbImage, x: std::ops::Range<u32>, y: std::ops::Range<u32>) -> [f64; 3] {
    let count = f64::from((x.end - x.start) * (y.end - y.start));
    let pixels = x.flat_map(|x| y.clone().map(move |y| (x, y)));
    let sum = pixels.fold([0.0; 3], |sum: [f64; 3], (x, y)| {
        let p = image.get_pixel(x, y).0;
        [0, 1, 2].map(|c: usize| sum[c] + f64::from(p[c]))
    });
    sum.map(|v| v / count)
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn calm_water_mirrors_the_sky_the_more_the_lower_it_is_seen() {
    let Some(gpu) = adapter() else { return };
    let (mut renderer, world, scene) = (Renderer::new(gpu).unwrap(), world(|_, _| -500.0), plain());
    // The eye looks along the water: the horizon is the picture's middle, 0.22 degrees a pixel.
    let level = Camera {
        target: DVec3::new(0.0, 0.0, 60.0),
        from_deg: 300.0,
        down_deg: 0.0,
        distance_m: 900.0,
        view_deg: 20.0,
    };
    let image = picture(&mut renderer, &world, &scene, &level);
    let (above, below) = (mean(&image, 60..100, 38..42), mean(&image, 60..100, 48..52));
    // From 0.7 to 1.6 degrees over and under the horizon; there Fresnel's share is 0.87 to 0.94.
    assert!(apart(above, below) < 0.13 * 255.0, "sky {above:?}, water {below:?}");
    assert!((0..3).all(|c| below[c] <= above[c] + 2.0), "sky {above:?}, water {below:?}");
    let deep = mean(&picture(&mut renderer, &world, &scene, &from_above(500.0)), 60..100, 30..60);
    assert!(apart(deep, above) > 60.0 && deep[0] < 0.5 * below[0], "sky {above:?}, deep {deep:?}");
    // Water that is seen from above is blue.
    assert!(deep[2] > deep[1] && deep[1] > deep[0], "{deep:?}");
}

#[test]
fn deeper_water_is_darker() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    // From 1 m in the west to 64 m in the east.
    let world = world(|x, _| -1.0 - x as f32);
    let image = picture(&mut renderer, &world, &plain(), &from_above(4000.0));
    // As light, of which the picture's bytes are about the root.
    let light = |byte: f64| libm::pow(byte / 255.0, 2.2);
    let green: Vec<f64> = (0..5).map(|k| light(mean(&image, 20 + 24 * k..44 + 24 * k, 20..70)[1])).collect();
    assert!(green.windows(2).all(|pair| pair[1] < pair[0]), "{green:?}");
    assert!(green[4] < 0.6 * green[0], "{green:?}");
}

#[test]
fn a_lake_lies_on_the_land_and_can_be_left_out() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    // A bowl 900 m over the sea, filled to 40 m under its rim.
    let bowl = |x: usize, y: usize| 900.0 + 0.1 * (x as f32 - 31.5).hypot(y as f32 - 31.5).powi(2);
    let mut world = world(bowl);
    world.set_layer(Layer::LakeDepth, Field::from_fn(world.grid, |x, y| (940.0 - bowl(x, y)).max(0.0)));
    let camera = Camera { target: DVec3::new(0.0, 0.0, 940.0), ..from_above(5000.0) };
    let wet = picture(&mut renderer, &world, &plain(), &camera);
    let mut without = plain();
    without.water.inland = false;
    let dry = picture(&mut renderer, &world, &without, &camera);
    // The shore is 20 cells, 2 km, from the middle: 50 pixels.
    let (middle, shore) = (mean(&wet, 70..90, 40..50), mean(&wet, 10..20, 40..50));
    assert!(middle[2] > middle[0] && shore[2] < shore[1], "lake {middle:?}, land {shore:?}");
    assert!(apart(middle, mean(&dry, 70..90, 40..50)) > 25.0);
    assert_eq!(shore, mean(&dry, 10..20, 40..50));
    for (x, lake) in [(80 - 46, true), (80 - 54, false), (80 + 45, true), (80 + 53, false)] {
        let moved = apart(mean(&wet, x..x + 1, 43..47), mean(&dry, x..x + 1, 43..47));
        assert_eq!(moved > 3.0, lake, "column {x}: {moved}");
    }
}

#[test]
fn a_river_shows_where_its_table_has_it() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    let mut world = world(|_, _| 300.0);
    let camera = Camera { target: DVec3::new(0.0, 0.0, 300.0), ..from_above(5000.0) };
    let dry = picture(&mut renderer, &world, &plain(), &camera);
    // 150 m wide, from west to east through the middle: 3.7 pixels.
    world.set_table(
        Table::new("rivers")
            .number("river", "1", vec![1.0, 1.0])
            .number("x_km", "km", vec![0.2, 6.2])
            .number("y_km", "km", vec![3.2, 3.2])
            .number("width_m", "m", vec![150.0, 150.0]),
    );
    let wet = picture(&mut renderer, &world, &plain(), &camera);
    let moved = |y: u32| apart(mean(&wet, 30..130, y..y + 1), mean(&dry, 30..130, y..y + 1));
    assert!(moved(44) > 15.0 && moved(45) > 15.0, "{} {}", moved(44), moved(45));
    assert!(moved(39) == 0.0 && moved(51) == 0.0, "{} {}", moved(39), moved(51));
}

#[test]
fn still_water_mirrors_the_land_where_it_is_told_to() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    // A ridge 400 m high along the north of the map; the eye looks at it over the water.
    let world = world(|_, y| if (8..16).contains(&y) { 400.0 } else { -300.0 });
    let camera = Camera {
        target: DVec3::new(0.0, 500.0, 20.0),
        from_deg: 180.0,
        down_deg: 2.0,
        distance_m: 1500.0,
        view_deg: 30.0,
    };
    let mut land = renderer.land(&world, &plain()).unwrap();
    let mut take = |reflections| {
        let mut scene = plain();
        scene.water.reflections = reflections;
        let moment = Moment { size: SIZE, share: 0.0, seconds: 0.0, quality: Quality::Full };
        renderer.picture(&mut land, &scene, &camera, &moment).unwrap()
    };
    let (with, without) = (take(true), take(false));
    // The horizon is 6 pixels over the middle; the ridge stands over it, its image lies under it.
    let (ridge, image, sky) =
        (mean(&with, 60..100, 30..34), mean(&with, 60..100, 48..54), mean(&without, 60..100, 48..54));
    assert!(apart(image, sky) > 15.0, "image {image:?}, sky {sky:?}");
    assert!(apart(image, ridge) < apart(sky, ridge), "image {image:?}, sky {sky:?}, ridge {ridge:?}");
    // What is no water is the same in both.
    assert_eq!(ridge, mean(&without, 60..100, 30..34));
}
