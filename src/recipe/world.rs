//! `[world]`: the map that a recipe fills.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::grid::{Edges, Grid};

/// Least cells a side: below, no stage has room to work.
pub const MIN_SIDE: usize = 16;
/// Most cells a side: 16384² cells of one layer are 1 GiB.
pub const MAX_SIDE: usize = 16384;
/// Least length of a map, km.
pub const SHORTEST_KM: f64 = 0.01;
/// Most length of a map, km: once around the Earth.
pub const LONGEST_KM: f64 = 40075.0;

/// The map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WorldParams {
    /// Name of the world on maps; the recipe's name if absent.
    pub name: Option<String>,
    /// Root of every random number.
    #[schemars(range(min = 0, max = 9223372036854775807u64), extend("x-effect" = "another world of the same kind"))]
    pub seed: u64,
    /// Cells a side, or [west-east, north-south]; those of the file where the first stage imports one.
    #[schemars(schema_with = "size_schema")]
    pub size: Size,
    /// Length of the map from west to east; the file's own where the first stage imports one that tells it.
    #[schemars(range(min = SHORTEST_KM, max = LONGEST_KM), extend("x-unit" = "km", "x-effect" = "a larger map, with larger cells"))]
    pub extent_km: f64,
    /// Height of the sea.
    #[schemars(range(min = -12000.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "less land"))]
    pub sea_level_m: f64,
    /// What lies beyond the rim: matter leaves (open), nothing passes (closed), or east meets west and north meets south (wrap; stages make no seamless land of their own yet).
    #[schemars(schema_with = "edges_schema")]
    pub edges: Edges,
}

impl Default for WorldParams {
    fn default() -> Self {
        Self { name: None, seed: 42, size: Size::Side(1024), extent_km: 1000.0, sea_level_m: 0.0, edges: Edges::Open }
    }
}

impl WorldParams {
    /// The raster.
    pub fn grid(&self) -> Grid {
        let [width, height] = self.size.cells();
        Grid::new(width, height, self.extent_km * 1000.0, self.edges)
    }
}

/// Cells a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Size {
    /// A square map.
    Side(usize),
    /// West-east, north-south.
    Sides([usize; 2]),
}

impl Size {
    /// West-east, north-south.
    pub fn cells(self) -> [usize; 2] {
        match self {
            Size::Side(side) => [side, side],
            Size::Sides(sides) => sides,
        }
    }
}

fn size_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    let side = serde_json::json!({ "type": "integer", "minimum": MIN_SIDE, "maximum": MAX_SIDE, "x-unit": "cells" });
    schemars::json_schema!({
        "anyOf": [side, { "type": "array", "items": side, "minItems": 2, "maxItems": 2 }],
        "x-unit": "cells",
        "x-wanted": format!("a whole number of cells between {MIN_SIDE} and {MAX_SIDE}, or two such: [1024, 512]"),
        "x-effect": "a sharper picture of the same land",
    })
}

fn edges_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({ "type": "string", "enum": ["open", "closed", "wrap"] })
}
