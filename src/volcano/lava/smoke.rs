//! Smoke over the vents, for those who draw: as long as lava is due to come out.

use super::{params::LavaParams, vents::Source};
use crate::{
    grid::linear,
    noise::Key,
    volcano::{outlet::Outlet, schedule::Schedule},
    world::{Plume, World},
};

/// Puffs a second of a vent; a fissure has as many more for each stretch of so many of its half widths, at most so many.
const PUFFS_PER_S: f64 = 3.0;
const STRETCH: f64 = 16.0;
const MOST_PER_S: f64 = 8.0;
/// How fast their rise slows, s, how long they last, s, and how much wider they get for a metre of rise.
const SLOWS_S: f64 = 15.0;
const LASTS_S: f64 = 40.0;
const SWELL: f64 = 0.2;
/// Height over the vent at which the wind is that of the recipe, m.
const WIND_AT_M: f64 = 100.0;
/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;

/// Puffs a second of a vent.
fn puffs_per_s(vent: &Outlet) -> f64 {
    let [x, y] = [0, 1].map(|axis| vent.to_m[axis] - vent.from_m[axis]);
    let stretches = libm::hypot(x, y) / (STRETCH * vent.radius_m.max(1.0));
    (PUFFS_PER_S * (1.0 + stretches)).min(MOST_PER_S)
}

impl LavaParams {
    /// The smoke of an eruption that begins now: a plume for each vent and each time in which lava comes out without a pause.
    pub(super) fn plumes(&self, sources: &[Source], schedule: &Schedule, world: &World, key: Key) -> Vec<Plume> {
        if self.smoke_m_per_s <= 0.0 {
            return Vec::new();
        }
        let height = world.height();
        let spans = schedule.spans(60.0 * self.duration_min);
        let vents = sources.iter().map(|source| &source.vent).enumerate().filter(|(_, vent)| vent.share > 0.0);
        vents
            .flat_map(|(k, vent)| spans.iter().enumerate().map(move |(span, times)| (k, vent, span, times)))
            .map(|(k, vent, span, [begin_s, end_s])| Plume {
                at_m: [vent.from_m[0], vent.from_m[1], linear(&height, vent.from_m)],
                along_m: [0, 1].map(|axis| vent.to_m[axis] - vent.from_m[axis]),
                radius_m: vent.radius_m,
                begin_yr: world.time_yr + begin_s / YEAR_S,
                end_yr: world.time_yr + end_s / YEAR_S,
                puffs_per_s: puffs_per_s(vent),
                rise_m_per_s: self.smoke_m_per_s,
                slows_s: SLOWS_S,
                swell: SWELL,
                wind_m_per_s: Plume::wind(self.wind_from_deg, self.wind_m_per_s),
                wind_at_m: WIND_AT_M,
                lasts_s: LASTS_S,
                seed: Plume::seed(key.with(k as u64).with(span as u64)),
            })
            .collect()
    }
}
