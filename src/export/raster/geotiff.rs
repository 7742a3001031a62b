//! TIFF with GeoTIFF 1.1 tags: a projected system of its own in metres, eastings and northings counted from the map's
//! south-west corner.

use tiff::{
    encoder::{Compression, DeflateLevel, Predictor, TiffEncoder, TiffValue, colortype},
    tags::Tag,
};

use super::{Layout, Out, Raster, Samples, Sampling};

/// What programs show as the name of the system.
const CITATION: &str = "Upthrust local metric grid|";

pub(super) fn encode(raster: &Raster, _: Layout, out: &mut Out) -> Result<(), String> {
    if raster.channels != 1 {
        return Err("GeoTIFF is written for one quantity".into());
    }
    match &raster.samples {
        Samples::U16(values) => write::<colortype::Gray16>(raster, values, Predictor::Horizontal, out),
        Samples::F32(values) => write::<colortype::Gray32Float>(raster, values, Predictor::None, out),
        Samples::U8(values) => write::<colortype::Gray8>(raster, values, Predictor::Horizontal, out),
    }
    .map_err(|e| e.to_string())
}

fn write<C: colortype::ColorType>(
    raster: &Raster,
    values: &[C::Inner],
    predictor: Predictor,
    out: &mut Out,
) -> tiff::TiffResult<()>
where
    [C::Inner]: TiffValue,
{
    let lattice = &raster.lattice;
    let mut tiff =
        TiffEncoder::new(out)?.with_compression(Compression::Deflate(DeflateLevel::Fast)).with_predictor(predictor);
    let mut image = tiff.new_image::<C>(lattice.width as u32, lattice.height as u32)?;
    let tags = image.encoder();
    let north_m = lattice.map_height_m - lattice.corner_m[1];
    tags.write_tag(Tag::ModelPixelScaleTag, &[lattice.spacing_m, lattice.spacing_m, 0.0][..])?;
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, lattice.corner_m[0], north_m, 0.0][..])?;
    tags.write_tag(Tag::GeoKeyDirectoryTag, &keys(lattice.sampling)[..])?;
    tags.write_tag(Tag::GeoAsciiParamsTag, CITATION)?;
    image.write_data(values)
}

/// The key directory: version 1.1.1, six keys of (number, where its value lies, count, value).
fn keys(sampling: Sampling) -> Vec<u16> {
    const ASCII_PARAMS: u16 = 34737;
    const USER_DEFINED: u16 = 32767;
    let raster_type = if sampling == Sampling::Cells { 1 } else { 2 };
    let length = CITATION.len() as u16;
    [
        [1, 1, 1, 6],
        [1024, 0, 1, 1],                 // GTModelType: projected
        [1025, 0, 1, raster_type],       // GTRasterType: 1 pixel is area, 2 pixel is point
        [1026, ASCII_PARAMS, length, 0], // GTCitation
        [3072, 0, 1, USER_DEFINED],      // ProjectedCRS
        [3073, ASCII_PARAMS, length, 0], // ProjectedCitation
        [3076, 0, 1, 9001],              // ProjLinearUnits: metre
    ]
    .concat()
}
