//! Plumes of smoke: stages that erupt write them, those that draw read them. A table, so that they are stored and carried along
//! like vents; the puffs are a pure function of time, so that a film may be cut anywhere.
//!
//! A puff leaves the vent, slows as it takes in air, `w = w₀/(1 + t/τ)`, drifts with a wind that grows with height, swells
//! with its rise and fades with its age.

use super::{Table, World};
use crate::noise::{Key, smoothstep};

/// The table of plumes.
const PLUMES: &str = "plumes";
/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;
/// Puffs of a plume in the air, at most: more cannot be told apart.
const MOST_PUFFS: f64 = 5000.0;

/// Smoke from a vent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plume {
    /// The vent, or where a fissure begins: from the map's north-west corner, and over the world's datum, m.
    pub at_m: [f64; 3],
    /// From there to where a fissure ends, m; 0 for a vent.
    pub along_m: [f64; 2],
    /// Radius of the vent, or half a fissure's width, m.
    pub radius_m: f64,
    /// When it begins, on the world's clock, years.
    pub begin_yr: f64,
    /// When the last puff leaves, years.
    pub end_yr: f64,
    /// Puffs a second.
    pub puffs_per_s: f64,
    /// Speed at which they leave the vent, m/s.
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
    /// Names its random numbers; a whole number below 2^53, which a table holds.
    pub seed: f64,
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
    /// Share of its life that is over, 0 to 1.
    pub spent: f64,
    /// How much of it is to be seen: 0 when it is born and when it is gone, at most 1.
    pub opacity: f64,
    /// How far it has turned, rad.
    pub turn_rad: f64,
}

/// A column of the table: name, unit, and where its number stands in a plume.
type Column = (&'static str, &'static str, fn(&mut Plume) -> &mut f64);

/// The columns of the table.
const COLUMNS: [Column; 17] = [
    ("x_m", "m", |plume| &mut plume.at_m[0]),
    ("y_m", "m", |plume| &mut plume.at_m[1]),
    ("z_m", "m", |plume| &mut plume.at_m[2]),
    ("along_x_m", "m", |plume| &mut plume.along_m[0]),
    ("along_y_m", "m", |plume| &mut plume.along_m[1]),
    ("radius_m", "m", |plume| &mut plume.radius_m),
    ("begin_yr", "yr", |plume| &mut plume.begin_yr),
    ("end_yr", "yr", |plume| &mut plume.end_yr),
    ("puffs_per_s", "1/s", |plume| &mut plume.puffs_per_s),
    ("rise_m_per_s", "m/s", |plume| &mut plume.rise_m_per_s),
    ("slows_s", "s", |plume| &mut plume.slows_s),
    ("swell", "1", |plume| &mut plume.swell),
    ("wind_x_m_per_s", "m/s", |plume| &mut plume.wind_m_per_s[0]),
    ("wind_y_m_per_s", "m/s", |plume| &mut plume.wind_m_per_s[1]),
    ("wind_at_m", "m", |plume| &mut plume.wind_at_m),
    ("lasts_s", "s", |plume| &mut plume.lasts_s),
    ("seed", "1", |plume| &mut plume.seed),
];

impl Plume {
    /// A seed for a plume under this key.
    pub fn seed(key: Key) -> f64 {
        (key.named("plume").stream().bits() >> 11) as f64
    }

    /// Wind from a compass direction (0 north, 90 east), towards east and south.
    pub fn wind(from_deg: f64, m_per_s: f64) -> [f64; 2] {
        let towards = (from_deg + 180.0).to_radians();
        [libm::sin(towards), -libm::cos(towards)].map(|part| part * m_per_s)
    }

    /// Whether smoke leaves the vent at a moment of the world's clock.
    pub fn erupts(&self, time_yr: f64) -> bool {
        (self.begin_yr..=self.end_yr).contains(&time_yr)
    }

    /// The puffs that are in the air at a moment of the world's clock, the oldest first.
    pub fn puffs(&self, time_yr: f64) -> Vec<Puff> {
        let at_s = (time_yr - self.begin_yr) * YEAR_S;
        let rate = self.puffs_per_s.min(MOST_PUFFS / self.lasts_s.max(1e-9));
        let good = rate > 0.0 && self.lasts_s > 0.0 && self.slows_s > 0.0 && self.wind_at_m > 0.0;
        if !good || !at_s.is_finite() || at_s < 0.0 {
            return Vec::new();
        }
        let leaves_s = at_s.min((self.end_yr - self.begin_yr) * YEAR_S);
        // None lasts longer than half as long again as the mean.
        let first = ((at_s - 1.5 * self.lasts_s) * rate).ceil().max(0.0) as u64;
        let last = (leaves_s * rate).floor() as u64;
        (first..=last).filter_map(|number| self.puff(number, at_s - number as f64 / rate)).collect()
    }

    fn puff(&self, number: u64, age_s: f64) -> Option<Puff> {
        let mut stream = Key::new(self.seed as u64).with(number).stream();
        let lasts_s = self.lasts_s * stream.between(0.5, 1.5);
        let (angle, off) = (stream.between(0.0, std::f64::consts::TAU), libm::sqrt(stream.unit()));
        let haste = stream.between(0.7, 1.3);
        let spin = stream.between(-0.3, 0.3);
        let along = stream.unit();
        if age_s < 0.0 || age_s >= lasts_s {
            return None;
        }
        let x = age_s / self.slows_s;
        let grown = libm::log1p(x);
        let rise = haste * self.rise_m_per_s * self.slows_s * grown;
        // ∫ z dt for the wind that grows with height: τ·((1 + x)·ln(1 + x) − x) at x = t/τ.
        let lift = haste * self.rise_m_per_s * self.slows_s * self.slows_s * ((1.0 + x) * grown - x);
        let radius_m = self.radius_m + self.swell * rise;
        let side = [libm::cos(angle), libm::sin(angle)].map(|part| 0.6 * off * radius_m * part);
        let blown = |axis: usize| {
            let from = self.at_m[axis] + along * self.along_m[axis] + side[axis];
            from + self.wind_m_per_s[axis] * lift / self.wind_at_m
        };
        let spent = age_s / lasts_s;
        let opacity = smoothstep(10.0 * spent) * (1.0 - spent) * (1.0 - spent);
        let at_m = [blown(0), blown(1), self.at_m[2] + rise];
        Some(Puff { number, at_m, radius_m, age_s, spent, opacity, turn_rad: angle + spin * age_s })
    }
}

impl World {
    /// The plumes that there are or were, in the order in which they were written.
    pub fn plumes(&self) -> Vec<Plume> {
        let Some(table) = self.table(PLUMES) else { return Vec::new() };
        let mut plumes = vec![Plume::default(); table.rows()];
        for (name, _, place) in COLUMNS {
            let Some(numbers) = table.numbers(name) else { return Vec::new() };
            plumes.iter_mut().zip(numbers).for_each(|(plume, &number)| *place(plume) = number);
        }
        plumes
    }

    /// Adds plumes to those that are there.
    pub fn add_plumes(&mut self, new: &[Plume]) {
        let mut plumes = self.plumes();
        plumes.extend(new);
        if plumes.is_empty() {
            return;
        }
        let table = COLUMNS.iter().fold(Table::new(PLUMES), |table, (name, unit, place)| {
            table.number(name, unit, plumes.iter_mut().map(|plume| *place(plume)).collect())
        });
        self.set_table(table);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    const SECOND: f64 = 1.0 / YEAR_S;

    fn plume() -> Plume {
        Plume {
            at_m: [100.0, 200.0, 300.0],
            along_m: [0.0, 0.0],
            radius_m: 20.0,
            begin_yr: 0.0,
            end_yr: 1000.0 * SECOND,
            puffs_per_s: 2.0,
            rise_m_per_s: 30.0,
            slows_s: 20.0,
            swell: 0.3,
            wind_m_per_s: [10.0, 0.0],
            wind_at_m: 1000.0,
            lasts_s: 60.0,
            seed: 7.0,
        }
    }

    #[test]
    fn a_puff_is_the_same_whenever_one_looks_and_rises_drifts_swells_and_fades() {
        let plume = plume();
        assert_eq!(plume.puffs(100.0 * SECOND), plume.puffs(100.0 * SECOND));
        let follow = |number: u64| -> Vec<Puff> {
            let at = |k: usize| plume.puffs((50.0 + 0.1 * k as f64) * SECOND);
            (0..900).filter_map(|k| at(k).into_iter().find(|p| p.number == number)).collect()
        };
        let path = follow(100);
        assert!(path.len() > 200);
        assert!(path.windows(2).all(|p| p[1].at_m[2] > p[0].at_m[2] && p[1].radius_m > p[0].radius_m));
        assert!(path.windows(2).all(|p| (p[1].age_s - p[0].age_s - 0.1).abs() < 1e-6 && p[1].spent > p[0].spent));
        let (start, end) = (path[0], path[path.len() - 1]);
        assert!(start.opacity < 0.01 && end.opacity < 0.01 && end.at_m[0] - start.at_m[0] > 100.0);
        assert!(path.iter().all(|p| (0.0..=1.0).contains(&p.opacity)));
        // Born at the vent's radius, and as much wider as it has risen.
        for puff in &path {
            let rise = puff.at_m[2] - 300.0;
            assert!((puff.radius_m - 20.0 - 0.3 * rise).abs() < 1e-9, "{puff:?}");
        }
        // Rise without air to slow it: as far as its speed takes it.
        let straight = Plume { slows_s: 1e9, ..plume };
        let p = straight.puffs(30.0 * SECOND)[0];
        let speed = (p.at_m[2] - 300.0) / p.age_s;
        assert!((20.9..39.1).contains(&speed), "{speed}");
        // And where the wind stands, as high as that: half of it times its own height over the wind's, for so long.
        let drift = p.at_m[0] - Plume { wind_m_per_s: [0.0; 2], ..straight }.puffs(30.0 * SECOND)[0].at_m[0];
        let want = 10.0 * 0.5 * speed * p.age_s * p.age_s / 1000.0;
        assert!((drift / want - 1.0).abs() < 1e-6, "{drift} {want}");
    }

    #[test]
    fn it_ends_when_the_eruption_does() {
        let short = Plume { begin_yr: 5.0, end_yr: 5.0 + 10.2 * SECOND, ..plume() };
        let numbers = |at_s: f64| short.puffs(5.0 + at_s * SECOND).iter().map(|p| p.number).collect::<Vec<_>>();
        // One each half second from the beginning to the end. Moments lie between those: years are known to some 1e-8 s here.
        assert_eq!(numbers(3.05), (0..=6).collect::<Vec<_>>());
        assert_eq!(numbers(12.05).last(), Some(&20));
        assert_eq!((numbers(-1.0), numbers(10.0 + 91.0)), (vec![], vec![]));
        assert_eq!([4.9, 5.0, 5.0 + 10.2 * SECOND, 5.1].map(|yr| short.erupts(yr)), [false, true, true, false]);
    }

    #[test]
    fn another_seed_is_other_smoke_and_a_fissure_smokes_along_its_line() {
        let at = 100.0 * SECOND;
        assert_ne!(Plume { seed: 8.0, ..plume() }.puffs(at), plume().puffs(at));
        let line = Plume { along_m: [0.0, 4000.0], radius_m: 0.0, swell: 0.0, wind_m_per_s: [0.0; 2], ..plume() };
        let south: Vec<f64> = line.puffs(at).iter().map(|p| p.at_m[1] - 200.0).collect();
        assert!(south.iter().all(|m| (0.0..=4000.0).contains(m)));
        // Some 120 of them, evenly: none of the four quarters has less than half its share but once in 10^5.
        assert!((0..4).all(|q| south.iter().filter(|m| (**m / 1000.0) as i32 == q).count() > 12), "{south:?}");
        assert_eq!(Plume::wind(270.0, 10.0).map(|v| v.round()), [10.0, 0.0]);
        assert_eq!(Plume::wind(0.0, 10.0).map(|v| v.round()), [0.0, 10.0]);
    }

    #[test]
    fn nothing_comes_of_nothing() {
        for none in [Plume { puffs_per_s: 0.0, ..plume() }, Plume { lasts_s: 0.0, ..plume() }] {
            assert!(none.puffs(10.0 * SECOND).is_empty());
        }
        assert!(plume().puffs(-SECOND).is_empty() && plume().puffs(f64::NAN).is_empty());
        // Nor too much of too much.
        assert!(Plume { puffs_per_s: 1e9, ..plume() }.puffs(500.0 * SECOND).len() <= 7501);
    }

    #[test]
    fn a_world_carries_them() {
        let mut world = World::new(Grid::new(4, 4, 4.0, Edges::Open), 0.0);
        world.add_plumes(&[]);
        assert_eq!((world.plumes(), world.table(PLUMES)), (vec![], None));
        // Another number in every place, so that no two can change places unseen.
        let mut other = plume();
        for (column, (_, _, place)) in COLUMNS.iter().enumerate() {
            *place(&mut other) = 1.0 + column as f64;
        }
        assert_eq!((other.at_m, other.along_m, other.seed), ([1.0, 2.0, 3.0], [4.0, 5.0], 17.0));
        world.add_plumes(&[plume()]);
        world.add_plumes(&[other]);
        assert_eq!(world.plumes(), [plume(), other]);
    }
}
