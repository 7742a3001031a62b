//! The stage `thermal`: what is too steep slides down.
//!
//! Three forms, all with the eight neighbours of a cell and a talus angle in degrees, so that a diagonal step down may be
//! `√2` times as high as a straight one:
//!
//! - `flux`: each face passes on `K·Δt·l·max(0, slope − tan φ)` metres, `φ` the angle at which the donor's material
//!   stands: loose ground, or rock. It vanishes at the talus, and no maximum grows while `K·Δt` is at most 0.146.
//! - `spread`: a cell sheds a share `c` of what its steepest way down exceeds the talus by, to all lower neighbours in
//!   proportion to their slope. What slides spreads sideways, so that screes have no ribs along the raster.
//! - `cells` (Olsen 2004): a cell sheds a share `c` of its greatest excess over the talus, among all lower neighbours that
//!   are too low, in proportion to how much lower they lie. Written to all cells at once, the latter two need `c ≤ 1/9`.
//!
//! Both move whole multiples of a quantum, a power of two so small that nobody sees it and so large that single
//! precision holds every sum of them: not a bit of ground is lost or made.
//!
//! A pass reaches one cell far, so that a slope of `L` cells needs some `L²` of them. `coarse_levels` lets the ground
//! slide on rasters of cells twice, four times and eight times as large first.

mod axis;
mod cells;
mod family;
mod flux;
mod levels;
mod params;
mod process;
mod raster;

#[cfg(test)]
mod tests;

pub use family::Thermal;
pub use params::{ThermalMethod, ThermalParams};
