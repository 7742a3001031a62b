//! A folder that appears whole or not at all: filled beside its place, then renamed.
//!
//! ```text
//! worlds/collision-11/           the finished world
//! worlds/.collision-11.growing/  while it grows, and as long as a stopped run can go on
//!   lock                         held by the run that fills it
//!   checkpoints/                 see `timeline`
//!   timeline/                    kept frames, if they are asked for
//!   bake/                        recordings of particles so far, if they are asked for
//!   series.notes profiles.notes  rows of series.csv and profiles.csv so far
//!   world/                       what will be the finished world
//! ```

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{JobError, MANIFEST};
use crate::world::store::said;

/// What is to happen where something is already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// A world, or a stopped run, is not touched.
    #[default]
    Refuse,
    /// A world is replaced, a stopped run forgotten.
    Replace,
    /// A stopped run goes on; a finished world of the same recipe stays.
    Resume,
}

/// A folder being filled. Dropped before [`Partial::finish`], it leaves nothing behind but checkpoints.
pub(crate) struct Partial {
    target: PathBuf,
    beside: PathBuf,
    made_parents: Vec<PathBuf>,
    lock: Option<fs::File>,
}

impl Partial {
    /// Prepares to fill `target`; says what stands in the way.
    pub fn begin(target: &Path, existing: Existing) -> Result<Self, JobError> {
        let shown = target.display();
        let refused = |what: String| Err(JobError::Refused(what));
        let Some(beside) = beside(target) else {
            return refused(format!("--out '{shown}': name a new folder"));
        };
        match fs::symlink_metadata(target) {
            Ok(found) if !found.is_dir() => {
                return refused(format!("{shown}: there is a file of that name; choose another --out"));
            }
            Ok(_) if existing != Existing::Replace => {
                return refused(format!(
                    "{shown}: this folder exists; choose another --out, or replace it with --force"
                ));
            }
            Ok(_) if !is_ours(target) => {
                return refused(format!("{shown}: --force replaces worlds only, and this folder has no {MANIFEST}"));
            }
            _ => {}
        }
        let mut partial = Self { target: target.to_owned(), beside, made_parents: Vec::new(), lock: None };
        partial.make().map_err(|cause| match cause.kind() {
            io::ErrorKind::WouldBlock => JobError::Refused(format!("{shown}: another run is growing this world")),
            _ => JobError::Refused(format!("{shown}: cannot make this folder: {}", said(&cause))),
        })?;
        if existing == Existing::Refuse && partial.has_checkpoint() {
            return refused(format!(
                "{shown}: a stopped run of this world is kept; go on with --resume, or start anew with --force"
            ));
        }
        partial.clear(existing).map_err(|cause| JobError::Disk { path: partial.beside.clone(), cause })?;
        Ok(partial)
    }

    fn make(&mut self) -> io::Result<()> {
        let missing: Vec<&Path> =
            self.target.ancestors().skip(1).take_while(|p| !p.as_os_str().is_empty() && !p.exists()).collect();
        for parent in missing.into_iter().rev() {
            fs::create_dir(parent)?;
            self.made_parents.push(parent.to_owned());
        }
        if !self.beside.is_dir() {
            fs::create_dir(&self.beside)?;
        }
        let lock = fs::File::create(self.beside.join("lock"))?;
        match lock.try_lock() {
            Err(fs::TryLockError::WouldBlock) => return Err(io::ErrorKind::WouldBlock.into()),
            // A file system that knows no locks; two runs into one folder are then the user's to avoid.
            Err(fs::TryLockError::Error(_)) | Ok(()) => self.lock = Some(lock),
        }
        Ok(())
    }

    /// Removes what a killed run left, and its checkpoints unless they are wanted.
    fn clear(&self, existing: Existing) -> io::Result<()> {
        remove(&self.path())?;
        if existing != Existing::Resume {
            remove(&self.checkpoints())?;
            remove(&self.timeline())?;
            for notes in ["series.notes", "profiles.notes"] {
                remove_file(&self.beside.join(notes))?;
            }
        }
        fs::create_dir(self.path())?;
        if !self.checkpoints().is_dir() {
            fs::create_dir(self.checkpoints())?;
        }
        Ok(())
    }

    /// Where to write the world.
    pub fn path(&self) -> PathBuf {
        self.beside.join("world")
    }

    /// Where to note what becomes part of the world at the end.
    pub fn beside(&self) -> &Path {
        &self.beside
    }

    /// Where to keep checkpoints.
    pub fn checkpoints(&self) -> PathBuf {
        checkpoints(&self.beside)
    }

    /// Where to keep the timeline while it grows.
    pub fn timeline(&self) -> PathBuf {
        self.beside.join("timeline")
    }

    /// Where to record particles while it grows.
    pub fn bake(&self) -> PathBuf {
        self.beside.join("bake")
    }

    fn has_checkpoint(&self) -> bool {
        has_checkpoint(&self.beside)
    }

    /// Puts the folder in its place.
    pub fn finish(mut self) -> Result<PathBuf, JobError> {
        let disk = |cause| JobError::Disk { path: self.target.clone(), cause };
        let (world, old) = (self.path(), self.beside.join("replaced"));
        remove(&old).map_err(disk)?;
        let replaces = self.target.exists();
        if replaces {
            fs::rename(&self.target, &old).map_err(disk)?;
        }
        if let Err(cause) = fs::rename(&world, &self.target) {
            if replaces {
                // The world that was there goes back; if even that fails it still stands beside.
                let _ = fs::rename(&old, &self.target);
            }
            return Err(disk(cause));
        }
        self.lock = None;
        fs::remove_dir_all(&self.beside).map_err(|cause| JobError::Disk { path: self.beside.clone(), cause })?;
        Ok(self.target.clone())
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // Cleaning up after a failure that is already being told. Without the lock it is another run's folder.
        if self.lock.take().is_some() && self.beside.exists() {
            let _ = match self.has_checkpoint() {
                true => fs::remove_dir_all(self.path()),
                false => fs::remove_dir_all(&self.beside),
            };
        }
        // A parent that others use by now stays.
        for parent in self.made_parents.iter().rev() {
            let _ = fs::remove_dir(parent);
        }
    }
}

/// The folder beside `target` in which it grows.
fn beside(target: &Path) -> Option<PathBuf> {
    let name = target.file_name()?.to_string_lossy();
    Some(target.with_file_name(format!(".{name}.growing")))
}

fn checkpoints(beside: &Path) -> PathBuf {
    beside.join("checkpoints")
}

fn has_checkpoint(beside: &Path) -> bool {
    checkpoints(beside).join("latest").is_file()
}

fn remove(folder: &Path) -> io::Result<()> {
    match fs::remove_dir_all(folder) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

fn remove_file(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

/// Whether a folder may be replaced: a world, or empty.
fn is_ours(folder: &Path) -> bool {
    folder.join(MANIFEST).is_file() || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none())
}

/// The first free one of `stem`, `stem-2`, `stem-3`, ...
pub(crate) fn free(stem: &Path) -> PathBuf {
    numbered(stem).find(|path| !taken(path)).unwrap_or_else(|| stem.to_owned())
}

/// The last one of `stem`, `stem-2`, `stem-3`, ... that is taken, or else `stem`.
pub(crate) fn newest(stem: &Path) -> PathBuf {
    numbered(stem).take_while(|path| taken(path)).last().unwrap_or_else(|| stem.to_owned())
}

fn numbered(stem: &Path) -> impl Iterator<Item = PathBuf> {
    let name = stem.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let rest = (2u32..).map({
        let stem = stem.to_owned();
        move |n| stem.with_file_name(format!("{name}-{n}"))
    });
    std::iter::once(stem.to_owned()).chain(rest)
}

/// Whether a world stands there, or a stopped run is kept for it.
fn taken(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok() || beside(path).is_some_and(|beside| has_checkpoint(&beside))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_of_a_failure() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("a/b/world");
        let partial = Partial::begin(&target, Existing::Refuse).unwrap();
        fs::write(partial.path().join("x"), "x").unwrap();
        drop(partial);
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
        let partial = Partial::begin(&target, Existing::Refuse).unwrap();
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
        assert!(Partial::begin(&target, Existing::Refuse).is_err());
        assert!(Partial::begin(&target, Existing::Replace).is_err());
        fs::write(target.join(MANIFEST), "{}").unwrap();
        drop(Partial::begin(&target, Existing::Replace).unwrap());
        assert!(target.join("photos").is_file());
        Partial::begin(&target, Existing::Replace).unwrap().finish().unwrap();
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
