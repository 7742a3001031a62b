//! What the automaton must do: keep the books, keep symmetry, and come to the same bits however it is shared out.

use proptest::prelude::*;

use super::{super::bed::Coast, *};
use crate::{
    grid::{Edges, Field},
    noise::{Fbm, Key},
};

fn bed(grid: Grid, f: impl Fn(f64, f64) -> f64 + Sync) -> Bed {
    let start = Field::from_fn(grid, |x, y| {
        let [x, y] = grid.center_m(x, y);
        f(x, y) as f32
    });
    Bed { sea_m: -1e5, ..Bed::new(grid, start.data) }
}

fn hills(size: usize, cell_m: f64, edges: Edges) -> Bed {
    let octaves = Fbm::new(40.0 * cell_m, 0.9).octaves(Key::new(9), cell_m);
    let grid = Grid { width: size + 3, height: size, cell_m, edges };
    bed(grid, |x, y| 300.0 + 8.0 * cell_m * octaves.value([x, y]))
}

/// Some iterations of the default storm.
fn storm(grid: &Grid, iterations: f64) -> HydraulicCellsParams {
    let params = HydraulicCellsParams::default();
    HydraulicCellsParams { duration_h: iterations * grid.cell_m / (3600.0 * params.flow_m_per_s), ..params }
}

/// Runs a whole stage; bed, what moved, and what was on its way before it settled.
fn run(params: &HydraulicCellsParams, bed: &mut Bed, steps: u64) -> (Moved, f64) {
    let mut cells = HydraulicCells::new(params, &bed.grid);
    let mut sum = Moved::default();
    for step in 0..steps {
        let moved = cells.advance(bed, Part { step, steps });
        sum.rock_left_m3 += moved.rock_left_m3;
        sum.water_in_m3 += moved.water_in_m3;
        sum.water_left_m3 += moved.water_left_m3;
    }
    let carried = cells.carried_m3();
    cells.settle(bed);
    assert_eq!(cells.carried_m3(), 0.0);
    (sum, carried)
}

fn sum(values: &[f32]) -> f64 {
    values.iter().map(|&v| v as f64).sum()
}

#[test]
fn rock_is_kept_whatever_the_rim() {
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        let mut bed = hills(60, 8.0, edges);
        let area = bed.grid.cell_area_m2();
        let params = storm(&bed.grid, 300.0);
        let mut cells = HydraulicCells::new(&params, &bed.grid);
        let moved = cells.advance(&mut bed, Part { step: 0, steps: 1 });
        let worked: f64 = bed.change.iter().map(|v| v.abs() as f64).sum();
        assert!(worked > 100.0, "{edges:?}: nothing happened");
        let error = |bed: &Bed, carried: f64| (sum(&bed.change) + (carried + moved.rock_left_m3) / area) / worked;
        let before = error(&bed, cells.carried_m3());
        assert!(before.abs() < 1e-6, "{edges:?}: {before:e}");
        cells.settle(&mut bed);
        let after = error(&bed, cells.carried_m3());
        assert!(after.abs() < 1e-6, "{edges:?}: {after:e} after it settled");
        assert_eq!(moved.rock_left_m3 > 0.0, edges == Edges::Open, "{edges:?}");
        // What has not left stands on the ground, and goes on to.
        let stands = sum(&cells.water) * area;
        assert!(stands > 0.0 && ((moved.water_left_m3 + stands) / moved.water_in_m3 - 1.0).abs() < 1e-9);
        assert!(cells.discharge().iter().all(|&q| q >= 0.0) && cells.discharge().iter().any(|&q| q > 0.01));
    }
}

/// Fast water passes its load through a thousand cells: in single precision alone, that lost 7e-6 of what it moved.
#[test]
fn rock_is_kept_however_far_it_goes() {
    let mut bed = hills(64, 8.0, Edges::Open);
    let params = HydraulicCellsParams {
        flow_m_per_s: 10.0,
        morphological_factor: 1000.0,
        duration_h: 1.0,
        ..Default::default()
    };
    let (moved, _) = run(&params, &mut bed, 4);
    let worked: f64 = bed.change.iter().map(|v| v.abs() as f64).sum();
    let error = sum(&bed.change) + moved.rock_left_m3 / bed.grid.cell_area_m2();
    assert!(worked > 1.0 && error.abs() < 1e-10 * worked, "{error:e} of {worked:e}");
}

#[test]
fn a_closed_bowl_holds_what_rains_less_what_dries_up() {
    let grid = Grid { width: 48, height: 48, cell_m: 5.0, edges: Edges::Closed };
    let mut bed = bed(grid, |x, y| 0.002 * ((x - 120.0).powi(2) + (y - 120.0).powi(2)));
    let params = storm(&grid, 401.0);
    let mut cells = HydraulicCells::new(&params, &grid);
    let moved = cells.advance(&mut bed, Part { step: 0, steps: 2 });
    let iterations = (moved.water_in_m3 / (cells.law.rain_m as f64 * 48.0 * 48.0 * 25.0)).round();
    assert_eq!(iterations, 201.0);
    // w' = w·k + r from 0: a geometric series.
    let (rain, kept) = (cells.law.rain_m as f64, cells.law.kept as f64);
    let want = rain * (1.0 - kept.powi(201)) / (1.0 - kept) * 48.0 * 48.0;
    assert!((sum(&cells.water) / want - 1.0).abs() < 1e-5, "{} {want}", sum(&cells.water));
    let load: f64 = cells.load.iter().sum();
    let rock = sum(&bed.change) + load;
    assert!(rock.abs() < 1e-12 * load, "{rock:e}");
    // The water stands in the middle.
    assert!(cells.water[24 * 48 + 24] > 100.0 * cells.water[2 * 48 + 2]);
}

#[test]
fn a_symmetric_bowl_stays_symmetric() {
    let grid = Grid { width: 41, height: 41, cell_m: 10.0, edges: Edges::Open };
    let mut bed = bed(grid, |x, y| 0.001 * ((x - 205.0).powi(2) + (y - 205.0).powi(2)));
    HydraulicCells::new(&storm(&grid, 200.0), &grid).advance(&mut bed, Part { step: 0, steps: 1 });
    let at = |x: usize, y: usize| bed.change[y * 41 + x];
    let largest = bed.change.iter().fold(0.0f32, |m, v| m.max(v.abs()));
    assert!(largest > 0.1, "{largest}");
    for y in 0..41 {
        for x in 0..41 {
            for other in [at(40 - x, y), at(x, 40 - y), at(y, x)] {
                assert_eq!(at(x, y), other, "{x} {y}");
            }
        }
    }
}

#[test]
fn flat_ground_stays_as_it_is() {
    for edges in [Edges::Closed, Edges::Wrap] {
        let mut bed = bed(Grid { width: 20, height: 12, cell_m: 30.0, edges }, |_, _| 812.5);
        run(&storm(&bed.grid, 50.0), &mut bed, 2);
        assert!(bed.change.iter().all(|&v| v == 0.0));
    }
}

#[test]
fn spikes_and_pits_stay_bounded() {
    for top in [500.0f32, -500.0] {
        let mut bed = bed(Grid { width: 31, height: 31, cell_m: 10.0, edges: Edges::Open }, |x, y| 0.1 * (x + y));
        bed.start[15 * 31 + 15] += top;
        let (low, high) = Field { grid: bed.grid, data: bed.start.clone() }.range().unwrap();
        run(&storm(&bed.grid, 300.0), &mut bed, 3);
        let heights: Vec<f32> = (0..bed.start.len()).map(|i| bed.height(i)).collect();
        let (lowest, highest) = Field { grid: bed.grid, data: heights }.range().unwrap();
        assert!(highest <= high + 0.01, "{highest} above {high}");
        // The ground beyond the corner lies 2 m below it.
        assert!(lowest >= low - 2.01, "{lowest} below {low}");
        let spike = bed.change[15 * 31 + 15];
        // A spike has but its own rain; a pit has that of all around it.
        assert!(if top > 0.0 { spike < -0.01 } else { spike > 1.0 }, "{spike}");
    }
}

#[test]
fn water_does_not_prefer_an_axis() {
    // A cone: what a ring of it loses along the axes and along the diagonals.
    let grid = Grid { width: 101, height: 101, cell_m: 10.0, edges: Edges::Open };
    let mut bed = bed(grid, |x, y| 600.0 - 0.5 * ((x - 505.0).powi(2) + (y - 505.0).powi(2)).sqrt());
    run(&storm(&grid, 100.0), &mut bed, 1);
    let ring = |diagonal: bool| {
        let (mut sum, mut cells) = (0.0, 0);
        for y in 0..101i32 {
            for x in 0..101i32 {
                let (dx, dy) = ((x - 50) as f64, (y - 50) as f64);
                let (far, turn) = (dx.hypot(dy), (dy.abs().atan2(dx.abs()).to_degrees() - 45.0).abs());
                if (20.0..40.0).contains(&far) && (turn < 22.5) == diagonal {
                    (sum, cells) = (sum + bed.change[(y * 101 + x) as usize] as f64, cells + 1);
                }
            }
        }
        sum / cells as f64
    };
    let (axes, diagonals) = (ring(false), ring(true));
    assert!(axes < -1e-4 && (axes / diagonals - 1.0).abs() < 0.1, "{axes} {diagonals}");
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_after_a_restart() {
    let worn = |threads: usize, restart: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut bed = hills(90, 8.0, Edges::Open);
            let params = storm(&bed.grid, 61.0);
            let mut cells = HydraulicCells::new(&params, &bed.grid);
            for step in 0..4 {
                if restart {
                    let saved = cells.save();
                    cells = HydraulicCells::new(&params, &bed.grid);
                    let field = |name: &str| saved.fields.iter().find(|f| f.0 == name).map(|f| f.1.clone());
                    cells.restore(&field, &saved.blob).unwrap();
                }
                cells.advance(&mut bed, Part { step, steps: 4 });
            }
            cells.settle(&mut bed);
            bed.change.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        })
    };
    let one = worn(1, false);
    assert!(one == worn(2, false) && one == worn(8, true));
}

#[test]
fn every_width_of_vectors_gives_the_same_bits() {
    let mut stream = Key::new(5).stream();
    let mut some = |size: usize, most: f64| (0..size).map(|_| (most * stream.unit()) as f32).collect::<Vec<_>>();
    let (width, stride) = (77, 79);
    let [level, flow, drift] = [90.0, 0.1, 0.1].map(|most| some(3 * stride, most));
    let [water, load, start, rate] = [2.0, 1.0, 90.0, 1.0].map(|most| some(width, most));
    let grid = Grid { width, height: 1, cell_m: 8.0, edges: Edges::Open };
    let params = HydraulicCellsParams { steepness: Steepness::HardCliffs, ..Default::default() };
    let law = Law { coast: Coast { sea_m: 20.0, margin_m: 0.5 }, locked: true, ..params.law(&grid) };
    let run = |wide: bool| {
        let [mut a, mut b, mut change] = [vec![0.0; width], vec![0.0; width], vec![0.0; width]];
        let mut water = water.clone();
        let mut load: Vec<f64> = load.iter().map(|&load| f64::from(load)).collect();
        let leave = if wide { passes::leave } else { passes::leave_body };
        leave(Around::of(&level, 0, stride), &mut a, &mut b, &mut water, &mut load);
        let arrive = if wide { passes::arrive } else { passes::arrive_body };
        let around = [&level, &flow, &drift].map(|data| Around::of(data, 0, stride));
        arrive(&law, around, [&start, &rate], &mut a, &mut water, &mut load, &mut change);
        let load = load.iter().map(|v| v.to_bits());
        [a, b, change, water].concat().iter().map(|v| u64::from(v.to_bits())).chain(load).collect::<Vec<_>>()
    };
    assert!(run(true) == run(false));
}

#[test]
fn land_stays_land_and_the_sea_takes_what_comes() {
    let mut bed = hills(60, 8.0, Edges::Closed);
    bed.sea_m = 300.0;
    let mut free = bed.clone();
    let params = HydraulicCellsParams { morphological_factor: 1e5, ..storm(&bed.grid, 300.0) };
    (bed.locked, bed.margin_m) = (true, 0.01);
    run(&params, &mut bed, 3);
    let land = |bed: &Bed, i: usize| bed.height(i) >= bed.sea_m;
    assert!((0..bed.start.len()).all(|i| land(&bed, i) == (bed.start[i] >= 300.0)));
    // Nor does any height come nearer than the margin.
    assert!((0..bed.start.len()).all(|i| bed.change[i] == 0.0 || (bed.height(i) - 300.0).abs() >= 0.009));
    let sea: f64 = (0..bed.start.len()).filter(|&i| bed.start[i] < 300.0).map(|i| bed.change[i] as f64).sum();
    assert!(sea > 1.0, "the sea took {sea} m");
    run(&params, &mut free, 3);
    assert!((0..free.start.len()).any(|i| land(&free, i) != (free.start[i] >= 300.0)), "the lock did nothing");
}

#[test]
fn hard_ground_is_not_worn() {
    let mut bed = hills(40, 8.0, Edges::Closed);
    bed.rate = (0..bed.start.len()).map(|i| if i % 43 < 20 { 0.0 } else { 1.0 }).collect();
    let params = storm(&bed.grid, 100.0);
    HydraulicCells::new(&params, &bed.grid).advance(&mut bed, Part { step: 0, steps: 1 });
    assert!((0..bed.start.len()).all(|i| bed.rate[i] > 0.0 || bed.change[i] == 0.0));
    assert!(bed.change.iter().any(|&v| v < -0.01));
}

#[test]
fn steepness_says_what_it_does() {
    // A gentle and a steep half: what is worn of the steep one, by what is worn of the gentle one.
    let worn = |steepness| {
        let grid = Grid { width: 80, height: 30, cell_m: 10.0, edges: Edges::Open };
        let mut bed = bed(grid, |x, _| if x < 400.0 { 2000.0 - 0.3 * x } else { 1880.0 - 2.0 * (x - 400.0) });
        let params = HydraulicCellsParams { steepness, capacity: 1.0, ..storm(&grid, 3.0) };
        HydraulicCells::new(&params, &grid).advance(&mut bed, Part { step: 0, steps: 1 });
        let at = |x: usize| bed.change[15 * 80 + x] as f64;
        at(60) / at(20)
    };
    let [even, hard, soft] = [Steepness::Even, Steepness::HardCliffs, Steepness::SoftCliffs].map(worn);
    assert!(hard < 0.5 * even && soft > 2.0 * even, "{hard} {even} {soft}");
}

#[test]
fn cells_of_another_size_are_worn_alike() {
    let worn = |size: usize| {
        let grid = Grid { width: size, height: size, cell_m: 1024.0 / size as f64, edges: Edges::Open };
        let octaves = Fbm::new(300.0, 1.1).octaves(Key::new(9), 16.0);
        let mut bed = bed(grid, |x, y| {
            let away = (x - 512.0).powi(2) + (y - 512.0).powi(2);
            300.0 * (-away / 1e5).exp() + 20.0 * octaves.value([x, y])
        });
        run(&HydraulicCellsParams::default(), &mut bed, 1);
        bed.change.iter().map(|v| v.min(0.0) as f64).sum::<f64>() / grid.cells() as f64
    };
    let (coarse, fine) = (worn(64), worn(128));
    assert!(fine < -0.1 && (0.7..1.4).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn what_cannot_run_is_said_with_the_fix() {
    let grid = Grid { width: 9, height: 9, cell_m: 10_000.0, edges: Edges::Open };
    let short = HydraulicCellsParams { duration_h: 1.0, ..Default::default() };
    let message = short.check(&grid).unwrap_err();
    assert!(message.contains("set duration_h to 5.556"), "{message}");
    let long = HydraulicCellsParams { duration_h: 1e5, flow_m_per_s: 10.0, ..Default::default() };
    assert!(long.check(&Grid { cell_m: 0.1, ..grid }).is_err());
    assert!(HydraulicCellsParams::default().check(&Grid { cell_m: 8.0, ..grid }).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_storm_on_any_ground_stays_finite_and_keeps_the_rock(
        size in (1usize..20, 1usize..20),
        edges in prop::sample::select(vec![Edges::Open, Edges::Closed, Edges::Wrap]),
        cell_log in -1.0f64..4.0,
        base in 0.0f64..1e6,
        rough_log in -3.0f64..5.0,
        factor_log in -2.0f64..6.0,
        rates in (0.0f64..1000.0, 0.01f64..10.0, 0.0f64..1000.0, 0.0f64..1.0, 0.0f64..1.0, 0.0f64..1.0),
        steepness in prop::sample::select(vec![Steepness::Even, Steepness::HardCliffs, Steepness::SoftCliffs]),
        (locked, kind, shared) in (any::<bool>(), 0u8..3, any::<bool>()),
        seed: u64,
    ) {
        let grid = Grid { width: size.0, height: size.1, cell_m: 10f64.powf(cell_log), edges };
        let mut stream = Key::new(seed).stream();
        // Rough ground, a spike, or a pit; heights are counted from the middle of their range.
        let spike = (stream.unit() * grid.cells() as f64) as usize;
        let relief = 10f64.powf(rough_log);
        let datum = (base + 0.5 * relief).round();
        let start = (0..grid.cells()).map(|i| {
            let rough = stream.unit();
            (base + relief * [rough, f64::from(i == spike), f64::from(i != spike)][usize::from(kind)] - datum) as f32
        });
        let start: Vec<f32> = start.collect();
        let mut bed = Bed { sea_m: (base + 1.0 - datum) as f32, locked, margin_m: 1e-4, ..Bed::new(grid, start) };
        if shared {
            bed.rate = (0..grid.cells()).map(|_| (1.5 * stream.unit() - 0.25).clamp(0.0, 1.0) as f32).collect();
        }
        let before = bed.clone();
        let (rain, flow, drying, dissolving, capacity, flat) = rates;
        let params = HydraulicCellsParams {
            lock: crate::erosion::Lock::None,
            duration_h: 40.0 * grid.cell_m / (3600.0 * flow), morphological_factor: 10f64.powf(factor_log), rain_mm_per_h: rain,
            flow_m_per_s: flow, drying_per_h: drying, dissolving_per_h: dissolving, capacity, flat_capacity: flat, steepness,
        };
        let (moved, _) = run(&params, &mut bed, 3);
        prop_assert!(bed.change.iter().all(|v| v.is_finite()));
        let worked: f64 = bed.change.iter().map(|v| v.abs() as f64).sum();
        let error = sum(&bed.change) + moved.rock_left_m3 / grid.cell_area_m2();
        prop_assert!(error.abs() <= 1e-6 * (worked + moved.rock_left_m3 / grid.cell_area_m2()), "{error:e} of {worked:e}");
        for i in 0..grid.cells() {
            prop_assert!(bed.rate(i) > 0.0 || bed.change[i] == 0.0, "a masked cell changed by {}", bed.change[i]);
            let land = |bed: &Bed| bed.height(i) >= bed.sea_m;
            prop_assert!(!locked || land(&before) == land(&bed), "{} became {}", before.height(i), bed.height(i));
        }
    }
}
