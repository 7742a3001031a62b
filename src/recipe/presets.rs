//! The recipes that come with the program.

use std::path::PathBuf;

use super::{
    error::{Problem, RecipeError},
    source::Source,
};

/// A built-in recipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
    /// Files it uses, by the name in its text.
    pub files: &'static [(&'static str, &'static [u8])],
}

macro_rules! presets {
    ($($name:literal $([$($file:literal),*])?;)*) => {
        &[$(Preset {
            name: $name,
            text: include_str!(concat!("../../presets/", $name, ".toml")),
            files: &[$($(($file, include_bytes!(concat!("../../presets/", $file)))),*)?],
        }),*]
    };
}

/// Every preset, in the order in which a reader meets them. A preset's own files stand after its name in brackets.
const ALL: &[Preset] = presets! {
    "fbm-smooth";
    "fbm-rough";
    "multifractal-range";
    "warped-terraces";
    "diamond-square";
    "fault-blocks";
    "rmp-peak";
    "rmp-ridge";
    "rmp-graph";
};

/// Every preset.
pub fn all() -> &'static [Preset] {
    ALL
}

/// The preset of that name.
pub fn find(name: &str) -> Option<&'static Preset> {
    ALL.iter().find(|preset| preset.name == name)
}

impl Preset {
    /// Its title and description: the values of the first two keys.
    pub fn summary(&self) -> (String, String) {
        let root = super::tree::parse(self.text, self.name).unwrap_or_default();
        let text = |key: &str| match root.get(key).map(|node| &node.value) {
            Some(super::tree::Value::Text(text)) => text.clone(),
            _ => String::new(),
        };
        (text("name"), text("description"))
    }

    /// The recipe, its files laid out where a stage can read them.
    pub fn source(&self) -> Result<Source, RecipeError> {
        let folder = if self.files.is_empty() { PathBuf::new() } else { self.unpack()? };
        Ok(Source { name: self.name.to_owned(), file: self.name.to_owned(), folder, text: self.text.to_owned() })
    }

    /// Writes the preset's files to the system's temporary folder, in a folder named after what they hold, so that
    /// several runs and versions share them safely.
    fn unpack(&self) -> Result<PathBuf, RecipeError> {
        use sha2::Digest;
        let mut hash = sha2::Sha256::new();
        self.files.iter().for_each(|(_, bytes)| hash.update(bytes));
        let tag: String = hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
        let folder = std::env::temp_dir().join(format!("upthrust-{}-{tag}", self.name));
        let write = || -> std::io::Result<()> {
            std::fs::create_dir_all(&folder)?;
            for (name, bytes) in self.files {
                let path = folder.join(name);
                if std::fs::read(&path).is_ok_and(|there| there == *bytes) {
                    continue;
                }
                let beside = folder.join(format!(".{name}.{}", std::process::id()));
                std::fs::write(&beside, bytes)?;
                std::fs::rename(&beside, &path)?;
            }
            Ok(())
        };
        let refuse = |e: std::io::Error| RecipeError {
            at: self.name.to_owned(),
            problem: Box::new(Problem::Unreadable(format!("cannot lay out its files in {}: {e}", folder.display()))),
        };
        write().map_err(refuse)?;
        Ok(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_listed_and_begins_with_its_name() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
        let mut there: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
            .collect();
        let mut listed: Vec<String> = ALL.iter().map(|preset| preset.name.to_owned()).collect();
        there.sort();
        listed.sort();
        assert_eq!(there, listed);
        for preset in ALL {
            assert!(preset.text.starts_with("name = \""), "{}", preset.name);
            let (name, description) = preset.summary();
            assert!(!name.is_empty() && !description.is_empty() && !description.contains('\n'), "{}", preset.name);
        }
    }
}
