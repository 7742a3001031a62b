//! Stream power against closed forms, published numbers, and the worst that can be asked of it.

use super::{
    Rim, StreamPowerParams,
    carver::{Carver, Forcing, Law, Moved},
    deposition::{Deposition, Slopes},
};
use crate::{
    flow::{LENGTHS, ROOT, Router},
    grid::{Edges, Grid},
    process::Placement,
};

const LAW: Law = Law {
    erodibility: 1e-5,
    area_exponent: 0.5,
    slope_exponent: 1.0,
    deposition: 0.0,
    channel_area_m2: 0.0,
    steepest: 1e9,
    slides_all_round: false,
    diffusivity_m2_per_yr: 0.0,
    marine_reach_m: 0.0,
    rim: Rim::Fixed,
    lifts_base: false,
};

const DRY: Forcing = Forcing {
    sea_level_m: -1e9,
    uplift_mm_per_yr: None,
    uplift_factor: 1.0,
    rain_mm_per_yr: None,
    inflows: &[],
    gates: &[],
    uniform_rain_mm_per_yr: 1000.0,
    ease: None,
};

/// Smooth hills with some roughness, the same land on every grid of this extent.
fn hills(grid: Grid) -> Vec<f64> {
    let [w, h] = grid.extent_m();
    let wave = |u: f64, v: f64, a: f64, b: f64, c: f64| (6.3 * (a * u + b * v) + c).sin();
    (0..grid.cells())
        .map(|i| {
            let (x, y) = grid.cell_of(i);
            let [x, y] = grid.center_m(x, y);
            let (u, v) = (x / w, y / h);
            let octaves = [(1.3, 0.7), (2.9, -1.7), (4.3, 5.9), (-11.3, 7.1), (17.9, 23.3)];
            let sum = octaves.iter().zip(1..).map(|(&(a, b), k)| wave(u, v, a, b, k as f64) / k as f64);
            300.0 + 150.0 * sum.sum::<f64>()
        })
        .collect()
}

fn run(law: &Law, forcing: &Forcing, grid: Grid, z: &mut Vec<f64>, years: f64, steps: usize) -> Moved {
    let mut carver = Carver::new(grid);
    let mut total = Moved::default();
    for _ in 0..steps {
        let moved = carver.step(law, forcing, z, years);
        total.lifted_m += moved.lifted_m;
        total.left_m += moved.left_m;
    }
    total
}

fn sum(z: &[f64]) -> f64 {
    z.iter().sum()
}

/// A channel of 101 cells that ends in the sea, with Hack's law for its catchment; `area[i]` belongs to cell `i`.
fn channel(cell_m: f64, hack: (f64, f64)) -> (Grid, Vec<f64>, Vec<f32>) {
    let grid = Grid { width: 101, height: 1, cell_m, edges: Edges::Closed };
    let area: Vec<f64> = (0..101).map(|i| hack.0 * libm::pow((101 - i) as f64 * cell_m, hack.1)).collect();
    let above = |i: usize| area.get(i + 1).copied().unwrap_or(0.0);
    let rain = (0..101).map(|i| (1000.0 * (area[i] - above(i)) / (cell_m * cell_m)) as f32).collect();
    (grid, area, rain)
}

#[test]
fn a_profile_in_balance_has_the_slopes_of_flint_s_law() {
    // fastscapelib's own test: 101 nodes 300 m apart, U = K = 1e-3, A = 6.69 x^1.67, 10 ky steps, n of 1, 2 and 4.
    let (grid, area, rain) = channel(300.0, (6.69, 1.67));
    let uplift = vec![1.0f32; 101];
    for n in [1.0, 2.0, 4.0] {
        let law = Law { erodibility: 1e-3, slope_exponent: n, ..LAW };
        let forcing = Forcing { sea_level_m: 0.0, uplift_mm_per_yr: Some(&uplift), rain_mm_per_yr: Some(&rain), ..DRY };
        let mut z: Vec<f64> = (0..101).map(|i| if i == 0 { -1e9 } else { 1e-3 * i as f64 }).collect();
        run(&law, &forcing, grid, &mut z, 1e4, 4000);
        z[0] = 0.0;
        for i in 1..101 {
            let (slope, want) = ((z[i] - z[i - 1]) / 300.0, libm::pow(area[i], -0.5 / n));
            // Rain in f32 is good to 6e-8; the rest is how near to balance it came.
            assert!((slope / want - 1.0).abs() < 1e-5, "n {n}, cell {i}: {slope} for {want}");
        }
    }
}

#[test]
fn above_the_channel_heads_a_profile_in_balance_steepens_as_the_channels_end() {
    let (grid, area, rain) = channel(300.0, (6.69, 1.67));
    let uplift = vec![1.0f32; 101];
    let law = Law { erodibility: 1e-3, channel_area_m2: 1e6, ..LAW };
    let forcing = Forcing { sea_level_m: 0.0, uplift_mm_per_yr: Some(&uplift), rain_mm_per_yr: Some(&rain), ..DRY };
    let mut z: Vec<f64> = (0..101).map(|i| if i == 0 { -1e9 } else { 1e-3 * i as f64 }).collect();
    run(&law, &forcing, grid, &mut z, 1e4, 4000);
    z[0] = 0.0;
    for i in 1..101 {
        let slope = (z[i] - z[i - 1]) / 300.0;
        // Flint's law over the share of the water that runs in channels.
        let want = area[i].powf(-0.5) / (1.0 - (-area[i] / 1e6).exp());
        assert!((slope / want - 1.0).abs() < 1e-5, "cell {i}: {slope} for {want}");
    }
    let share = |i: usize| 1.0 - (-area[i] / 1e6).exp();
    assert!(share(100) < 0.1 && share(1) > 1.0 - 1e-9, "{} {}", share(100), share(1));
}

#[test]
fn what_slides_all_round_is_carried_off_and_leaves_no_steeper_slope() {
    for (sea_level_m, deposition) in [(-1e9, 0.0), (-1e9, 1.0), (250.0, 0.0), (250.0, 1.0)] {
        let grid = Grid::new(60, 50, 3e3, Edges::Open);
        let law =
            Law { rim: Rim::Free, deposition, steepest: 0.7, slides_all_round: true, channel_area_m2: 1e4, ..LAW };
        let forcing = Forcing { sea_level_m, ..DRY };
        // A rough cone, too steep everywhere, without pits: the floor of a lake may be steeper.
        let from_middle = |i: usize| {
            let (x, y) = grid.cell_of(i);
            grid.cell_m * (x as f64 - 29.5).hypot(y as f64 - 24.5)
        };
        let mut z: Vec<f64> =
            hills(grid).iter().enumerate().map(|(i, z)| 2000.0 - 1.2 * from_middle(i) + 0.1 * (z - 300.0)).collect();
        let before = sum(&z);
        let moved = run(&law, &forcing, grid, &mut z, 1e3, 3);
        let residual = sum(&z) - before + moved.left_m;
        assert!(residual.abs() < 1e-13 * before.abs(), "{residual}");
        assert!(moved.left_m > 0.0 || sea_level_m > 0.0);
        let mut worst = 0.0f64;
        for y in 1..49 {
            for x in 1..59 {
                let fall =
                    |dx: isize, dy: isize| z[grid.index(x, y)] - z[grid.index(grid.column(x, dx), grid.row(y, dy))];
                let (a, b) = (fall(-1, 0).max(fall(1, 0)).max(0.0), fall(0, -1).max(fall(0, 1)).max(0.0));
                if z[grid.index(x, y)] > sea_level_m + 1.0 && deposition == 0.0 {
                    worst = worst.max(a.hypot(b) / grid.cell_m);
                }
            }
        }
        // Foot of a slope in the sea: the slope of what stands out is from the water on.
        assert!(worst < 0.7 + 1e-3 || sea_level_m > 0.0, "{worst}");
    }
}

#[test]
fn a_held_rim_lets_rivers_leave_no_lower_than_they_did() {
    let grid = Grid::new(64, 64, 64e3, Edges::Open);
    let uplift = vec![0.5f32; grid.cells()];
    let forcing = Forcing { sea_level_m: -2e3, uplift_mm_per_yr: Some(&uplift), ..DRY };
    let start = hills(grid);
    let least = |z: &[f64]| z.iter().copied().fold(f64::MAX, f64::min);
    let lowest = |rim: Rim| {
        let mut z = start.clone();
        run(&Law { rim, erodibility: 3e-6, ..LAW }, &forcing, grid, &mut z, 1e5, 60);
        (least(&z), sum(&z) / z.len() as f64)
    };
    let ((free, _), (held, mean)) = (lowest(Rim::Free), lowest(Rim::Held));
    assert!(free < least(&start) - 100.0 && held >= least(&start), "{free} {held} {}", least(&start));
    // Held is not walled in: the land does not keep all that uplift gave it.
    assert!(mean < sum(&start) / start.len() as f64 + 0.9 * 3000.0, "{mean}");
}

#[test]
fn a_knickpoint_travels_at_the_speed_of_its_water() {
    // All water comes from the head, so the speed K·A^m is the same everywhere; a step of 100 m starts at the sea.
    let grid = Grid { width: 101, height: 1, cell_m: 100.0, edges: Edges::Closed };
    let mut rain = vec![0.0f32; 101];
    rain[100] = 1e6;
    let speed = LAW.erodibility * (1e7f64).sqrt();
    let mut z: Vec<f64> = (0..101).map(|i| if i == 0 { -1e9 } else { 100.0 + 1e-6 * i as f64 }).collect();
    let forcing = Forcing { sea_level_m: 0.0, rain_mm_per_yr: Some(&rain), ..DRY };
    // To the middle of the channel, a twentieth of a cell a step.
    let steps = 1000;
    run(&LAW, &forcing, grid, &mut z, 50.0 * 100.0 / speed / steps as f64, steps);
    let at = z.windows(2).position(|pair| pair[0] < 50.0 && pair[1] >= 50.0).unwrap();
    let front = at as f64 + (50.0 - z[at]) / (z[at + 1] - z[at]);
    // The scheme's own front is a sum of waiting times: its middle trails by a third of a cell.
    assert!((front - 50.0).abs() < 1.0, "{front}");
}

#[test]
fn landlab_s_worked_example_comes_out() {
    // The docstring of landlab's FastscapeEroder: 5 x 5 nodes 10 m apart, K = 1, m = 0.5, n = 1, one step of a year.
    let grid = Grid::new(5, 5, 50.0, Edges::Open);
    #[rustfmt::skip]
    let mut z = vec![
        7.0, 7.0, 7.0, 7.0, 7.0,
        7.0, 5.0, 3.2, 6.0, 7.0,
        7.0, 2.0, 3.0, 5.0, 7.0,
        7.0, 1.0, 1.9, 4.0, 7.0,
        7.0, 0.0, 7.0, 7.0, 7.0,
    ];
    run(&Law { erodibility: 1.0, ..LAW }, &DRY, grid, &mut z, 1.0, 1);
    #[rustfmt::skip]
    let want = [
        7.0, 7.0, 7.0, 7.0, 7.0,
        7.0, 2.92996598, 2.02996598, 4.01498299, 7.0,
        7.0, 0.85993197, 1.87743897, 3.28268321, 7.0,
        7.0, 0.28989795, 0.85403051, 2.42701526, 7.0,
        7.0, 0.0, 7.0, 7.0, 7.0,
    ];
    for (i, (z, want)) in z.iter().zip(want).enumerate() {
        assert!((z - want).abs() < 5e-9, "{i}: {z} for {want}");
    }
}

#[test]
fn land_in_balance_loses_what_it_gains_and_keeps_flint_s_law() {
    let grid = Grid::new(40, 40, 40e3, Edges::Open);
    let uplift = vec![1.0f32; grid.cells()];
    let forcing = Forcing { uplift_mm_per_yr: Some(&uplift), ..DRY };
    let mut z = hills(grid);
    z.iter_mut().for_each(|z| *z *= 0.01);
    run(&LAW, &forcing, grid, &mut z, 1e5, 400);
    let before = z.clone();
    let mut carver = Carver::new(grid);
    carver.step(&LAW, &forcing, &mut z, 1e5);
    let mut area = vec![grid.cell_area_m2(); grid.cells()];
    carver.router().descend(&mut area, |_, area| *area);
    for i in 0..grid.cells() {
        assert!((z[i] - before[i]).abs() < 1e-6 * 100.0, "{i}: {} and {}", z[i], before[i]);
        let r = carver.router().receiver(i);
        if r != i {
            let straight = i.abs_diff(r) == 1 || i.abs_diff(r) == 40;
            let length = if straight { 1e3 } else { 1e3 * std::f64::consts::SQRT_2 };
            let slope = (z[i] - z[r]) / length;
            let want = 1e-3 / (LAW.erodibility * area[i].sqrt());
            assert!((slope / want - 1.0).abs() < 1e-5, "{i}: {slope} for {want}");
        }
    }
}

#[test]
fn deposition_solves_its_equation_at_every_cell() {
    let grid = Grid::new(60, 50, 60e3, Edges::Open);
    let raised = hills(grid);
    let at_rim = |i: usize| matches!(grid.cell_of(i), (x, y) if x == 0 || y == 0 || x == 59 || y == 49);
    let mut router = Router::new(grid);
    router.route(&raised, &(0..grid.cells()).map(at_rim).collect::<Vec<_>>());
    let mut cells = vec![1.0; grid.cells()];
    router.descend(&mut cells, |_, cells| *cells);
    for (n, g, steepest) in [(1.0, 0.5, 1e9), (1.0, 3.0, 1e9), (0.6, 1.0, 1e9), (2.0, 1.0, 1e9), (1.0, 0.5, 0.05)] {
        let what = format!("n {n}, G {g}, at most {steepest}");
        let length = |i: usize| LENGTHS[router.ways()[i] as usize & 7] * grid.cell_m;
        let ratio = |i: usize| 2.0 * (cells[i] * grid.cell_area_m2()).sqrt() / length(i).powf(n);
        let ratio: Vec<f64> = (0..grid.cells()).map(ratio).collect();
        let steepest_m = LENGTHS.map(|cells| cells * grid.cell_m * steepest);
        let slopes = Slopes { ratio: &ratio, exponent: n, steepest_m };
        let (mut level, mut z) = (raised.clone(), raised.clone());
        Deposition::default().settle(&router, &slopes, g, &raised, &mut level, &mut z);
        // What passes each cell: a lake keeps what it has room for.
        let mut load: Vec<f64> = raised.iter().zip(&z).map(|(raised, z)| raised - z).collect();
        router.descend(&mut load, |i, load| *load - load.clamp(0.0, level[i] - z[i]));
        let (mut ran, mut slid, mut drowned) = (0, 0, 0);
        for i in (0..z.len()).filter(|&i| router.ways()[i] != ROOT) {
            let drop = level[i] - level[router.receiver(i)];
            if drop <= 0.0 {
                assert!(z[i] <= level[i] && z[i] <= raised[i], "{what}: {i}");
                drowned += 1;
                continue;
            }
            let came = load[i] - (raised[i] - z[i]);
            let want = raised[i] + (g / cells[i]).min(1.0) * came - ratio[i] * drop.powf(n);
            if drop > steepest * length(i) * (1.0 - 1e-9) {
                assert!(want > z[i] - 1e-3, "{what}: {i} stands at {}, for {want}", z[i]);
                slid += 1;
            } else {
                assert!((z[i] - want).abs() < 1e-3, "{what}: {i} stands at {}, for {want}", z[i]);
                ran += 1;
            }
        }
        assert!(ran > 500 && drowned > 50 && (slid > 100) == (steepest < 1.0), "{what}: {ran} {slid} {drowned}");
    }
}

#[test]
fn nothing_is_lost_whatever_is_asked() {
    let mut tried = 0;
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        for (rim, sea_level_m) in [(Rim::Free, 250.0), (Rim::Fixed, 250.0), (Rim::Free, -1e9), (Rim::Free, 1e4)] {
            for (slope_exponent, deposition) in [(1.0, 0.0), (1.0, 1.0), (0.3, 0.0), (4.0, 0.0), (2.0, 2.0)] {
                for years in [1.0, 1e5, 1e6] {
                    let grid = Grid::new(24, 20, 24e3, edges);
                    let law =
                        Law { rim, slope_exponent, deposition, diffusivity_m2_per_yr: 0.02, steepest: 0.7, ..LAW };
                    let uplift: Vec<f32> = (0..grid.cells()).map(|i| 0.1 * (i % 7) as f32 - 0.1).collect();
                    let forcing = Forcing { sea_level_m, uplift_mm_per_yr: Some(&uplift), ..DRY };
                    let mut z = hills(grid);
                    let before = sum(&z);
                    let moved = run(&law, &forcing, grid, &mut z, years, 3);
                    let what = format!("{edges:?} {law:?} sea {sea_level_m} years {years}");
                    assert!(z.iter().all(|z| z.is_finite() && z.abs() < 1e5), "{what}");
                    // Sums of some hundred heights: their rounding is what limits the books.
                    let residual = sum(&z) - before - moved.lifted_m + moved.left_m;
                    let scale = before + moved.lifted_m.abs() + moved.left_m.abs();
                    assert!(residual.abs() < 1e-13 * scale, "{what}: {residual}");
                    tried += 1;
                }
            }
        }
    }
    assert_eq!(tried, 180);
}

#[test]
fn odd_lands_are_no_trouble() {
    let grid = Grid::new(17, 16, 17e3, Edges::Open);
    let closed = Grid { edges: Edges::Closed, ..grid };
    let step = |law: Law, sea_level_m: f64, grid: Grid, z: Vec<f64>| {
        let mut after = z.clone();
        run(&law, &Forcing { sea_level_m, ..DRY }, grid, &mut after, 1e5, 2);
        after
    };
    let flat = vec![500.0; grid.cells()];
    for rim in [Rim::Free, Rim::Fixed] {
        // Level land, all sea, nothing erodible: nothing happens.
        let law = Law { rim, diffusivity_m2_per_yr: 0.01, ..LAW };
        assert_eq!(step(law, 0.0, grid, flat.clone()), flat);
        assert_eq!(step(law, 600.0, grid, flat.clone()), flat);
        let still = Law { erodibility: 0.0, diffusivity_m2_per_yr: 0.0, ..law };
        assert_eq!(step(still, 0.0, grid, hills(grid)), hills(grid));
        assert_eq!(step(still, 0.0, closed, hills(grid)), hills(grid));
    }
    // One cell of land in the sea wears down towards it and not below.
    let mut islet = vec![-50.0; grid.cells()];
    islet[100] = 80.0;
    let after = step(LAW, 0.0, grid, islet);
    assert!(after[100] < 80.0 && after[100] >= 0.0, "{}", after[100]);
    // A closed bowl keeps its lowest point as base level; its floor is filled, its walls wear.
    let bowl: Vec<f64> =
        (0..grid.cells()).map(|i| (grid.cell_of(i).0 as f64 - 8.0).powi(2) + (i / 17) as f64).collect();
    let after = step(LAW, -1e9, closed, bowl.clone());
    let lowest = |z: &[f64]| z.iter().copied().fold(f64::MAX, f64::min);
    assert_eq!(lowest(&after), lowest(&bowl));
    assert!(sum(&after) < sum(&bowl));
}

#[test]
fn a_lake_is_kept_and_fills_with_what_rivers_bring() {
    // A valley 9 cells wide that falls to the west; a sill across it holds a lake.
    let grid = Grid::new(60, 9, 60e3, Edges::Closed);
    let ground = |i: usize| {
        let (x, y) = grid.cell_of(i);
        let bed = 5.0 * x as f64 + 20.0 * (y as f64 - 4.0).abs();
        match x {
            0 => -1000.0,
            18..=20 => 180.0f64.max(bed),
            _ => bed,
        }
    };
    let mut z: Vec<f64> = (0..grid.cells()).map(ground).collect();
    let (before, deep) = (z.clone(), grid.index(23, 4));
    let law = Law { erodibility: 1e-7, ..LAW };
    let forcing = Forcing { sea_level_m: 0.0, ..DRY };
    let mut carver = Carver::new(grid);
    carver.step(&law, &forcing, &mut z, 1e5);
    let lake: Vec<usize> = carver.router().flooded(&before).into_iter().map(|(i, _)| i).collect();
    assert!(lake.contains(&deep));
    // No lake bed is cut, and the lake is not filled at once.
    assert!(lake.iter().all(|&i| z[i] >= before[i]) && z[deep] < 180.0);
    let filled = |z: &[f64]| lake.iter().map(|&i| (z[i] - before[i]).max(0.0)).sum::<f64>();
    let first = filled(&z);
    for _ in 0..20 {
        carver.step(&law, &forcing, &mut z, 1e5);
    }
    assert!(first > 0.0 && filled(&z) > 2.0 * first, "{first} {}", filled(&z));
}

#[test]
fn a_free_rim_leaves_neither_wall_nor_cliff() {
    let grid = Grid::new(64, 64, 64e3, Edges::Open);
    let uplift = vec![0.5f32; grid.cells()];
    let law = Law { rim: Rim::Free, erodibility: 3e-6, ..LAW };
    let forcing = Forcing { sea_level_m: 0.0, uplift_mm_per_yr: Some(&uplift), ..DRY };
    let mut z = hills(grid);
    run(&law, &forcing, grid, &mut z, 1e5, 60);
    // Mean heights of the rings from the rim inwards.
    let ring = |k: usize| {
        let on = |i: &usize| {
            let (x, y) = grid.cell_of(*i);
            x.min(y).min(63 - x).min(63 - y) == k
        };
        let cells: Vec<usize> = (0..grid.cells()).filter(on).collect();
        cells.iter().map(|&i| z[i]).sum::<f64>() / cells.len() as f64
    };
    let (rim, next, inner) = (ring(0), ring(1), ring(4));
    let relief = z.iter().copied().fold(0.0, f64::max);
    assert!((rim - next).abs() < 0.1 * relief && (rim - inner).abs() < 0.25 * relief, "{rim} {next} {inner} {relief}");
}

#[test]
fn the_same_bits_on_any_number_of_threads_and_the_same_land_at_any_size() {
    let land = |size: usize, threads: usize| {
        let grid = Grid::new(size, size, 256e3, Edges::Open);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let uplift: Vec<f32> = (0..grid.cells())
                .map(|i| {
                    let (x, y) = grid.cell_of(i);
                    let [x, y] = grid.center_m(x, y).map(|v| v / 256e3 - 0.5);
                    (1.0 - 3.0 * (x * x + 0.5 * y * y)).max(0.0) as f32
                })
                .collect();
            let law = Law { rim: Rim::Free, erodibility: 2.2e-6, marine_reach_m: 15e3, ..LAW };
            let forcing = Forcing { sea_level_m: 200.0, uplift_mm_per_yr: Some(&uplift), ..DRY };
            let mut z = hills(grid);
            run(&law, &forcing, grid, &mut z, 1e5, 30);
            z
        })
    };
    let fine = land(300, 1);
    for threads in [2, 8] {
        assert!(land(300, threads).iter().zip(&fine).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
    }
    // Means over 25 x 25 blocks of 10 km.
    let blocks = |z: &[f64], size: usize| {
        let side = size / 25;
        let mut means = vec![0.0; 625];
        for (i, z) in z.iter().enumerate() {
            means[i / size / side * 25 + i % size / side] += z / (side * side) as f64;
        }
        means
    };
    let (a, b) = (blocks(&fine, 300), blocks(&land(100, 2), 100));
    let mean = |v: &[f64]| sum(v) / v.len() as f64;
    let (ma, mb) = (mean(&a), mean(&b));
    let moment =
        |p: &[f64], q: &[f64], mp: f64, mq: f64| p.iter().zip(q).map(|(p, q)| (p - mp) * (q - mq)).sum::<f64>();
    let r = moment(&a, &b, ma, mb) / (moment(&a, &a, ma, ma) * moment(&b, &b, mb, mb)).sqrt();
    // DESIGN.md's second promise.
    assert!(r > 0.95, "{r}");
}

/// A refusal names the span that the steps are of: its own duration, or the plates'.
#[test]
fn steps_of_a_year_are_refused() {
    let refusal = |coupled: bool, duration_myr: f64, step_kyr: f64| {
        let params = StreamPowerParams { coupled, duration_myr, step_kyr, ..StreamPowerParams::default() };
        let fit = params.process(Placement::default(), None).fit(&Grid::new(8, 8, 100.0, Edges::Open));
        fit.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let own = refusal(false, 2.0, 0.001);
    assert!(own.contains("2 My in steps of 0.001 ky are 2000000 steps; raise step_kyr to 0.02 or more"), "{own}");
    let plates = refusal(true, 5.0, 0.001);
    assert!(plates.contains("each My of the plates in steps of 0.001 ky are 1000000 steps"), "{plates}");
    assert!(plates.contains("raise step_kyr to 0.05 or more"), "{plates}");
    for sound in [refusal(false, 0.05, 0.001), refusal(true, 5.0, 0.05), refusal(false, 1e3, 1e4)] {
        assert_eq!(sound, "");
    }
}

/// The longest step that a recipe may ask for ends near what short ones do; ten times that would end on walls and pits.
#[test]
fn the_longest_step_is_still_the_same_land() {
    let grid = Grid::new(48, 48, 48e3, Edges::Open);
    let law = Law { erodibility: 2.2e-6, steepest: 0.7, ..LAW };
    let uplift = vec![0.5f32; grid.cells()];
    let forcing = Forcing { sea_level_m: 0.0, uplift_mm_per_yr: Some(&uplift), ..DRY };
    let mean = |years: f64, steps: usize| {
        let mut z = hills(grid);
        run(&law, &forcing, grid, &mut z, years, steps);
        sum(&z) / grid.cells() as f64
    };
    let (long, short) = (mean(1e6, 10), mean(2e4, 500));
    assert!((long / short - 1.0).abs() < 0.1, "{long} m for {short} m");
}

/// The sea floor is a base that stays, or rises by the exact sum of its uplift, whatever the steps.
#[test]
fn the_sea_floor_rises_where_it_is_asked_to() {
    let grid = Grid::new(16, 16, 16e3, Edges::Closed);
    let uplift = vec![0.5f32; grid.cells()];
    let forcing = Forcing { sea_level_m: 0.0, uplift_mm_per_yr: Some(&uplift), ..DRY };
    for (lifts_base, steps) in [(false, 4), (true, 4), (true, 20)] {
        let mut z = vec![-2000.0; grid.cells()];
        run(&Law { lifts_base, ..LAW }, &forcing, grid, &mut z, 2e6 / steps as f64, steps);
        let want = if lifts_base { -1000.0 } else { -2000.0 };
        assert!(z.iter().all(|z| (z - want).abs() < 1e-9), "{lifts_base} {steps}: {}", z[0]);
    }
}
