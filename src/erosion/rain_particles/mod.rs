//! Rain as smoothed particles: water that falls on the land, runs off it under its own pressure, digs and lays down.
//!
//! Momentum is that of `sph`: weakly compressible, Wendland's kernel at 1.2 spacings, symplectic Euler within the limits of
//! sound and viscosity. The ground is a mesh of triangles on the cell centres; it mirrors the pressure of the water on it
//! (the kernel's share below the plane) and is never gone through. Speeds are bounded by what friction on the bed lets water
//! reach, or drops in air, so that the number of sub-steps is known before a run and `check` refuses what would not end.
//!
//! Time goes in blocks of a few sub-steps that share one neighbour list. Particles are born, sorted and lost, and the bed
//! changes, between blocks only. Each step of the stage begins with a new block and the lists made anew, from the particles in
//! the order in which the last block left them: a run that was saved and restored goes on with the same bits.
//!
//! For cells of metres; over five metres a particle is a pond.

mod contact;
mod exchange;
mod family;
mod params;
mod process;
mod rain;
#[cfg(test)]
mod tests;
mod water;

pub use family::{RainParticles, Seen};
pub use params::RainParticlesParams;
