//! Which film a name asks for, and what each kind can hold.

use std::path::Path;

use super::Rate;
use crate::export::ExportError;

/// A kind of film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// H.264 in MP4.
    Mp4,
    /// VP9 in WebM.
    WebM,
    /// MPEG-2.
    Mpeg,
    /// ProRes in QuickTime.
    Mov,
    /// Animated GIF.
    Gif,
    /// Animated PNG.
    AnimatedPng,
    /// A folder of numbered PNG pictures.
    NumberedPng,
    /// A folder of numbered EXR pictures.
    NumberedExr,
}

/// What MPEG-2's sequence header can state (ISO/IEC 13818-2, table 6-4).
const MPEG_RATES: [(u32, u32); 8] =
    [(24_000, 1001), (24, 1), (25, 1), (30_000, 1001), (30, 1), (50, 1), (60_000, 1001), (60, 1)];
/// A GIF counts hundredths of a second, and browsers slow down what is faster than two of them.
const GIF_MOST: f64 = 50.0;
/// Longest side of a film, pixels.
const MOST_PX: usize = 8192;
/// MPEG-2 states sides in twelve bits.
const MPEG_MOST_PX: usize = 4094;
/// Shortest side of a film, pixels.
const LEAST_PX: usize = 64;

impl Format {
    /// The kind that a file's name asks for.
    pub fn of(path: &Path) -> Result<Self, ExportError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let end = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let numbered = name.contains('%');
        match end.as_str() {
            "mp4" | "m4v" if !numbered => Ok(Format::Mp4),
            "webm" if !numbered => Ok(Format::WebM),
            "mpg" | "mpeg" if !numbered => Ok(Format::Mpeg),
            "mov" if !numbered => Ok(Format::Mov),
            "gif" if !numbered => Ok(Format::Gif),
            "png" if numbered => Ok(Format::NumberedPng),
            "png" | "apng" => Ok(Format::AnimatedPng),
            "exr" if numbered => Ok(Format::NumberedExr),
            "exr" => refuse(path, "one EXR holds one picture; number them, as in film/%05d.exr"),
            _ => refuse(
                path,
                "a film's name ends in .mp4, .webm, .mpg, .mov, .gif or .png, or is numbered, as in film/%05d.png or film/%05d.exr",
            ),
        }
    }

    /// Whether it is made by ffmpeg.
    pub fn needs_ffmpeg(self) -> bool {
        matches!(self, Format::Mp4 | Format::WebM | Format::Mpeg | Format::Mov | Format::Gif)
    }

    /// Whether it is a folder of pictures.
    pub fn numbered(self) -> bool {
        matches!(self, Format::NumberedPng | Format::NumberedExr)
    }

    /// The rate where none is asked for. Pictures that every reader holds whole are fewer.
    pub fn usual_rate(self) -> Rate {
        match self {
            Format::Gif => Rate::whole(25),
            Format::AnimatedPng => Rate::whole(15),
            _ => Rate::whole(30),
        }
    }

    /// The size where none is asked for, pixels.
    pub fn usual_size(self) -> [usize; 2] {
        match self {
            Format::Gif | Format::AnimatedPng => [640, 360],
            _ => [1280, 720],
        }
    }

    /// The size it is made in: colours at half the resolution ask for even sides.
    pub fn fit(self, [width, height]: [usize; 2]) -> [usize; 2] {
        match self {
            Format::Mp4 | Format::WebM | Format::Mpeg | Format::Mov => {
                [width.next_multiple_of(2), height.next_multiple_of(2)]
            }
            _ => [width, height],
        }
    }

    /// Refuses a rate or a size that it cannot hold.
    pub fn check(self, rate: Rate, [width, height]: [usize; 2]) -> Result<(), ExportError> {
        let wrong = |what: String| Err(ExportError::FilmRequest(what));
        if self == Format::Mpeg && !MPEG_RATES.contains(&(rate.frames, rate.seconds)) {
            return wrong(format!(
                "--fps {rate}: MPEG-2 (.mpg) knows only 23.976, 24, 25, 29.97, 30, 50, 59.94 and 60 frames a second"
            ));
        }
        if self == Format::Gif && rate.per_second() > GIF_MOST {
            return wrong(format!("--fps {rate}: a GIF shows at most {GIF_MOST} frames a second"));
        }
        let most = if self == Format::Mpeg { MPEG_MOST_PX } else { MOST_PX };
        let fits = |side: usize| (LEAST_PX..=most).contains(&side);
        if !fits(width) || !fits(height) {
            return wrong(format!("--video-size {width}x{height}: a side must be from {LEAST_PX} to {most} pixels"));
        }
        Ok(())
    }
}

fn refuse<T>(path: &Path, what: &str) -> Result<T, ExportError> {
    Err(ExportError::FilmRequest(format!("{}: {what}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_the_kind() {
        let of = |name: &str| Format::of(Path::new(name)).ok();
        assert_eq!(of("a.MP4"), Some(Format::Mp4));
        assert_eq!(of("a.png"), Some(Format::AnimatedPng));
        assert_eq!(of("f/%05d.png"), Some(Format::NumberedPng));
        assert_eq!(of("f/%05d.exr"), Some(Format::NumberedExr));
        for bad in ["a", "a.avi", "a.exr", "%d.mp4", ""] {
            assert_eq!(of(bad), None, "{bad}");
        }
    }

    #[test]
    fn each_kind_knows_its_limits() {
        let check = |format: Format, rate: &str, size| format.check(Rate::parse(rate).unwrap(), size).is_ok();
        for rate in ["23.976", "24", "25", "29.97", "30", "50", "59.94", "60"] {
            assert!(check(Format::Mpeg, rate, [1280, 720]), "{rate}");
        }
        assert!(!check(Format::Mpeg, "15", [1280, 720]) && check(Format::Mp4, "15", [1280, 720]));
        assert!(!check(Format::Mpeg, "25", [5000, 720]) && check(Format::Mp4, "25", [5000, 720]));
        assert!(!check(Format::Gif, "60", [640, 360]) && !check(Format::Mp4, "25", [0, 720]));
        assert_eq!(Format::Mp4.fit([641, 359]), [642, 360]);
        assert_eq!(Format::Gif.fit([641, 359]), [641, 359]);
    }
}
