//! OpenEXR: one channel of fractions as heights (`Y`, `Z`, `height`, or the only one), or the luminance of R, G and B.

use ::exr::{
    error::Error,
    meta::{MetaData, header::Header as Part},
    prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, read},
};

use super::{Format, Header, Input, MOST_SIDE, Sample, Scale, checked, damaged, io_problem, luminance};
use crate::edit::Problem;

/// Names that programs give the channel of heights, the likeliest first.
const NAMES: [&str; 6] = ["Y", "Z", "height", "Height", "depth", "V"];
/// Pieces of a file (tiles, blocks of rows) at most: one for each row of 64 narrow parts.
const MOST_PIECES: usize = 1 << 20;
/// Zip makes at most 1032 bytes of one; the wavelet and 24-bit codecs stay below that.
const EXPANSION: u64 = 1032;

/// Which channels become heights.
enum Pick {
    One(String),
    Colours,
}

pub(super) fn header(input: &mut dyn Input, length: u64) -> Result<Header, Problem> {
    let parts = MetaData::read_from_buffered(input, false).map_err(problem)?.headers;
    for part in &parts {
        let (w, h) = (part.layer_size.0 as u64, part.layer_size.1 as u64);
        if w > MOST_SIDE || h > MOST_SIDE {
            return Err(Problem::TooLarge(w, h));
        }
        if part.chunk_count > MOST_PIECES {
            return Err(damaged("it is cut into too many pieces"));
        }
    }
    let part = parts.first().ok_or_else(|| damaged("it has no picture"))?;
    if part.deep {
        return Err(Problem::Unsupported("deep pictures are not read; save it as a flat one".to_owned()));
    }
    pick(part)?;
    let (width, height) = (part.layer_size.0 as u64, part.layer_size.1 as u64);
    let (width, height) = checked(width, height, 2, length, EXPANSION)?;
    Ok(Header {
        format: Format::Exr,
        width,
        height,
        cell_m: None,
        sample: Sample::Fraction(32),
        metres: true,
        line: None,
    })
}

fn pick(part: &Part) -> Result<Pick, Problem> {
    let names: Vec<String> = part.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let has = |name: &str| names.iter().any(|have| have == name);
    if let Some(name) = NAMES.iter().find(|name| has(name)) {
        return Ok(Pick::One((*name).to_owned()));
    }
    if ["R", "G", "B"].iter().all(|name| has(name)) {
        return Ok(Pick::Colours);
    }
    match names.as_slice() {
        [only] => Ok(Pick::One(only.clone())),
        _ => Err(Problem::Unsupported(format!(
            "which channel is the height? it has {}; name one of them Y",
            names.join(", ").chars().take(80).collect::<String>()
        ))),
    }
}

pub(super) fn heights(input: &mut dyn Input, header: &Header, scale: &Scale) -> Result<Vec<f32>, Problem> {
    let parts = MetaData::read_from_buffered(&mut *input, false).map_err(problem)?.headers;
    let pick = pick(parts.first().ok_or_else(|| damaged("it has no picture"))?)?;
    input.rewind().map_err(io_problem)?;
    let (width, cells, scale) = (header.width, header.width * header.height, *scale);
    let start = move |size: ::exr::math::Vec2<usize>| vec![f32::NAN; (size.0 * size.1).min(cells)];
    let put = move |heights: &mut Vec<f32>, at: ::exr::math::Vec2<usize>, value: f64| {
        if let Some(height) = heights.get_mut(at.1 * width + at.0) {
            *height = scale.height(value);
        }
    };
    let flat = || read().no_deep_data().largest_resolution_level().specific_channels();
    match pick {
        Pick::One(name) => {
            let channels = flat().required(name.as_str());
            let image = channels
                .collect_pixels(
                    move |size, _: &_| start(size),
                    move |to: &mut Vec<f32>, at, (v,): (f32,)| put(to, at, v as f64),
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(input)
                .map_err(problem)?;
            Ok(image.layer_data.channel_data.pixels)
        }
        Pick::Colours => {
            let channels = flat().required("R").required("G").required("B");
            let image = channels
                .collect_pixels(
                    move |size, _: &_| start(size),
                    move |to: &mut Vec<f32>, at, (r, g, b): (f32, f32, f32)| {
                        put(to, at, luminance(r as f64, g as f64, b as f64));
                    },
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(input)
                .map_err(problem)?;
            Ok(image.layer_data.channel_data.pixels)
        }
    }
}

fn problem(error: Error) -> Problem {
    match error {
        Error::Io(error) => io_problem(error),
        Error::NotSupported(what) => Problem::Unsupported(format!("this kind of OpenEXR is not read: {what}")),
        error => damaged(error),
    }
}
