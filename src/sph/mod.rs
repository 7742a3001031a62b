//! Smoothed particles: kernels, neighbour lists, sums over pairs, and a step in time. Knows neither rain nor lava.
//!
//! Particles lie sorted by cell in flat arrays of `f32`. Lists of neighbours reach a skin further than the kernel, so that
//! several steps share them. Every sum gathers: a particle reads its neighbours in the order of its list and writes its own
//! value, so the bits do not depend on the number of threads nor on the width of the processor's registers.
//!
//! Densities are relative to the rest density and pressures are divided by it (m²/s²): no sum needs a mass in kilograms.

mod cells;
mod cloud;
mod contact;
mod diffuse;
mod forces;
mod implicit;
mod kernel;
mod naive;
mod neighbours;
mod scheme;
mod swarm;
mod terms;
#[cfg(test)]
mod tests;
mod viscous;
mod wide;

pub use cells::{Cells, Domain};
pub use cloud::{Cloud, gather};
pub use contact::Touch;
pub use diffuse::{Around, look_around};
pub use forces::{Forces, Liquid, pack};
pub use implicit::{Implicit, Stiff};
pub use kernel::{CubicSpline, DesbrunGascuel, Kernel, Scale, WendlandC2};
pub use naive::naive_neighbours;
pub use neighbours::Lists;
pub use scheme::{Scheme, Weights};
pub use swarm::Swarm;
pub use terms::{Particle, Term, sum_pairs};
pub use viscous::{Diagonal, Drawn, Flowing, Rubbing, Shear, shear_rate};
pub use wide::{LANES, Reader, Work, widest};

/// Particles that one task works on: enough to pay for waking a thread, few enough to share out evenly.
pub const RUN: usize = 128;
