//! A picture of a world that is on disk.

use std::path::{Path, PathBuf};

use image::{
    ExtendedColorType, ImageEncoder,
    codecs::{jpeg, png},
};

use crate::{
    export,
    recipe::nearest,
    relief,
    world::{
        Layer, World,
        store::{self, Provenance, said},
    },
};

use super::{JobError, STORE};

/// Fine lines and letters stay clean.
const JPEG_QUALITY: u8 = 92;

/// A picture to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The world's folder, or the store in it.
    pub world: PathBuf,
    /// The picture.
    pub file: PathBuf,
    /// `relief`, or a layer's name.
    pub view: String,
    /// Plate borders and motions over it.
    pub overlay: bool,
    /// Smoke over the relief, where a vent erupts.
    pub smoke: bool,
}

/// Reads a world from its folder, or from the store in it.
pub fn open_world(path: &Path) -> Result<(World, Provenance), JobError> {
    let inner = path.join(STORE);
    if !path.exists() {
        return Err(JobError::Refused(format!("{}: there is no such world", path.display())));
    }
    Ok(store::read(if inner.is_dir() { &inner } else { path })?)
}

/// Draws a view of a world.
pub fn render(picture: &Picture) -> Result<PathBuf, JobError> {
    check_picture(&picture.file)?;
    let view = view(&picture.view)?;
    let (world, provenance) = open_world(&picture.world)?;
    if let relief::View::Layer(layer) = view
        && !world.viewable().contains(&layer)
    {
        let there: Vec<_> = world.viewable().iter().map(|layer| layer.name()).collect();
        let what = format!("this world has no layer '{}' (it has: {})", layer.name(), there.join(", "));
        return Err(JobError::Refused(format!("--view {}: {what}", picture.view)));
    }
    let options = relief::Options {
        overlay: picture.overlay,
        smoke: picture.smoke,
        title: Some(provenance.name),
        ..Default::default()
    };
    write_picture(&relief::map(&world, &view, &options)?, &picture.file)?;
    Ok(picture.file.clone())
}

pub(crate) fn view(name: &str) -> Result<relief::View, JobError> {
    if name == "relief" {
        return Ok(relief::View::Relief);
    }
    let names = || Layer::ALL.iter().map(|layer| layer.name()).chain(["relief"]);
    Layer::from_name(name).map(relief::View::Layer).ok_or_else(|| {
        let hint = match nearest(name, names()) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!("there are: {}", names().collect::<Vec<_>>().join(", ")),
        };
        JobError::Refused(format!("--view {name}: neither 'relief' nor a layer ({hint})"))
    })
}

/// Writes a picture, whole or not at all.
pub(crate) fn write_png(picture: &image::RgbImage, path: &Path) -> Result<(), JobError> {
    Ok(export::write_whole(path, |file| {
        png::PngEncoder::new_with_quality(file, png::CompressionType::Default, png::FilterType::Adaptive)
            .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
            .map_err(|e| export::ExportError::Encode { path: path.to_owned(), cause: e.to_string() })
    })?)
}

/// Writes a picture as its name's ending says, whole or not at all.
pub(crate) fn write_picture(picture: &image::RgbImage, path: &Path) -> Result<(), JobError> {
    if !is_jpeg(path) {
        return write_png(picture, path);
    }
    Ok(export::write_whole(path, |file| {
        jpeg::JpegEncoder::new_with_quality(file, JPEG_QUALITY)
            .write_image(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
            .map_err(|e| export::ExportError::Encode { path: path.to_owned(), cause: e.to_string() })
    })?)
}

fn has_ending(file: &Path, endings: &[&str]) -> bool {
    file.extension().is_some_and(|end| endings.iter().any(|known| end.eq_ignore_ascii_case(known)))
}

fn is_jpeg(file: &Path) -> bool {
    has_ending(file, &["jpg", "jpeg"])
}

/// Refuses early a picture that could not be written at the end.
pub(crate) fn check_picture(file: &Path) -> Result<(), JobError> {
    if !is_jpeg(file) && !has_ending(file, &["png"]) {
        let what = "pictures are written as PNG or JPEG; give the name the ending .png or .jpg";
        return Err(JobError::Refused(format!("{}: {what}", file.display())));
    }
    check_place(file)
}

/// Refuses early a place where nothing could be written at the end.
pub(crate) fn check_place(file: &Path) -> Result<(), JobError> {
    let shown = file.display();
    let refuse = |what: String| Err(JobError::Refused(format!("{shown}: {what}")));
    if file.is_dir() {
        return refuse("this is a folder".into());
    }
    match file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) if !folder.is_dir() => refuse(format!("there is no folder '{}'", folder.display())),
        _ => match std::fs::OpenOptions::new().append(true).open(file) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => refuse(format!("cannot be written: {}", said(&e))),
            _ => Ok(()),
        },
    }
}
