//! TIFF: whole numbers of 8 to 32 bits and fractions, gray or colour; GeoTIFF's cell size and GDAL's mark of no data.
//!
//! Without GeoTIFF's tags, whole numbers from 0 are levels between black and white; with them, or where they are signed,
//! they are metres.

use std::io::SeekFrom;

use ::tiff::{
    ColorType, TiffError, TiffUnsupportedError,
    decoder::{Decoder, DecodingResult, Limits},
    tags::{SampleFormat, Tag},
};

use super::{DEGREE_M, Format, Header, Input, MOST_SIDE, Sample, Scale, checked, damaged, io_problem, luminance};
use crate::edit::Problem;

/// LZW makes at most about 2700 bytes of one: its longest word of 4094 bytes takes 12 bits.
const EXPANSION: u64 = 2732;
/// Most bytes of one directory entry: the offsets of the strips of the tallest picture, twice over.
const ENTRY_BYTES: usize = 1 << 20;
/// Most bytes of one strip or tile as it stands in the file.
const STRIP_BYTES: usize = 1 << 30;
/// Most bytes of a picture's values: the largest map in 32-bit values, or in colour with 8.
const PICTURE_BYTES: u64 = MOST_SIDE * MOST_SIDE * 4;
/// What stands for no height where a file does not declare it: no land is that deep, or exactly that deep in fractions.
const VOIDS: [f64; 3] = [-32768.0, -32767.0, -9999.0];

/// GDAL's own tag: items of metadata as XML.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

// Keys of GeoTIFF's directory (OGC 19-008), and the codes used here.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
const LINEAR_UNITS: u16 = 3076;
const FEET_M: [(u16, f64); 2] = [(9002, 0.3048), (9003, 1200.0 / 3937.0)];

type Tiff<'a> = Decoder<&'a mut dyn Input>;

pub(super) fn header(input: &mut dyn Input, length: u64) -> Result<Header, Problem> {
    let mut tiff = open(input)?;
    let (width, height) = tiff.dimensions().map_err(problem)?;
    let channels = channels(tiff.colortype().map_err(problem)?)?.0 as u64;
    let sample = sample(&mut tiff)?;
    let bytes = channels * (sample.bits() as u64).div_ceil(8);
    let (width, height) = checked(width as u64, height as u64, bytes, length, EXPANSION)?;
    let cell_m = cell_m(&mut tiff, height)?;
    let georeferenced = cell_m.is_some() || tiff.find_tag(Tag::GeoKeyDirectoryTag).map_err(problem)?.is_some();
    let line = line(&mut tiff)?;
    let metres = georeferenced || line.is_some() || !matches!(sample, Sample::Whole(_));
    Ok(Header { format: Format::Tiff, width, height, cell_m, sample, metres, line })
}

pub(super) fn heights(input: &mut dyn Input, header: &Header, scale: &Scale) -> Result<Vec<f32>, Problem> {
    let mut tiff = open(input)?;
    let (channels, alpha) = channels(tiff.colortype().map_err(problem)?)?;
    let declared = no_data(&mut tiff)?;
    let voids = match header.sample {
        Sample::Whole(_) => &[],
        Sample::Signed(_) => &VOIDS[..2],
        Sample::Fraction(_) => &VOIDS[..],
    };
    let void = |value: f64| declared.map_or_else(|| voids.contains(&value), |declared| value == declared);
    let cells = header.width * header.height;
    let mut values = tiff.read_image().map_err(problem)?;
    // Planes one after the other: the decoder gives the first alone.
    let count = values.as_buffer(0).as_bytes().len() / (header.sample.bits() as usize).div_ceil(8);
    let channels = if count == cells { 1 } else { channels };
    let pixel = |at: &dyn Fn(usize) -> f64| {
        let hidden = alpha && channels > 1 && at(channels - 1) == 0.0;
        let gray = if channels >= 3 { luminance(at(0), at(1), at(2)) } else { at(0) };
        if hidden || void(gray) { f32::NAN } else { scale.height(gray) }
    };
    fn each<T: Copy>(
        values: &[T],
        channels: usize,
        to: impl Fn(T) -> f64,
        pixel: impl Fn(&dyn Fn(usize) -> f64) -> f32,
    ) -> Vec<f32> {
        values.chunks_exact(channels).map(|c| pixel(&|i| to(c[i.min(c.len() - 1)]))).collect()
    }
    Ok(match &values {
        DecodingResult::U8(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::U16(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::U32(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::I8(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::I16(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::I32(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::F32(v) => each(v, channels, |v| v as f64, pixel),
        DecodingResult::F64(v) => each(v, channels, |v| v, pixel),
        DecodingResult::F16(v) => each(v, channels, |v| v.to_f64(), pixel),
        DecodingResult::U64(_) | DecodingResult::I64(_) => return Err(unsupported("64-bit whole numbers")),
    })
}

fn open(input: &mut dyn Input) -> Result<Tiff<'_>, Problem> {
    // What the file says of its strips is believed no further than its length can be worth.
    let length = input.seek(SeekFrom::End(0)).map_err(io_problem)?;
    input.rewind().map_err(io_problem)?;
    let worth = (length.saturating_mul(EXPANSION)).clamp(1 << 20, PICTURE_BYTES) as usize;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = worth;
    limits.intermediate_buffer_size = worth.min(STRIP_BYTES);
    limits.ifd_value_size = ENTRY_BYTES;
    let mut tiff = Decoder::new(input).map_err(problem)?.with_limits(limits);
    // The decoder makes room for what a strip claims to be before it reads it.
    for tag in [Tag::StripByteCounts, Tag::TileByteCounts] {
        let bytes =
            tiff.find_tag(tag).map_err(problem)?.map(|value| value.into_u64_vec()).transpose().map_err(problem)?;
        if bytes.is_some_and(|bytes| bytes.iter().any(|&bytes| bytes > length)) {
            return Err(damaged("a part of it is said to be longer than the file"));
        }
    }
    for tag in [Tag::TileWidth, Tag::TileLength] {
        let side = tiff.find_tag(tag).map_err(problem)?.map(|value| value.into_u64()).transpose().map_err(problem)?;
        if side.is_some_and(|side| side > MOST_SIDE) {
            return Err(damaged("its tiles are too large"));
        }
    }
    Ok(tiff)
}

fn unsupported(what: &str) -> Problem {
    Problem::Unsupported(format!(
        "a TIFF of {what} is not read; save it as gray, 16-bit or 32-bit float, uncompressed or with deflate or LZW"
    ))
}

/// Channels a pixel, and whether the last says how opaque it is.
fn channels(colour: ColorType) -> Result<(usize, bool), Problem> {
    match colour {
        ColorType::Gray(_) => Ok((1, false)),
        ColorType::GrayA(_) => Ok((2, true)),
        ColorType::RGB(_) => Ok((3, false)),
        ColorType::RGBA(_) => Ok((4, true)),
        // A band of its own for each quantity: the first holds the heights, and two are no colour.
        ColorType::Multiband { num_samples: 1, .. } => Ok((1, false)),
        ColorType::Multiband { num_samples: 2, .. } => Ok((2, false)),
        other => Err(unsupported(&format!("{other:?}"))),
    }
}

fn sample(tiff: &mut Tiff) -> Result<Sample, Problem> {
    let bits = match tiff.colortype().map_err(problem)? {
        ColorType::Gray(bits) | ColorType::GrayA(bits) | ColorType::RGB(bits) | ColorType::RGBA(bits) => bits,
        ColorType::Multiband { bit_depth, .. } => bit_depth,
        other => return Err(unsupported(&format!("{other:?}"))),
    };
    let formats = tiff.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(problem)?;
    let format = formats.and_then(|list| list.first().copied()).unwrap_or(SampleFormat::Uint.to_u16());
    match (SampleFormat::from_u16(format), bits) {
        (Some(SampleFormat::Uint), 8 | 16 | 32) => Ok(Sample::Whole(bits)),
        (Some(SampleFormat::Int), 8 | 16 | 32) => Ok(Sample::Signed(bits)),
        (Some(SampleFormat::IEEEFP), 16 | 32 | 64) => Ok(Sample::Fraction(bits)),
        _ => Err(unsupported(&format!("{bits}-bit values of this kind"))),
    }
}

/// The value that GDAL marks as no data.
fn no_data(tiff: &mut Tiff) -> Result<Option<f64>, Problem> {
    let Some(value) = tiff.find_tag(Tag::GdalNodata).map_err(problem)? else { return Ok(None) };
    let text = value.into_string().map_err(problem)?;
    Ok(text.trim_matches(['\0', ' ', '\n']).parse().ok())
}

/// GDAL's offset and scale of the first band, where they are stated.
fn line(tiff: &mut Tiff) -> Result<Option<[f64; 2]>, Problem> {
    let Some(value) = tiff.find_tag(GDAL_METADATA).map_err(problem)? else { return Ok(None) };
    let text = value.into_string().map_err(problem)?;
    let number = |role: &str| {
        let items = text.split("<Item").filter_map(|item| item.split_once("</Item>")?.0.split_once('>'));
        let (quoted, first) =
            (format!("role=\"{role}\""), |head: &str| !head.contains("sample=") || head.contains("sample=\"0\""));
        let mut own = items.filter(|(head, _)| head.contains(&quoted) && first(head));
        own.find_map(|(_, text)| text.trim().parse::<f64>().ok()).filter(|v| v.is_finite())
    };
    let (offset, scale) = (number("offset"), number("scale").filter(|scale| *scale != 0.0));
    Ok((offset.is_some() || scale.is_some()).then(|| [offset.unwrap_or(0.0), scale.unwrap_or(1.0)]))
}

/// A cell's size by GeoTIFF's tags; degrees become metres in the middle of the map.
fn cell_m(tiff: &mut Tiff, height: usize) -> Result<Option<[f64; 2]>, Problem> {
    let mut numbers = |tag: Tag| -> Result<Vec<f64>, Problem> {
        let value = tiff.find_tag(tag).map_err(problem)?;
        value.map_or(Ok(Vec::new()), |value| value.into_f64_vec().map_err(problem))
    };
    let pixel_scale = numbers(Tag::ModelPixelScaleTag)?;
    let tie = numbers(Tag::ModelTiepointTag)?;
    let matrix = numbers(Tag::ModelTransformationTag)?;
    let half = 0.5 * height as f64;
    let (x, y, middle_y) = if let [x, y, ..] = pixel_scale[..] {
        // A tie point is i, j, k in the picture and x, y, z on the map.
        let middle = if let [_, j, _, _, north, ..] = tie[..] { north - y * (half - j) } else { 0.0 };
        (x.abs(), y.abs(), middle)
    } else if matrix.len() >= 8 {
        let length = |a: f64, b: f64| libm::hypot(a, b);
        (length(matrix[0], matrix[4]), length(matrix[1], matrix[5]), matrix[7] + matrix[5] * half)
    } else {
        return Ok(None);
    };
    let keys = tiff.find_tag_unsigned_vec::<u16>(Tag::GeoKeyDirectoryTag).map_err(problem)?.unwrap_or_default();
    // Four numbers an entry after a first one about the directory: key, where, how many, value.
    let key = |wanted: u16| keys.chunks_exact(4).skip(1).find(|e| e[0] == wanted && e[1] == 0).map(|e| e[3]);
    let cell = if key(MODEL_TYPE) == Some(GEOGRAPHIC) {
        [x * DEGREE_M * libm::cos(middle_y.clamp(-89.0, 89.0).to_radians()), y * DEGREE_M]
    } else {
        let unit = FEET_M.iter().find(|(code, _)| key(LINEAR_UNITS) == Some(*code)).map_or(1.0, |(_, m)| *m);
        [x * unit, y * unit]
    };
    Ok(cell.iter().all(|c| c.is_finite() && *c > 0.0).then_some(cell))
}

fn problem(error: TiffError) -> Problem {
    match error {
        TiffError::IoError(error) => io_problem(error),
        TiffError::UnsupportedError(TiffUnsupportedError::UnsupportedCompressionMethod(method)) => {
            unsupported(&format!("compression {method:?}"))
        }
        TiffError::UnsupportedError(what) => {
            Problem::Unsupported(format!("{what}; save it as gray, 16-bit or 32-bit float"))
        }
        TiffError::LimitsExceeded => damaged("it asks for more memory than a picture needs"),
        error => damaged(error),
    }
}
