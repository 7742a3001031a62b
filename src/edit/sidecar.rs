//! What this program's own export wrote in `FILE.json` beside a heightmap, so that it comes back as high and as wide as
//! it was.
//!
//! Only what the file cannot say itself is taken, and only where the person says nothing. A JSON of another program, or
//! one that does not fit the file any more, is passed over.

use std::{fs::File, io::Read, path::Path};

use serde::Deserialize;

/// More than any of ours has, bytes.
const MOST_BYTES: u64 = 1 << 20;
/// The one beside the sample `my-heights.png`.
const SAMPLE: &str = include_str!("../../presets/my-heights.png.json");

/// What it says of one heightmap.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Sidecar {
    /// The version that wrote it: what tells ours from others.
    #[serde(rename = "upthrust")]
    _version: String,
    layer: String,
    /// Samples, west-east and north-south.
    pub size: [u32; 2],
    extent_m: [f64; 2],
    #[serde(default)]
    tiles_a_side: Option<usize>,
    /// Height of black, m.
    #[serde(default)]
    pub black_m: Option<f64>,
    /// Height of white, m.
    #[serde(default)]
    pub white_m: Option<f64>,
    #[serde(default)]
    byte_order: Option<String>,
    #[serde(default)]
    first_row: Option<String>,
}

impl Sidecar {
    /// The one beside a heightmap, where there is one.
    pub fn beside(path: &str) -> Option<Self> {
        if let Some(name) = path.strip_prefix("sample:") {
            return Self::parse(SAMPLE).filter(|_| name == "my-heights.png");
        }
        let path = Path::new(path);
        let name = path.file_name()?.to_string_lossy();
        let file = File::open(path.with_file_name(format!("{name}.json"))).ok()?;
        let mut text = String::new();
        file.take(MOST_BYTES).read_to_string(&mut text).ok()?;
        Self::parse(&text)
    }

    fn parse(text: &str) -> Option<Self> {
        let said: Self = serde_json::from_str(text).ok()?;
        let heights = matches!(said.layer.as_str(), "height" | "bedrock");
        let sound = said.extent_m.iter().all(|m| m.is_finite() && *m > 0.0) && said.size.iter().all(|&n| n > 0);
        // A tile is a part of what it describes.
        (heights && sound && said.tiles_a_side.is_none()).then_some(said)
    }

    /// Size of a cell, m: the extent over the samples.
    pub fn cell_m(&self) -> [f64; 2] {
        [0, 1].map(|i| self.extent_m[i] / f64::from(self.size[i]))
    }

    /// Whether it describes a file of that many cells.
    pub fn fits(&self, width: usize, height: usize) -> bool {
        self.size.map(|n| n as usize) == [width, height]
    }

    /// Whether the greatest byte of a raw number comes first.
    pub fn big_endian(&self) -> bool {
        self.byte_order.as_deref() == Some("big endian")
    }

    /// Whether the first row is the southernmost.
    pub fn south_first(&self) -> bool {
        self.first_row.as_deref() == Some("south")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_says_how_high_it_is() {
        let said = Sidecar::beside("sample:my-heights.png").unwrap();
        assert!(said.fits(288, 216) && said.cell_m()[0] == said.cell_m()[1]);
        assert_eq!((said.black_m, said.white_m), (Some(-620.0), Some(4770.0)));
        assert_eq!(Sidecar::beside("sample:my-continents.png"), None);
    }

    const OURS: &str = r#"{"upthrust": "0.1.0", "layer": "height", "size": [64, 32], "extent_m": [6400.0, 3200.0],
        "black_m": -200.5, "white_m": 1800.0, "byte_order": "big endian", "first_row": "north", "seed": 7}"#;

    #[test]
    fn ours_is_read_and_others_are_passed_over() {
        let said = Sidecar::parse(OURS).unwrap();
        assert_eq!((said.black_m, said.white_m, said.cell_m()), (Some(-200.5), Some(1800.0), [100.0, 100.0]));
        assert!(said.fits(64, 32) && !said.fits(32, 64) && said.big_endian() && !said.south_first());
        for (from, to) in [
            ("upthrust", "other"),
            ("\"height\"", "\"rain\""),
            ("6400.0", "0.0"),
            ("[64, 32]", "[64]"),
            ("\"seed\"", "\"tiles_a_side\""),
            ("}", ""),
        ] {
            assert_eq!(Sidecar::parse(&OURS.replace(from, to)), None, "{to}");
        }
    }
}
