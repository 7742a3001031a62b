//! Steps of lava on one thread and on two: 64,000 particles at rest in a basin, viscosity followed and solved for at once, with
//! what a look for neighbours costs in it. Elements are steps of a particle. Then a look for neighbours alone, by cells and by
//! the loop over all pairs.
//!
//! `cargo bench --bench lava -- explicit` runs one group; `-- "all pairs once"` adds what takes minutes.

use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};
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

/// Particles of the pool.
const PARTICLES: usize = 64_000;
/// What is run between two looks at the clock: a few steps; s.
const SPAN_S: f64 = 0.01;

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
        max_particles: PARTICLES as u32,
        freeze: false,
        vent: vec![VentParams { at_km: [0.016, 0.016], to_km: None, radius_m: Some(11.0), part: None }],
        schedule: vec![Timed::particles(0.0, 0.5, 2.0 * PARTICLES as f64 + 1.0)],
        ..params.clone()
    };
    let mut own = Eruption::new(&full, &basin(), None, Key::new(1)).expect("parameters that run");
    own.run(0.0, 1.0).expect("a pool at rest");
    (own, 1.0)
}

/// The time of so many steps of all particles. A step's length is the lava's own, so whole spans run, and their time is shared
/// out over the steps in them.
fn timed(own: &mut Eruption, now: &mut f64, steps: u64) -> Duration {
    let (wanted, before, begun) = (steps * PARTICLES as u64, own.work()[1], Instant::now());
    while own.work()[1] - before < wanted {
        own.run(*now, *now + SPAN_S).expect("a pool at rest");
        *now += SPAN_S;
    }
    begun.elapsed().mul_f64(wanted as f64 / (own.work()[1] - before) as f64)
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
            group.throughput(Throughput::Elements(PARTICLES as u64));
            // Filled when it is first asked for: a filter spares the wait.
            let mut filled = None;
            group.bench_function(BenchmarkId::new(format!("{threads} threads"), PARTICLES), |b| {
                let (own, now) = filled.get_or_insert_with(|| on.install(|| pool(&params)));
                b.iter_custom(|steps| on.install(|| timed(own, now, steps)));
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
    }
    group.finish();
}

/// The loop over all pairs, the yardstick of the search by cells: its time grows with the square, so it runs last, and once
/// where ten runs would take minutes.
fn all_pairs(c: &mut Criterion) {
    let mut group = c.benchmark_group("all pairs");
    group.sample_size(10);
    for particles in [1_000, 3_000, 10_000] {
        let (swarm, _, radius) = block(particles);
        group.throughput(Throughput::Elements(particles as u64));
        group.bench_function(BenchmarkId::from_parameter(particles), |b| {
            b.iter(|| naive_neighbours(&swarm.cloud, swarm.domain, radius))
        });
    }
    group.finish();
}

/// The same for 30,000 and 100,000 particles, one pass each: half a minute and more, so only where it is asked for by name.
fn all_pairs_once() {
    if !std::env::args().any(|word| word == "all pairs once") {
        return;
    }
    for particles in [30_000, 100_000] {
        let (swarm, _, radius) = block(particles);
        let begun = Instant::now();
        let found: usize = naive_neighbours(&swarm.cloud, swarm.domain, radius).iter().map(Vec::len).sum();
        let seconds = begun.elapsed().as_secs_f64();
        println!("all pairs once/{particles}: {seconds:.2} s, {found} found");
    }
}

criterion_group!(benches, lava, neighbours, all_pairs);

fn main() {
    benches();
    all_pairs_once();
    Criterion::default().configure_from_args().final_summary();
}
