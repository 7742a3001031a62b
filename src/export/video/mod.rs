//! Films: pictures in time order become one file, or a folder of numbered pictures.
//!
//! | name | holds | made by |
//! |---|---|---|
//! | `.mp4` | H.264, yuv420p, ready to stream | ffmpeg |
//! | `.webm` | VP9 | ffmpeg |
//! | `.mpg` | MPEG-2 | ffmpeg |
//! | `.mov` | ProRes 422 HQ | ffmpeg |
//! | `.gif` | 256 colours chosen for the whole film | ffmpeg, in two passes |
//! | `.png` | animated PNG | this program |
//! | `name/%05d.png`, `name/%05d.exr` | numbered pictures; EXR in linear light | this program |
//!
//! Pictures go through a short queue to a thread that writes them, so that memory does not grow with the film. A film is
//! written beside its place and moved there when it is whole; of one that fails nothing is left, and no process either.
//! This room knows pixels only: rows of red, green, blue bytes from the top left.

mod animated;
mod encoder;
mod ffmpeg;
mod format;
mod numbered;
mod rate;

pub use encoder::{Encoder, Settings};
pub use ffmpeg::split_arguments;
pub use format::Format;
pub use numbered::{NumberedFolder, Pattern};
pub use rate::Rate;
