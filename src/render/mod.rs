//! Pictures of a world on the graphics adapter, off-screen (feature `render`).
//!
//! This room owns the adapter and the passes; every pass is one file here and one shader of the same name under
//! `shaders/`. It reads worlds, never changes them, and opens no window.

mod gpu;
mod hillshade;

pub use gpu::Gpu;
pub use hillshade::{Sun, hillshade};

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// No adapter.
    #[error(
        "no graphics adapter was found; install a Vulkan driver (without a graphics card: Mesa's software driver, \
         package mesa-vulkan-drivers on Debian and Ubuntu)"
    )]
    NoAdapter,
    /// The adapter refused the device.
    #[error("the graphics adapter '{adapter}' cannot be used: {cause}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// In the driver's words.
        cause: String,
    },
    /// The world has more cells a side than the adapter's textures.
    #[error("a world of {width} x {height} cells is too large for '{adapter}' (at most {most} a side)")]
    TooLarge {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// The adapter.
        adapter: String,
        /// Its limit.
        most: u32,
    },
    /// A pass failed.
    #[error("the graphics adapter '{adapter}' failed: {cause}")]
    Failed {
        /// The adapter.
        adapter: String,
        /// In the driver's words.
        cause: String,
    },
}
