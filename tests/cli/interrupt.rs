//! Stopping a run, and readers that stop listening.

use std::{
    io::{BufRead, BufReader, Read},
    process::Stdio,
    time::Duration,
};

use super::Place;

/// Stops a run once it has told `line` (or, without one, as soon as its folder shows); returns all it said.
#[cfg(unix)]
fn interrupted(place: &Place, arguments: &[&str], line: Option<&str>) -> String {
    let mut child = place.command(arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut err = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    match line {
        Some(line) => {
            while !said.contains(line) {
                assert!(err.read_line(&mut said).unwrap() > 0, "it ended before it could be stopped: {said}");
            }
        }
        None => {
            while place.files().is_empty() {
                assert!(child.try_wait().unwrap().is_none(), "it ended before it could be stopped");
                std::thread::sleep(Duration::from_millis(5));
            }
        }
    }
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    err.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    said
}

// A stage of thousands of draws on a large map: minutes, unless stopped.
#[cfg(unix)]
const LONG: [&str; 7] = ["grow", "rmp-peak", "--size", "3000", "--set", "rmp_peak.iterations=5000", "--out"];

#[cfg(unix)]
#[test]
fn ctrl_c_before_the_first_step_leaves_nothing() {
    let place = Place::new();
    let mut arguments = [&LONG[..], &["w"]].concat();
    // The peak alone: one step, which is not begun or not done.
    arguments.extend(["--set", "plain.enabled=false"]);
    let said = interrupted(&place, &arguments, None);
    assert_eq!(said.lines().last(), Some("stopped; nothing was written"));
    assert!(place.files().is_empty(), "{:?}", place.files());
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_was_done() {
    let place = Place::new();
    let arguments = [&LONG[..], &["w"]].concat();
    let said = interrupted(&place, &arguments, Some("1/2 "));
    assert_eq!(said.lines().last(), Some("stopped; the same command with --resume goes on from here"));
    assert_eq!(place.entries(), [".w.growing"]);
    let again = place.run(&arguments);
    let what = "error: w: a stopped run of this world is kept; go on with --resume, or start anew with --force";
    assert_eq!((again.code, again.err.lines().last()), (2, Some(what)), "{}", again.err);
    let other = place.run(&["grow", "fbm-rough", "--size", "16", "--out", "w", "--resume"]);
    let what = "w.growing/checkpoints: the stopped run there is of another recipe; start anew with --force, or choose";
    assert!(other.code == 2 && other.err.contains(what), "{}", other.err);
    assert_eq!(place.entries(), [".w.growing"]);
    let anew = place.run(&["grow", "fbm-rough", "--size", "16", "--out", "w", "--force"]);
    assert_eq!((anew.code, place.entries()), (0, vec!["w".to_owned()]), "{}", anew.err);
    let done = place.run(&["grow", "fbm-rough", "--size", "16", "--out", "w", "--resume", "--quiet"]);
    assert_eq!((done.code, done.out.as_str()), (0, "w\n"), "{}", done.err);
    let other = place.run(&["grow", "fbm-rough", "--size", "32", "--out", "w", "--resume"]);
    assert!(other.code == 2 && other.err.contains("w: the world there is of another recipe"), "{}", other.err);
}

#[cfg(unix)]
#[test]
fn a_second_ctrl_c_waits_for_nothing() {
    let place = Place::new();
    let arguments = [&LONG[..], &["w"]].concat();
    let mut child = place.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut err = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    while !said.contains("1/2 ") {
        assert!(err.read_line(&mut said).unwrap() > 0, "it ended before it could be stopped: {said}");
    }
    // The second may find it gone.
    for _ in 0..2 {
        let _ = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    // Whatever stands is no world, and in nobody's way.
    assert!(!place.path("w").exists(), "{:?}", place.entries());
    let anew = place.run(&["grow", "fbm-rough", "--size", "16", "--out", "w", "--force"]);
    assert_eq!((anew.code, place.entries()), (0, vec!["w".to_owned()]), "{}", anew.err);
}

#[cfg(unix)]
#[test]
fn a_resumed_run_keeps_the_timeline_of_the_whole() {
    let place = Place::new();
    // A long stage after the plates, so that there is time to stop behind them.
    let recipe = place.run(&["presets", "collision"]).out;
    let peak = "[[stage]]\nkind = \"rmp_peak\"\niterations = 5000\nblend = \"add\"\n";
    place.write("long.toml", format!("{recipe}\n{peak}"));
    let set = ["--set", "plates.cells=160", "--set", "rivers.enabled=false", "--keep-timeline", "--out", "w"];
    let arguments = [&["grow", "long.toml", "--size", "300"], &set[..]].concat();
    interrupted(&place, &arguments, Some("1/2 "));
    // The peak is left out, so that it is soon done.
    let said = place.run(&[&arguments[..], &["--resume", "--until", "plates"]].concat());
    assert!(said.code == 0 && said.err.contains("goes on at 10.000 million years\n"), "{}", said.err);
    let said = place.run(&["film", "w", "whole.png", "--video-size", "160x90"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let file = BufReader::new(std::fs::File::open(place.path("whole.png")).unwrap());
    let frames = png::Decoder::new(file).read_info().unwrap().info().animation_control().unwrap().num_frames;
    assert!(frames > 70, "{frames}");
}

#[cfg(unix)]
#[test]
fn a_resumed_run_with_nothing_left_to_film_says_so() {
    let place = Place::new();
    let recipe = "[[stage]]\nkind = \"fbm\"\n[[stage]]\nkind = \"rmp_peak\"\niterations = 5000\nblend = \"add\"\n";
    place.write("long.toml", recipe);
    let arguments = ["grow", "long.toml", "--size", "3000", "--out", "w"];
    interrupted(&place, &arguments, Some("1/2 "));
    // The stopped run stands at the end of the ground, and no more is wanted.
    let rest = ["--resume", "--until", "fbm", "--video", "film.png"];
    let said = place.run(&[&arguments[..], &rest].concat());
    let what = "error: film.png: nothing was left to film: the stopped run had done its last step; --force grows and \
                films it anew";
    assert_eq!((said.code, said.err.lines().last()), (1, Some(what)), "{}", said.err);
    assert!(place.path("w/manifest.json").exists() && !place.path("film.png").exists());
    assert_eq!(place.entries(), ["long.toml", "w"]);
}

/// A run of a few seconds, in steps of some ten milliseconds, with checkpoints as often as can be.
#[cfg(unix)]
const KILLED: [&str; 9] =
    ["grow", "collision", "--size", "96", "--set", "plates.cells=160", "--checkpoint-every", "0", "--resume"];

#[cfg(unix)]
#[test]
fn killed_at_any_moment_it_ends_at_the_same_bits() {
    let hashes = |place: &Place, world: &str| {
        let text = std::fs::read_to_string(place.path(world).join("manifest.json")).unwrap();
        let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
        let series = std::fs::read_to_string(place.path(world).join("series.csv")).unwrap();
        (manifest["layers"].clone(), manifest["ledger"].clone(), manifest["time_yr"].clone(), series)
    };
    let place = Place::new();
    let began = std::time::Instant::now();
    assert_eq!(place.run(&["grow", "collision", "--size", "96", "--set", "plates.cells=160", "--out", "a"]).code, 0);
    let whole_ms = began.elapsed().as_millis() as u64;
    let mut resumed = 0;
    for round in 0..20u64 {
        let arguments = [&KILLED[..], &["--out", "b"]].concat();
        let mut child = place.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        // Scattered over the length of a run by the golden ratio; each life ends a little later than it began.
        let share = (round as f64 * 0.618_034).fract();
        std::thread::sleep(Duration::from_millis(20 + (share * 1.1 * whole_ms as f64) as u64));
        let _ = child.kill();
        child.wait().unwrap();
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert!(!said.contains("error"), "round {round}: {said}");
        resumed += usize::from(said.contains("goes on at"));
        if place.path("b").exists() {
            assert_eq!(hashes(&place, "b"), hashes(&place, "a"), "round {round}");
            std::fs::remove_dir_all(place.path("b")).unwrap();
        }
    }
    assert!(resumed >= 3, "only {resumed} of 20 runs went on from a checkpoint");
    let said = place.run(&[&KILLED[..], &["--out", "b"]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(hashes(&place, "b"), hashes(&place, "a"));
    assert_eq!(place.entries(), ["a", "b"]);
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let place = Place::new();
    let mut child =
        place.command(&["params", "--markdown"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}
