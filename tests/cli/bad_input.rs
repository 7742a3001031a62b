//! Every bad request: one exact line, an exit code, nothing written.

use super::Place;

/// The command fails with this one line and code, and no file is made or lost.
pub fn refused(place: &Place, arguments: &[&str], line: &str, code: i32) {
    let before = place.files();
    let said = place.run(arguments);
    assert_eq!(said.err, format!("error: {line}\n"), "{arguments:?}");
    assert_eq!((said.code, said.out.as_str()), (code, ""), "{arguments:?}");
    assert_eq!(place.files(), before, "{arguments:?} left something behind");
}

const SIZES: &str = "'size' in [world] must be a whole number of cells between 16 and 16384, or two such: [1024, 512]";

#[test]
fn flags() {
    let place = Place::new();
    let grow = |rest: &[&str], line: &str| {
        let arguments = [&["grow", "fbm-smooth"], rest].concat();
        refused(&place, &arguments, line, 2);
    };
    grow(&["--size", "0"], &format!("--size: {SIZES}, not the number 0"));
    grow(&["--size", "100000"], &format!("--size: {SIZES}, not the number 100000"));
    grow(&["--size", "-5"], &format!("--size: {SIZES}, not the number -5"));
    grow(&["--size", "big"], &format!("--size: {SIZES}, not the text 'big'"));
    grow(&["--size", "64x8"], &format!("--size: {SIZES}, not a list of 2"));
    grow(&["--seed", "-1"], "--seed -1: must be a whole number from 0 to 9223372036854775807, or random");
    grow(&["--threads", "0"], "--threads 0: must be a whole number from 1 to 1024");
    grow(&["--until", "rain"], "--until rain: no such stage (this recipe has: fbm)");
    grow(
        &["--set", "fbm.hurts=1"],
        "--set fbm.hurts: unknown parameter 'hurts' in stage 'fbm' (did you mean 'hurst'?)",
    );
    grow(
        &["--set", "fbm.hurst=9"],
        "--set fbm.hurst: 'hurst' in stage 'fbm' must be a number between 0.05 and 1.2, not 9",
    );
    grow(&["--set", "rain.x=9"], "--set rain.x: no stage 'rain' (this recipe has: fbm)");
    grow(&["--seeds", "1..4"], "--seeds draws a contact sheet; name it with --sheet FILE.png");
    grow(&["--sheet", "a.png"], "--sheet draws several seeds; name them with --seeds A..B");
    grow(&["--seeds", "4..1", "--sheet", "a.png"], "--seeds 4..1: the second seed must not be below the first");
    grow(
        &["--seeds", "1..2", "--sheet", "a.txt"],
        "a.txt: pictures are written as PNG or JPEG; give the name the ending .png or .jpg",
    );
    grow(&["--seeds", "1..2", "--sheet", "no/a.png"], "no/a.png: there is no folder 'no'");
    grow(&["--colour"], "unexpected argument '--colour' found; see 'upthrust --help'");
}

#[test]
fn recipes() {
    let place = Place::new();
    place.write("alps.toml", "name = \"Alps\"\n\n[[stage]]\nkind = \"fbm\"\nhurts = 1.0\n");
    place.write("type.toml", "[world]\nextent_km = \"wide\"\n[[stage]]\nkind = \"fbm\"\n");
    place.write("range.toml", "[[stage]]\nkind = \"fbm\"\nhurst = 7\n");
    place.write("twice.toml", "[[stage]]\nid = \"a\"\nkind = \"fbm\"\n[[stage]]\nid = \"a\"\nkind = \"warp\"\n");
    place.write("kind.toml", "[[stage]]\nkind = \"wrap\"\n");
    place.write("order.toml", "[[stage]]\nkind = \"warp\"\n");
    place.write("syntax.toml", "[world\nseed = 1\n");
    place.write("garbage.toml", [0u8, 159, 146, 150, 10, 255, 254, 0, 7]);
    place.write("empty.toml", "");
    std::fs::create_dir(place.path("folder.toml")).unwrap();
    let grow = |name: &str, line: &str| refused(&place, &["grow", name], line, 2);
    grow("alps.toml", "alps.toml:5: unknown parameter 'hurts' in stage 'fbm' (did you mean 'hurst'?)");
    grow(
        "type.toml",
        "type.toml:2: 'extent_km' in [world] must be a number between 0.01 and 40075 km, not the text 'wide'",
    );
    grow("range.toml", "range.toml:3: 'hurst' in stage 'fbm' must be a number between 0.05 and 1.2, not 7");
    grow(
        "twice.toml",
        "twice.toml:5: stage id 'a' is already taken by the stage at line 2; give each stage its own id",
    );
    grow("kind.toml", "kind.toml:2: unknown stage kind 'wrap' (did you mean 'warp'?)");
    grow(
        "order.toml",
        "order.toml:1: stage 'warp' needs the layer 'bedrock', which no earlier stage makes; put such a stage before it",
    );
    grow("garbage.toml", "garbage.toml:1: not a text in UTF-8; a recipe is a TOML file");
    grow("empty.toml", "empty.toml: a recipe needs at least one [[stage]]");
    grow("no.toml", "no.toml: there is no such file");
    grow("folder.toml", "folder.toml: this is a folder; name a recipe file in it");
    grow("fbm-smoth", "fbm-smoth: no preset of that name (did you mean 'fbm-smooth'?)");
    let said = place.run(&["grow", "syntax.toml"]);
    assert!(said.err.starts_with("error: syntax.toml:1: ") && said.err.lines().count() == 1, "{}", said.err);
    assert_eq!(said.code, 2);
}

#[test]
fn output_folders() {
    let place = Place::new();
    place.write("file", "mine");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.write("photos/cat.jpg", "mine");
    let grow = |rest: &[&str], line: &str| {
        refused(&place, &[&["grow", "fbm-smooth", "--size", "16"], rest].concat(), line, 2);
    };
    grow(&["--out", "photos"], "photos: this folder exists; choose another --out, or replace it with --force");
    grow(&["--out", "photos", "--force"], "photos: --force replaces worlds only, and this folder has no manifest.json");
    grow(&["--out", "file"], "file: there is a file of that name; choose another --out");
    grow(&["--out", "file", "--force"], "file: there is a file of that name; choose another --out");
    grow(&["--out", "file/world"], "file/world: cannot make this folder: not a directory");
    grow(&["--out", ".."], "--out '..': name a new folder");
    #[cfg(target_os = "linux")]
    grow(&["--out", "/proc/world"], "/proc/world: cannot make this folder: no such file or directory; check the path");
}

#[test]
fn worlds() {
    let place = Place::new();
    place.write("file", "mine");
    std::fs::create_dir(place.path("empty")).unwrap();
    refused(&place, &["inspect", "no"], "no: there is no such world", 2);
    for world in ["file", "empty"] {
        let said = place.run(&["inspect", world]);
        assert!(said.code == 2 && said.err.starts_with("error: ") && said.err.lines().count() == 1, "{}", said.err);
    }
    let what = "--view slop: neither 'relief', 'scene' nor a layer (did you mean 'slope'?)";
    refused(&place, &["render", "no", "a.png", "--view", "slop"], what, 2);
    refused(&place, &["render", "no", "a.png"], "no: there is no such world", 2);
    refused(
        &place,
        &["render", "no", "a.gif"],
        "a.gif: pictures are written as PNG or JPEG; give the name the ending .png or .jpg",
        2,
    );
    #[cfg(not(feature = "app"))]
    refused(&place, &["app"], "this build lacks the desktop application; build it with --features app", 2);
    let named = "the following required arguments were not provided: <WORLD>...; see 'upthrust --help'";
    refused(&place, &["inspect"], named, 2);
}

#[test]
fn a_run_that_fails_leaves_nothing() {
    let place = Place::new();
    // Only where the plates lie shows that both entries mean the same one.
    let entry = "[[stage.plate]]\nat_km = [100, 100]\nheading_deg = 0\nspeed_mm_per_yr = 1\n";
    place.write("twice.toml", format!("[world]\nsize = 16\n[[stage]]\nkind = \"plates\"\n{entry}{entry}"));
    let said = place.run(&["grow", "twice.toml", "--out", "deep/er/w"]);
    let last = said.err.lines().last().unwrap();
    let what = "error: stage 'plates', step 1: plate 2: at_km = [100, 100] lies on a plate that an earlier entry has";
    assert!(last.starts_with(what), "{}", said.err);
    assert_eq!(said.code, 2);
    assert_eq!(place.files(), ["twice.toml"]);
}

#[test]
fn what_does_not_go_together_is_found_before_the_run() {
    let place = Place::new();
    let refused = |stage: &str, what: &str| {
        place.write("r.toml", format!("[world]\nsize = 16\nextent_km = 100\n\n[[stage]]\n{stage}\n"));
        let said = place.run(&["grow", "r.toml", "--out", "w"]);
        assert!(said.err.starts_with(&format!("error: r.toml:5: stage {what}")), "{}", said.err);
        assert_eq!((said.code, said.err.lines().count()), (2, 1), "{}", said.err);
        assert_eq!(place.files(), ["r.toml"]);
    };
    refused("kind = \"rmp_graph\"\nat_km = [9000, 0]", "'rmp_graph': at_km = [9000, 0] lies outside the map");
    let entry = "[[stage.plate]]\nat_km = [10, 200]\nheading_deg = 0\nspeed_mm_per_yr = 1";
    let plates = "kind = \"plates\"\nduration_myr = 1\nbelt_km = 10";
    refused(&format!("{plates}\n{entry}"), "'plates': plate 1: at_km = [10, 200] lies outside the map");
    refused("kind = \"plates\"\nduration_myr = 1\nbelt_km = 90", "'plates': belt_km = 90 is too wide for this map");
    refused("kind = \"plates\"\nduration_myr = 50", "'plates': plates would drift");
    refused(&format!("{plates}\ncontinents = \"r.toml\""), "'plates': continents: ");
    refused(&format!("{plates}\nmap = \"r.toml\""), "'plates': map: ");
    refused("kind = \"volcano\"\nat_km = [300, 50]", "'volcano': at_km = [300, 50] is so far off the map");
    refused("kind = \"volcano\"\ncrater_radius_m = 20000", "'volcano': a crater of 20000 m is as wide as");
    refused("kind = \"volcano\"\nheight_m = 0\ncrater_height_m = 1", "'volcano': the crater's floor at 1 m is higher");
    refused("kind = \"volcano\"\nplace = \"arc\"", "'volcano' needs the layer 'plate_id'");
    refused("kind = \"island\"\nislands = [{ at_km = [300, 50] }]", "'island': islands[1]: at_km = [300, 50]");
}

#[test]
fn eruptions_that_make_no_sense_end_in_a_line() {
    let place = Place::new();
    let erupt = |stage: &str, line: &str| {
        let ground = "[world]\nsize = 16\nextent_km = 1\n\n[[stage]]\nkind = \"fbm\"\n";
        place.write("r.toml", format!("{ground}\n[[stage]]\n{stage}\n"));
        refused(&place, &["grow", "r.toml", "--out", "w"], &format!("r.toml:{line}"), 2);
    };
    let off = "vent 1 at 9 km, 0.5 km does not lie on the map, which is 1 km by 1 km";
    let none = "the vents have no part of the lava; give one of them a 'part' above 0";
    let cold = "lava of temperature_degc = 400 is rock before it comes out; raise it above solidus_degc = 1000";
    let frozen = [("lava", ", or set freeze = false"), ("lava_sheet", "")];
    for (kind, or) in frozen {
        let with = |rest: &str, line: &str| erupt(&format!("kind = \"{kind}\"\n{rest}"), line);
        with("vent = [{ at_km = [9, 0.5] }]", &format!("8: stage '{kind}': {off}"));
        with("vent = [{ at_km = [0.5, 0.5], part = 0 }]", &format!("8: stage '{kind}': {none}"));
        with("temperature_degc = 400", &format!("8: stage '{kind}': {cold}{or}"));
        let list = format!("(`upthrust params {kind}` lists what there is)");
        with("lavva = 1", &format!("10: unknown parameter 'lavva' in stage '{kind}' {list}"));
        let vent = "vent = [{ at_km = [0.5, 0.5], prat = 1 }]";
        let meant = "(did you mean 'part'?)";
        with(vent, &format!("10: unknown parameter 'prat' in 'vent[1]' of stage '{kind}' {meant}"));
    }
    let negative = "must be a number between 0 and";
    erupt(
        "kind = \"lava\"\nduration_min = -1",
        &format!("10: 'duration_min' in stage 'lava' {negative} 100000 min, not -1"),
    );
    erupt(
        "kind = \"lava\"\nschedule = [{ start_time = 0, duration = -1, m3_per_s = 1 }]",
        &format!("10: 'duration' in 'schedule[1]' of stage 'lava' {negative} 1e9 s, not -1"),
    );
    erupt(
        "kind = \"lava_sheet\"\nduration_h = -1",
        &format!("10: 'duration_h' in stage 'lava_sheet' {negative} 1000000 h, not -1"),
    );
    erupt(
        "kind = \"lava_sheet\"\nschedule = [{ start_h = 0, duration_h = -1, m3_per_s = 1 }]",
        &format!("10: 'duration_h' in 'schedule[1]' of stage 'lava_sheet' {negative} 1000000 h, not -1"),
    );
    erupt(
        "kind = \"lava_sheet\"\nschedule = [{ start_h = 0, m3_per_s = 1e6 }]",
        "8: stage 'lava_sheet': the schedule's 1.7e11 m3 of lava would lie 172800 m deep over the whole map, 300 m at \
         most; lower m3_per_s or the keys' duration_h, or raise extent_km",
    );
    erupt("kind = \"ash\"\nvolume_km3 = -1", &format!("10: 'volume_km3' in stage 'ash' {negative} 100000 km3, not -1"));
    let list = "(`upthrust params ash` lists what there is)";
    erupt("kind = \"ash\"\nwindy = 1", &format!("10: unknown parameter 'windy' in stage 'ash' {list}"));
}
