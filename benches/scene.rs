//! Pictures of a scene on the adapter that there is: each quality, and full quality without one of its parts, which tells what
//! that part costs. A land of 1024 x 1024 cells by the sea, with a lake and its river's valley.
//!
//! `cargo bench --features render --bench scene -- full` runs one group.

use criterion::{Criterion, criterion_group, criterion_main};
use upthrust::{
    grid::{Edges, Field, Grid},
    noise::{Fbm, Key},
    render::{Camera, Gpu, Land, Moment, Renderer},
    scene::{Quality, SceneParams},
    world::{Layer, World},
};

/// Hills over a sea that covers a third of the map, and a lake on a plateau.
fn world() -> World {
    let grid = Grid::new(1024, 1024, 30_000.0, Edges::Open);
    let mut world = World::new(grid, 0.0);
    let hills = Fbm::new(9000.0, 0.85).octaves(Key::new(5), grid.cell_m);
    let height = Field::from_fn(grid, |x, y| {
        let at = [x as f64 * grid.cell_m, y as f64 * grid.cell_m];
        let lake = (at[0] - 15_000.0).hypot(at[1] - 15_000.0) < 2500.0;
        if lake { 420.0 } else { (250.0 + 1400.0 * hills.value(at)) as f32 }
    });
    let lake = Field::from_fn(grid, |x, y| if height.at(x, y) == 420.0 { 30.0 } else { 0.0 });
    world.set_layer(Layer::Bedrock, height);
    world.set_layer(Layer::LakeDepth, lake);
    world
}

fn camera(land: &Land) -> Camera {
    let target = glam::DVec3::new(0.0, 0.0, land.surface(0.0, 0.0));
    Camera { target, from_deg: 200.0, down_deg: 20.0, distance_m: 24_000.0, view_deg: 35.0 }
}

fn pictures(c: &mut Criterion) {
    let mut renderer = match Gpu::open().and_then(Renderer::new) {
        Ok(renderer) => renderer,
        Err(error) => return eprintln!("skipped: {error}"),
    };
    println!("on {}", renderer.gpu().name());
    let world = world();
    let mut run = |group: &str, name: &str, quality: Quality, size: [u32; 2], scene: SceneParams| {
        let mut land = renderer.land(&world, &scene).expect("a land");
        let camera = camera(&land);
        let moment = Moment { size, share: 0.0, seconds: 2.0, quality };
        // Shaders are compiled by the first one.
        renderer.picture(&mut land, &scene, &camera, &moment).expect("a picture");
        let mut group = c.benchmark_group(group);
        group.sample_size(10);
        group.bench_function(name, |b| {
            b.iter(|| renderer.picture(&mut land, &scene, &camera, &moment).expect("a picture"));
        });
        group.finish();
    };
    let plain = SceneParams::default;
    run("draft", "640 x 360", Quality::Draft, [640, 360], plain());
    run("normal", "1280 x 720", Quality::Normal, [1280, 720], plain());
    let hd = [1280, 720];
    run("full", "1280 x 720", Quality::Full, hd, plain());
    type Change = fn(&mut SceneParams);
    let without: [(&str, Change); 7] = [
        ("without sea", |s| s.water.sea = false),
        ("without mirrored land", |s| s.water.reflections = false),
        ("without lakes", |s| s.water.inland = false),
        ("without shafts", |s| s.fog.shafts = false),
        ("without glow", |s| s.bloom.on = false),
        ("without haze", |s| s.fog.on = false),
        ("without shadows", |s| s.shadow.on = false),
    ];
    for (name, change) in without {
        let mut scene = plain();
        change(&mut scene);
        run("full", name, Quality::Full, hd, scene);
    }
}

criterion_group!(benches, pictures);
criterion_main!(benches);
