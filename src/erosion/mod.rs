//! What wears land away, and what is laid down elsewhere: streams and hillslopes over geologic time, and on a finer scale
//! slides, storm water and droplets.
//!
//! `stream_power` and `hillslope` work in `f64` on plain heights; the column of rock is read before and written after a step, and what `f32`
//! cannot hold is kept beside it until it can. The other families share a [`Bed`] in single precision, and one `stage` that
//! reads and writes the world for them. Makes no weather and raises nothing.

mod bed;
mod column;
mod diffusion;
pub mod droplets;
mod hillslope;
pub mod hydraulic_cells;
mod leftover;
pub mod pipes;
pub mod rain_particles;
mod stage;
pub mod stream_power;
pub mod thermal;
mod weathering;

pub use bed::{Bed, Coast, Family, Moved, Part, Saved};
pub use droplets::{Droplets, DropletsParams};
pub use hillslope::HillslopeParams;
pub use hydraulic_cells::{HydraulicCells, HydraulicCellsParams, Steepness};
pub use pipes::{Pipes, PipesParams};
pub use rain_particles::{RainParticles, RainParticlesParams};
pub use stage::Lock;
pub use stream_power::StreamPowerParams;
pub use thermal::{Thermal, ThermalMethod, ThermalParams};
pub use weathering::weathering;
