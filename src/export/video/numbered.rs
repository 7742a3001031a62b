//! Numbered pictures in a folder that appears whole or not at all.

use std::{
    fs,
    io::BufWriter,
    path::{Path, PathBuf},
};

use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage, f16};
use image::{ExtendedColorType, ImageEncoder, codecs::png};

use super::{Format, Settings};
use crate::{export::ExportError, world::store::said};

/// A folder being filled beside its place. Dropped before [`NumberedFolder::finish`], it leaves nothing behind.
pub struct NumberedFolder {
    folder: PathBuf,
    beside: PathBuf,
    finished: bool,
}

impl NumberedFolder {
    /// Prepares to fill a folder that is not there, or is empty.
    pub fn begin(folder: &Path) -> Result<Self, ExportError> {
        let refuse = |what: &str| Err(ExportError::FilmRequest(format!("{}: {what}", folder.display())));
        let Some(name) = folder.file_name() else { return refuse("name a new folder for the files") };
        match fs::read_dir(folder).map(|mut entries| entries.next().is_some()) {
            Ok(true) => {
                return refuse("this folder has something in it; name a new one for the files");
            }
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return refuse("there is a file of that name"),
            _ => {}
        }
        crate::export::sweep(folder);
        let beside = folder.with_file_name(format!(".{}.partial-{}", name.to_string_lossy(), std::process::id()));
        if let Err(cause) = fs::create_dir(&beside) {
            return refuse(&format!("cannot make this folder: {}", said(&cause)));
        }
        Ok(Self { folder: folder.to_owned(), beside, finished: false })
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.beside
    }

    /// Puts the folder in its place.
    pub fn finish(mut self) -> Result<PathBuf, ExportError> {
        // An empty folder makes room; one that was filled meanwhile stays, and the move fails.
        let _ = fs::remove_dir(&self.folder);
        fs::rename(&self.beside, &self.folder)
            .map_err(|cause| ExportError::Disk { path: self.folder.clone(), cause })?;
        self.finished = true;
        Ok(self.folder.clone())
    }
}

impl Drop for NumberedFolder {
    fn drop(&mut self) {
        if !self.finished {
            // It holds only what we wrote.
            let _ = fs::remove_dir_all(&self.beside);
        }
    }
}

/// The name of numbered files: `frame-%05d.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// Reads it; `None` where no number is to stand, or more than one.
    pub fn parse(name: &str) -> Option<Self> {
        let (before, rest) = name.split_once('%')?;
        let (digits, after) = rest.split_once('d')?;
        let digits = if digits.is_empty() { 1 } else { digits.parse().ok().filter(|n| (1..=9).contains(n))? };
        let plain = !after.contains('%');
        plain.then(|| Self { before: before.to_owned(), digits, after: after.to_owned() })
    }

    /// The name with a number in its place.
    pub fn name(&self, number: u64) -> String {
        format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits)
    }
}

/// A film as numbered pictures, from 1.
pub struct Numbered {
    folder: NumberedFolder,
    pattern: Pattern,
    settings: Settings,
    written: u64,
}

impl Numbered {
    /// Begins the folder that the name's pattern stands in.
    pub fn open(path: &Path, settings: &Settings) -> Result<Self, ExportError> {
        let refuse = |what: &str| ExportError::FilmRequest(format!("{}: {what}", path.display()));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let pattern = Pattern::parse(&name).ok_or_else(|| refuse("write the number once, as in film/%05d.png"))?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.ok_or_else(|| refuse("name a folder for the pictures too, as in film/%05d.png"))?;
        Ok(Self { folder: NumberedFolder::begin(folder)?, pattern, settings: settings.clone(), written: 0 })
    }

    /// Writes a picture.
    pub fn picture(&mut self, picture: &[u8]) -> Result<(), ExportError> {
        self.written += 1;
        let path = self.folder.path().join(self.pattern.name(self.written));
        let [width, height] = self.settings.size;
        let disk = |cause| ExportError::Disk { path: path.clone(), cause };
        let encode = |cause: String| ExportError::Encode { path: path.clone(), cause };
        let mut file = BufWriter::new(fs::File::create(&path).map_err(disk)?);
        if self.settings.format == Format::NumberedExr {
            write_exr(&mut file, picture, [width, height]).map_err(encode)?;
        } else {
            png::PngEncoder::new_with_quality(&mut file, png::CompressionType::Fast, png::FilterType::Paeth)
                .write_image(picture, width as u32, height as u32, ExtendedColorType::Rgb8)
                .map_err(|e| encode(e.to_string()))?;
        }
        std::io::Write::flush(&mut file).map_err(disk)
    }

    /// Writes the last picture and puts the folder in its place.
    pub fn finish(mut self, last: &[u8]) -> Result<(), ExportError> {
        self.picture(last)?;
        self.folder.finish().map(|_| ())
    }
}

/// Red, green, blue as half floats in linear light, which is what compositing programs expect.
fn write_exr(file: &mut BufWriter<fs::File>, picture: &[u8], [width, height]: [usize; 2]) -> Result<(), String> {
    let linear: Vec<f16> = (0..=255).map(|byte| f16::from_f64(linear(byte as f64 / 255.0))).collect();
    let channels = SpecificChannels::rgb(|at: exr::prelude::Vec2<usize>| {
        let i = (at.1 * width + at.0) * 3;
        (linear[picture[i] as usize], linear[picture[i + 1] as usize], linear[picture[i + 2] as usize])
    });
    let image = Image::from_encoded_channels((width, height), Encoding::FAST_LOSSLESS, channels);
    image.write().non_parallel().to_buffered(file).map_err(|e| e.to_string())
}

/// From sRGB's curve.
fn linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::video::{Encoder, Rate};

    #[test]
    fn names_count_up() {
        let names = |pattern: &str| Pattern::parse(pattern).map(|p| [p.name(7), p.name(123_456)]);
        assert_eq!(names("%05d.png").unwrap(), ["00007.png", "123456.png"]);
        assert_eq!(names("a-%d.exr").unwrap(), ["a-7.exr", "a-123456.exr"]);
        for bad in ["a.png", "%5x.png", "%05d-%d.png", "%.png", "%99d.png"] {
            assert_eq!(names(bad), None, "{bad}");
        }
    }

    #[test]
    fn pictures_come_back_from_png_and_exr() {
        let root = tempfile::tempdir().unwrap();
        let picture: Vec<u8> = (0..64 * 80 * 3).map(|k| (k % 251) as u8).collect();
        for name in ["p/%05d.png", "e/%03d.exr"] {
            let path = root.path().join(name);
            let format = Format::of(&path).unwrap();
            let settings =
                Settings { format, size: [64, 80], rate: Rate::whole(30), hold_s: 1.0, ffmpeg_args: Vec::new() };
            let mut encoder = Encoder::open(&path, &settings).unwrap();
            encoder.push(picture.clone()).unwrap();
            encoder.push(picture.clone()).unwrap();
            encoder.finish().unwrap();
        }
        assert_eq!(fs::read_dir(root.path().join("p")).unwrap().count(), 2);
        let read = image::open(root.path().join("p/00002.png")).unwrap().into_rgb8();
        assert!(read.dimensions() == (64, 80) && read.as_raw() == &picture);
        let read = exr::prelude::read_first_rgba_layer_from_file(
            root.path().join("e/001.exr"),
            |size, _| vec![[0.0f32; 3]; size.width() * size.height()],
            |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.1 * 64 + at.0] = [r, g, b],
        )
        .unwrap();
        let pixels = read.layer_data.channel_data.pixels;
        for (i, pixel) in pixels.iter().enumerate() {
            for c in 0..3 {
                // Eleven bits of a half float.
                let want = linear(picture[3 * i + c] as f64 / 255.0);
                assert!((pixel[c] as f64 - want).abs() <= want / 2048.0 + 1e-7, "{i}");
            }
        }
    }

    #[test]
    fn a_folder_in_use_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("x"), "x").unwrap();
        assert!(NumberedFolder::begin(root.path()).is_err());
        assert!(NumberedFolder::begin(&root.path().join("x")).is_err());
        assert!(NumberedFolder::begin(&root.path().join("no/folder")).is_err());
        fs::create_dir(root.path().join("empty")).unwrap();
        NumberedFolder::begin(&root.path().join("empty")).unwrap().finish().unwrap();
    }
}
