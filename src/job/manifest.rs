//! `manifest.json`: how a world was made and what came out, for people and scripts.

use std::path::Path;

use serde::Serialize;

use crate::{
    export::HeightRange,
    measure::{Books, Inspection, LayerStats},
    recipe::Plan,
    timeline::StageRecord,
    world::World,
};

use super::{JobError, MANIFEST};

/// Everything the manifest says.
#[derive(Clone, Debug, Serialize)]
pub struct Manifest {
    /// Version of the program.
    pub upthrust: &'static str,
    /// The recipe's short name.
    pub name: String,
    /// The recipe's name for people.
    pub title: String,
    /// The recipe as it ran, flags included.
    pub recipe: String,
    /// The stage the run was ended after, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// The seed.
    pub seed: u64,
    /// Cells from west to east and from north to south.
    pub size: [usize; 2],
    /// Side of a cell, m.
    pub cell_m: f64,
    /// West-east and north-south extent, km.
    pub extent_km: [f64; 2],
    /// Where the map's north-west corner lies in the first map, east and south of that one's, km, where a stage cut a window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_at_km: Option<[f64; 2]>,
    /// What lies beyond the rim.
    pub edges: crate::grid::Edges,
    /// Height of the sea, m.
    pub sea_level_m: f64,
    /// Years that passed.
    pub time_yr: f64,
    /// Share of the map above the sea.
    pub land_share: f64,
    /// The heights that black and white stand for in `height.png`.
    pub height_png: HeightRange,
    /// Each layer: least, greatest, mean, hash.
    pub layers: Vec<LayerStats>,
    /// The books of each stage.
    pub ledger: Vec<Books>,
    /// Steps and seconds of each stage.
    pub stages: Vec<StageRecord>,
    /// Files with the run's numbers in time: a row a step, and the rivers' long profiles.
    pub in_time: Vec<&'static str>,
    /// Recordings of particles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub baked: Vec<String>,
    /// Threads that worked.
    pub threads: usize,
    /// Seconds from the first step to the last file.
    pub seconds: f64,
}

impl Manifest {
    /// What is known once the world is grown and measured.
    pub(crate) fn new(plan: &Plan, world: &World, measured: Inspection, height_png: HeightRange) -> Self {
        Self {
            upthrust: env!("CARGO_PKG_VERSION"),
            name: plan.name.clone(),
            title: plan.title.clone(),
            recipe: plan.text.clone(),
            until: None,
            seed: plan.world.seed,
            size: measured.size,
            cell_m: measured.cell_m,
            extent_km: measured.extent_km,
            window_at_km: window_at_km(world),
            edges: world.grid.edges,
            sea_level_m: world.sea_level_m,
            time_yr: world.time_yr,
            land_share: measured.land_share,
            height_png,
            layers: measured.layers,
            ledger: measured.ledger,
            stages: Vec::new(),
            in_time: Vec::new(),
            baked: Vec::new(),
            threads: rayon::current_num_threads(),
            seconds: 0.0,
        }
    }

    /// The file's text.
    pub fn text(&self) -> String {
        // Plain strings and finite numbers: there is nothing in it that JSON cannot say.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    pub(crate) fn write(&self, folder: &Path) -> Result<(), JobError> {
        let path = folder.join(MANIFEST);
        std::fs::write(&path, self.text()).map_err(|cause| JobError::Disk { path, cause })
    }
}

/// The last row of the table that zooms write.
fn window_at_km(world: &World) -> Option<[f64; 2]> {
    let windows = world.table("windows")?;
    let last = |column: &str| windows.numbers(column)?.last().copied();
    Some([last("first_x_km")?, last("first_y_km")?])
}
