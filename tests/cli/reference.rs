//! `presets`, `params`, help, and the page made from them.

use super::Place;

#[test]
fn presets_are_listed_name_first_and_printed_whole() {
    let place = Place::new();
    let said = place.run(&["presets"]);
    assert!(said.out.lines().any(|line| line.starts_with("rmp-ridge ")), "{}", said.out);
    let said = place.run(&["presets", "rmp-ridge"]);
    place.write("mine.toml", &said.out);
    assert_eq!(place.run(&["grow", "mine.toml", "--size", "16", "--out", "w"]).code, 0);
    let said = place.run(&["presets", "rmp-rigde"]);
    assert_eq!((said.code, said.err.as_str()), (2, "error: no preset 'rmp-rigde' (did you mean 'rmp-ridge'?)\n"));
}

#[test]
fn params_say_unit_range_default_and_effect() {
    let place = Place::new();
    let said = place.run(&["params", "fbm"]);
    let row = said.out.lines().position(|line| line.starts_with("height_m ")).unwrap();
    let lines: Vec<&str> = said.out.lines().collect();
    assert_eq!(lines[row].split_whitespace().collect::<Vec<_>>(), ["height_m", "m", "0", "to", "20000", "2000"]);
    assert!(lines[row + 1].contains("Higher: "), "{}", lines[row + 1]);
    assert!(place.run(&["params", "world"]).out.contains("extent_km"));
    assert!(place.run(&["params", "scene"]).out.contains("sun.time_of_day_h"));
    let said = place.run(&["params", "fmb"]);
    assert_eq!((said.code, said.err.as_str()), (2, "error: no stage kind 'fmb' (did you mean 'fbm'?)\n"));
    let schema: serde_json::Value = serde_json::from_str(&place.run(&["params", "--schema"]).out).unwrap();
    let stages = schema["properties"]["stage"]["items"]["oneOf"].as_array().unwrap();
    assert!(stages.iter().any(|stage| stage["properties"]["kind"]["const"] == "fbm"));
}

#[test]
fn the_page_of_parameters_is_current() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/parameters.md");
    let page = std::fs::read_to_string(path).unwrap();
    let now = Place::new().run(&["params", "--markdown"]).out;
    assert!(page == now, "renew it: upthrust params --markdown > docs/parameters.md");
}

#[test]
fn help_names_what_works() {
    let place = Place::new();
    let said = place.run(&["--help"]);
    assert_eq!(said.code, 0);
    for command in ["grow", "presets", "params", "inspect", "render"] {
        assert!(said.out.contains(&format!("\n  {command} ")), "{command}");
    }
    assert_eq!(said.out.contains("\n  app "), cfg!(feature = "app"), "{}", said.out);
    assert_eq!(place.run(&[]).code, 2);
    assert!(place.run(&["--version"]).out.starts_with("upthrust "));
}
