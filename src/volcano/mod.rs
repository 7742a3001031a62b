//! Volcanoes: what they pour out, and what becomes of it.
//!
//! Builds no pictures, and knows other stages only by what they leave in the world.

pub mod lava;

pub use lava::LavaParams;
