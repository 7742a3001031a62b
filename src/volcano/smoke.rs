//! Smoke over vents, for those who draw: as long as lava is due to come out.

use super::outlet::Outlet;
use crate::{
    grid::linear,
    noise::Key,
    world::{Plume, World},
};

/// A fissure has as many more puffs for each stretch of so many of its half widths.
const STRETCH: f64 = 16.0;
/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;

/// How smoke behaves that leaves a vent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoke {
    /// Speed at which it leaves, m/s; 0: there is none.
    pub(super) rise_m_per_s: f64,
    /// Where the wind comes from, and its speed at a height over the vent, m/s, m.
    pub(super) wind_from_deg: f64,
    pub(super) wind_m_per_s: f64,
    pub(super) wind_at_m: f64,
    /// Puffs a second of a vent, and at most of a long fissure.
    pub(super) puffs_per_s: f64,
    pub(super) most_per_s: f64,
    /// How fast their rise slows, and how long they last, s.
    pub(super) slows_s: f64,
    pub(super) lasts_s: f64,
    /// How much wider they get for a metre of rise.
    pub(super) swell: f64,
}

impl Smoke {
    /// The smoke of an eruption that begins now: a plume for each vent and each time, from and to, s, in which lava comes out
    /// without a pause.
    pub(super) fn plumes<'a>(
        &self,
        vents: impl Iterator<Item = &'a Outlet>,
        spans: &[[f64; 2]],
        world: &World,
        key: Key,
    ) -> Vec<Plume> {
        if self.rise_m_per_s <= 0.0 {
            return Vec::new();
        }
        let height = world.height();
        let vents = vents.enumerate().filter(|(_, vent)| vent.share > 0.0);
        vents
            .flat_map(|(k, vent)| spans.iter().enumerate().map(move |(span, times)| (k, vent, span, times)))
            .map(|(k, vent, span, [begin_s, end_s])| Plume {
                at_m: [vent.from_m[0], vent.from_m[1], linear(&height, vent.from_m)],
                along_m: [0, 1].map(|axis| vent.to_m[axis] - vent.from_m[axis]),
                radius_m: vent.radius_m,
                begin_yr: world.time_yr + begin_s / YEAR_S,
                end_yr: world.time_yr + end_s / YEAR_S,
                puffs_per_s: self.puffs_per_s_of(vent),
                rise_m_per_s: self.rise_m_per_s,
                slows_s: self.slows_s,
                swell: self.swell,
                wind_m_per_s: Plume::wind(self.wind_from_deg, self.wind_m_per_s),
                wind_at_m: self.wind_at_m,
                lasts_s: self.lasts_s,
                seed: Plume::seed(key.with(k as u64).with(span as u64)),
            })
            .collect()
    }

    fn puffs_per_s_of(&self, vent: &Outlet) -> f64 {
        let [x, y] = [0, 1].map(|axis| vent.to_m[axis] - vent.from_m[axis]);
        let stretches = libm::hypot(x, y) / (STRETCH * vent.radius_m.max(1.0));
        (self.puffs_per_s * (1.0 + stretches)).min(self.most_per_s)
    }
}
