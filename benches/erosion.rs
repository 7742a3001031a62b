//! Rivers over a raster: routing alone, and a whole step of stream power (route, erode, diffuse), on young ground full of
//! pits and on ground that rivers have shaped; with what memory gives beside it.

mod memory;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use upthrust::{
    erosion::stream_power::{Carver, Forcing, Law, Rim, StreamPowerParams},
    flow::Router,
    grid::{Edges, Field, Grid},
    noise::{Fbm, Key},
};

const SIZES: [usize; 3] = [512, 1024, 2048];

/// Fractal hills of some hundred metres.
fn young(size: usize) -> (Grid, Vec<f64>) {
    let grid = Grid::new(size, size, 1e6, Edges::Open);
    let sum = Fbm::new(200e3, 0.8).octaves(Key::new(5), grid.cell_m);
    let field = Field::from_fn(grid, |x, y| sum.value(grid.center_m(x, y)) as f32);
    (grid, field.data.iter().map(|&v| 500.0 + 300.0 * v as f64).collect())
}

fn law() -> Law {
    Law { rim: Rim::Fixed, ..StreamPowerParams::default().law() }
}

fn forcing(uplift: &[f32]) -> Forcing<'_> {
    Forcing {
        sea_level_m: f64::MIN,
        uplift_mm_per_yr: Some(uplift),
        uplift_factor: 1.0,
        rain_mm_per_yr: None,
        inflows: &[],
        gates: &[],
        uniform_rain_mm_per_yr: 1000.0,
        ease: None,
    }
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("stream power");
    group.sample_size(10);
    for size in SIZES {
        let (grid, ground) = young(size);
        let uplift = vec![0.5f32; grid.cells()];
        let mut carver = Carver::new(grid);
        group.throughput(Throughput::Elements(grid.cells() as u64));
        group.bench_function(BenchmarkId::new("step on young ground", size), |b| {
            b.iter_batched_ref(
                || ground.clone(),
                |z| carver.step(&law(), &forcing(&uplift), z, 1e5),
                criterion::BatchSize::LargeInput,
            )
        });
        let mut shaped = ground.clone();
        for _ in 0..60 {
            carver.step(&law(), &forcing(&uplift), &mut shaped, 1e5);
        }
        group.bench_function(BenchmarkId::new("step", size), |b| {
            b.iter(|| carver.step(&law(), &forcing(&uplift), &mut shaped, 1e5))
        });
        let mut router = Router::new(grid);
        let outlet: Vec<bool> = (0..grid.cells()).map(|i| i < size).collect();
        group.bench_function(BenchmarkId::new("route", size), |b| b.iter(|| router.route(&shaped, &outlet)));
    }
    group.finish();
}

criterion_group!(benches, steps, memory::triad);
criterion_main!(benches);
