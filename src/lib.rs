//! Upthrust grows a world from its plates.

#![warn(missing_docs)]

pub mod crust;
pub mod cli;
pub mod export;
pub mod grid;
pub mod job;
pub mod measure;
pub mod noise;
pub mod process;
pub mod rmp;
pub mod tectonics;
pub mod terrain;
pub mod relief;
pub mod recipe;
pub mod relief;
pub mod rmp;
pub mod terrain;
pub mod timeline;
pub mod world;
