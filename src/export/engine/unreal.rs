//! Unreal Engine landscapes.
//!
//! Epic's Landscape Technical Guide: a height is stored as `(value - 32768) / 128` in local units, so that the whole
//! range of 16 bits spans 512 local units, and the actor's scale turns local units into centimetres. So the Z scale is
//! the range in centimetres over 512, and the actor stands at the height of value 32768. X grows to the east, Y to the
//! south as in our rows. The recommended sizes follow from whole sections in whole components.

use serde_json::{Value, json};

use super::{Demands, Facts, WeightFiles};

pub const DEMANDS: Demands = Demands {
    name: "unreal",
    sizes: &[127, 253, 505, 1009, 2017, 4033, 8129],
    endings: &["png", "r16", "raw"],
    south_first: false,
    weights: WeightFiles::OneEach,
};

/// Local units that 65536 steps of height span.
const LOCAL_SPAN: f64 = 512.0;

pub fn settings(facts: &Facts) -> Value {
    // 65535 steps lie between black and white, 65536 make up the 512 units.
    let range_cm = facts.levels.span() * 100.0 * 65536.0 / 65535.0;
    let z_scale = range_cm / LOCAL_SPAN;
    let middle_cm = facts.levels.black * 100.0 + range_cm / 2.0;
    let spacing_cm = facts.tile.spacing_m * 100.0;
    json!({
        "engine": "unreal",
        "scale_x_cm": spacing_cm,
        "scale_y_cm": spacing_cm,
        "scale_z": z_scale,
        "location_z_cm": middle_cm - facts.sea_level_m * 100.0,
        "location_z_is": "where the landscape stands so that the sea lies at Z = 0",
        "overall_resolution": facts.tile.width,
        "tiles_a_side": facts.tiles,
    })
}

/// Whether Unreal would take a name for one of a set of tiles: `map4033x4033` or `map_x0_y0`.
pub fn reads_as_tiles(stem: &str) -> bool {
    let bytes = stem.as_bytes();
    let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
    let is = |i: usize, c: u8| bytes.get(i).is_some_and(|b| b.eq_ignore_ascii_case(&c));
    (1..bytes.len())
        .any(|i| is(i, b'x') && digit(i + 1) && (digit(i - 1) || is(i - 1, b'_') && stem[i..].contains("_y")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        export::raster::{Lattice, Levels, Sampling},
        grid::{Edges, Grid},
    };

    #[test]
    fn heights_come_out_in_centimetres_above_the_sea() {
        let grid = Grid::new(1000, 1000, 5000.0, Edges::Open);
        let tile = Lattice::over(&grid, None, 1009, Sampling::Vertices);
        let levels = Levels { black: -1200.0, white: 3007.0 };
        let facts = Facts { tile: &tile, tiles: 1, levels, sea_level_m: 100.0, metres: false, big_endian: false };
        let said = settings(&facts);
        let number = |key: &str| said[key].as_f64().unwrap();
        // A range of Mauna Kea's 4207 m; 65536 steps instead of 65535 are 1.5e-5 more.
        assert!((number("scale_z") / 821.68 - 1.0).abs() < 3e-5, "{said}");
        assert!((number("scale_x_cm") - 500_000.0 / 1008.0).abs() < 1e-9);
        for height_m in [-1200.0, 0.0, 100.0, 3007.0] {
            let value = levels.place(height_m, 65535.0);
            let world_cm = (value - 32768.0) / 128.0 * number("scale_z") + number("location_z_cm");
            assert!((world_cm - (height_m - 100.0) * 100.0).abs() < 1e-6, "{height_m}: {world_cm}");
        }
    }

    #[test]
    fn names_that_look_like_tiles() {
        for name in ["map4033x4033", "a_x0_y0", "1X1"] {
            assert!(reads_as_tiles(name), "{name}");
        }
        for name in ["alps", "max2", "x1", "index_0", "a_x"] {
            assert!(!reads_as_tiles(name), "{name}");
        }
    }
}
