//! How lava's smoke behaves, on maps of some hundred metres.

use super::{params::LavaParams, vents::Source};
use crate::{
    noise::Key,
    volcano::{schedule::Schedule, smoke::Smoke},
    world::{Plume, World},
};

impl LavaParams {
    /// The smoke of an eruption that begins now.
    pub(super) fn plumes(&self, sources: &[Source], schedule: &Schedule, world: &World, key: Key) -> Vec<Plume> {
        let smoke = Smoke {
            rise_m_per_s: self.smoke_m_per_s,
            wind_from_deg: self.wind_from_deg,
            wind_m_per_s: self.wind_m_per_s,
            wind_at_m: 100.0,
            puffs_per_s: 3.0,
            most_per_s: 8.0,
            slows_s: 15.0,
            lasts_s: 40.0,
            swell: 0.2,
        };
        let spans = schedule.spans(60.0 * self.duration_min);
        smoke.plumes(sources.iter().map(|source| &source.vent), &spans, world, key)
    }
}
