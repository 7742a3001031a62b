//! Lava as smoothed particles: it wells up, runs down under its own pressure, rubs the stiffer the colder it is, cools, and
//! freezes into the ground.
//!
//! Momentum is that of `sph`: weakly compressible, symmetric pressure, Morris's viscosity with the harmonic mean of a pair,
//! followed where that is cheap and solved for all at once where it is stiff. Heat is enthalpy, conserved by conduction, lost
//! through surfaces. What is below the solidus and lies on the ground becomes lava of the column, with its volume; what flows
//! later runs over it. What Seed 0's document does otherwise stays as named choices.
//!
//! Time goes in blocks of a few steps that share one neighbour list. Particles are born, sorted, frozen and lost between blocks
//! only. Each step of the stage begins with a new block, from the particles in the order in which the last one left them: a run
//! that was saved and restored goes on with the same bits.

mod choices;
mod engine;
mod eruption;
mod flow;
mod heat;
mod land;
mod law;
mod params;
mod process;
mod saved;
mod smoke;
mod stride;
#[cfg(test)]
mod tests;
mod vents;

pub use choices::{Contact, Cooling, Mass, Smoothing, Solver, Viscosity};
pub use eruption::{Eruption, Seen};
pub use heat::Lost;
pub use params::LavaParams;
