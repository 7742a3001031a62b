//! Noise and RMP draws.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use upthrust::{
    grid::{Edges, Field, Grid},
    noise::{Basis, Fbm, Key},
    rmp::{self, Arrangement, Probe, Raised},
};

/// Ten octaves over 256² cells.
fn octaves(c: &mut Criterion) {
    let mut group = c.benchmark_group("noise");
    let grid = Grid::new(256, 256, 25.6e3, Edges::Open);
    group.throughput(Throughput::Elements(10 * grid.cells() as u64));
    for basis in [Basis::Value, Basis::Gradient, Basis::Simplex] {
        let sum = Fbm { octaves: Some(10.0), basis, ..Fbm::new(100e3, 0.8) }.octaves(Key::new(1), 0.0);
        group.bench_function(format!("{basis:?} octaves"), |b| b.iter(|| over(grid, |at| sum.value(at))));
        group.bench_function(format!("{basis:?} octaves with slope"), |b| {
            b.iter(|| over(grid, |at| sum.gradient(at).1[0]))
        });
    }
    let sum = Fbm { octaves: Some(10.0), ..Fbm::new(100e3, 0.8) }.octaves(Key::new(1), 0.0);
    group.bench_function("hybrid multifractal octaves", |b| {
        b.iter(|| {
            let mut sampler = sum.sampler();
            over(grid, |at| sampler.hybrid(at, 0.7))
        })
    });
    group.bench_function("Gradient octaves, sampled along rows", |b| {
        b.iter(|| {
            let mut sampler = sum.sampler();
            over(grid, |at| sampler.value(at))
        })
    });
    group.finish();
}

/// One thread, so that the figure is one core's.
fn over(grid: Grid, mut f: impl FnMut([f64; 2]) -> f64) -> f64 {
    (0..grid.cells()).map(|i| f(grid.center_m(i % grid.width, i / grid.width))).sum()
}

/// Draws of the Voronoi form, by the length of the path in site spacings (sites grow with it), and of the line form.
fn draws(c: &mut Criterion) {
    let mut group = c.benchmark_group("rmp");
    for (length, sites) in [(0.0, 36), (10.0, 100), (42.0, 300)] {
        let path = [[0.0, 0.0], [length, 0.3 * length]];
        let probe = Probe::new(&path[..if length > 0.0 { 2 } else { 1 }], 1.0);
        let mut draw = 0;
        group.bench_function(format!("voronoi draw, about {sites} sites"), |b| {
            b.iter(|| {
                draw += 1;
                black_box(probe.cells(Key::new(1).with(draw)))
            })
        });
    }
    let mut draw = 0;
    group.bench_function("arrangement of 12 lines", |b| {
        b.iter(|| {
            draw += 1;
            black_box(Arrangement::random([1000.0, 1000.0], 12, Key::new(1).with(draw)))
        })
    });
    let mut field = Field::filled(Grid::new(1024, 1024, 1024.0, Edges::Open), 0.0);
    let path = [[200.0, 300.0], [800.0, 700.0]];
    let raised: Vec<Raised> = (0..20)
        .flat_map(|i| rmp::cells_along(&path, rmp::density_for_half_width(20.0), Key::new(2).with(i)))
        .map(|cell| Raised { outline: cell.outline, amount: 1.0 })
        .collect();
    let cells: f64 = raised.len() as f64;
    group.bench_function(format!("raise {cells} outlines of 20 draws on 1024²"), |b| {
        b.iter(|| rmp::raise(black_box(&mut field), &raised))
    });
    group.finish();
}

criterion_group!(benches, octaves, draws);
criterion_main!(benches);
