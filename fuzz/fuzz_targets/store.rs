//! See `entry_points.rs`.
#![no_main]

#[allow(dead_code, reason = "each target uses one entry point")]
#[path = "../entry_points.rs"]
mod entry_points;

use std::sync::OnceLock;

use entry_points::Shelf;

static SHELF: OnceLock<(tempfile::TempDir, Shelf)> = OnceLock::new();

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let (_, shelf) = SHELF.get_or_init(|| {
        let folder = tempfile::tempdir().expect("there is a folder for temporary files");
        let shelf = Shelf::new(folder.path());
        (folder, shelf)
    });
    shelf.read_with(bytes);
});
