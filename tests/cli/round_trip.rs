//! What is exported comes back the same within the format's step, whatever the format.

use upthrust::{grid::Field, world::store};

use super::Place;

fn heights(place: &Place, world: &str) -> Field<f32> {
    store::read(&place.path(world)).unwrap().0.height()
}

#[test]
fn import_undoes_export() {
    let place = Place::new();
    assert_eq!(place.run(&["grow", "fbm-smooth", "--size", "96x64", "--quiet", "--out", "w"]).code, 0);
    let truth = heights(&place, "w");
    for (file, flags) in [
        ("h.png", &[][..]),
        ("h.r16", &[]),
        ("h.r16", &["--big-endian"]),
        ("h.r32", &[]),
        ("h.exr", &[]),
        ("h.asc", &[]),
        ("h.tif", &[]),
    ] {
        let said = place.run(&[&["export", "w", file, "--force"], flags].concat());
        assert_eq!(said.code, 0, "{file}: {}", said.err);
        // Whole numbers need the metres that black and white stand for; the file beside says them.
        let facts: serde_json::Value =
            serde_json::from_slice(&std::fs::read(place.path(&format!("{file}.json"))).unwrap()).unwrap();
        let ends = [&facts["black_m"], &facts["white_m"]].map(serde_json::Value::as_f64);
        let mut recipe = format!("[world]\nextent_km = 200.0\n[[stage]]\nkind = \"import\"\npath = \"{file}\"\n");
        let step_m = match ends {
            [Some(black_m), Some(white_m)] => {
                recipe += &format!("low_m = {black_m:?}\nhigh_m = {white_m:?}\n");
                (white_m - black_m) / 65535.0
            }
            _ => 0.0,
        };
        let bare = file.ends_with("r16") || file.ends_with("r32");
        recipe += if bare { "size = [96, 64]\n" } else { "" };
        recipe += if flags.contains(&"--big-endian") { "endian = \"big\"\n" } else { "" };
        place.write("back.toml", recipe);
        let said = place.run(&["grow", "back.toml", "--out", "back", "--force"]);
        assert_eq!(said.code, 0, "{file}: {}", said.err);
        let back = heights(&place, "back");
        assert_eq!((back.grid.width, back.grid.height), (96, 64), "{file}");
        // Half a step, and what f32 rounds at a few thousand metres.
        let most = truth.data.iter().zip(&back.data).map(|(a, b)| (a - b).abs() as f64).fold(0.0, f64::max);
        let allowed = if step_m > 0.0 { 0.5 * step_m + 5e-4 } else { 0.0 };
        assert!(most <= allowed, "{file} {flags:?}: off by {most} m, a step is {step_m} m");
        assert!((step_m > 0.0) == (file == "h.png" || file.ends_with("16")), "{file}");
    }
}

#[test]
fn our_own_export_comes_back_without_a_word() {
    let place = Place::new();
    assert_eq!(place.run(&["grow", "fbm-smooth", "--size", "96x64", "--quiet", "--out", "w"]).code, 0);
    let truth = heights(&place, "w");
    for flags in [&["h.png"][..], &["h.r16"], &["h.r16", "--big-endian"], &["h.r16", "--flip", "y"]] {
        let said = place.run(&[&["export", "w"], flags, &["--force"]].concat());
        assert_eq!(said.code, 0, "{flags:?}: {}", said.err);
        place.write("back.toml", format!("[[stage]]\nkind = \"import\"\npath = \"{}\"\n", flags[0]));
        let said = place.run(&["grow", "back.toml", "--out", "back", "--force"]);
        assert_eq!(said.code, 0, "{flags:?}: {}", said.err);
        assert!(said.err.contains(&format!("{}.json beside it says", flags[0])), "{}", said.err);
        let back = heights(&place, "back");
        assert_eq!((back.grid.width, back.grid.height), (96, 64), "{flags:?}");
        assert!((back.grid.cell_m / truth.grid.cell_m - 1.0).abs() < 1e-9, "{flags:?}");
        let (low, high) = truth.range().unwrap();
        let most = truth.data.iter().zip(&back.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // Half a step, and what f32 rounds at a few thousand metres.
        assert!(most <= 0.5 * (high - low) / 65535.0 + 5e-4, "{flags:?}: off by {most} m");
    }
    // A TIFF says itself what its numbers stand for.
    assert_eq!(place.run(&["export", "w", "h.tif", "--bits", "16"]).code, 0);
    std::fs::remove_file(place.path("h.tif.json")).unwrap();
    place.write("tiff.toml", "[[stage]]\nkind = \"import\"\npath = \"h.tif\"\n");
    assert_eq!(place.run(&["grow", "tiff.toml", "--out", "tiff"]).code, 0);
    let (back, (low, high)) = (heights(&place, "tiff"), truth.range().unwrap());
    let most = truth.data.iter().zip(&back.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(most > 0.0 && most <= 0.5 * (high - low) / 65535.0 + 5e-4, "off by {most} m");
    // What the person says counts for more than the file beside.
    place.write("higher.toml", "[[stage]]\nkind = \"import\"\npath = \"h.png\"\nlow_m = 0.0\nhigh_m = 9000.0\n");
    assert_eq!(place.run(&["export", "w", "h.png", "--force"]).code, 0);
    assert_eq!(place.run(&["grow", "higher.toml", "--out", "higher"]).code, 0);
    assert_eq!(heights(&place, "higher").range(), Some((0.0, 9000.0)));
}
