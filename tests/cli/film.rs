//! Films of a run: what other programs read in them, and what happens where they cannot be made.

use std::{fs::File, io::BufReader, path::Path, process::Command};

use upthrust::{
    relief::{
        View,
        film::{Animation, Options, Words},
    },
    world::store,
};

use super::{Place, Said};

/// Two stages, high enough for the colours of the Earth, and a film of 10 + 5 pictures at 25 a second.
const RECIPE: &str = "name = \"Short\"\n[world]\nsize = [96, 64]\nextent_km = 300\n\
    [[stage]]\nkind = \"fbm\"\nheight_m = 4000.0\nfilm_seconds = 0.4\n\
    [[stage]]\nkind = \"warp\"\nfilm_seconds = 0.2\n";
/// Pictures of that, and those for which the last stands a second.
const PICTURES: usize = 15;
const HELD: usize = 24;

fn place() -> Place {
    let place = Place::new();
    place.write("short.toml", RECIPE);
    place
}

/// Whether ffmpeg and ffprobe are there; where tests must not be skipped, they have to be.
fn has_ffmpeg() -> bool {
    let there = ["ffmpeg", "ffprobe"].iter().all(|name| Command::new(name).arg("-version").output().is_ok());
    if !there {
        assert!(std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_none(), "ffmpeg is missing");
        eprintln!("skipped: there is no ffmpeg");
    }
    there
}

fn film(place: &Place, file: &str, rest: &[&str]) -> Said {
    let world = format!("world-of-{}", file.replace(['/', '%', '.'], "-"));
    let fixed = ["grow", "short.toml", "--out", &world, "--video", file, "--video-size", "240x136", "--fps", "25"];
    place.run(&[&fixed[..], rest].concat())
}

/// What ffprobe says of a film's picture stream: codec, width, height, rate, pictures, and the seconds of all.
fn probe(path: &Path) -> (Vec<String>, f64) {
    let ask = |entries: &str| {
        let output = Command::new("ffprobe")
            .args(["-v", "error", "-count_frames", "-select_streams", "v:0", "-of", "default=nw=1:nk=1"])
            .args(["-show_entries", entries])
            .arg(path)
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let stream = ask("stream=codec_name,width,height,r_frame_rate,nb_read_frames");
    (stream, ask("format=duration")[0].parse().unwrap_or(0.0))
}

/// The last picture of a film as another program decodes it.
fn decoded(film: &Path, number: usize) -> image::RgbImage {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("p.png");
    let select = format!("select=eq(n\\,{number})");
    let status = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(film)
        .args(["-vf", &select, "-frames:v", "1"])
        .arg(&out)
        .status()
        .unwrap();
    assert!(status.success());
    image::open(out).unwrap().into_rgb8()
}

fn mean_difference(a: &image::RgbImage, b: &image::RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let sum: f64 = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}

#[test]
fn other_programs_read_every_kind() {
    if !has_ffmpeg() {
        return;
    }
    let place = place();
    assert_eq!(film(&place, "p/%03d.png", &[]).code, 0);
    let last = image::open(place.path(&format!("p/{PICTURES:03}.png"))).unwrap().into_rgb8();
    let upside_down = image::imageops::flip_vertical(&last);
    // Colours at half the resolution and lossy codes: a few steps of a byte; a GIF has 256 colours and dithers.
    let kinds = [
        ("mp4", "h264", 6.0),
        ("webm", "vp9", 6.0),
        ("mpg", "mpeg2video", 6.0),
        ("mov", "prores", 4.0),
        ("gif", "gif", 9.0),
    ];
    for (end, codec, most) in kinds {
        let name = format!("film.{end}");
        let said = film(&place, &name, &[]);
        assert_eq!((said.code, said.out.lines().nth(1)), (0, Some(name.as_str())), "{}", said.err);
        let path = place.path(&name);
        let (stream, seconds) = probe(&path);
        let pictures = (PICTURES + HELD).to_string();
        assert_eq!(stream, [codec, "240", "136", "25/1", &pictures], "{name}");
        // MPEG's program stream and GIF state times to a frame or two.
        assert!((seconds - (PICTURES + HELD) as f64 / 25.0).abs() < 0.09, "{name}: {seconds}");
        let shown = decoded(&path, PICTURES + HELD - 1);
        let (apart, flipped) = (mean_difference(&shown, &last), mean_difference(&shown, &upside_down));
        assert!(apart < most && flipped > 3.0 * apart, "{name}: {apart} {flipped}");
    }
    assert!(place.files().iter().all(|name| !name.contains("partial")), "{:?}", place.files());
}

#[test]
fn the_last_picture_is_the_finished_world() {
    let place = place();
    let world = "world-of-p--03d-png";
    for (view, folder) in [("relief", "p"), ("slope", "s")] {
        let name = format!("{folder}/%03d.png");
        let arguments = [
            "grow",
            "short.toml",
            "--out",
            world,
            "--force",
            "--video",
            &name,
            "--video-size",
            "264x136",
            "--fps",
            "25",
            "--view",
            view,
        ];
        let said = place.run(&arguments);
        assert_eq!(said.code, 0, "{}", said.err);
        assert_eq!(std::fs::read_dir(place.path(folder)).unwrap().count(), PICTURES);
        let (world, _) = store::read(&place.path(world).join("world.zarr")).unwrap();
        let view = if view == "relief" { View::Relief } else { View::Layer(upthrust::world::Layer::Slope) };
        let options =
            Options { size: [264, 136], view, range_m: [-9000.0, 9000.0], climate: false, smoke: true, title: None };
        let mut animation = Animation::new(world.grid, &options);
        let shot = animation.shot(&world).unwrap();
        let mut want = vec![0; animation.bytes()];
        animation.draw([&shot, &shot], 1.0, Words::default(), &mut want);
        let last = image::open(place.path(&format!("{folder}/{PICTURES:03}.png"))).unwrap().into_rgb8();
        let [width, height] = animation.map_size();
        assert_eq!([width, height], [204, 136]);
        let rows =
            |pixels: &[u8]| -> Vec<u8> { pixels.chunks(264 * 3).flat_map(|row| row[..width * 3].to_vec()).collect() };
        assert!(rows(last.as_raw()) == rows(&want), "{folder}");
    }
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let place = place();
    assert_eq!(film(&place, "one/%03d.png", &["--threads", "1", "--clock"]).code, 0);
    assert_eq!(film(&place, "many/%03d.png", &["--threads", "5", "--clock"]).code, 0);
    for i in 1..=PICTURES {
        let read = |folder: &str| std::fs::read(place.path(&format!("{folder}/{i:03}.png"))).unwrap();
        assert!(read("one") == read("many"), "{i}");
    }
}

#[test]
fn without_ffmpeg_there_is_an_animated_png() {
    let place = place();
    let alone = |arguments: &[&str]| {
        let output = place.command(arguments).env("PATH", place.path("nowhere")).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, err) = alone(&["grow", "short.toml", "--out", "w", "--video"]);
    assert_eq!(code, Some(0), "{err}");
    let file = BufReader::new(File::open(place.path("w/film.png")).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    // 0.4 and 0.2 seconds at the animated PNG's 15 a second.
    assert_eq!(reader.info().animation_control.unwrap().num_frames, 6 + 3);
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    for _ in 0..9 {
        reader.next_frame(&mut pixels).unwrap();
    }
    let before = place.files();
    let (code, err) = alone(&["grow", "short.toml", "--out", "v", "--video", "a.mp4"]);
    assert!(err.starts_with("error: a.mp4: this film needs ffmpeg, which is not installed (Debian"), "{err}");
    assert_eq!((code, err.lines().count(), place.files()), (Some(2), 1, before));
}

#[cfg(unix)]
#[test]
fn if_ffmpeg_dies_its_last_words_are_shown_and_the_world_is_there() {
    use std::os::unix::fs::PermissionsExt;
    let place = place();
    std::fs::create_dir(place.path("bin")).unwrap();
    let script = "#!/bin/sh\nfor last in \"$@\"; do :; done\necho half > \"${last#file:}\"\n\
                  head -c 500000 > /dev/null\necho warming up >&2\necho 'No space left on device' >&2\nexit 3\n";
    place.write("bin/ffmpeg", script);
    std::fs::set_permissions(place.path("bin/ffmpeg"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:/usr/bin:/bin", place.path("bin").display());
    for (file, shown) in [(None, "w0/film.mp4"), (Some("f.mp4"), "f.mp4")] {
        let world = if file.is_some() { "w1" } else { "w0" };
        let arguments = ["grow", "short.toml", "--quiet", "--out", world, "--video"];
        let arguments = [&arguments[..], file.as_slice()].concat();
        let output = place.command(&arguments).env("PATH", &path).output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        let words = "ffmpeg ended with exit status: 3: warming up; No space left on device\n";
        assert!(err.starts_with("error: ") && err.ends_with(words) && err.contains("mp4: "), "{shown}: {err}");
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(1), format!("{world}\n").as_bytes()));
        assert!(place.path(world).join("manifest.json").is_file());
    }
    let left: Vec<_> = place.files().into_iter().filter(|name| name.contains("mp4")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_ffmpeg_and_leaves_nothing() {
    if !has_ffmpeg() {
        return;
    }
    let place = Place::new();
    let slow = ["--size", "3000", "--set", "rmp_peak.iterations=5000", "--out", "w", "--video", "f.mp4"];
    // The peak alone, so that there is nothing yet to be kept.
    let set = ["grow", "rmp-peak", "--set", "rmp_peak.film_seconds=1", "--set", "plain.enabled=false"];
    let arguments = [&set[..], &slow[..]].concat();
    let mut child = place.command(&arguments).stderr(std::process::Stdio::null()).spawn().unwrap();
    let (own, here) = (child.id().to_string(), place.folder.path().canonicalize().unwrap());
    // Processes of this folder that are not the program itself.
    let others = || {
        let processes = std::fs::read_dir("/proc").unwrap().flatten();
        let in_here =
            processes.filter(|entry| std::fs::read_link(entry.path().join("cwd")).is_ok_and(|cwd| cwd == here));
        in_here.filter(|entry| entry.file_name().to_string_lossy() != own).count()
    };
    // The trial that finds the range comes first; then ffmpeg is started.
    let began = std::time::Instant::now();
    while others() == 0 {
        assert!(began.elapsed().as_secs() < 300, "ffmpeg was never started");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let sent = Command::new("kill").args(["-INT", &own]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(others(), 0);
    assert!(place.files().is_empty(), "{:?}", place.files());
}

#[test]
fn heightmaps_share_one_range() {
    let place = place();
    let said = place.run(&["grow", "short.toml", "--out", "w", "--frames", "maps", "--every", "5"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let index: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("maps/range.json")).unwrap()).unwrap();
    let (black, white) = (index["black_m"].as_f64().unwrap(), index["white_m"].as_f64().unwrap());
    let frames = index["frames"].as_array().unwrap();
    // Each stage has one step, and its end is always there.
    assert_eq!((frames.len(), &index["cut_cells"]), (2, &serde_json::json!(0)));
    assert_eq!((&frames[1]["file"], &frames[1]["stage"]), (&"00002.png".into(), &"warp".into()));
    let (world, _) = store::read(&place.path("w/world.zarr")).unwrap();
    let height = world.height();
    let picture = image::open(place.path("maps/00002.png")).unwrap().into_luma16();
    let step = (white - black) / 65535.0;
    for (x, y, pixel) in picture.enumerate_pixels() {
        let read = black + f64::from(pixel.0[0]) * step;
        assert!((read - f64::from(height.at(x as usize, y as usize))).abs() <= 0.5001 * step, "{x} {y}");
    }
    assert_eq!(std::fs::read_dir(place.path("maps")).unwrap().count(), 3);
}

#[test]
fn what_cannot_be_filmed_is_refused_in_one_line() {
    let place = place();
    let refused = |rest: &[&str], line: &str| {
        let before = place.files();
        let said = place.run(&[&["grow", "short.toml", "--out", "w"], rest].concat());
        assert_eq!((said.err.trim_end(), said.code), (format!("error: {line}").as_str(), 2), "{rest:?}");
        assert_eq!(place.files(), before, "{rest:?} left something behind");
    };
    let ends = "a film's name ends in .mp4, .webm, .mpg, .mov, .gif or .png, or is numbered, as in film/%05d.png or film/%05d.exr";
    refused(&["--video", "a.avi"], &format!("a.avi: {ends}"));
    refused(&["--video", "no/a.png"], "no/a.png: there is no folder 'no'");
    refused(&["--video", "a.exr"], "a.exr: one EXR holds one picture; number them, as in film/%05d.exr");
    place.write("old.png", "an old film");
    refused(&["--video", "old.png"], "old.png: exists; choose another name, or replace it with --force");
    refused(&["--video", "%d.png"], "%d.png: name a folder for the pictures too, as in film/%05d.png");
    refused(
        &["--video", "a.png", "--fps", "0"],
        "--fps 0: must be a number from 1 to 240, such as 30, 29.97 or 24000/1001",
    );
    refused(
        &["--video", "a.mpg", "--fps", "15"],
        "--fps 15: MPEG-2 (.mpg) knows only 23.976, 24, 25, 29.97, 30, 50, 59.94 and 60 frames a second",
    );
    refused(&["--video", "a.gif", "--fps", "60"], "--fps 60: a GIF shows at most 50 frames a second");
    refused(&["--video", "a.png", "--video-size", "9x9"], "--video-size 9x9: a side must be from 64 to 8192 pixels");
    refused(
        &["--video", "a.png", "--video-size", "big"],
        "--video-size big: write width and height as WxH, such as 1280x720",
    );
    refused(
        &["--video", "a.png", "--view", "relieff"],
        "--view relieff: neither 'relief', 'scene' nor a layer (did you mean 'relief'?)",
    );
    refused(
        &["--video", "a.png", "--view", "lava"],
        "--view lava: no stage of this recipe makes that layer (it has: relief, height, slope, bedrock)",
    );
    refused(&["--video", "a.png", "--ffmpeg-args", "-crf 9"], "--ffmpeg-args: a.png is made without ffmpeg");
    refused(&["--video", "a.mp4", "--ffmpeg-args", "'x"], "--ffmpeg-args 'x: a quote is not closed");
    refused(&["--fps", "30"], "--fps is about a film; ask for one with --video");
    refused(&["--every", "3"], "--every is about heightmaps; ask for them with --frames DIR");
    refused(&["--frames", "f", "--every", "0"], "--every 0: must be a whole number of steps from 1");
    std::fs::create_dir(place.path("full")).unwrap();
    place.write("full/x", "x");
    let full = "full: this folder has something in it; name a new one for the files";
    refused(&["--frames", "full"], full);
    refused(&["--video", "full/%d.png"], full);
    let said = place.run(&["grow", "--video", "short"]);
    assert!(said.err.contains("if 'short' is the recipe, write it before --video"), "{}", said.err);
    place.write("both.toml", format!("{RECIPE}film_yr_per_s = 5\n"));
    let said = place.run(&["grow", "both.toml"]);
    let line = "error: both.toml:12: 'film_yr_per_s' and 'film_seconds' both say how long the stage takes in a film; keep one\n";
    assert_eq!((said.err.as_str(), said.code), (line, 2));
}

#[test]
fn pictures_are_png_or_jpeg_by_their_ending() {
    let place = place();
    assert_eq!(place.run(&["grow", "short.toml", "--out", "w"]).code, 0);
    for (name, format) in
        [("p.png", image::ImageFormat::Png), ("p.jpg", image::ImageFormat::Jpeg), ("q.JPEG", image::ImageFormat::Jpeg)]
    {
        let said = place.run(&["render", "w", name]);
        assert_eq!(said.code, 0, "{}", said.err);
        let bytes = std::fs::read(place.path(name)).unwrap();
        assert_eq!(image::guess_format(&bytes).unwrap(), format, "{name}");
        assert!(image::load_from_memory(&bytes).is_ok());
    }
}

#[test]
fn smoke_stands_over_vents_that_erupt_unless_it_is_left_out() {
    let place = Place::new();
    let ground = "name = \"Fire\"\n[world]\nsize = 40\nextent_km = 0.05\n[[stage]]\nkind = \"rmp_peak\"\nheight_m = 12.0\n\
        half_width_km = 0.015\nfilm_seconds = 0.2\n[[stage]]\nkind = \"lava\"\nduration_min = 0.2\nspacing_m = 0.8\n\
        film_seconds = 1.0\nschedule = [{ start_time = 6, duration = 5, particles_per_second = 20 }]\n";
    place.write("fire.toml", ground);
    let film = |name: &str, rest: &[&str]| -> Vec<image::RgbImage> {
        let (out, file) = (format!("w-{name}"), format!("{name}/%02d.png"));
        let fixed = ["grow", "fire.toml", "--out", &out, "--video", &file, "--video-size", "160x90", "--fps", "10"];
        let said = place.run(&[&fixed[..], rest].concat());
        assert_eq!(said.code, 0, "{}", said.err);
        (1..=12).map(|k| image::open(place.path(&format!("{name}/{k:02}.png"))).unwrap().into_rgb8()).collect()
    };
    let (with, without) = (film("with", &["--keep-timeline"]), film("without", &["--no-smoke"]));
    // Two pictures of the peak and ten of twelve seconds: lava is due from the sixth to the eleventh, and smoke stays a while.
    let smokes: Vec<bool> = with.iter().zip(&without).map(|(a, b)| a != b).collect();
    assert!(smokes[..7].iter().all(|smokes| !smokes) && smokes[8..].iter().all(|smokes| *smokes), "{smokes:?}");
    // What was kept shows the same smoke again.
    let again = place.run(&["film", "w-with", "again/%02d.png", "--video-size", "160x90", "--fps", "10"]);
    assert_eq!(again.code, 0, "{}", again.err);
    for (k, with) in (1..=12).zip(&with) {
        let own = image::open(place.path(&format!("again/{k:02}.png"))).unwrap().into_rgb8();
        assert!(mean_difference(&own, with) < 0.5, "picture {k}: a timeline keeps heights, not all they are made of");
    }
    // An eruption column stands when its ash has just fallen.
    place.write(
        "ash.toml",
        "name = \"Ash\"\n[world]\nsize = 64\n[[stage]]\nkind = \"fbm\"\n[[stage]]\nkind = \"ash\"\n",
    );
    assert_eq!(place.run(&["grow", "ash.toml", "--out", "ash"]).code, 0);
    let picture = |file: &str, rest: &[&str]| {
        assert_eq!(place.run(&[&["render", "ash", file], rest].concat()).code, 0);
        image::open(place.path(file)).unwrap().into_rgb8()
    };
    assert!(picture("a.png", &["--smoke"]) != picture("b.png", &[]));
    assert!(picture("c.png", &["--smoke", "--view", "slope"]) == picture("d.png", &["--view", "slope"]));
}
