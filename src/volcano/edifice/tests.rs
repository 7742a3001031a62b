//! What volcanoes promise: their surface and its gradient, where they stand, how they age, what is refused.

use proptest::prelude::*;

use super::*;
use crate::{
    grid::{Edges, Field, Grid},
    noise::Key,
    process::{Blend, Context, Placement, ProcessError},
    world::{Layer, Table, World},
};
use std::sync::atomic::AtomicBool;

fn grid(size: usize, extent_m: f64) -> Grid {
    Grid::new(size, size, extent_m, Edges::Open)
}

fn rough(noise: f64, turbulence: f64) -> Roughness {
    Roughness { noise, turbulence, frequency: 3.0, hurst: 0.75 }
}

fn edifice(profile: Profile, at_m: [f64; 2], roughness: Roughness) -> Edifice {
    let cone = Cone {
        height_m: 2000.0,
        radius_m: 8000.0,
        crater_height_m: 1700.0,
        crater_radius_m: 600.0,
        transition: 1.8,
        profile,
    };
    Edifice { at_m, cone, rough: roughness, key: Key::new(5), age_yr: 0.0, wear: None }
}

/// Runs the stage on flat ground at `ground_m` in a world with these tables.
fn run(params: VolcanoParams, blend: Blend, world: &mut World) -> Result<(), ProcessError> {
    let stay = AtomicBool::new(false);
    let mut process = params.process(Placement { blend, mask: None });
    process.fit(&world.grid)?;
    process.step(world, &Context::new(4, "volcano#1", &stay)).map(|_| ())
}

fn sea_floor(size: usize, extent_m: f64, ground_m: f32) -> World {
    let mut world = World::new(grid(size, extent_m), 0.0);
    world.set_layer(Layer::Bedrock, Field::filled(world.grid, ground_m));
    world
}

#[test]
fn gradients_are_those_of_the_heights() {
    let worn = Wear::after(2.0, 2000.0, 500.0, 350.0, 3.0);
    let mut stream = Key::new(2).stream();
    for profile in [Profile::Smoothstep, Profile::Gaussian, Profile::Exponential] {
        let one = edifice(profile, [20e3, 20e3], rough(0.1, 0.0));
        let other = Edifice { at_m: [27e3, 23e3], key: Key::new(6), wear: worn, ..one.clone() };
        let all = Edifices::new(vec![one, other], 100.0);
        let mut reader = all.reader();
        let mut missed = 0;
        for _ in 0..2000 {
            let at = [stream.between(0.0, 40e3), stream.between(0.0, 40e3)];
            let (z, slope) = reader.gradient(at);
            assert!((z - reader.height(at)).abs() < 1e-9 * z.max(1.0));
            let step = 0.01;
            let mut read = |dx: f64, dy: f64| reader.height([at[0] + dx, at[1] + dy]);
            let measured = [read(step, 0.0) - read(-step, 0.0), read(0.0, step) - read(0.0, -step)];
            // Second differences: 2000 m over waves of 200 m give some 2 per m² of third derivative, times step².
            missed += usize::from((0..2).any(|i| (measured[i] / (2.0 * step) - slope[i]).abs() > 2e-3));
        }
        // Only at the coast of the worn one is there an edge, a line that a step of 2 cm seldom meets.
        assert!(missed <= 1, "{profile:?}: {missed}");
    }
}

#[test]
fn alone_a_volcano_is_its_cone_and_two_keep_their_craters() {
    let smooth = edifice(Profile::Exponential, [20e3, 20e3], rough(0.0, 0.0));
    let alone = Edifices::new(vec![smooth.clone()], 50.0);
    for r in [0.0, 300.0, 600.0, 4000.0, 20e3] {
        assert_eq!(alone.reader().height([20e3 + r, 20e3]), smooth.cone.at(r).0);
    }
    let other = Edifice { at_m: [26e3, 20e3], ..smooth.clone() };
    let both = Edifices::new(vec![smooth.clone(), other], 50.0);
    let mut reader = both.reader();
    // Where one is 2000 m and the other 164 m high: 2000·(1 + 0.082⁴)^¼.
    let rim = reader.height([19.4e3, 20e3]);
    assert!((rim / 2000.0 - 1.0).abs() < 1e-4, "{rim}");
    assert!(rim - reader.height([20e3, 20e3]) > 250.0, "the crater is there");
    // Between them both are equal: 2^¼ of one.
    let middle = reader.height([23e3, 20e3]);
    assert!((middle / smooth.cone.at(3000.0).0 - 2.0f64.powf(0.25)).abs() < 1e-9);
}

#[test]
fn turbulence_has_the_mean_and_deviation_it_is_scaled_by() {
    for hurst in [0.4, 0.75, 1.0] {
        turbulence_is_scaled(hurst);
    }
}

fn turbulence_is_scaled(hurst: f64) {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for seed in 0..64 {
        let noise = crate::noise::Fbm::new(1.0, hurst).octaves(Key::new(seed), 1e-6);
        let mut sampler = noise.sampler();
        let mut stream = Key::new(seed).named("at").stream();
        for _ in 0..2000 {
            let t = sampler.turbulence([stream.between(0.0, 500.0), stream.between(0.0, 500.0)]);
            (sum, squares, count) = (sum + t, squares + t * t, count + 1.0);
        }
    }
    let mean: f64 = sum / count;
    let deviation = (squares / count - mean * mean).sqrt();
    // 128,000 samples: standard errors 0.0003 and 0.0002, some more for samples that lie near one another. Cells of a
    // millionth leave out half a per cent of the sum at the lowest Hurst exponent.
    let [known_mean, known_deviation] = Roughness { hurst, ..rough(0.0, 0.0) }.turbulence();
    let least = 0.99 * known_mean - 2e-3;
    assert!((least..known_mean + 2e-3).contains(&mean), "{hurst}: {mean}, not {known_mean}");
    assert!((deviation / known_deviation - 1.0).abs() < 0.03, "{hurst}: {deviation}, not {known_deviation}");
}

#[test]
fn a_default_volcano_has_a_crater_and_a_vent_in_it() {
    let mut world = sea_floor(256, 60e3, 0.0);
    run(VolcanoParams::default(), Blend::Add, &mut world).unwrap();
    let (middle, top) = (world.height().at(128, 128) as f64, world.height().range().unwrap().1 as f64);
    assert!(top - middle > 200.0, "{top} {middle}");
    let [vent] = world.vents()[..] else { panic!("one vent") };
    assert_eq!((vent.at_m, vent.radius_m, vent.age_yr), ([30e3, 30e3], 0.08 * 12e3, 0.0));
    // Another stage adds its own.
    run(VolcanoParams { at_km: Some([10.0, 50.0]), ..VolcanoParams::default() }, Blend::Max, &mut world).unwrap();
    assert_eq!(world.vents().len(), 2);
}

fn chain(chain: Chain) -> VolcanoParams {
    VolcanoParams {
        place: Place::Chain,
        at_km: Some([700.0, 700.0]),
        height_m: 9000.0,
        radius_km: Some(50.0),
        noise: 0.0,
        turbulence: 0.0,
        chain,
        ..VolcanoParams::default()
    }
}

#[test]
fn a_chain_is_carried_off_by_its_plate_and_ages() {
    let straight = Chain { heading_deg: Some(270.0), speed_mm_per_yr: Some(80.0), variety: 0.0, ..Chain::default() };
    let mut world = sea_floor(200, 1000e3, -5000.0);
    run(chain(straight.clone()), Blend::Add, &mut world).unwrap();
    let vents = world.vents();
    assert_eq!(vents.len(), 8);
    for (i, vent) in vents.iter().enumerate() {
        assert!((vent.at_m[0] - (700e3 - 80e3 * i as f64)).abs() < 1.0 && (vent.at_m[1] - 700e3).abs() < 1.0);
        assert_eq!(vent.age_yr, 1e6 * i as f64);
    }
    // Older ones are lower, flank by flank.
    let height = world.height();
    let flank = |i: usize| crate::grid::linear(&height, [700e3 - 80e3 * i as f64, 700e3 + 15e3]);
    assert!((1..8).all(|i| flank(i) < flank(i - 1)), "{:?}", [0, 1, 2, 3, 4, 5, 6, 7].map(flank));

    // A bend: what is older than 4 My lies north of the fourth.
    let bent = Chain { bend_myr: Some(4.0), earlier_heading_deg: 0.0, ..straight };
    let mut world = sea_floor(64, 1000e3, -5000.0);
    run(chain(bent), Blend::Add, &mut world).unwrap();
    let last = world.vents()[7].at_m;
    assert!((last[0] - (700e3 - 320e3)).abs() < 1.0 && (last[1] - (700e3 - 240e3)).abs() < 1.0, "{last:?}");
}

#[test]
fn a_chain_reads_the_motion_of_the_plate_below_it() {
    let mut world = sea_floor(64, 1000e3, -5000.0);
    world.time_yr = 4e6;
    let mut ids = Field::filled(world.grid, 0.0);
    ids.data[64 * 44 + 44] = 1.0;
    world.set_layer(Layer::PlateId, ids);
    world.set_table(
        Table::new("plates")
            .number("id", "1", vec![0.0, 1.0])
            .number("x_km", "km", vec![700.0, 0.0])
            .number("y_km", "km", vec![700.0, 0.0])
            .number("speed_mm_per_yr", "mm/yr", vec![10.0, 100.0])
            .number("heading_deg", "deg", vec![0.0, 270.0])
            .number("first_speed_mm_per_yr", "mm/yr", vec![10.0, 50.0])
            .number("first_heading_deg", "deg", vec![0.0, 270.0]),
    );
    let params = chain(Chain { variety: 0.0, ..Chain::default() });
    run(params.clone(), Blend::Add, &mut world).unwrap();
    // 4 My at 75 mm/yr on the mean, from then on at 50.
    let at: Vec<f64> = world.vents().iter().map(|vent| 700e3 - vent.at_m[0]).collect();
    assert!((at[4] - 300e3).abs() < 1.0 && (at[7] - 450e3).abs() < 1e3, "{at:?}");
    assert!(world.vents().iter().all(|vent| (vent.at_m[1] - 700e3).abs() < 1.0));
    // Off the map the nearest plate's.
    world.remove_table("vents");
    run(VolcanoParams { at_km: Some([700.0, 1001.0]), ..params }, Blend::Add, &mut world).unwrap();
    assert!(world.vents().iter().all(|vent| (vent.at_m[0] - 700e3).abs() < 1.0), "{:?}", world.vents());
}

#[test]
fn arcs_stand_along_the_table_and_are_refused_without_one() {
    let params =
        VolcanoParams { place: Place::Arc, height_m: 2000.0, radius_km: Some(15.0), ..VolcanoParams::default() };
    let mut world = sea_floor(128, 400e3, -1000.0);
    let error = run(params.clone(), Blend::Add, &mut world).unwrap_err().to_string();
    assert!(error.contains("plates") && !error.contains('\n'), "{error}");
    let x: Vec<f64> = (0..80).map(|i| 5.0 * i as f64).collect();
    world.set_table(Table::new("arcs").number("y_km", "km", vec![200.0; 80]).number("x_km", "km", x));
    run(params, Blend::Add, &mut world).unwrap();
    let vents = world.vents();
    assert!((7..=11).contains(&vents.len()), "{}", vents.len());
    assert!(vents.iter().all(|vent| (vent.at_m[1] - 200e3).abs() <= 5e3));
    for (i, a) in vents.iter().enumerate() {
        assert!(vents[..i].iter().all(|b| (a.at_m[0] - b.at_m[0]).hypot(a.at_m[1] - b.at_m[1]) > 37e3));
    }
}

#[test]
fn what_does_not_go_together_is_said_in_one_line() {
    let p = VolcanoParams::default;
    let entry = |at_km| VolcanoEntry {
        at_km,
        height_m: None,
        radius_km: None,
        crater_height_m: None,
        crater_radius_m: None,
        age_myr: None,
        profile: None,
    };
    let wide = VolcanoEntry { crater_radius_m: Some(9e3), ..entry([30.0, 30.0]) };
    let bad = [
        (VolcanoParams { at_km: Some([90.0, 30.0]), ..p() }, "at_km = [90, 30]"),
        (VolcanoParams { at_km: Some([f64::NAN, 30.0]), ..p() }, "at_km must be"),
        (VolcanoParams { crater_radius_m: Some(12e3), ..p() }, "as wide as the volcano"),
        (VolcanoParams { crater_height_m: Some(2501.0), ..p() }, "higher than its rim"),
        (
            VolcanoParams { radius_km: Some(5.0), volcanoes: vec![entry([1.0, 2.0]), wide], ..p() },
            "volcanoes[2]: a crater",
        ),
        (VolcanoParams { volcanoes: vec![entry([-80.0, 2.0])], ..p() }, "volcanoes[1]: at_km"),
        (VolcanoParams { place: Place::Chain, volcanoes: vec![entry([1.0, 2.0])], ..p() }, "'volcanoes'"),
    ];
    for (params, what) in bad {
        let error = run(params, Blend::Add, &mut sea_floor(32, 60e3, 0.0)).unwrap_err().to_string();
        assert!(error.contains(what) && !error.contains('\n'), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever a recipe may ask for: finite ground, never below the foot, and none of it moves when the map gets finer.
    #[test]
    fn any_volcano_is_finite_and_stands_on_its_foot(
        height_m in 0.0f64..20000.0,
        radius_km in 0.001f64..10000.0,
        crater in 0.0f64..0.999,
        floor in 0.0f64..1.0,
        transition in 1.0f64..10.0,
        noise in 0.0f64..1.0,
        turbulence in 0.0f64..1.0,
        frequency in 0.1f64..100.0,
        age_myr in 0.0f64..500.0,
        extent_m in 10.0f64..4e7,
        profile in prop_oneof![Just(Profile::Smoothstep), Just(Profile::Gaussian), Just(Profile::Exponential)],
    ) {
        let mut world = sea_floor(16, extent_m, -1000.0);
        let params = VolcanoParams {
            height_m,
            radius_km: Some(radius_km),
            crater_height_m: Some(floor * height_m),
            crater_radius_m: Some(crater * radius_km * 1e3),
            transition,
            noise,
            noise_frequency: frequency,
            turbulence,
            age_myr,
            profile,
            ..VolcanoParams::default()
        };
        run(params, Blend::Add, &mut world).unwrap();
        let (low, high) = world.height().range().unwrap();
        prop_assert!(world.first_non_finite().is_none());
        prop_assert!(low >= -1000.0 && high.is_finite(), "{low} {high}");
    }
}
