//! Azgaar's Fantasy Map Generator: gray pictures for its image converter.
//!
//! Its heights are whole numbers from 0 to 100 with the shore at 20. "Auto-assign by luminosity" reads CIE lightness L*:
//! from 13 on it is the height itself, below that the height is L* times 20/13. What it shows in metres is
//! `(height - 18)^exponent` on land, with an exponent of 2 unless set otherwise, and `50 (20 - height)/height` below the
//! sea. We invert all of this, so that its map shows the world's own metres.

use serde_json::{Value, json};

use super::{Demands, WeightFiles};

pub const DEMANDS: Demands =
    Demands { name: "azgaar", sizes: &[], endings: &["png"], south_first: false, weights: WeightFiles::None };

/// Its own exponent unless the highest peak needs more.
const EXPONENT: f64 = 2.0;
/// Height number of the shore.
const SHORE: f64 = 20.0;

/// The exponent at which a peak this far above the sea still fits height 100.
fn exponent(peak_m: f64) -> f64 {
    let needed = libm::log(peak_m.max(1.0)) / libm::log(82.0);
    // It is set in tenths there.
    EXPONENT.max((needed * 10.0).ceil() / 10.0)
}

/// The numbers that say how its heights were made.
pub fn scale(peak_m: f64) -> Value {
    json!({
        "engine": "azgaar",
        "assign_colors": "by luminosity",
        "height_exponent": exponent(peak_m),
        "sea_level_height": SHORE,
    })
}

/// The gray value of each whole height, and the height of ground `above_sea_m`.
pub fn gray(peak_m: f64) -> impl Fn(f64) -> u8 {
    let exponent = exponent(peak_m);
    let bytes: Vec<u8> = (0..=100).map(byte_of).collect();
    move |above_sea_m| {
        let height = if above_sea_m > 0.0 {
            (18.0 + libm::pow(above_sea_m, 1.0 / exponent)).clamp(SHORE, 100.0)
        } else {
            // At 0 its formula for depths divides by zero.
            (1000.0 / (50.0 - above_sea_m)).clamp(1.0, SHORE - 1.0)
        };
        bytes[(height + 0.5) as usize]
    }
}

/// The gray byte that reads back as `height`: in the middle of the lightnesses that are cut off to it.
fn byte_of(height: usize) -> u8 {
    let middle = height as f64 + 0.5;
    let wanted = if middle < SHORE { middle * 13.0 / SHORE } else { middle };
    let distance = |byte: &u8| (lightness(*byte) - wanted).abs();
    (0..=255u8).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// CIE L* of an sRGB gray.
fn lightness(byte: u8) -> f64 {
    let v = byte as f64 / 255.0;
    let y = if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) };
    if y > 216.0 / 24389.0 { 116.0 * libm::cbrt(y) - 16.0 } else { y * 24389.0 / 27.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What its converter makes of a gray.
    fn read(byte: u8) -> usize {
        let l = lightness(byte);
        if l < 13.0 { (l / 13.0 * 20.0) as usize } else { l as usize }
    }

    #[test]
    fn its_converter_reads_every_height_back() {
        assert_eq!((lightness(0), lightness(255).round()), (0.0, 100.0));
        // White is the one lightness that rounding could cut to 99.
        for height in 0..100 {
            assert_eq!(read(byte_of(height)), height);
        }
        assert_eq!(byte_of(100), 255);
    }

    #[test]
    fn it_shows_the_worlds_own_metres() {
        let byte = gray(4000.0);
        for metres in [4.0, 100.0, 900.0, 2500.0, 4000.0] {
            let height = read(byte(metres)) as f64;
            let shown = |height: f64| (height - 18.0).powi(2);
            assert!(shown(height - 1.0) <= metres && metres <= shown(height + 1.0), "{metres} {height}");
        }
        assert_eq!(read(byte(0.0)), 19);
        assert_eq!(read(byte(0.5)), 20);
        assert_eq!(read(byte(-100.0)), 7);
        assert_eq!(read(byte(-9000.0)), 1);
        assert_eq!(exponent(6724.0), 2.0);
        assert!(82f64.powf(exponent(9000.0)) >= 9000.0);
    }
}
