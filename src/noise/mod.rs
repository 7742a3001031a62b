//! Randomness without state: a hash of integer coordinates, streams keyed by what they are for, and the noises built on
//! them. All coordinates in metres or in units of the caller's wavelength; nothing here knows a map.

mod fbm;
mod gully;
mod hash;
mod lattice;
mod multifractal;

pub use fbm::{Fbm, Octaves, Sampler};
pub use gully::Gullies;
pub use hash::{Key, Stream};
pub use lattice::{Basis, gradient, simplex, value};
