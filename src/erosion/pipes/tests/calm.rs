//! Beds that change under water make no waves of their own.

use super::*;
use crate::noise::{Fbm, Key};

/// Fractal hills of some height above a level, one of many.
fn hills(key: u64, size: usize, cell_m: f64, edges: Edges, [base_m, height_m, wavelength_m]: [f64; 3]) -> Bed {
    let sum = Fbm::new(wavelength_m, 1.0).octaves(Key::new(key), cell_m);
    bed(size, size, cell_m, edges, |x, y| {
        (base_m + height_m * sum.value([x, y].map(|v| (v as f64 + 0.5) * cell_m))) as f32
    })
}

/// The greatest flow, m³/s, and speed, m/s, that ever show in a hundred looks.
fn peaks(params: PipesParams, mut bed: Bed) -> ([f32; 2], Bed) {
    let mut pipes = Pipes::new(params, &bed, None);
    let most = |values: Vec<f32>| values.into_iter().fold(0.0f32, f32::max);
    let (mut flow, mut speed) = (0.0f32, 0.0f32);
    for step in 0..100 {
        pipes.advance(&mut bed, Part { step, steps: 100 });
        (flow, speed) = (flow.max(most(pipes.discharge())), speed.max(most(pipes.speed())));
    }
    ([flow, speed], bed)
}

#[test]
fn a_river_carries_no_more_than_it_brings() {
    let spring = Spring { x_km: 0.75, y_km: 0.75, radius_m: 40.0, flow_m3_per_s: 12.0 };
    let river = PipesParams { duration_h: 0.7, rain_mm_per_h: 0.0, springs: vec![spring], ..Default::default() };
    for (key, flux) in [(1, Flux::Signed), (4, Flux::Signed), (4, Flux::Mei)] {
        let params = PipesParams { flux, ..river.clone() };
        let ([flow, speed], after) = peaks(params, hills(key, 96, 15.6, Edges::Open, [0.0, 80.0, 1500.0]));
        assert!(after.change.iter().any(|v| v.abs() > 3.0));
        assert!(flow > 3.0 && flow < 1.5 * 12.0 && speed < 10.0, "{key} {flux:?}: {flow} m3/s, {speed} m/s");
    }
}

#[test]
fn a_storm_carries_no_more_than_falls() {
    let params = PipesParams { duration_h: 0.5, ..Default::default() };
    let falls = (64.0f32 * 7.8) * (64.0 * 7.8) * 60.0 / 3.6e6;
    let ([flow, speed], _) = peaks(params, hills(9, 64, 7.8, Edges::Open, [0.0, 100.0, 400.0]));
    assert!(flow < falls && speed < 10.0, "{flow} m3/s of {falls}, {speed} m/s");
}

#[test]
fn steep_water_is_no_faster_than_its_waves_allow() {
    // A fall of one in one: by Manning alone 17 m/s.
    let mut bed = bed(200, 1, 10.0, Edges::Closed, |x, _| 10.0 * (200 - x) as f32);
    let mut pipes = Pipes::new(PipesParams { manning_n: 0.04, ..still() }, &bed, None);
    pipes.depth.fill(0.5);
    pipes.look();
    run(&mut pipes, &mut bed, 60.0, false);
    let v = pipes.flux[0][100] / pipes.depth[100];
    let wanted = 1.5 * (9.81f32 * 0.5).sqrt();
    assert!((v / wanted - 1.0).abs() < 0.01, "{v} {wanted}");
}

#[test]
fn a_pond_stays_level_while_its_bed_rises() {
    // A load settles in still water: the bed gets eighty times of it, and the surface rises by what was in the water.
    let mut bed = bed(16, 16, 5.0, Edges::Closed, |_, _| 0.0);
    let params = PipesParams { settle_per_s: 0.1, sea: false, ..PipesParams { slip_per_h: 0.0, ..still() } };
    let factor = params.morphological_factor as f32;
    let mut pipes = Pipes::new(params, &bed, None);
    pipes.depth.fill(3.0);
    pipes.load.fill(0.002);
    pipes.look();
    let stock = sum_f64(&pipes.depth);
    let moved = run(&mut pipes, &mut bed, 20.0, false);
    let laid = bed.change[100];
    assert!(laid > 0.05, "{laid}");
    let level = bed.height(100) + pipes.depth[100];
    assert!((level - 3.0 - laid / factor).abs() < 1e-5, "{level} {laid}");
    let kept = (sum_f64(&pipes.depth) - stock) * 25.0 + moved.water_left_m3 - moved.water_in_m3;
    assert!(kept.abs() < 1e-6 * stock * 25.0, "{kept}");
    assert!(pipes.flux.iter().flatten().all(|q| q.abs() < 1e-5));
}

#[test]
fn a_lake_rests_on_a_fractal_bed() {
    for flux in [Flux::Signed, Flux::Mei] {
        let mut bed = hills(9, 48, 5.0, Edges::Closed, [900.0, 8.0, 120.0]);
        let params =
            PipesParams { flux, recession: 1.0, slip_per_h: 0.0, evaporation_mm_per_h: 0.0, ..Default::default() };
        let mut pipes = Pipes::new(params, &bed, None);
        pipes.depth = bed.start.iter().map(|z| (903.0 - z).max(0.0)).collect();
        pipes.look();
        let most = pipes.depth.iter().fold(0.0f32, |a, &b| a.max(b));
        pipes.advance(&mut bed, Part { step: 0, steps: 20 });
        // Depths are good to half an ulp: falls of as much are seen, and waves of that height carry √(g·d) times it. Over
        // a few of them and two dimensions, four times.
        let ulp = most * f32::EPSILON;
        let flow = pipes.flux.iter().flatten().fold(0.0f32, |a, q| a.max(q.abs()));
        assert!(most > 5.0 && flow <= 4.0 * ulp * (9.81 * most).sqrt(), "{flux:?}: {flow:e} {ulp:e}");
        assert!(bed.change.iter().all(|&v| v == 0.0));
    }
}

#[test]
fn a_spring_in_the_sea_takes_no_time() {
    let mut sea = bed(64, 64, 8.0, Edges::Open, |x, y| rough(x, y) - 200.0);
    sea.sea_m = 0.0;
    let spring = Spring { x_km: 0.25, y_km: 0.25, radius_m: 0.0, flow_m3_per_s: 12.0 };
    let params = PipesParams { duration_h: 0.2, springs: vec![spring], ..Default::default() };
    assert_eq!(params.check(&sea.grid), Ok(()));
    let mut pipes = Pipes::new(params.clone(), &sea, None);
    let moved = pipes.advance(&mut sea, WHOLE);
    assert!(pipes.substeps() < 1000, "{}", pipes.substeps());
    let brought = 12.0 * 0.2 * 3600.0 * 0.85;
    let books = [moved.water_in_m3, moved.water_left_m3].map(|v| v / (brought + 60e-3 * 0.17 * 512.0 * 512.0) - 1.0);
    assert!(books.iter().all(|off| off.abs() < 1e-3), "{moved:?}");
    // What nobody would wait for is refused.
    let flood = Spring { flow_m3_per_s: 1e6, ..spring };
    let small = Grid { cell_m: 1.0, ..sea.grid };
    let flood = PipesParams { springs: vec![Spring { x_km: 0.03, y_km: 0.03, ..flood }], duration_h: 1.0, ..params };
    assert!(flood.check(&small).unwrap_err().contains("springs[0] wells up"));
}
