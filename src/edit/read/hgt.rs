//! SRTM tiles: a square degree (or half its columns) of 16-bit heights in metres, big-endian, from the north.
//!
//! The name is the south-west corner (`N46E007.hgt`); samples lie on the lattice of arc seconds, both rims included.
//! -32768 stands for no height.

use std::path::Path;

use super::{DEGREE_M, Format, Header, Input, Sample, Scale, checked, rows};
use crate::edit::Problem;

/// Columns and rows of a tile of 3", 1", and 1" with half the columns (north of 50° in some editions).
const SIZES: [[u64; 2]; 3] = [[1201, 1201], [3601, 3601], [1801, 3601]];
const VOID: i16 = i16::MIN;

pub(super) fn header(name: &str, length: u64) -> Result<Header, Problem> {
    let size = SIZES.iter().find(|[w, h]| 2 * w * h == length).ok_or_else(|| {
        Problem::Length(format!(
            "{length} bytes are no SRTM tile; those have 2884802 (1201 x 1201) or 25934402 (3601 x 3601)"
        ))
    })?;
    let (width, height) = checked(size[0], size[1], 2, length, 1)?;
    // Without a latitude the tile is as wide as at the equator.
    let middle_deg = south_deg(name).map_or(0.0, |south| south + 0.5);
    let east_m = DEGREE_M * libm::cos(middle_deg.to_radians()) / (size[0] - 1) as f64;
    let north_m = DEGREE_M / (size[1] - 1) as f64;
    let sample = Sample::Signed(16);
    Ok(Header { format: Format::Hgt, width, height, cell_m: Some([east_m, north_m]), sample, metres: true, line: None })
}

/// The latitude that a tile is named by.
fn south_deg(name: &str) -> Option<f64> {
    let stem = Path::new(name).file_stem()?.to_str()?;
    let sign = match stem.as_bytes().first()? {
        b'N' | b'n' => 1.0,
        b'S' | b's' => -1.0,
        _ => return None,
    };
    let degrees: f64 = stem.get(1..3)?.parse().ok()?;
    (degrees < 90.0).then_some(sign * degrees)
}

pub(super) fn heights(input: &mut dyn Input, header: &Header, scale: &Scale) -> Result<Vec<f32>, Problem> {
    rows(input, header, 2, |b| match i16::from_be_bytes([b[0], b[1]]) {
        VOID => f32::NAN,
        value => scale.height(value as f64),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_latitudes() {
        assert_eq!(south_deg("dem/N46E007.hgt"), Some(46.0));
        assert_eq!(south_deg("s03w060.hgt"), Some(-3.0));
        for strange in ["alps.hgt", "N.hgt", "N99E000.hgt", "Nä.hgt", ""] {
            assert_eq!(south_deg(strange), None, "{strange}");
        }
    }

    #[test]
    fn a_tile_narrows_towards_the_poles() {
        let [east, north] = header("N59E010.hgt", 2 * 1201 * 1201).unwrap().cell_m.unwrap();
        // cos 59.5° = 0.50754, from a table.
        assert!((east / north - 0.50754).abs() < 1e-5, "{east} {north}");
        assert!((north - 92.66).abs() < 0.01);
    }
}
