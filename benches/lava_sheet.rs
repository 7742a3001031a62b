//! A sheet of lava over rough ground: a step in time where lava is thin enough to be followed, and where it is so deep that
//! its surface is solved for; with what memory gives beside it.

mod memory;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use upthrust::{
    grid::{Edges, Field, Grid},
    noise::{Fbm, Key},
    volcano::{LavaSheetParams, sheet::Film},
};

/// Steps between two looks at the clock.
const STEPS: u64 = 4;

/// A slope of 5 % with hills of some metres, on cells of 20 m.
fn slope(size: usize) -> Field<f32> {
    let grid = Grid::new(size, size, 20.0 * size as f64, Edges::Open);
    let sum = Fbm::new(1500.0, 0.9).octaves(Key::new(5), grid.cell_m);
    Field::from_fn(grid, |x, y| {
        let at = grid.center_m(x, y);
        (0.05 * at[0] + 10.0 * sum.value(at)) as f32
    })
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("lava sheet");
    group.sample_size(10);
    for size in [256, 1024] {
        let ground = slope(size);
        for (name, depth_m, most_s) in [("followed", 1.0, 0.5), ("solved for", 20.0, 0.5)] {
            let film = Film::new(&LavaSheetParams::default(), &ground, depth_m);
            group.throughput(Throughput::Elements(STEPS * (size * size) as u64));
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter_batched_ref(
                    || film.clone(),
                    |film| (0..STEPS).map(|_| film.advance(most_s)).sum::<f64>(),
                    BatchSize::LargeInput,
                )
            });
        }
    }
    group.finish();
}

criterion_group!(benches, steps, memory::triad);
criterion_main!(benches);
