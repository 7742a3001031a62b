//! What wears land away: streams over geologic time, hillslopes, and what they lay down elsewhere.
//!
//! Solvers work in `f64` on plain heights; the column of rock is read before and written after a step, and what `f32`
//! cannot hold is kept beside it until it can. Makes no weather and raises nothing.

mod column;
mod diffusion;
mod hillslope;
pub mod stream_power;

pub use hillslope::HillslopeParams;
pub use stream_power::StreamPowerParams;
