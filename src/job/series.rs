//! `series.csv` and `profiles.csv`: what a run did in time, as numbers.
//!
//! ```text
//! series.csv     a row a step: mean height, relief, rates of erosion and of sediment
//! profiles.csv   the largest rivers from mouth to divide, a few times in each stage that carves
//! ```
//!
//! Rows are noted in a file beside the growing world, each with its place in the run, so that a resumed run goes on with those
//! that lie before its checkpoint and ends with the same file.

use std::{
    fs,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{JobError, keep};
use crate::{
    measure::{Glance, main_stems},
    timeline::{Interest, Moment, Sink},
    world::{Layer, World},
};

/// The series' name in a world's folder.
pub const SERIES: &str = "series.csv";
/// The profiles' name in a world's folder.
pub const PROFILES: &str = "profiles.csv";

const SERIES_HEAD: &str =
    "time_yr,stage,mean_height_m,relief_m,erosion_rate_mm_per_yr,sediment_flux_m3_per_yr,land_share";
const PROFILES_HEAD: &str = "time_yr,stage,river,distance_km,height_m,area_km2,discharge_m3_s";
/// Rows a stage has at most, where it takes more steps.
const ROWS: f64 = 500.0;
/// Moments in a stage at which profiles are taken, where no timeline is kept.
const PROFILED: f64 = 10.0;
/// Rivers that have a profile.
const RIVERS: usize = 5;

/// A note of one moment.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Note {
    stage: usize,
    step: u64,
    /// Floating-point numbers as bits: what is read back is what was written.
    done: u64,
    sums: Vec<u64>,
    /// Rows of the finished file.
    rows: String,
}

/// Notes on the disk.
struct Notes {
    path: PathBuf,
    file: fs::File,
    rows: Vec<String>,
    last: Option<Note>,
}

impl Notes {
    /// Goes on behind those at or before a place of a stopped run; without one from the start.
    fn begin(path: &Path, from: Option<(usize, u64)>) -> Result<Self, JobError> {
        let disk = |cause| JobError::Disk { path: path.to_owned(), cause };
        let mut kept: Vec<Note> = Vec::new();
        if let (Some(from), Ok(file)) = (from, fs::File::open(path)) {
            // A line cut short by a kill ends what is whole.
            let notes = BufReader::new(file).lines().map_while(|line| serde_json::from_str(&line.ok()?).ok());
            kept.extend(notes.take_while(|note: &Note| (note.stage, note.step) <= from));
        }
        let beside = path.with_extension("partial");
        let mut file = fs::File::create(&beside).map_err(disk)?;
        for note in &kept {
            file.write_all(&line(note)).map_err(disk)?;
        }
        fs::rename(&beside, path).map_err(disk)?;
        let last = kept.last().cloned();
        Ok(Self { path: path.to_owned(), file, rows: kept.into_iter().map(|note| note.rows).collect(), last })
    }

    /// Whether a moment lies in another part of its stage than the last note, the stage being cut into `parts`.
    fn due(&self, moment: &Moment, parts: f64) -> bool {
        // Steps are counted in floating point.
        let part = |done: f64| (done * parts + 1e-9).floor();
        let before = match &self.last {
            Some(note) if note.stage == moment.stage => part(f64::from_bits(note.done)),
            _ => 0.0,
        };
        moment.stage_over() || part(moment.done) > before
    }

    fn add(&mut self, moment: &Moment, sums: &[f64], rows: String) -> Result<(), String> {
        let sums = sums.iter().map(|v| v.to_bits()).collect();
        let note = Note { stage: moment.stage, step: moment.step, done: moment.done.to_bits(), sums, rows };
        self.file.write_all(&line(&note)).map_err(|e| format!("{}: {e}", self.path.display()))?;
        self.rows.push(note.rows.clone());
        self.last = Some(note);
        Ok(())
    }

    /// Writes the finished file; none where there is no row.
    fn finish(self, head: &str, file: &Path) -> Result<bool, JobError> {
        if self.rows.iter().all(String::is_empty) {
            return Ok(false);
        }
        let text = format!("{head}\n{}", self.rows.concat());
        fs::write(file, text).map_err(|cause| JobError::Disk { path: file.to_owned(), cause })?;
        Ok(true)
    }
}

fn line(note: &Note) -> Vec<u8> {
    // Whole numbers and text: there is nothing in it that JSON cannot say.
    let mut line = serde_json::to_vec(note).unwrap_or_default();
    line.push(b'\n');
    line
}

/// A column that may be empty.
fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:.digits$}"))
}

/// A stage's name as a CSV field: ids are plain words, kinds too.
fn stage(moment: &Moment) -> String {
    moment.label.to_owned()
}

/// Takes a row of `series.csv` after each step that leaves the world up to date.
pub(crate) struct SeriesSink {
    notes: Notes,
    last: Option<Glance>,
}

impl SeriesSink {
    /// Notes beside the growing world.
    pub fn begin(beside: &Path, from: Option<(usize, u64)>) -> Result<Self, JobError> {
        let notes = Notes::begin(&beside.join("series.notes"), from)?;
        let last = notes.last.as_ref().and_then(|note| unpack(&note.sums));
        Ok(Self { notes, last })
    }

    /// Writes `series.csv` into the world's folder.
    pub fn finish(self, folder: &Path) -> Result<bool, JobError> {
        self.notes.finish(SERIES_HEAD, &folder.join(SERIES))
    }
}

fn pack(glance: &Glance) -> [f64; 7] {
    let worn_m3 = glance.worn_m3.unwrap_or(f64::NAN);
    let Glance { time_yr, land_m2, map_m2, mean_height_m, relief_m, laid_on_land_m3, .. } = *glance;
    [time_yr, land_m2, map_m2, mean_height_m, relief_m, worn_m3, laid_on_land_m3]
}

fn unpack(sums: &[u64]) -> Option<Glance> {
    let &[time_yr, land_m2, map_m2, mean_height_m, relief_m, worn_m3, laid_on_land_m3] = sums else { return None };
    let [time_yr, land_m2, map_m2, mean_height_m, relief_m, worn_m3, laid_on_land_m3] =
        [time_yr, land_m2, map_m2, mean_height_m, relief_m, worn_m3, laid_on_land_m3].map(f64::from_bits);
    let worn_m3 = Some(worn_m3).filter(|v| !v.is_nan());
    Some(Glance { time_yr, land_m2, map_m2, mean_height_m, relief_m, worn_m3, laid_on_land_m3 })
}

impl Sink for SeriesSink {
    fn wants(&mut self, moment: &Moment) -> Interest {
        Interest::Passing.when(self.notes.due(moment, ROWS))
    }

    fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String> {
        let glance = Glance::of(world);
        let rates = self.last.as_ref().and_then(|last| glance.since(last));
        let land = Some(&glance).filter(|glance| glance.land_m2 > 0.0);
        let row = [
            cell(Some(moment.time_yr), 3),
            stage(moment),
            cell(land.map(|glance| glance.mean_height_m), 3),
            cell(land.map(|glance| glance.relief_m), 3),
            cell(rates.map(|rates| rates.erosion_mm_per_yr), 6),
            cell(rates.map(|rates| rates.sediment_m3_per_yr), 1),
            cell(Some(glance.land_share()), 6),
        ];
        self.notes.add(moment, &pack(&glance), row.join(",") + "\n")?;
        self.last = Some(glance);
        Ok(())
    }
}

/// Takes the long profiles of the largest rivers, once streams have carved.
pub(crate) struct ProfileSink {
    notes: Notes,
    /// Whether a timeline is kept, whose frames then have their profiles.
    with_frames: bool,
}

impl ProfileSink {
    /// Notes beside the growing world.
    pub fn begin(beside: &Path, from: Option<(usize, u64)>, with_frames: bool) -> Result<Self, JobError> {
        Ok(Self { notes: Notes::begin(&beside.join("profiles.notes"), from)?, with_frames })
    }

    /// Writes `profiles.csv` into the world's folder, if there is any.
    pub fn finish(self, folder: &Path) -> Result<bool, JobError> {
        self.notes.finish(PROFILES_HEAD, &folder.join(PROFILES))
    }
}

impl Sink for ProfileSink {
    fn wants(&mut self, moment: &Moment) -> Interest {
        if !self.with_frames {
            return Interest::Passing.when(self.notes.due(moment, PROFILED));
        }
        // When frames are kept, profiles are too.
        let overall = |note: &Note| (note.stage as f64 + f64::from_bits(note.done)) / moment.stages as f64;
        let next = self.notes.last.as_ref().map_or(0.0, |note| keep::after(overall(note)));
        Interest::Passing.when(moment.stage_over() || moment.overall() >= next)
    }

    fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String> {
        let mut rows = String::new();
        let carved = world.layer(Layer::Wear).is_some();
        let stems = if carved { main_stems(world, RIVERS) } else { Vec::new() };
        for (river, stem) in stems.iter().enumerate() {
            for point in stem {
                let row = [
                    cell(Some(moment.time_yr), 3),
                    stage(moment),
                    (river + 1).to_string(),
                    cell(Some(point.distance_m * 1e-3), 4),
                    cell(Some(point.height_m), 3),
                    cell(Some(point.area_m2 * 1e-6), 4),
                    cell(Some(point.discharge_m3_s), 4),
                ];
                rows += &row.join(",");
                rows.push('\n');
            }
        }
        self.notes.add(moment, &[], rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Field, Grid};

    /// A ramp that streams lower by a millimetre a year.
    fn world(years: u64) -> World {
        let grid = Grid::new(24, 24, 24e3, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.time_yr = years as f64;
        let worn_m = years as f32 * 1e-3;
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| 100.0 + 5.0 * x as f32 + 0.3 * y as f32 - worn_m));
        world.set_layer(Layer::Wear, Field::filled(grid, worn_m));
        world
    }

    fn moment(step: u64) -> Moment<'static> {
        Moment { stage: 1, stages: 2, label: "rivers", step, done: step as f64 / 40.0, time_yr: 1000.0 * step as f64 }
    }

    /// Shows the steps to both sinks and lets them write, if they are to.
    fn look_on(beside: &Path, steps: std::ops::RangeInclusive<u64>, out: Option<&Path>) {
        let from = steps.start().checked_sub(1).filter(|&step| step > 0).map(|step| (1, step));
        let mut series = SeriesSink::begin(beside, from).unwrap();
        let mut profiles = ProfileSink::begin(beside, from, false).unwrap();
        for step in steps {
            for sink in [&mut series as &mut dyn Sink, &mut profiles] {
                if sink.wants(&moment(step)) > Interest::None {
                    sink.take(&world(1000 * step), &moment(step)).unwrap();
                }
            }
        }
        if let Some(out) = out {
            assert!(series.finish(out).unwrap() && profiles.finish(out).unwrap());
        }
    }

    #[test]
    fn a_resumed_run_writes_what_an_unbroken_one_does() {
        let [whole, broken] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        look_on(whole.path(), 1..=40, Some(whole.path()));
        // Stopped at step 23, with a checkpoint from step 17; the last note cut short.
        look_on(broken.path(), 1..=23, None);
        let notes = broken.path().join("series.notes");
        let text = fs::read_to_string(&notes).unwrap();
        fs::write(&notes, &text[..text.len() - 9]).unwrap();
        look_on(broken.path(), 18..=40, Some(broken.path()));
        let read = |folder: &Path, file: &str| fs::read_to_string(folder.join(file)).unwrap();
        for file in [SERIES, PROFILES] {
            assert_eq!(read(whole.path(), file), read(broken.path(), file), "{file}");
        }
        let series = read(whole.path(), SERIES);
        let rows: Vec<&str> = series.lines().collect();
        assert_eq!((rows.len(), rows[0]), (41, SERIES_HEAD));
        // The land's mean is 100 + 57.5 + 3.45 m less two metres; a millimetre a year leaves 576 km2.
        assert_eq!(rows[2], "2000.000,rivers,158.950,121.900,1.000000,576000.0,1.000000");
        let profiles = read(whole.path(), PROFILES);
        let times: std::collections::BTreeSet<&str> =
            profiles.lines().skip(1).filter_map(|row| row.split(',').next()).collect();
        assert_eq!(times.len(), 10, "{times:?}");
    }

    #[test]
    fn long_stages_have_no_more_rows_than_can_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let mut sink = SeriesSink::begin(folder.path(), None).unwrap();
        let mut rows = 0;
        for step in 1..=20_000u64 {
            let moment = Moment { done: step as f64 / 20_000.0, ..moment(step) };
            if sink.wants(&moment) > Interest::None {
                sink.take(&World::new(Grid::new(1, 1, 1.0, Edges::Open), 0.0), &moment).unwrap();
                rows += 1;
            }
        }
        assert_eq!(rows, 500);
    }
}
