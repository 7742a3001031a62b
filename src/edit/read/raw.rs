//! Raw values without a header: 16-bit whole numbers between black and white, or 32-bit fractions in metres.

use super::{Format, Header, Input, Sample, Scale, checked, rows};
use crate::edit::{Endian, Problem};

pub(super) fn header(format: Format, length: u64, size: Option<[u32; 2]>) -> Result<Header, Problem> {
    let (bytes, sample) = match format {
        Format::Raw32 => (4, Sample::Fraction(32)),
        _ => (2, Sample::Whole(16)),
    };
    let values = length / bytes;
    let [width, height] = match size {
        Some(size) => size.map(u64::from),
        None => [values.isqrt(); 2],
    };
    if width * height * bytes != length {
        let bits = 8 * bytes;
        return Err(Problem::Length(match size {
            Some(_) => {
                let wanted = width * height * bytes;
                format!("size = [{width}, {height}] of {bits}-bit values are {wanted} bytes, but the file has {length}")
            }
            None => format!("{length} bytes are no square of {bits}-bit values; state its size = [width, height]"),
        }));
    }
    let (width, height) = checked(width, height, bytes, length, 1)?;
    Ok(Header { format, width, height, cell_m: None, sample, metres: format == Format::Raw32, line: None })
}

pub(super) fn heights(
    input: &mut dyn Input,
    header: &Header,
    scale: &Scale,
    endian: Endian,
) -> Result<Vec<f32>, Problem> {
    let big = endian == Endian::Big;
    match header.format {
        Format::Raw32 => rows(input, header, 4, |b| {
            let bytes = [b[0], b[1], b[2], b[3]];
            let value = if big { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) };
            scale.height(value as f64)
        }),
        _ => rows(input, header, 2, |b| {
            let bytes = [b[0], b[1]];
            let value = if big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) };
            scale.height(value as f64)
        }),
    }
}
