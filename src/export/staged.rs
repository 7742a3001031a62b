//! Several files that appear together or not at all: written beside their places, then renamed.

use std::{
    fs::{self, File},
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use super::{ExportError, raster::Out};

/// Files being written. Dropped before [`Staged::finish`], it leaves nothing behind.
#[derive(Debug, Default)]
pub struct Staged {
    files: Vec<(PathBuf, PathBuf)>,
}

impl Staged {
    /// Lets `fill` write one more file, beside `path` for now.
    pub fn write(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut Out) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let disk = |cause| ExportError::Disk { path: path.to_owned(), cause };
        let beside = super::beside(path);
        let file = File::create(&beside).map_err(disk)?;
        self.files.push((beside, path.to_owned()));
        let mut out = BufWriter::new(file);
        fill(&mut out)?;
        out.flush().map_err(disk)
    }

    /// Puts all files in their places and names them, in the order they were written.
    pub fn finish(mut self) -> Result<Vec<PathBuf>, ExportError> {
        let mut done = Vec::new();
        while !self.files.is_empty() {
            let (beside, path) = &self.files[0];
            fs::rename(beside, path).map_err(|cause| ExportError::Disk { path: path.clone(), cause })?;
            done.push(self.files.remove(0).1);
        }
        Ok(done)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        for (beside, _) in &self.files {
            // The first error matters; there may be nothing to clean up.
            let _ = fs::remove_file(beside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let mut staged = Staged::default();
        staged.write(&path("a"), |_| Ok(())).unwrap();
        let failed = staged.write(&path("b"), |_| Err(ExportError::NotFinite { layer: "height", x: 0, y: 0 }));
        assert!(failed.is_err());
        drop(staged);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let mut staged = Staged::default();
        for name in ["b", "a"] {
            staged.write(&path(name), |_| Ok(())).unwrap();
        }
        assert!(!path("a").exists());
        assert_eq!(staged.finish().unwrap(), [path("b"), path("a")]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
