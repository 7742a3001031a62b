//! A world grown from its plates: the run itself, what the map reads of it, raising, and what is done with the world after.

mod memory;

use std::{hint::black_box, sync::atomic::AtomicBool};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use upthrust::{
    noise::Key,
    process::{Context, Process},
    recipe::{Overrides, Plan, find_preset},
    relief::{self, Options, View},
    rmp::{self, Brush},
    timeline::Timeline,
    world::{World, store},
};

static STAY: AtomicBool = AtomicBool::new(false);

fn collision(size: usize) -> Plan {
    let overrides = Overrides { size: Some(size.to_string()), ..Overrides::default() };
    Plan::new(&find_preset("collision").unwrap().source(), &overrides).unwrap()
}

fn grown(size: usize) -> World {
    Timeline::new(&collision(size), &STAY).run(&mut [], &mut |_| ()).unwrap()
}

/// Runs the plates to their end without showing them.
fn moved(plan: &Plan, context: &Context) -> (Box<dyn Process>, World) {
    let mut process = plan.stages[0].build().unwrap();
    let mut world = World::new(plan.world.grid(), plan.world.sea_level_m);
    while !process.step(&mut world, context).unwrap().finished() {}
    (process, world)
}

/// The run on its own raster, which is the same for every map; what a map of some size reads of it; and both.
fn plates(c: &mut Criterion) {
    let mut group = c.benchmark_group("plates");
    group.sample_size(10);
    let plan = collision(64);
    let context = Context::new(plan.world.seed, &plan.stages[0].key, &STAY);
    group.bench_function("run, unpublished", |b| b.iter(|| moved(&plan, &context)));
    for size in [256, 1024] {
        let plan = collision(size);
        group.throughput(Throughput::Elements((size * size) as u64));
        let (mut process, mut world) = moved(&plan, &context);
        group.bench_function(BenchmarkId::new("publish", size), |b| {
            b.iter(|| process.publish(&mut world, &context).unwrap())
        });
        group.bench_function(BenchmarkId::new("whole stage", size), |b| b.iter(|| grown(size)));
    }
    group.finish();
}

/// Draws of the Voronoi form along a border of 600 km, laid over a raster of 400 x 400 tectonic cells: massif to crest.
fn raising(c: &mut Criterion) {
    let mut group = c.benchmark_group("raising");
    const CELLS: usize = 400;
    let cell_m = 1_500e3 / CELLS as f64;
    let path = [[400e3, 500e3], [700e3, 900e3], [800e3, 950e3]];
    for half_width_km in [45.0, 11.25] {
        let (mut draw, mut brush, mut raster) = (0, Brush::new(), vec![0.0f32; CELLS * CELLS]);
        let density = rmp::density_for_half_width(half_width_km * 1e3);
        group.bench_function(BenchmarkId::new("draw and cover, half width km", half_width_km), |b| {
            b.iter(|| {
                draw += 1;
                for cell in rmp::cells_along(&path, density, Key::new(1).with(draw)) {
                    let outline: Vec<[f64; 2]> = cell.outline.iter().map(|v| v.map(|v| v / cell_m)).collect();
                    brush.cover(&outline, CELLS, CELLS, |x, y, coverage| {
                        raster[y * CELLS + x] += (cell.weight * coverage as f64) as f32;
                    });
                }
            })
        });
        black_box(&raster);
    }
    group.finish();
}

/// The picture and the store of a finished world.
fn after(c: &mut Criterion) {
    let mut group = c.benchmark_group("after");
    group.sample_size(10);
    for size in [256, 1024] {
        let world = grown(size);
        group.throughput(Throughput::Elements((size * size) as u64));
        group.bench_function(BenchmarkId::new("relief", size), |b| {
            b.iter(|| relief::map(&world, &View::Relief, &Options::default()).unwrap())
        });
        let folder = tempfile::tempdir().unwrap();
        let (path, provenance) = (folder.path().join("world.zarr"), store::Provenance::default());
        group.bench_function(BenchmarkId::new("store write", size), |b| {
            b.iter(|| store::write(&world, &provenance, &path).unwrap())
        });
    }
    group.finish();
}

criterion_group!(benches, plates, raising, after, memory::triad);
criterion_main!(benches);
