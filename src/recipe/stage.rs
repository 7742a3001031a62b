//! One stage of a plan: what it is, what it is set to, and whose time it takes.

use serde_json::Value as Json;

use crate::process::{Placement, Process, ProcessError};

use super::{Setting, StageKind};

/// One stage of a plan.
#[derive(Clone, Debug)]
pub struct Stage {
    /// What it is.
    pub kind: &'static StageKind,
    /// Its name for random numbers and the ledger: its id, or kind#ordinal.
    pub key: String,
    /// Its name for people: its id, its kind where that is the only one, or kind#ordinal.
    pub label: String,
    /// Whether it runs.
    pub enabled: bool,
    /// Blend and mask.
    pub placement: Placement,
    /// An expert's number of steps.
    pub steps: Option<u64>,
    /// How long it takes in a film; its share of the usual length where it does not say.
    pub film: Option<FilmTime>,
    /// Its own parameters.
    pub params: Json,
    /// The stages that step in turn with it.
    pub coupled: Vec<Stage>,
}

/// How long a stage takes in a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilmTime {
    /// So many seconds.
    Seconds(f64),
    /// A second for so many years of the world.
    YearsPerSecond(f64),
}

impl Stage {
    /// Whether it takes time in the world: it has a duration among its parameters.
    pub fn takes_time(&self) -> bool {
        let defaults = self.kind.defaults.as_object();
        defaults.is_some_and(|keys| keys.keys().any(|key| key.starts_with("duration_")))
    }

    /// Years that it is to last, by its parameters; 0 where it takes no time.
    pub fn duration_yr(&self) -> f64 {
        const HOURS_PER_YEAR: f64 = 365.25 * 24.0;
        let units = [
            ("yr", 1.0),
            ("kyr", 1e3),
            ("myr", 1e6),
            ("h", 1.0 / HOURS_PER_YEAR),
            ("min", 1.0 / HOURS_PER_YEAR / 60.0),
        ];
        let of = |(unit, years): (&str, f64)| {
            let key = format!("duration_{unit}");
            Some(self.params.get(&key).or(self.kind.defaults.get(&key))?.as_f64()? * years)
        };
        units.into_iter().find_map(of).unwrap_or(0.0)
    }

    /// Whether its time is that of weather and not of the Earth: minutes or hours of water, which move no mountain.
    pub fn takes_hours(&self) -> bool {
        ["duration_min", "duration_h"].iter().any(|key| self.kind.defaults.get(key).is_some())
    }

    /// A fresh process.
    pub fn build(&self) -> Result<Box<dyn Process>, ProcessError> {
        let leads = !self.coupled.is_empty();
        self.kind.build(&self.params, Setting { placement: self.placement.clone(), steps: self.steps, leads })
    }

    /// Whether it asks to step in turn with the stage before it.
    pub(super) fn follows(&self) -> bool {
        self.params["coupled"] == Json::Bool(true)
    }

    /// Whether a name means it.
    pub(super) fn is_called(&self, name: &str) -> bool {
        self.label == name || self.key == name
    }
}
