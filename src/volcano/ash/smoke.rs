//! The eruption column, for those who draw: it stands at the moment at which its ash has fallen, and ends with it.

use super::params::AshParams;
use crate::{
    grid::linear,
    noise::Key,
    world::{Plume, World},
};

/// Density of ash as it lies over that of the magma it was.
const LOOSE: f64 = 0.4;
/// A column of `H` km has magma of `(H/2)^(1/0.241)` m³/s (Mastin et al., J. Volcanol. Geotherm. Res. 186 (2009), 10–21).
const MASTIN: [f64; 2] = [2.0, 0.241];
/// How long puffs are seen, s, how fast their rise slows, s, and how many there are a second.
const LASTS_S: f64 = 1500.0;
const SLOWS_S: f64 = 120.0;
const PUFFS_PER_S: f64 = 0.3;
/// Radius of a vent of which nothing is known, m.
const RADIUS_M: f64 = 100.0;
/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;

impl AshParams {
    /// How long the eruption of this volume lasted, s.
    fn lasted_s(&self) -> f64 {
        let [factor, power] = MASTIN;
        1e9 * self.volume_km3 * LOOSE / libm::pow(self.column_km / factor, 1.0 / power)
    }

    /// One of so many columns, which stands until now.
    pub(super) fn plume(&self, at_m: [f64; 2], of: usize, world: &World, key: Key) -> Plume {
        let top_m = 1e3 * self.column_km;
        let extent = world.grid.extent_m();
        let on_map = [0, 1].map(|axis| at_m[axis].clamp(0.0, extent[axis]));
        Plume {
            at_m: [at_m[0], at_m[1], linear(&world.height(), on_map)],
            along_m: [0.0; 2],
            radius_m: RADIUS_M.min(self.width * top_m),
            begin_yr: world.time_yr - self.lasted_s() / of.max(1) as f64 / YEAR_S,
            end_yr: world.time_yr,
            puffs_per_s: PUFFS_PER_S,
            // As high as the column when it is as old as they get in the mean.
            rise_m_per_s: top_m / (SLOWS_S * libm::log1p(LASTS_S / SLOWS_S)),
            slows_s: SLOWS_S,
            swell: self.width,
            wind_m_per_s: Plume::wind(self.wind_from_deg, self.wind_m_per_s),
            // The wind is the mean of the column.
            wind_at_m: 0.5 * top_m,
            lasts_s: LASTS_S,
            seed: Plume::seed(key),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn the_column_is_as_high_as_its_ash_fell_from_and_stands_when_it_has_fallen() {
        let mut world = World::new(Grid::new(10, 10, 50e3, Edges::Open), 0.0);
        world.time_yr = 7.0;
        let ash = AshParams::default();
        let plume = ash.plume([25e3, 25e3], 1, &world, Key::new(1));
        assert!(plume.erupts(7.0) && !plume.erupts(7.0 + 1e-6));
        // 0.04 km³ of magma at 6^(1/0.241) = 1696 m³/s: 6.6 h.
        let hours = (plume.end_yr - plume.begin_yr) * YEAR_S / 3600.0;
        assert!((hours - 6.55).abs() < 0.05, "{hours}");
        let puffs = plume.puffs(7.0);
        let highest = puffs.iter().map(|puff| puff.at_m[2]).fold(0.0, f64::max);
        // Haste is up to 1.3 times the mean, and ages half as long again.
        assert!((10e3..19e3).contains(&highest) && puffs.len() > 200, "{highest} {}", puffs.len());
        // West wind: smoke lies east of the vent.
        let east = puffs.iter().map(|puff| puff.at_m[0] - 25e3).sum::<f64>() / puffs.len() as f64;
        assert!(east > 500.0, "{east}");
        assert_ne!(plume.seed, ash.plume([25e3, 25e3], 1, &world, Key::new(2)).seed);
    }
}
