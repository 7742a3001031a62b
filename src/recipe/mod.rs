//! Recipes: TOML in, a validated [`Plan`] out; presets; what every parameter is; the JSON schema.
//!
//! A recipe is read into a tree that knows its lines, flags are laid over the tree, and the tree is held against the
//! schema of each stage. Only what passed reaches serde. Whoever holds a [`Plan`] can trust it. This room runs nothing.

mod error;
mod imports;
mod near;
mod overrides;
mod params;
mod plan;
mod presets;
#[cfg(test)]
mod probe;
mod scene;
mod schema;
mod source;
mod stage;
mod stages;
#[cfg(test)]
mod tests;
mod tree;
mod world;

pub use error::{Problem, RecipeError};
pub(crate) use near::nearest;
pub use overrides::Overrides;
pub use params::{Parameter, json_schema, markdown, parameters, scene_parameters, world_parameters};
pub use plan::Plan;
pub use presets::{Preset, all as presets, find as find_preset};
pub use scene::{read_camera, read_scene};
pub use source::Source;
pub use stage::{FilmTime, Stage};
pub use stages::{Setting, StageKind, all as stage_kinds, find as find_stage};
pub use world::{Size, WorldParams};
