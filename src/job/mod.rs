//! From a recipe to files: runs a timeline and writes what it grew, whole or not at all.
//!
//! Used by the command line and the application alike, on whatever thread they like. It prints nothing and reads no
//! arguments.

mod bake;
mod estimate;
mod export;
pub mod film;
mod folder;
mod grow;
mod keep;
mod manifest;
mod picture;
mod report;
mod scene;
mod series;
mod sheet;

pub use bake::{BAKE_PER_S, Inspected, inspect_recording, is_recording};
pub use estimate::{Estimate, estimate};
pub use export::{ExportRequest, Exported, export};
pub use folder::Existing;
pub use grow::{Grown, Request, grow};
pub use manifest::Manifest;
pub use picture::{Picture, open_world, render};
pub use report::Measured;
pub use scene::{CameraChoice, SceneRequest, TIMES_H};
pub use series::{PROFILES, SERIES};
pub use sheet::{MOST as SHEET_MOST, SheetRequest, sheet};

use std::path::{Path, PathBuf};

use crate::{
    bake::BakeError,
    export::ExportError,
    recipe::RecipeError,
    relief::ReliefError,
    timeline::{CheckpointError, Moment, TimelineError},
    world::store::{StoreError, said},
};

/// The store's name in a world's folder.
pub const STORE: &str = "world.zarr";
/// The heightmap's name in a world's folder.
pub const HEIGHT: &str = "height.png";
/// The map's name in a world's folder.
pub const RELIEF: &str = "relief.png";
/// The manifest's name in a world's folder.
pub const MANIFEST: &str = "manifest.json";

/// What a job tells while it works.
#[derive(Debug)]
pub enum Event<'a> {
    /// A step is done.
    Step(&'a Moment<'a>),
    /// There was no stopped run to go on with.
    Anew,
    /// A stopped run goes on.
    Resumed {
        /// The world's clock, years.
        time_yr: f64,
        /// Whether a film begins there.
        filmed: bool,
    },
    /// One of several worlds is done.
    World {
        /// Worlds done.
        done: usize,
        /// Worlds asked for.
        of: usize,
    },
    /// A file is being written.
    Writing(&'a str),
}

/// Why a job ended early.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// The recipe is wrong.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The request cannot be done as it was made; nothing was begun.
    #[error("{0}")]
    Refused(String),
    /// The run stopped.
    #[error(transparent)]
    Timeline(#[from] TimelineError),
    /// The user stopped it, and it can go on.
    #[error("stopped; the same command with --resume goes on from here")]
    Stopped,
    /// The world could not be stored or read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The heightmap could not be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The map could not be drawn.
    #[error(transparent)]
    Relief(#[from] ReliefError),
    /// The scene could not be drawn.
    #[cfg(feature = "render")]
    #[error(transparent)]
    Render(#[from] crate::render::RenderError),
    /// A recording could not be written or read.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// A file could not be written.
    #[error("{path}: {}", said(.cause))]
    Disk {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
}

impl JobError {
    /// The same of a film that was made in one folder and would have been in another.
    pub(crate) fn moved(self, from: &Path, to: &Path) -> Self {
        match self {
            JobError::Export(ExportError::Film { path, cause }) => {
                let path = path.strip_prefix(from).map(|inner| to.join(inner)).unwrap_or(path);
                JobError::Export(ExportError::Film { path, cause })
            }
            other => other,
        }
    }

    /// Whether the user stopped it.
    pub fn cancelled(&self) -> bool {
        matches!(self, JobError::Timeline(TimelineError::Cancelled) | JobError::Stopped)
    }

    /// Whether the request was wrong, rather than the run.
    pub fn refused(&self) -> bool {
        match self {
            JobError::Recipe(_) | JobError::Refused(_) => true,
            JobError::Timeline(TimelineError::Past(_) | TimelineError::Process { unfit: true, .. }) => true,
            JobError::Timeline(TimelineError::Checkpoint(error)) => matches!(error, CheckpointError::Foreign { .. }),
            JobError::Export(ExportError::FilmRequest(_)) => true,
            JobError::Store(error) => matches!(error, StoreError::Absent(_)),
            #[cfg(feature = "render")]
            JobError::Render(error) => matches!(error, crate::render::RenderError::PictureSize { .. }),
            JobError::Bake(error) => matches!(error, BakeError::Foreign { .. } | BakeError::Outside { .. }),
            _ => false,
        }
    }
}
