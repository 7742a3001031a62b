//! Scenes: stills, films, data views, and what cannot be drawn.

use super::{Place, Said, bad_input::refused};

/// Hills by the sea, seen from the east.
const RECIPE: &str = "name = \"Bay\"\n[world]\nsize = [48, 32]\nextent_km = 30\n\
    [scene]\nquality = \"draft\"\n[scene.camera]\nfrom_deg = 90\nturn_deg = 120\n\
    [[stage]]\nkind = \"fbm\"\nheight_m = 900.0\nfilm_seconds = 0.5\n";

/// A folder with that world.
fn place() -> Place {
    let place = Place::new();
    place.write("bay.toml", RECIPE);
    assert_eq!(place.run(&["grow", "bay.toml", "--out", "w", "--quiet"]).code, 0);
    place
}

/// Whether scenes can be drawn here; where tests must not be skipped, they have to be, in builds that draw any.
fn drawn(said: &Said) -> bool {
    let missing = !cfg!(feature = "render") || said.err.contains("no graphics adapter was found");
    if missing && cfg!(feature = "render") {
        assert!(std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_none(), "{}", said.err);
        eprintln!("skipped: {}", said.err);
    }
    assert!(missing || said.code == 0, "{}", said.err);
    !missing
}

fn picture(place: &Place, name: &str) -> image::RgbImage {
    image::open(place.path(name)).unwrap().into_rgb8()
}

/// Mean difference of two pictures, in steps of a byte.
fn apart(a: &image::RgbImage, b: &image::RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let sum: f64 = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}

#[test]
fn stills_have_their_size_and_obey_recipe_and_flags() {
    let place = place();
    let render = |name: &str, rest: &[&str]| {
        let fixed = ["render", "w", name, "--size", "128x72", "--view"];
        place.run(&[&fixed[..], rest].concat())
    };
    if !drawn(&render("a.png", &["scene"])) {
        return;
    }
    let a = picture(&place, "a.png");
    assert_eq!(a.dimensions(), (128, 72));
    let differs = |name: &str, rest: &[&str]| {
        let said = render(name, rest);
        assert!(drawn(&said));
        // Far more than the noise of rounding: another picture.
        assert!(apart(&a, &picture(&place, name)) > 2.0, "{rest:?}");
    };
    assert!(drawn(&render("again.png", &["scene", "--set", "scene.camera.from_deg=90"])));
    assert_eq!(apart(&a, &picture(&place, "again.png")), 0.0, "the recipe's own side");
    differs("side.png", &["scene", "--set", "scene.camera.from_deg=270"]);
    differs("night.png", &["scene", "--time-of-day", "0"]);
    differs("top.png", &["scene", "--camera", "top"]);
    place.write("cam.toml", "down_deg = 80\ndistance = 0.4\n");
    differs("cam.png", &["scene", "--camera", "cam.toml"]);
    place.write("dusk.toml", "[sun]\naltitude_deg = 2\nazimuth_deg = 180\n");
    differs("dusk.png", &["scene", "--scene", "dusk.toml"]);
    differs("slope.png", &["scene:slope"]);
    // Paper with the legend on the right.
    assert_eq!(picture(&place, "slope.png").get_pixel(126, 36).0, [0xfa, 0xf8, 0xf2]);
}

#[test]
fn a_film_grows_the_scene_and_another_turns_around_it() {
    let place = place();
    let film =
        |file: &str| ["--view", "scene", "--video-size", "64x64", "--fps", "10", "--video", file].map(str::to_owned);
    let args: Vec<String> =
        ["grow", "bay.toml", "--out", "v"].map(str::to_owned).into_iter().chain(film("g/%02d.png")).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    if !drawn(&place.run(&args)) {
        return;
    }
    let files = |folder: &str| std::fs::read_dir(place.path(folder)).unwrap().count();
    assert_eq!(files("g"), 5);
    assert!(apart(&picture(&place, "g/01.png"), &picture(&place, "g/05.png")) > 2.0);
    let turn =
        ["film", "w", "t/%02d.png", "--view", "scene", "--seconds", "0.3", "--fps", "10", "--video-size", "64x64"];
    assert!(drawn(&place.run(&turn)));
    assert_eq!(files("t"), 3);
    assert!(apart(&picture(&place, "t/01.png"), &picture(&place, "t/03.png")) > 2.0);
    let data =
        ["film", "w", "d.png", "--view", "scene:slope", "--seconds", "0.2", "--fps", "10", "--video-size", "96x64"];
    assert!(drawn(&place.run(&data)));
    assert_eq!(picture(&place, "d.png").dimensions(), (96, 64));
}

#[test]
fn bad_flags() {
    let place = place();
    let render = |rest: &[&str], line: &str| refused(&place, &[&["render", "w", "a.png"], rest].concat(), line, 2);
    let size = "each side must be from 16 to 16384 pixels";
    render(&["--view", "scene", "--size", "0x0"], &format!("--size 0x0: {size}"));
    render(&["--view", "scene", "--size", "99999x720"], &format!("--size 99999x720: {size}"));
    render(&["--view", "scene", "--size", "-5"], "--size -5: write width and height as WxH, such as 1280x720");
    render(
        &["--view", "scene", "--camera", "orbti"],
        "--camera orbti: must be one of orbit, fly, top, still, or a file that ends in .toml (did you mean 'orbit'?)",
    );
    render(&["--view", "scene", "--quality", "best"], "--quality best: must be one of draft, normal, full");
    render(
        &["--view", "scene", "--time-of-day", "noon"],
        "--time-of-day noon: write hours from 0 to 48, such as 16.5, or where a film's day begins and ends, such as 5..21 (to 72)",
    );
    render(&["--camera", "top"], "--camera is about scenes; ask for one with --view scene");
    render(&["--view", "slope", "--size", "64x64"], "--size is about scenes; ask for one with --view scene");
    let film = |rest: &[&str], line: &str| refused(&place, &[&["film", "w", "a.png"], rest].concat(), line, 2);
    film(&["--seconds", "2"], "--seconds: a map of a finished world does not move; a scene does, with --view scene");
    film(&["--view", "scene", "--seconds", "-1"], "--seconds -1: must be a number of seconds from 0.1 to 3600");
    film(&["--quality", "draft"], "--quality is about scenes; ask for one with --view scene");
    let grow = |rest: &[&str], line: &str| refused(&place, &[&["grow", "bay.toml"], rest].concat(), line, 2);
    grow(&["--camera", "top"], "--camera is about a film; ask for one with --video");
    if !cfg!(feature = "render") {
        let line = "--view scene: this build draws no scenes; build it with the feature 'render' (cargo build --release \
                    --features render)";
        render(&["--view", "scene"], line);
        film(&["--view", "scene", "--seconds", "1"], line);
        return;
    }
    render(
        &["--view", "scene:slop"],
        "--view scene:slop: 'scene:' goes with relief or a layer (did you mean 'scene:slope'?)",
    );
    render(
        &["--view", "scene", "--smoke"],
        "--smoke is about maps; in a scene smoke is drawn, or not with --set scene.smoke.on=false",
    );
    film(
        &["--view", "scene"],
        "w: no timeline was kept in it; for the finished world and a camera that moves, say how long, such as --seconds 10",
    );
    render(
        &["--view", "scene", "--set", "fbm.hurst=1"],
        "--set fbm.hurst: the world is grown already; of the scene, write scene.PARAM=VALUE, such as scene.sky.exposure=1",
    );
    render(
        &["--view", "scene", "--set", "scene.sun.tme_of_day_h=3"],
        "--set scene.sun.tme_of_day_h: unknown key 'tme_of_day_h' in 'sun' of [scene] (did you mean 'time_of_day_h'?)",
    );
    render(&["--view", "scene", "--camera", "no.toml"], "no.toml: there is no such file");
    place.write("late.toml", "[[keys]]\nat = 0.5\n[[keys]]\nat = 0.2\n");
    render(
        &["--view", "scene", "--camera", "late.toml"],
        "late.toml:4: 'at' of a key of the camera is 0.2, and must lie behind that of the key before it",
    );
    place.write("far.toml", "distance = 1000\n");
    render(
        &["--view", "scene", "--camera", "far.toml"],
        "far.toml:1: 'distance' in [scene.camera] must be a number between 0.0001 and 20 sides, not 1000",
    );
}

#[cfg(feature = "render")]
#[test]
fn without_an_adapter_there_is_a_line_about_what_to_install() {
    let place = place();
    let draw = |arguments: &[&str]| {
        // No system has both this interface and the tests' other ones.
        let backend = if cfg!(windows) { "metal" } else { "dx12" };
        let output = place.command(arguments).env("WGPU_BACKEND", backend).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let before = place.files();
    for arguments in [
        &["render", "w", "a.png", "--view", "scene"][..],
        &["film", "w", "a.png", "--view", "scene", "--seconds", "1"],
        &["grow", "bay.toml", "--out", "v", "--quiet", "--video", "a.png", "--view", "scene"],
    ] {
        let (code, said) = draw(arguments);
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!((code, lines.len()), (1, 1), "{said}");
        assert!(said.starts_with("error: no graphics adapter was found; install a Vulkan driver"), "{said}");
        assert_eq!(place.files(), before, "{arguments:?} left something behind");
    }
}
