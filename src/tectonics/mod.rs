//! Rigid plates drift, collide, part and slide; land follows.
//!
//! A square wider than the map is cut into convex plates (`partition`). rapier2d moves them (`engine`) over a mantle that
//! drags them (`mantle`); what their contacts say (`contact`) becomes stretches of border (`stretch`). Every plate carries
//! its ground on a raster of its own (`plate`), so that nothing smears; where rasters overlap or part, crust is exchanged
//! (`exchange`), ranges are raised (`raise`) and volcanoes grow (`arc`). `simulation` runs it; `surface` turns crust into
//! heights, with the shapes that borders press beside them (`profiles`). The map reads them through one fold-free warp
//! (`warp`), so that straight borders show nowhere; what lies outside all that it reads (`window`) is left out. Where
//! another stage carves the map while the plates move, `carved` keeps the two together.
//!
//! This room alone touches rapier2d. It knows the map's grid only when it publishes: plates run on cells of their own,
//! so that a larger map is sharper, not different.

mod arc;
mod border;
mod carved;
mod contact;
mod domain;
mod engine;
mod exchange;
mod initial;
mod mantle;
mod paint;
mod params;
mod partition;
mod plate;
mod profiles;
mod raise;
mod simulation;
mod stage;
mod stretch;
mod surface;
mod tables;
#[cfg(test)]
mod tests;
mod thesis;
mod warp;
mod window;

pub use params::{PlateCrust, PlateEntry, PlateStyle, PlatesParams};
