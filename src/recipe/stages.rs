//! The registry of stages: one row a kind. To add a stage, add its row to `table`.

use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::process::{Placement, Process, ProcessError};

use super::schema;

/// What every stage is given besides its own parameters.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// Blend and mask.
    pub placement: Placement,
    /// An expert's number of steps.
    pub steps: Option<u64>,
}

type Build = Box<dyn Fn(&Json, Setting) -> Result<Box<dyn Process>, ProcessError> + Send + Sync>;

/// One kind of stage.
pub struct StageKind {
    /// The name in a recipe.
    pub kind: &'static str,
    /// The name for people.
    pub title: &'static str,
    /// What it does, in a sentence.
    pub about: &'static str,
    /// Whether its heights join by `blend`.
    pub blends: bool,
    /// JSON schema of its own parameters.
    pub schema: Json,
    /// Its parameters' defaults.
    pub defaults: Json,
    build: Build,
}

impl std::fmt::Debug for StageKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StageKind").field("kind", &self.kind).finish_non_exhaustive()
    }
}

impl StageKind {
    /// The process for validated parameters.
    pub fn build(&self, params: &Json, setting: Setting) -> Result<Box<dyn Process>, ProcessError> {
        (self.build)(params, setting)
    }
}

/// A row of the registry: a stage whose heights join by `blend` and `mask`.
fn ground<P>(
    kind: &'static str,
    title: &'static str,
    about: &'static str,
    make: fn(P, Placement) -> Box<dyn Process>,
) -> StageKind
where
    P: Default + Serialize + DeserializeOwned + JsonSchema + 'static,
{
    let build = move |params: P, setting: Setting| Ok(make(params, setting.placement));
    StageKind { blends: true, ..row(kind, title, about, build) }
}

/// A row of the registry: any stage.
fn row<P>(
    kind: &'static str,
    title: &'static str,
    about: &'static str,
    make: impl Fn(P, Setting) -> Result<Box<dyn Process>, ProcessError> + Send + Sync + 'static,
) -> StageKind
where
    P: Default + Serialize + DeserializeOwned + JsonSchema,
{
    let build = move |params: &Json, setting: Setting| {
        let params = serde_json::from_value(params.clone()).map_err(|e| ProcessError::Unfit(e.to_string()))?;
        make(params, setting)
    };
    let defaults = serde_json::to_value(P::default()).unwrap_or_default();
    StageKind { kind, title, about, blends: false, schema: schema::of::<P>(), defaults, build: Box::new(build) }
}

fn table() -> Vec<StageKind> {
    vec![
        #[cfg(test)]
        ground("probe", "Probe", "A level ground for tests.", super::probe::ProbeParams::process),
        #[cfg(test)]
        row("drip", "Drip", "Adds a metre a step, for tests.", super::probe::DripParams::process),
    ]
}

/// Every stage kind, in the order in which a reader meets them.
pub fn all() -> &'static [StageKind] {
    static ALL: OnceLock<Vec<StageKind>> = OnceLock::new();
    ALL.get_or_init(table)
}

/// The stage of that kind.
pub fn find(kind: &str) -> Option<&'static StageKind> {
    all().iter().find(|stage| stage.kind == kind)
}
