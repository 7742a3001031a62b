//! Files for other programs: one format a file here.
//!
//! | ending | holds | written by |
//! |---|---|---|
//! | `.png` | heights, layers, normals, weights: gray or colour, 16 or 8 bits | [`raster`] |
//! | `.tif` | a layer with its place in metres (GeoTIFF), 32-bit floating point or 16 bits | [`raster`] |
//! | `.exr` | a layer or normals, 32-bit floating point | [`raster`] |
//! | `.asc` | a layer as text (ESRI ASCII grid) | [`raster`] |
//! | `.r16 .raw .r32` | a layer as bare numbers | [`raster`] |
//! | `.glb` `.obj` `.stl` | the ground as a mesh | [`write_mesh`] |
//! | `.geojson` `.svg` | coast, contours, rivers, lakes, plates as lines and polygons | [`write_vector`] |
//! | films | pictures in time order | [`video`] |
//!
//! A file is written beside its place and moved there when it is whole. This room reads worlds and never changes them.

pub mod engine;
mod height_png;
mod mesh;
mod normals;
pub mod raster;
mod staged;
mod vector;
pub mod video;
mod weights;

pub use height_png::{HeightRange, write_height_png, write_height_png_within};
pub use mesh::{MESH_FORMATS, MESH_SIDES, MeshFormat, MeshOptions, write_glb, write_mesh, write_obj, write_stl};
pub use normals::{Green, encoded as encoded_normal, normals};
pub use staged::Staged;
pub use vector::{VECTOR_FORMATS, VectorFormat, VectorOptions, write_vector};
pub use weights::{MATERIALS, WeightRules};

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The disk refused.
    #[error("{path}: {cause}")]
    Disk {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// What is written to took no more.
    #[error("cannot write: {0}")]
    Stream(#[from] io::Error),
    /// The file could not be encoded.
    #[error("{path}: cannot write this file: {cause}")]
    Encode {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        cause: String,
    },
    /// A film was asked for that cannot be made.
    #[error("{0}")]
    FilmRequest(String),
    /// A film could not be finished.
    #[error("{path}: {cause}")]
    Film {
        /// The film.
        path: PathBuf,
        /// What went wrong, in the words of whoever made it.
        cause: String,
    },
    /// A layer holds a value that is not a number.
    #[error("{layer} is not finite at cell ({x}, {y})")]
    NotFinite {
        /// The layer.
        layer: &'static str,
        /// Column of the cell.
        x: usize,
        /// Row of the cell.
        y: usize,
    },
}

/// Where a file stands until it is whole.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.partial-{}", std::process::id()))
}

/// Lets `fill` write a file beside `path`, and moves it there when it is whole.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let disk = |cause| ExportError::Disk { path: path.to_owned(), cause };
    let beside = beside(path);
    let written = File::create(&beside).map_err(disk).and_then(|file| {
        let mut file = BufWriter::new(file);
        fill(&mut file)?;
        file.flush().map_err(disk)?;
        fs::rename(&beside, path).map_err(disk)
    });
    if written.is_err() {
        // The first error matters; there may be nothing to clean up.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Writes a picture as a PNG.
pub fn write_picture(picture: &image::RgbImage, path: &Path) -> Result<(), ExportError> {
    use image::{ExtendedColorType, ImageEncoder, codecs::png};
    write_whole(path, |file| {
        png::PngEncoder::new_with_quality(file, png::CompressionType::Fast, png::FilterType::Adaptive)
            .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
            .map_err(|e| ExportError::Encode { path: path.to_owned(), cause: e.to_string() })
    })
}
