//! Recordings of particles: made while a world grows, looked at, and exported moment by moment.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::Mutex,
};

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::JobError;
use crate::{
    bake::{self, BakeError, ENDING, Frame, Header, Reader, Tape, Totals, Writer},
    grid::Edges,
    recipe::{Plan, Stage},
    timeline::{Checkpoint, Moment, Recorder},
};

/// Frames to a second of a stage's time, where nobody says otherwise.
pub const BAKE_PER_S: f64 = 30.0;
/// Frames that a recording may have: nobody has the disk for more.
const MOST_FRAMES: u64 = 1_000_000;

/// The recordings that a run will make, checked before it begins.
pub(crate) struct BakePlan {
    /// A stage among those that run, the file's name, and the header.
    stages: Vec<(usize, String, Header)>,
}

impl BakePlan {
    /// All stages with particles, so many frames to a second of their time.
    pub fn new(plan: &Plan, until: Option<usize>, per_s: f64) -> Result<Self, JobError> {
        let grids = plan.grids();
        let running = plan.running().enumerate().filter(|(_, (place, _))| until.is_none_or(|end| *place <= end));
        let mut stages = Vec::new();
        for (index, (_, stage)) in running {
            // A stage with particles leaves the map as it is.
            let grid = &grids[index];
            let process = stage.build().map_err(|e| JobError::Refused(e.to_string()))?;
            let Some(subject) = process.subject(grid) else { continue };
            let header = Header {
                program: concat!("upthrust ", env!("CARGO_PKG_VERSION")).to_owned(),
                recipe: plan.name.clone(),
                recipe_sha256: hash(&plan.text),
                seed: plan.world.seed,
                stage: stage.label.clone(),
                kind: stage.kind.kind.to_owned(),
                parameters: stage.params.clone(),
                extent_m: grid.extent_m(),
                wraps: grid.edges == Edges::Wrap,
                radius_m: libm::cbrt(subject.volume_m3 * 0.75 / std::f64::consts::PI),
                columns: subject.columns,
                frames_per_s: per_s,
                frames: bake::frames_by(subject.duration_s, per_s),
                duration_s: subject.duration_s,
            };
            if header.frames > MOST_FRAMES {
                let (frames, name) = (header.frames, &stage.label);
                return Err(JobError::Refused(format!(
                    "--bake-rate {per_s}: stage '{name}' lasts {} s, which makes {frames} frames, {MOST_FRAMES} at most",
                    subject.duration_s
                )));
            }
            stages.push((index, file_name(stage), header));
        }
        if stages.is_empty() {
            return Err(JobError::Refused(format!(
                "--bake: no stage that runs has particles to record ('lava' and 'rain_particles' have); this recipe has: {}",
                plan.stage_names()
            )));
        }
        Ok(Self { stages })
    }

    /// Refuses a finished world that was not baked.
    pub fn stands_in(&self, folder: &Path) -> Result<(), JobError> {
        let lacks = |(_, file, header): &(usize, String, Header)| finished(&folder.join(file), header).is_err();
        if self.stages.iter().any(lacks) {
            let shown = folder.display();
            return Err(JobError::Refused(format!(
                "{shown}: the world there is finished and was not baked so; --force grows and bakes it anew"
            )));
        }
        Ok(())
    }

    /// Begins, in a folder of its own; a resumed run goes on with what the stopped one has left there.
    pub fn begin(self, folder: &Path, from: Option<&Checkpoint>) -> Result<Bakes, JobError> {
        let disk = |cause| JobError::Disk { path: folder.to_owned(), cause };
        if from.is_none() && folder.is_dir() {
            fs::remove_dir_all(folder).map_err(disk)?;
        }
        fs::create_dir_all(folder).map_err(disk)?;
        let mut stages = Vec::new();
        for (index, file, header) in self.stages {
            let (path, per_s) = (folder.join(&file), header.frames_per_s);
            let place = from.map_or((0, 0), Checkpoint::place);
            let writer = match from {
                Some(_) if index < place.0 => finished(&path, &header).map(|()| None),
                Some(from) if index == place.0 && place.1 > 0 => {
                    let due = bake::frames_by(header.duration_s * from.done(), header.frames_per_s);
                    Writer::resume(&path, header, step(place.1), due).map(Some)
                }
                _ => Ok(Some(Writer::create(&path, header)?)),
            };
            let writer = writer.map_err(|_| {
                JobError::Refused(
                    "--bake: the stopped run was not baked, or at another rate; go on as it was begun, or start anew with \
                     --force"
                        .to_owned(),
                )
            })?;
            let done = if index == place.0 { step(place.1) } else { 0 };
            stages.push(Bake { index, per_s, path, writer: Mutex::new((writer, done)) });
        }
        Ok(Bakes { stages })
    }
}

/// Steps as a recording counts them; nobody takes more.
fn step(step: u64) -> u32 {
    u32::try_from(step).unwrap_or(u32::MAX)
}

/// Whether this is the whole recording that the run would have made.
fn finished(path: &Path, header: &Header) -> Result<(), BakeError> {
    let reader = Reader::open(path)?;
    if reader.header() == header {
        return Ok(());
    }
    Err(BakeError::Unfit { path: path.to_owned(), what: "it was baked otherwise".to_owned() })
}

/// The name of a stage's recording.
fn file_name(stage: &Stage) -> String {
    format!("{}.{ENDING}", stage.label.replace('#', "-"))
}

fn hash(text: &str) -> String {
    Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A stage's recording being made: its writer, and the steps that are done.
struct Bake {
    index: usize,
    per_s: f64,
    path: PathBuf,
    writer: Mutex<(Option<Writer>, u32)>,
}

/// Recordings being made.
pub(crate) struct Bakes {
    stages: Vec<Bake>,
}

impl Bake {
    fn with<T>(&self, act: impl FnOnce(&mut Option<Writer>, &mut u32) -> Result<T, BakeError>) -> Result<T, String> {
        // A thread that panicked here has ended the run.
        let mut held = self.writer.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (writer, done) = &mut *held;
        act(writer, done).map_err(|e| e.to_string())
    }
}

impl Tape for Bake {
    fn per_s(&self) -> f64 {
        self.per_s
    }

    fn take(&self, frame: Frame) -> Result<(), String> {
        self.with(|writer, done| writer.as_mut().map_or(Ok(()), |writer| writer.push(frame, *done + 1)))
    }
}

impl Recorder for Bakes {
    fn tape(&self, stage: usize) -> Option<&dyn Tape> {
        self.stages.iter().find(|bake| bake.index == stage).map(|bake| bake as &dyn Tape)
    }

    fn step(&self, moment: &Moment) -> Result<(), String> {
        let Some(bake) = self.stages.iter().find(|bake| bake.index == moment.stage) else { return Ok(()) };
        bake.with(|writer, done| {
            *done = step(moment.step);
            if let Some(writer) = writer {
                writer.end_step(*done)?;
            }
            match writer.take_if(|_| moment.stage_over()) {
                Some(writer) => writer.finish().map(|_| ()),
                None => Ok(()),
            }
        })
    }
}

impl Bakes {
    /// Moves the recordings, which are whole once the run is over, into the world's folder.
    pub fn finish(self, folder: &Path) -> Result<Vec<String>, JobError> {
        let mut files = Vec::new();
        for bake in self.stages {
            let name = bake.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let to = folder.join(&name);
            fs::rename(&bake.path, &to).map_err(|cause| JobError::Disk { path: to, cause })?;
            files.push(name);
        }
        Ok(files)
    }
}

/// Whether a file is a recording, or calls itself one.
pub fn is_recording(path: &Path) -> bool {
    path.is_file() && path.extension().is_some_and(|end| end == ENDING)
}

/// What there is to say of a recording whose every byte was looked at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspected {
    /// What it says of itself.
    pub header: Header,
    /// Chunks.
    pub chunks: u32,
    /// Particles that were ever seen.
    pub particles: u64,
    /// Most particles of a frame.
    pub most: u64,
    /// Places: a particle in a frame.
    pub places: u64,
    /// The file's bytes.
    pub bytes: u64,
    /// Most that a coordinate is off because it is a whole number of units, m.
    pub off_m: f64,
}

/// Reads all of a recording; an error says where it is damaged.
pub fn inspect_recording(path: &Path) -> Result<Inspected, JobError> {
    let mut reader = Reader::open(path)?;
    let bytes = fs::metadata(path).map_err(|cause| JobError::Disk { path: path.to_owned(), cause })?.len();
    let (mut ids, mut off_m) = (BTreeSet::new(), 0.0f64);
    for chunk in 0..reader.chunks() {
        let chunk = reader.chunk(chunk)?;
        ids.extend(chunk.frames.iter().flat_map(|frame| &frame.id).copied());
        off_m = chunk.units[..3].iter().fold(off_m, |most, unit| most.max(0.5 * unit));
    }
    let Totals { chunks, places, most, .. } = reader.totals();
    Ok(Inspected { header: reader.header().clone(), chunks, particles: ids.len() as u64, most, places, bytes, off_m })
}

impl Inspected {
    /// For people.
    pub fn text(&self) -> String {
        let h = &self.header;
        let columns: Vec<String> =
            h.columns.iter().map(|column| format!("{} ({})", column.name, column.unit)).collect();
        let [width, height] = h.extent_m.map(|m| 1e-3 * m);
        let per_place = self.bytes as f64 / self.places.max(1) as f64;
        let rows = [
            ("recording of", format!("stage '{}' ({}) of '{}', seed {}", h.stage, h.kind, h.recipe, h.seed)),
            ("written by", h.program.clone()),
            ("recipe", format!("SHA-256 {}", h.recipe_sha256)),
            ("map", format!("{width} km by {height} km")),
            ("frames", format!("{}, {} a second, from 0 to {} s", h.frames, h.frames_per_s, h.last_s())),
            (
                "particles",
                format!("{}, at most {} in a frame, of radius {:.4} m", self.particles, self.most, h.radius_m),
            ),
            ("columns", columns.join(", ")),
            ("places are off", format!("at most {:.4} m", self.off_m)),
            (
                "size",
                format!(
                    "{:.1} MB, {per_place:.2} bytes a particle and frame, {} chunks",
                    1e-6 * self.bytes as f64,
                    self.chunks
                ),
            ),
            ("hashes", "all right".to_owned()),
        ];
        rows.iter().map(|(name, text)| format!("{name:15} {text}")).collect::<Vec<_>>().join("\n")
    }

    /// For programs.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}
