//! A picture of a world that is on disk.

use std::path::{Path, PathBuf};

use image::{
    ExtendedColorType, ImageEncoder,
    codecs::{jpeg, png},
};

use crate::{
    export, relief,
    world::{
        World,
        store::{self, Provenance, said},
    },
};

use super::{
    JobError, STORE,
    scene::{self, SceneRequest, View},
};

/// Fine lines and letters stay clean.
const JPEG_QUALITY: u8 = 92;

/// A picture to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The world's folder, or the store in it.
    pub world: PathBuf,
    /// The picture.
    pub file: PathBuf,
    /// `relief`, a layer's name, `scene`, or `scene:` and one of the former.
    pub view: String,
    /// Plate borders and motions over it; over a scene they lie on a map's colours.
    pub overlay: bool,
    /// Smoke over the relief, where a vent erupts.
    pub smoke: bool,
    /// What flags say of the scene.
    pub scene: SceneRequest,
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
    let view = View::parse(&picture.view)?;
    match view {
        View::Map(_) => picture.scene.refuse_for_maps()?,
        View::Scene(_) if picture.smoke => {
            let what = "--smoke is about maps; in a scene smoke is drawn, or not with --set scene.smoke.on=false";
            return Err(JobError::Refused(what.to_owned()));
        }
        View::Scene(_) => scene::check_build()?,
    }
    let (world, provenance) = open_world(&picture.world)?;
    view.check(&picture.view, &world)?;
    let drawn = match view {
        View::Map(view) => {
            let options = relief::Options {
                overlay: picture.overlay,
                smoke: picture.smoke,
                title: Some(provenance.name),
                ..Default::default()
            };
            relief::map(&world, &view, &options)?
        }
        View::Scene(draped) => scene::still(picture, &world, &provenance, draped)?,
    };
    write_picture(&drawn, &picture.file)?;
    Ok(picture.file.clone())
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
