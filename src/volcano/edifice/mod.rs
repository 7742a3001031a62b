//! The stage `volcano`: edifices with craters, one, several, a chain behind a hot spot, or along the arcs of the plates.
//!
//! `profile` is the noise-free shape, `age` what time does to it, `surface` joins them with noise to heights over the map;
//! `params` says how they are asked for, `place` where they stand, `stage` lays them into the ground and writes their vents.

mod age;
mod params;
mod place;
mod profile;
mod stage;
mod surface;
#[cfg(test)]
mod tests;

pub use age::Wear;
pub use params::{Arc, Chain, Place, VolcanoEntry, VolcanoParams};
pub use profile::{Cone, Profile};
pub use surface::{Edifice, Edifices, Reader, Roughness};
