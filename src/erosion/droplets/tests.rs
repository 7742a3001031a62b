//! What droplets must do: run down, keep the books, and come to the same bits however they are shared out.

use proptest::prelude::*;

use super::*;
use crate::{
    grid::{Edges, Field},
    noise::Fbm,
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

/// Runs a whole stage; what left over the rim, m of a cell.
fn run(params: &DropletsParams, bed: &mut Bed, steps: u64) -> f64 {
    let mut droplets = Droplets::new(params, &bed.grid, Key::new(4));
    let left: f64 = (0..steps).map(|step| droplets.advance(bed, Part { step, steps }).rock_left_m3).sum();
    droplets.settle(bed);
    assert_eq!(droplets.carried_m3(), 0.0);
    left / bed.grid.cell_area_m2()
}

const WHOLE: Part = Part { step: 0, steps: 1 };

fn sum(values: &[f32]) -> f64 {
    values.iter().map(|&v| v as f64).sum()
}

fn heights(bed: &Bed) -> Field<f32> {
    Field { grid: bed.grid, data: (0..bed.start.len()).map(|i| bed.height(i)).collect() }
}

#[test]
fn rock_is_kept_whatever_the_rim() {
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        let mut bed = hills(200, 8.0, edges);
        let params = DropletsParams::default();
        let mut droplets = Droplets::new(&params, &bed.grid, Key::new(4));
        let moved = droplets.advance(&mut bed, Part { step: 0, steps: 2 });
        let worked: f64 = bed.change.iter().map(|v| v.abs() as f64).sum();
        assert!(worked > 1000.0, "{edges:?}: nothing happened");
        let area = bed.grid.cell_area_m2();
        let error = |bed: &Bed, carried: f64| (sum(&bed.change) + (carried + moved.rock_left_m3) / area) / worked;
        let before = error(&bed, droplets.carried_m3());
        assert!(before.abs() < 1e-6, "{edges:?}: {before:e}");
        droplets.settle(&mut bed);
        let after = error(&bed, 0.0);
        assert!(after.abs() < 1e-6, "{edges:?}: {after:e} after it settled");
        assert_eq!(moved.rock_left_m3 > 0.0, edges == Edges::Open, "{edges:?}");
        // 5000 years of a metre on 203 x 200 cells.
        assert!((moved.water_in_m3 / (5000.0 * 203.0 * 200.0 * area) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn speed_is_what_gravity_gives_and_drag_leaves() {
    let grid = Grid { width: 9, height: 9, cell_m: 10.0, edges: Edges::Open };
    let law = |drag_per_m| DropletsParams { drag_per_m, ..Default::default() }.law(&grid, 1.0);
    // Falling 5 m: v² = 2·g·h. Rising takes it away, and no more than there is.
    let fallen = walk::faster(0.0, 5.0, &law(0.0));
    assert!((fallen - 98.1).abs() < 1e-3);
    assert!((walk::faster(fallen, -2.0, &law(0.0)) - 58.86).abs() < 1e-3);
    assert_eq!(walk::faster(fallen, -50.0, &law(0.0)), 0.0);
    // With drag it tends to 2·g·slope / drag.
    let end = (0..200).fold(0.0, |v, _| walk::faster(v, 3.0, &law(1.0)));
    assert!((end - 2.0 * 9.81 * 0.3).abs() < 1e-3, "{end}");
}

/// A plane that falls at 0.3 towards `turn` degrees from east, and what is worn of its middle.
fn plane(turn: f64) -> f64 {
    let grid = Grid { width: 160, height: 160, cell_m: 8.0, edges: Edges::Open };
    let (sin, cos) = turn.to_radians().sin_cos();
    let mut bed = bed(grid, |x, y| 2000.0 - 0.3 * (x * cos + y * sin));
    let params = DropletsParams { path_m: 200.0, duration_yr: 1000.0, droplets_per_cell: 2.0, ..Default::default() };
    run(&params, &mut bed, 1);
    let middle = (0..grid.cells()).filter(|&i| (48..112).contains(&(i % 160)) && (48..112).contains(&(i / 160)));
    middle.map(|i| bed.change[i].min(0.0) as f64).sum::<f64>()
}

#[test]
fn a_plane_is_worn_alike_however_it_is_turned() {
    let east = plane(0.0);
    assert!(east < -10.0, "{east}");
    for turn in [22.5, 45.0, 180.0, 270.0] {
        let turned = plane(turn);
        assert!((turned / east - 1.0).abs() < 0.06, "{turn}: {turned} for {east}");
    }
}

#[test]
fn a_droplet_runs_straight_down_a_walled_plane() {
    // One droplet, in the middle of the upper part: what it wore lies on the line of fall below it.
    for turn in [0.0f64, 22.5, 45.0] {
        let grid = Grid { width: 120, height: 120, cell_m: 8.0, edges: Edges::Closed };
        let (sin, cos) = turn.to_radians().sin_cos();
        let mut bed = bed(grid, |x, y| 2000.0 - 0.3 * (x * cos + y * sin));
        let params = DropletsParams { path_m: 400.0, duration_yr: 10.0, ..Default::default() };
        let mut droplets = Droplets::new(&params, &grid, Key::new(4));
        droplets.waiting.push(Droplet::new([30.0, 30.0]));
        let mut stream = Key::new(1).stream();
        droplets.phase(&mut bed, &mut stream);
        assert!(droplets.waiting.is_empty());
        let (mut along, mut across, mut weight) = (0.0, 0.0, 0.0);
        for (i, &change) in bed.change.iter().enumerate() {
            let (x, y) = ((i % 120) as f64 - 30.0, (i / 120) as f64 - 30.0);
            let worn = change.min(0.0) as f64;
            along += worn * (x * cos + y * sin);
            across += worn * (y * cos - x * sin);
            weight += worn;
        }
        assert!(along / weight > 5.0, "{turn}: {}", along / weight);
        assert!((across / weight).abs() < 0.3, "{turn}: {} cells aside", across / weight);
    }
}

#[test]
fn flow_is_the_rain_of_what_lies_above() {
    // A plane 80 cells wide that falls to the east; droplets run all the way, none dries up, and nothing is dug.
    let grid = Grid { width: 80, height: 40, cell_m: 8.0, edges: Edges::Open };
    let mut bed = bed(grid, |x, _| 2000.0 - 0.3 * x);
    let params =
        DropletsParams { path_m: 1e4, drying_per_km: 0.0, capacity: 0.0, droplets_per_cell: 8.0, ..Default::default() };
    let mut droplets = Droplets::new(&params, &grid, Key::new(4));
    for step in 0..2 {
        droplets.advance(&mut bed, Part { step, steps: 2 });
        let flow = droplets.discharge();
        // A metre a year on a strip of cells: through column x goes the rain of x of them.
        for x in [20usize, 40, 60] {
            let column: f64 = (0..40).map(|y| f64::from(flow[y * 80 + x])).sum();
            let want = x as f64 * 40.0 * 64.0 / YEAR_S;
            assert!((column / want - 1.0).abs() < 0.08, "{step}, {x}: {column:e} m3/s for {want:e}");
        }
    }
}

#[test]
fn more_droplets_smooth_but_do_not_deepen() {
    let worn = |droplets_per_cell| {
        let mut bed = hills(96, 8.0, Edges::Closed);
        run(&DropletsParams { droplets_per_cell, duration_yr: 2000.0, ..Default::default() }, &mut bed, 1);
        bed.change.iter().map(|v| v.min(0.0) as f64).sum::<f64>()
    };
    let ratio = worn(4.0) / worn(1.0);
    assert!((0.75..1.33).contains(&ratio), "{ratio}");
}

#[test]
fn a_factor_stands_for_as_many_years_of_the_same_rain() {
    let worn = |duration_yr, morphological_factor| {
        let mut bed = hills(96, 8.0, Edges::Closed);
        let params = DropletsParams { duration_yr, morphological_factor, ..Default::default() };
        let mut droplets = Droplets::new(&params, &bed.grid, Key::new(4));
        let moved = droplets.advance(&mut bed, WHOLE);
        droplets.settle(&mut bed);
        (bed.change, droplets.discharge(), params.elapsed_yr(), moved.water_in_m3)
    };
    // A power of two, so that not even the last bit differs.
    let [(land, flow, years, water), (again, flow_again, years_again, eighth)] = [worn(8000.0, 1.0), worn(1000.0, 8.0)];
    assert!(land.iter().any(|&v| v < -1.0));
    assert!(land == again && flow == flow_again && years == years_again);
    assert_eq!(eighth, water / 8.0, "the water is that of the years in which it rains");
    assert!(worn(1000.0, 0.0).0.iter().all(|&v| v == 0.0), "a bed whose clock stands does not change");
}

#[test]
fn spikes_and_pits_stay_bounded() {
    for top in [500.0f32, -500.0] {
        let mut bed = bed(Grid { width: 61, height: 61, cell_m: 10.0, edges: Edges::Open }, |x, y| 0.1 * (x + y));
        bed.start[30 * 61 + 30] += top;
        let (low, high) = heights(&bed).range().unwrap();
        let params = DropletsParams { path_m: 400.0, droplets_per_cell: 4.0, duration_yr: 1e5, ..Default::default() };
        run(&params, &mut bed, 2);
        let (lowest, highest) = heights(&bed).range().unwrap();
        assert!(lowest >= low - 0.01 && highest <= high + 0.01, "{lowest} {highest} of {low} {high}");
        let spike = bed.change[30 * 61 + 30];
        assert!(spike * top < 0.0, "{spike}: a spike is worn, a pit is filled");
    }
}

#[test]
fn droplets_dig_no_pits_and_build_no_needles() {
    // A smooth hill has no pits and one peak; what is carved into it drains as well, and is a few metres deep at most.
    let grid = Grid { width: 128, height: 128, cell_m: 8.0, edges: Edges::Open };
    let mut bed = bed(grid, |x, y| 500.0 * (-((x - 512.0).powi(2) + (y - 512.0).powi(2)) / 2e5).exp());
    run(&DropletsParams::default(), &mut bed, 2);
    let after = heights(&bed);
    let (mut sharpest, mut pits) = (0.0f32, 0);
    for y in 1..127 {
        for x in 1..127 {
            let (here, around) = (
                after.at(x, y),
                crate::flow::STEPS.map(|(i, j)| after.at(x.wrapping_add_signed(i), y.wrapping_add_signed(j))),
            );
            sharpest = sharpest.max((here - around.iter().sum::<f32>() / 8.0).abs());
            pits += around.iter().all(|&z| z > here) as usize;
        }
    }
    assert_eq!(pits, 0);
    assert!(bed.change.iter().any(|&v| v < -3.0));
    assert!(sharpest < 8.0, "{sharpest}");
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_after_a_restart() {
    for edges in [Edges::Open, Edges::Wrap] {
        let worn = |threads: usize, restart: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut bed = hills(260, 8.0, edges);
                let params = DropletsParams { droplets_per_cell: 0.2, ..Default::default() };
                let mut droplets = Droplets::new(&params, &bed.grid, Key::new(4));
                for step in 0..4 {
                    if restart {
                        let saved = droplets.save();
                        droplets = Droplets::new(&params, &bed.grid, Key::new(4));
                        let field = |name: &str| saved.fields.iter().find(|f| f.0 == name).map(|f| f.1.clone());
                        droplets.restore(&field, &saved.blob).unwrap();
                    }
                    droplets.advance(&mut bed, Part { step, steps: 4 });
                }
                droplets.settle(&mut bed);
                bed.change.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
            })
        };
        let one = worn(1, false);
        assert!(one == worn(2, false) && one == worn(8, true), "{edges:?}");
    }
}

#[test]
fn land_stays_land_and_the_sea_takes_what_comes() {
    let mut bed = hills(100, 8.0, Edges::Closed);
    bed.sea_m = 300.0;
    let mut free = bed.clone();
    let params = DropletsParams { duration_yr: 50_000.0, ..Default::default() };
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
    let mut bed = hills(60, 8.0, Edges::Closed);
    bed.rate = (0..bed.start.len()).map(|i| if i % 63 < 30 { 0.0 } else { 1.0 }).collect();
    run(&DropletsParams::default(), &mut bed, 2);
    assert!((0..bed.start.len()).all(|i| bed.rate[i] > 0.0 || bed.change[i] == 0.0));
    assert!(bed.change.iter().any(|&v| v < -1.0));
}

#[test]
fn pieces_cover_an_axis_once() {
    for edges in [Edges::Open, Edges::Wrap] {
        for size in [1, 100, 193, 500] {
            for offset in [0.0, 0.37, 0.999] {
                let pieces = window::cut(size, edges, offset);
                assert_eq!(pieces.iter().map(|piece| piece.size).sum::<usize>(), size, "{edges:?} {size} {offset}");
                assert!(pieces.iter().all(|piece| piece.size > 0));
                let owners = window::owners(&pieces, size);
                assert!((0..pieces.len()).all(|k| owners.iter().filter(|&&o| o == k).count() == pieces[k].size));
            }
        }
    }
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
        run(&DropletsParams::default(), &mut bed, 1);
        bed.change.iter().map(|v| v.min(0.0) as f64).sum::<f64>() / grid.cells() as f64
    };
    let (coarse, fine) = (worn(64), worn(128));
    assert!(fine < -0.1 && (0.7..1.4).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn what_cannot_run_is_said_with_the_fix() {
    let grid = Grid { width: 64, height: 64, cell_m: 1000.0, edges: Edges::Open };
    let message = DropletsParams::default().check(&grid).unwrap_err();
    assert!(message.contains("set path_m to 4000 or more"), "{message}");
    let fine = Grid { cell_m: 0.1, ..grid };
    assert!(DropletsParams::default().check(&fine).unwrap_err().contains("set radius_m to 1.6"));
    let narrow = Grid { width: 9, cell_m: 8.0, edges: Edges::Wrap, ..grid };
    assert!(DropletsParams::default().check(&narrow).is_err());
    assert!(DropletsParams::default().check(&Grid { cell_m: 8.0, ..grid }).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_rain_on_any_ground_stays_finite_and_keeps_the_rock(
        size in (1usize..40, 1usize..40),
        edges in prop::sample::select(vec![Edges::Open, Edges::Closed, Edges::Wrap]),
        cell_log in -1.0f64..4.0,
        base in 0.0f64..1e6,
        rough_log in -3.0f64..5.0,
        logs in (0.0f64..7.0, -3.0f64..0.5, -2.0f64..6.0, -2.0f64..6.0),
        rates in (1.0f64..100.0, 0.0f64..16.0, 0.0f64..1000.0, 0.0f64..1.0, 0.0f64..1.0, 0.0f64..1000.0, 0.0f64..1000.0),
        (rain_log, factor_log, gravity) in (-1.0f64..4.3, -3.0f64..5.0, 0.01f64..100.0),
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
        let (path, radius, turning, capacity, least_slope, drying, drag) = rates;
        let params = DropletsParams {
            lock: crate::erosion::Lock::None,
            duration_yr: 10f64.powf(logs.0), rain_mm_per_yr: 10f64.powf(rain_log),
            morphological_factor: 10f64.powf(factor_log), droplets_per_cell: 10f64.powf(logs.1), path_m: path * grid.cell_m,
            radius_m: radius * grid.cell_m, turning_m: turning, capacity, least_slope, erosion_m: 10f64.powf(logs.2),
            deposition_m: 10f64.powf(logs.3), drying_per_km: drying, gravity_m_per_s2: gravity, drag_per_m: drag,
        };
        let left = run(&params, &mut bed, 3);
        prop_assert!(bed.change.iter().all(|v| v.is_finite()));
        let worked: f64 = bed.change.iter().map(|v| v.abs() as f64).sum();
        let error = sum(&bed.change) + left;
        prop_assert!(error.abs() <= 1e-6 * (worked + left), "{error:e} of {worked:e}");
        for i in 0..grid.cells() {
            prop_assert!(bed.rate(i) > 0.0 || bed.change[i] == 0.0, "a masked cell changed by {}", bed.change[i]);
            let land = |bed: &Bed| bed.height(i) >= bed.sea_m;
            prop_assert!(!locked || land(&before) == land(&bed), "{} became {}", before.height(i), bed.height(i));
        }
    }
}
