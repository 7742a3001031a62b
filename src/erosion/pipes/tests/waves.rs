//! Water over a bed that does not change.

use super::*;

/// Depths for `pipes` to start from.
fn fill(pipes: &mut Pipes, bed: &Bed, depth: impl Fn(usize) -> f32) {
    pipes.depth = (0..bed.grid.width * bed.grid.height).map(|i| depth(i % bed.grid.width)).collect();
    pipes.look();
}

#[test]
fn a_lake_rests() {
    for flux in [Flux::Signed, Flux::Mei] {
        let mut bed = bed(24, 20, 5.0, Edges::Closed, |x, y| 900.0 + ((x * 7 + y * 13) % 32) as f32 / 4.0);
        let params =
            PipesParams { flux, recession: 1.0, slip_per_h: 0.0, evaporation_mm_per_h: 0.0, ..Default::default() };
        let mut pipes = Pipes::new(params, &bed, None);
        pipes.depth = bed.start.iter().map(|z| (905.0 - z).max(0.0)).collect();
        let before = pipes.depth.clone();
        pipes.look();
        let moved = pipes.advance(&mut bed, Part { step: 0, steps: 50 });
        assert_eq!(moved, Moved::default());
        assert!(pipes.flux.iter().flatten().all(|q| q.abs() <= 1e-12) && pipes.depth == before);
        assert!(bed.change.iter().all(|&v| v == 0.0));
    }
}

#[test]
fn a_closed_box_keeps_its_water() {
    let mut bed = bed(40, 30, 8.0, Edges::Closed, rough);
    let mut pipes = Pipes::new(PipesParams { manning_n: 0.03, ..still() }, &bed, None);
    fill(&mut pipes, &bed, |x| if x < 15 { 4.0 } else { 0.0 });
    let before = sum_f64(&pipes.depth);
    let moved = run(&mut pipes, &mut bed, 600.0, false);
    let made = moved.water_in_m3 / 64.0;
    // Asked for is 1e-12 a step in double precision. In single precision each cell rounds its depth to 6e-8 of it once a
    // step, up or down alike: after the 1000 steps here a random walk of 6e-8·√1000 = 2e-6 of a cell, and over 1200 cells a
    // 35th of that; what rounding made is booked to the last bit besides, so that only the sums' own rounding stays.
    assert!((sum_f64(&pipes.depth) - before - made).abs() < 2e-6 * before, "{}", sum_f64(&pipes.depth) - before);
    assert!(made < 1e-6 * before);
}

/// A step of 4 % of the depth after it has gone a thousand cells either way: where its front is, of the way it should have
/// gone, and how far the depth between the fronts (over the jump) and the speed there (over that of the theory) are off.
fn small_step(courant: f64) -> [f64; 3] {
    // A thousand cells, so that the ripples behind the fronts stay near them.
    const REACH: f64 = 10_000.0;
    let (d0, n) = (10.0f32, 3200);
    let mut bed = bed(n, 1, 10.0, Edges::Closed, |_, _| 0.0);
    let mut pipes = Pipes::new(still(), &bed, None);
    // A front of a few cells: waves of two cells would stay behind as ripples.
    fill(&mut pipes, &bed, |x| d0 * (1.0 - 0.02 * libm::tanhf((x as f32 + 0.5 - n as f32 / 2.0) / 4.0)));
    pipes.courant = courant;
    let c = (9.81 * d0 as f64).sqrt();
    run(&mut pipes, &mut bed, REACH / c, false);
    let jump = 0.04 * d0;
    let at = |x: usize| (x as f64 - n as f64 / 2.0 + 0.5) * 10.0;
    let u = pipes.velocity(0);
    let (mut uneven, mut wrong) = (0.0f64, 0.0f64);
    for x in (0..n).filter(|&x| at(x).abs() < 0.7 * REACH) {
        uneven = uneven.max(((pipes.depth[x] - d0) / jump).abs() as f64);
        wrong = wrong.max((u[x] as f64 / (0.02 * c) - 1.0).abs());
    }
    // A front is where half of its change has come.
    let front = (n / 2..n).find(|&x| pipes.depth[x] < d0 - 0.25 * jump).map_or(0.0, at);
    [front / REACH, uneven, wrong]
}

#[test]
fn a_small_step_runs_at_the_root_of_g_d() {
    // In one dimension steps may be longer by the root of two, and ripples are then the least; and as it ships.
    for courant in [0.95 * std::f64::consts::SQRT_2, 0.9] {
        let [front, uneven, wrong] = small_step(courant);
        assert!((front - 1.0).abs() < 0.03, "{courant}: {front}");
        assert!(uneven < 0.01 && wrong < 0.02, "{courant}: {uneven} {wrong}");
    }
}

#[test]
fn a_standing_wave_has_its_period() {
    let (n, cell, d0) = (64usize, 10.0, 5.0f32);
    let length = n as f64 * cell;
    let wanted = 2.0 * length / (9.81 * d0 as f64).sqrt();
    let period = |flux, courant| {
        let mut bed = bed(n, 1, cell, Edges::Closed, |_, _| 0.0);
        let mut pipes = Pipes::new(PipesParams { flux, ..still() }, &bed, None);
        pipes.courant = courant;
        fill(&mut pipes, &bed, |x| d0 + 0.01 * libm::cosf(std::f32::consts::PI * (x as f32 + 0.5) / n as f32));
        let (mut now, mut last, mut crossings) = (0.0, 0.01, Vec::new());
        while crossings.len() < 4 {
            let dt = pipes.limit(false);
            pipes.substep(&mut bed, dt, false, &mut Moved::default());
            let here = (pipes.depth[0] - d0) as f64;
            if here * last < 0.0 {
                crossings.push(now + dt * last / (last - here));
            }
            (now, last) = (now + dt, here);
        }
        crossings[2] - crossings[0]
    };
    for courant in [0.3, 0.9] {
        let ratio = period(Flux::Signed, courant) / wanted;
        assert!((ratio - 1.0).abs() < 0.02, "{courant}: {ratio}");
        let mei = period(Flux::Mei, courant) / wanted;
        assert!((mei - 0.707).abs() < 0.02, "{courant}: {mei}");
    }
}

#[test]
fn the_limit_of_a_step_is_where_it_is_said_to_be() {
    let swing = |courant: f64| {
        let mut bed = bed(16, 16, 10.0, Edges::Wrap, |_, _| 0.0);
        let mut pipes = Pipes::new(still(), &bed, None);
        pipes.courant = courant;
        // The shortest wave in both directions: the first to grow.
        let check = |i: usize| if (i % 16 + i / 16).is_multiple_of(2) { 1e-3 } else { -1e-3 };
        pipes.depth = (0..256).map(|i| 2.0 + check(i)).collect();
        pipes.look();
        let dt = pipes.limit(false);
        for _ in 0..300 {
            pipes.substep(&mut bed, dt, false, &mut Moved::default());
        }
        pipes.depth.iter().map(|d| (d - 2.0).abs()).fold(0.0, f32::max)
    };
    assert!(swing(0.9) < 3e-3, "{}", swing(0.9));
    assert!(swing(1.2) > 0.1, "{}", swing(1.2));
}

#[test]
fn a_dam_breaks_as_ritter_says() {
    let (n, cell, d0, t) = (800usize, 5.0, 10.0f64, 60.0);
    let error = |momentum| {
        let mut bed = bed(n, 1, cell, Edges::Closed, |_, _| 0.0);
        let mut pipes = Pipes::new(PipesParams { momentum, ..still() }, &bed, None);
        fill(&mut pipes, &bed, |x| if x < n / 2 { d0 as f32 } else { 0.0 });
        run(&mut pipes, &mut bed, t, false);
        let c = (9.81 * d0).sqrt();
        let exact = |x: usize| {
            let s = ((x as f64 + 0.5) - n as f64 / 2.0) * cell / t;
            if s < -c {
                d0
            } else if s > 2.0 * c {
                0.0
            } else {
                (2.0 * c - s) * (2.0 * c - s) / (9.0 * 9.81)
            }
        };
        let off: f64 = (0..n).map(|x| (pipes.depth[x] as f64 - exact(x)).abs()).sum();
        let inside: f64 = (0..n).map(exact).sum();
        off / inside
    };
    let (with, without) = (error(true), error(false));
    assert!(with < 0.015 && without > 3.0 * with, "{with} {without}");
}

#[test]
fn an_even_slope_has_mannings_speed() {
    for (slope, depth, n) in [(0.01f32, 0.5f32, 0.03f64), (0.1, 0.05, 0.05), (0.002, 2.0, 0.04)] {
        // A long plane whose middle knows nothing of its ends, at a depth that stays.
        let mut bed = bed(300, 3, 10.0, Edges::Closed, |x, _| 300.0 * 10.0 * slope - slope * 10.0 * x as f32);
        let mut pipes = Pipes::new(PipesParams { manning_n: n, ..still() }, &bed, None);
        fill(&mut pipes, &bed, |_| depth);
        let wanted = (depth as f64).powf(2.0 / 3.0) * (slope as f64).sqrt() / n;
        run(&mut pipes, &mut bed, 600.0 / wanted, false);
        let v = pipes.velocity(0)[450] as f64;
        assert!((v / wanted - 1.0).abs() < 0.03, "{slope} {depth}: {v} {wanted}");
    }
}

#[test]
fn rain_on_a_plane_leaves_as_it_falls() {
    let mut bed = bed(60, 5, 5.0, Edges::Open, |x, _| 30.0 - 0.02 * 5.0 * x as f32);
    let mut pipes = Pipes::new(PipesParams { rain_mm_per_h: 50.0, manning_n: 0.03, ..still() }, &bed, None);
    run(&mut pipes, &mut bed, 7200.0, true);
    let moved = run(&mut pipes, &mut bed, 1800.0, true);
    let fell = 50.0 / 3.6e6 * 1800.0 * 60.0 * 5.0 * 25.0;
    assert!((moved.water_in_m3 / fell - 1.0).abs() < 1e-3, "{moved:?} {fell}");
    assert!((moved.water_left_m3 / fell - 1.0).abs() < 1e-3, "{} {fell}", moved.water_left_m3);
}

#[test]
fn a_river_brings_what_it_says_and_stands_on_the_map() {
    let mut bed = bed(30, 30, 7.0, Edges::Closed, |_, _| 0.0);
    let spring = Spring { x_km: 0.1, y_km: 0.08, radius_m: 17.0, flow_m3_per_s: 12.0 };
    let params = PipesParams { springs: vec![spring], ..still() };
    assert_eq!(params.check(&bed.grid), Ok(()));
    let mut pipes = Pipes::new(params.clone(), &bed, None);
    run(&mut pipes, &mut bed, 100.0, true);
    let volume = sum_f64(&pipes.depth) * 49.0;
    assert!((volume / 1200.0 - 1.0).abs() < 1e-4, "{volume}");
    let off = PipesParams { springs: vec![Spring { x_km: 3.0, ..spring }], ..params };
    assert!(off.check(&bed.grid).unwrap_err().contains("springs[0]"));
}
