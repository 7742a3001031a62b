//! Air against what can be worked out by hand.

use super::{
    air::{Air, Below, Habits, saturation_mm},
    *,
};
use crate::grid::{Edges, Field, Grid};

const EXTENT_M: f64 = 1000e3;

fn habits() -> Habits {
    Habits { wind_m_per_s: 3.0, rim_humidity: 0.75, lift_share: 0.35, delay_s: 5000.0, shadow_m: 250e3 }
}

/// Ground under a west wind at 45 degrees, where belts add nothing.
fn below(grid: Grid, height: impl Fn(f64, f64) -> f64 + Sync, sea: impl Fn(f64, f64) -> bool + Sync) -> Below {
    let at = |x: usize, y: usize| grid.center_m(x, y);
    let params = ClimateParams { wind_from_deg: Some(270.0), latitude_span_deg: Some(0.0), ..Default::default() };
    Below::new(
        Field::from_fn(grid, |x, y| height(at(x, y)[0], at(x, y)[1]) as f32),
        Field::from_fn(grid, |x, y| f32::from(sea(at(x, y)[0], at(x, y)[1]))),
        Zone::rows(&grid, &params),
    )
}

fn square(edges: Edges) -> Grid {
    Grid::new(CELLS, CELLS, EXTENT_M, edges)
}

/// A smooth wave for rough ground.
fn hills(x: f64, y: f64) -> f64 {
    let wave = |k: f64, s: f64| libm::sin((k * x + s * y) * std::f64::consts::TAU / EXTENT_M);
    (1500.0 * wave(3.0, 1.0) * wave(-1.0, 4.0) + 800.0).max(0.0)
}

#[test]
fn flat_land_dries_exponentially_from_the_coast() {
    let grid = square(Edges::Open);
    let (land, habits) = (below(grid, |_, _| 0.0, |_, _| false), habits());
    let air = Air::over(&land, habits, 0.0);
    let rain: Vec<f64> = air.rain().collect();
    let row = |x: usize| rain[grid.index(x, 100)];
    // W' = -(1 - r) W / (u stay): upwind differences turn exp(-d/L) into (1 + d/L)^-1 a cell, and the short delay of
    // the cloud adds a term of its own size over L, 15 km of 3456 km.
    let length_m = 3.0 * 8.0 * 86_400.0 / 0.6;
    let (near, far) = (60, 250);
    let measured = (far - near) as f64 * grid.cell_m / libm::log(row(near) / row(far));
    assert!((measured / length_m - 1.0).abs() < 0.01, "{measured} {length_m}");
    // What falls at the coast is what came in over the stay.
    let coast = 0.75 * saturation_mm(land.zones[0].sea_degc) / (8.0 * 86_400.0);
    assert!((row(0) / coast - 1.0).abs() < 0.01);
}

#[test]
fn a_ramp_rains_what_its_ascent_condenses() {
    let grid = square(Edges::Open);
    let slope = 4e-3;
    let land = below(grid, |x, _| slope * x, |_, _| false);
    let habits = habits();
    let air = Air::over(&land, habits, 0.0);
    let rain: Vec<f64> = air.rain().collect();
    let row = |x: usize| rain[grid.index(x, 40)];
    // (a + b)(1 - r) per metre: a = 0.35 slope / 2000 m, b = 1/(u stay).
    let rate = 0.6 * (0.35 * slope / 2000.0 + 1.0 / (3.0 * 8.0 * 86_400.0));
    // Far enough from the rim for the cloud to follow (15 km).
    let (near, far) = (40, 230);
    let measured = libm::log(row(near) / row(far)) / ((far - near) as f64 * grid.cell_m);
    // Upwind: log(1 + d·rate)/d, 0.2 % at 4 km; the delay: rate times 15 km, 0.9 %.
    assert!((measured / rate - 1.0).abs() < 0.015, "{measured} {rate}");
}

#[test]
fn a_ridge_is_wet_to_windward_and_dry_in_its_lee() {
    let grid = square(Edges::Open);
    let middle = 0.5 * EXTENT_M;
    let bell = |x: f64, _: f64| 2500.0 / (1.0 + ((x - middle) / 40e3) * ((x - middle) / 40e3));
    let land = below(grid, bell, |x, _| x < 200e3);
    let air = Air::over(&land, habits(), 0.0);
    let rain: Vec<f64> = air.rain().collect();
    let mean = |from_km: f64, to_km: f64| {
        let cells: Vec<f64> = (0..CELLS)
            .filter(|&x| (from_km..to_km).contains(&(grid.center_m(x, 0)[0] / 1e3)))
            .map(|x| rain[grid.index(x, 128)])
            .collect();
        cells.iter().sum::<f64>() / cells.len() as f64
    };
    let (plain, windward, lee, far) = (mean(250.0, 350.0), mean(440.0, 500.0), mean(560.0, 640.0), mean(900.0, 1000.0));
    assert!(windward > 3.0 * plain, "{windward} {plain}");
    assert!(lee < 0.35 * plain && far > 1.5 * lee && far < plain, "{lee} {far} {plain}");
}

#[test]
fn water_balances() {
    for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
        let grid = Grid { width: 96, height: 64, ..Grid::new(96, 64, 600e3, edges) };
        let land = below(grid, hills, |x, y| hills(x, y) <= 0.0);
        for turn_deg in [-120.0, -30.0, 0.0, 45.0, 90.0, 180.0] {
            let budget = Air::over(&land, habits(), turn_deg).budget();
            let moved = budget.from_sea.abs() + budget.from_rim;
            assert!(moved > 0.0 && budget.to_ground > 0.0);
            // Sums of 6144 cells in f64; laps end at 1e-12.
            assert!(budget.residual().abs() < 1e-9 * moved, "{edges:?} {turn_deg}: {budget:?}");
        }
    }
}

#[test]
fn water_balances_where_winds_meet_and_part() {
    let grid = Grid { height: 90, ..Grid::new(80, 90, 4000e3, Edges::Open) };
    let params = ClimateParams { latitude_deg: 0.0, latitude_span_deg: Some(180.0), ..Default::default() };
    let mut land = below(grid, hills, |x, y| hills(x, y) <= 0.0);
    land.zones = Zone::rows(&grid, &params);
    let air = Air::over(&land, habits(), 10.0);
    let budget = air.budget();
    assert!(budget.residual().abs() < 1e-9 * (budget.from_sea.abs() + budget.from_rim), "{budget:?}");
    assert!(air.rain().all(|rain| rain.is_finite() && rain >= 0.0));
}

#[test]
fn a_seamless_world_has_no_seam() {
    // The same ground shifted gives the same weather shifted.
    let grid = Grid::new(64, 64, 800e3, Edges::Wrap);
    let tau = std::f64::consts::TAU / 800e3;
    let ground = |x: f64, y: f64| 900.0 * (libm::sin(2.0 * tau * x) + libm::cos(tau * y + tau * x)) - 400.0;
    let shifted = |by: f64| {
        let land = below(grid, |x, y| ground(x + by, y).max(0.0), |x, y| ground(x + by, y) < 0.0);
        Air::over(&land, habits(), 30.0).rain().collect::<Vec<f64>>()
    };
    let (plain, moved) = (shifted(0.0), shifted(20.0 * grid.cell_m));
    for y in 0..64 {
        for x in 0..64 {
            let (a, b) = (plain[grid.index((x + 20) % 64, y)], moved[grid.index(x, y)]);
            // Heights are f32; laps end at 1e-12.
            assert!((a / b - 1.0).abs() < 1e-4, "{x} {y}: {a} {b}");
        }
    }
}

#[test]
fn it_gets_colder_with_height_and_latitude() {
    let params = ClimateParams::default();
    let alps = Zone::at(45.0, &params);
    assert!((alps.temperature_degc(1000.0) - alps.temperature_degc(2000.0) - 6.5).abs() < 1e-9);
    assert_eq!(alps.temperature_degc(-500.0), alps.sea_degc);
    assert!((alps.sea_degc - 9.5).abs() < 1e-9);
    let colder = (0..90).all(|deg| {
        let at = |deg: i32| Zone::at(f64::from(deg), &params).sea_degc;
        at(deg) > at(deg + 1) && at(-deg) == at(deg)
    });
    assert!(colder);
}

#[test]
fn snow_lies_where_it_does_on_earth() {
    let params = ClimateParams::default();
    let line = |deg: f64, rain: f64| water::snow_line_m(&Zone::at(deg, &params), rain);
    // Equilibrium lines of glaciers: the tropical Andes and Ruwenzori 4600 m to 5100 m, the Alps 2700 m to 3000 m,
    // Scandinavia at 65 degrees 1100 m to 1500 m.
    for (deg, rain, low, high) in
        [(0.0, 1200.0, 4600.0, 5100.0), (46.0, 1300.0, 2500.0, 3000.0), (65.0, 1300.0, 1000.0, 1500.0)]
    {
        let m = line(deg, rain);
        assert!(m > low && m < high, "{deg}: {m}");
    }
    assert!(line(45.0, 300.0) > line(45.0, 2000.0) + 400.0, "dry air raises it");
    assert_eq!(snow_temperature_degc(645.0), 0.0);
}

#[test]
fn winds_follow_their_belts() {
    let params = ClimateParams::default();
    let wind = |deg: f64| Zone::at(deg, &params).wind;
    // East positive, south positive.
    assert!(wind(15.0)[0] < -0.8 && wind(15.0)[1] > 0.3, "north-east trades");
    assert!(wind(-15.0)[0] < -0.8 && wind(-15.0)[1] < -0.3, "south-east trades");
    assert!(wind(45.0)[0] > 0.8 && wind(45.0)[1] < -0.3, "westerlies towards the pole");
    assert!(wind(75.0)[0] < -0.8);
    assert!(libm::hypot(wind(45.0)[0], wind(45.0)[1]) <= 1.0 + 1e-12);
    let fixed = ClimateParams { wind_from_deg: Some(90.0), ..params };
    assert!((Zone::at(45.0, &fixed).wind[0] + 1.0).abs() < 1e-12, "from the east is to the west");
}

#[test]
fn what_runs_off_is_less_than_rain() {
    for t in [-20.0, 0.0, 10.0, 25.0] {
        let mut before = 0.0;
        for rain in [10.0, 100.0, 500.0, 1000.0, 4000.0] {
            let runoff = runoff_mm_per_yr(rain, t);
            assert!(runoff >= before && runoff < rain, "{t} {rain}");
            before = runoff;
        }
    }
    // Turc's own example of a mild land: 10 degC could take up 600 mm; of 800 mm, 480 mm evaporate.
    assert!((runoff_mm_per_yr(800.0, 10.0) - 320.0).abs() < 0.1);
    assert_eq!(runoff_mm_per_yr(0.0, 10.0), 0.0);
}

#[test]
fn biomes_of_known_places() {
    let places = [
        (27.0, 2300.0, Biome::TropicalRainForest), // Manaus
        (28.0, 800.0, Biome::Savanna),             // Bamako
        (24.0, 60.0, Biome::Desert),               // Sahara
        (16.0, 560.0, Biome::Shrubland),           // Marseille
        (10.0, 700.0, Biome::TemperateForest),     // Paris
        (9.0, 3000.0, Biome::TemperateRainForest), // the west coast of New Zealand
        (9.0, 320.0, Biome::Grassland),            // Denver's plains
        (-1.0, 600.0, Biome::Taiga),               // Arkhangelsk
        (-12.0, 150.0, Biome::Tundra),             // Tiksi
    ];
    for (t, rain, biome) in places {
        assert_eq!(Biome::of(t, rain), biome, "{t} {rain}");
    }
    let crate::world::Kind::Class(names) = crate::world::Layer::Biome.spec().kind else { panic!() };
    assert_eq!(names[Biome::TropicalRainForest as usize], "tropical rain forest");
    assert_eq!(names[Biome::Ice as usize], "ice");
}

#[test]
fn larger_maps_have_the_same_weather() {
    let over = |size: usize| {
        let grid = Grid::new(size, size, EXTENT_M, Edges::Open);
        let height = Field::from_fn(grid, |x, y| {
            let [x, y] = grid.center_m(x, y);
            (hills(x, y) - 200.0) as f32
        });
        Weather::over(&height, 0.0, &ClimateParams::default(), None).rain_mm_per_yr
    };
    let (small, large) = (over(128), over(512));
    let (mut apart, mut sum) = (0.0f64, 0.0);
    for y in 0..128 {
        for x in 0..128 {
            let block = |i: usize| large.at(4 * x + i % 4, 4 * y + i / 4) as f64;
            let mean = (0..16).map(block).sum::<f64>() / 16.0;
            let own = (small.at(x, y) as f64 / mean - 1.0).abs();
            (apart, sum) = (apart.max(own), sum + own);
        }
    }
    // Crests are rounded by cells of 8 km, which shows where a shadow is deepest.
    assert!(apart < 0.15 && sum / 16_384.0 < 0.01, "{apart} {sum}");
}

#[test]
fn odd_worlds_have_weather() {
    for (height, edges) in [(-500.0f32, Edges::Open), (500.0, Edges::Open), (0.0, Edges::Closed), (700.0, Edges::Wrap)]
    {
        let flat = Field::filled(Grid::new(20, 16, 50e3, edges), height);
        for wanted in [None, Some(900.0)] {
            let params = ClimateParams { rain_mm_per_yr: wanted, ..Default::default() };
            let weather = Weather::over(&flat, 0.0, &params, None);
            let rain = weather.rain_mm_per_yr.range().expect("finite");
            assert!(rain.0 >= 0.0 && rain.1 < 3000.0, "{height} {edges:?}: {rain:?}");
            if let Some(wanted) = wanted
                && height >= 0.0
            {
                assert!((rain.0 as f64 - wanted).abs() < 0.05 * wanted, "{height} {edges:?}: {rain:?}");
            }
            assert!(weather.snow_line_m.range().is_some() && weather.biome.range().is_some());
        }
    }
    let ugly = ClimateParams {
        latitude_deg: 0.0,
        latitude_span_deg: Some(180.0),
        wind_m_per_s: 50.0,
        wind_spread_deg: 90.0,
        warmer_k: 40.0,
        lapse_k_per_km: 0.0,
        rim_humidity: 1.0,
        air_km: 1.0,
        drift_km: 100.0,
        lift_share: 1.0,
        shadow_km: 1.0,
        ..Default::default()
    };
    let spiky =
        Field::from_fn(Grid::new(64, 64, 64e3, Edges::Wrap), |x, y| ((x * 7919 + y * 104_729) % 9000) as f32 - 2000.0);
    let weather = Weather::over(&spiky, 0.0, &ugly, None);
    assert!(weather.rain_mm_per_yr.range().is_some_and(|(low, _)| low >= 0.0));
    assert!(weather.snow_line_m.range().is_some());
}
