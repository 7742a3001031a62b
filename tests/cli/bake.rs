//! Recordings of particles: made, looked at, exported, stopped and damaged.

use super::{Place, Said};

/// A cone of some metres, and lava for three seconds, in three steps.
const RECIPE: &str = "name = \"Small fire\"\n[world]\nseed = 3\nsize = 40\nextent_km = 0.05\n\
    [[stage]]\nkind = \"rmp_peak\"\nheight_m = 12.0\nhalf_width_km = 0.015\n\
    [[stage]]\nkind = \"lava\"\nduration_min = 0.05\nspacing_m = 0.8\n\
    schedule = [{ start_time = 0, duration = 2, particles_per_second = 150 }]\n";

fn place() -> Place {
    let place = Place::new();
    place.write("fire.toml", RECIPE);
    place
}

fn bake(place: &Place, out: &str, rest: &[&str]) -> Said {
    place.run(&[&["grow", "fire.toml", "--out", out, "--bake"][..], rest].concat())
}

fn bytes(place: &Place, file: &str) -> Vec<u8> {
    std::fs::read(place.path(file)).unwrap()
}

#[test]
fn two_bakes_are_the_same_bytes_and_the_world_is_that_without() {
    let place = place();
    assert_eq!(bake(&place, "a", &["--threads", "1"]).code, 0);
    assert_eq!(bake(&place, "b", &["--threads", "2"]).code, 0);
    assert!(bytes(&place, "a/lava.upbake") == bytes(&place, "b/lava.upbake"));
    assert_eq!(place.run(&["grow", "fire.toml", "--out", "plain"]).code, 0);
    let manifest = |world: &str| -> serde_json::Value {
        serde_json::from_slice(&bytes(&place, &format!("{world}/manifest.json"))).unwrap()
    };
    assert_eq!(manifest("a")["layers"], manifest("plain")["layers"]);
    assert_eq!(manifest("a")["baked"], serde_json::json!(["lava.upbake"]));
    assert!(manifest("plain")["baked"].is_null() && !place.path("plain/lava.upbake").exists());
    // Another rate, another file; a finished world is not baked afterwards.
    assert_eq!(bake(&place, "c", &["--bake-rate", "10"]).code, 0);
    assert!(bytes(&place, "c/lava.upbake").len() < bytes(&place, "a/lava.upbake").len());
    assert_eq!(bake(&place, "a", &["--resume"]).code, 0);
    let late = bake(&place, "plain", &["--resume"]);
    let line = "error: plain: the world there is finished and was not baked so; --force grows and bakes it anew\n";
    assert_eq!((late.code, late.err.as_str()), (2, line));
}

#[test]
fn a_recording_is_inspected_and_its_moments_are_exported() {
    let place = place();
    assert_eq!(bake(&place, "w", &["--bake-rate", "20"]).code, 0);
    let said = place.run(&["inspect", "w/lava.upbake"]);
    for part in [
        "recording of    stage 'lava' (lava) of 'fire', seed 3",
        "frames          61, 20 a second, from 0 to 3 s",
        "columns         x (m), y (m), z (m), temperature (degC), age (s)",
        "hashes          all right",
    ] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
    let json: serde_json::Value =
        serde_json::from_str(&place.run(&["inspect", "w/lava.upbake", "--json"]).out).unwrap();
    assert_eq!((&json["header"]["frames"], &json["header"]["seed"]), (&61.into(), &3.into()));
    assert!(json["particles"].as_u64().unwrap() > 250, "{json}");

    // The last frame is what the stage shows before it settles; one in the middle lies between its neighbours.
    let rows = |file: &str, at: &str| -> Vec<Vec<f64>> {
        let said = place.run(&["export", "w/lava.upbake", file, "--at", at]);
        assert_eq!((said.code, said.out), (0, format!("{file}\n")), "{}", said.err);
        let text = String::from_utf8(bytes(&place, file)).unwrap();
        assert!(text.starts_with("id,x_m,y_m,z_m,temperature_degc,age_s,radius_m\n"));
        text.lines().skip(1).map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let [before, middle, after] = [("a.csv", "1.5"), ("b.csv", "1.525"), ("c.csv", "1.55")].map(|(f, t)| rows(f, t));
    assert!(before.len() > 150 && middle.len() == before.len());
    for ((a, m), i) in before.iter().zip(&middle).zip(0..) {
        let Some(c) = after.iter().find(|row| row[0] == a[0]) else { continue };
        for column in 1..6 {
            // As many digits as are written.
            let off = (m[column] - 0.5 * (a[column] + c[column])).abs();
            assert!(off <= 2e-4 + if column == 4 { 1e-3 } else { 0.0 }, "row {i}, column {column}: {off}");
        }
    }
    let said = place.run(&["export", "w/lava.upbake", "p.ply", "--at", "1.5"]);
    assert_eq!((said.code, said.out.as_str()), (0, "p.ply\n"), "{}", said.err);
    let ply = bytes(&place, "p.ply");
    let head = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    assert_eq!(ply.len() - head, 28 * before.len());
    let early = place.run(&["export", "w/lava.upbake", "e.ply", "--at", "0"]);
    assert_eq!((early.code, early.err.as_str()), (0, "note: no particle flows at 0 s\n"));
}

#[cfg(unix)]
#[test]
fn a_stopped_bake_goes_on_to_the_same_bytes() {
    let place = place();
    let long = RECIPE.replace("duration_min = 0.05", "duration_min = 0.6").replace("duration = 2", "duration = 20");
    place.write("fire.toml", long);
    assert_eq!(bake(&place, "whole", &[]).code, 0);
    let arguments = ["grow", "fire.toml", "--out", "w", "--bake", "--checkpoint-every", "0"];
    let mut child = place.command(&arguments).stdout(std::process::Stdio::null()).spawn().unwrap();
    while !place.path(".w.growing/checkpoints/000006").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be stopped");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    // Killed, not asked.
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(place.entries(), [".w.growing", "fire.toml", "whole"]);
    for (rest, what) in
        [(&["--bake-rate", "7"][..], "at another rate"), (&["--set", "lava.smoothing=1.2"], "another recipe")]
    {
        let said = bake(&place, "w", &[&["--resume"], rest].concat());
        assert!(said.code == 2 && said.err.contains(what), "{}", said.err);
    }
    let said = bake(&place, "w", &["--resume"]);
    assert!(said.code == 0 && said.err.contains("goes on at"), "{}", said.err);
    assert!(bytes(&place, "w/lava.upbake") == bytes(&place, "whole/lava.upbake"));
    assert_eq!(place.entries(), ["fire.toml", "w", "whole"]);
}

#[test]
fn what_cannot_be_baked_is_said_before_anything_is_begun() {
    let place = place();
    let refused = |arguments: &[&str], line: &str| {
        let said = place.run(arguments);
        assert_eq!((said.code, said.err.lines().last()), (2, Some(line)), "{arguments:?}");
    };
    for rate in ["0", "-3", "1e6", "nan", "fast", ""] {
        let line = format!("error: --bake-rate {rate}: must be a number of frames a second from 0.001 to 1000");
        refused(&["grow", "fire.toml", "--bake", "--bake-rate", rate], &line);
    }
    refused(
        &["grow", "fire.toml", "--bake-rate", "30"],
        "error: --bake-rate is about the recording of particles; ask for it with --bake",
    );
    refused(
        &["grow", "fbm-rough", "--bake"],
        "error: --bake: no stage that runs has particles to record ('lava' and 'rain_particles' have); this recipe has: fbm",
    );
    refused(
        &["grow", "fire.toml", "--bake", "--until", "rmp_peak"],
        "error: --bake: no stage that runs has particles to record ('lava' and 'rain_particles' have); this recipe has: rmp_peak, lava",
    );
    let set = ["--set", "lava.duration_min=1000", "--set", "lava.spacing_m=3", "--bake-rate", "100"];
    refused(
        &[&["grow", "fire.toml", "--bake"][..], &set].concat(),
        "error: --bake-rate 100: stage 'lava' lasts 60000 s, which makes 6000001 frames, 1000000 at most",
    );
    refused(
        &["grow", "fire.toml", "--bake", "--seeds", "1..4", "--sheet", "s.png"],
        "error: --bake does not go with --sheet, which grows no folder",
    );
    assert_eq!(place.entries(), ["fire.toml"]);
}

#[test]
fn a_series_of_moments_is_numbered_and_each_is_that_moment() {
    let place = place();
    assert_eq!(bake(&place, "w", &["--bake-rate", "20"]).code, 0);
    let said = place.run(&["export", "w/lava.upbake", "frames/p_%03d.ply", "--every", "0.75"]);
    let note = "note: 5 files, from 0 to 3 s\n";
    assert_eq!((said.code, said.out.as_str(), said.err.as_str()), (0, "frames\n", note));
    assert_eq!(std::fs::read_dir(place.path("frames")).unwrap().count(), 5);
    assert_eq!(place.run(&["export", "w/lava.upbake", "one.ply", "--at", "1.5"]).code, 0);
    assert!(bytes(&place, "frames/p_003.ply") == bytes(&place, "one.ply"));
    let said = place.run(&["export", "w/lava.upbake", "late/%05d.csv", "--every", "1", "--at", "2"]);
    assert_eq!((said.code, said.err.as_str()), (0, "note: 2 files, from 2 to 3 s\n"));
    let refused = |arguments: &[&str], what: &str| {
        let said = place.run(&[&["export", "w/lava.upbake"], arguments].concat());
        assert_eq!((said.code, said.err), (2, format!("error: {what}\n")), "{arguments:?}");
    };
    let full = "frames: this folder has something in it; name a new one for the files";
    refused(&["frames/%d.ply", "--every", "1"], full);
    for bare in ["new/p.ply", "%05d.ply"] {
        let what = format!("{bare}: name a new folder and number the files in it, as in points/%05d.ply");
        refused(&[bare, "--every", "1"], &what);
    }
    let many = "--every 0.00001: that would be 300001 files, 100000 at most; take 3.0e-5 s or more";
    refused(&["new/%05d.ply", "--every", "0.00001"], many);
    let outside = "w/lava.upbake: there is no moment 3.5 s: it lasts from 0 to 3 s";
    refused(&["new/%05d.ply", "--every", "1", "--at", "3.5"], outside);
    assert!(!place.path("new").exists());
    for every in ["0", "-1", "x", "inf"] {
        let what = format!("--every {every}: must be a number of seconds above 0, such as 0.04");
        refused(&["new/%05d.ply", "--every", every], &what);
    }
}

#[test]
fn smoke_is_exported_as_points() {
    let place = place();
    assert_eq!(place.run(&["grow", "fire.toml", "--out", "w"]).code, 0);
    let said = place.run(&["export", "w", "smoke.csv", "--layer", "plumes"]);
    assert_eq!((said.code, said.out.as_str()), (0, "smoke.csv\n"), "{}", said.err);
    let text = String::from_utf8(bytes(&place, "smoke.csv")).unwrap();
    assert!(text.starts_with("id,x_m,y_m,z_m,radius_m,opacity,age_s,plume\n"), "{text}");
    // Three puffs a second for 2 s, and all still in the air at 3 s.
    assert_eq!(text.lines().count(), 1 + 6, "{text}");
    let ages: Vec<f64> = text.lines().skip(1).map(|line| line.split(',').nth(6).unwrap().parse().unwrap()).collect();
    assert!(ages.iter().all(|age| (1.33..=3.01).contains(age)), "{ages:?}");
    let said = place.run(&["export", "w", "smoke/%d.ply", "--layer", "plumes", "--every", "1"]);
    assert_eq!((said.code, said.err.as_str()), (0, "note: 4 files, from 0 to 3 s\n"));
    let refused = |arguments: &[&str], what: &str| {
        let said = place.run(&[&["export"], arguments].concat());
        assert_eq!((said.code, said.err), (2, format!("error: {what}\n")), "{arguments:?}");
    };
    refused(&["w", "s.png", "--layer", "plumes"], "s.png: smoke becomes .ply or .csv");
    let late = "w: there is no moment 9 s: smoke lasts until the world ends, from 0 to 3 s";
    refused(&["w", "s.ply", "--layer", "plumes", "--at", "9"], late);
    let still = &["grow", "fire.toml", "--out", "still", "--set", "lava.smoke_m_per_s=0"];
    assert_eq!(place.run(still).code, 0);
    refused(&["still", "s.ply", "--layer", "plumes"], "still: no vent of this world ever smoked");
}

#[test]
fn what_cannot_be_exported_is_said() {
    let place = place();
    assert_eq!(bake(&place, "w", &["--bake-rate", "5"]).code, 0);
    let refused = |arguments: &[&str], what: &str| {
        let said = place.run(&[&["export"], arguments].concat());
        assert_eq!((said.code, said.err), (2, format!("error: {what}\n")), "{arguments:?}");
    };
    refused(
        &["w/lava.upbake", "p.ply"],
        "p.ply: name the moment with --at SECONDS, or write a series with --every SECONDS",
    );
    refused(&["w/lava.upbake", "p.png", "--at", "1"], "p.png: a recording of particles becomes .ply or .csv");
    let such = "p.ply: such files hold particles, and w is no recording of them; bake one with grow --bake, or ask for smoke \
        with --layer plumes";
    refused(&["w", "p.ply", "--at", "1"], such);
    refused(
        &["w", "p.png", "--at", "1"],
        "--at is about the time of a recording of particles, or of smoke, which this is not",
    );
    let outside = "w/lava.upbake: there is no moment 3.5 s: it lasts from 0 to 3 s";
    refused(&["w/lava.upbake", "p.ply", "--at", "3.5"], outside);
    for at in ["-1", "x", "nan"] {
        let what = format!("--at {at}: must be a number of seconds from 0");
        refused(&["w/lava.upbake", "p.ply", "--at", at], &what);
    }
    refused(&["w/lava.upbake", "p.ply", "--at", "1", "--size", "9"], "p.ply: --size does not go with points");
    refused(&["w/lava.upbake", "p.ply", "--at", "1", "--window", "0,0,1"], "p.ply: --window does not go with points");
    place.write("p.ply", "mine");
    let said = place.run(&["export", "w/lava.upbake", "p.ply", "--at", "1"]);
    assert!(said.code == 2 && said.err.contains("p.ply") && said.err.contains("--force"), "{}", said.err);
    assert_eq!(bytes(&place, "p.ply"), b"mine");
}

#[test]
fn a_damaged_recording_gives_one_line() {
    let place = place();
    assert_eq!(bake(&place, "w", &[]).code, 0);
    let whole = bytes(&place, "w/lava.upbake");
    let mut bad = whole.clone();
    let at = whole.windows(4).enumerate().filter(|(_, mark)| mark == b"CHNK").nth(2).unwrap().0;
    bad[at + 100] ^= 4;
    place.write("bad.upbake", &bad);
    place.write("cut.upbake", &whole[..at + 100]);
    place.write("text.upbake", "hello");
    let place_in_file = format!("chunk 3 (frames 61 to 90, at byte {at}): its bytes are not those that were written");
    for (file, code, what) in [
        ("bad.upbake", 1, place_in_file),
        ("cut.upbake", 1, format!("chunk 3, at byte {at}: it ends after frame 61 of 91")),
        ("text.upbake", 2, "this is no recording of particles".into()),
    ] {
        let said = place.run(&["inspect", file]);
        let line = format!("error: {file}: {what}");
        assert!(said.code == code && said.err.starts_with(&line) && said.err.lines().count() == 1, "{}", said.err);
        let said = place.run(&["export", file, "p.ply", "--at", "2.5"]);
        assert!(said.code == code && said.err.starts_with(&line), "{}", said.err);
        assert!(!place.path("p.ply").exists());
    }
    let two = place.run(&["inspect", "bad.upbake", "w"]);
    assert!(two.code == 2 && two.err.contains("is inspected alone"), "{}", two.err);
}
