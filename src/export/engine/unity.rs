//! Unity terrains.
//!
//! Unity's manual, "Working with Heightmaps": RAW files of 16-bit gray, 2^n + 1 vertices a side; the first row is the
//! terrain's near edge (z = 0), so rows run from the south. The terrain's size in metres and its height are typed in.
//! Terrain Tools' batch import takes names that end with the tile's index along X and along Z.

use serde_json::{Value, json};

use super::{Demands, Facts, WeightFiles};

pub const DEMANDS: Demands = Demands {
    name: "unity",
    sizes: &[33, 65, 129, 257, 513, 1025, 2049, 4097],
    endings: &["raw", "r16"],
    south_first: true,
    weights: WeightFiles::FourChannels,
};

pub fn settings(facts: &Facts) -> Value {
    let side_m = facts.tile.extent_m()[0];
    json!({
        "engine": "unity",
        "depth": "Bit 16",
        "resolution": facts.tile.width,
        "byte_order": if facts.big_endian { "Mac" } else { "Windows" },
        "flip_vertically": false,
        "terrain_width_m": side_m,
        "terrain_length_m": side_m,
        "terrain_height_m": facts.levels.span(),
        "position_y_m": facts.levels.black - facts.sea_level_m,
        "position_y_is": "where the terrain stands so that the sea lies at Y = 0",
        "tiles_a_side": facts.tiles,
    })
}

/// Columns from the west, rows from the south.
pub fn tile_suffix(x: usize, y: usize, tiles: usize) -> String {
    format!("_{x}_{}", tiles - 1 - y)
}
