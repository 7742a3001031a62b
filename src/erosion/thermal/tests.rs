//! What slides must do: come to rest at the talus, lose nothing, and come to the same bits however they are shared out.

use proptest::prelude::*;

use super::*;
use crate::{
    erosion::{
        bed::{Bed, Family, Part},
        stage::Lock,
    },
    grid::{Edges, Grid},
    noise::Key,
};

const METHODS: [ThermalMethod; 3] = [ThermalMethod::Flux, ThermalMethod::Spread, ThermalMethod::Cells];

fn bed(grid: Grid, f: impl Fn(usize, usize) -> f32) -> Bed {
    let start = (0..grid.cells()).map(|i| f(i % grid.width, i / grid.width)).collect();
    Bed { sea_m: -1e4, ..Bed::new(grid, start) }
}

fn rough(grid: Grid, relief: f32) -> Bed {
    bed(grid, |x, y| relief * (((x * 7919 + y * 104_729 + x * y * 31) % 1009) as f32 / 1009.0 - 0.5))
}

/// One material, so many passes' worth.
fn params(method: ThermalMethod, passes: f64) -> ThermalParams {
    let base = ThermalParams { method, talus_angle_deg: 35.0, rock_angle_deg: 35.0, ..ThermalParams::default() };
    ThermalParams { duration_yr: passes * base.most() / base.rate_per_yr, ..base }
}

fn slide(params: &ThermalParams, bed: &mut Bed, steps: u64) -> Thermal {
    let mut thermal = Thermal::new(params.clone(), bed, vec![0.0; bed.start.len()]);
    (0..steps).for_each(|step| {
        thermal.advance(bed, Part { step, steps });
    });
    thermal
}

fn gained(bed: &Bed) -> f64 {
    bed.change.iter().map(|&v| f64::from(v)).sum()
}

/// Steepest step down between neighbours, as a share of what the talus allows.
fn steepest(bed: &Bed, rise: f64) -> f64 {
    let (w, h, cell) = (bed.grid.width as isize, bed.grid.height as isize, bed.grid.cell_m);
    let z = |x: isize, y: isize| f64::from(bed.height((y * w + x) as usize));
    let mut most = 0.0f64;
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        for (dx, dy) in [(1, 0), (0, 1), (1, 1), (1, -1)] {
            let (nx, ny) = (x + dx, y + dy);
            if (0..w).contains(&nx) && (0..h).contains(&ny) {
                let apart = cell * ((dx * dx + dy * dy) as f64).sqrt();
                most = most.max((z(x, y) - z(nx, ny)).abs() / apart / rise);
            }
        }
    }
    most
}

#[test]
fn a_column_of_sand_comes_down_to_a_cone() {
    let grid = Grid::new(81, 81, 81.0 * 2.0, Edges::Closed);
    let rise = 35.0f64.to_radians().tan();
    // A column of a single cell 8 km high, which moves quanta of a millimetre, and the same sand on 25 cells.
    // An excess rests whose shares, eighths of a ninth of it, are less than half a quantum: 36 of them, 2.6 % of a drop.
    for (side, tall, rests) in [(1, 8000.0, 0.03), (5, 320.0, 0.02)] {
        for method in METHODS {
            let on = (81 - side) / 2..(81 + side) / 2;
            let mut sand = bed(grid, |x, y| if on.contains(&x) && on.contains(&y) { tall } else { 0.0 });
            slide(&params(method, 40_000.0), &mut sand, 2);
            assert_eq!(gained(&sand), 0.0, "{method:?}");
            assert!(steepest(&sand, rise) < 1.0 + rests, "{method:?} {}", steepest(&sand, rise));
            // The radius of the circle that covers as much as the heap does; an octagon has no edge on its corners.
            let volume = 8000.0 * 4.0;
            let high: f64 = (3.0 * volume * rise * rise / std::f64::consts::PI).cbrt();
            let covered = (0..grid.cells()).filter(|&i| sand.height(i) > 0.3).count() as f64 * 4.0;
            let radius = (covered / std::f64::consts::PI).sqrt();
            let want = high / rise;
            assert!((radius / want - 1.0).abs() < 0.05, "{method:?}, {side}: {radius:.2} m for {want:.2}");
            let top = sand.start.iter().zip(&sand.change).map(|(s, c)| s + c).fold(0.0f32, f32::max);
            assert!((f64::from(top) / high - 1.0).abs() < 0.08, "{method:?}, {side}: {top:.2} m high for {high:.2}");
        }
    }
}

#[test]
fn a_step_comes_down_to_a_ramp_about_its_middle() {
    let grid = Grid::new(60, 5, 60.0, Edges::Wrap);
    let mut cliff = bed(Grid { edges: Edges::Closed, ..grid }, |x, _| if x < 30 { 12.0 } else { 0.0 });
    slide(&params(ThermalMethod::Flux, 20_000.0), &mut cliff, 1);
    let rise = 35.0f64.to_radians().tan();
    let width = 12.0 / rise;
    for x in 0..60 {
        let from_middle = x as f64 + 0.5 - 30.0;
        let want = (6.0 - from_middle * rise).clamp(0.0, 12.0);
        let got = f64::from(cliff.height(2 * 60 + x));
        assert!((got - want).abs() < 0.06 * 12.0, "{x} of a ramp {width:.1} m wide: {got:.2} for {want:.2}");
    }
}

#[test]
fn what_is_not_too_steep_keeps_every_bit() {
    let grid = Grid::new(40, 30, 400.0, Edges::Open);
    for method in METHODS {
        // 34.9 degrees straight down, and a diagonal plane as steep.
        let rise = 34.9f32.to_radians().tan() * 10.0;
        let mut plane = bed(grid, |x, _| x as f32 * rise);
        slide(&params(method, 50.0), &mut plane, 3);
        assert!(plane.change.iter().all(|&v| v == 0.0), "{method:?}");
        let mut diagonal = bed(grid, |x, y| (x + y) as f32 * rise * std::f32::consts::FRAC_1_SQRT_2);
        slide(&params(method, 50.0), &mut diagonal, 3);
        assert!(diagonal.change.iter().all(|&v| v == 0.0), "{method:?}");
    }
}

#[test]
fn nothing_is_lost_and_no_summit_grows() {
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        for (method, levels) in [0, 3].into_iter().flat_map(|levels| METHODS.map(|method| (method, levels))) {
            let grid = if levels > 0 { Grid::new(65, 47, 650.0, edges) } else { Grid::new(64, 48, 640.0, edges) };
            let mut ground = rough(grid, 300.0);
            let params = ThermalParams { coarse_levels: levels, ..params(method, 60.0) };
            let range = |bed: &Bed| {
                (0..bed.start.len())
                    .fold((f32::MAX, f32::MIN), |(a, b), i| (a.min(bed.height(i)), b.max(bed.height(i))))
            };
            let (low, high) = range(&ground);
            slide(&params, &mut ground, 3);
            assert_eq!(gained(&ground), 0.0, "{method:?} {edges:?}");
            assert!(ground.change.iter().any(|&v| v.abs() > 1.0), "{method:?} {edges:?}");
            let (low_now, high_now) = range(&ground);
            assert!(low_now >= low && high_now <= high, "{method:?} {edges:?}");
        }
    }
}

#[test]
fn a_seamless_map_slides_as_well_over_its_seam() {
    let grid = Grid::new(40, 40, 400.0, Edges::Wrap);
    let heap = |x: usize, y: usize, at: usize| if (x % 40, y % 40) == (at, at) { 900.0 } else { 0.0 };
    let (mut seam, mut middle) = (bed(grid, |x, y| heap(x, y, 0)), bed(grid, |x, y| heap(x, y, 20)));
    for bed in [&mut seam, &mut middle] {
        slide(&params(ThermalMethod::Flux, 300.0), bed, 1);
    }
    for i in 0..grid.cells() {
        let (x, y) = grid.cell_of(i);
        assert_eq!(seam.change[i], middle.change[grid.index((x + 20) % 40, (y + 20) % 40)]);
    }
}

#[test]
fn scree_gathers_below_a_cliff_that_stands() {
    // A wall of 48 degrees stands by itself; one of 70 does not, and its scree comes to rest at 35.
    let grid = Grid::new(120, 9, 240.0, Edges::Closed);
    let wall = |deg: f32| {
        move |x: usize, _: usize| (120.0 - (x as f32 - 40.0).max(0.0) * 2.0 * deg.to_radians().tan()).max(0.0)
    };
    let two = ThermalParams { rock_angle_deg: 50.0, ..params(ThermalMethod::Flux, 40_000.0) };
    let mut firm = bed(grid, wall(48.0));
    slide(&two, &mut firm, 1);
    assert!(firm.change.iter().all(|&v| v == 0.0));
    let mut steep = bed(grid, wall(70.0));
    slide(&two, &mut steep, 1);
    assert_eq!(gained(&steep), 0.0);
    let z = |x: usize| f64::from(steep.height(4 * 120 + x));
    let laid: Vec<usize> = (1..119).filter(|&x| steep.change[4 * 120 + x] > 2.0).collect();
    assert!(laid.len() > 5, "{laid:?}");
    for &x in &laid[1..laid.len() - 1] {
        let slope = ((z(x) - z(x + 1)) / 2.0).atan().to_degrees();
        assert!(slope < 36.5, "{x}: {slope:.1} degrees");
    }
}

#[test]
fn a_coarse_start_brings_a_long_slope_to_rest_sooner() {
    let grid = Grid::new(128, 128, 1280.0, Edges::Closed);
    let hill = |x: usize, y: usize| {
        let r = ((x as f32 - 63.5).powi(2) + (y as f32 - 63.5).powi(2)).sqrt();
        (600.0 - 16.0 * r).max(0.0)
    };
    let rise = 35.0f64.to_radians().tan();
    let after = |levels: u32| {
        let mut ground = bed(grid, hill);
        slide(&ThermalParams { coarse_levels: levels, ..params(ThermalMethod::Flux, 100.0) }, &mut ground, 1);
        assert_eq!(gained(&ground), 0.0);
        steepest(&ground, rise)
    };
    let (plain, coarse) = (after(0), after(3));
    assert!(coarse < 1.1 && plain > 1.5 * coarse, "{plain:.2} {coarse:.2}");
}

/// "A raster of an odd side has no half": such maps once had no coarse start at all.
#[test]
fn a_coarse_start_works_for_any_number_of_cells() {
    let rise = 35.0f64.to_radians().tan();
    let slid = |size: usize| {
        let grid = Grid::new(size, size, 1270.0, Edges::Open);
        // A ridge across the map, so that it meets two rims.
        let mut ground = bed(grid, |x, y| {
            let [x, y] = grid.center_m(x, y);
            (600.0 - 1.6 * ((x - 640.0) + 0.3 * (y - 640.0)).abs()).max(0.0) as f32
        });
        slide(&ThermalParams { coarse_levels: 3, ..params(ThermalMethod::Spread, 100.0) }, &mut ground, 1);
        assert_eq!(gained(&ground), 0.0, "{size}");
        let top = (0..grid.cells()).map(|i| ground.height(i)).fold(0.0f32, f32::max);
        (steepest(&ground, rise), f64::from(top))
    };
    let [even, odd, next] = [126, 127, 128].map(slid);
    for (steep, top) in [odd, next] {
        assert!((steep / even.0 - 1.0).abs() < 0.1 && steep < 1.25, "{steep:.2} for {:.2}", even.0);
        assert!((top / even.1 - 1.0).abs() < 0.03, "{top:.1} m high for {:.1}", even.1);
    }
}

#[test]
fn hard_rock_takes_scree_and_a_mask_lets_nothing_by() {
    // A cliff along the middle; the low ground east of it is hard, or masked out.
    let grid = Grid::new(40, 20, 400.0, Edges::Closed);
    let east = |i: usize| i % 40 >= 20;
    let shares = || (0..grid.cells()).map(|i| if east(i) { 0.0 } else { 1.0 }).collect::<Vec<f32>>();
    for (method, levels) in [0, 2].into_iter().flat_map(|levels| METHODS.map(|method| (method, levels))) {
        let cliff = || bed(grid, |x, _| if x < 20 { 100.0 } else { 0.0 });
        let params = ThermalParams { coarse_levels: levels, ..params(method, 200.0) };
        let mut hard = Bed { rate: shares(), ..cliff() };
        slide(&params, &mut hard, 2);
        let laid: f64 = (0..grid.cells()).filter(|&i| east(i)).map(|i| f64::from(hard.change[i])).sum();
        assert!(laid > 1000.0, "{method:?}: {laid}");
        let mut masked = Bed { rate: shares(), mask: shares(), ..cliff() };
        slide(&params, &mut masked, 2);
        assert!(masked.change.iter().all(|&v| v == 0.0), "{method:?}");
    }
}

#[test]
fn a_locked_coast_stays() {
    for method in METHODS {
        let grid = Grid::new(50, 40, 500.0, Edges::Open);
        let mut shore = Bed { sea_m: 3.0, locked: true, margin_m: 0.02, ..rough(grid, 200.0) };
        let land = |bed: &Bed| (0..grid.cells()).map(|i| bed.height(i) >= bed.sea_m).collect::<Vec<_>>();
        let before = land(&shore);
        slide(&ThermalParams { lock: Lock::Coast, ..params(method, 500.0) }, &mut shore, 2);
        assert_eq!(before, land(&shore), "{method:?}");
        let near = |i: usize| (shore.height(i) - 3.0).abs() < 0.02 && shore.change[i] != 0.0;
        assert!(!(0..grid.cells()).any(near), "{method:?}");
        assert_eq!(gained(&shore), 0.0);
    }
}

#[test]
fn threads_and_a_break_change_nothing() {
    let grid = Grid::new(75, 66, 750.0, Edges::Open);
    for method in METHODS {
        let params = ThermalParams { rock_angle_deg: 45.0, coarse_levels: 1, ..params(method, 40.0) };
        let run = |threads: usize, stop: Option<u64>| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut ground = rough(grid, 150.0);
                let mut thermal = Thermal::new(params.clone(), &ground, vec![0.5; grid.cells()]);
                for step in 0..4 {
                    if stop == Some(step) {
                        let saved = thermal.save();
                        thermal = Thermal::new(params.clone(), &ground, vec![0.5; grid.cells()]);
                        let field = |name: &str| saved.fields.iter().find(|f| f.0 == name).map(|f| f.1.clone());
                        thermal.restore(&field, &saved.blob).unwrap();
                    }
                    thermal.advance(&mut ground, Part { step, steps: 4 });
                }
                ground.change.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
            })
        };
        let one = run(1, None);
        assert!(one == run(2, None) && one == run(8, None) && one == run(2, Some(2)), "{method:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn any_slide_on_any_ground_keeps_every_grain(
        size in (1usize..40, 1usize..40),
        edges in prop::sample::select(vec![Edges::Open, Edges::Closed, Edges::Wrap]),
        cell_log in -1.0f64..4.0,
        base in 0.0f64..1e6,
        (rough_log, kind) in (-3.0f64..5.0, 0u8..3),
        method in prop::sample::select(METHODS.to_vec()),
        angles in (1.0f64..85.0, 1.0f64..89.0),
        (passes, levels, steps) in (0.0f64..120.0, 0u32..4, 1u64..4),
        hard in (-1e4f64..1e6, -1e4f64..1e6, 0.0f64..1.0),
        (masked, soft, locked) in (any::<bool>(), any::<bool>(), any::<bool>()),
        seed: u64,
    ) {
        let grid = Grid { width: size.0, height: size.1, cell_m: 10f64.powf(cell_log), edges };
        let mut stream = Key::new(seed).stream();
        let relief = 10f64.powf(rough_log);
        let spike = (stream.unit() * grid.cells() as f64) as usize;
        let start: Vec<f32> = (0..grid.cells())
            .map(|i| {
                let rough = stream.unit();
                let z = match kind {
                    0 => rough,
                    1 => f64::from(i == spike),
                    _ => f64::from(i != spike),
                };
                (base + relief * z) as f32
            })
            .collect();
        // Heights are counted from the middle of their range.
        let datum = (base + 0.5 * relief).round() as f32;
        let mut bed = Bed { sea_m: 0.0, locked, margin_m: 1e-4, ..Bed::new(grid, start.iter().map(|z| z - datum).collect()) };
        let mut shares = |some: bool| (0..grid.cells()).map(|_| if some { (1.5 * stream.unit() - 0.25).clamp(0.0, 1.0) as f32 } else { 1.0 }).collect::<Vec<f32>>();
        let (mask, softness) = (shares(masked), shares(soft));
        bed.rate = mask.iter().zip(&softness).map(|(a, b)| a * b).collect();
        if masked {
            bed.mask = mask.clone();
        }
        let params = ThermalParams {
            talus_angle_deg: angles.0,
            rock_angle_deg: angles.1,
            hard_from_m: hard.0,
            hard_to_m: hard.1,
            hard_rate: hard.2,
            coarse_levels: levels,
            ..params(method, passes)
        };
        let params = ThermalParams { talus_angle_deg: angles.0, rock_angle_deg: angles.1, ..params };
        let before = bed.clone();
        slide(&params, &mut bed, steps);
        prop_assert!(bed.change.iter().all(|v| v.is_finite()));
        prop_assert_eq!(gained(&bed), 0.0);
        for i in 0..grid.cells() {
            prop_assert!(mask[i] > 0.0 || bed.change[i] == 0.0, "a masked cell changed by {}", bed.change[i]);
            prop_assert!(softness[i] > 0.0 || bed.change[i] >= 0.0, "hard rock lost {}", bed.change[i]);
            prop_assert!(!locked || (before.height(i) < 0.0) == (bed.height(i) < 0.0), "{} became {}", before.height(i), bed.height(i));
        }
    }
}
