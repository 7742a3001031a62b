//! What a person does to a world from outside: lay a heightmap of any origin into the bedrock (stage `import`), say how fast
//! rock rises (`uplift`) and how hard it is (`hardness`), and go on with a part of the map at a finer scale (`zoom`).
//!
//! | file | owns |
//! |---|---|
//! | `uplift` `hardness` | the stages of those names |
//! | `region` | rectangles and discs with soft edges |
//! | `zoom` | the stage: which window, and what becomes of layers, tables and books |
//! | `window` | resampling of layers to a window, and detail below the old cells |
//! | `tables` | places and lines that go along with a window |
//! | `inflow` | the rivers that come in over a window's rim |
//! | `import` | the stage: its parameters, and how a file becomes the heights of a map |
//! | `read` | the formats, one file each: a header first, heights only when it is sound |
//! | `sidecar` | what our own export says beside a file |
//! | `fill` | heights where a file has none |
//! | `unstep` | taking the stairs out of heights stored in few bits |
//!
//! A file is judged by its content: what it begins with must agree with its name. Sizes are checked before anything is
//! decoded, so that no file can ask for more memory than a map of the largest size.

mod fill;
mod hardness;
mod import;
mod inflow;
mod read;
mod region;
mod sidecar;
mod tables;
#[cfg(test)]
mod tests;
mod unstep;
mod uplift;
mod window;
mod zoom;

use crate::process::ProcessError;

pub use hardness::HardnessParams;
pub use import::{Endian, ImportParams, NoData, SourceFormat};
pub use read::{Format, Header, Heightmap, MOST_SIDE, Sample};
pub use region::Outline;
pub use uplift::{UpliftChange, UpliftParams, UpliftShape};
pub use zoom::ZoomParams;

/// A file that cannot be imported.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct EditError {
    /// The file, or `sample:NAME`.
    pub file: String,
    /// What is wrong with it.
    pub problem: Problem,
}

impl EditError {
    /// Why a stage stops that has met this while it ran: a broken file fails it, holes that are not wanted were asked about.
    fn into_process(self) -> ProcessError {
        match self.problem {
            Problem::Disk(_) | Problem::Truncated | Problem::Damaged(_) => ProcessError::Failed(self.to_string()),
            _ => ProcessError::Unfit(self.to_string()),
        }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The system cannot read it, or there is no such sample.
    #[error("cannot be read: {0}")]
    Disk(String),
    /// It is empty.
    #[error("the file is empty")]
    Empty,
    /// Neither name nor content is known.
    #[error(
        "no heightmap of a known kind (.png .tif .tiff .exr .r16 .r32 .raw .asc .hgt); \
         set format where the name does not tell it"
    )]
    Unknown,
    /// Name and content contradict each other.
    #[error("{claim} {claimed}, but the content is {found}; rename the file, or set format")]
    Contradiction {
        /// Who claims: the name or the parameter.
        claim: &'static str,
        /// The format claimed.
        claimed: &'static str,
        /// The format found.
        found: &'static str,
    },
    /// It ends too early.
    #[error("the file is cut short")]
    Truncated,
    /// It cannot be decoded.
    #[error("the file is damaged: {0}")]
    Damaged(String),
    /// It is sound, but of a kind that is not read here.
    #[error("{0}")]
    Unsupported(String),
    /// Too many cells.
    #[error("{0} x {1} is too large; at most {MOST_SIDE} a side can be imported")]
    TooLarge(u64, u64),
    /// Too few cells.
    #[error("{0} x {1} is too small for a map; at least 2 a side are needed")]
    TooSmall(u64, u64),
    /// A raw file is of another length than its size says.
    #[error("{0}")]
    Length(String),
    /// No cell has a height.
    #[error("no cell of it holds a height")]
    NoHeights,
    /// Some cells have no height, and that was not wanted.
    #[error("{0} cells have no height, the first at {1}, {2}; no_data = \"fill\" fills them from their neighbours")]
    Holes(usize, usize, usize),
    /// Values that are no heights of any land.
    #[error("heights from {0} to {1} m are none of any land; is the byte order (endian) or the format another?")]
    Absurd(f32, f32),
    /// The two heights of black and white are not in order.
    #[error("low_m = {0} must be below high_m = {1}")]
    Levels(f64, f64),
}
