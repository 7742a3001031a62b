//! Animated PNG: a film that needs no other program, and that every browser shows.

use std::{
    fs::File,
    io::{BufWriter, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

use png::{BitDepth, ColorType, Compression, Filter};

use super::Settings;
use crate::export::ExportError;

/// An animated PNG being written.
pub struct Animated {
    path: PathBuf,
    beside: PathBuf,
    settings: Settings,
    writer: Option<png::Writer<BufWriter<File>>>,
    pictures: u32,
}

impl Animated {
    /// Begins the file.
    pub fn open(path: &Path, settings: &Settings) -> Result<Self, ExportError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let beside = path.with_file_name(format!(".{name}.partial-{}", std::process::id()));
        let file = File::create(&beside).map_err(|cause| ExportError::Disk { path: path.to_owned(), cause })?;
        let mut film = Self { path: path.to_owned(), beside, settings: settings.clone(), writer: None, pictures: 0 };
        let [width, height] = settings.size;
        let mut encoder = png::Encoder::new(BufWriter::new(file), width as u32, height as u32);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Paeth);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        // How many there will be is known at the end, and put in then.
        encoder.set_animated(u32::MAX >> 1, 0).map_err(|e| film.failed(e))?;
        let writer = encoder.write_header().map_err(|e| film.failed(e))?;
        film.writer = Some(writer);
        Ok(film)
    }

    fn failed(&self, error: png::EncodingError) -> ExportError {
        match error {
            png::EncodingError::IoError(cause) => ExportError::Disk { path: self.path.clone(), cause },
            error => ExportError::Encode { path: self.path.clone(), cause: error.to_string() },
        }
    }

    fn write(&mut self, picture: &[u8], [numerator, denominator]: [u16; 2]) -> Result<(), ExportError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let written = writer.set_frame_delay(numerator, denominator).and_then(|()| writer.write_image_data(picture));
        self.pictures += 1;
        written.map_err(|e| self.failed(e))
    }

    /// Adds a picture.
    pub fn picture(&mut self, picture: &[u8]) -> Result<(), ExportError> {
        let rate = self.settings.rate;
        let delay = match (u16::try_from(rate.seconds), u16::try_from(rate.frames)) {
            (Ok(seconds), Ok(frames)) => [seconds, frames],
            // Milliseconds are exact enough for a fraction that fits no better.
            _ => [(1000.0 / rate.per_second()).round() as u16, 1000],
        };
        self.write(picture, delay)
    }

    /// Adds the last picture, which stands longer, and puts the file in its place.
    pub fn finish(mut self, last: &[u8]) -> Result<(), ExportError> {
        self.write(last, [(self.settings.hold_s * 1000.0).clamp(1.0, 65_000.0) as u16, 1000])?;
        if let Some(writer) = self.writer.take() {
            writer.finish().map_err(|e| self.failed(e))?;
        }
        let disk = |cause| ExportError::Disk { path: self.path.clone(), cause };
        state_count(&self.beside, self.pictures).map_err(disk)?;
        std::fs::rename(&self.beside, &self.path).map_err(disk)
    }
}

impl Drop for Animated {
    fn drop(&mut self) {
        self.writer = None;
        // A finished film has been moved away.
        let _ = std::fs::remove_file(&self.beside);
    }
}

/// Puts the number of pictures into the animation's chunk: length, `acTL`, count, plays, checksum over all but length.
fn state_count(file: &Path, pictures: u32) -> std::io::Result<()> {
    const NAME: &[u8; 4] = b"acTL";
    let mut file = File::options().read(true).write(true).open(file)?;
    let mut head = [0; 256];
    file.read_exact(&mut head)?;
    let at = head.windows(4).position(|four| four == NAME).ok_or(std::io::ErrorKind::InvalidData)?;
    let mut chunk = NAME.to_vec();
    chunk.extend(pictures.to_be_bytes());
    chunk.extend(0u32.to_be_bytes());
    chunk.extend(checksum(&chunk).to_be_bytes());
    file.seek(SeekFrom::Start(at as u64))?;
    file.write_all(&chunk)
}

/// PNG's CRC-32 (ISO 3309), bit by bit: it is of twelve bytes.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::video::{Encoder, Format, Rate};

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
        assert_eq!(checksum(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn every_picture_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let settings = Settings {
            format: Format::AnimatedPng,
            size: [70, 64],
            rate: Rate::parse("29.97").unwrap(),
            hold_s: 1.5,
            ffmpeg_args: Vec::new(),
        };
        let picture = |i: usize| -> Vec<u8> { (0..70 * 64 * 3).map(|k| (k * 7 + i * 31) as u8).collect() };
        let mut encoder = Encoder::open(&path, &settings).unwrap();
        for i in 0..9 {
            let mut blank = encoder.blank();
            blank.copy_from_slice(&picture(i));
            encoder.push(blank).unwrap();
        }
        encoder.finish().unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
        assert_eq!(reader.info().animation_control.unwrap().num_frames, 9);
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        for i in 0..9 {
            reader.next_frame(&mut pixels).unwrap();
            assert!(pixels == picture(i), "{i}");
            let control = reader.info().frame_control.unwrap();
            let delay = (control.delay_num, control.delay_den);
            assert_eq!(delay, if i == 8 { (1500, 1000) } else { (1001, 30_000) });
        }
        assert!(reader.next_frame(&mut pixels).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_film_that_is_given_up_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "f/%03d.png", "g/%d.exr"] {
            let path = folder.path().join(name);
            let format = Format::of(&path).unwrap();
            let settings =
                Settings { format, size: [64, 64], rate: Rate::whole(5), hold_s: 1.0, ffmpeg_args: Vec::new() };
            let mut encoder = Encoder::open(&path, &settings).unwrap();
            for _ in 0..6 {
                let blank = encoder.blank();
                encoder.push(blank).unwrap();
            }
            drop(encoder);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
