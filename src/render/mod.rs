//! Pictures of a world on the graphics adapter, off-screen and in windows (feature `render`).
//!
//! This room owns the adapter and the passes. A world becomes [`Land`] once (`ground`, `cover`, `shade` make its rasters on the
//! processor), then [`Renderer`] draws any number of pictures: ground in patches by distance (`terrain`), the block's walls,
//! the sky (`air`), the sea, glow, and the tone curve that makes a picture of light. What a scene looks like is `scene`'s;
//! this room reads worlds and scenes, never changes them, and opens no window.
//!
//! The scene's axes: x east, y north, z up, metres from the middle of the map, heights times their exaggeration.

mod air;
mod camera;
mod cover;
mod drape;
mod fire;
mod frame;
mod glow;
mod gpu;
mod ground;
mod hillshade;
mod land;
mod lumps;
#[cfg(test)]
mod night;
mod overview;
mod passes;
mod path;
mod puff;
mod renderer;
mod rivers;
mod sea;
mod set;
mod shade;
mod shader;
mod shafts;
mod smoke;
mod terrain;
#[cfg(test)]
mod tests;
mod textures;
mod water;
#[cfg(test)]
mod water_tests;

pub use camera::Camera;
pub use frame::{Lights, Moment};
pub use gpu::Gpu;
pub use ground::{Lie, settled};
pub use hillshade::{Sun, hillshade};
pub use land::Land;
pub use lumps::Lump;
pub use path::Path;
pub use renderer::Renderer;

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
    /// A value is not a number.
    #[error("layer '{layer}' is not finite at cell ({x}, {y})")]
    NotFinite {
        /// The layer.
        layer: &'static str,
        /// Column of the cell.
        x: usize,
        /// Row of the cell.
        y: usize,
    },
    /// No adapter draws such a picture.
    #[error("a picture of {width} x {height} pixels cannot be drawn (from 1 to {most} a side)")]
    PictureSize {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Most of a side.
        most: u32,
    },
    /// A picture that the scene names cannot be read.
    #[error("{0}")]
    Picture(String),
    /// A pass failed.
    #[error("the graphics adapter '{adapter}' failed: {cause}")]
    Failed {
        /// The adapter.
        adapter: String,
        /// In the driver's words.
        cause: String,
    },
}
