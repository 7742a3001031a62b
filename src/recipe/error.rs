//! What can be wrong with a recipe, said in one line: where, what, and what to do.

use std::fmt;

use super::tree::Place;

/// A recipe that cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}: {problem}")]
pub struct RecipeError {
    /// `file:line`, or the flag.
    pub at: String,
    /// What is wrong there.
    pub problem: Box<Problem>,
}

impl RecipeError {
    pub(crate) fn new(file: &str, place: &Place, problem: Problem) -> Self {
        let at = match place {
            Place::Line(line) => format!("{file}:{line}"),
            Place::File => file.to_owned(),
            Place::Flag(flag) => flag.clone(),
        };
        Self { at, problem: Box::new(problem) }
    }
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// There is no such file or preset, or it cannot be read.
    Unreadable(String),
    /// It is not TOML.
    Syntax(String),
    /// A key nobody knows.
    UnknownKey {
        /// The key as written.
        key: String,
        /// Where it stands: `stage 'thermal'`, `[world]`.
        within: String,
        /// What was probably meant, or where to look.
        hint: String,
    },
    /// A stage kind nobody knows.
    UnknownKind {
        /// The kind as written.
        kind: String,
        /// What was probably meant, or all kinds.
        hint: String,
    },
    /// A key that must be there is not.
    MissingKey {
        /// The key.
        key: String,
        /// Where it belongs.
        within: String,
    },
    /// A value of another type.
    WrongType {
        /// The key.
        key: String,
        /// Where it stands.
        within: String,
        /// What it must be.
        wanted: String,
        /// What it is.
        found: String,
    },
    /// A number outside its range, a word outside its choices.
    OutOfRange {
        /// The key.
        key: String,
        /// Where it stands.
        within: String,
        /// What is allowed, with the unit.
        wanted: String,
        /// What was written.
        found: String,
    },
    /// Two stages with one id.
    DuplicateId {
        /// The id.
        id: String,
        /// Where the first one stands.
        first: String,
    },
    /// A flag names a stage that is not there, or one of several.
    NoSuchStage {
        /// The name in the flag.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A stage needs a layer that no earlier stage makes.
    AbsentLayer {
        /// The stage.
        stage: String,
        /// The layer.
        layer: &'static str,
    },
    /// Everything else, in the words of whoever found it.
    Unfit(String),
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::Unreadable(what) | Problem::Syntax(what) | Problem::Unfit(what) => f.write_str(what),
            Problem::UnknownKey { key, within, hint } => {
                let noun = if within.contains("stage '") { "parameter" } else { "key" };
                write!(f, "unknown {noun} {} in {within} ({hint})", super::tree::quoted(key))
            }
            Problem::UnknownKind { kind, hint } => {
                write!(f, "unknown stage kind {} ({hint})", super::tree::quoted(kind))
            }
            Problem::MissingKey { key, within } => write!(f, "{within} lacks '{key}'"),
            Problem::WrongType { key, within, wanted, found } | Problem::OutOfRange { key, within, wanted, found } => {
                write!(f, "'{key}' in {within} must be {wanted}, not {found}")
            }
            Problem::DuplicateId { id, first } => {
                write!(f, "stage id '{id}' is already taken by the stage at {first}; give each stage its own id")
            }
            Problem::NoSuchStage { name, known } => {
                write!(f, "no stage {} (this recipe has: {known})", super::tree::quoted(name))
            }
            Problem::AbsentLayer { stage, layer } => write!(
                f,
                "stage '{stage}' needs the layer '{layer}', which no earlier stage makes; put such a stage before it"
            ),
        }
    }
}
