//! The stage `rivers`: rain gathered to rivers and lakes, on the ground and as lines.
//!
//! | file | owns |
//! |---|---|
//! | `params` | the parameters |
//! | `hollows` | which hollows are lakes; how the others are drained or filled |
//! | `waters` | ways, lakes, discharge, Strahler's order, basins |
//! | `bed` | width and depth of rivers, and their beds |
//! | `course` | rivers as smooth lines |
//! | `tables` | rivers, lakes and their outlines as tables |
//! | `wetness` | how wet ground stays |
//! | `stage` | the process: what it reads, and what it writes and books |
//!
//! It takes no time and makes no valleys: the ground must have been carved before. It changes heights by no more than the
//! small hollows it drains or fills and the beds of rivers. Standing water on land is the layer `lake_depth`; the layer
//! `water` is left to what flows.

mod bed;
mod course;
mod hollows;
mod params;
mod stage;
mod tables;
#[cfg(test)]
mod tests;
mod waters;
mod wetness;

pub use params::RiversParams;
