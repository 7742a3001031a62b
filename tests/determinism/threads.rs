//! Any number of threads gives the same bits.

use std::process::Command;

use upthrust::{
    measure::layer_stats,
    recipe::{Plan, presets},
};

use super::{run, small};

#[test]
fn every_preset_is_the_same_for_one_two_and_eight_threads() {
    let on = |threads: usize, plan: &Plan| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(plan, &mut []))
    };
    for preset in presets() {
        let plan = small(preset, "128x112");
        let one = on(1, &plan);
        for threads in [2, 8] {
            let many = on(threads, &plan);
            // Hashes first: they name the layer that differs.
            assert_eq!(layer_stats(&one), layer_stats(&many), "{} with {threads} threads", preset.name);
            assert!(one == many, "{} with {threads} threads: tables or books differ", preset.name);
        }
    }
}

#[test]
fn the_program_gives_the_same_hashes_for_any_threads() {
    let folder = tempfile::tempdir().unwrap();
    let layers = |threads: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_upthrust"))
            .args(["grow", "blocks", "--size", "128", "--json", "--threads", threads, "--out", threads])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let manifest: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(manifest["threads"].to_string(), threads);
        manifest["layers"].clone()
    };
    let one = layers("1");
    assert!(one.as_array().is_some_and(|layers| layers.len() > 5));
    assert_eq!(one, layers("2"));
    assert_eq!(one, layers("8"));
}
