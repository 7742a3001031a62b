//! Recordings that are whole, damaged, stopped and played, against what was put in.

use std::{fs, path::Path};

use super::*;

const PER_S: f64 = 8.0;

fn header(duration_s: f64) -> Header {
    let columns = [["x", "m"], ["y", "m"], ["z", "m"], ["temperature", "degC"], ["age", "s"]];
    Header {
        program: "test".into(),
        recipe: "r".into(),
        recipe_sha256: "0".repeat(64),
        seed: 7,
        stage: "lava".into(),
        kind: "lava".into(),
        parameters: serde_json::json!({ "a": 1.5 }),
        extent_m: [100.0, 80.0],
        wraps: false,
        radius_m: 0.3,
        columns: columns.iter().map(|[name, unit]| Column::new(name, unit)).collect(),
        frames_per_s: PER_S,
        frames: frames_by(duration_s, PER_S),
        duration_s,
    }
}

/// Particles that are born one a quarter of a second, live for three, and go where `place` says at their age.
fn frame(k: u64, place: impl Fn(f64) -> [f64; 3]) -> Frame {
    let time_s = due_s(k, PER_S);
    let id: Vec<u32> =
        (0..1000).filter(|&id| (0.0..3.0).contains(&(time_s - 0.25 * f64::from(id)))).map(|id| 3 * id).collect();
    let ages: Vec<f64> = id.iter().map(|&id| time_s - 0.25 * f64::from(id / 3)).collect();
    let mut columns: Vec<Vec<f64>> = (0..3).map(|axis| ages.iter().map(|&age| place(age)[axis]).collect()).collect();
    columns.push(ages.iter().map(|age| 1150.0 - 50.0 * age).collect());
    columns.push(ages);
    Frame { time_s, id, columns }
}

fn straight(age: f64) -> [f64; 3] {
    [10.0 + 4.0 * age, 60.0 - 7.0 * age, 1.5 * age - 30.0]
}

/// Writes frames, eight to a step.
fn write(path: &Path, header: Header, place: impl Fn(f64) -> [f64; 3]) -> Totals {
    let frames = header.frames;
    let mut writer = Writer::create(path, header).unwrap();
    for k in 0..frames {
        let step = (k / 8 + 1) as u32;
        writer.push(frame(k, &place), step).unwrap();
        if k % 8 == 7 {
            writer.end_step(step).unwrap();
        }
    }
    writer.finish().unwrap()
}

fn recording(place: impl Fn(f64) -> [f64; 3]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.upbake");
    write(&path, header(10.0), place);
    (folder, path)
}

/// The largest unit of each column.
fn units(path: &Path) -> Vec<f64> {
    let mut reader = Reader::open(path).unwrap();
    let chunks: Vec<Chunk> = (0..reader.chunks()).map(|chunk| reader.chunk(chunk).unwrap()).collect();
    (0..5).map(|column| chunks.iter().map(|chunk| chunk.units[column]).fold(0.0, f64::max)).collect()
}

#[test]
fn what_is_read_is_what_was_written_and_twice_the_same_bytes() {
    let (folder, path) = recording(straight);
    let other = folder.path().join("b.upbake");
    let totals = write(&other, header(10.0), straight);
    assert_eq!(fs::read(&path).unwrap(), fs::read(&other).unwrap());
    let mut reader = Reader::open(&path).unwrap();
    assert_eq!((reader.header(), reader.totals()), (&header(10.0), totals));
    // 80 frames and one; a chunk a step; at most twelve particles live at a time.
    assert_eq!((totals.frames, totals.chunks, totals.most), (81, 11, 12));
    let mut k = 0;
    for chunk in 0..reader.chunks() {
        let Chunk { frames, units } = reader.chunk(chunk).unwrap();
        assert_eq!(reader.first_of(chunk), k);
        for own in frames {
            let want = frame(k, straight);
            assert_eq!((own.time_s, &own.id), (want.time_s, &want.id));
            for ((own, want), unit) in own.columns.iter().zip(&want.columns).zip(&units) {
                assert!(own.iter().zip(want).all(|(a, b)| (a - b).abs() <= 0.5001 * unit), "{k}");
            }
            assert_eq!(reader.chunk_of(k), chunk);
            k += 1;
        }
        // 7 m/s for three seconds and what a second of frames adds: a unit is below half a millimetre.
        assert!(units[1] < 5e-4, "{units:?}");
    }
    assert_eq!(k, 81);
}

#[test]
fn straight_ways_are_played_exactly() {
    let (_folder, path) = recording(straight);
    let unit = units(&path);
    for between in [Between::Linear, Between::Hermite] {
        let mut player = Player::open(&path).unwrap();
        player.between = between;
        // Out of order too, and across chunks.
        for time_s in [0.0, 0.01, 9.999, 3.3, 0.99, 1.01, 10.0, 6.25] {
            let particles = player.at(time_s).unwrap();
            let here = frame(frames_by(time_s, PER_S) - 1, straight);
            assert_eq!(particles.iter().map(|p| p.id).collect::<Vec<_>>(), here.id, "who is in the frame before it");
            for particle in particles {
                let age = time_s - 0.25 * f64::from(particle.id / 3);
                // Who is gone by the next frame stands still.
                let gone = due_s(frames_by(time_s, PER_S), PER_S) - 0.25 * f64::from(particle.id / 3) >= 3.0;
                let age = if gone { due_s(frames_by(time_s, PER_S) - 1, PER_S) - time_s + age } else { age };
                let (want, most) = (straight(age), if between == Between::Linear { 0.5001 } else { 0.7 });
                for axis in 0..3 {
                    let off = (particle.at_m[axis] - want[axis]).abs();
                    assert!(off <= most * unit[axis] + 1e-9, "{time_s} {between:?} {particle:?} {want:?}");
                }
                assert!((particle.age_s - age).abs() <= 0.5001 * unit[4] + 1e-9, "{particle:?} {age}");
                let degc = 1150.0 - 50.0 * age;
                assert!((particle.temperature_degc - degc).abs() <= 0.5001 * unit[3] + 1e-9, "{particle:?}");
            }
        }
    }
}

#[test]
fn a_curve_is_cut_by_a_line_and_followed_by_a_cubic() {
    let fall = |age: f64| [50.0, 40.0, -4.9 * age * age];
    let (_folder, path) = recording(fall);
    let unit = units(&path)[2];
    let off = |between: Between| {
        let mut player = Player::open(&path).unwrap();
        player.between = between;
        let time_s = 5.5 / PER_S + 4.0;
        let particles = player.at(time_s).unwrap();
        // With two frames on either side.
        let inner = particles.iter().filter(|p| (0.5..2.5).contains(&p.age_s));
        inner.map(|p| (p.at_m[2] - fall(p.age_s)[2]).abs()).fold(0.0, f64::max)
    };
    // In the middle of a span a chord is off by a·dt²/8; the cubic is exact for parabolas.
    let chord = 9.8 / (8.0 * PER_S * PER_S);
    // The age is off by half a unit too, of 4 s over 65,535, at 25 m/s at most.
    let slack = unit + 25.0 * units(&path)[4];
    assert!((off(Between::Linear) - chord).abs() < slack, "{} {chord}", off(Between::Linear));
    assert!(off(Between::Hermite) < slack, "{}", off(Between::Hermite));
}

#[test]
fn in_a_world_that_wraps_the_way_is_the_shorter_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("w.upbake");
    let header = Header { wraps: true, ..header(10.0) };
    write(&path, header, |age| [(90.0 + 8.0 * age).rem_euclid(100.0), 10.0, 0.0]);
    let mut player = Player::open(&path).unwrap();
    for k in 0..200 {
        for particle in player.at(0.05 * f64::from(k)).unwrap().iter().filter(|p| p.age_s < 2.7) {
            let want = (90.0 + 8.0 * particle.age_s).rem_euclid(100.0);
            let off = (particle.at_m[0] - want + 50.0).rem_euclid(100.0) - 50.0;
            // A unit is 100 m over 65,535, and as much for the age.
            assert!(off.abs() < 0.003 && (0.0..100.0).contains(&particle.at_m[0]), "{particle:?} {want}");
        }
    }
}

#[test]
fn moments_outside_are_refused() {
    let (_folder, path) = recording(straight);
    let mut player = Player::open(&path).unwrap();
    for time_s in [-0.1, 10.1, f64::NAN, f64::INFINITY] {
        let line = player.at(time_s).unwrap_err().to_string();
        assert!(line.contains("it lasts from 0 to 10 s") && !line.contains('\n'), "{line}");
    }
}

/// What is wrong with a file, in one line; `None` if nothing is.
fn damage(path: &Path) -> Option<String> {
    let read =
        Reader::open(path).and_then(|mut reader| (0..reader.chunks()).try_for_each(|c| reader.chunk(c).map(|_| ())));
    read.err().map(|error| error.to_string())
}

#[test]
fn no_byte_can_be_changed_and_none_be_missing() {
    let (_folder, path) = recording(straight);
    let whole = fs::read(&path).unwrap();
    assert_eq!(damage(&path), None);
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        fs::write(&path, &bytes).unwrap();
        let line = damage(&path).unwrap_or_else(|| panic!("byte {at}"));
        assert!(line.contains("a.upbake: ") && !line.contains('\n'), "{at}: {line}");
        if at % 7 == 0 {
            fs::write(&path, &whole[..at]).unwrap();
            let line = damage(&path).unwrap_or_else(|| panic!("{at} bytes"));
            assert!(line.contains("a.upbake: ") && !line.contains('\n'), "{at}: {line}");
        }
    }
    fs::write(&path, [&whole[..], b"x"].concat()).unwrap();
    assert!(damage(&path).unwrap().contains("the end, at byte"));
    // Where: in the second chunk.
    let second = whole.windows(4).enumerate().filter(|(_, mark)| mark == b"CHNK").nth(1).unwrap().0;
    let mut bytes = whole.clone();
    bytes[second + 60] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let want = format!(
        "{}: chunk 2 (frames 8 to 15, at byte {second}): its bytes are not those that were written; bake it anew",
        path.display()
    );
    assert_eq!(damage(&path), Some(want));
    fs::write(&path, &whole[..second + 70]).unwrap();
    let line = damage(&path).unwrap();
    assert!(line.contains(&format!("chunk 2, at byte {second}: it ends after frame 8 of 81; bake it anew")), "{line}");
}

#[test]
fn a_writer_goes_on_behind_a_step_and_ends_with_the_same_bytes() {
    let (folder, path) = recording(straight);
    let whole = fs::read(&path).unwrap();
    let marks: Vec<usize> =
        whole.windows(4).enumerate().filter(|(_, mark)| mark == b"CHNK").map(|(at, _)| at).collect();
    // Killed within the eighth chunk, with a checkpoint from the fifth step.
    let cut = folder.path().join("cut.upbake");
    let left = &whole[..marks[7] + 90];
    fs::write(&cut, left).unwrap();
    let mut writer = Writer::resume(&cut, header(10.0), 5, 40).unwrap();
    for k in 40..81 {
        let step = (k / 8 + 1) as u32;
        writer.push(frame(k, straight), step).unwrap();
        if k % 8 == 7 {
            writer.end_step(step).unwrap();
        }
    }
    writer.finish().unwrap();
    assert_eq!(fs::read(&cut).unwrap(), whole);
    // What is not there cannot be gone on from.
    fs::write(&cut, left).unwrap();
    assert!(Writer::resume(&cut, header(10.0), 9, 72).is_err());
    assert!(Writer::resume(&cut, Header { seed: 8, ..header(10.0) }, 5, 40).is_err());
    assert!(Writer::resume(&folder.path().join("none"), header(10.0), 5, 40).is_err());
}

#[test]
fn a_writer_takes_nothing_that_a_reader_would_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.upbake");
    let begun = || {
        let mut writer = Writer::create(&path, header(10.0)).unwrap();
        (0..60).for_each(|k| writer.push(frame(k, straight), 1).unwrap());
        writer
    };
    let good = frame(60, straight);
    let unsorted = Frame { id: good.id.iter().rev().copied().collect(), ..good.clone() };
    let late = Frame { time_s: good.time_s + 0.01, ..good.clone() };
    let thin = Frame { columns: good.columns[..4].to_vec(), ..good.clone() };
    for bad in [unsorted, late, thin] {
        assert!(begun().push(bad, 2).unwrap_err().to_string().contains("frame 60 is not what the header says"));
    }
    let mut wild = good;
    wild.columns[2][3] = f64::NAN;
    let mut writer = begun();
    let pushed = writer.push(wild, 2).and_then(|()| writer.end_step(2));
    assert!(pushed.unwrap_err().to_string().contains("a particle's value is no number"));
    assert!(begun().finish().is_err_and(|e| e.to_string().contains("60 of 81 frames came")));
    let refused = |header: Header| Writer::create(&path, header).is_err();
    for rate in [0.0, -1.0, 1e6, f64::NAN] {
        assert!(refused(Header { frames_per_s: rate, ..header(10.0) }), "{rate}");
    }
    assert!(refused(Header { frames: 80, ..header(10.0) }) && refused(Header { duration_s: -1.0, ..header(10.0) }));
}

#[test]
fn frames_are_due_at_their_own_times() {
    for per_s in [0.001, 0.3, 1.0, 7.0, 24.0, 29.97, 30.0, 1000.0] {
        assert_eq!(frames_by(0.0, per_s), 1);
        for k in 0..2000u64 {
            let due = due_s(k, per_s);
            assert_eq!(frames_by(due, per_s), k + 1, "{per_s} {k}");
            assert_eq!(frames_by(due + 0.4 / per_s, per_s), k + 1, "{per_s} {k}");
            if k > 0 {
                assert_eq!(frames_by(due - 1e-6, per_s), k, "{per_s} {k}");
            }
        }
    }
}

#[test]
fn an_empty_frame_is_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("e.upbake");
    let mut writer = Writer::create(&path, header(2.0)).unwrap();
    (0..17).for_each(|k| writer.push(Frame::empty(due_s(k, PER_S), 5), 1).unwrap());
    writer.finish().unwrap();
    assert_eq!(Player::open(&path).unwrap().at(1.3).unwrap(), []);
}
