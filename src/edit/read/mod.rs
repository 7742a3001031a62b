//! Heightmap files: which format a file is, what its header says, and its heights. One file a format.
//!
//! A reader gets a file whose size has passed [`checked`], and a [`Scale`] that turns its values into metres. It gives
//! `NaN` where the file has no height. It never allocates more than the header's cells, and the header's cells never
//! exceed what the file's length could hold.

mod asc;
mod exr;
mod hgt;
mod png;
mod raw;
mod sniff;
mod tiff;

pub use sniff::Format;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Cursor, Seek, SeekFrom},
};

use super::{ImportParams, Problem};

/// Most cells a side of a file: as many as a map may have.
pub const MOST_SIDE: u64 = 16384;
/// Metres of a degree of latitude on a sphere of 6371.0088 km, the mean radius of the Earth (IUGG).
const DEGREE_M: f64 = 111_195.08;
/// No land, sea floor or unit of length gives heights beyond this, m.
const ABSURD_M: f32 = 1e6;
/// Below this, a fraction stands for "no height" in every program that writes such files.
const NO_HEIGHT: f64 = -1e30;

/// What a file says of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Its format.
    pub format: Format,
    /// Cells from west to east.
    pub width: usize,
    /// Cells from north to south.
    pub height: usize,
    /// West-east and north-south size of a cell, m, where the file tells it.
    pub cell_m: Option<[f64; 2]>,
    /// How a value is stored.
    pub sample: Sample,
    /// Whether values are metres, not levels between black and white.
    pub metres: bool,
    /// Where a file of metres says so: the height of 0, m, and the metres a value.
    pub line: Option<[f64; 2]>,
}

/// How a value is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// Whole numbers of so many bits from 0.
    Whole(u8),
    /// Whole numbers of so many bits about 0.
    Signed(u8),
    /// Fractions of so many bits.
    Fraction(u8),
}

impl Sample {
    /// Bits a value.
    pub fn bits(self) -> u8 {
        match self {
            Sample::Whole(bits) | Sample::Signed(bits) | Sample::Fraction(bits) => bits,
        }
    }

    /// The values of black and white.
    pub(super) fn ends(self) -> (f64, f64) {
        let power = |bits: u8| libm::exp2(bits as f64);
        match self {
            Sample::Whole(bits) => (0.0, power(bits) - 1.0),
            Sample::Signed(bits) => (-power(bits - 1), power(bits - 1) - 1.0),
            Sample::Fraction(_) => (0.0, 1.0),
        }
    }

    /// Distance of two neighbouring values; 0 for fractions.
    pub(super) fn step(self) -> f64 {
        if matches!(self, Sample::Fraction(_)) { 0.0 } else { 1.0 }
    }
}

/// A map of heights as a file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Heightmap {
    /// Cells from west to east.
    pub width: usize,
    /// Cells from north to south.
    pub height: usize,
    /// Row by row from the north, m.
    pub heights: Vec<f32>,
    /// How many of them the file did not say.
    pub filled: usize,
    /// How many of these it said to be infinite.
    pub infinite: usize,
    /// Distance of two heights that the file can tell apart, m; 0 where it stores fractions.
    pub step_m: f32,
}

/// Turns values into metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// The value of the lowest height.
    pub black: f64,
    /// That height, m.
    pub low_m: f64,
    /// Metres a value.
    pub per_value_m: f64,
    /// Metres between two neighbouring values.
    pub step_m: f64,
}

impl Scale {
    /// The height of a value; `NaN` where it stands for none. What is infinite stays so: the file says it by mistake.
    pub fn height(&self, value: f64) -> f32 {
        if value.is_infinite() {
            value as f32
        } else if value.is_finite() && value > NO_HEIGHT {
            (self.low_m + (value - self.black) * self.per_value_m) as f32
        } else {
            f32::NAN
        }
    }
}

/// What a reader needs of a file.
pub(super) trait Input: BufRead + Seek {}
impl<T: BufRead + Seek> Input for T {}

/// An open file.
pub(super) struct Source {
    name: String,
    length: u64,
    input: Box<dyn Input>,
}

impl Source {
    /// Bytes under a name.
    pub fn bytes(name: &str, bytes: impl AsRef<[u8]> + 'static) -> Self {
        let length = bytes.as_ref().len() as u64;
        Self { name: name.to_owned(), length, input: Box::new(Cursor::new(bytes)) }
    }
}

/// Opens a file or a sample.
pub(super) fn open(path: &str) -> Result<Source, Problem> {
    if let Some(name) = path.strip_prefix("sample:") {
        let bytes = crate::world::sample(name).map_err(|e| Problem::Disk(e.to_string()))?;
        return Ok(Source::bytes(path, bytes));
    }
    let disk = |e: io::Error| Problem::Disk(e.to_string());
    let file = File::open(path).map_err(disk)?;
    let about = file.metadata().map_err(disk)?;
    // A pipe or a device has no length to check a size against.
    if !about.is_file() {
        return Err(Problem::Disk("it is not a file".to_owned()));
    }
    Ok(Source { name: path.to_owned(), length: about.len(), input: Box::new(BufReader::new(file)) })
}

/// Which format it is, and what its header says; a size that no map can have is refused here.
pub(super) fn header(source: &mut Source, params: &ImportParams) -> Result<Header, Problem> {
    if source.length == 0 {
        return Err(Problem::Empty);
    }
    let format = sniff::format(source, params.format)?;
    rewind(source)?;
    let (input, length) = (&mut *source.input, source.length);
    match format {
        Format::Png => png::header(input, length),
        Format::Tiff => tiff::header(input, length),
        Format::Exr => exr::header(input, length),
        Format::Raw16 | Format::Raw32 => raw::header(format, length, params.size),
        Format::Asc => asc::header(input, length),
        Format::Hgt => hgt::header(&source.name, length),
    }
}

/// The heights of a file with this header.
pub(super) fn heights(
    source: &mut Source,
    header: &Header,
    scale: &Scale,
    params: &ImportParams,
) -> Result<Heightmap, Problem> {
    rewind(source)?;
    let input = &mut *source.input;
    let mut heights = match header.format {
        Format::Png => png::heights(input, header, scale),
        Format::Tiff => tiff::heights(input, header, scale),
        Format::Exr => exr::heights(input, header, scale),
        Format::Raw16 | Format::Raw32 => raw::heights(input, header, scale, params.endian),
        Format::Asc => asc::heights(input, header, scale),
        Format::Hgt => hgt::heights(input, header, scale),
    }?;
    if heights.len() != header.width * header.height {
        return Err(Problem::Truncated);
    }
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for &v in heights.iter().filter(|v| v.is_finite()) {
        (low, high) = (low.min(v), high.max(v));
    }
    // Of heights that land can have, some overflow in single precision as well.
    let infinite = heights.iter().filter(|v| v.is_infinite()).count();
    heights.iter_mut().filter(|v| v.is_infinite()).for_each(|v| *v = f32::NAN);
    if low < -ABSURD_M || high > ABSURD_M {
        return Err(Problem::Absurd(low, high));
    }
    heights.shrink_to_fit();
    Ok(Heightmap {
        width: header.width,
        height: header.height,
        heights,
        filled: 0,
        infinite,
        step_m: scale.step_m as f32,
    })
}

fn rewind(source: &mut Source) -> Result<(), Problem> {
    source.input.seek(SeekFrom::Start(0)).map(|_| ()).map_err(io_problem)
}

/// A size that a map can have, of a file long enough to hold it when a byte of it stands for at most `expansion` bytes.
fn checked(width: u64, height: u64, bytes_each: u64, length: u64, expansion: u64) -> Result<(usize, usize), Problem> {
    if width > MOST_SIDE || height > MOST_SIDE {
        return Err(Problem::TooLarge(width, height));
    }
    if width < 2 || height < 2 {
        return Err(Problem::TooSmall(width, height));
    }
    if width * height * bytes_each > length.saturating_mul(expansion) {
        return Err(Problem::Truncated);
    }
    Ok((width as usize, height as usize))
}

fn io_problem(error: io::Error) -> Problem {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => Problem::Truncated,
        _ => Problem::Disk(error.to_string()),
    }
}

/// A decoder's words in one short line.
fn damaged(cause: impl std::fmt::Display) -> Problem {
    let text = cause.to_string();
    let line: String = text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(160).collect();
    Problem::Damaged(line)
}

/// Luminance of linear red, green and blue (Rec. 709); gray stays exactly what it is.
fn luminance(r: f64, g: f64, b: f64) -> f64 {
    if r == g && g == b { r } else { 0.2126 * r + 0.7152 * g + 0.0722 * b }
}

/// Rows of values of `bytes_each` bytes, one row in memory at a time.
fn rows(
    input: &mut dyn Input,
    header: &Header,
    bytes_each: usize,
    value: impl Fn(&[u8]) -> f32,
) -> Result<Vec<f32>, Problem> {
    let mut out = Vec::with_capacity(header.width * header.height);
    let mut row = vec![0u8; header.width * bytes_each];
    for _ in 0..header.height {
        input.read_exact(&mut row).map_err(io_problem)?;
        out.extend(row.chunks_exact(bytes_each).map(&value));
    }
    Ok(out)
}
