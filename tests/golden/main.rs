//! Pictures of a small made-up world, compared byte for byte with those kept beside this file.
//!
//! The CPU pictures are deterministic, so there is no tolerance. `UPDATE_GOLDEN=1 cargo test --release --test golden`
//! renews them on purpose; look at them before committing. `cargo test --release --test golden -- --ignored` draws the
//! same world large, for the eye.

mod sample;

use std::path::Path;

use image::RgbImage;
use upthrust::{
    export,
    relief::{self, Options, View},
    world::{Layer, World},
};

/// Kept small: a picture in the repository.
const MOST_BYTES: u64 = 32_000;

fn check(name: &str, picture: &RgbImage) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name).with_extension("png");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        export::write_picture(picture, &path).unwrap();
    }
    assert!(std::fs::metadata(&path).unwrap().len() < MOST_BYTES, "{name} is too large to keep");
    let golden = image::open(&path).unwrap().into_rgb8();
    assert_eq!(golden.dimensions(), picture.dimensions(), "{name}: size");
    let apart = golden.pixels().zip(picture.pixels()).filter(|(a, b)| a != b).count();
    if apart > 0 {
        let seen = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).with_extension("png");
        export::write_picture(picture, &seen).unwrap();
        panic!("{name}: {apart} pixels differ; now: {}", seen.display());
    }
}

fn draw(world: &World, view: View, options: &Options) -> RgbImage {
    relief::map(world, &view, options).unwrap()
}

#[test]
fn bare_relief() {
    check("relief", &draw(&sample::world(96, 96), View::Relief, &Options::bare(96)));
}

#[test]
fn a_larger_world_is_averaged_to_nearly_the_same_picture() {
    let small = draw(&sample::world(96, 96), View::Relief, &Options::bare(96));
    let large = draw(&sample::world(384, 384), View::Relief, &Options::bare(96));
    let apart: u64 = small.iter().zip(large.iter()).map(|(a, b)| a.abs_diff(*b) as u64).sum();
    let mean = apart as f64 / small.len() as f64;
    assert!(mean < 14.0, "{mean} of 255 on average");
}

#[test]
fn furnished_map_with_plates() {
    let options = Options { overlay: true, min_px: 128, title: Some("Sample".into()), ..Options::default() };
    check("furnished", &draw(&sample::world(64, 40), View::Relief, &options));
}

#[test]
fn layers_by_their_palettes() {
    let world = sample::world(96, 96);
    for layer in [Layer::PlateId, Layer::CrustAge, Layer::BoundaryKind] {
        check(layer.name(), &draw(&world, View::Layer(layer), &Options::bare(96)));
    }
}

#[test]
fn a_film_can_fix_its_light() {
    let world = sample::world(96, 96);
    let bare = Options::bare(96);
    let fixed = Options { exaggeration: Some(relief::exaggeration(&world, &bare)), ..bare.clone() };
    assert_eq!(draw(&world, View::Relief, &fixed), draw(&world, View::Relief, &bare));
}

#[test]
fn same_picture_for_any_number_of_threads() {
    let world = sample::world(200, 130);
    let options = Options { overlay: true, ..Options::default() };
    let pictures = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw(&world, View::Relief, &options))
    });
    assert!(pictures.iter().all(|picture| *picture == pictures[0]));
}

#[test]
fn odd_worlds_have_pictures_and_bad_ones_one_line() {
    use upthrust::grid::{Edges, Grid};
    for (w, h) in [(1, 1), (1, 700), (300, 2), (3, 5)] {
        let mut world = World::new(Grid::new(w, h, 1000.0, Edges::Open), 0.0);
        for view in [View::Relief, View::Layer(Layer::Slope)] {
            draw(&world, view, &Options { overlay: true, title: Some("x".repeat(300)), ..Options::default() });
        }
        let absent = relief::map(&world, &View::Layer(Layer::Hardness), &Options::default()).unwrap_err();
        assert_eq!(absent.to_string(), "this world has no layer 'hardness' (it has height, slope)");
        world.layer_mut(Layer::Bedrock).data[0] = f32::INFINITY;
        let bad = relief::map(&world, &View::Relief, &Options::default()).unwrap_err();
        assert_eq!(bad.to_string(), "layer 'height' is not finite at cell (0, 0)");
    }
}
