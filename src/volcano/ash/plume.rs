//! The column as a picture needs it: puffs of smoke, a pure function of time, so that a film may be cut anywhere.
//!
//! A puff leaves the vent, slows as it takes in air, `w = w₀/(1 + t/τ)`, drifts with a wind that grows with height, swells
//! with its rise and fades with its age.

use crate::noise::Key;

/// Smoke from a vent.
#[derive(Clone, Debug, PartialEq)]
pub struct Plume {
    /// The vent, m.
    pub at_m: [f64; 3],
    /// Radius of the vent, m.
    pub radius_m: f64,
    /// Puffs a second.
    pub puffs_per_s: f64,
    /// Speed at which they leave it, m/s.
    pub rise_m_per_s: f64,
    /// Time in which that speed halves, s.
    pub slows_s: f64,
    /// How much a puff's radius grows for a metre of rise.
    pub swell: f64,
    /// Wind at the height `wind_at_m` over the vent, towards east and south, m/s.
    pub wind_m_per_s: [f64; 2],
    /// The height of that wind, m.
    pub wind_at_m: f64,
    /// Mean age at which a puff is gone, s.
    pub lasts_s: f64,
}

/// A puff of smoke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Puff {
    /// Which one, counted from the beginning.
    pub number: u64,
    /// Where, m.
    pub at_m: [f64; 3],
    /// Its radius, m.
    pub radius_m: f64,
    /// Since it left the vent, s.
    pub age_s: f64,
    /// How much of it is to be seen: 0 when it is born and when it is gone, at most 1.
    pub opacity: f64,
    /// How far it has turned, rad.
    pub turn_rad: f64,
}

impl Plume {
    /// The puffs that are in the air at a moment, the oldest first: the same for the same key and moment.
    pub fn puffs(&self, key: Key, at_s: f64) -> Vec<Puff> {
        if !(self.puffs_per_s > 0.0 && self.lasts_s > 0.0 && at_s >= 0.0) {
            return Vec::new();
        }
        // None lasts longer than half as long again as the mean.
        let first = ((at_s - 1.5 * self.lasts_s) * self.puffs_per_s).ceil().max(0.0) as u64;
        let last = (at_s * self.puffs_per_s).floor() as u64;
        (first..=last).filter_map(|number| self.puff(key, number, at_s - number as f64 / self.puffs_per_s)).collect()
    }

    fn puff(&self, key: Key, number: u64, age_s: f64) -> Option<Puff> {
        let mut stream = key.named("plume").with(number).stream();
        let lasts_s = self.lasts_s * stream.between(0.5, 1.5);
        let (angle, off) = (stream.between(0.0, std::f64::consts::TAU), libm::sqrt(stream.unit()));
        let haste = stream.between(0.7, 1.3);
        let spin = stream.between(-0.3, 0.3);
        if age_s < 0.0 || age_s >= lasts_s {
            return None;
        }
        let grown = libm::log1p(age_s / self.slows_s);
        let rise = haste * self.rise_m_per_s * self.slows_s * grown;
        // ∫ z dt for the wind that grows with height: τ·((1 + x)·ln(1 + x) − x) at x = t/τ.
        let x = age_s / self.slows_s;
        let lift = haste * self.rise_m_per_s * self.slows_s * self.slows_s * ((1.0 + x) * grown - x);
        let radius_m = self.radius_m + self.swell * rise;
        let side = [libm::cos(angle), libm::sin(angle)].map(|part| 0.6 * off * radius_m * part);
        let blown = |axis: usize| self.at_m[axis] + side[axis] + self.wind_m_per_s[axis] * lift / self.wind_at_m;
        let share = age_s / lasts_s;
        let opacity = crate::noise::smoothstep(10.0 * share) * (1.0 - share) * (1.0 - share);
        let at_m = [blown(0), blown(1), self.at_m[2] + rise];
        Some(Puff { number, at_m, radius_m, age_s, opacity, turn_rad: angle + spin * age_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plume() -> Plume {
        Plume {
            at_m: [100.0, 200.0, 300.0],
            radius_m: 20.0,
            puffs_per_s: 2.0,
            rise_m_per_s: 30.0,
            slows_s: 20.0,
            swell: 0.3,
            wind_m_per_s: [10.0, 0.0],
            wind_at_m: 1000.0,
            lasts_s: 60.0,
        }
    }

    #[test]
    fn a_puff_is_the_same_whenever_one_looks_and_rises_drifts_swells_and_fades() {
        let (plume, key) = (plume(), Key::new(7));
        assert_eq!(plume.puffs(key, 100.0), plume.puffs(key, 100.0));
        let follow = |number: u64| -> Vec<Puff> {
            (0..900)
                .filter_map(|k| plume.puffs(key, 50.0 + 0.1 * k as f64).into_iter().find(|p| p.number == number))
                .collect()
        };
        let path = follow(100);
        assert!(path.len() > 200);
        assert!(path.windows(2).all(|p| p[1].at_m[2] > p[0].at_m[2] && p[1].radius_m > p[0].radius_m));
        let (start, end) = (path[0], path[path.len() - 1]);
        assert!(start.opacity < 0.01 && end.opacity < 0.01 && end.at_m[0] - start.at_m[0] > 100.0);
        assert!(path.iter().all(|p| (0.0..=1.0).contains(&p.opacity)));
        // Rise without air to slow it: as far as its speed takes it.
        let straight = Plume { slows_s: 1e9, ..plume.clone() };
        let p = straight.puffs(key, 30.0)[0];
        let speed = (p.at_m[2] - 300.0) / p.age_s;
        assert!((20.9..39.1).contains(&speed), "{speed}");
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert!(Plume { puffs_per_s: 0.0, ..plume() }.puffs(Key::new(1), 10.0).is_empty());
        assert!(Plume { lasts_s: 0.0, ..plume() }.puffs(Key::new(1), 10.0).is_empty());
        assert!(plume().puffs(Key::new(1), -1.0).is_empty());
    }
}
