//! How lava cools and freezes.

use super::*;

/// Lava that lies still in a box, and cools only as told.
fn still(params: LavaSheetParams, depth: f64) -> (Sheet, Law, Grid) {
    let law = Law::new(&params);
    let grid = square(4, 40.0);
    let mut sheet = on(&grid, |_, _| 0.0);
    pool(&mut sheet, &grid, &law, |_, _| depth);
    (sheet, law, grid)
}

fn degc(sheet: &Sheet, law: &Law, grid: &Grid) -> f64 {
    let i = sheet.cell(grid, 5);
    law.melt.degc(sheet.heat[i] / sheet.molten[i])
}

/// Steps of a length.
fn paced(sheet: &mut Sheet, law: &Law, seconds: f64, step_s: f64) {
    for _ in 0..(seconds / step_s).round() as usize {
        assert_eq!(sheet.advance(law, &[], step_s), step_s);
    }
}

/// No latent heat: mush from 0 to 1 °C, out of the way.
fn plain() -> LavaSheetParams {
    LavaSheetParams { latent_heat_j_per_kg: 0.0, solidus_degc: 30.0, liquidus_degc: 31.0, ..warm() }
}

#[test]
fn air_cools_lava_as_newton_says() {
    // T = Tₐ + (T₀ − Tₐ)·exp(−k t/(ρ c h)).
    let params = LavaSheetParams { air_w_per_m2_k: 400.0, crust_factor: 0.5, ..plain() };
    let (mut sheet, law, grid) = still(params.clone(), 2.0);
    let rate = 0.5 * 400.0 / (2600.0 * 1150.0 * 2.0);
    let whole = 1.0 / rate;
    paced(&mut sheet, &law, whole, whole / 1000.0);
    let want = 20.0 + 1130.0 * (-1.0f64).exp();
    let found = degc(&sheet, &law, &grid);
    // First order: an error of half a step's share.
    assert!((found - want).abs() < 0.5, "{found} {want}");
    let (mut coarse, ..) = still(params, 2.0);
    paced(&mut coarse, &law, whole, whole / 100.0);
    let ratio = (degc(&coarse, &law, &grid) - want) / (found - want);
    assert!((ratio - 10.0).abs() < 0.5, "not of first order: {ratio}");
}

#[test]
fn the_sky_cools_lava_as_stefan_says() {
    // To 0 K: T⁻³ = T₀⁻³ + 3 ε σ t/(ρ c h).
    let params = LavaSheetParams { emissivity: 1.0, crust_factor: 1.0, ambient_degc: -273.15, ..plain() };
    let (mut sheet, law, grid) = still(params, 1.0);
    let per = 5.670374419e-8 / (2600.0 * 1150.0);
    let seconds = 20_000.0;
    paced(&mut sheet, &law, seconds, 10.0);
    let want = (1423.15f64.powi(-3) + 3.0 * per * seconds).powf(-1.0 / 3.0) - 273.15;
    let found = degc(&sheet, &law, &grid);
    assert!((found - want).abs() < 1.0, "{found} {want}");
}

#[test]
fn latent_heat_keeps_lava_molten() {
    // At a constant loss the time to freeze is the heat above the solidus over that loss; here the loss hardly changes.
    let params = LavaSheetParams { air_w_per_m2_k: 100.0, crust_factor: 1.0, ambient_degc: -200.0, ..warm() };
    let (mut sheet, law, grid) = still(params, 1.0);
    let above = law.fresh - law.rock;
    assert!((above - (1150.0 * 150.0 + 0.75 * 3.5e5)).abs() < 1e-6);
    // Newton in the mush, of heat capacity c + L/200 K.
    let mush: f64 = 1150.0 + 3.5e5 / 200.0;
    let want = 2600.0 * mush / 100.0 * (1350.0f64 / 1200.0).ln();
    let mut seconds = 0.0;
    while sheet.molten[sheet.cell(&grid, 5)] > 0.0 {
        seconds += sheet.advance(&law, &[], 10.0);
    }
    assert!((seconds / want - 1.0).abs() < 0.01, "{seconds} {want}");
    assert!((sheet.frozen[sheet.cell(&grid, 5)] - 1.0).abs() < 1e-12);
}

#[test]
fn the_ground_freezes_lava_from_below_as_stefan_says() {
    // dh/dt = −k (T − Tₐ)/(ρ (e − e_solidus)), and the rest stays as hot as it was.
    let params = LavaSheetParams { ground_w_per_m2_k: 50.0, ..warm() };
    let (mut sheet, law, grid) = still(params, 3.0);
    paced(&mut sheet, &law, 20_000.0, 100.0);
    let want = 20_000.0 * 50.0 * 1130.0 / (2600.0 * (law.fresh - law.rock));
    let i = sheet.cell(&grid, 5);
    assert!((sheet.frozen[i] / want - 1.0).abs() < 1e-9, "{} {want}", sheet.frozen[i]);
    assert!((degc(&sheet, &law, &grid) - 1150.0).abs() < 1e-9);
    assert!((sheet.frozen[i] + sheet.molten[i] - 3.0).abs() < 1e-12 && (sheet.bed[i] - sheet.frozen[i]).abs() < 1e-12);
}

#[test]
fn the_sea_freezes_lava_many_times_faster() {
    let wet = LavaSheetParams { sea_w_per_m2_k: 5000.0, air_w_per_m2_k: 50.0, emissivity: 0.95, ..warm() };
    let law = Law::new(&wet);
    let grid = square(4, 40.0);
    let until_frozen = |sea_m: f64| {
        let mut sheet = Sheet::new(&grid, |_, _| 0.0, sea_m);
        pool(&mut sheet, &grid, &law, |_, _| 5.0);
        let mut seconds = 0.0;
        while sheet.molten.iter().any(|&h| h > 0.0) {
            seconds += sheet.advance(&law, &[], 20.0);
        }
        seconds
    };
    let (under, half, dry) = (until_frozen(10.0), until_frozen(2.5), until_frozen(-10.0));
    assert!(under < half && 50.0 * under < dry, "{under} {half} {dry}");
}

#[test]
fn heat_moves_with_lava_and_none_is_lost_without_losses() {
    let law = Law::new(&warm());
    let grid = Grid::new(48, 48, 480.0, Edges::Wrap);
    let mut sheet = on(&grid, |x, y| 10.0 * (x * std::f64::consts::TAU / 480.0).sin() + 8.0 * (y * 0.0262).cos());
    pool(&mut sheet, &grid, &law, |x, y| if (x - 240.0).hypot(y - 240.0) < 100.0 { 8.0 } else { 0.0 });
    // One half cooler than the other.
    let (cold, hot) = (law.melt.enthalpy(1050.0), law.fresh);
    for i in 0..sheet.heat.len() / 2 {
        sheet.heat[i] = sheet.molten[i] * cold;
    }
    let (volume, heat): (f64, f64) = (sheet.molten.iter().sum(), sheet.heat.iter().sum());
    run(&mut sheet, &law, &[], 2000.0);
    let (volume_after, heat_after): (f64, f64) = (sheet.molten.iter().sum(), sheet.heat.iter().sum());
    assert!((volume_after / volume - 1.0).abs() < 1e-12 && (heat_after / heat - 1.0).abs() < 1e-12);
    // No cell is hotter than the hottest or colder than the coldest that flowed into it.
    for (h, e) in sheet.molten.iter().zip(&sheet.heat).filter(|(h, _)| **h > 1e-6) {
        assert!(e / h >= cold * (1.0 - 1e-9) && e / h <= hot * (1.0 + 1e-9), "{} {h}", e / h);
    }
}
