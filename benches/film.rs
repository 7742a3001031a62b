//! What a film costs besides the run: taking a shot of a world, drawing a picture, drawing and encoding it.

use std::{hint::black_box, sync::atomic::AtomicBool};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use upthrust::{
    export::video::{Encoder, Format, Rate, Settings},
    recipe::{Overrides, Plan, find_preset},
    relief::{
        View,
        film::{Animation, Options, Words},
    },
    timeline::Timeline,
    world::World,
};

static STAY: AtomicBool = AtomicBool::new(false);
/// 720p.
const SIZE: [usize; 2] = [1280, 720];

fn grown(size: &str) -> World {
    let overrides = Overrides { size: Some(size.to_owned()), ..Overrides::default() };
    let plan = Plan::new(&find_preset("collision").unwrap().source(), &overrides).unwrap();
    Timeline::new(&plan, &STAY).run(&mut [], &mut |_| ()).unwrap()
}

fn options() -> Options {
    Options {
        size: SIZE,
        view: View::Relief,
        range_m: [-8000.0, 6000.0],
        climate: false,
        smoke: false,
        title: Some("Film".to_owned()),
    }
}

/// A map that fills the picture, and a square one.
fn drawing(c: &mut Criterion) {
    let mut group = c.benchmark_group("film");
    group.sample_size(10);
    for size in ["1280x720", "1024x1024"] {
        let world = grown(size);
        let mut animation = Animation::new(world.grid, &options());
        group.bench_function(BenchmarkId::new("shot", size), |b| b.iter(|| animation.shot(&world).unwrap()));
        let to = animation.shot(&world).unwrap();
        let from = to.clone();
        let mut picture = vec![0; animation.bytes()];
        let words = Words { caption: "Plates", clock: "12.4 My" };
        group.bench_function(BenchmarkId::new("picture", size), |b| {
            b.iter(|| animation.draw([&from, &to], black_box(0.7), words, &mut picture))
        });
        let folder = tempfile::tempdir().unwrap();
        for format in [Format::Mp4, Format::AnimatedPng] {
            if format.needs_ffmpeg() && !Encoder::has_ffmpeg() {
                continue;
            }
            let rate = Rate::whole(30);
            let settings = Settings { format, size: SIZE, rate, hold_s: 0.1, ffmpeg_args: Vec::new() };
            let path = folder.path().join(if format.needs_ffmpeg() { "film.mp4" } else { "film.png" });
            group.bench_function(BenchmarkId::new(format!("150 pictures to {format:?}"), size), |b| {
                b.iter(|| {
                    let mut encoder = Encoder::open(&path, &settings).unwrap();
                    for i in 0..150 {
                        let mut picture = encoder.blank();
                        animation.draw([&from, &to], i as f32 / 149.0, words, &mut picture);
                        encoder.push(picture).unwrap();
                    }
                    encoder.finish().unwrap();
                })
            });
        }
    }
    group.finish();
}

criterion_group!(benches, drawing);
criterion_main!(benches);
