//! Upthrust grows a world from its plates: rigid plates drift and collide, ranges rise where they meet, and a picture, a
//! heightmap and a store of layers come out.
//!
//! The rooms, in the order in which they may import each other (a room imports only rooms above it):
//!
//! - [`grid`], [`noise`], [`rmp`], [`sph`], [`flow`]: rasters in metres, keyed randomness, random partitions, particles, the ways of water.
//!   Numerics only.
//! - [`world`]: what all solvers meet through.
//! - [`bake`]: recordings of particles, their file, and playback.
//! - [`process`]: what a solver looks like.
//! - [`crust`]: how high a column of rock floats.
//! - [`terrain`], [`tectonics`], [`climate`], [`erosion`], [`volcano`], [`rivers`], [`edit`]: the stages. They never import each other.
//! - [`scene`]: how a world is to be seen, in plain numbers.
//! - [`recipe`], [`timeline`]: a recipe becomes a checked plan, a plan becomes a world.
//! - [`measure`], [`relief`], [`export`]: numbers, pictures and files of a world.
//! - `render`: pictures on the graphics adapter (feature `render`).
//! - [`job`], [`cli`]: recipe to files on a worker, and the command line.
//! - `app`: the desktop application (feature `app`).

#![warn(missing_docs)]

pub mod grid;
pub mod noise;
pub mod rmp;
pub mod sph;

pub mod flow;

pub mod world;

pub mod bake;

pub mod process;

pub mod crust;

pub mod climate;
pub mod edit;
pub mod erosion;
pub mod rivers;
pub mod tectonics;
pub mod terrain;
pub mod volcano;

pub mod scene;

pub mod recipe;
pub mod timeline;

pub mod measure;

pub mod relief;

#[cfg(feature = "render")]
pub mod render;

pub mod export;

pub mod job;

pub mod cli;

#[cfg(feature = "app")]
pub mod app;
