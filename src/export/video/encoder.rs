//! The queue between who draws a film and the thread that writes it.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    },
    thread::JoinHandle,
};

use super::{
    Format, Rate,
    animated::Animated,
    ffmpeg::{self, Ffmpeg, Running},
    numbered::Numbered,
};
use crate::export::{ExportError, sweep};

/// Pictures that may wait to be written.
const WAITING: usize = 2;

/// How a film is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The kind of film.
    pub format: Format,
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Frames a second.
    pub rate: Rate,
    /// How long the last picture stands, s. Numbered pictures are never repeated.
    pub hold_s: f64,
    /// What ffmpeg is told besides, after our own.
    pub ffmpeg_args: Vec<String>,
}

/// A film being written. Dropped before [`Encoder::finish`], it leaves nothing behind.
pub struct Encoder {
    path: PathBuf,
    bytes: usize,
    queue: Option<SyncSender<Vec<u8>>>,
    spent: Receiver<Vec<u8>>,
    writer: Option<JoinHandle<Result<(), ExportError>>>,
    given_up: Arc<AtomicBool>,
    process: Option<Running>,
}

/// Where pictures go.
enum Target {
    Ffmpeg(Ffmpeg),
    Animated(Animated),
    Numbered(Numbered),
}

impl Encoder {
    /// Begins a film; refuses what the format cannot hold, and says how to get what is missing.
    pub fn open(path: &Path, settings: &Settings) -> Result<Self, ExportError> {
        let [width, height] = settings.size;
        settings.format.check(settings.rate, settings.size)?;
        if settings.format.fit(settings.size) != settings.size {
            let what = format!("{}: {width} x {height} pixels: sides must be even", path.display());
            return Err(ExportError::FilmRequest(what));
        }
        if !settings.ffmpeg_args.is_empty() && !settings.format.needs_ffmpeg() {
            let what = format!("--ffmpeg-args: {} is made without ffmpeg", path.display());
            return Err(ExportError::FilmRequest(what));
        }
        sweep(path);
        let (target, process) = match settings.format {
            Format::AnimatedPng => (Target::Animated(Animated::open(path, settings)?), None),
            Format::NumberedPng | Format::NumberedExr => (Target::Numbered(Numbered::open(path, settings)?), None),
            _ => {
                let target = Ffmpeg::open(path, settings)?;
                let process = target.running();
                (Target::Ffmpeg(target), Some(process))
            }
        };
        let given_up = Arc::new(AtomicBool::new(false));
        let (queue, frames) = sync_channel(WAITING);
        let (back, spent) = channel();
        let stop = Arc::clone(&given_up);
        let writer = std::thread::Builder::new()
            .name("film".to_owned())
            .spawn(move || write(target, frames, back, &stop))
            .map_err(|e| ExportError::Film { path: path.to_owned(), cause: e.to_string() })?;
        Ok(Self {
            path: path.to_owned(),
            bytes: width * height * 3,
            queue: Some(queue),
            spent,
            writer: Some(writer),
            given_up,
            process,
        })
    }

    /// Whether there is an ffmpeg to be found.
    pub fn has_ffmpeg() -> bool {
        ffmpeg::find().is_some()
    }

    /// Room for a picture: one that has been written, or new. What is in it is of no meaning.
    pub fn blank(&self) -> Vec<u8> {
        self.spent.try_recv().unwrap_or_else(|_| vec![0; self.bytes])
    }

    /// Puts a picture into the queue: rows of red, green, blue from the top left. Waits where the queue is full. An
    /// error is that of the writer, and is told once.
    pub fn push(&mut self, picture: Vec<u8>) -> Result<(), ExportError> {
        assert_eq!(picture.len(), self.bytes, "a picture has the film's size");
        match &self.queue {
            Some(queue) if queue.send(picture).is_ok() => Ok(()),
            _ => Err(self.ended()),
        }
    }

    /// Ends the film and puts it in its place.
    pub fn finish(mut self) -> Result<PathBuf, ExportError> {
        self.queue = None;
        match self.writer.take().map(JoinHandle::join) {
            Some(Ok(Ok(()))) => Ok(self.path.clone()),
            Some(Ok(Err(error))) => Err(error),
            _ => Err(self.broken()),
        }
    }

    fn ended(&mut self) -> ExportError {
        self.queue = None;
        match self.writer.take().map(JoinHandle::join) {
            Some(Ok(Err(error))) => error,
            _ => self.broken(),
        }
    }

    fn broken(&self) -> ExportError {
        ExportError::Film { path: self.path.clone(), cause: "the film's writer stopped".to_owned() }
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        let Some(writer) = self.writer.take() else { return };
        self.given_up.store(true, Ordering::Relaxed);
        self.queue = None;
        // A writer that waits for ffmpeg is freed by ffmpeg's end.
        if let Some(process) = &self.process {
            process.kill();
        }
        // Nobody wants the film any more, nor what went wrong with it.
        let _ = writer.join();
    }
}

/// Writes what comes until nothing more does; keeps the last picture, which stands longer than the others.
fn write(
    mut target: Target,
    frames: Receiver<Vec<u8>>,
    spent: Sender<Vec<u8>>,
    given_up: &AtomicBool,
) -> Result<(), ExportError> {
    let mut last: Option<Vec<u8>> = None;
    for frame in frames {
        if let Some(before) = last.take() {
            target.picture(&before)?;
            // The drawing side may have gone.
            let _ = spent.send(before);
        }
        if given_up.load(Ordering::Relaxed) {
            break;
        }
        last = Some(frame);
    }
    match last {
        Some(last) if !given_up.load(Ordering::Relaxed) => target.finish(&last),
        // Dropping the target clears away what it wrote.
        _ => Ok(()),
    }
}

impl Target {
    fn picture(&mut self, picture: &[u8]) -> Result<(), ExportError> {
        match self {
            Target::Ffmpeg(target) => target.picture(picture),
            Target::Animated(target) => target.picture(picture),
            Target::Numbered(target) => target.picture(picture),
        }
    }

    fn finish(self, last: &[u8]) -> Result<(), ExportError> {
        match self {
            Target::Ffmpeg(target) => target.finish(last),
            Target::Animated(target) => target.finish(last),
            Target::Numbered(target) => target.finish(last),
        }
    }
}
