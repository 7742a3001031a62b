//! What pictures of lava and smoke must show, whatever the adapter.

use glam::DVec3;
use image::RgbImage;

use super::{Camera, Gpu, Lump, Moment, Renderer};
use crate::{
    grid::{Edges, Field, Grid},
    scene::{Quality, SceneParams},
    world::{Layer, Plume, World},
};

const SIZE: [u32; 2] = [160, 90];
const YEAR_S: f64 = 365.25 * 86_400.0;

/// An adapter, or nothing and a line about it where one may be missing.
fn renderer() -> Option<Renderer> {
    match Gpu::open() {
        Ok(gpu) => Some(Renderer::new(gpu).unwrap()),
        Err(error) if std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// A plain of 640 m with a hill; lava runs over its middle if asked for.
fn world(molten: bool) -> World {
    let grid = Grid::new(64, 64, 640.0, Edges::Open);
    let mut world = World::new(grid, -100.0);
    let away = |x: usize, y: usize| libm::hypot(x as f64 - 31.5, y as f64 - 31.5);
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| (60.0 - 2.0 * away(x, y)).max(0.0) as f32));
    if molten {
        let inside = |x: usize, y: usize| away(x, y) < 7.0;
        world.set_layer(Layer::MoltenLava, Field::from_fn(grid, |x, y| if inside(x, y) { 2.0 } else { 0.0 }));
        let hot = |x: usize, y: usize| if inside(x, y) { 1150.0 } else { 0.0 };
        world.set_layer(Layer::MoltenTemperature, Field::from_fn(grid, hot));
    }
    world
}

fn night() -> SceneParams {
    let mut scene = SceneParams::default();
    scene.sun.time_of_day_h = 23.0;
    scene
}

fn shot(renderer: &mut Renderer, world: &World, scene: &SceneParams, lumps: Option<Vec<Lump>>) -> RgbImage {
    let mut land = renderer.land(world, scene).unwrap();
    land.set_lumps(lumps);
    let target = DVec3::new(0.0, 0.0, 40.0);
    let camera = Camera { target, from_deg: 200.0, down_deg: 35.0, distance_m: 700.0, view_deg: 40.0 };
    let moment = Moment { size: SIZE, share: 0.0, seconds: 1.0, quality: Quality::Normal };
    renderer.picture(&mut land, scene, &camera, &moment).unwrap()
}

fn bright(pixel: &image::Rgb<u8>) -> f64 {
    0.2126 * f64::from(pixel[0]) + 0.7152 * f64::from(pixel[1]) + 0.0722 * f64::from(pixel[2])
}

/// Mean of a square of pixels around a place.
fn mean(image: &RgbImage, at: [u32; 2]) -> [f64; 3] {
    let around = (0..25).map(|k| image.get_pixel(at[0] + k % 5 - 2, at[1] + k / 5 - 2));
    around.fold([0.0; 3], |sum, p| [0, 1, 2].map(|c: usize| sum[c] + f64::from(p[c]) / 25.0))
}

const MIDDLE: [u32; 2] = [80, 45];

#[test]
fn lava_is_the_brightest_thing_at_night_and_lights_the_land_around() {
    let Some(mut renderer) = renderer() else { return };
    let (with, without) =
        (shot(&mut renderer, &world(true), &night(), None), shot(&mut renderer, &world(false), &night(), None));
    let brightest = |image: &RgbImage| {
        image.enumerate_pixels().max_by(|a, b| bright(a.2).total_cmp(&bright(b.2))).map(|(x, y, p)| (x, y, *p)).unwrap()
    };
    let (x, y, most) = brightest(&with);
    assert!(x.abs_diff(MIDDLE[0]) < 25 && y.abs_diff(MIDDLE[1]) < 18, "{x} {y}");
    assert!(most[0] > 180 && most[0] > most[1] && most[1] > most[2], "{most:?}");
    assert!(bright(&most) > 2.0 * bright(&brightest(&without).2), "{most:?}");
    // The slope below it is lit, warmer than it is; the far corner of the sky is not.
    let below = [80, 68];
    let ([r, _, b], [r0, _, b0]) = (mean(&with, below), mean(&without, below));
    assert!(r > r0 + 8.0 && r - r0 > 2.0 * (b - b0), "{r} {r0} {b} {b0}");
    let sky = |image: &RgbImage| mean(image, [4, 4])[0];
    assert!((sky(&with) - sky(&without)).abs() < 3.0);
}

#[test]
fn lava_has_the_colours_it_is_told() {
    let Some(mut renderer) = renderer() else { return };
    let mut scene = night();
    scene.lava.black_body = false;
    scene.lava.crust = 0.0;
    scene.lava.colours = ["#000000", "#0000ff", "#0000ff"].map(String::from);
    let [r, g, b] = mean(&shot(&mut renderer, &world(true), &scene, None), MIDDLE);
    assert!(b > 100.0 && b > 2.0 * r && b > 2.0 * g, "{r} {g} {b}");
    scene.lava.on = false;
    let [r, _, b] = mean(&shot(&mut renderer, &world(true), &scene, None), MIDDLE);
    assert!(b < r + 20.0 && b < 80.0, "{r} {b}");
}

#[test]
fn particles_are_drawn_where_they_are_as_one_surface_and_as_lumps() {
    let Some(mut renderer) = renderer() else { return };
    let row = |degc: f64| -> Vec<Lump> {
        let lump = |k: i32| Lump {
            at_m: [280.0 + 2.0 * f64::from(k % 40), 290.0 + 2.0 * f64::from(k / 40), 62.0],
            radius_m: 1.5,
            temperature_degc: degc,
        };
        (0..1200).map(lump).collect()
    };
    for spheres in [false, true] {
        let mut scene = night();
        scene.lava.spheres = spheres;
        let mut red = |lumps| mean(&shot(&mut renderer, &world(false), &scene, lumps), MIDDLE)[0];
        let (hot, cold, none) = (red(Some(row(1150.0))), red(Some(row(400.0))), red(None));
        assert!(hot > 120.0 && hot > 2.0 * cold && hot > 2.0 * none, "{spheres}: {hot} {cold} {none}");
    }
    // They stand for the map's own melt: without any of them there is none.
    let none = mean(&shot(&mut renderer, &world(true), &night(), Some(Vec::new())), MIDDLE);
    assert!(none[0] < 80.0, "{none:?}");
}

#[test]
fn smoke_hides_what_is_behind_it_and_glows_over_lava_at_night() {
    let Some(mut renderer) = renderer() else { return };
    let smoking = |molten: bool| {
        let mut world = world(molten);
        world.add_plumes(&[Plume {
            at_m: [320.0, 320.0, 60.0],
            along_m: [0.0; 2],
            radius_m: 15.0,
            begin_yr: 0.0,
            end_yr: 1.0,
            puffs_per_s: 3.0,
            rise_m_per_s: 10.0,
            slows_s: 15.0,
            swell: 0.2,
            wind_m_per_s: [0.0; 2],
            wind_at_m: 100.0,
            lasts_s: 40.0,
            seed: 3.0,
        }]);
        world.time_yr = 60.0 / YEAR_S;
        world
    };
    let above = [80, 22];
    let mut noon = SceneParams::default();
    noon.sun.time_of_day_h = 12.0;
    let mut at = |world: &World, scene: &SceneParams| mean(&shot(&mut renderer, world, scene, None), above);
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f64>();
    assert!(apart(at(&smoking(false), &noon), at(&world(false), &noon)) > 40.0);
    let mut off = noon.clone();
    off.smoke.on = false;
    // Grain of half a step is all that may differ.
    assert!(apart(at(&smoking(false), &off), at(&world(false), &off)) < 1.0);
    // As light, of which the picture's bytes are about the root.
    let light = |byte: f64| libm::pow(byte / 255.0, 2.2);
    let ([lit, _, blue], [dark, ..]) =
        (at(&smoking(true), &night()).map(light), at(&smoking(false), &night()).map(light));
    assert!(lit > 2.0 * dark && lit > 1.5 * blue, "{lit} {dark} {blue}");
}
