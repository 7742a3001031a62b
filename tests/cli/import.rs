//! Heightmaps from outside, as a user brings them.

use super::Place;

/// An 8-bit gray PNG of `width` x `height` whose heights rise to the east.
fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let data: Vec<u8> = (0..width * height).map(|i| (i % width * 255 / (width - 1)) as u8).collect();
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    bytes
}

const ASC: &str = "[[stage]]\nkind = \"import\"\npath = \"maps/dem.asc\"\n";

/// A grid of 40 x 20 cells of 250 m.
fn asc() -> String {
    let row = (0..40).map(|x| (x * 10).to_string()).collect::<Vec<_>>().join(" ");
    format!("ncols 40\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 250\n{}", format!("{row}\n").repeat(20))
}

#[test]
fn a_flag_brings_a_file_and_the_file_its_size() {
    let place = Place::new();
    place.write("mine.png", png(60, 30));
    let said = place.run(&["grow", "erode-my-map", "--set", "import.path=mine.png", "--out", "w"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let said = place.run(&["inspect", "w"]);
    assert!(said.out.starts_with("size        60 x 30 cells of 1000 m"), "{}", said.out);
    // Another size shows the same land, so it keeps its shape.
    let said = place.run(&["grow", "erode-my-map", "--set", "import.path=mine.png", "--size", "128", "--out", "v"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(place.run(&["inspect", "v"]).out.starts_with("size        128 x 64 cells"));
}

#[test]
fn a_preset_takes_metres_as_they_are() {
    let place = Place::new();
    place.write("dem.asc", asc());
    let said = place.run(&["grow", "erode-my-map", "--set", "import.path=dem.asc", "--out", "w"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let bare = place.run(&["grow", "erode-my-map", "--set", "import.path=dem.asc", "--until", "import", "--out", "v"]);
    assert_eq!(bare.code, 0, "{}", bare.err);
    let said = place.run(&["inspect", "v"]);
    assert!(said.out.contains("height      0.0 to 390.0 m"), "{}", said.out);
}

#[test]
fn a_file_that_knows_its_cells_sets_the_extent() {
    let place = Place::new();
    std::fs::create_dir(place.path("maps")).unwrap();
    place.write("maps/dem.asc", asc());
    place.write("dem.toml", ASC);
    let said = place.run(&["grow", "dem.toml", "--out", "w"]);
    assert!(said.code == 0 && !said.err.contains("note:"), "{}", said.err);
    let said = place.run(&["inspect", "w"]);
    assert!(said.out.starts_with("size        40 x 20 cells of 250 m"), "{}", said.out);
    assert!(said.out.contains("height      0.0 to 390.0 m"), "{}", said.out);
    place.write("wide.toml", format!("[world]\nextent_km = 50\n{ASC}"));
    let said = place.run(&["grow", "wide.toml", "--out", "v"]);
    let note = "by its own cells the map is 10.000 km wide; the recipe makes it 50 km (extent_km in [world])";
    assert!(said.code == 0 && said.err.contains(note), "{}", said.err);
}

#[test]
fn few_bits_and_unknown_lengths_are_said() {
    let place = Place::new();
    place.write("mine.png", png(60, 30));
    place.write("mine.toml", "[[stage]]\nkind = \"import\"\npath = \"mine.png\"\n");
    let said = place.run(&["grow", "mine.toml", "--out", "w"]);
    let notes: Vec<&str> = said.err.lines().filter(|line| line.starts_with("note: ")).collect();
    let wanted = ["8 bits hold 256 heights", "black is taken for 0 m and white for 2000 m", "the map is 1000 km wide"];
    assert_eq!(notes.len(), wanted.len(), "{}", said.err);
    for want in wanted {
        assert!(notes.iter().any(|note| note.contains(want)), "{want}: {}", said.err);
    }
    let said = place.run(&["grow", "mine.toml", "--out", "v", "--quiet"]);
    assert_eq!(said.err, "");
}

#[test]
fn what_had_no_height_is_counted() {
    let place = Place::new();
    place.write("holes.asc", asc().replacen("250\n0 10 20", "250\nNODATA_value -9999\n-9999 -9999 20", 1));
    place.write("holes.toml", "[[stage]]\nkind = \"import\"\npath = \"holes.asc\"\n");
    let said = place.run(&["grow", "holes.toml", "--out", "w"]);
    let note = "note: stage 'import': 2 of 800 cells (0.25 %) had no height and were filled in (no_data)";
    assert!(said.code == 0 && said.err.contains(note), "{}", said.err);
    assert!(std::fs::read_to_string(place.path("w/manifest.json")).unwrap().contains("2 of 800 cells"));
    let quiet = place.run(&["grow", "holes.toml", "--out", "v", "--quiet"]);
    assert!(quiet.code == 0 && quiet.err.is_empty(), "{}", quiet.err);
}

#[test]
fn what_a_file_says_to_be_infinite_is_named() {
    let place = Place::new();
    let heights = (0..20 * 20).map(|i| if i < 3 { [f32::INFINITY, f32::NEG_INFINITY, f32::NAN][i] } else { i as f32 });
    place.write("a.r32", heights.flat_map(f32::to_le_bytes).collect::<Vec<u8>>());
    place.write("a.toml", "[[stage]]\nkind = \"import\"\npath = \"a.r32\"\nlow_m = 0.0\nhigh_m = 1.0\n");
    let said = place.run(&["grow", "a.toml", "--out", "w"]);
    let note = "3 of 400 cells (0.75 %) had no height, 2 of them infinite, and were filled in (no_data)";
    assert!(said.code == 0 && said.err.contains(note), "{}", said.err);
    // Holes that are not wanted are a wrong request, though only the run finds them.
    let said = place.run(&["grow", "a.toml", "--set", "import.no_data=refuse", "--out", "v"]);
    let last = said.err.lines().last().unwrap();
    let what = "a.r32: 3 cells have no height, the first at 0, 0; no_data = \"fill\" fills them from their neighbours";
    assert!(last.starts_with("error: stage 'import', step 1: ") && last.ends_with(what), "{}", said.err);
    assert_eq!((said.code, place.path("v").exists()), (2, false));
}

#[test]
fn bad_files_are_refused_where_the_recipe_names_them() {
    let place = Place::new();
    place.write("mine.toml", "\n[[stage]]\nkind = \"import\"\npath = \"mine.png\"\n");
    let before = |name: &str, bytes: &[u8]| {
        place.write(name, bytes);
        place.files()
    };
    let wrong = |what: &str, files: Vec<String>| {
        let said = place.run(&["grow", "mine.toml", "--out", "w"]);
        assert!(said.err.starts_with("error: mine.toml:4: stage 'import': "), "{}", said.err);
        assert!(said.err.contains(what) && said.err.lines().count() == 1, "{}", said.err);
        assert_eq!((said.code, place.files()), (2, files));
    };
    wrong("the file is empty", before("mine.png", b""));
    wrong("the name says PNG, but the content is an ESRI ASCII grid", before("mine.png", asc().as_bytes()));
    wrong("1 x 2 is too small for a map", {
        let mut bytes = Vec::new();
        png::Encoder::new(&mut bytes, 1, 2).write_header().unwrap().write_image_data(&[1, 2]).unwrap();
        before("mine.png", &bytes)
    });
    // Cut behind its header: known only when it is read, and nothing is left then either.
    let whole = png(600, 300);
    let files = before("mine.png", &whole[..whole.len() / 2]);
    let said = place.run(&["grow", "mine.toml", "--out", "w"]);
    let last = said.err.lines().last().unwrap();
    assert!(last.starts_with("error: stage 'import', step 1: ") && last.contains("is cut short"), "{}", said.err);
    assert_eq!((said.code, place.files()), (1, files));
}
