//! Recordings of particles: frames at an even rate, a file of them, and playback at any moment.
//!
//! A solver hands out [`Frame`]s through a [`Tape`] while it steps; its own steps are not changed by that. A [`Writer`] packs
//! them into a file as they come, a few at a time; a [`Player`] reads them back and says where everyone was between two of
//! them. What the particles are is said by the file's [`Header`], and nothing here knows it.
//!
//! ```text
//! header    "UPBAKE", version (u16), length (u32) and SHA-256 of what follows: JSON, see [`Header`]
//! chunk     "CHNK", first frame, frames, step of the stage, bytes packed, bytes unpacked (5 x u32), SHA-256, a Zstandard frame
//! ...
//! end       "DONE", chunks (u32), frames, places, most in a frame (3 x u64), SHA-256 over the SHA-256s of header and chunks
//! ```
//!
//! All numbers are little-endian. A chunk stands for itself: unpacked it is, a column each, least value and unit (2 x f64), then
//! frame by frame the number of particles n (u32), n differences of their ascending numbers (u32), and, a column each, n low
//! bytes and n high bytes of whole numbers. Those are differences to the frame before in the chunk of the particle of that
//! number (or to 0), folded so that small ones are small: 0, -1, 1, -2 as 0, 1, 2, 3. A value is least + unit * whole number.

mod chunk;
mod glimpse;
mod header;
mod play;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use glimpse::Glimpses;
pub use header::{Column, FORMAT, Header, RATES_PER_S};
pub use play::{Between, Particle, Player};
pub use read::{Chunk, ENDING, Reader};
pub use write::{Totals, Writer};

use std::path::PathBuf;

use crate::world::store::said;

/// Particles at one moment. The columns are those of the header; the first three are the place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Since the stage began, s.
    pub time_s: f64,
    /// Their numbers in the order of birth, ascending.
    pub id: Vec<u32>,
    /// A value a particle in each.
    pub columns: Vec<Vec<f64>>,
}

impl Frame {
    /// A moment without particles.
    pub fn empty(time_s: f64, columns: usize) -> Self {
        Self { time_s, id: Vec::new(), columns: vec![Vec::new(); columns] }
    }
}

/// What takes frames while a solver steps. Frame k is due at k over the rate.
pub trait Tape: Sync {
    /// Frames to a second of the solver's own time.
    fn per_s(&self) -> f64;

    /// Takes the next frame; an error, in one line, ends the run.
    fn take(&self, frame: Frame) -> Result<(), String>;
}

/// What a solver has to be recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// Its columns; the first three are the place.
    pub columns: Vec<Column>,
    /// How long it is followed, s.
    pub duration_s: f64,
    /// Volume of a particle, m³.
    pub volume_m3: f64,
}

/// Steps are counted in floating point, s.
const SLACK_S: f64 = 1e-9;

/// When a frame is due, s.
pub fn due_s(frame: u64, per_s: f64) -> f64 {
    frame as f64 / per_s
}

/// Frames that are due up to and with a moment.
pub fn frames_by(time_s: f64, per_s: f64) -> u64 {
    let mut count = (time_s.max(0.0) * per_s) as u64;
    while due_s(count, per_s) <= time_s + SLACK_S {
        count += 1;
    }
    while count > 0 && due_s(count - 1, per_s) > time_s + SLACK_S {
        count -= 1;
    }
    count
}

/// Why a recording could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The disk refused.
    #[error("{path}: {}", said(.cause))]
    Disk {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// It is no recording, or another version's.
    #[error("{path}: {what}")]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it is.
        what: String,
    },
    /// It is not whole.
    #[error("{path}: {place}: {what}; bake it anew")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where.
        place: String,
        /// What is wrong.
        what: String,
    },
    /// The moment is not in it.
    #[error("{path}: there is no moment {time_s} s: it lasts from 0 to {last_s} s")]
    Outside {
        /// The file.
        path: PathBuf,
        /// The moment asked for.
        time_s: f64,
        /// The last frame's.
        last_s: f64,
    },
    /// What was to be written cannot be.
    #[error("{path}: {what}")]
    Unfit {
        /// The file.
        path: PathBuf,
        /// Why.
        what: String,
    },
}
