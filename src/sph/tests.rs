//! Kernels against integrals, lists against the naive loop, and what sums over pairs must keep.

use std::sync::atomic::Ordering;

use super::*;
use crate::noise::Key;

/// A block of `side`³ particles a metre apart, each moved by up to `jitter`.
fn block(side: usize, jitter: f64) -> Cloud {
    let mut stream = Key::new(5).named("block").stream();
    let mut cloud = Cloud::default();
    for k in 0..side * side * side {
        let at = [k % side, k / side % side, k / side / side];
        let at = at.map(|at| (at as f64 + 0.5 + stream.between(-jitter, jitter)) as f32);
        cloud.push(at, [0; 3].map(|_| stream.between(-1.0, 1.0) as f32));
    }
    cloud
}

/// The cloud sorted, and its lists.
fn listed(mut cloud: Cloud, radius: f32, domain: Domain) -> (Cloud, Lists) {
    let (mut cells, mut order, mut lists) = (Cells::default(), Vec::new(), Lists::default());
    cells.sort([&cloud.x, &cloud.y, &cloud.z], radius, domain, &mut order);
    cloud.reorder(&order, &mut Vec::new());
    lists.make(&cells, &cloud, radius);
    (cloud, lists)
}

fn liquid<K: Kernel>() -> Liquid {
    Liquid { scale: Scale::new::<K>(1.0, 1.2), sound_m_per_s: 20.0, viscosity_m2_per_s: 0.3, cohesion_per_s2: 0.5 }
}

fn forces<K: Kernel>(cloud: &Cloud, lists: &Lists, domain: Domain) -> Forces {
    let mut forces = Forces::default();
    forces.densities::<K>(cloud, lists, domain, &liquid::<K>(), &vec![0.0; cloud.len()]);
    forces.accelerations::<K>(cloud, lists, domain, &liquid::<K>());
    forces
}

fn kernel_is_sound<K: Kernel>() {
    let (steps, dq) = (4000, 2.0 / 4000.0);
    let at = |k: usize| (k as f64 + 0.5) * dq;
    let pi = std::f64::consts::PI;
    let whole: f64 = (0..steps).map(|k| 4.0 * pi * at(k) * at(k) * K::shape(at(k) as f32) as f64 * dq).sum();
    assert!((whole - 1.0).abs() < 1e-5, "{whole}");
    for q in [0.05f32, 0.4, 0.9, 1.1, 1.6, 1.95] {
        let difference = (K::shape(q + 1e-2) - K::shape(q - 1e-2)) / 2e-2;
        assert!((difference - K::slope(q) * q).abs() < 2e-3, "{q}: {difference}");
        // Slices of the ball beyond a plane: rings at height t weigh 2π·∫W·r dr from t on.
        let slice = |t: f64| {
            (0..steps).map(at).filter(|&r| r > t).map(|r| 2.0 * pi * K::shape(r as f32) as f64 * r * dq).sum::<f64>()
        };
        assert!((slice(q as f64) - K::beyond_slope(q) as f64).abs() < 2e-3, "{q}");
        let difference = (K::beyond(q - 1e-2) - K::beyond(q + 1e-2)) / 2e-2;
        assert!((difference - K::beyond_slope(q)).abs() < 2e-3, "{q}: {difference}");
    }
    assert!((K::beyond(0.0) - 0.5).abs() < 1e-6);
    assert_eq!([K::shape(2.5), K::slope(2.5), K::beyond(2.5), K::beyond_slope(2.5)].map(f32::abs), [0.0; 4]);
}

#[test]
fn kernels_integrate_to_one_and_their_slopes_are_theirs() {
    kernel_is_sound::<CubicSpline>();
    kernel_is_sound::<WendlandC2>();
    kernel_is_sound::<DesbrunGascuel>();
}

fn lattice_rests<K: Kernel>(raw: f64) {
    // What the lattice sums to before it is calibrated, from a table worked out apart from this code.
    let sum = 1.0 / Scale::new::<K>(1.0, 1.2).volume_m3 as f64;
    // Raw values are given to three or more digits.
    assert!((sum - raw).abs() < 5e-3, "{sum}");
    let (cloud, lists) = listed(block(9, 0.0), 2.8, Domain::default());
    let forces = forces::<K>(&cloud, &lists, Domain::default());
    let middle = (0..cloud.len()).find(|&i| [&cloud.x, &cloud.y, &cloud.z].iter().all(|at| at[i] == 4.5)).unwrap();
    assert!((forces.density[middle] - 1.0).abs() < 1e-5, "{}", forces.density[middle]);
    // A wall takes the place of half a lattice.
    let floor = (0..cloud.len()).find(|&i| [cloud.x[i], cloud.y[i], cloud.z[i]] == [4.5, 4.5, 0.5]).unwrap();
    let with_wall = forces.density[floor] + K::beyond(0.5 / 1.2);
    assert!((with_wall - 1.0).abs() < 0.06, "{with_wall}");
}

#[test]
fn a_lattice_has_the_rest_density() {
    lattice_rests::<CubicSpline>(1.0008);
    lattice_rests::<DesbrunGascuel>(1.12);
    // 21/(16π·1.2³)·Σ n·(1 − q/2)⁴·(2q + 1): 1, 6, 12, 8, 6 and 24 points at 0, 1, √2, √3, 2 and √5.
    lattice_rests::<WendlandC2>(1.01746);
}

#[test]
fn lists_hold_what_the_naive_loop_finds() {
    // The third world has five cells around and a table of four.
    for (side, wrap) in [(9, None), (12, Some([12.0, 12.0])), (9, Some([13.6, 13.6])), (1, None)] {
        let (domain, radius) = (Domain { wrap_m: wrap }, 2.7f32);
        let (cloud, lists) = listed(block(side, 0.7), radius, domain);
        for (i, naive) in naive_neighbours(&cloud, domain, radius).into_iter().enumerate() {
            let mut found: Vec<u32> = lists.of(i).map(|j| j as u32).collect();
            found.sort_unstable();
            assert_eq!(found, naive);
        }
        assert!(side == 1 || lists.entries() > 50 * cloud.len() / 2);
    }
}

#[test]
fn far_places_share_a_table_and_stay_apart() {
    // A line much longer than the table, and two heaps that fall on the same entries.
    let mut cloud = Cloud::default();
    for k in 0..300 {
        cloud.push([4096.0 * k as f32, 0.0, 1e5], [0.0; 3]);
        cloud.push([4096.0 * k as f32 + 0.5, 0.0, 1e5], [0.0; 3]);
    }
    let (cloud, lists) = listed(cloud, 1.0, Domain::default());
    assert!((0..cloud.len()).all(|i| lists.of(i).count() == 1));
}

fn momentum_is_kept<K: Kernel>(domain: Domain) {
    let (cloud, lists) = listed(block(10, 0.3), 2.4, domain);
    let forces = forces::<K>(&cloud, &lists, domain);
    for pull in &forces.pull {
        let sum: f64 = pull.iter().map(|&a| a as f64).sum();
        let size: f64 = pull.iter().map(|&a| a.abs() as f64).sum();
        // A pair is exact, so that only sums round: each of n pulls ten times, by 2^-24/√3 of it at random. Four times that.
        let most = 4.0 * 2f64.powi(-24) * (10.0f64 / 3.0).sqrt() / (cloud.len() as f64).sqrt();
        assert!(size > 100.0 && sum.abs() < most * size, "{sum} of {size}");
    }
}

/// Two particles pull each other alike to the bit: what momentum a world loses comes from sums alone.
#[test]
fn a_pair_keeps_momentum_exactly() {
    let mut stream = Key::new(8).stream();
    for _ in 0..200 {
        let mut cloud = Cloud::default();
        for _ in 0..2 {
            let at = [0; 3].map(|_| stream.between(0.0, 1.2) as f32);
            cloud.push(at, [0; 3].map(|_| stream.between(-1.0, 1.0) as f32));
        }
        let (cloud, lists) = listed(cloud, 2.4, Domain::default());
        let forces = forces::<WendlandC2>(&cloud, &lists, Domain::default());
        for pull in &forces.pull {
            // Alike but for the last bit: both densities are the same, and so is every factor.
            assert!(pull[0] + pull[1] == 0.0 && pull[0] != 0.0, "{pull:?}");
        }
    }
}

#[test]
fn pairs_keep_momentum_to_rounding() {
    for domain in [Domain::default(), Domain { wrap_m: Some([10.0, 10.0]) }] {
        momentum_is_kept::<CubicSpline>(domain);
        momentum_is_kept::<WendlandC2>(domain);
        momentum_is_kept::<DesbrunGascuel>(domain);
    }
}

#[test]
fn a_shear_flow_feels_its_viscosity() {
    // v = sin(k·z) in a world that wraps and is endless up and down: the pull is −ν·k²·v in the middle.
    let mut cloud = block(12, 0.0);
    let k = std::f32::consts::TAU / 12.0;
    for i in 0..cloud.len() {
        (cloud.vx[i], cloud.vy[i], cloud.vz[i]) = ((k * cloud.z[i]).sin(), 0.0, 0.0);
    }
    let domain = Domain { wrap_m: Some([12.0, 12.0]) };
    let (cloud, lists) = listed(cloud, 2.8, domain);
    let mut forces = Forces::default();
    let scale = Scale::new::<WendlandC2>(1.0, 1.3);
    let liquid = Liquid { scale, cohesion_per_s2: 0.0, ..liquid::<WendlandC2>() };
    forces.densities::<WendlandC2>(&cloud, &lists, domain, &liquid, &vec![0.0; cloud.len()]);
    forces.accelerations::<WendlandC2>(&cloud, &lists, domain, &liquid);
    for i in (0..cloud.len()).filter(|&i| (3.0..9.0).contains(&cloud.z[i]) && cloud.vx[i].abs() > 0.3) {
        let nu = -forces.pull[0][i] / (k * k * cloud.vx[i]);
        // A sum over three layers either way, and a wave only twelve spacings long.
        assert!((nu / 0.3 - 1.0).abs() < 0.08, "{nu}");
    }
}

#[test]
fn threads_and_widths_give_the_same_bits() {
    let domain = Domain::default();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (cloud, lists) = listed(block(14, 0.4), 2.8, domain);
            let forces = forces::<WendlandC2>(&cloud, &lists, domain);
            let all = [vec![forces.density], forces.pull.to_vec()].concat().concat();
            (lists.entries(), all.into_iter().map(f32::to_bits).collect::<Vec<_>>())
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(8));
    wide::tests::NARROW.store(true, Ordering::Relaxed);
    let narrow = run(2);
    wide::tests::NARROW.store(false, Ordering::Relaxed);
    assert!(one == narrow);
}

#[test]
fn particles_on_one_place_do_no_harm() {
    let mut cloud = Cloud::default();
    for _ in 0..20 {
        cloud.push([1.0; 3], [0.5, 0.0, 0.0]);
    }
    let (cloud, lists) = listed(cloud, 2.4, Domain::default());
    for forces in [
        forces::<CubicSpline>(&cloud, &lists, Domain::default()),
        forces::<DesbrunGascuel>(&cloud, &lists, Domain::default()),
    ] {
        assert!(forces.pull.iter().flatten().all(|&a| a == 0.0) && forces.density.iter().all(|n| n.is_finite()));
    }
}

/// Records for sums over pairs: marks, and notes.
fn records(cloud: &Cloud, marks: &[f32], notes: &[f32]) -> [Vec<[f32; 4]>; 2] {
    let (mut place, mut flow) = (Vec::new(), Vec::new());
    pack(&mut place, [&cloud.x, &cloud.y, &cloud.z, marks]);
    pack(&mut flow, [&cloud.vx, &cloud.vy, &cloud.vz, notes]);
    [place, flow]
}

/// Particles of which one is up to a thousand times as viscous as another, sorted and listed, and `n²/ν` of each.
fn unlike(domain: Domain) -> (Cloud, Lists, Vec<f32>) {
    let (cloud, lists) = listed(block(12, 0.2), 2.8, domain);
    let mut stream = Key::new(8).stream();
    let resist = (0..cloud.len()).map(|_| libm::pow(10.0, stream.between(-2.0, 1.0)) as f32).collect();
    (cloud, lists, resist)
}

#[test]
fn particles_that_differ_keep_momentum_and_alike_ones_flow_as_a_liquid() {
    for domain in [Domain::default(), Domain { wrap_m: Some([12.0, 12.0]) }] {
        let (cloud, lists, resist) = unlike(domain);
        let scale = liquid::<WendlandC2>().scale;
        let whole = forces::<WendlandC2>(&cloud, &lists, domain);
        let [place, flow] = records(&cloud, &whole.push, &resist);
        let mut out = Vec::new();
        sum_pairs(Flowing::<WendlandC2>::new(&scale), [&place, &flow], &lists, (domain, scale.h_m), &mut out);
        for axis in 0..3 {
            let sum: f64 = out.iter().map(|a| f64::from(a[axis])).sum();
            let size: f64 = out.iter().map(|a| f64::from(a[axis].abs())).sum();
            assert!(size > 100.0 && sum.abs() < 1e-6 * size, "{sum} of {size}");
        }
        // All of one viscosity on a lattice: what the sums for a liquid give.
        let (cloud, lists) = listed(block(12, 0.0), 2.8, domain);
        let plain = Liquid { cohesion_per_s2: 0.0, ..liquid::<WendlandC2>() };
        let mut whole = Forces::default();
        whole.densities::<WendlandC2>(&cloud, &lists, domain, &plain, &vec![0.0; cloud.len()]);
        whole.accelerations::<WendlandC2>(&cloud, &lists, domain, &plain);
        let resist: Vec<f32> = whole.density.iter().map(|n| n * n / plain.viscosity_m2_per_s).collect();
        let [place, flow] = records(&cloud, &whole.push, &resist);
        sum_pairs(Flowing::<WendlandC2>::new(&scale), [&place, &flow], &lists, (domain, scale.h_m), &mut out);
        let inside = |i: usize| [cloud.x[i], cloud.y[i], cloud.z[i]].iter().all(|at| (3.0..9.0).contains(at));
        for i in (0..cloud.len()).filter(|&i| inside(i)) {
            for (&a, pull) in out[i].iter().zip(&whole.pull) {
                let b = pull[i];
                assert!((a - b).abs() < 1e-4 * (1.0 + b.abs()), "{a} {b}");
            }
        }
    }
}

#[test]
fn what_is_solved_for_satisfies_its_equation_and_keeps_momentum() {
    let domain = Domain::default();
    let (cloud, lists, resist) = unlike(domain);
    let scale = liquid::<WendlandC2>().scale;
    let [place, _] = records(&cloud, &resist, &resist);
    let before: Vec<[f32; 3]> = (0..cloud.len()).map(|i| [cloud.vx[i], cloud.vy[i], cloud.vz[i]]).collect();
    for (drag, dt) in [(0.0f32, 0.5f32), (2.0, 5.0)] {
        let (mut v, drags) = (before.clone(), vec![drag; cloud.len()]);
        let stiff = Stiff { scale, domain, place: &place, resist: &resist, drag: &drags, dt };
        let mut implicit = Implicit::default();
        implicit.solve::<WendlandC2>(&stiff, &lists, &mut v, 1e-3);
        assert!((2..120).contains(&implicit.steps), "{}", implicit.steps);
        let flow: Vec<[f32; 4]> = v.iter().zip(&resist).map(|(v, &r)| [v[0], v[1], v[2], r]).collect();
        let mut rubbed = Vec::new();
        sum_pairs(Rubbing::<WendlandC2>::new(&scale), [&place, &flow], &lists, (domain, scale.h_m), &mut rubbed);
        let (mut off, mut size, mut moved) = (0.0, 0.0, [0.0; 3]);
        for i in 0..v.len() {
            for axis in 0..3 {
                let left = before[i][axis] - v[i][axis] - dt * (rubbed[i][axis] + drag * v[i][axis]);
                off += f64::from(left * left);
                size += f64::from(before[i][axis] * before[i][axis]);
                moved[axis] += f64::from(v[i][axis] - before[i][axis]);
            }
        }
        assert!((off / size).sqrt() < 5e-3, "{}", (off / size).sqrt());
        assert!(drag > 0.0 || moved.iter().all(|moved| moved.abs() < 1e-2), "{moved:?}");
    }
}

#[test]
fn sums_of_terms_have_the_same_bits_on_narrow_registers() {
    let domain = Domain::default();
    let run = || {
        let (cloud, lists, resist) = unlike(domain);
        let scale = liquid::<WendlandC2>().scale;
        let [place, flow] = records(&cloud, &resist, &resist);
        let (mut a, mut b, space) = (Vec::new(), Vec::new(), (domain, scale.h_m));
        sum_pairs(Shear::<WendlandC2>::new(&scale), [&place, &flow], &lists, space, &mut a);
        sum_pairs(Drawn::<DesbrunGascuel>::new(&scale), [&place, &flow], &lists, space, &mut b);
        let bits: Vec<u32> = a.iter().flatten().chain(b.iter().flatten()).map(|v| v.to_bits()).collect();
        bits
    };
    let wide = run();
    wide::tests::NARROW.store(true, Ordering::Relaxed);
    let narrow = run();
    wide::tests::NARROW.store(false, Ordering::Relaxed);
    assert!(wide == narrow);
}

#[test]
fn a_shear_flow_has_its_rate_of_shear() {
    // v = (2·z, 0, 0): the rate is 2, also beside a surface.
    let mut cloud = block(12, 0.0);
    for i in 0..cloud.len() {
        (cloud.vx[i], cloud.vy[i], cloud.vz[i]) = (2.0 * cloud.z[i], 0.0, 0.0);
    }
    let domain = Domain { wrap_m: Some([12.0, 12.0]) };
    let (cloud, lists) = listed(cloud, 2.8, domain);
    let scale = liquid::<WendlandC2>().scale;
    let thin = vec![1.0; cloud.len()];
    let [place, flow] = records(&cloud, &thin, &thin);
    let mut sums = Vec::new();
    sum_pairs(Shear::<WendlandC2>::new(&scale), [&place, &flow], &lists, (domain, scale.h_m), &mut sums);
    for (i, sums) in sums.iter().enumerate() {
        let rate = shear_rate(sums);
        assert!((rate - 2.0).abs() < 1e-3, "{}: {rate}", cloud.z[i]);
    }
}
