//! The desktop application (feature `app`): a window on a world.
//!
//! It owns its own state and nothing of a world's; worlds are opened and drawn by the rooms below. What is shown and why
//! (`state`, `camera`) stands apart from how it is painted (`window`); pictures are drawn on a thread of their own
//! (`drawing`). Nothing below knows of this room: the binary hands `open` to the command line.

mod camera;
mod drawing;
mod state;
mod window;

pub use window::open;
