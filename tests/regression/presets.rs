//! Hashes of every preset at a small size, and what each preset states of its convergence.

use std::{fmt::Write, path::Path};

use upthrust::{
    measure::layer_stats,
    recipe::{Preset, presets},
    world::World,
};

use super::grown;

const SIZE: &str = "64";

fn hashes(preset: &Preset, world: &World) -> String {
    let mut lines = String::new();
    for stats in layer_stats(world) {
        writeln!(lines, "{:<20} {:<16} {}", preset.name, stats.layer, stats.hash).unwrap();
    }
    lines
}

/// Renewed only on purpose: `UPDATE_HASHES=1 cargo test --release --test regression`.
#[test]
fn every_preset_has_its_published_hashes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/regression/hashes.txt");
    let mut found = format!("# SHA-256 (first 16 digits) of every layer of every preset at {SIZE} x {SIZE}.\n");
    for preset in presets() {
        // Lava takes as long at any size of the map: a beginning of it will do.
        let sooner: &[&str] = if preset.text.contains("kind = \"lava\"") { &["lava.duration_min=0.1"] } else { &[] };
        let (plan, world) = grown(preset, SIZE, sooner);
        // The map that the plates moved on; a zoom may have gone into it since.
        assert_convergence(preset, plan.world.grid().extent_m()[0], &world);
        found += &hashes(preset, &world);
    }
    if std::env::var_os("UPDATE_HASHES").is_some_and(|v| v == "1") {
        std::fs::write(&path, &found).unwrap();
    }
    let published = std::fs::read_to_string(&path).unwrap_or_default();
    let changed: Vec<&str> = found.lines().filter(|line| !published.lines().any(|old| old == *line)).collect();
    let gone: Vec<&str> = published.lines().filter(|line| !found.lines().any(|new| new == *line)).collect();
    assert!(
        changed.is_empty() && gone.is_empty(),
        "worlds differ from the published ones; renew tests/regression/hashes.txt with UPDATE_HASHES=1 if that is meant\n\
         now:\n{}\npublished:\n{}",
        changed.join("\n"),
        gone.join("\n")
    );
}

/// Plates may close by less than two fifths of the map, and by no more than the preset's description says.
fn assert_convergence(preset: &Preset, map_m: f64, world: &World) {
    let Some(table) = world.table("convergence") else { return };
    let closed_km = table.numbers("closed_km").unwrap().iter().fold(0.0f64, |most, &km| most.max(km));
    let share = closed_km * 1e3 / map_m;
    println!("{}: closed {closed_km:.0} km, {:.1} % of the map", preset.name, share * 100.0);
    assert!(share < 0.4, "{} closes {:.1} % of the map", preset.name, share * 100.0);
    let stated = stated_percent(&preset.summary().1);
    let stated = stated.unwrap_or_else(|| panic!("{} does not say how many '% of the map' it closes", preset.name));
    assert!(stated < 40.0 && share * 100.0 <= stated, "{}: {:.1} of {stated} %", preset.name, share * 100.0);
}

/// The number before "% of the map".
fn stated_percent(description: &str) -> Option<f64> {
    let (before, _) = description.split_once("% of the map")?;
    before.split_whitespace().last()?.parse().ok()
}
