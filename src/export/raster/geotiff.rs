//! TIFF with GeoTIFF 1.1 tags: a projected system of its own in metres, eastings and northings counted from the map's
//! south-west corner. Whole numbers come with GDAL's scale and offset, by which they are metres again.

use tiff::{
    encoder::{Compression, DeflateLevel, Predictor, TiffEncoder, TiffValue, colortype},
    tags::Tag,
};

use super::{Layout, Levels, Out, Raster, Samples, Sampling};

/// GDAL's own tag: items of metadata as XML.
const GDAL_METADATA: Tag = Tag::Unknown(42112);
/// What programs show as the name of the system.
const CITATION: &str = "Upthrust local metric grid|";

pub(super) fn encode(raster: &Raster, _: Layout, out: &mut Out) -> Result<(), String> {
    if raster.channels != 1 {
        return Err("GeoTIFF is written for one quantity".into());
    }
    match &raster.samples {
        Samples::U16(values) => write::<colortype::Gray16>(raster, values, Some(65535.0), out),
        Samples::F32(values) => write::<colortype::Gray32Float>(raster, values, None, out),
        Samples::U8(values) => write::<colortype::Gray8>(raster, values, Some(255.0), out),
    }
    .map_err(|e| e.to_string())
}

fn write<C: colortype::ColorType>(
    raster: &Raster,
    values: &[C::Inner],
    most: Option<f64>,
    out: &mut Out,
) -> tiff::TiffResult<()>
where
    [C::Inner]: TiffValue,
{
    let lattice = &raster.lattice;
    let predictor = if most.is_some() { Predictor::Horizontal } else { Predictor::None };
    let mut tiff =
        TiffEncoder::new(out)?.with_compression(Compression::Deflate(DeflateLevel::Fast)).with_predictor(predictor);
    let mut image = tiff.new_image::<C>(lattice.width as u32, lattice.height as u32)?;
    let tags = image.encoder();
    let north_m = lattice.map_height_m - lattice.corner_m[1];
    tags.write_tag(Tag::ModelPixelScaleTag, &[lattice.spacing_m, lattice.spacing_m, 0.0][..])?;
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, lattice.corner_m[0], north_m, 0.0][..])?;
    tags.write_tag(Tag::GeoKeyDirectoryTag, &keys(lattice.sampling)[..])?;
    tags.write_tag(Tag::GeoAsciiParamsTag, CITATION)?;
    if let Some((levels, most)) = raster.levels.zip(most) {
        tags.write_tag(GDAL_METADATA, &metadata(levels, most)[..])?;
    }
    image.write_data(values)
}

/// By what the numbers become the quantity again.
fn metadata(levels: Levels, most: f64) -> String {
    let item = |name: &str, value: f64| {
        format!("  <Item name=\"{}\" sample=\"0\" role=\"{name}\">{value}</Item>\n", name.to_uppercase())
    };
    let (offset, scale) = (item("offset", levels.black), item("scale", levels.span() / most));
    format!("<GDALMetadata>\n{offset}{scale}</GDALMetadata>\n")
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
