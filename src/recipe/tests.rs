//! Bad recipes, each with the exact line a user sees.

use std::path::PathBuf;

use proptest::prelude::*;

use super::*;

fn source(text: &str) -> Source {
    Source { name: "t".into(), file: "t.toml".into(), folder: PathBuf::new(), text: text.into() }
}

fn refused(text: &str) -> String {
    Plan::new(&source(text), &Overrides::default()).unwrap_err().to_string()
}

fn with(set: &[&str]) -> Result<Plan, RecipeError> {
    let text =
        "[[stage]]\nkind = \"probe\"\n\n[[stage]]\nid = \"wet\"\nkind = \"drip\"\n\n[[stage]]\nkind = \"drip\"\n";
    Plan::new(&source(text), &Overrides { set: set.iter().map(|s| s.to_string()).collect(), ..Default::default() })
}

#[test]
fn a_zoom_is_refused_where_there_is_nothing_to_zoom_into() {
    let plan = |stages: &str| {
        let text = format!("[world]\nsize = 64\nextent_km = 64\n{stages}");
        let source = Source { name: "t".into(), file: "t.toml".into(), folder: "".into(), text };
        Plan::new(&source, &Overrides::default())
    };
    let line = |stages: &str| plan(stages).unwrap_err().to_string();
    let ground = "[[stage]]\nkind = \"fbm\"\n";
    let zoom = "[[stage]]\nkind = \"zoom\"\n";
    assert!(line(zoom).contains("needs the layer 'bedrock', which no earlier stage makes"), "{}", line(zoom));
    let off = line(&format!("{ground}{zoom}window_km = [40, 40, 30]\n"));
    assert!(
        off.starts_with("t.toml:6: stage 'zoom': the window (30 x 30 km from 40, 40) reaches off the map"),
        "{off}"
    );
    let mask = line(&format!("{ground}{zoom}mask = \"slope > 3\"\n"));
    assert!(mask.contains("a zoom takes no 'mask'"), "{mask}");
    let long = line(&format!("{ground}{zoom}window_km = [1, 2]\n"));
    assert!(long.contains("t.toml:8") && long.contains("window_km"), "{long}");
    // The second window is judged on the first one's map.
    let both = format!("{ground}{zoom}window_km = [10, 10, 16]\n{zoom}window_km = [4, 4, 8]\n");
    assert_eq!(plan(&both).unwrap().grids()[2].cell_m, 125.0);
    let second = line(&format!("{ground}{zoom}window_km = [10, 10, 16]\n{zoom}window_km = [10, 10, 16]\n"));
    assert!(second.contains("stage 'zoom#2'") && second.contains("which is 16 x 16 km"), "{second}");
}

#[test]
fn every_mistake_has_its_line() {
    let probe = "[[stage]]\nkind = \"probe\"\n";
    let cases = [
        ("", "t.toml: a recipe needs at least one [[stage]]"),
        ("nam = 1\n", "t.toml:1: unknown key 'nam' in the recipe (did you mean 'name'?)"),
        ("name = 1\n", "t.toml:1: 'name' in the recipe must be a text in quotes, not the number 1"),
        ("world = 3\n", "t.toml:1: 'world' in the recipe must be a table, written [world], not the number 3"),
        ("[world]\nsiez = 64\n", "t.toml:2: unknown key 'siez' in [world] (did you mean 'size'?)"),
        (
            "[world]\nsize = [512, 4]\n",
            "t.toml:2: 'size' in [world] must be a whole number of cells between 16 and 16384, or two such: [1024, 512], not a list of 2",
        ),
        (
            "[world]\nseed = -1\n",
            "t.toml:2: 'seed' in [world] must be a whole number between 0 and 9223372036854775807, not -1",
        ),
        (
            "[world]\nextent_km = nan\n",
            "t.toml:2: 'extent_km' in [world] must be a number between 0.01 and 40075 km, not NaN",
        ),
        ("[world]\nedges = \"opn\"\n", "t.toml:2: 'edges' in [world] must be one of open, closed, wrap, not 'opn'"),
        (
            "[world]\nsize = [16, 16384]\n",
            "t.toml:2: 'size' in [world] is 16 x 16384: one side may be at most 64 times the other",
        ),
        ("[stage]\nkind = \"probe\"\n", "t.toml:1: stages are a list of tables: write [[stage]], not [stage]"),
        ("[[stage]]\n", "t.toml:1: this [[stage]] lacks 'kind'"),
        (
            "[[stage]]\nkind = 3\n",
            "t.toml:2: 'kind' in this [[stage]] must be the name of a stage in quotes, not the number 3",
        ),
        ("[[stage]]\nkind = \"prob\"\n", "t.toml:2: unknown stage kind 'prob' (did you mean 'probe'?)"),
        (
            "[[stage]]\nkind = \"drip\"\n",
            "t.toml:1: stage 'drip' needs the layer 'bedrock', which no earlier stage makes; put such a stage before it",
        ),
        (
            "[[stage]]\nkind = \"probe\"\nenabled = false\n",
            "t.toml:1: no stage is enabled, so there is nothing to grow",
        ),
        ("a = 1\na = 2\n", "t.toml:2: duplicate key"),
    ];
    for (text, message) in cases {
        assert_eq!(refused(text), message);
    }
    let lines = [
        ("hight_m = 3", "unknown parameter 'hight_m' in stage 'probe' (did you mean 'height_m'?)"),
        ("gusts_m = 3", "unknown parameter 'gusts_m' in stage 'probe' (`upthrust params probe` lists what there is)"),
        ("height_m = 2000", "'height_m' in stage 'probe' must be a number between -1000 and 1000 m, not 2000"),
        (
            "height_m = \"high\"",
            "'height_m' in stage 'probe' must be a number between -1000 and 1000 m, not the text 'high'",
        ),
        ("height_m = inf", "'height_m' in stage 'probe' must be a number between -1000 and 1000 m, not inf"),
        ("share = 2", "'share' in stage 'probe' must be a number between 0 and 1, not 2"),
        ("count = 2.5", "'count' in stage 'probe' must be a whole number between 1 and 9, not the number 2.5"),
        ("style = \"odd\"", "'style' in stage 'probe' must be one of plain, fancy, not 'odd'"),
        ("maybe = 4", "'maybe' in stage 'probe' must be one of plain, fancy, not the number 4"),
        ("at_km = [1, 2, 3]", "'at_km' in stage 'probe' must be a list of 2 numbers, not a list of 3"),
        ("at_km = [1, \"x\"]", "'at_km[2]' in stage 'probe' must be a number, not the text 'x'"),
        (
            "lump = [{ at_km = [1, 2], height_m = -1 }]",
            "'height_m' in 'lump[1]' of stage 'probe' must be a number at least 0 m, not -1",
        ),
        (
            "lump = [{ at_km = [1, 2], hight_m = 1 }]",
            "unknown parameter 'hight_m' in 'lump[1]' of stage 'probe' (did you mean 'height_m'?)",
        ),
        ("lump = [{}]", "'lump[1]' of stage 'probe' lacks 'at_km'"),
        ("map = \"no.png\"", "'map' in stage 'probe': there is no file 'no.png' (paths are relative to the recipe)"),
        (
            "mask = \"slop > 3\"",
            "mask 'slop > 3' is neither a layer (height), a range of one (slope > 30), nor an image file (.png, .jpg)",
        ),
        ("mask = \"hardness\"", "mask of stage 'probe' needs the layer 'hardness', which no earlier stage makes"),
        ("id = \"a b\"", "stage id 'a b' must be of letters, digits, '-' and '_', and not 'world' or 'scene'"),
        ("blend = \"addd\"", "'blend' in stage 'probe' must be one of add, replace, max, min, not 'addd'"),
        ("steps = 0", "'steps' in stage 'probe' must be a whole number between 1 and 1000000, not 0"),
    ];
    for (line, message) in lines {
        assert_eq!(refused(&format!("{probe}{line}\n")), format!("t.toml:3: {message}"));
    }
    let twice = "[[stage]]\nkind = \"probe\"\nid = \"a\"\n\n[[stage]]\nkind = \"probe\"\nid = \"a\"\n";
    assert_eq!(
        refused(twice),
        "t.toml:7: stage id 'a' is already taken by the stage at line 3; give each stage its own id"
    );
}

#[test]
fn whole_numbers_serve_as_fractions_and_lists_of_tables_work() {
    let text = "[[stage]]\nkind = \"probe\"\nheight_m = 5\nat_km = [1, 2]\npoints_km = [[0, 1], [2, 3.5]]\n\
                [[stage.lump]]\nat_km = [1, 2]\n[[stage.lump]]\nat_km = [3, 4]\nheight_m = 7\n";
    let plan = Plan::new(&source(text), &Overrides::default()).unwrap();
    let params: super::probe::ProbeParams = serde_json::from_value(plan.stages[0].params.clone()).unwrap();
    assert_eq!((params.height_m, params.at_km, params.lump.len()), (5.0, Some([1.0, 2.0]), 2));
    assert_eq!(params.lump[1].height_m, 7.0);
}

#[test]
fn flags_reach_stages_and_errors_name_them() {
    let plan = with(&["probe.height_m=7", "wet.count=9", "drip#2.enabled=false", "world.extent_km=20"]).unwrap();
    assert_eq!(plan.stages[0].params["height_m"], 7.0);
    assert_eq!(plan.stages[1].params["count"], 9);
    assert!(!plan.stages[2].enabled);
    assert_eq!(plan.world.extent_km, 20.0);
    // What is kept is the recipe as it ran: it gives the same plan without flags.
    let again = Plan::new(&source(&plan.text), &Overrides::default()).unwrap();
    assert_eq!(again.stages[1].params, plan.stages[1].params);
    assert_eq!(again.world, plan.world);

    let cases = [
        (
            "probe.height_m=9999",
            "--set probe.height_m: 'height_m' in stage 'probe' must be a number between -1000 and 1000 m, not 9999",
        ),
        (
            "probe.hight_m=9",
            "--set probe.hight_m: unknown parameter 'hight_m' in stage 'probe' (did you mean 'height_m'?)",
        ),
        ("drip.count=1", "--set drip.count: no stage 'drip' (this recipe has: probe, wet, drip#2)"),
        ("wind.count=1", "--set wind.count: no stage 'wind' (this recipe has: probe, wet, drip#2)"),
        ("probe.kind=drip", "--set probe.kind: a stage's kind and id are the recipe's own; change them in the file"),
        ("count", "--set count: write STAGE.PARAM=VALUE, such as fbm.height_m=800 or world.extent_km=200"),
        ("count=3", "--set count: write STAGE.PARAM=VALUE, such as fbm.height_m=800 or world.extent_km=200"),
        (
            "world.size=3",
            "--set world.size: 'size' in [world] must be a whole number of cells between 16 and 16384, or two such: [1024, 512], not the number 3",
        ),
    ];
    for (set, message) in cases {
        assert_eq!(with(&[set]).unwrap_err().to_string(), message);
    }
}

#[test]
fn sizes_and_seeds() {
    let plan = |seed, size: &str| {
        let text = "[world]\nseed = 3\n[[stage]]\nkind = \"probe\"\n";
        Plan::new(&source(text), &Overrides { seed, size: Some(size.into()), ..Default::default() })
    };
    let grid = plan(Some(9), "64x32").unwrap().world.grid();
    assert_eq!((grid.width, grid.height, grid.cell_m), (64, 32, 1e6 / 64.0));
    assert_eq!(plan(Some(9), "64").unwrap().world.seed, 9);
    assert_eq!(plan(None, "64").unwrap().world.seed, 3);
    for bad in ["0", "100000", "x", "64x", "-5", "1e3", "64x8", "", "99999999999999999999"] {
        let error = plan(None, bad).unwrap_err().to_string();
        assert!(error.starts_with("--size: 'size' in [world] must be"), "{error}");
    }
    assert!(plan(Some(u64::MAX), "64").unwrap_err().to_string().starts_with("--seed: 'seed' in [world] must be"));
}

#[test]
fn keys_do_not_depend_on_other_stages() {
    let keys = |text: &str| {
        let plan = Plan::new(&source(text), &Overrides::default()).unwrap();
        plan.stages.iter().map(|stage| (stage.key.clone(), stage.label.clone())).collect::<Vec<_>>()
    };
    let pair = |key: &str, label: &str| (key.to_owned(), label.to_owned());
    let probe = "[[stage]]\nkind = \"probe\"\n";
    assert_eq!(keys(probe), [pair("probe#1", "probe")]);
    let three = format!("{probe}enabled = false\n[[stage]]\nkind = \"probe\"\n[[stage]]\nkind = \"drip\"\n");
    assert_eq!(keys(&three), [pair("probe#1", "probe#1"), pair("probe#2", "probe#2"), pair("drip#1", "drip")]);
}

#[test]
fn schemas_keep_to_what_the_check_understands() {
    for kind in stage_kinds() {
        for (key, property) in kind.schema["properties"].as_object().unwrap() {
            assert!(!super::plan::COMMON.contains(&key.as_str()), "{}.{key} is a common key", kind.kind);
            assert!(property["description"].is_string(), "{}.{key} says not what it is", kind.kind);
        }
        assert_eq!(kind.schema["additionalProperties"], false, "{}", kind.kind);
        assert!(kind.build(&kind.defaults, Setting::default()).is_ok(), "{}: defaults must run", kind.kind);
        assert_eq!(kind.kind, kind.kind.to_lowercase());
    }
    let text = serde_json::to_string(&json_schema()).unwrap();
    assert!(!text.contains("$ref"));
    assert!(markdown().contains("| `height_m` | m | -1000 to 1000 | 100 | Height of the ground. | higher ground |"));
}

#[test]
fn presets_are_plans() {
    for preset in presets() {
        let plan = Plan::new(&preset.source(), &Overrides::default());
        assert!(plan.is_ok(), "{}", plan.unwrap_err());
    }
}

#[test]
fn sources_are_found_or_refused() {
    let refused = |name: &str| Source::find(name).unwrap_err().to_string();
    assert_eq!(refused("fbm-smoth"), "fbm-smoth: no preset of that name (did you mean 'fbm-smooth'?)");
    assert_eq!(refused("no/such.toml"), "no/such.toml: there is no such file");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("garbage.toml");
    std::fs::write(&path, b"a = 1\n\xff\xfe\x00").unwrap();
    let error = Source::read(&path).unwrap_err().to_string();
    assert!(error.ends_with("garbage.toml:2: not a text in UTF-8; a recipe is a TOML file"), "{error}");
}

/// Texts that look like recipes more often than not.
fn tomlish() -> impl Strategy<Value = String> {
    let words = prop::sample::select(vec![
        "[world]",
        "[[stage]]",
        "[stage]",
        "[[stage.lump]]",
        "[scene]",
        "kind",
        "id",
        "size",
        "seed",
        "height_m",
        "at_km",
        "lump",
        "mask",
        "=",
        " = ",
        "\"probe\"",
        "\"drip\"",
        "\"slope > 3\"",
        "1",
        "-1",
        "1e400",
        "nan",
        "inf",
        "[",
        "]",
        "{",
        "}",
        ",",
        "\n",
        "\n",
        "\n",
        "'",
        "\"",
        "\"\"\"",
        "#",
        ".",
        "0x",
        "1979-05-27",
        "true",
        "\u{0}",
        "é",
        "\r",
    ]);
    prop::collection::vec(words, 0..60).prop_map(|parts| parts.concat())
}

/// A value of any form, as a flag would give it.
fn any_value() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<f64>().prop_map(|v| v.to_string()),
        any::<i64>().prop_map(|v| v.to_string()),
        ".{0,12}",
        prop::collection::vec(any::<f32>(), 0..4).prop_map(|v| format!("{v:?}")),
        Just("[[1, 2], [3, 4]]".to_owned()),
        Just("{ a = 1 }".to_owned()),
    ]
}

/// One line, and a place before the first colon.
fn well_said(result: Result<Plan, RecipeError>) -> Result<(), TestCaseError> {
    if let Err(error) = result {
        let text = error.to_string();
        prop_assert!(!text.contains(['\n', '\r']) && text.contains(": "), "{:?}", text);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text_never_panics(text in any::<String>()) {
        well_said(Plan::new(&source(&text), &Overrides::default()))?;
    }

    #[test]
    fn arbitrary_toml_never_panics(text in tomlish()) {
        well_said(Plan::new(&source(&text), &Overrides::default()))?;
    }

    #[test]
    fn damaged_presets_never_panic(which in any::<prop::sample::Index>(), at in any::<prop::sample::Index>(), cut in 0usize..20, put in ".{0,8}") {
        let preset = which.get(presets());
        let mut chars: Vec<char> = preset.text.chars().collect();
        let from = at.index(chars.len());
        let to = (from + cut).min(chars.len());
        chars.splice(from..to, put.chars());
        well_said(Plan::new(&source(&chars.iter().collect::<String>()), &Overrides::default()))?;
    }

    #[test]
    fn arbitrary_parameters_never_panic(stage in any::<prop::sample::Index>(), key in any::<prop::sample::Index>(), value in any_value()) {
        let kind = stage.get(stage_kinds());
        let keys: Vec<&String> = kind.schema["properties"].as_object().unwrap().keys().collect();
        if keys.is_empty() {
            return Ok(());
        }
        let text = format!("[[stage]]\nkind = \"probe\"\nid = \"base\"\n[[stage]]\nid = \"own\"\nkind = \"{}\"\n", kind.kind);
        let set = vec![format!("own.{}={value}", key.get(&keys))];
        well_said(Plan::new(&source(&text), &Overrides { set, ..Default::default() }))?;
    }
}

#[test]
fn a_scene_is_checked_to_its_last_key() {
    let scene = |text: &str| format!("[[stage]]\nkind = \"probe\"\n{text}");
    let cases = [
        ("[scene]\nfgo = 1\n", "t.toml:4: unknown key 'fgo' in [scene] (did you mean 'fog'?)"),
        (
            "[scene.sun]\ntime_of_day_h = 99\n",
            "t.toml:4: 'time_of_day_h' in 'sun' of [scene] must be a number between 0 and 48 h, not 99",
        ),
        (
            "[scene.water]\ndark = \"blue\"\n",
            "t.toml:4: 'dark' in 'water' of [scene] must be a colour such as '#3fa7a5', not 'blue'",
        ),
        (
            "[scene.lava]\ncolours = [\"#000000\", \"#ff00\", \"#ffff00\"]\n",
            "t.toml:4: 'colours[2]' in 'lava' of [scene] must be a colour such as '#3fa7a5', not '#ff00'",
        ),
        (
            "[scene.lava]\ncolours = [\"#000000\"]\n",
            "t.toml:4: 'colours' in 'lava' of [scene] must be a list of 3 colours such as '#3fa7a5', not a list of 1",
        ),
        (
            "[scene.ground]\nrock_deg = [42, 28]\n",
            "t.toml:4: 'rock_deg' in 'ground' of [scene] must be two numbers, the first below the second, each between 0 and 90, not [42, 28]",
        ),
        (
            "[scene.sky]\npicture = \"no.png\"\n",
            "t.toml:4: 'picture' in 'sky' of [scene]: there is no file 'no.png' (paths are relative to the recipe)",
        ),
        (
            "[[scene.camera.keys]]\nat = 0.5\nview_dge = 3\n",
            "t.toml:5: unknown key 'view_dge' in 'keys[1]' of 'camera' of [scene] (did you mean 'view_deg'?)",
        ),
        (
            "[[scene.camera.keys]]\nat = 0.5\n[[scene.camera.keys]]\nat = 0.5\n",
            "t.toml:6: 'at' of a key of the camera is 0.5, and must lie behind that of the key before it",
        ),
    ];
    for (text, line) in cases {
        assert_eq!(refused(&scene(text)), line);
    }
    let plan = with(&["scene.sun.time_of_day_h=21", "scene.camera.keys=[{at=0.2, distance=0.5}]"]).unwrap();
    assert_eq!(plan.scene.sun.time_of_day_h, 21.0);
    assert_eq!(plan.scene.camera.keys[0].distance, Some(0.5));
    // What was set is in the text that a world remembers.
    let again = read_scene(&source(&plan.text), &["scene.fog.on=false".into()]).unwrap();
    assert_eq!((again.sun.time_of_day_h, again.fog.on), (21.0, false));
    let bare = read_scene(&source("exaggeration = 2\n[fog]\non = false\n"), &[]).unwrap();
    assert_eq!((bare.exaggeration, bare.fog.on), (Some(2.0), false));
    assert!(read_scene(&source("[scene]\n[[stage]]\nkind = \"import\"\nfile = \"gone.png\"\n"), &[]).is_ok());
    let line = with(&["scene.sun.tme_of_day_h=3"]).unwrap_err().to_string();
    let want =
        "--set scene.sun.tme_of_day_h: unknown key 'tme_of_day_h' in 'sun' of [scene] (did you mean 'time_of_day_h'?)";
    assert_eq!(line, want);
    assert_eq!(with(&[]).unwrap().scene, crate::scene::SceneParams::default());
}
