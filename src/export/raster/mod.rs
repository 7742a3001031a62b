//! Raster files: heights, layers, normal maps and weights as pictures, raw numbers and maps.
//!
//! [`FORMATS`] is the one table of endings; a format is a row in it and a file here that encodes a [`Raster`]. Encoders
//! know samples and where they lie, never what they mean.

mod ascii_grid;
mod geotiff;
mod lattice;
mod levels;
mod open_exr;
pub(super) mod png_image;
mod raw;
#[cfg(test)]
mod round_trip;

pub use lattice::{Lattice, Sampling, Window};
pub use levels::Levels;

use std::{fs::File, io::BufWriter, path::Path};

use super::{ExportError, write_whole};

/// Samples of one kind, row by row from the north, channels side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// 8-bit numbers.
    U8(Vec<u8>),
    /// 16-bit numbers.
    U16(Vec<u16>),
    /// 32-bit floating point: the quantity itself.
    F32(Vec<f32>),
}

/// How a sample is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// 8-bit whole numbers.
    U8,
    /// 16-bit whole numbers.
    U16,
    /// 32-bit floating point.
    F32,
}

impl Depth {
    /// Bits of a sample.
    pub const fn bits(self) -> u32 {
        match self {
            Depth::U8 => 8,
            Depth::U16 => 16,
            Depth::F32 => 32,
        }
    }

    /// The greatest whole number; `None` for floating point.
    pub const fn most(self) -> Option<f64> {
        match self {
            Depth::U8 => Some(255.0),
            Depth::U16 => Some(65535.0),
            Depth::F32 => None,
        }
    }
}

/// What a raster file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Where the samples lie, and how many there are.
    pub lattice: Lattice,
    /// Samples side by side at each place: 1 gray, 3 colour, 4 colour and alpha.
    pub channels: usize,
    /// The samples.
    pub samples: Samples,
    /// What black and white stand for, where whole numbers measure one quantity.
    pub levels: Option<Levels>,
}

impl Raster {
    /// The samples of a part: `width` x `height` places beginning at `(x, y)`.
    pub fn part(&self, x: usize, y: usize, width: usize, height: usize) -> Raster {
        fn cut<T: Copy>(all: &[T], row: usize, from: usize, count: usize, rows: std::ops::Range<usize>) -> Vec<T> {
            rows.flat_map(|y| all[y * row + from..][..count].iter().copied()).collect()
        }
        let (row, from, count) = (self.lattice.width * self.channels, x * self.channels, width * self.channels);
        let rows = y..y + height;
        let samples = match &self.samples {
            Samples::U8(all) => Samples::U8(cut(all, row, from, count, rows)),
            Samples::U16(all) => Samples::U16(cut(all, row, from, count, rows)),
            Samples::F32(all) => Samples::F32(cut(all, row, from, count, rows)),
        };
        Raster {
            lattice: self.lattice.part(x, y, width, height),
            channels: self.channels,
            samples,
            levels: self.levels,
        }
    }
}

/// How bytes and rows are laid out, where the format leaves it open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// The most significant byte first.
    pub big_endian: bool,
    /// The southern row first.
    pub south_first: bool,
}

/// A file that is being written.
pub type Out = BufWriter<File>;
/// Encodes a raster; says in words what went wrong.
pub type Encode = fn(&Raster, Layout, &mut Out) -> Result<(), String>;

/// A kind of raster file.
#[derive(Debug)]
pub struct Format {
    /// Endings of names, without the dot, the usual one first.
    pub endings: &'static [&'static str],
    /// What it is, for people.
    pub title: &'static str,
    /// How it stores one quantity, the usual way first.
    pub gray: &'static [Depth],
    /// How it stores three, the usual way first; none if it cannot.
    pub colour: &'static [Depth],
    /// Nothing but numbers: byte order and order of rows are for the writer to choose.
    pub bare: bool,
    /// Its encoder.
    pub encode: Encode,
}

use Depth::{F32, U8, U16};

/// Every raster format.
pub const FORMATS: &[Format] = &[
    Format {
        endings: &["png"],
        title: "gray picture, 16 or 8 bits",
        gray: &[U16, U8],
        colour: &[U8, U16],
        bare: false,
        encode: png_image::encode,
    },
    Format {
        endings: &["tif", "tiff"],
        title: "GeoTIFF, metres in 32-bit floating point or 16 bits",
        gray: &[F32, U16],
        colour: &[],
        bare: false,
        encode: geotiff::encode,
    },
    Format {
        endings: &["exr"],
        title: "OpenEXR, metres in 32-bit floating point",
        gray: &[F32],
        colour: &[F32],
        bare: false,
        encode: open_exr::encode,
    },
    Format {
        endings: &["asc"],
        title: "ESRI ASCII grid, metres",
        gray: &[F32],
        colour: &[],
        bare: false,
        encode: ascii_grid::encode,
    },
    Format {
        endings: &["r16", "raw"],
        title: "16-bit numbers and nothing else",
        gray: &[U16],
        colour: &[],
        bare: true,
        encode: raw::encode,
    },
    Format {
        endings: &["r32"],
        title: "metres as 32-bit floating point and nothing else",
        gray: &[F32],
        colour: &[],
        bare: true,
        encode: raw::encode,
    },
];

impl Format {
    /// The format a file's ending asks for.
    pub fn of(path: &Path) -> Option<&'static Format> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        FORMATS.iter().find(|format| format.endings.contains(&ending.as_str()))
    }

    /// Writes a raster whole or not at all.
    pub fn write(&self, raster: &Raster, layout: Layout, path: &Path) -> Result<(), ExportError> {
        write_whole(path, |out| self.fill(raster, layout, path, out))
    }

    /// Encodes a raster into a file that is open.
    pub fn fill(&self, raster: &Raster, layout: Layout, path: &Path, out: &mut Out) -> Result<(), ExportError> {
        (self.encode)(raster, layout, out).map_err(|cause| ExportError::Encode { path: path.to_owned(), cause })
    }
}
