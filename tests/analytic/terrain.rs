//! Base terrain: faults and RMP against closed forms, and every stage against itself at another size and on other
//! numbers of threads.

use std::sync::atomic::AtomicBool;

use upthrust::{
    grid::{Edges, Field, Grid},
    process::{Blend, Context, Placement, Shape},
    terrain::*,
    volcano::{IslandParams, VolcanoParams},
    world::{Layer, World},
};

const EXTENT_M: f64 = 400e3;

/// The heights that the stages make one after the other.
fn grown(stages: Vec<Box<dyn upthrust::process::Process>>, grid: Grid, seed: u64) -> Field<f32> {
    let cancel = AtomicBool::new(false);
    let mut world = World::new(grid, 0.0);
    for (i, mut stage) in stages.into_iter().enumerate() {
        let id = format!("stage{i}");
        let step = stage.step(&mut world, &Context::new(seed, &id, &cancel)).unwrap();
        assert!(step.finished());
    }
    assert_eq!(world.first_non_finite(), None);
    world.layer(Layer::Bedrock).unwrap().clone()
}

fn square(size: usize) -> Grid {
    Grid::new(size, size, EXTENT_M, Edges::Open)
}

type Stages = fn() -> Vec<Box<dyn upthrust::process::Process>>;

fn put<S: Shape>(shape: S) -> Box<dyn upthrust::process::Process> {
    shape.process(Placement::default())
}

fn on_top(volcano: VolcanoParams) -> Box<dyn upthrust::process::Process> {
    volcano.process(Placement { blend: Blend::Add, mask: None })
}

fn form(form: Form) -> MultifractalParams {
    MultifractalParams { form, base_m: -1500.0, ..MultifractalParams::default() }
}

/// Every stage, sea somewhere in the middle of its heights.
const ALL: [(&str, Stages, f64); 15] = [
    ("fbm", || vec![put(FbmParams::default())], 0.0),
    ("fbm-rough", || vec![put(FbmParams { hurst: 0.2, ..FbmParams::default() })], 0.0),
    ("hybrid", || vec![put(form(Form::Hybrid))], 0.0),
    ("ridged", || vec![put(form(Form::Ridged))], 0.0),
    ("hetero", || vec![put(form(Form::Hetero))], 0.0),
    ("billow", || vec![put(form(Form::Billow))], 0.0),
    ("warp", || vec![put(FbmParams::default()), put(WarpParams::default())], 0.0),
    ("terrace", || vec![put(FbmParams::default()), put(TerraceParams::default())], 0.0),
    ("diamond_square", || vec![put(DiamondSquareParams::default())], 0.0),
    ("fault", || vec![put(FaultParams::default())], 0.0),
    ("rmp_peak", || vec![put(RmpPeakParams::default())], 500.0),
    ("rmp_ridge", || vec![put(RmpRidgeParams::default())], 500.0),
    ("rmp_graph", || vec![put(RmpGraphParams::default())], 500.0),
    ("island", || vec![put(IslandParams::default())], 0.0),
    ("volcano", || vec![put(FbmParams::default()), on_top(VolcanoParams::default())], 0.0),
];

fn averaged(field: &Field<f32>, size: usize) -> Vec<f64> {
    let k = field.grid.width / size;
    let block = |i: usize| {
        let (x0, y0) = (i % size * k, i / size * k);
        let sum: f64 = (0..k * k).map(|j| field.at(x0 + j % k, y0 + j / k) as f64).sum();
        sum / (k * k) as f64
    };
    (0..size * size).map(block).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let sum = |f: fn(f64, f64) -> f64| a.iter().zip(b).map(|(x, y)| f(x - ma, y - mb)).sum::<f64>();
    sum(|x, y| x * y) / (sum(|x, _| x * x) * sum(|_, y| y * y)).sqrt()
}

#[test]
fn another_size_refines_the_same_land() {
    for (name, stages, sea_m) in ALL {
        let [a, b] = [512, 2048].map(|size| averaged(&grown(stages(), square(size), 5), 128));
        let r = correlation(&a, &b);
        let both = a.iter().zip(&b).filter(|(a, b)| **a > sea_m && **b > sea_m).count() as f64;
        let either = a.iter().zip(&b).filter(|(a, b)| **a > sea_m || **b > sea_m).count() as f64;
        println!("{name}: correlation {r:.5}, land overlap {:.4}", both / either);
        assert!(r >= 0.98, "{name}: correlation {r}");
        assert!(both / either >= 0.9, "{name}: land overlap {}", both / either);
    }
}

#[test]
fn same_bits_for_any_number_of_threads() {
    for (name, stages, _) in ALL {
        let grid = Grid::new(200, 136, EXTENT_M, Edges::Open);
        let fields = [1, 2, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| grown(stages(), grid, 9))
        });
        let bits = |field: &Field<f32>| field.data.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert!(fields.iter().all(|field| bits(field) == bits(&fields[0])), "{name}");
    }
}

/// Mean square difference of heights a distance apart, over many seeds: 8·n·δ²·d/P.
#[test]
fn faults_have_a_linear_variogram() {
    let grid = Grid::new(128, 96, 128e3, Edges::Open);
    let (n, seeds, distances) = (64, 400, [4usize, 8, 16, 32]);
    let params = FaultParams {
        height_m: 2.0 * (n as f64).sqrt(),
        faults: n,
        width_km: Some(0.0),
        decline: 0.0,
        ..FaultParams::default()
    };
    let mut sums = [0.0; 4];
    for seed in 0..seeds {
        let field = grown(vec![put(params.clone())], grid, seed);
        for (sum, d) in sums.iter_mut().zip(distances) {
            let pairs: Vec<f64> = (0..96)
                .step_by(8)
                .flat_map(|y| (0..128 - d).step_by(8).map(move |x| (x, y)))
                .map(|(x, y)| (field.at(x + d, y) - field.at(x, y)) as f64)
                .collect();
            *sum += pairs.iter().map(|v| v * v).sum::<f64>() / pairs.len() as f64;
        }
    }
    // δ = 1 m by the choice of height. A slope one cell wide takes a third of a cell off the distance of sharp steps.
    let perimeter = 2.0 * (128.0 + 96.0);
    for (sum, d) in sums.iter().zip(distances) {
        let (measured, want) = (sum / seeds as f64, 8.0 * n as f64 * d as f64 / perimeter);
        assert!((measured / want - 1.0).abs() < 0.1, "at {d} cells: {measured}, not {want}");
    }
}

#[test]
fn one_octave_of_a_peak_follows_the_profile() {
    let half_width_km = 20.0;
    let params = RmpPeakParams {
        half_width_km: Some(half_width_km),
        height_m: 1000.0,
        iterations: 4000,
        octaves: 1,
        random_weights: false,
        spurs: 0.0,
        ..RmpPeakParams::default()
    };
    let grid = Grid::new(201, 201, 201e3, Edges::Open);
    let field = grown(vec![put(params)], grid, 3);
    // The middle cell holds the peak; a draw's rim may cut its corner.
    assert!((field.at(100, 100) / 1000.0 - 1.0).abs() < 0.03, "{}", field.at(100, 100));
    for d in [10usize, 20, 40] {
        let u = 0.442 * d as f64 / half_width_km;
        let around = [(100 + d, 100), (100 - d, 100), (100, 100 + d), (100, 100 - d)];
        let mean = around.iter().map(|&(x, y)| field.at(x, y) as f64).sum::<f64>() / 4000.0;
        let want = (-1.16 * u - 0.96 * u * u).exp();
        // Standard error at most 0.5/√(2·4000) = 0.0056, and the fit's own 0.004.
        assert!((mean - want).abs() < 0.025, "at {d} km: {mean}, not {want}");
    }
}

#[test]
fn a_graph_of_one_face_halves_by_the_closed_form() {
    let params = RmpGraphParams {
        cuts: 12,
        faces: 1,
        iterations: 4000,
        height_m: 1000.0,
        bend: 0.0,
        ..RmpGraphParams::default()
    };
    let field = grown(vec![put(params)], Grid::new(200, 150, 200e3, Edges::Open), 3);
    for d in [10usize, 30, 50] {
        let around = [(100 + d, 75), (99 - d, 75)];
        let mean = around.iter().map(|&(x, y)| field.at(x, y) as f64).sum::<f64>() / 2000.0;
        // The cell's middle is half a cell off the peak.
        let want = (1.0 - 2.0 * (d as f64 + 0.5) / 700.0f64).powi(12);
        // Standard error at most 0.5/√4000 = 0.008.
        assert!((mean - want).abs() < 0.03, "at {d} km: {mean}, not {want}");
    }
}

#[test]
fn what_does_not_fit_is_said_in_one_line() {
    let outside = RmpGraphParams { at_km: Some([500.0, 10.0]), ..RmpGraphParams::default() };
    let narrow = RmpPeakParams { half_width_km: Some(0.01), octaves: 8, ..RmpPeakParams::default() };
    let nan = RmpRidgeParams { points_km: vec![[f64::NAN, 0.0]], ..RmpRidgeParams::default() };
    for stage in [put(outside), put(narrow), put(nan)] {
        let error = stage.fit(&square(32)).unwrap_err().to_string();
        assert!(!error.contains('\n') && error.contains("km"), "{error}");
    }
}
