//! Checkpoints: all that a stopped run needs to end at the same bits.
//!
//! ```text
//! FOLDER/
//!   latest             the number of the newest whole checkpoint; renamed into place after it is on the disk
//!   000007/            at most two
//!     checkpoint.json  the recipe, where the run is, what its finished stages cost, the process's fields by name and grid
//!     process.bin      the process's fields (f32, little-endian) one after the other, then its blob
//!     world.zarr       the world between two steps
//! ```
//!
//! A kill at any moment leaves the last pointer, and what it points to, whole. This file knows no process.

use std::{
    fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::{
    grid::{Field, Grid},
    process::State,
    recipe::Plan,
    world::{
        World,
        store::{self, Provenance, StoreError, said},
    },
};

use super::StageRecord;

/// Raised when older builds cannot read a checkpoint any more.
const FORMAT: u64 = 2;
/// Checkpoints kept: should the newest not be readable, the one before it is.
const KEPT: usize = 2;
/// A run spends at most a twentieth of its time on checkpoints.
const SPACING: u32 = 20;
/// Seconds between checkpoints, unless one costs more than a twentieth of that.
pub const EVERY: Duration = Duration::from_secs(45);

/// Why a checkpoint could not be kept or taken up.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The disk refused.
    #[error("{path}: cannot keep a checkpoint: {}; what was kept before stands, for --resume", said(.cause))]
    Disk {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// Its world could not be written or read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// It is not whole.
    #[error("{path}: the checkpoint is damaged ({cause}); start anew with --force")]
    Damaged {
        /// The checkpoint.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// Another recipe's, or another version's.
    #[error("{path}: the stopped run there is of {what}; start anew with --force, or choose another --out")]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// What it is of.
        what: String,
    },
}

/// Where a run stands between two steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Position {
    /// Which of the running stages, from 0.
    pub stage: usize,
    /// Steps done in it.
    pub step: u64,
    /// Share of it that is done.
    pub done: f64,
    /// The world's clock when it began.
    pub began_yr: f64,
    /// Seconds spent in it.
    pub seconds: f64,
    /// What the stages before it cost.
    pub records: Vec<StageRecord>,
}

/// A stopped run, read back.
pub struct Checkpoint {
    pub(super) position: Position,
    pub(super) world: World,
    /// What the process of the stage saved; nothing where the stage has not begun.
    pub(super) state: Option<State>,
}

impl Checkpoint {
    /// Which of the running stages, from 0, and the steps done in it.
    pub fn place(&self) -> (usize, u64) {
        (self.position.stage, self.position.step)
    }

    /// Share of that stage that is done.
    pub fn done(&self) -> f64 {
        self.position.done
    }

    /// The world's clock when that stage began, years.
    pub fn began_yr(&self) -> f64 {
        // A stage that has not begun begins now.
        if self.position.step == 0 { self.world.time_yr } else { self.position.began_yr }
    }

    /// The world's clock, years.
    pub fn time_yr(&self) -> f64 {
        self.world.time_yr
    }
}

#[derive(Serialize, Deserialize)]
struct Head {
    format: u64,
    version: String,
    recipe: String,
    position: Position,
    state: Option<StateHead>,
}

#[derive(Serialize, Deserialize)]
struct StateHead {
    fields: Vec<FieldHead>,
    blob: usize,
    sha256: String,
}

#[derive(Serialize, Deserialize)]
struct FieldHead {
    name: String,
    grid: Grid,
}

/// The checkpoints of one run.
pub struct Checkpoints {
    folder: PathBuf,
    recipe: String,
    number: u64,
    every: Duration,
    /// When the last one was written, or the run began, and what it cost.
    last: (Instant, Duration),
    written: bool,
}

impl Checkpoints {
    /// Keeps the checkpoints of a plan in a folder, one every `every` (see [`EVERY`]); zero keeps one after each step.
    pub fn new(folder: &Path, plan: &Plan, every: Duration) -> Self {
        let number = newest(folder).unwrap_or(0);
        let last = (Instant::now(), Duration::ZERO);
        Self { folder: folder.to_owned(), recipe: plan.text.clone(), number, every, last, written: number > 0 }
    }

    /// Whether there is one.
    pub fn any(&self) -> bool {
        self.written
    }

    /// The newest that is whole; an error where none of those that are there can be taken up.
    pub fn latest(&self) -> Result<Option<Checkpoint>, CheckpointError> {
        let Some(newest) = newest(&self.folder) else { return Ok(None) };
        let first = match self.read(newest) {
            Err(error @ (CheckpointError::Damaged { .. } | CheckpointError::Store(_))) => error,
            other => return other.map(Some),
        };
        match newest.checked_sub(1).map(|number| self.read(number)) {
            Some(Ok(older)) => Ok(Some(older)),
            _ => Err(first),
        }
    }

    pub(super) fn due(&self) -> bool {
        self.every.is_zero() || self.last.0.elapsed() >= self.every.max(self.last.1 * SPACING)
    }

    /// Writes a checkpoint, points to it, and removes those that are no longer needed.
    pub(super) fn save(
        &mut self,
        world: &World,
        position: &Position,
        state: Option<&State>,
    ) -> Result<(), CheckpointError> {
        let began = Instant::now();
        let number = self.number + 1;
        let path = self.path(number);
        let disk = |cause| CheckpointError::Disk { path: path.clone(), cause };
        remove(&path).map_err(disk)?;
        fs::create_dir_all(&path).map_err(disk)?;
        store::write(world, &Provenance::default(), &path.join("world.zarr"))?;
        let state = pack(state, &path.join("process.bin")).map_err(disk)?;
        let head = Head {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            recipe: self.recipe.clone(),
            position: position.clone(),
            state,
        };
        let head = serde_json::to_vec_pretty(&head).map_err(|e| disk(e.into()))?;
        fs::write(path.join("checkpoint.json"), head).map_err(disk)?;
        flush(&path).map_err(disk)?;
        self.point_to(number).map_err(disk)?;
        self.number = number;
        self.written = true;
        self.tidy();
        self.last = (Instant::now(), began.elapsed());
        Ok(())
    }

    fn path(&self, number: u64) -> PathBuf {
        self.folder.join(format!("{number:06}"))
    }

    fn point_to(&self, number: u64) -> io::Result<()> {
        let beside = self.folder.join("latest.partial");
        fs::write(&beside, number.to_string())?;
        flush(&beside)?;
        fs::rename(&beside, self.folder.join("latest"))?;
        flush_entries(&self.folder)
    }

    /// Removes all but the last; one that cannot be removed only takes room.
    fn tidy(&self) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let numbers = entries.flatten().filter_map(|entry| entry.file_name().to_string_lossy().parse::<u64>().ok());
        for number in numbers.filter(|number| number + KEPT as u64 <= self.number) {
            let _ = remove(&self.path(number));
        }
    }

    fn read(&self, number: u64) -> Result<Checkpoint, CheckpointError> {
        let path = self.path(number);
        let damaged = |cause: String| CheckpointError::Damaged { path: path.clone(), cause };
        let text = fs::read(path.join("checkpoint.json")).map_err(|e| damaged(e.to_string()))?;
        let head: Head = serde_json::from_slice(&text).map_err(|e| damaged(e.to_string()))?;
        let foreign = |what: String| CheckpointError::Foreign { path: self.folder.clone(), what };
        if head.format != FORMAT || head.version != env!("CARGO_PKG_VERSION") {
            return Err(foreign(format!("upthrust {}", head.version)));
        }
        if head.recipe != self.recipe {
            return Err(foreign("another recipe".to_owned()));
        }
        let bytes = fs::read(path.join("process.bin")).map_err(|e| damaged(e.to_string()))?;
        let state = head.state.map(|head| unpack(&head, &bytes).map_err(damaged)).transpose()?;
        let (world, _) = store::read(&path.join("world.zarr"))?;
        Ok(Checkpoint { position: head.position, world, state })
    }
}

/// The number that the pointer names.
fn newest(folder: &Path) -> Option<u64> {
    fs::read_to_string(folder.join("latest")).ok()?.trim().parse().ok()
}

/// Writes a process's state, a run of values at a time: all its bytes at once would be a second copy of it.
fn pack(state: Option<&State>, path: &Path) -> io::Result<Option<StateHead>> {
    const RUN: usize = 1 << 16;
    let mut file = io::BufWriter::new(fs::File::create(path)?);
    let Some(State { fields, blob }) = state else { return file.flush().map(|()| None) };
    let (mut sum, mut bytes) = (Sha256::new(), Vec::with_capacity(4 * RUN));
    for values in fields.iter().flat_map(|(_, field)| field.data.chunks(RUN)) {
        bytes.clear();
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        sum.update(&bytes);
        file.write_all(&bytes)?;
    }
    sum.update(blob);
    file.write_all(blob)?;
    file.flush()?;
    let fields = fields.iter().map(|(name, field)| FieldHead { name: name.clone(), grid: field.grid }).collect();
    Ok(Some(StateHead { fields, blob: blob.len(), sha256: hex(&sum.finalize()) }))
}

fn unpack(head: &StateHead, bytes: &[u8]) -> Result<State, String> {
    if hex(&Sha256::digest(bytes)) != head.sha256 {
        return Err("process.bin has other bytes than were written".to_owned());
    }
    let mut rest = bytes;
    let mut fields = Vec::new();
    for FieldHead { name, grid } in &head.fields {
        let length = grid.width.checked_mul(grid.height).and_then(|cells| cells.checked_mul(4));
        let (mine, others) = length.and_then(|n| rest.split_at_checked(n)).ok_or("process.bin is too short")?;
        let data = mine.as_chunks::<4>().0.iter().map(|&word| f32::from_le_bytes(word)).collect();
        fields.push((name.clone(), Field { grid: *grid, data }));
        rest = others;
    }
    if rest.len() != head.blob {
        return Err("process.bin has another length than was written".to_owned());
    }
    Ok(State { fields, blob: rest.to_vec() })
}

fn hex(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn remove(folder: &Path) -> io::Result<()> {
    match fs::remove_dir_all(folder) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

/// Sends a file, or a folder and all in it, to the disk itself.
fn flush(path: &Path) -> io::Result<()> {
    if !path.is_dir() {
        return fs::OpenOptions::new().write(true).open(path)?.sync_all();
    }
    for entry in fs::read_dir(path)? {
        flush(&entry?.path())?;
    }
    flush_entries(path)
}

/// Sends a folder's list of names to the disk; only Unix systems let one ask for it.
fn flush_entries(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { fs::File::open(folder)?.sync_all() } else { Ok(()) }
}
