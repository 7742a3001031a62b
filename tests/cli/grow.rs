//! What a good run leaves behind.

use super::Place;

fn manifest(place: &Place, world: &str) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(place.path(world).join("manifest.json")).unwrap()).unwrap()
}

#[test]
fn a_folder_holds_the_world_and_its_numbers() {
    let place = Place::new();
    let said = place.run(&["grow", "warped-terraces", "--size", "64x48", "--out", "deep/world"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let lines: Vec<&str> = said.out.lines().collect();
    assert_eq!(lines.len(), 4);
    assert_eq!((lines[0], lines[1]), ("deep/world", "  upthrust inspect deep/world"));
    // Not a terminal: a line a stage.
    assert_eq!(said.err.lines().count(), 3, "{}", said.err);
    assert!(said.err.starts_with("1/3 fbm: 1 step, "), "{}", said.err);

    let mut names: Vec<_> = std::fs::read_dir(place.path("deep/world"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["height.png", "manifest.json", "relief.png", "series.csv", "world.zarr"]);
    assert_eq!(std::fs::read_dir(place.path("deep")).unwrap().count(), 1, "something stayed beside");

    let manifest = manifest(&place, "deep/world");
    assert_eq!(manifest["seed"], 5);
    assert_eq!(manifest["size"], serde_json::json!([64, 48]));
    assert_eq!(manifest["cell_m"], 120_000.0 / 64.0);
    assert_eq!(manifest["stages"].as_array().unwrap().len(), 3);
    assert_eq!(manifest["layers"][0]["layer"], "height");
    let (black, white) = (&manifest["height_png"]["black_m"], &manifest["height_png"]["white_m"]);
    assert_eq!((black, white), (&manifest["layers"][0]["min"], &manifest["layers"][0]["max"]));
    let picture = image::open(place.path("deep/world/height.png")).unwrap();
    assert_eq!((picture.width(), picture.height(), picture.color()), (64, 48, image::ColorType::L16));
    for account in manifest["ledger"].as_array().unwrap() {
        let share = account["residual_share"].as_f64().unwrap();
        assert!(share.abs() <= 1e-6, "{account}");
    }
}

#[test]
fn the_clocks_of_water_and_land_are_booked() {
    let place = Place::new();
    let water = "[world]\nsize = 32\nextent_km = 0.32\n[[stage]]\nkind = 'fbm'\nheight_m = 40\nwavelength_km = 0.2\n";
    let stages = [
        ("droplets", "duration_yr = 20.0\nmorphological_factor = 50.0", 20.0 * 31_557_600.0, 50.0),
        ("pipes", "duration_h = 0.1\nmorphological_factor = 8766.0e-1", 360.0, 876.6),
        ("hydraulic_cells", "duration_h = 0.5\nmorphological_factor = 1e4", 1800.0, 1e4),
    ];
    let set: String = stages.iter().map(|(kind, set, ..)| format!("[[stage]]\nkind = '{kind}'\n{set}\n")).collect();
    place.write("storms.toml", format!("{water}{set}"));
    let said = place.run(&["grow", "storms.toml", "--out", "w"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let clock = "note: stage 'droplets': 20 years of water stand for 1000 years of land (morphological_factor = 50)";
    assert!(said.err.contains(clock), "{}", said.err);
    let manifest = manifest(&place, "w");
    assert!(manifest["stages"][0].get("water_s").is_none(), "no water runs in {}", manifest["stages"][0]);
    let inspected = place.run(&["inspect", "w"]).out;
    for (k, (kind, _, water_s, factor)) in stages.into_iter().enumerate() {
        let stage = &manifest["stages"][k + 1];
        let near = |key: &str, want: f64| (stage[key].as_f64().unwrap() / want - 1.0).abs() < 1e-12;
        assert!(near("water_s", water_s) && near("morphological_factor", factor), "{stage}");
        // A clock that stands at 2,000 years is moved on a hundred times, and rounds to 2e-13 each time.
        let elapsed_yr = water_s * factor / 31_557_600.0;
        assert!((stage["elapsed_yr"].as_f64().unwrap() - elapsed_yr).abs() < 1e-10, "{stage}");
        // The store keeps them too.
        assert!(inspected.contains(&format!("h of water, {factor} times that of its bed")), "{kind}: {inspected}");
    }
}

#[test]
fn the_same_world_for_any_number_of_threads() {
    let place = Place::new();
    let hashes = |threads: &str| {
        let said = place.run(&["grow", "warped-terraces", "--size", "96", "--threads", threads, "--json"]);
        assert_eq!(said.err, "");
        let manifest: serde_json::Value = serde_json::from_str(&said.out).unwrap();
        assert_eq!(manifest["threads"], threads.parse::<u64>().unwrap());
        manifest["layers"].clone()
    };
    let one = hashes("1");
    assert_eq!(one, hashes("2"));
    assert_eq!(one, hashes("8"));
    // Three runs without --out stand side by side.
    for name in ["warped-terraces-5", "warped-terraces-5-2", "warped-terraces-5-3"] {
        assert!(place.path("worlds").join(name).is_dir(), "{name}");
    }
}

#[test]
fn the_kept_recipe_grows_the_same_world() {
    let place = Place::new();
    let first = ["grow", "fault-blocks", "--size", "48", "--seed", "77", "--set", "fault.faults=9", "--out", "a", "-q"];
    let said = place.run(&first);
    assert_eq!((said.code, said.out.as_str(), said.err.as_str()), (0, "a\n", ""));
    place.write("again.toml", manifest(&place, "a")["recipe"].as_str().unwrap());
    assert_eq!(place.run(&["grow", "again.toml", "--out", "b"]).code, 0);
    assert_eq!(manifest(&place, "a")["layers"], manifest(&place, "b")["layers"]);
    assert_eq!(manifest(&place, "b")["seed"], 77);
}

#[test]
fn force_replaces_a_world_and_until_ends_early() {
    let place = Place::new();
    let grow = |rest: &[&str]| place.run(&[&["grow", "warped-terraces", "--size", "16", "--out", "w"], rest].concat());
    assert_eq!(grow(&[]).code, 0);
    assert_eq!(grow(&[]).code, 2);
    let said = grow(&["--force", "--until", "terrace"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let manifest = manifest(&place, "w");
    assert_eq!(manifest["stages"].as_array().unwrap().len(), 2);
    assert_eq!(manifest["until"], "terrace");
    assert_eq!(std::fs::read_dir(place.folder.path()).unwrap().count(), 1);
}

#[test]
fn a_failed_force_keeps_the_old_world() {
    let place = Place::new();
    assert_eq!(place.run(&["grow", "rmp-graph", "--size", "16", "--out", "w"]).code, 0);
    let before = manifest(&place, "w");
    let entry = "[[stage.plate]]\nat_km = [100, 100]\nheading_deg = 0\nspeed_mm_per_yr = 1\n";
    place.write("twice.toml", format!("[world]\nsize = 16\n[[stage]]\nkind = \"plates\"\n{entry}{entry}"));
    assert_eq!(place.run(&["grow", "twice.toml", "--out", "w", "--force"]).code, 2);
    assert_eq!(manifest(&place, "w"), before);
    assert_eq!(std::fs::read_dir(place.folder.path()).unwrap().count(), 2);
}

#[test]
fn sheets_pictures_and_numbers() {
    let place = Place::new();
    let said = place.run(&["grow", "fbm-rough", "--size", "32", "--seeds", "3..5", "--sheet", "s.png"]);
    assert_eq!((said.code, said.out.as_str()), (0, "s.png\n"), "{}", said.err);
    assert!(image::open(place.path("s.png")).unwrap().width() > 96);
    assert_eq!(place.files(), ["s.png"]);

    assert_eq!(place.run(&["grow", "fbm-rough", "--size", "32", "--out", "w"]).code, 0);
    for world in ["w", "w/world.zarr"] {
        let said = place.run(&["inspect", world, "--json", "--report", "r.txt"]);
        assert_eq!(said.code, 0, "{}", said.err);
        let numbers: serde_json::Value = serde_json::from_str(&said.out).unwrap();
        assert_eq!(numbers["layers"], manifest(&place, "w")["layers"]);
        assert!(std::fs::read_to_string(place.path("r.txt")).unwrap().contains("hypsometry"));
        for view in ["relief", "slope", "bedrock"] {
            let said = place.run(&["render", world, "p.png", "--view", view]);
            assert_eq!((said.code, said.out.as_str()), (0, "p.png\n"), "{}", said.err);
            assert!(image::open(place.path("p.png")).is_ok());
        }
    }
    let said = place.run(&["render", "w", "q.png", "--view", "lava"]);
    let line = "error: --view lava: this world has no layer 'lava' (it has: height, slope, bedrock)\n";
    assert_eq!((said.code, said.err.as_str()), (2, line));
    assert!(!place.path("q.png").exists());
}

#[test]
fn random_seeds_are_told() {
    let place = Place::new();
    let said = place.run(&["grow", "fbm-smooth", "--size", "16", "--seed", "random", "--json"]);
    let manifest: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let seed = manifest["seed"].as_u64().unwrap();
    assert!(seed < 1_000_000);
    assert!(place.path("worlds").join(format!("fbm-smooth-{seed}")).is_dir());
}
