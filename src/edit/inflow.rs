//! The rivers that come in over a window's rim: the old map's water is routed, and what crosses the rim inward is counted
//! where it crosses.

use std::collections::BTreeMap;

use super::window::Window;
use crate::{
    flow::{Drainage, outlets_but},
    grid::Field,
    world::{Inflow, World},
};

/// How far along the rim a river's lowest new cell is looked for, old cells.
const SEARCH_CELLS: f64 = 0.75;

/// The old map with its water.
pub(super) struct Routed {
    drainage: Drainage,
    height: Vec<f64>,
    area_m2: Vec<f64>,
    discharge_m3_s: Vec<f64>,
}

impl Routed {
    /// Routes what runs off a world, and what comes in over its own rim.
    pub fn of(world: &World, height: &Field<f32>) -> Self {
        let outlet = outlets_but(height, world.sea_level_m, &world.inflow_gates());
        let z: Vec<f64> = height.data.iter().map(|&z| z as f64).collect();
        let drainage = Drainage::of(world.grid, &z, &outlet);
        let area_m2 = drainage.accumulate(&world.catchment_sources_m2());
        let discharge_m3_s = drainage.accumulate(&world.water_sources_m3_s());
        Self { drainage, height: z, area_m2, discharge_m3_s }
    }

    /// The highest point, m.
    pub fn summit_m(&self) -> [f64; 2] {
        let cells = 0..self.height.len();
        // The first of equals.
        let top = cells.reduce(|best, i| if self.height[i] > self.height[best] { i } else { best }).unwrap_or(0);
        self.centre_m(top)
    }

    /// The largest river half way along its main stem, m.
    pub fn mid_river_m(&self) -> [f64; 2] {
        let d = &self.drainage;
        let mut best_donor: Vec<Option<usize>> = vec![None; d.len()];
        let larger = |a: usize, b: Option<usize>| b.is_none_or(|b| self.discharge_m3_s[a] > self.discharge_m3_s[b]);
        let mut mouth = None;
        for i in 0..d.len() {
            if d.is_outlet(i) {
                continue;
            }
            let r = d.receiver[i] as usize;
            if larger(i, best_donor[r]) {
                best_donor[r] = Some(i);
            }
            if d.is_outlet(r) && larger(i, mouth) {
                mouth = Some(i);
            }
        }
        let Some(mouth) = mouth else { return self.summit_m() };
        let stem: Vec<usize> = std::iter::successors(Some(mouth), |&i| best_donor[i]).collect();
        self.centre_m(stem[stem.len() / 2])
    }

    fn centre_m(&self, i: usize) -> [f64; 2] {
        let (x, y) = self.drainage.grid.cell_of(i);
        self.drainage.grid.center_m(x, y)
    }
}

/// Every river that crosses the window's rim inward, at the lowest new cell near the crossing. `ground` is the window's own.
pub(super) fn over_rim(world: &World, routed: &Routed, window: &Window, ground: &Field<f32>) -> Vec<Inflow> {
    let old = world.grid;
    let [width_m, height_m] = window.grid.extent_m();
    let own = |i: usize| {
        let [x, y] = routed.centre_m(i);
        [x - window.corner_m[0], y - window.corner_m[1]]
    };
    let inside = |[x, y]: [f64; 2]| (0.0..=width_m).contains(&x) && (0.0..=height_m).contains(&y);
    let reach = (SEARCH_CELLS * old.cell_m / window.grid.cell_m).ceil() as usize;
    // By cell, so that two that meet in one become one river.
    let mut found: BTreeMap<usize, Inflow> = BTreeMap::new();
    let mut add = |at_m: [f64; 2], area_m2: f64, discharge_m3_s: f64, z_m: f64| {
        let cell = lowest_on_rim(ground, at_m, reach);
        let river = found.entry(cell).or_insert(Inflow { cell, area_m2: 0.0, discharge_m3_s: 0.0, z_m });
        river.area_m2 += area_m2;
        river.discharge_m3_s += discharge_m3_s;
        river.z_m = river.z_m.min(z_m);
    };
    for i in (0..routed.drainage.len()).filter(|&i| !routed.drainage.is_outlet(i)) {
        let (from, to) = (own(i), own(routed.drainage.receiver[i] as usize));
        if inside(from) || !inside(to) || (routed.height[i] <= world.sea_level_m) {
            continue;
        }
        // Where the way into the window meets its rim: the last of the sides it has to pass.
        let share = [(from[0], to[0], width_m), (from[1], to[1], height_m)].map(|(a, b, side)| {
            let rim = if a < 0.0 { 0.0 } else { side };
            if (0.0..=side).contains(&a) { 0.0 } else { (rim - a) / (b - a) }
        });
        let t = share[0].max(share[1]);
        let at_m = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
        add(at_m, routed.area_m2[i], routed.discharge_m3_s[i], routed.height[i]);
    }
    // What came in over the old rim where the window shares it.
    for inflow in world.inflows() {
        let at_m = own(inflow.cell);
        if inside(at_m) {
            add(at_m, inflow.area_m2, inflow.discharge_m3_s, inflow.z_m);
        }
    }
    found.into_values().collect()
}

/// The lowest cell of the rim side next to a place, at most `reach` cells along it.
fn lowest_on_rim(ground: &Field<f32>, at_m: [f64; 2], reach: usize) -> usize {
    let grid = ground.grid;
    let cell = |m: f64, count: usize| ((m / grid.cell_m).floor().max(0.0) as usize).min(count - 1);
    let (x, y) = (cell(at_m[0], grid.width), cell(at_m[1], grid.height));
    let near = |at: usize, count: usize| at.saturating_sub(reach)..=(at + reach).min(count - 1);
    let [width_m, height_m] = grid.extent_m();
    // North, south, west, east; the first of equals.
    let off = [at_m[1], height_m - at_m[1], at_m[0], width_m - at_m[0]].map(f64::abs);
    let side = (1..4).fold(0, |best, side| if off[side] < off[best] { side } else { best });
    let cells: Vec<usize> = match side {
        0 => near(x, grid.width).map(|x| grid.index(x, 0)).collect(),
        1 => near(x, grid.width).map(|x| grid.index(x, grid.height - 1)).collect(),
        2 => near(y, grid.height).map(|y| grid.index(0, y)).collect(),
        _ => near(y, grid.height).map(|y| grid.index(grid.width - 1, y)).collect(),
    };
    let lower = |best: usize, i: usize| if ground.data[i] < ground.data[best] { i } else { best };
    cells.into_iter().reduce(lower).unwrap_or(0)
}
