//! Closed books, water that obeys the ground, and the same bits every time.

use proptest::prelude::*;

use super::super::bed::{Bed, Family, Moved, Part};
use super::{RainParticles, RainParticlesParams, params::GRAVITY};
use crate::{
    bake::{Frame, Tape, due_s},
    grid::{Edges, Grid},
    noise::{Fbm, Key},
};

fn bed(grid: Grid, height: impl Fn(usize, usize) -> f64) -> Bed {
    let start = (0..grid.cells()).map(|i| height(i % grid.width, i / grid.width) as f32).collect();
    Bed { sea_m: -1e9, ..Bed::new(grid, start) }
}

fn hill(edges: Edges) -> Bed {
    let grid = Grid::new(40, 32, 40.0, edges);
    let land = Fbm::new(25.0, 0.8).octaves(Key::new(3), 1.0);
    bed(grid, |x, y| 6.0 * land.value(grid.center_m(x, y)) + 20.0)
}

fn params() -> RainParticlesParams {
    RainParticlesParams { duration_min: 0.3, lifespan_s: 8.0, ..RainParticlesParams::default() }
}

fn run(rain: &mut RainParticles, bed: &mut Bed, from: u64, to: u64, steps: u64) -> Moved {
    (from..to).fold(Moved::default(), |sum, step| {
        let moved = rain.advance(bed, Part { step, steps });
        Moved {
            rock_left_m3: sum.rock_left_m3 + moved.rock_left_m3,
            water_in_m3: sum.water_in_m3 + moved.water_in_m3,
            water_left_m3: sum.water_left_m3 + moved.water_left_m3,
        }
    })
}

/// What the books are off by, and what was moved, m³.
fn books(rain: &RainParticles, bed: &Bed, left_m3: f64) -> (f64, f64) {
    let sum: f64 = bed.change.iter().map(|&change| change as f64).sum();
    let size: f64 = bed.change.iter().map(|&change| change.abs() as f64).sum();
    let area = bed.grid.cell_area_m2();
    (sum * area + rain.carried_m3() + left_m3, size * area)
}

#[test]
fn the_books_close() {
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        let mut bed = hill(edges);
        bed.sea_m = 12.0;
        bed.rate = (0..bed.grid.cells()).map(|i| if i % 7 == 0 { 0.0 } else { 0.9 }).collect();
        let mut rain = RainParticles::new(&params(), bed.grid, Key::new(1)).unwrap();
        let moved = run(&mut rain, &mut bed, 0, 3, 3);
        let (off, size) = books(&rain, &bed, moved.rock_left_m3);
        assert!(size > 1.0 && off.abs() < 1e-9 * size, "{off} of {size}");
        let alive = rain.seen().x_m.len() as f64 * rain.particle_m3();
        assert!((moved.water_in_m3 - moved.water_left_m3 - alive).abs() < 1e-6 && moved.water_left_m3 > 1.0);
        assert!(moved.rock_left_m3 > 0.0 || edges != Edges::Open);
        rain.settle(&mut bed);
        let (off, size) = books(&rain, &bed, moved.rock_left_m3);
        assert!(off.abs() < 1e-9 * size && rain.carried_m3().abs() < 1e-5 * size, "{off} {}", rain.carried_m3());
        assert!((0..bed.grid.cells()).all(|i| bed.rate(i) > 0.0 || bed.change[i] == 0.0));
    }
}

#[test]
fn land_stays_land_and_sea_stays_sea() {
    let mut bed = hill(Edges::Open);
    (bed.sea_m, bed.locked, bed.margin_m) = (19.0, true, 0.01);
    let below = |bed: &Bed| (0..bed.grid.cells()).map(|i| bed.height(i) < bed.sea_m).collect::<Vec<_>>();
    let before = below(&bed);
    let more = RainParticlesParams { morphological_factor: 100.0, ..params() };
    let mut rain = RainParticles::new(&more, bed.grid, Key::new(1)).unwrap();
    let moved = run(&mut rain, &mut bed, 0, 2, 2);
    rain.settle(&mut bed);
    let (off, size) = books(&rain, &bed, moved.rock_left_m3);
    assert!(size > 10.0 && off.abs() < 1e-9 * size);
    assert_eq!(before, below(&bed));
    // Nor does any height come nearer than the margin.
    assert!((0..bed.start.len()).all(|i| bed.change[i] == 0.0 || (bed.height(i) - 19.0).abs() >= 0.009));
}

#[test]
fn a_drop_never_goes_through_the_ground() {
    let grid = Grid::new(60, 12, 60.0, Edges::Closed);
    for slope in [0.0, 0.4, 1.5] {
        let mut bed = bed(grid, |x, _| slope * (60.0 - x as f64));
        let calm = RainParticlesParams { rain_mm_per_h: 0.0, restitution: 0.2, acidity_per_s: 0.0, ..params() };
        let mut rain = RainParticles::new(&calm, grid, Key::new(1)).unwrap();
        let top = slope * 50.0 + 15.0;
        assert_eq!(rain.fill(&bed, [10.0, 6.0, top], [10.5, 6.5, top + 0.5]), 1);
        let mut lowest = f64::INFINITY;
        for step in 0..400 {
            rain.advance(&mut bed, Part { step, steps: 1200 });
            let seen = rain.seen();
            let ground = slope * (60.5 - seen.x_m[0] as f64) - seen.datum_m as f64;
            let gap = (seen.z_m[0] as f64 - ground) / (1.0 + slope * slope).sqrt();
            // The rim beyond the outermost centres is level.
            if seen.x_m[0] < 59.0 {
                lowest = lowest.min(gap);
            }
        }
        // Half a spacing is its radius; 1 % for f32 at tens of metres.
        assert!(lowest > 0.25 * 0.99 && lowest < 0.26, "{slope}: {lowest}");
    }
}

#[test]
fn a_slide_ends_at_the_speed_that_friction_allows() {
    let grid = Grid::new(90, 8, 90.0, Edges::Open);
    for (slope, friction) in [(0.5f64, 0.1), (0.2, 0.3)] {
        let mut bed = bed(grid, |x, _| slope * (90.0 - x as f64));
        let slide =
            RainParticlesParams { rain_mm_per_h: 0.0, friction, lifespan_s: 100.0, acidity_per_s: 0.0, ..params() };
        let mut rain = RainParticles::new(&slide, grid, Key::new(1)).unwrap();
        rain.fill(&bed, [5.0, 4.0, slope * 85.0 + 0.3], [5.5, 4.5, slope * 85.0 + 0.8]);
        rain.advance(&mut bed, Part { step: 0, steps: 1 });
        let sine = slope / (1.0 + slope * slope).sqrt();
        let want = (GRAVITY * sine * 0.5 / friction).sqrt();
        let v = rain.seen().velocity_m_per_s.map(|v| v[0] as f64);
        let speed = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        assert!((speed / want - 1.0).abs() < 0.02, "{speed} for {want}");
    }
}

/// A layer of water a metre deep slides down a plane: on the bed friction `c·u²` balances the weight `g·H·sin α`; above,
/// viscosity lets water be faster by `g·sin α/ν·(H·z − z²/2)`.
#[test]
fn a_layer_of_water_slides_as_friction_and_viscosity_allow() {
    let grid = Grid::new(64, 16, 64.0, Edges::Open);
    let (slope, friction, viscosity) = (0.2f64, 0.6, 0.5);
    // A channel: its banks are steep and higher than the water.
    let bank = |y: usize| if (3..13).contains(&y) { 0.0 } else { 6.0 };
    let mut bed = bed(grid, |x, y| slope * (64.0 - (x as f64 + 0.5)) + bank(y));
    // The speed nears its end by tanh(1.07·t); what the banks hold back comes √(ν·t), 1.4 m, near.
    let params = RainParticlesParams {
        rain_mm_per_h: 0.0,
        lifespan_s: 1e4,
        acidity_per_s: 0.0,
        viscosity_m2_per_s: viscosity,
        friction,
        duration_min: 4.0 / 60.0,
        ..params()
    };
    let mut rain = RainParticles::new(&params, grid, Key::new(1)).unwrap();
    for x in (4..60).map(f64::from) {
        let low = slope * (63.5 - x);
        rain.fill(&bed, [x, 3.0, low], [x + 1.0, 13.0, low + 1.0]);
    }
    rain.advance(&mut bed, Part { step: 0, steps: 1 });
    let seen = rain.seen();
    let (sine, cosine) = (slope / slope.hypot(1.0), 1.0 / slope.hypot(1.0));
    let over = |i: usize| (f64::from(seen.z_m[i] + seen.datum_m) - slope * (64.0 - f64::from(seen.x_m[i]))) * cosine;
    let speed =
        |i: usize| f64::from(seen.velocity_m_per_s[0][i]) * cosine - f64::from(seen.velocity_m_per_s[2][i]) * sine;
    // Far from both ends and from the banks.
    let far = |i: &usize| (28.0..44.0).contains(&seen.x_m[*i]) && (6.5..9.5).contains(&seen.y_m[*i]);
    let inside: Vec<usize> = (0..seen.x_m.len()).filter(far).collect();
    let layer = rain.particle_m3() / (16.0 * 3.0 / cosine);
    let (depth, weight) = (inside.len() as f64 * layer, GRAVITY * sine * inside.len() as f64 * layer);
    let mean = |low: f64, high: f64, f: &dyn Fn(usize) -> f64| {
        let of: Vec<usize> = inside.iter().copied().filter(|&i| (low..high).contains(&over(i))).collect();
        of.iter().map(|&i| f(i)).sum::<f64>() / of.len() as f64
    };
    // Friction is felt within half a metre of the bed, over half a metre.
    let touching = inside.iter().filter(|&&i| over(i) < 0.5);
    let stress = layer * touching.map(|&i| friction / 0.5 * speed(i) * speed(i)).sum::<f64>();
    assert!((stress / weight - 1.0).abs() < 0.05, "a stress of {stress} under a weight of {weight}");
    // Next to the bed lies a tenth more than a layer, which slows it by half of that.
    let (bottom, want) = (mean(0.0, 0.45, &speed), (weight / friction).sqrt());
    assert!((bottom / want - 1.0).abs() < 0.08, "{bottom} m/s for {want}, {depth} m deep");
    let profile = |z: f64| GRAVITY * sine / viscosity * (depth * z - 0.5 * z * z);
    let top = mean(depth - 0.5, depth + 1.0, &speed);
    let more = profile(mean(depth - 0.5, depth + 1.0, &over)) - profile(mean(0.0, 0.45, &over));
    // Two layers resolve it to a fifth.
    assert!(((top - bottom) / more - 1.0).abs() < 0.2, "{} m/s more at the top for {more}", top - bottom);
}

/// A pool over a world that wraps, settled.
fn pool(depth_m: f64) -> (RainParticles, Bed) {
    let grid = Grid::new(6, 6, 6.0, Edges::Wrap);
    let mut bed = bed(grid, |_, _| 100.0);
    let still = RainParticlesParams {
        duration_min: 0.2,
        rain_mm_per_h: 0.0,
        lifespan_s: 1e3,
        viscosity_m2_per_s: 0.3,
        ..params()
    };
    let mut rain = RainParticles::new(&still, grid, Key::new(1)).unwrap();
    rain.fill(&bed, [0.0, 0.0, 100.0], [6.0, 6.0, 100.0 + depth_m]);
    rain.advance(&mut bed, Part { step: 0, steps: 1 });
    (rain, bed)
}

#[test]
fn a_column_settles_to_the_weight_above() {
    let (rain, _) = pool(4.0);
    let (water, z) = (rain.water(), rain.seen().z_m);
    let top = z.iter().fold(0.0f32, |a, &b| a.max(b)) as f64 + 0.25;
    // Pressed by 1 % in the mean; and the surface, where half of every kernel is empty, draws together by a third of a layer.
    assert!((top - 4.0).abs() < 0.25, "{top}");
    for (low, high) in [(0.5, 1.0), (1.0, 2.0), (2.0, 3.0)] {
        let inside: Vec<usize> = (0..z.len()).filter(|&i| (low..high).contains(&(z[i] as f64))).collect();
        let mean = |f: &dyn Fn(usize) -> f64| inside.iter().map(|&i| f(i)).sum::<f64>() / inside.len() as f64;
        let pressure = mean(&|i| water.sound * water.sound * (water.density()[i] as f64 - 1.0).max(0.0));
        let want = mean(&|i| GRAVITY * (top - z[i] as f64));
        // A twentieth of the pressure at the bottom: layers are half a metre thick.
        assert!((pressure - want).abs() < 0.05 * GRAVITY * 4.0, "{low}: {pressure} for {want}");
    }
}

#[test]
fn standing_water_digs_nothing() {
    let (_, bed) = pool(2.0);
    assert!(bed.change.iter().all(|&change| change == 0.0));
    // Nor in a bowl, once it has come to rest.
    let grid = Grid::new(16, 16, 16.0, Edges::Closed);
    let mut bed = self::bed(grid, |x, y| 0.05 * ((x as f64 - 7.5).powi(2) + (y as f64 - 7.5).powi(2)));
    let still = RainParticlesParams { duration_min: 1.0, rain_mm_per_h: 0.0, lifespan_s: 1e4, ..params() };
    let mut rain = RainParticles::new(&still, grid, Key::new(1)).unwrap();
    rain.fill(&bed, [5.0, 5.0, 0.0], [11.0, 11.0, 2.0]);
    run(&mut rain, &mut bed, 0, 3, 4);
    let before = bed.change.clone();
    run(&mut rain, &mut bed, 3, 4, 4);
    // It still lays down what it stirred up before.
    let (dug, most) = bed
        .change
        .iter()
        .zip(&before)
        .fold((0.0f32, 0.0f32), |(dug, most), (after, before)| (dug.max(before - after), most.max(before.abs())));
    assert!(dug < 1e-5 && most > 1e-3, "{dug} {most}");
}

fn bits(bed: &Bed, rain: &RainParticles) -> (Vec<u32>, Vec<u8>) {
    (bed.change.iter().map(|change| change.to_bits()).collect(), rain.save().blob)
}

#[test]
fn threads_give_the_same_bits_and_rain_comes_again() {
    let run = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut bed = hill(Edges::Wrap);
            let mut rain = RainParticles::new(&params(), bed.grid, Key::new(seed)).unwrap();
            run(&mut rain, &mut bed, 0, 2, 2);
            bits(&bed, &rain)
        })
    };
    let one = run(1, 1);
    assert!(one == run(2, 1) && one == run(8, 1) && one != run(1, 2));
}

#[test]
fn a_saved_run_goes_on_as_if_never_stopped() {
    let start = || {
        let bed = hill(Edges::Open);
        let rain = RainParticles::new(&params(), bed.grid, Key::new(1)).unwrap();
        (bed, rain)
    };
    let (mut bed, mut rain) = start();
    run(&mut rain, &mut bed, 0, 2, 4);
    let (saved, kept) = (rain.save(), bed.clone());
    run(&mut rain, &mut bed, 2, 4, 4);
    let (_, mut other) = start();
    let field = |name: &str| saved.fields.iter().find(|field| field.0 == name).map(|field| field.1.clone());
    other.restore(&field, &saved.blob).unwrap();
    assert_eq!(other.save(), saved);
    let mut again = kept;
    run(&mut other, &mut again, 2, 4, 4);
    assert!(bits(&bed, &rain) == bits(&again, &other));
    // What is cut short or from another layout is refused.
    for blob in [&saved.blob[..saved.blob.len() - 1], &saved.blob[8..], &[]] {
        assert!(other.restore(&field, blob).is_none());
    }
    assert!(other.restore(&|_| None, &saved.blob).is_none());
}

#[test]
fn drops_are_born_apart_and_fall_where_it_rains() {
    let mut bed = hill(Edges::Open);
    let disc =
        RainParticlesParams { rain_radius: 0.2, rain_x: 0.3, rain_mm_per_h: 2e4, duration_min: 0.01, ..params() };
    let mut rain = RainParticles::new(&disc, bed.grid, Key::new(1)).unwrap();
    let moved = rain.advance(&mut bed, Part { step: 0, steps: 1 });
    let seen = rain.seen();
    let n = seen.x_m.len();
    // π·6.4² m² at 20 m/h for 0.6 s.
    assert!((moved.water_in_m3 - 0.43).abs() < 0.25 && n > 0, "{}", moved.water_in_m3);
    for i in 0..n {
        assert!((seen.x_m[i] - 12.0).hypot(seen.y_m[i] - 16.0) < 6.4 + 2.0);
    }
    let depth: f64 = rain.depth_m().data.iter().map(|&depth| depth as f64).sum();
    assert!((depth - n as f64 * 0.125).abs() < 1e-4);
}

#[test]
fn what_cannot_run_is_refused_with_the_fix() {
    let grid = Grid::new(64, 64, 64.0, Edges::Open);
    let with = |change: &dyn Fn(&mut RainParticlesParams)| {
        let mut params = RainParticlesParams::default();
        change(&mut params);
        params.check(&grid)
    };
    assert_eq!(with(&|_| ()), Ok(()));
    assert!(with(&|p| p.spacing_m = 3.0).unwrap_err().contains("spacing_m from 0.050 to 1.000"));
    assert!(
        with(&|p| (p.viscosity_m2_per_s, p.duration_min) = (100.0, 30.0))
            .is_err_and(|error| error.contains("sub-steps"))
    );
    assert!(with(&|p| p.duration_min = 1000.0).is_err());
    assert_eq!(RainParticlesParams::default().warning(&grid), None);
    assert!(RainParticlesParams::default().warning(&Grid { cell_m: 30.0, ..grid }).is_some());
}

fn edges() -> impl Strategy<Value = Edges> {
    prop_oneof![Just(Edges::Open), Just(Edges::Closed), Just(Edges::Wrap)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn ugly_parameters_and_ugly_ground_stay_finite(
        (width, height, edges, cell) in (1usize..14, 1usize..14, edges(), -1.0f64..4.0),
        (relief, kind, sea, locked) in (-1.0f64..6.0, 0u8..4, 0.0f64..1.0, any::<bool>()),
        (spacing, rain, lifespan, radius) in (0.1f64..1.0, -1.0f64..5.0, 0.0f64..3.0, 0.0f64..1.0),
        (viscosity, tension, restitution, friction) in (-4.0f64..2.0, 0.0f64..10.0, 0.0f64..0.2, -2.3f64..1.0),
        (capacity, acidity, factor, seed, shared) in (0.0f64..1.0, 0.0f64..100.0, 0.0f64..5.0, any::<u64>(), any::<bool>()),
    ) {
        let ten = |power: f64| libm::pow(10.0, power);
        let grid = Grid::new(width, height, width as f64 * ten(cell), edges);
        let mut stream = Key::new(seed).stream();
        let random: Vec<f64> = (0..grid.cells()).map(|_| stream.unit()).collect();
        let mut bed = bed(grid, |x, y| ten(relief) * match kind {
            0 => 1.0,
            1 => random[y * width + x],
            2 => f64::from(x == width / 2 && y == height / 2),
            _ => f64::from(x != width / 2 || y != height / 2),
        });
        bed.sea_m = (ten(relief) * (2.0 * sea - 1.0)) as f32;
        (bed.locked, bed.margin_m) = (locked, 1e-4);
        if shared {
            bed.rate = (0..grid.cells()).map(|_| (1.5 * stream.unit() - 0.25).clamp(0.0, 1.0) as f32).collect();
        }
        let start = bed.clone();
        let mut params = RainParticlesParams {
            duration_min: 1.0,
            particles: 400.0,
            spacing_m: spacing * grid.cell_m,
            rain_mm_per_h: ten(rain),
            lifespan_s: ten(lifespan),
            rain_radius: radius,
            viscosity_m2_per_s: ten(viscosity),
            surface_tension_n_per_m: tension,
            restitution,
            friction: ten(friction),
            capacity_s_per_m: capacity,
            acidity_per_s: acidity,
            morphological_factor: ten(factor),
            ..RainParticlesParams::default()
        };
        params.duration_min *= 1000.0 / params.most_sub_steps(&grid);
        let mut rain = RainParticles::new(&params, grid, Key::new(seed)).unwrap();
        let high = ten(relief) + 4.0 * params.spacing_m;
        rain.fill(&bed, [0.0, 0.0, high - 8.0 * params.spacing_m], [4.0 * params.spacing_m, 4.0 * params.spacing_m, high]);
        let moved = run(&mut rain, &mut bed, 0, 2, 2);
        let seen = rain.seen();
        prop_assert!([seen.x_m, seen.y_m, seen.z_m].into_iter().chain(seen.velocity_m_per_s).flatten().all(|v| v.is_finite()));
        rain.settle(&mut bed);
        prop_assert!(bed.change.iter().all(|change| change.is_finite()));
        let (off, size) = books(&rain, &bed, moved.rock_left_m3);
        prop_assert!(off.abs() <= 1e-6 * (size + moved.rock_left_m3), "{off} of {size}");
        prop_assert!((moved.water_left_m3).is_finite());
        for i in 0..grid.cells() {
            prop_assert!(bed.rate(i) > 0.0 || bed.change[i] == 0.0, "a masked cell changed by {}", bed.change[i]);
            let land = |bed: &Bed| bed.height(i) >= bed.sea_m;
            prop_assert!(!locked || land(&start) == land(&bed), "{} became {}", start.height(i), bed.height(i));
        }
    }
}

/// Keeps all frames, ten a second.
#[derive(Default)]
struct Roll(std::sync::Mutex<Vec<Frame>>);

impl Tape for Roll {
    fn per_s(&self) -> f64 {
        10.0
    }

    fn take(&self, frame: Frame) -> Result<(), String> {
        self.0.lock().unwrap().push(frame);
        Ok(())
    }
}

#[test]
fn frames_of_rain_are_the_state_at_their_time_and_change_nothing() {
    let make = || (hill(Edges::Open), RainParticles::new(&params(), hill(Edges::Open).grid, Key::new(1)).unwrap());
    let ((mut bed, mut rain), (mut plain_bed, mut plain), roll) = (make(), make(), Roll::default());
    let mut states = Vec::new();
    for step in 0..6 {
        rain.advance_on(&mut bed, Part { step, steps: 6 }, Some(&roll)).unwrap();
        run(&mut plain, &mut plain_bed, step, step + 1, 6);
        let seen = rain.seen();
        let mut order: Vec<usize> = (0..seen.born.len()).collect();
        order.sort_by_key(|&i| seen.born[i]);
        let wide = |values: &[f32], from: f32| -> Vec<f64> {
            order.iter().map(|&i| f64::from(values[i]) + f64::from(from)).collect()
        };
        let age = order.iter().map(|&i| (8.0 - f64::from(seen.life_s[i])).max(0.0)).collect();
        let load = order.iter().map(|&i| seen.load_m3[i]).collect();
        let columns = vec![wide(seen.x_m, 0.0), wide(seen.y_m, 0.0), wide(seen.z_m, seen.datum_m), age, load];
        states.push((order.iter().map(|&i| seen.born[i] as u32).collect::<Vec<_>>(), columns));
    }
    assert_eq!((bed.change, rain.save()), (plain_bed.change, plain.save()), "being looked at changes nothing");
    let frames = roll.0.into_inner().unwrap();
    // Eighteen seconds, a step every three.
    assert_eq!(frames.len(), 181);
    assert!(frames.iter().enumerate().all(|(k, frame)| frame.time_s == due_s(k as u64, 10.0)));
    for (step, (id, columns)) in states.iter().enumerate() {
        let frame = &frames[30 * (step + 1)];
        assert_eq!((frame.id.len() > 10, &frame.id), (true, id), "step {step}");
        assert!(&frame.columns == columns, "step {step}");
    }
}
