//! Where a recipe's text comes from: a preset, or a file.

use std::path::{Path, PathBuf};

use super::{
    error::{Problem, RecipeError},
    near::nearest,
    presets,
    tree::{Place, quoted},
};

/// A recipe's text, and what its paths are relative to.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Short name, for folders: the preset's, or the file's without its ending.
    pub name: String,
    /// The name in messages.
    pub file: String,
    /// The folder that paths in it are relative to.
    pub folder: PathBuf,
    /// The text.
    pub text: String,
}

impl Source {
    /// The preset or file that was asked for. What looks like a path is one; any other word is first a preset.
    pub fn find(asked: &str) -> Result<Self, RecipeError> {
        let path = Path::new(asked);
        let looks_like_path = asked.contains(['/', '\\']) || asked.ends_with(".toml");
        if !looks_like_path && let Some(preset) = presets::find(asked) {
            return Ok(preset.source());
        }
        if looks_like_path || path.is_file() {
            return Self::read(path);
        }
        let hint = match nearest(asked, presets::all().iter().map(|preset| preset.name)) {
            Some(near) => format!("did you mean '{near}'?"),
            None => "`upthrust presets` lists the presets; a file is named with its ending .toml".to_owned(),
        };
        let problem = Problem::Unreadable(format!("no preset of that name ({hint})"));
        Err(RecipeError { at: quoted(asked).trim_matches('\'').to_owned(), problem: Box::new(problem) })
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, RecipeError> {
        let file = path.display().to_string();
        let refuse = |what: String| RecipeError::new(&file, &Place::File, Problem::Unreadable(what));
        if path.is_dir() {
            return Err(refuse("this is a folder; name a recipe file in it".into()));
        }
        /// No recipe is longer; stops a mistaken picture or device before it fills the memory.
        const LONGEST_BYTES: u64 = 16 << 20;
        let bytes = std::fs::File::open(path)
            .and_then(|opened| {
                let mut bytes = Vec::new();
                std::io::Read::read_to_end(&mut std::io::Read::take(opened, LONGEST_BYTES + 1), &mut bytes)?;
                Ok(bytes)
            })
            .map_err(|e| match e.kind() {
                std::io::ErrorKind::NotFound => refuse("there is no such file".into()),
                _ => refuse(format!("cannot be read: {e}")),
            })?;
        if bytes.len() as u64 > LONGEST_BYTES {
            return Err(refuse("too long for a recipe (more than 16 MiB)".into()));
        }
        let text = String::from_utf8(bytes).map_err(|e| {
            let line = 1 + e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|&&b| b == b'\n').count();
            let problem = Problem::Unreadable("not a text in UTF-8; a recipe is a TOML file".into());
            RecipeError::new(&file, &Place::Line(line), problem)
        })?;
        let stem = path.file_stem().map_or_else(|| "world".into(), |stem| stem.to_string_lossy().into_owned());
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Ok(Self { name: stem, file, folder, text })
    }
}
