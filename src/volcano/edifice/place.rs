//! Where volcanoes stand, and how old they are: where a recipe puts them, behind a hot spot, or along the plates' arcs.
//!
//! A hot spot stays; what it built moves with the plate. A volcano of age `a` stands `∫₀ᵃ v(t) dt` from it, where `v(t)` is
//! the plate's velocity `t` years ago. The table `plates` holds that of now and that at the beginning of the plates' run,
//! between which it is read linearly.

use super::{
    age::Wear,
    params::{Place, VolcanoEntry, VolcanoParams},
    profile::Cone,
    surface::{Edifice, Roughness},
};
use crate::{
    grid::{Field, linear},
    noise::Key,
    process::{Blend, ProcessError},
    volcano::{off_map_m, place_m},
    world::{Layer, Table, World},
};

/// Where nothing is known of plates: the Pacific plate at Hawaii.
const USUAL_SPEED_MM_PER_YR: f64 = 90.0;
const USUAL_HEADING_DEG: f64 = 300.0;
/// Pieces into which an age is cut to follow a plate.
const PIECES: usize = 64;

/// The ground that volcanoes are put on.
pub(super) struct Site<'a> {
    pub world: &'a World,
    pub ground: &'a Field<f32>,
    pub blend: Blend,
    pub key: Key,
}

/// A volcano before time wears it.
struct Spot {
    at_m: [f64; 2],
    cone: Cone,
    age_myr: f64,
    /// Which noise it has.
    number: u64,
}

impl VolcanoParams {
    /// The volcanoes that reach the map, in order.
    pub(super) fn edifices(&self, site: &Site) -> Result<Vec<Edifice>, ProcessError> {
        let grid = &site.world.grid;
        let spots = match self.place {
            Place::At if self.volcanoes.is_empty() => {
                let at_m = place_m(self.at_km, grid);
                vec![Spot { at_m, cone: self.cone(grid), age_myr: self.age_myr, number: 0 }]
            }
            Place::At => self.volcanoes.iter().enumerate().map(|(i, entry)| self.entry(entry, i, site)).collect(),
            Place::Chain => self.chain(site),
            Place::Arc => self.arc(site)?,
        };
        let seen = spots.into_iter().filter(|spot| off_map_m(spot.at_m, grid) <= spot.cone.reach_m());
        Ok(seen.map(|spot| self.edifice(spot, site)).collect())
    }

    fn entry(&self, entry: &VolcanoEntry, index: usize, site: &Site) -> Spot {
        Spot {
            at_m: entry.at_km.map(|km| km * 1e3),
            cone: self.listed(entry, &site.world.grid),
            age_myr: entry.age_myr.unwrap_or(self.age_myr),
            number: index as u64,
        }
    }

    /// A volcano with its noise and its age: its crater fills as its slopes are worn.
    fn edifice(&self, spot: Spot, site: &Site) -> Edifice {
        let Spot { at_m, cone, age_myr, number } = spot;
        let under_m = if site.blend == Blend::Add { linear(site.ground, at_m) } else { 0.0 };
        let depth_m = site.world.sea_level_m - (self.foot_m + under_m);
        let open = libm::exp(-age_myr / self.wear_myr);
        let crater_height_m = cone.height_m - open * (cone.height_m - cone.crater_height_m);
        Edifice {
            at_m,
            cone: Cone { crater_height_m, ..cone },
            rough: Roughness {
                noise: self.noise,
                turbulence: self.turbulence,
                frequency: self.noise_frequency,
                hurst: self.hurst,
            },
            key: site.key.with(u64::from(self.variant)).with(number),
            age_yr: age_myr * 1e6,
            wear: Wear::after(age_myr, cone.height_m, depth_m, self.sinks_m, self.wear_myr),
        }
    }

    fn chain(&self, site: &Site) -> Vec<Spot> {
        let (chain, cone) = (&self.chain, self.cone(&site.world.grid));
        let hot_m = place_m(self.at_km, &site.world.grid);
        let motion = self.motion(site.world, hot_m);
        let spot = |i: u32| {
            let mut stream = site.key.named("chain").with(u64::from(i)).stream();
            let age_myr = f64::from(i) * chain.interval_myr;
            // The way of half an interval aside at the most, across the way of the plate.
            let aside = chain.variety * (stream.unit() - 0.5) * chain.interval_myr * 1e6;
            let [vx, vy] = motion.before(age_myr);
            let carried = motion.carried(age_myr);
            let at_m = [hot_m[0] + carried[0] - aside * vy, hot_m[1] + carried[1] + aside * vx];
            let cone = cone.scaled(1.0 - 0.8 * chain.variety * stream.unit());
            Spot { at_m, cone, age_myr: self.age_myr + age_myr, number: u64::from(i) }
        };
        (0..chain.count).map(spot).collect()
    }

    /// How the plate over a place goes, and went.
    fn motion(&self, world: &World, at_m: [f64; 2]) -> Motion {
        let chain = &self.chain;
        let known = world.table("plates").and_then(|table| plate_motion(world, table, at_m));
        let [now, first] = known.unwrap_or([[USUAL_SPEED_MM_PER_YR, USUAL_HEADING_DEG]; 2]);
        let asked = |[speed, heading]: [f64; 2]| {
            velocity(chain.speed_mm_per_yr.unwrap_or(speed), chain.heading_deg.unwrap_or(heading))
        };
        let speed = chain.speed_mm_per_yr.unwrap_or(first[0]);
        Motion {
            now: asked(now),
            first: asked(first),
            began_myr: world.time_yr * 1e-6,
            bend: chain.bend_myr.map(|myr| (myr, velocity(speed, chain.earlier_heading_deg))),
        }
    }

    /// Along the table `arcs`: a volcano wherever the last is far enough away.
    fn arc(&self, site: &Site) -> Result<Vec<Spot>, ProcessError> {
        let missing = || {
            ProcessError::Unfit(
                "place = \"arc\" needs arcs, and no plate of this world sinks below another (another seed of the stage \
                 'plates', more closing, or less continent)"
                    .to_owned(),
            )
        };
        let table = site.world.table("arcs").filter(|table| table.rows() > 0).ok_or_else(missing)?;
        let (Some(x), Some(y)) = (table.numbers("x_km"), table.numbers("y_km")) else { return Err(missing()) };
        let (arc, cone) = (&self.arc, self.cone(&site.world.grid));
        let spacing_m = arc.spacing_km * 1e3;
        let mut spots: Vec<Spot> = Vec::new();
        for (i, (x, y)) in x.iter().zip(y).enumerate() {
            let mut stream = site.key.named("arc").with(i as u64).stream();
            let mut aside = || arc.scatter * spacing_m * (stream.unit() - 0.5);
            let at_m = [x * 1e3 + aside(), y * 1e3 + aside()];
            // Between three quarters of the distance and a quarter more, so that they do not stand like posts.
            let apart_m = spacing_m * stream.between(0.75, 1.25);
            let far = |spot: &Spot| libm::hypot(spot.at_m[0] - at_m[0], spot.at_m[1] - at_m[1]) >= apart_m;
            if spots.iter().all(far) {
                let cone = cone.scaled(stream.between(arc.lowest, 1.0).max(1e-3));
                spots.push(Spot { at_m, cone, age_myr: self.age_myr, number: i as u64 });
            }
        }
        Ok(spots)
    }
}

/// How a plate goes and went, m/yr, x to the east and y to the south.
struct Motion {
    now: [f64; 2],
    first: [f64; 2],
    /// How long ago it went as at first.
    began_myr: f64,
    /// A turn that a recipe asks for: when, and how it went before.
    bend: Option<(f64, [f64; 2])>,
}

impl Motion {
    /// The velocity so long ago.
    fn before(&self, age_myr: f64) -> [f64; 2] {
        match self.bend {
            Some((since_myr, earlier)) if age_myr > since_myr => earlier,
            _ => {
                let t = if self.began_myr > 0.0 { (age_myr / self.began_myr).min(1.0) } else { 0.0 };
                [0, 1].map(|i| self.now[i] + t * (self.first[i] - self.now[i]))
            }
        }
    }

    /// How far the plate has come since then, m.
    fn carried(&self, age_myr: f64) -> [f64; 2] {
        // Up to the turn in pieces, before it straight on.
        let own_myr = self.bend.map_or(age_myr, |(since_myr, _)| age_myr.min(since_myr));
        let earlier = self.bend.map_or([0.0; 2], |(_, velocity)| velocity.map(|v| v * (age_myr - own_myr) * 1e6));
        let piece_myr = own_myr / PIECES as f64;
        let middle = |i: usize| self.before((i as f64 + 0.5) * piece_myr);
        (0..PIECES).map(middle).fold(earlier, |[x, y], [vx, vy]| [x + vx * piece_myr * 1e6, y + vy * piece_myr * 1e6])
    }
}

/// Speed and heading (mm/yr, deg) of the plate over a place, now and at first.
fn plate_motion(world: &World, table: &Table, at_m: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let column = |name: &str| table.numbers(name);
    let (ids, x, y) = (column("id")?, column("x_km")?, column("y_km")?);
    let names = [["speed_mm_per_yr", "heading_deg"], ["first_speed_mm_per_yr", "first_heading_deg"]];
    let grid = &world.grid;
    let cell = |m: f64, cells: usize| ((m / grid.cell_m).max(0.0) as usize).min(cells - 1);
    let under =
        world.layer(Layer::PlateId).map(|id| id.at(cell(at_m[0], grid.width), cell(at_m[1], grid.height)) as f64);
    let far = |i: &usize| libm::hypot(x[*i] * 1e3 - at_m[0], y[*i] * 1e3 - at_m[1]);
    let row = (0..ids.len())
        .find(|i| Some(ids[*i]) == under)
        .or_else(|| (0..ids.len()).min_by(|a, b| far(a).total_cmp(&far(b))))?;
    let [now, first] = names.map(|[speed, heading]| Some([*column(speed)?.get(row)?, *column(heading)?.get(row)?]));
    Some([now?, first?])
}

/// A velocity from a speed and a compass direction, m/yr.
fn velocity(speed_mm_per_yr: f64, heading_deg: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(heading_deg.to_radians());
    [1e-3 * speed_mm_per_yr * sin, -1e-3 * speed_mm_per_yr * cos]
}
