//! Which format a file is: what its name or the recipe claims, held against what it begins with.

use std::io::Read;

use super::{Source, io_problem};
use crate::edit::{Problem, SourceFormat};

/// The formats that can be imported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG.
    Png,
    /// TIFF and GeoTIFF.
    Tiff,
    /// OpenEXR.
    Exr,
    /// 16-bit whole numbers without a header.
    Raw16,
    /// 32-bit fractions without a header.
    Raw32,
    /// ESRI ASCII grid.
    Asc,
    /// SRTM tile.
    Hgt,
}

impl Format {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Format::Png => "PNG",
            Format::Tiff => "TIFF",
            Format::Exr => "OpenEXR",
            Format::Raw16 => "raw 16-bit values",
            Format::Raw32 => "raw 32-bit values",
            Format::Asc => "an ESRI ASCII grid",
            Format::Hgt => "an SRTM tile",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        let ending = std::path::Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
        Some(match ending.as_str() {
            "png" => Format::Png,
            "tif" | "tiff" => Format::Tiff,
            "exr" => Format::Exr,
            "r16" | "raw" => Format::Raw16,
            "r32" => Format::Raw32,
            "asc" => Format::Asc,
            "hgt" => Format::Hgt,
            _ => return None,
        })
    }
}

/// What a file begins with.
enum Content {
    Known(Format),
    Foreign(&'static str),
    /// No mark: raw values, or nothing known.
    Bare,
}

/// First bytes of formats; those that are not read here are known by name so that they can be called by it.
fn content(head: &[u8]) -> Content {
    const FOREIGN: [(&[u8], &str); 9] = [
        (b"\xff\xd8\xff", "JPEG"),
        (b"GIF8", "GIF"),
        (b"RIFF", "WebP or another RIFF file"),
        (b"PK\x03\x04", "a zip archive"),
        (b"\x1f\x8b\x08", "compressed with gzip"),
        (b"%PDF", "PDF"),
        (b"\x89HDF\r\n\x1a\n", "HDF5 or NetCDF"),
        (b"CDF\x01", "NetCDF"),
        (b"8BPS", "a Photoshop file"),
    ];
    let begins = |mark: &[u8]| head.starts_with(mark);
    if begins(b"\x89PNG\r\n\x1a\n") {
        return Content::Known(Format::Png);
    }
    if begins(b"II*\0") || begins(b"MM\0*") || begins(b"II+\0") || begins(b"MM\0+") {
        return Content::Known(Format::Tiff);
    }
    if begins(b"\x76\x2f\x31\x01") {
        return Content::Known(Format::Exr);
    }
    let word = head.trim_ascii_start();
    let word = &word[..word.len().min(5)];
    if word.eq_ignore_ascii_case(b"ncols") || word.eq_ignore_ascii_case(b"nrows") {
        return Content::Known(Format::Asc);
    }
    FOREIGN.iter().find(|(mark, _)| begins(mark)).map_or(Content::Bare, |(_, name)| Content::Foreign(name))
}

/// The format that the recipe or the name claims and the content does not contradict.
pub(super) fn format(source: &mut Source, asked: SourceFormat) -> Result<Format, Problem> {
    let mut head = Vec::new();
    source.input.by_ref().take(64).read_to_end(&mut head).map_err(io_problem)?;
    let found = content(&head);
    let (claim, claimed) = match asked {
        SourceFormat::Auto => ("the name says", Format::from_name(&source.name)),
        SourceFormat::Png => ("format says", Some(Format::Png)),
        SourceFormat::Tiff => ("format says", Some(Format::Tiff)),
        SourceFormat::Exr => ("format says", Some(Format::Exr)),
        SourceFormat::R16 => ("format says", Some(Format::Raw16)),
        SourceFormat::R32 => ("format says", Some(Format::Raw32)),
        SourceFormat::Asc => ("format says", Some(Format::Asc)),
        SourceFormat::Hgt => ("format says", Some(Format::Hgt)),
    };
    let contradiction =
        |claimed: Format, found: &'static str| Err(Problem::Contradiction { claim, claimed: claimed.name(), found });
    match (claimed, found) {
        (Some(claimed), Content::Known(found)) if claimed == found => Ok(found),
        (Some(claimed), Content::Known(found)) => contradiction(claimed, found.name()),
        (Some(claimed), Content::Foreign(found)) => contradiction(claimed, found),
        (Some(claimed @ (Format::Raw16 | Format::Raw32 | Format::Hgt)), Content::Bare) => Ok(claimed),
        (Some(claimed), Content::Bare) => contradiction(claimed, "none of the formats that can be imported"),
        (None, _) => Err(Problem::Unknown),
    }
}
