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
//! | `.ply` `.csv` | particles or smoke at a moment, as points | [`Points`] |
//! | films | pictures in time order | [`video`] |
//!
//! A file is written beside its place and moved there when it is whole. This room reads worlds and never changes them.

pub mod engine;
mod height_png;
mod mesh;
mod normals;
mod points;
pub mod raster;
mod staged;
mod vector;
pub mod video;
mod weights;

pub use height_png::{HeightRange, write_height_png, write_height_png_within};
pub use mesh::{MESH_FORMATS, MESH_SIDES, MeshFormat, MeshOptions, write_glb, write_mesh, write_obj, write_stl};
pub use normals::{Green, encoded as encoded_normal, normals};
pub use points::{POINT_FORMATS, PointFormat, Points};
pub use staged::Staged;
pub use vector::{VECTOR_FORMATS, VectorFormat, VectorOptions, write_vector};
pub use weights::{MATERIALS, WeightRules};

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use crate::world::store::said;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The disk refused.
    #[error("{path}: {}", said(.cause))]
    Disk {
        /// The file.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// What is written to took no more.
    #[error("cannot write: {}", said(.0))]
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

/// Removes what a killed run of this program left beside `path`: files and folders named as [`beside`] names them, of
/// processes that are no more. Where the system cannot say who runs, nothing is touched.
fn sweep(path: &Path) {
    let processes = Path::new("/proc");
    if !processes.join("self").exists() {
        return;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = fs::read_dir(folder) else { return };
    let stems = [path.file_name(), path.file_stem()].map(|name| name.unwrap_or_default().to_string_lossy());
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let rest = stems.iter().find_map(|stem| name.strip_prefix(&format!(".{stem}.partial-")));
        let Some(rest) = rest else { continue };
        let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        let (process, ending) = rest.split_at(digits);
        let ours = !process.is_empty() && (ending.is_empty() || ending.starts_with('.'));
        if ours && !processes.join(process).exists() {
            // It may belong to somebody else; then it stays.
            let _ = match entry.file_type() {
                Ok(kind) if kind.is_dir() => fs::remove_dir_all(entry.path()),
                _ => fs::remove_file(entry.path()),
            };
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_run_left_is_swept_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("film.mp4");
        // No process has this number: Linux gives none above 2^22.
        let (gone, here) = (4_194_999u32, std::process::id());
        let left = [
            format!(".film.partial-{gone}.mp4"),
            format!(".film.mp4.partial-{gone}"),
            format!(".film.partial-{gone}.mp4.nut"),
        ];
        let kept = [
            format!(".film.partial-{here}.mp4"),
            format!(".other.partial-{gone}.mp4"),
            ".film.partial-x.mp4".into(),
            "film.mp4".into(),
        ];
        for name in left.iter().chain(&kept) {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        let pictures = folder.path().join(format!(".film.mp4.partial-{}", gone + 1));
        fs::create_dir(&pictures).unwrap();
        fs::write(pictures.join("00001.png"), "x").unwrap();
        sweep(&film);
        let there = |name: &String| folder.path().join(name).exists();
        assert!(kept.iter().all(there));
        if Path::new("/proc/self").exists() {
            assert!(!left.iter().any(there) && !pictures.exists());
        }
    }
}
