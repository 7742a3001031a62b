//! Solvers against answers known in closed form.

mod measure;
mod noise;
mod rmp;
mod terrain;
