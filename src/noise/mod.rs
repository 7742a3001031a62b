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

/// 0 below 0, 1 above 1, and `3t² - 2t³` between: no step and no kink.
pub fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
