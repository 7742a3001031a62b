//! ffmpeg as a process that reads raw pictures.
//!
//! It writes beside the film's place. What it says on its standard error is read on a thread of its own, so that it
//! never waits for us; the end of it is what a user sees if it stops early. Dropped before the end, it is killed, waited
//! for, and its files are removed.

use std::{
    ffi::OsString,
    io::{Read, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::{Arc, Mutex, MutexGuard},
    thread::JoinHandle,
};

use super::{Format, Settings};
use crate::export::ExportError;

/// Of what ffmpeg says, this much of the end is kept.
const WORDS_BYTES: usize = 4096;
/// Lines of it that are shown.
const WORDS_LINES: usize = 3;

/// The program, if it is on the path.
pub fn find() -> Option<PathBuf> {
    let name = format!("ffmpeg{}", std::env::consts::EXE_SUFFIX);
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(&name)).find(|file| executable(file))
}

#[cfg(unix)]
fn executable(file: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    file.metadata().is_ok_and(|found| found.is_file() && found.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn executable(file: &Path) -> bool {
    file.is_file()
}

/// Splits arguments as a shell does: at blanks, but not within quotes. `None` where a quote stays open.
pub fn split_arguments(text: &str) -> Option<Vec<String>> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in text.chars() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (None, '\'' | '"') => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (None, c) if c.is_whitespace() => words.extend(word.take()),
            (_, c) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    quote.is_none().then_some(words)
}

/// A handle that can end the process from another thread.
#[derive(Clone)]
pub struct Running(Arc<Mutex<Child>>);

impl Running {
    fn child(&self) -> MutexGuard<'_, Child> {
        // A panic elsewhere does not change what a process is.
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Ends it, if it still runs.
    pub fn kill(&self) {
        // It may have ended by itself.
        let _ = self.child().kill();
    }
}

/// A film that ffmpeg makes.
pub struct Ffmpeg {
    path: PathBuf,
    /// Where the film is written until it is whole.
    beside: PathBuf,
    settings: Settings,
    process: Process,
}

impl Ffmpeg {
    /// Starts it.
    pub fn open(path: &Path, settings: &Settings) -> Result<Self, ExportError> {
        let missing = || {
            let what = "needs ffmpeg, which is not installed (Debian, Ubuntu: apt install ffmpeg; macOS: brew install \
                        ffmpeg; Windows: winget install ffmpeg); --video without a name needs none";
            ExportError::FilmRequest(format!("{}: {what}", path.display()))
        };
        let program = find().ok_or_else(missing)?;
        let end = path.extension().unwrap_or_default().to_string_lossy();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let beside = path.with_file_name(format!(".{name}.partial-{}.{end}", std::process::id()));
        let first = if settings.format == Format::Gif { between(&beside, "nut") } else { beside.clone() };
        let mut arguments = input(settings);
        arguments.extend(output(settings));
        if settings.format != Format::Gif {
            arguments.extend(settings.ffmpeg_args.iter().map(OsString::from));
        }
        arguments.push(file_name(&first));
        let process = Process::start(&program, &arguments, path, true)?;
        Ok(Self { path: path.to_owned(), beside, settings: settings.clone(), process })
    }

    /// A handle that can end it.
    pub fn running(&self) -> Running {
        self.process.running.clone()
    }

    /// Hands a picture on.
    pub fn picture(&mut self, picture: &[u8]) -> Result<(), ExportError> {
        let Some(stdin) = &mut self.process.stdin else { return Err(self.process.last_words(None)) };
        match stdin.write_all(picture) {
            Ok(()) => Ok(()),
            // It has closed its end: it says why, and the pipe does not.
            Err(_) => Err(self.process.end().err().unwrap_or_else(|| self.process.last_words(None))),
        }
    }

    /// Hands the last picture on, as often as it stands, and waits for the end.
    pub fn finish(mut self, last: &[u8]) -> Result<(), ExportError> {
        let times = (self.settings.hold_s * self.settings.rate.per_second()).round().max(1.0) as usize;
        for _ in 0..times {
            self.picture(last)?;
        }
        self.process.end()?;
        if self.settings.format == Format::Gif {
            self.choose_colours()?;
        }
        std::fs::rename(&self.beside, &self.path).map_err(|cause| ExportError::Disk { path: self.path.clone(), cause })
    }

    /// A GIF's colours can be chosen only when all pictures are known. They are kept losslessly on the disk till then:
    /// ffmpeg would otherwise hold the whole film in memory.
    fn choose_colours(&mut self) -> Result<(), ExportError> {
        let (film, colours) = (file_name(&between(&self.beside, "nut")), file_name(&between(&self.beside, "png")));
        let program = find().unwrap_or_else(|| "ffmpeg".into());
        let common = || ["-hide_banner", "-nostdin", "-loglevel", "error", "-y", "-i"].map(OsString::from).to_vec();
        let mut run = |arguments: Vec<OsString>| {
            self.process = Process::start(&program, &arguments, &self.path, false)?;
            self.process.end()
        };
        let mut choose = common();
        choose.push(film.clone());
        choose.extend(["-vf", "palettegen=stats_mode=full", "-update", "1"].map(OsString::from));
        choose.push(colours.clone());
        run(choose)?;
        let mut paint = common();
        paint.extend([film, "-i".into(), colours]);
        paint.extend(
            ["-lavfi", "paletteuse=dither=bayer:bayer_scale=5:diff_mode=rectangle", "-f", "gif"].map(OsString::from),
        );
        paint.extend(self.settings.ffmpeg_args.iter().map(OsString::from));
        paint.push(file_name(&self.beside));
        run(paint)
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        self.process.kill();
        for file in [self.beside.clone(), between(&self.beside, "nut"), between(&self.beside, "png")] {
            // Most of them were never there, or have been moved.
            let _ = std::fs::remove_file(file);
        }
    }
}

/// A file between the pictures and the film.
fn between(beside: &Path, end: &str) -> PathBuf {
    let mut name = beside.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(end);
    beside.with_file_name(name)
}

/// A path that ffmpeg takes for a file, whatever it begins with.
fn file_name(path: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push(path);
    name
}

/// What comes in: raw pictures.
fn input(settings: &Settings) -> Vec<OsString> {
    let [width, height] = settings.size;
    let mut arguments: Vec<OsString> = [
        "-hide_banner",
        "-nostdin",
        "-nostats",
        "-loglevel",
        "error",
        "-y",
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-s",
    ]
    .map(OsString::from)
    .to_vec();
    arguments.push(format!("{width}x{height}").into());
    arguments.push("-framerate".into());
    arguments.push(format!("{}/{}", settings.rate.frames, settings.rate.seconds).into());
    arguments.extend(["-i", "pipe:0", "-an"].map(OsString::from));
    arguments
}

/// What goes out. High definition's own matrix, stated in the file, so that players show the colours that were drawn.
fn output(settings: &Settings) -> Vec<OsString> {
    let yuv420 = "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p";
    let (filter, codec): (&str, &[&str]) = match settings.format {
        Format::Mp4 => {
            (yuv420, &["-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-movflags", "+faststart", "-f", "mp4"])
        }
        Format::WebM => (
            yuv420,
            &[
                "-c:v",
                "libvpx-vp9",
                "-crf",
                "24",
                "-b:v",
                "0",
                "-deadline",
                "good",
                "-cpu-used",
                "5",
                "-row-mt",
                "1",
                "-f",
                "webm",
            ],
        ),
        Format::Mpeg => (yuv420, &["-c:v", "mpeg2video", "-q:v", "3", "-f", "mpeg"]),
        Format::Mov => (
            "scale=out_color_matrix=bt709:out_range=tv,format=yuv422p10le",
            &[
                "-c:v",
                "prores_ks",
                "-profile:v",
                "3",
                "-vendor",
                "apl0",
                // The encoder does not state the colours by itself.
                "-bsf:v",
                "prores_metadata=color_primaries=bt709:color_trc=bt709:colorspace=bt709",
                "-movflags",
                "+faststart",
                "-f",
                "mov",
            ],
        ),
        // Lossless and quick, until the colours are chosen.
        _ => return ["-c:v", "ffv1", "-pix_fmt", "bgr0", "-f", "nut"].map(OsString::from).to_vec(),
    };
    let colours = ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"];
    ["-vf", filter].iter().chain(colours.iter()).chain(codec).map(OsString::from).collect()
}

/// A run of the program.
struct Process {
    path: PathBuf,
    running: Running,
    stdin: Option<ChildStdin>,
    words: Option<JoinHandle<String>>,
}

impl Process {
    fn start(program: &Path, arguments: &[OsString], path: &Path, reads: bool) -> Result<Self, ExportError> {
        let failed = |cause: String| ExportError::Film { path: path.to_owned(), cause };
        let mut command = Command::new(program);
        command.args(arguments).stdout(Stdio::null()).stderr(Stdio::piped());
        command.stdin(if reads { Stdio::piped() } else { Stdio::null() });
        own_group(&mut command);
        let mut child = command.spawn().map_err(|e| failed(format!("cannot start ffmpeg: {e}")))?;
        let (stdin, stderr) = (child.stdin.take(), child.stderr.take());
        let words = std::thread::Builder::new().name("ffmpeg's words".to_owned()).spawn(move || tail(stderr));
        let running = Running(Arc::new(Mutex::new(child)));
        let mut process = Self { path: path.to_owned(), running, stdin, words: None };
        process.words = Some(words.map_err(|e| failed(e.to_string()))?);
        Ok(process)
    }

    /// Closes its input and waits; an error in its own words where it did not end well.
    fn end(&mut self) -> Result<(), ExportError> {
        self.stdin = None;
        let status = self.running.child().wait();
        match status {
            Ok(status) if status.success() => Ok(()),
            status => Err(self.last_words(status.ok())),
        }
    }

    fn last_words(&mut self, status: Option<ExitStatus>) -> ExportError {
        let words = self.words.take().and_then(|words| words.join().ok()).unwrap_or_default();
        let lines: Vec<&str> = words.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        let last = lines[lines.len().saturating_sub(WORDS_LINES)..].join("; ");
        let how = status.map_or_else(|| "early".to_owned(), |status| format!("with {status}"));
        let cause = match last.as_str() {
            "" => format!("ffmpeg ended {how} and said nothing"),
            last => format!("ffmpeg ended {how}: {last}"),
        };
        ExportError::Film { path: self.path.clone(), cause }
    }

    fn kill(&mut self) {
        self.stdin = None;
        self.running.kill();
        // Waited for, so that it does not stay behind as a zombie.
        let _ = self.running.child().wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Ctrl-C in a terminal reaches a whole group; ffmpeg shall end when we say so.
#[cfg(unix)]
fn own_group(command: &mut Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
fn own_group(_command: &mut Command) {}

/// The end of what is said.
fn tail(stream: Option<impl Read>) -> String {
    let Some(mut stream) = stream else { return String::new() };
    let (mut kept, mut buffer) = (Vec::new(), [0; 1024]);
    while let Ok(count @ 1..) = stream.read(&mut buffer) {
        kept.extend_from_slice(&buffer[..count]);
        let too_many = kept.len().saturating_sub(WORDS_BYTES);
        kept.drain(..too_many);
    }
    String::from_utf8_lossy(&kept).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_split_as_in_a_shell() {
        let of = |text: &str| split_arguments(text).map(|words| words.join("|"));
        assert_eq!(of("-crf 30  -preset slow").as_deref(), Some("-crf|30|-preset|slow"));
        assert_eq!(
            of("-vf 'hflip, vflip' -metadata title=\"a b\" ''").as_deref(),
            Some("-vf|hflip, vflip|-metadata|title=a b|")
        );
        assert_eq!(of(" ").as_deref(), Some(""));
        assert_eq!(of("-vf 'x"), None);
    }

    #[test]
    fn only_the_end_of_long_talk_is_kept() {
        let talk = "x".repeat(10_000) + "\nthe end";
        let kept = tail(Some(talk.as_bytes()));
        assert!(kept.ends_with("\nthe end") && kept.len() == WORDS_BYTES);
    }
}
