//! Solvers against answers known in closed form.

mod noise;
mod rmp;
mod terrain;
