//! A folder that appears whole or not at all: filled beside its place, then renamed.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{JobError, MANIFEST};

/// A folder being filled. Dropped before [`Partial::finish`], it leaves nothing behind.
pub(crate) struct Partial {
    target: PathBuf,
    beside: PathBuf,
    made_parents: Vec<PathBuf>,
    finished: bool,
}

impl Partial {
    /// Prepares to fill `target`; refuses what exists, unless `force` and it is a world of ours.
    pub fn begin(target: &Path, force: bool) -> Result<Self, JobError> {
        let shown = target.display();
        let Some(name) = target.file_name() else {
            return Err(JobError::Refused(format!("--out '{shown}': name a new folder")));
        };
        match fs::symlink_metadata(target) {
            Ok(found) if !found.is_dir() => {
                return Err(JobError::Refused(format!("{shown}: there is a file of that name; choose another --out")));
            }
            Ok(_) if !force => {
                let what = format!("{shown}: this folder exists; choose another --out, or replace it with --force");
                return Err(JobError::Refused(what));
            }
            Ok(_) if !is_ours(target) => {
                let what = format!("{shown}: --force replaces worlds only, and this folder has no {MANIFEST}");
                return Err(JobError::Refused(what));
            }
            _ => {}
        }
        let beside = target.with_file_name(format!(".{}.partial-{}", name.to_string_lossy(), std::process::id()));
        let mut partial = Self { target: target.to_owned(), beside, made_parents: Vec::new(), finished: false };
        partial
            .make()
            .map_err(|cause| JobError::Refused(format!("{shown}: cannot make this folder: {}", plain(&cause))))?;
        Ok(partial)
    }

    fn make(&mut self) -> io::Result<()> {
        let missing: Vec<&Path> =
            self.target.ancestors().skip(1).take_while(|p| !p.as_os_str().is_empty() && !p.exists()).collect();
        for parent in missing.into_iter().rev() {
            fs::create_dir(parent)?;
            self.made_parents.push(parent.to_owned());
        }
        fs::create_dir(&self.beside)
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.beside
    }

    /// Puts the folder in its place.
    pub fn finish(mut self) -> Result<PathBuf, JobError> {
        let disk = |cause| JobError::Disk { path: self.target.clone(), cause };
        let old = self.beside.with_extension(format!("old-{}", std::process::id()));
        let replaces = self.target.exists();
        if replaces {
            fs::rename(&self.target, &old).map_err(disk)?;
        }
        if let Err(cause) = fs::rename(&self.beside, &self.target) {
            if replaces {
                // The world that was there goes back; if even that fails it still stands beside.
                let _ = fs::rename(&old, &self.target);
            }
            return Err(disk(cause));
        }
        self.finished = true;
        if replaces {
            fs::remove_dir_all(&old).map_err(|cause| JobError::Disk { path: old, cause })?;
        }
        Ok(self.target.clone())
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if self.finished {
            return;
        }
        // Cleaning up after a failure that is already being told; a parent that others use by now stays.
        let _ = fs::remove_dir_all(&self.beside);
        for parent in self.made_parents.iter().rev() {
            let _ = fs::remove_dir(parent);
        }
    }
}

/// Whether a folder may be replaced: a world, or empty.
fn is_ours(folder: &Path) -> bool {
    folder.join(MANIFEST).is_file() || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none())
}

/// The first free one of `stem`, `stem-2`, `stem-3`, ...
pub(crate) fn free(stem: &Path) -> PathBuf {
    let name = stem.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = (2u32..).map(|n| stem.with_file_name(format!("{name}-{n}")));
    std::iter::once(stem.to_owned())
        .chain(numbered)
        .find(|path| fs::symlink_metadata(path).is_err())
        .unwrap_or_else(|| stem.to_owned())
}

/// A system's error without its number.
pub(crate) fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_of_a_failure() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("a/b/world");
        let partial = Partial::begin(&target, false).unwrap();
        fs::write(partial.path().join("x"), "x").unwrap();
        drop(partial);
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
        let partial = Partial::begin(&target, false).unwrap();
        fs::write(partial.path().join("x"), "x").unwrap();
        partial.finish().unwrap();
        assert_eq!(fs::read_dir(target.parent().unwrap()).unwrap().count(), 1);
        assert!(target.join("x").is_file());
    }

    #[test]
    fn only_worlds_are_replaced() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("world");
        fs::create_dir(&target).unwrap();
        fs::write(target.join("photos"), "x").unwrap();
        assert!(Partial::begin(&target, false).is_err());
        assert!(Partial::begin(&target, true).is_err());
        fs::write(target.join(MANIFEST), "{}").unwrap();
        drop(Partial::begin(&target, true).unwrap());
        assert!(target.join("photos").is_file());
        Partial::begin(&target, true).unwrap().finish().unwrap();
        assert!(!target.join("photos").exists());
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[test]
    fn free_names_count_on() {
        let root = tempfile::tempdir().unwrap();
        let stem = root.path().join("w-1");
        assert_eq!(free(&stem), stem);
        fs::create_dir(&stem).unwrap();
        fs::create_dir(root.path().join("w-1-2")).unwrap();
        assert_eq!(free(&stem), root.path().join("w-1-3"));
    }
}
