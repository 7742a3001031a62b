//! PNG: 8 and 16 bits, gray, colour or palette; where it is transparent, it has no height.

use ::png::{ColorType, Decoder, DecodingError, Limits, Reader, Transformations};

use super::{Format, Header, Input, Sample, Scale, checked, damaged, io_problem, luminance};
use crate::edit::Problem;

/// Deflate makes at most 1032 bytes of one.
const EXPANSION: u64 = 1032;
/// What the decoder may hold besides the picture: a row or two, and stray chunks.
const WORKING_BYTES: usize = 64 << 20;

pub(super) fn header(input: &mut dyn Input, length: u64) -> Result<Header, Problem> {
    let mut decoder = Decoder::new_with_limits(input, Limits { bytes: WORKING_BYTES });
    let info = decoder.read_header_info().map_err(problem)?;
    let (width, height) = (info.width as u64, info.height as u64);
    // The fewest bits a pixel has, for pictures of 1 to 4 bits; a row is whole bytes.
    let (width, height) = checked(width, height, 1, length, EXPANSION * 8)?;
    let bits = if info.bit_depth as u8 == 16 { 16 } else { 8 };
    Ok(Header {
        format: Format::Png,
        width,
        height,
        cell_m: None,
        sample: Sample::Whole(bits),
        metres: false,
        line: None,
    })
}

pub(super) fn heights(input: &mut dyn Input, header: &Header, scale: &Scale) -> Result<Vec<f32>, Problem> {
    let mut decoder = Decoder::new_with_limits(input, Limits { bytes: WORKING_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder.read_info().map_err(problem)?;
    let channels = match reader.output_color_type().0 {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
        ColorType::Indexed => return Err(damaged("its palette is missing")),
    };
    let wide = header.sample.bits() == 16;
    let row = |bytes: &[u8], out: &mut Vec<f32>| {
        let each = channels * if wide { 2 } else { 1 };
        out.extend(bytes.chunks_exact(each).take(header.width).map(|pixel| {
            let at = |c: usize| match wide {
                true => u16::from_be_bytes([pixel[2 * c], pixel[2 * c + 1]]) as f64,
                false => pixel[c] as f64,
            };
            let gray = if channels >= 3 { luminance(at(0), at(1), at(2)) } else { at(0) };
            let hidden = channels % 2 == 0 && at(channels - 1) == 0.0;
            if hidden { f32::NAN } else { scale.height(gray) }
        }));
    };
    if reader.info().interlaced { whole(&mut reader, header, row) } else { by_rows(&mut reader, header, row) }
}

fn by_rows(
    reader: &mut Reader<&mut dyn Input>,
    header: &Header,
    row: impl Fn(&[u8], &mut Vec<f32>),
) -> Result<Vec<f32>, Problem> {
    let mut out = Vec::with_capacity(header.width * header.height);
    while let Some(next) = reader.next_row().map_err(problem)? {
        row(next.data(), &mut out);
    }
    Ok(out)
}

/// An interlaced picture has no rows until all of it is there.
fn whole(
    reader: &mut Reader<&mut dyn Input>,
    header: &Header,
    row: impl Fn(&[u8], &mut Vec<f32>),
) -> Result<Vec<f32>, Problem> {
    let size = reader.output_buffer_size().ok_or(Problem::Truncated)?;
    let mut bytes = vec![0; size];
    reader.next_frame(&mut bytes).map_err(problem)?;
    let mut out = Vec::with_capacity(header.width * header.height);
    for line in bytes.chunks_exact(size / header.height) {
        row(line, &mut out);
    }
    Ok(out)
}

fn problem(error: DecodingError) -> Problem {
    match error {
        DecodingError::IoError(error) => io_problem(error),
        DecodingError::LimitsExceeded => damaged("it asks for more memory than a picture needs"),
        error => damaged(error),
    }
}
