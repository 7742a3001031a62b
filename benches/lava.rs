//! Steps of lava on one thread and on two: 64,000 particles at rest in a basin, viscosity followed and solved for at once, with
//! what a look for neighbours costs in it. Elements are steps of a particle. Then a look for neighbours alone, by cells and by
//! the loop over all pairs.

use std::time::Instant;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use upthrust::{
    grid::{Edges, Field, Grid},
    noise::Key,
    sph::{Scale, Swarm, WendlandC2, naive_neighbours},
    volcano::{
        Key as Timed, VentParams,
        lava::{Eruption, LavaParams, Smoothing, Solver},
    },
    world::{Layer, World},
};

/// A basin of 24 m with walls of 60 m.
fn basin() -> World {
    let grid = Grid::new(32, 32, 32.0, Edges::Closed);
    let mut world = World::new(grid, -1e4);
    let wall = |x: usize, y: usize| if x.min(y) < 4 || x.max(y) > 27 { 60.0 } else { 0.0 };
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, wall));
    world
}

/// Lava that has filled it with 64,000 particles.
fn pool(params: &LavaParams) -> (Eruption, f64) {
    let full = LavaParams {
        spacing_m: 0.5,
        max_particles: 64_000,
        freeze: false,
        vent: vec![VentParams { at_km: [0.016, 0.016], to_km: None, radius_m: Some(11.0), part: None }],
        schedule: vec![Timed::particles(0.0, 0.5, 128_001.0)],
        ..params.clone()
    };
    let mut own = Eruption::new(&full, &basin(), None, Key::new(1)).expect("parameters that run");
    own.run(0.0, 1.0).expect("a pool at rest");
    (own, 1.0)
}

fn lava(c: &mut Criterion) {
    let usual = LavaParams { viscosity_pa_s: 300.0, ..LavaParams::default() };
    let explicit = LavaParams { viscosity_solver: Solver::Explicit, most_viscosity_pa_s: 1e3, ..usual.clone() };
    let spiky = LavaParams { kernel: Smoothing::Desbrun, smoothing: 1.2, ..explicit.clone() };
    let implicit = LavaParams { viscosity_solver: Solver::Implicit, viscosity_pa_s: 1e5, yield_pa: 1e3, ..usual };
    for (name, params) in [("explicit", explicit), ("explicit, desbrun", spiky), ("implicit with yield", implicit)] {
        let mut group = c.benchmark_group(format!("lava, {name}"));
        group.sample_size(10);
        for threads in [1, 2] {
            let on = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            let (mut own, mut now) = on.install(|| pool(&params));
            // So long that a measurement is some twelve steps: what it did is counted afterwards.
            let span = 0.03;
            let before = own.work()[1];
            on.install(|| own.run(now, now + span)).expect("a pool at rest");
            now += span;
            group.throughput(Throughput::Elements(own.work()[1] - before));
            group.bench_function(BenchmarkId::new(format!("{threads} threads"), own.seen().born.len()), |b| {
                b.iter(|| {
                    on.install(|| own.run(now, now + span)).expect("a pool at rest");
                    now += span;
                })
            });
        }
        group.finish();
    }
}

/// A block of particles that are not quite on a lattice a metre wide, and how far their lists reach.
fn block(particles: usize) -> (Swarm, Grid, f32) {
    let side = libm::cbrt(particles as f64).ceil() as usize;
    let grid = Grid::new(side, side, side as f64, Edges::Open);
    let scale = Scale::new::<WendlandC2>(1.0, 1.3);
    let (mut swarm, mut stream) = (Swarm::new(&grid, scale.support_m()), Key::new(7).stream());
    for k in 0..particles {
        let at = [k % side, k / side % side, k / side / side];
        let at = at.map(|at| (at as f64 + stream.between(0.3, 0.7)) as f32);
        swarm.add([at, [0.0; 3]], 0.0, 0.0, k as u64);
    }
    (swarm, grid, scale.support_m() + 0.4)
}

fn neighbours(c: &mut Criterion) {
    let mut group = c.benchmark_group("neighbours");
    group.sample_size(10);
    for particles in [1_000, 3_000, 10_000, 30_000, 100_000] {
        let (mut swarm, grid, radius) = block(particles);
        group.throughput(Throughput::Elements(particles as u64));
        for threads in [1, 2] {
            let on = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            group.bench_function(BenchmarkId::new(format!("cells, {threads} threads"), particles), |b| {
                b.iter(|| {
                    on.install(|| {
                        swarm.sort(&grid, radius);
                        swarm.meet(radius);
                    })
                })
            });
        }
        if particles <= 10_000 {
            group.bench_function(BenchmarkId::new("all pairs", particles), |b| {
                b.iter(|| naive_neighbours(&swarm.cloud, swarm.domain, radius))
            });
        } else {
            // Ten of these would take minutes.
            let begun = Instant::now();
            let found: usize = naive_neighbours(&swarm.cloud, swarm.domain, radius).iter().map(Vec::len).sum();
            println!(
                "neighbours/all pairs/{particles}: {:.2} s, one pass, {found} found",
                begun.elapsed().as_secs_f64()
            );
        }
    }
    group.finish();
}

criterion_group!(benches, neighbours, lava);
criterion_main!(benches);
