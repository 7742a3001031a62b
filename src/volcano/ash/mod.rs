//! Ash: what an eruption column lets fall downwind, and the smoke of the column itself.
//!
//! Advection and diffusion of grains that fall, after Suzuki (in Arc Volcanism, 1983, 95–113): the column lets grains go at
//! every height, most of them high up, `p(z) ∝ (1 − z/H)·exp(A·(z/H − 1))`; a grain falls at its terminal velocity, drifts
//! with the wind, and spreads. What lands is a sum of Gaussians, a size and a height each, whose integral over an infinite
//! plane is the volume that erupted. Each is integrated over every cell, so that no cell size changes what falls where.

mod column;
mod params;
mod smoke;
mod stage;

pub use params::AshParams;
