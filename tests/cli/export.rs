//! `upthrust export` as it is typed.

use super::Place;

fn grown() -> Place {
    let place = Place::new();
    assert_eq!(place.run(&["grow", "fbm-smooth", "--size", "64", "--quiet", "--out", "w"]).code, 0);
    place
}

#[test]
fn files_are_named_and_notes_go_elsewhere() {
    let place = grown();
    let said = place.run(&["export", "w", "h.png"]);
    assert_eq!((said.code, said.out.as_str(), said.err.as_str()), (0, "h.png\nh.png.json\n", ""));
    // The heightmap that `grow` wrote holds the same numbers.
    let pixels = |name: &str| image::open(place.path(name)).unwrap().into_luma16().into_raw();
    assert_eq!(pixels("h.png"), pixels("w/height.png"));
    let said = place.run(&["export", "w", "u.png", "--engine", "unreal"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(said.out, "u.png\nu_sand.png\nu_grass.png\nu_rock.png\nu_snow.png\nu.png.json\n");
    assert!(
        said.err.lines().all(|line| line.starts_with("note: ") || line.starts_with("  ")) && !said.err.is_empty(),
        "{}",
        said.err
    );
}

#[test]
fn every_format_and_every_viewable_layer() {
    let place = grown();
    for ending in ["png", "tif", "tiff", "exr", "asc", "r16", "raw", "r32", "glb", "obj", "stl"] {
        let said = place.run(&["export", "w", &format!("h.{ending}")]);
        assert_eq!(said.code, 0, "{ending}: {}", said.err);
    }
    for layer in ["height", "slope", "bedrock", "normals", "weights"] {
        let said = place.run(&["export", "w", &format!("{layer}.png"), "--layer", layer]);
        assert_eq!(said.code, 0, "{layer}: {}", said.err);
    }
}

#[test]
fn bad_requests_leave_nothing() {
    let place = grown();
    let before = place.files();
    let refused = |rest: &[&str], line: &str| {
        let said = place.run(&[&["export", "w"], rest].concat());
        assert_eq!(said.err, format!("error: {line}\n"), "{rest:?}");
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{rest:?}");
        assert_eq!(place.files(), before, "{rest:?}");
    };
    refused(
        &["h.gif"],
        "h.gif: no format has this ending; there are .png .tif .tiff .exr .asc .r16 .raw .r32 .glb .obj .stl .geojson .svg",
    );
    refused(&["h.png", "--layer", "slop"], "--layer slop: no such layer (did you mean 'slope'?)");
    refused(&["h.png", "--engine", "unral"], "--engine unral: no such engine (did you mean 'unreal'?)");
    refused(
        &["h.png", "--window", "1,2"],
        "--window 1,2: write west edge, north edge and size in km, such as 120,80,8",
    );
    refused(&["h.png", "--range", "9..1"], "--range 9..1: the first number must be below the second");
    refused(&["h.png", "--range", "-9"], "--range -9: write two numbers as MIN..MAX, such as -500..3000");
    refused(&["h.png", "--size", "100000"], "--size 100000: must be a whole number from 2 to 16385");
    refused(&["h.png", "--bits", "12"], "--bits 12: must be 8, 16 or 32");
    refused(&["h.r16", "--flip", "x"], "--flip x: rows can be flipped with 'y', nothing else");
    refused(&["no/h.png"], "no/h.png: there is no folder 'no'");
    refused(&["w/height.png"], "w/height.png: exists; choose another name, or replace it with --force");
}

#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_takes_no_files_is_named() {
    let place = grown();
    let said = place.run(&["export", "w", "/proc/h.png"]);
    assert_eq!((said.code, said.err.lines().count()), (1, 1), "{}", said.err);
    assert!(said.err.starts_with("error: /proc/h.png: "), "{}", said.err);
}
