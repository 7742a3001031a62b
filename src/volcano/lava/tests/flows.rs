//! Pressure, viscosity, yield stress and ground.

use super::*;

const G: f64 = 9.80665;

/// A sheet on a plane tilted by an angle, in a world that wraps: what pulls it is turned, not the plane.
fn sheet(params: LavaParams, angle_deg: f64, layers: usize) -> (Flow, Land) {
    let grid = Grid::new(8, 8, 8.0, Edges::Wrap);
    let (mut flow, land) = cold(&params, &world(grid, |_, _| 0.0));
    let (sine, cosine) = (libm::sin(angle_deg.to_radians()), libm::cos(angle_deg.to_radians()));
    flow.gravity = [(G * sine) as f32, 0.0, (-G * cosine) as f32];
    let side = (8.0 / flow.law.spacing).round() as usize;
    fill(&mut flow, [0.0; 3], [side, side, layers], 0.0);
    (flow, land)
}

/// Mean speed of all and of the uppermost layer down the slope, m/s, with the thickness that the sheet then has.
fn speeds(flow: &Flow) -> (f64, f64, f64) {
    let (cloud, d) = (&flow.swarm.cloud, flow.law.spacing);
    let area = 64.0;
    let thick = cloud.len() as f64 * flow.law.volume_m3() / area;
    let mean = cloud.vx.iter().map(|&v| f64::from(v)).sum::<f64>() / cloud.len() as f64;
    let top: Vec<f64> =
        (0..cloud.len()).filter(|&i| f64::from(cloud.z[i]) > thick - d).map(|i| f64::from(cloud.vx[i])).collect();
    (mean, top.iter().sum::<f64>() / top.len() as f64, thick)
}

fn jeffreys(solver: Solver) {
    let viscosity_pa_s = 3e4;
    let params = LavaParams {
        spacing_m: 0.5,
        viscosity_pa_s,
        most_viscosity_pa_s: viscosity_pa_s,
        viscosity_solver: solver,
        ..LavaParams::default()
    };
    let (mut flow, land) = sheet(params, 20.0, 10);
    // Four times as long as it takes to tell the whole depth: H²·4/(π²·ν) = 0.9 s.
    flow_for(&mut flow, &land, 4.0);
    let (mean, top, thick) = speeds(&flow);
    let pull = G * libm::sin(20f64.to_radians()) * 2600.0 / viscosity_pa_s;
    let flux = pull * thick * thick * thick / 3.0;
    // The uppermost layer lies half a spacing under the surface.
    let low = thick - 0.25;
    let surface = pull * (thick * low - 0.5 * low * low);
    assert!((mean * thick / flux - 1.0).abs() < 0.05, "{solver:?}: flux {} for {flux}", mean * thick);
    assert!((top / surface - 1.0).abs() < 0.05, "{solver:?}: {top} for {surface}");
}

#[test]
fn a_sheet_on_a_slope_flows_as_jeffreys_says() {
    jeffreys(Solver::Explicit);
}

#[test]
fn a_sheet_solved_for_at_once_flows_alike() {
    jeffreys(Solver::Implicit);
}

#[test]
fn below_its_yield_stress_a_sheet_stops() {
    // τ = ρ·g·H·sin α = 43.6 kPa at the foot of 5 m.
    let at = |yield_pa: f64| {
        let params = LavaParams {
            spacing_m: 0.5,
            viscosity_pa_s: 2e4,
            most_viscosity_pa_s: 2e4,
            yield_pa,
            yield_per_k: 0.0,
            yield_sharpness_s: 30.0,
            ..LavaParams::default()
        };
        let (mut flow, land) = sheet(params, 20.0, 10);
        flow_for(&mut flow, &land, 4.0);
        speeds(&flow).1
    };
    let (free, stuck, half) = (at(0.0), at(60e3), at(20e3));
    assert!(stuck < 0.02 * free, "{stuck} of {free}");
    // Bingham: the plug rides on a layer of H − τ_y/(ρ·g·sin α).
    let pull = G * libm::sin(20f64.to_radians()) * 2600.0;
    let layer = 5.0 - 20e3 / pull;
    let plug = pull * layer * layer / (2.0 * 2e4);
    assert!((half / plug - 1.0).abs() < 0.1, "{half} for {plug}");
}

/// How much of the weight above it lava carries, and how high it stands: the mean over some ten swings of the column, which
/// only slowly comes to rest.
fn carried(smoothing: f64) -> (f64, f64) {
    let grid = Grid::new(8, 8, 8.0, Edges::Wrap);
    let params =
        LavaParams { spacing_m: 0.5, smoothing, viscosity_pa_s: 5e3, viscosity_per_k: 0.0, ..LavaParams::default() };
    let (mut flow, land) = cold(&params, &world(grid, |_, _| 0.0));
    fill(&mut flow, [0.0; 3], [16, 16, 16], 0.05);
    flow_for(&mut flow, &land, 1.5);
    let (mut sums, mut top) = ([0.0; 2], 0.0);
    for _ in 0..48 {
        flow_for(&mut flow, &land, 0.05);
        let sound2 = flow.sound * flow.sound;
        let mut order: Vec<usize> = (0..flow.swarm.len()).collect();
        order.sort_by(|&a, &b| flow.swarm.cloud.z[b].total_cmp(&flow.swarm.cloud.z[a]));
        for (higher, &i) in order.iter().enumerate() {
            // What weighs on it: all that is higher, over the area.
            let depth = (higher as f64 + 0.5) * flow.law.volume_m3() / 64.0;
            if depth > 1.5 {
                sums[0] += sound2 * f64::from(flow.density()[i] - 1.0) * depth;
                sums[1] += depth * depth;
            }
        }
        top += (f64::from(flow.swarm.cloud.z[order[0]]) + 0.25) / 48.0;
    }
    (sums[0] / sums[1] / G, top)
}

#[test]
fn a_column_carries_its_weight() {
    for smoothing in [1.3, 1.6] {
        let (share, top) = carried(smoothing);
        eprintln!("{smoothing}: {share} {top}");
        assert!((share - 1.0).abs() < 0.05, "{smoothing}: {share}");
        assert!((top - 8.0).abs() < 0.25, "{smoothing}: {top}");
    }
}

#[test]
fn a_heap_spreads_as_huppert_says() {
    // A volume V on a plane: R = 0.894·(g·V³/(3ν))^(1/8)·t^(1/8).
    let grid = Grid::new(60, 60, 60.0, Edges::Closed);
    let (viscosity_pa_s, d) = (6e4, 0.8);
    let params =
        LavaParams { spacing_m: d, viscosity_pa_s, most_viscosity_pa_s: viscosity_pa_s, ..LavaParams::default() };
    let (mut flow, land) = cold(&params, &world(grid, |_, _| 0.0));
    fill(&mut flow, [30.0 - 10.0 * d, 30.0 - 10.0 * d, 0.0], [20, 20, 10], 0.05);
    let volume = flow.swarm.len() as f64 * flow.law.volume_m3();
    let spread = |flow: &Flow| {
        let r2 = |i: usize| {
            let (x, y) = (f64::from(flow.swarm.cloud.x[i]) - 30.0, f64::from(flow.swarm.cloud.y[i]) - 30.0);
            x * x + y * y
        };
        let mean = (0..flow.swarm.len()).map(r2).sum::<f64>() / flow.swarm.len() as f64;
        // The profile (1 − r²/R²)^(1/3) has a mean square radius of 3/7 R².
        (7.0 / 3.0 * mean).sqrt()
    };
    let want = |t: f64| 0.894 * libm::pow(G * volume * volume * volume / (3.0 * viscosity_pa_s / 2600.0) * t, 0.125);
    flow_for(&mut flow, &land, 10.0);
    let early = spread(&flow);
    flow_for(&mut flow, &land, 30.0);
    let late = spread(&flow);
    let power = libm::log(late / early) / libm::log(4.0);
    assert!((late / want(40.0) - 1.0).abs() < 0.1, "{late} for {}", want(40.0));
    // It began as a block and not as a point: a little slower than 1/8 at first.
    assert!((power - 0.125).abs() < 0.03, "{power}");
}

#[test]
fn momentum_is_kept_where_temperatures_differ() {
    let grid = Grid::new(40, 40, 40.0, Edges::Open);
    for solver in [Solver::Explicit, Solver::Implicit] {
        let params = LavaParams {
            spacing_m: 1.0,
            gravity: false,
            ground: Contact::Off,
            viscosity_pa_s: 1e4,
            viscosity_solver: solver,
            ..LavaParams::default()
        };
        let (mut flow, land) = cold(&params, &world(grid, |_, _| 0.0));
        fill(&mut flow, [15.0, 15.0, 5.0], [9, 9, 9], 0.3);
        let mut stream = Key::new(9).stream();
        for i in 0..flow.swarm.len() {
            flow.swarm.load[i] = flow.law.enthalpy(stream.between(1000.0, 1150.0));
            flow.swarm.cloud.vx[i] = stream.between(-1.0, 1.5) as f32;
            flow.swarm.cloud.vz[i] = stream.between(-1.0, 1.0) as f32;
        }
        let sum = |flow: &Flow| {
            [&flow.swarm.cloud.vx, &flow.swarm.cloud.vy, &flow.swarm.cloud.vz]
                .map(|v| v.iter().map(|&v| f64::from(v)).sum::<f64>())
        };
        let size: f64 = flow.swarm.cloud.vx.iter().map(|&v| f64::from(v.abs())).sum();
        let before = sum(&flow);
        flow_for(&mut flow, &land, 0.5);
        let after = sum(&flow);
        // Single precision: 1e-7 of what is exchanged, in some hundred steps.
        let most = 1e-5;
        for axis in 0..3 {
            assert!((after[axis] - before[axis]).abs() < most * size, "{solver:?} {axis}: {before:?} {after:?} {size}");
        }
    }
}

#[test]
fn pressure_alone_keeps_a_plane_a_plane() {
    // The document's first scene: particles on a plane, nothing but pressure.
    let grid = Grid::new(40, 40, 40.0, Edges::Open);
    let params = LavaParams {
        spacing_m: 0.5,
        gravity: false,
        ground: Contact::Off,
        viscosity: Viscosity::Off,
        stiffness_m2_per_s2: 100.0,
        mass: super::super::Mass::Document,
        kernel: super::super::Smoothing::Desbrun,
        ..LavaParams::default()
    };
    let (mut flow, land) = cold(&params, &world(grid, |_, _| 0.0));
    fill(&mut flow, [17.0, 17.0, 5.0], [12, 12, 1], 0.0);
    let spread = |flow: &Flow| flow.swarm.cloud.x.iter().fold(0.0f32, |a, &x| a.max((x - 20.0).abs()));
    let before = spread(&flow);
    flow_for(&mut flow, &land, 1.0);
    assert!(flow.swarm.cloud.z.iter().all(|&z| z == 5.25) && spread(&flow) > 1.2 * before, "{}", spread(&flow));
    // And with viscosity it moves in blocks: neighbours go alike.
    let mut rubbing = params.clone();
    (rubbing.viscosity, rubbing.temperature_degc) = (Viscosity::Document, 1200.0);
    let (mut slow, land) = cold(&rubbing, &world(grid, |_, _| 0.0));
    fill(&mut slow, [17.0, 17.0, 5.0], [12, 12, 1], 0.0);
    flow_for(&mut slow, &land, 1.0);
    assert!(slow.swarm.cloud.z.iter().all(|&z| z == 5.25) && spread(&slow) < spread(&flow));
}

#[test]
fn lava_stays_on_the_ground_or_falls_through_none() {
    let grid = Grid::new(30, 30, 30.0, Edges::Closed);
    let ground = |x: f64, _: f64| 0.3 * x;
    for contact in [Contact::Stick, Contact::Slip, Contact::Document] {
        let params = LavaParams { spacing_m: 0.5, ground: contact, ..LavaParams::default() };
        let (mut flow, land) = cold(&params, &world(grid, ground));
        fill(&mut flow, [20.0, 12.0, 8.0], [6, 6, 6], 0.1);
        flow_for(&mut flow, &land, 3.0);
        let least = (0..flow.swarm.len())
            .map(|i| land.mesh.foot(flow.swarm.cloud.x[i], flow.swarm.cloud.y[i]).gap(flow.swarm.cloud.z[i]))
            .fold(f32::INFINITY, f32::min);
        let middle = flow.swarm.cloud.x.iter().sum::<f32>() / flow.swarm.len() as f32;
        assert!(least > -1e-3 && (contact != Contact::Stick || least > 0.2), "{contact:?}: {least}");
        assert!(middle < 21.5, "{contact:?}: {middle}");
    }
    let params = LavaParams {
        spacing_m: 0.5,
        ground: Contact::Off,
        pressure: false,
        viscosity: Viscosity::Off,
        ..LavaParams::default()
    };
    let (mut flow, land) = cold(&params, &world(grid, ground));
    fill(&mut flow, [20.0, 12.0, 8.0], [2, 2, 2], 0.0);
    flow_for(&mut flow, &land, 2.0);
    // ½·g·t² = 19.6 m.
    assert!((f64::from(flow.swarm.cloud.z[0]) - (8.25 - 0.5 * G * 4.0)).abs() < 0.2, "{}", flow.swarm.cloud.z[0]);
}

#[test]
fn hot_lava_runs_further_than_cold() {
    let grid = Grid::new(40, 20, 40.0, Edges::Closed);
    let far = |degc: f64| {
        let params = LavaParams { spacing_m: 0.7, viscosity_pa_s: 2e3, ..LavaParams::default() };
        let (mut flow, land) = cold(&params, &world(grid, |x, _| 0.2 * (40.0 - x)));
        fill(&mut flow, [6.0, 7.0, 7.0], [8, 8, 4], 0.1);
        let heat = flow.law.enthalpy(degc);
        flow.swarm.load.fill(heat);
        flow_for(&mut flow, &land, 6.0);
        flow.swarm.cloud.x.iter().sum::<f32>() / flow.swarm.len() as f32
    };
    let (hot, cold) = (far(1150.0), far(1020.0));
    assert!(hot > cold + 1.0, "{hot} {cold}");
}

#[test]
fn threads_give_the_same_bits() {
    let grid = Grid::new(30, 30, 30.0, Edges::Open);
    let params = LavaParams {
        spacing_m: 0.6,
        yield_pa: 500.0,
        viscosity_solver: Solver::Implicit,
        cooling_factor: 100.0,
        schedule: vec![Timed::particles(0.0, 2.0, 400.0)],
        ..LavaParams::default()
    };
    let run = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let mut own =
                eruption(&params, &world(grid, |x, y| 8.0 - 0.02 * ((x - 15.0).powi(2) + (y - 15.0).powi(2))));
            own.run(0.0, 2.0).unwrap();
            let heat: Vec<u64> = own.flow.swarm.load.iter().map(|v| v.to_bits()).collect();
            let rest: Vec<u32> = own.flow.swarm.cloud.arrays().into_iter().flatten().map(|v| v.to_bits()).collect();
            (heat, rest, own.counts())
        })
    };
    let one = run(1);
    assert!(one.0.len() > 300 && one == run(2) && one == run(8));
}
