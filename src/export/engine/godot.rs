//! Godot with the add-on Terrain3D.
//!
//! Terrain3D's documentation, "Importing & Exporting Data" and "Heightmaps": `.exr` holds metres, `.r16` and `.raw` hold
//! little-endian 16-bit values whose range and size are typed in; Godot reads PNG with 8 bits only. A map is cut into
//! regions of a power of two, and vertices lie `vertex_spacing` apart.

use serde_json::{Value, json};

use super::{Demands, Facts, WeightFiles};

pub const DEMANDS: Demands = Demands {
    name: "godot",
    sizes: &[64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384],
    endings: &["exr", "r16", "raw"],
    south_first: false,
    weights: WeightFiles::None,
};

pub fn settings(facts: &Facts) -> Value {
    let mut said = json!({
        "engine": "godot",
        "addon": "Terrain3D",
        "import_scale": 1.0,
        "height_offset_m": 0.0 - facts.sea_level_m,
        "height_offset_is": "moves the sea to Y = 0",
        "vertex_spacing_m": facts.tile.spacing_m,
        "tiles_a_side": facts.tiles,
    });
    if !facts.metres {
        said["r16_range"] = json!([facts.levels.black, facts.levels.white]);
        said["r16_size"] = json!([facts.tile.width, facts.tile.height]);
    }
    said
}
