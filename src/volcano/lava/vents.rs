//! How lava finds room at a vent.

use super::law::Law;
use crate::{grid::Mesh, noise::Key, volcano::outlet::Outlet};

/// Layers of sites above each other, at most.
const LAYERS: usize = 48;
/// How far a particle comes out beside its site, in spacings.
const JITTER: f64 = 0.02;
/// No particle comes out nearer than this to another, in spacings: nearer ones would be blown apart.
pub(super) const APART: f64 = 0.95;
/// Most sites of a vent: more room than a crater needs.
const MOST_SITES: usize = 20_000;

/// A vent at work.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) vent: Outlet,
    pub(super) sites: Vec<[f64; 2]>,
    /// Particles that are due and have not come out.
    pub(super) owed: f64,
}

impl Source {
    /// The sites of a vent, on a lattice.
    pub(super) fn new(vent: Outlet, law: &Law) -> Self {
        let (d, r) = (law.spacing, vent.radius_m.max(0.0));
        let [low, high] = vent.box_m();
        let mut sites = vec![vent.from_m];
        let reach = [0, 1].map(|axis| ((high[axis] - low[axis] + r) / d).ceil().min(3e3) as i64);
        let back = (r / d).ceil().min(3e3) as i64;
        for y in -back..=reach[1] {
            for x in -back..=reach[0] {
                // The lattice holds the vent's first place.
                let start = [0, 1].map(|axis| low[axis] + ((vent.from_m[axis] - low[axis]) / d).fract() * d);
                let at = [start[0] + x as f64 * d, start[1] + y as f64 * d];
                let near = vent.distance_m(at) <= r.max(0.5 * d);
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
