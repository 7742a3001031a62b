//! PNG: gray, colour, and colour with alpha, in 8 or 16 bits.

use super::{Layout, Out, Raster, Samples};

pub(in crate::export) fn encode(raster: &Raster, _: Layout, out: &mut Out) -> Result<(), String> {
    let swapped: Vec<u8>;
    let (bytes, depth): (&[u8], _) = match &raster.samples {
        Samples::U8(samples) => (samples, png::BitDepth::Eight),
        Samples::U16(samples) => {
            swapped = samples.iter().flat_map(|v| v.to_be_bytes()).collect();
            (&swapped, png::BitDepth::Sixteen)
        }
        Samples::F32(_) => return Err("PNG holds whole numbers only".into()),
    };
    let color = match raster.channels {
        1 => png::ColorType::Grayscale,
        3 => png::ColorType::Rgb,
        4 => png::ColorType::Rgba,
        other => return Err(format!("PNG has no pictures of {other} channels")),
    };
    let mut encoder = png::Encoder::new(out, raster.lattice.width as u32, raster.lattice.height as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Up);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(bytes).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())
}
