//! Runs the real binary: what a user types, what stands on the screen, which files there are.

mod bad_input;
mod bake;
mod export;
mod film;
mod grow;
mod import;
mod interrupt;
mod reference;
mod report;
mod round_trip;
mod scene;

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// What a command said.
struct Said {
    code: i32,
    out: String,
    err: String,
}

/// A folder of its own for each test.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_upthrust"));
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        command
    }

    fn run(&self, arguments: &[&str]) -> Said {
        let output = self.command(arguments).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
    }

    /// Everything below the folder, hidden files too, sorted.
    fn files(&self) -> Vec<String> {
        fn walk(folder: &Path, root: &Path, into: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                into.push(path.strip_prefix(root).unwrap().display().to_string());
                if path.is_dir() {
                    walk(&path, root, into);
                }
            }
        }
        let mut files = Vec::new();
        walk(self.folder.path(), self.folder.path(), &mut files);
        files.sort();
        files
    }

    /// What lies in the folder itself, hidden entries too, sorted.
    fn entries(&self) -> Vec<String> {
        self.files().into_iter().filter(|name| !name.contains('/')).collect()
    }
}
