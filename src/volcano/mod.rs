//! Volcanoes: islands to stand on, edifices with craters, alone, in chains behind a hot spot, or along arcs; the lava and ash
//! they pour and throw out, and what becomes of it.
//!
//! `island` and `volcano` are base terrain: they lay heights into the bedrock in one go, in metres, keyed by place and count,
//! so that another size refines the land and does not change it. Where the plates say how ground moves or where a slab
//! sinks, they are asked through the world's tables. Vents go into the table that [`crate::world::World::vents`] reads.

pub mod ash;
mod edifice;
mod heat;
mod island;
pub mod lava;
mod outlet;
mod schedule;
pub mod sheet;
mod smoke;
#[cfg(test)]
mod tests;

pub use ash::AshParams;
pub use edifice::{
    Arc, Chain, Cone, Edifice, Edifices, Place, Profile, Reader, Roughness, VolcanoEntry, VolcanoParams, Wear,
};
pub use island::{IslandEntry, IslandParams, IslandProfile};
pub use lava::LavaParams;
pub use outlet::VentParams;
pub use schedule::{Key, Schedule, SheetKey};
pub use sheet::LavaSheetParams;

use crate::grid::Grid;

/// A place given in km, or the middle of the map; m.
fn place_m(given_km: Option<[f64; 2]>, grid: &Grid) -> [f64; 2] {
    let [w, h] = grid.extent_m();
    given_km.map_or([0.5 * w, 0.5 * h], |[x, y]| [x * 1e3, y * 1e3])
}

/// A length given in km, or a share of the map's longer side; m.
fn length_m(given_km: Option<f64>, share: f64, grid: &Grid) -> f64 {
    let [w, h] = grid.extent_m();
    given_km.map_or(share * w.max(h), |km| km * 1e3)
}

/// What a person should know of lava that left the map.
fn over_rim(m3: f64) -> String {
    format!("{m3:.0} m3 of lava left over the rim of the map; a larger extent_km, or vents further in, would keep it")
}

/// Distance of a place from the map, 0 on it; m.
fn off_map_m(at_m: [f64; 2], grid: &Grid) -> f64 {
    let [w, h] = grid.extent_m();
    libm::hypot((-at_m[0]).max(at_m[0] - w).max(0.0), (-at_m[1]).max(at_m[1] - h).max(0.0))
}
