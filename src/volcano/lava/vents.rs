//! Where lava comes out, and how it finds room there.

use super::{law::Law, params::LavaParams};
use crate::{
    grid::Mesh,
    noise::Key,
    world::{Table, World},
};

/// The table that a volcano leaves.
const TABLE: &str = "vents";
/// Layers of sites above each other, at most.
const LAYERS: usize = 48;
/// How far a particle comes out beside its site, in spacings.
const JITTER: f64 = 0.02;
/// No particle comes out nearer than this to another, in spacings: nearer ones would be blown apart.
pub(super) const APART: f64 = 0.95;
/// Most sites of a vent: more room than a crater needs.
const MOST_SITES: usize = 20_000;

/// A disc, or the surroundings of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vent {
    pub(super) from_m: [f64; 2],
    pub(super) to_m: [f64; 2],
    pub(super) radius_m: f64,
    /// Share of the schedule's lava.
    pub(super) share: f64,
}

/// A vent at work.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) vent: Vent,
    pub(super) sites: Vec<[f64; 2]>,
    /// Particles that are due and have not come out.
    pub(super) owed: f64,
}

impl LavaParams {
    /// The vents of this recipe in a world: its own, else the youngest of the table, else the summit.
    pub(super) fn vents(&self, world: &World, law: &Law) -> Result<Vec<Vent>, String> {
        let usual = 2.0 * law.spacing;
        let mut vents: Vec<Vent> = self
            .vent
            .iter()
            .map(|vent| Vent {
                from_m: vent.at_km.map(|km| 1e3 * km),
                to_m: vent.to_km.unwrap_or(vent.at_km).map(|km| 1e3 * km),
                radius_m: vent.radius_m.unwrap_or(usual),
                share: vent.part.unwrap_or(1.0),
            })
            .collect();
        if vents.is_empty() {
            vents = world.table(TABLE).map(youngest).unwrap_or_default();
        }
        if vents.is_empty() {
            vents.push(summit(world, usual));
        }
        let extent = world.grid.extent_m();
        for (i, vent) in vents.iter().enumerate() {
            let inside = |at: [f64; 2]| (0..2).all(|axis| at[axis] > 0.0 && at[axis] < extent[axis]);
            if !inside(vent.from_m) || !inside(vent.to_m) {
                let [x, y] = vent.from_m.map(|m| 1e-3 * m);
                let [w, h] = extent.map(|m| 1e-3 * m);
                return Err(format!(
                    "vent {} at {x} km, {y} km does not lie on the map, which is {w} km by {h} km",
                    i + 1
                ));
            }
        }
        let whole: f64 = vents.iter().map(|vent| vent.share).sum();
        if whole <= 0.0 {
            return Err("the vents have no part of the lava; give one of them a 'part' above 0".into());
        }
        vents.iter_mut().for_each(|vent| vent.share /= whole);
        Ok(vents)
    }
}

/// The youngest vents of a table.
fn youngest(table: &Table) -> Vec<Vent> {
    let column = |name: &str| table.numbers(name).unwrap_or(&[]);
    let (x, y, radius, age) = (column("x_m"), column("y_m"), column("radius_m"), column("age_yr"));
    let least = age.iter().copied().fold(f64::INFINITY, f64::min);
    let rows = x.iter().zip(y).zip(radius).zip(age).filter(|(_, age)| **age <= least);
    rows.map(|(((&x, &y), &radius_m), _)| Vent { from_m: [x, y], to_m: [x, y], radius_m, share: 1.0 }).collect()
}

/// A vent on the highest cell.
fn summit(world: &World, radius_m: f64) -> Vent {
    let height = world.height();
    let mut top = 0;
    for (i, &z) in height.data.iter().enumerate() {
        if z > height.data[top] {
            top = i;
        }
    }
    let (x, y) = world.grid.cell_of(top);
    let at = world.grid.center_m(x, y);
    Vent { from_m: at, to_m: at, radius_m, share: 1.0 }
}

impl Source {
    /// The sites of a vent, on a lattice.
    pub(super) fn new(vent: Vent, law: &Law) -> Self {
        let (d, r) = (law.spacing, vent.radius_m.max(0.0));
        let [low, high] = [f64::min, f64::max].map(|f| [0, 1].map(|axis| f(vent.from_m[axis], vent.to_m[axis])));
        let mut sites = vec![vent.from_m];
        let reach = [0, 1].map(|axis| ((high[axis] - low[axis] + r) / d).ceil().min(3e3) as i64);
        let back = (r / d).ceil().min(3e3) as i64;
        for y in -back..=reach[1] {
            for x in -back..=reach[0] {
                // The lattice holds the vent's first place.
                let start = [0, 1].map(|axis| low[axis] + ((vent.from_m[axis] - low[axis]) / d).fract() * d);
                let at = [start[0] + x as f64 * d, start[1] + y as f64 * d];
                let near = distance(at, vent.from_m, vent.to_m) <= r.max(0.5 * d);
                let first = (at[0] - vent.from_m[0]).abs() + (at[1] - vent.from_m[1]).abs() < 0.01 * d;
                if near && !first && sites.len() < MOST_SITES {
                    sites.push(at);
                }
            }
        }
        Self { vent, sites, owed: 0.0 }
    }

    /// Places for as many of the particles that are due as find room, above the ground, and a number each drew: `free` says
    /// whether nobody is near a place.
    pub(super) fn emit(
        &mut self,
        (mesh, law, key): (&Mesh, &Law, Key),
        most: usize,
        free: impl Fn([f32; 3]) -> bool,
        mut each: impl FnMut([f32; 3]),
    ) {
        // Sums of many small shares end a little under the whole.
        let mut left = ((self.owed + 1e-6) as usize).min(most);
        if left == 0 {
            return;
        }
        // Another order each time, so that lava wells up evenly.
        let mut order: Vec<(u64, usize)> =
            (0..self.sites.len()).map(|site| (key.with(site as u64).stream().bits(), site)).collect();
        order.sort_unstable();
        let d = law.spacing;
        let grid = mesh.grid();
        let wrap = |at: f64, extent: f64| {
            if grid.edges == crate::grid::Edges::Wrap { at.rem_euclid(extent) } else { at }
        };
        let extent = grid.extent_m();
        for layer in 0..LAYERS {
            for &(_, site) in &order {
                let mut stream = key.with(site as u64).with(layer as u64).stream();
                let off: [f64; 3] = [0; 3].map(|_| stream.between(-JITTER, JITTER) * d);
                let [x, y] = [0, 1].map(|axis| wrap(self.sites[site][axis] + off[axis], extent[axis]) as f32);
                if mesh.holder(x, y).is_none() {
                    continue;
                }
                // The ground under the site, not beside it: those above each other stay apart on slopes too.
                let foot = mesh.foot(self.sites[site][0] as f32, self.sites[site][1] as f32);
                let z = foot.height + (0.6 * d) as f32 / foot.face[2].max(0.2) + (layer as f64 * d + off[2]) as f32;
                if free([x, y, z]) {
                    each([x, y, z]);
                    self.owed -= 1.0;
                    left -= 1;
                    if left == 0 {
                        return;
                    }
                }
            }
        }
    }
}

/// Distance of a place from a line between two others.
fn distance(at: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let way = [to[0] - from[0], to[1] - from[1]];
    let long2 = way[0] * way[0] + way[1] * way[1];
    let rel = [at[0] - from[0], at[1] - from[1]];
    let share = if long2 > 0.0 { ((rel[0] * way[0] + rel[1] * way[1]) / long2).clamp(0.0, 1.0) } else { 0.0 };
    let off = [rel[0] - share * way[0], rel[1] - share * way[1]];
    (off[0] * off[0] + off[1] * off[1]).sqrt()
}
