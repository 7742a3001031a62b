//! The families of erosion over a raster or a cloud of particles, on one thread and on two, with what memory gives beside
//! them. Elements are cell-steps for rasters, steps of a droplet, and steps of a particle.

mod memory;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use upthrust::{
    erosion::{
        Bed, Family, Part,
        droplets::{Droplets, DropletsParams},
        hydraulic_cells::{HydraulicCells, HydraulicCellsParams},
        pipes::{Pipes, PipesParams},
        rain_particles::{RainParticles, RainParticlesParams},
        thermal::{Thermal, ThermalMethod, ThermalParams},
    },
    grid::{Edges, Field, Grid},
    noise::{Fbm, Key},
};

/// Passes over a raster between two looks at the clock.
const PASSES: u64 = 8;
/// Parts that a stage is divided into: more than a measurement takes.
const PARTS: u64 = 1_000_000;

/// Fractal hills of 600 m on cells of 8 m.
fn hills(size: usize) -> Bed {
    let grid = Grid::new(size, size, 8.0 * size as f64, Edges::Open);
    let sum = Fbm::new(2500.0, 0.9).octaves(Key::new(5), grid.cell_m);
    let start = Field::from_fn(grid, |x, y| 150.0 * sum.value(grid.center_m(x, y)) as f32).data;
    Bed { sea_m: -1e4, ..Bed::new(grid, start) }
}

fn on(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads")
}

/// Times `advance` of what `make` makes, `work` elements a time.
fn time<F: Family>(c: &mut Criterion, name: &str, size: usize, work: u64, make: impl Fn(&Bed) -> F + Sync) {
    let mut group = c.benchmark_group(name);
    group.sample_size(10).throughput(Throughput::Elements(work));
    for threads in [1, 2] {
        let pool = on(threads);
        let mut bed = hills(size);
        let mut family = pool.install(|| make(&bed));
        let mut step = 0;
        group.bench_function(BenchmarkId::new(format!("{threads} threads"), size), |b| {
            b.iter(|| {
                pool.install(|| family.advance(&mut bed, Part { step, steps: PARTS }));
                step += 1;
            })
        });
    }
    group.finish();
}

fn slides(c: &mut Criterion) {
    for (name, method, most) in
        [("thermal, spread", ThermalMethod::Spread, 0.11), ("thermal, flux", ThermalMethod::Flux, 0.14)]
    {
        let rate_per_yr = 0.05;
        let duration_yr = (PARTS * PASSES) as f64 * most * 0.999 / rate_per_yr;
        let params = ThermalParams { method, rate_per_yr, duration_yr, ..ThermalParams::default() };
        for size in [256, 1024, 4096] {
            let cells = (size * size) as u64;
            time(c, name, size, PASSES * cells, |bed| Thermal::new(params.clone(), bed, vec![0.0; bed.start.len()]));
        }
    }
}

fn cells(c: &mut Criterion) {
    let base = HydraulicCellsParams::default();
    let hours = 8.0 / (3600.0 * base.flow_m_per_s);
    let params = HydraulicCellsParams { duration_h: hours * (PARTS * PASSES) as f64, ..base };
    for size in [256, 1024, 4096] {
        let work = PASSES * (size * size) as u64;
        time(c, "hydraulic_cells", size, work, |bed| HydraulicCells::new(&params, &bed.grid));
    }
}

fn storms(c: &mut Criterion) {
    let mut group = c.benchmark_group("pipes");
    group.sample_size(10);
    // At one size with a rate by cell too, as a mask or hardness gives it.
    for (size, rated) in [(256, false), (1024, false), (1024, true), (4096, false)] {
        group.throughput(Throughput::Elements(PASSES * (size * size) as u64));
        for threads in [1, 2] {
            let pool = on(threads);
            let mut bed = hills(size);
            if rated {
                bed.rate = (0..size * size).map(|i| 0.5 + 0.125 * (i % 5) as f32).collect();
            }
            let mut pipes = Pipes::new(PipesParams::default(), &bed, None);
            // Until water runs everywhere.
            pool.install(|| pipes.run_steps(&mut bed, 100));
            let name = format!("{threads} threads{}", if rated { ", rates" } else { "" });
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter(|| pool.install(|| pipes.run_steps(&mut bed, PASSES)))
            });
        }
    }
    group.finish();
}

fn drops(c: &mut Criterion) {
    let params = DropletsParams::default();
    let round = |bed: &mut Bed, drops: &mut Droplets, step: u64| drops.advance(bed, Part { step, steps: 16 });
    let fresh = |bed: &Bed| Droplets::new(&params, &bed.grid, Key::new(1));
    let mut group = c.benchmark_group("droplets");
    group.sample_size(10);
    // The smaller map has hardly more windows than two threads have lanes.
    for size in [1024, 2048] {
        // Ways grow longer from round to round, so that the same round is taken again and again: the second.
        let mut bed = hills(size);
        let mut first = fresh(&bed);
        round(&mut bed, &mut first, 0);
        let steps = {
            let (mut bed, mut drops) = (bed.clone(), fresh(&bed));
            round(&mut bed, &mut drops, 1);
            drops.steps_taken()
        };
        group.throughput(Throughput::Elements(steps));
        for threads in [1, 2] {
            let pool = on(threads);
            group.bench_function(BenchmarkId::new(format!("{threads} threads"), size), |b| {
                let begin = || (bed.clone(), fresh(&bed));
                let second = |(bed, drops): &mut (Bed, Droplets)| pool.install(|| round(bed, drops, 1));
                b.iter_batched_ref(begin, second, BatchSize::PerIteration)
            });
        }
    }
    group.finish();
}

fn particles(c: &mut Criterion) {
    // A pool of 40 x 40 x 40 particles half a metre apart, at rest in a basin.
    let grid = Grid::new(28, 28, 28.0, Edges::Closed);
    let rim = |x: usize, y: usize| if x.min(y) < 4 || x.max(y) > 23 { 40.0 } else { 0.0 };
    let start: Vec<f32> = (0..grid.cells()).map(|i| rim(i % 28, i / 28)).collect();
    let params = RainParticlesParams {
        rain_mm_per_h: 0.0,
        lifespan_s: 1e5,
        particles: 1e5,
        spacing_m: 0.5,
        duration_min: 2.0,
        ..RainParticlesParams::default()
    };
    let mut group = c.benchmark_group("rain_particles");
    group.sample_size(10);
    for threads in [1, 2] {
        let pool = on(threads);
        let mut bed = Bed { sea_m: -1e4, ..Bed::new(grid, start.clone()) };
        let mut rain = RainParticles::new(&params, grid, Key::new(1)).expect("parameters that run");
        let filled = rain.fill(&bed, [4.0, 4.0, 0.0], [24.0, 24.0, 20.0]);
        let mut step = 0;
        let mut once = |rain: &mut RainParticles| {
            pool.install(|| rain.advance(&mut bed, Part { step, steps: 1000 }));
            step += 1;
        };
        once(&mut rain);
        let before = rain.work()[1];
        once(&mut rain);
        group.throughput(Throughput::Elements(rain.work()[1] - before));
        group.bench_function(BenchmarkId::new(format!("{threads} threads"), filled), |b| b.iter(|| once(&mut rain)));
    }
    group.finish();
}

criterion_group!(benches, slides, cells, storms, drops, particles, memory::triad);
criterion_main!(benches);
