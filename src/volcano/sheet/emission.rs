//! When lava comes out, and of which cells.

use super::{
    law::Law,
    params::{LavaSheetParams, SheetKey},
};
use crate::{
    grid::{Field, Grid},
    volcano::outlet::{Outlet, on, outlets},
    world::World,
};

/// Places a side of a cell that are asked whether they lie in a vent.
const PLACES: usize = 4;
/// Seconds of an hour.
pub(super) const HOUR_S: f64 = 3600.0;
/// Most steps in time that a run may need: more than anyone waits for.
const MOST_STEPS: f64 = 2e7;
/// Share of a step's limit that lava may pile up by on a vent before it flows off.
const PILE: f64 = 0.5;

/// A vent at work: a disc, or the surroundings of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Vent {
    from_m: [f64; 2],
    to_m: [f64; 2],
    radius_m: f64,
    part: f64,
}

/// The schedule and the cells it feeds.
#[derive(Clone, Debug)]
pub(super) struct Emission {
    keys: Vec<SheetKey>,
    /// Cells in ascending order with their shares of the whole; their sum is 1, or less under a mask.
    pub(super) cells: Vec<(usize, f64)>,
}

impl Emission {
    /// The schedule alone.
    pub(super) fn of(params: &LavaSheetParams) -> Self {
        Self { keys: params.schedule.clone(), cells: Vec::new() }
    }

    /// That of a recipe in a world; a mask takes its share off what comes out under it.
    pub(super) fn new(params: &LavaSheetParams, world: &World, mask: Option<&Field<f32>>) -> Result<Self, String> {
        let vents = vents(params, world)?;
        let mut shares = vec![0.0; world.grid.cells()];
        let whole: f64 = vents.iter().map(|vent| vent.part).sum();
        for vent in &vents {
            vent.feed(&world.grid, vent.part / whole, &mut shares);
        }
        let masked = |i: usize, share: f64| share * mask.map_or(1.0, |mask| f64::from(mask.data[i]).clamp(0.0, 1.0));
        let cells = shares.iter().enumerate().map(|(i, &share)| (i, masked(i, share)));
        Ok(Self { keys: params.schedule.clone(), cells: cells.filter(|(_, share)| *share > 0.0).collect() })
    }

    /// Lava that comes out at a moment, m³/s.
    pub(super) fn rate_m3_s(&self, at_s: f64) -> f64 {
        let runs = |key: &&SheetKey| key.start_h * HOUR_S <= at_s && at_s < end_s(key);
        self.keys.iter().filter(runs).map(|key| key.m3_per_s).sum()
    }

    /// The next moment after this at which a rate begins or ends.
    pub(super) fn next_change_s(&self, now_s: f64) -> f64 {
        let ends = self.keys.iter().flat_map(|key| [key.start_h * HOUR_S, end_s(key)]);
        ends.filter(|&at| at > now_s).fold(f64::INFINITY, f64::min)
    }
}

fn end_s(key: &SheetKey) -> f64 {
    key.duration_h.map_or(f64::INFINITY, |h| (key.start_h + h) * HOUR_S)
}

impl Law {
    /// Depth to which lava may pile up on a vent that rises so fast before it is asked where it flows, m: in the time that
    /// takes, lava so deep loses `PILE` of itself to its neighbours.
    pub(super) fn pile_m(&self, rise_m_s: f64, cell_m: f64) -> f64 {
        let fluidity = self.flow(self.fresh).fluidity;
        libm::sqrt(libm::sqrt(PILE * cell_m * cell_m * rise_m_s / (self.weight * fluidity)))
    }
}

impl LavaSheetParams {
    /// Refuses what would not end in a day: fronts pass a cell in as many steps as their speed allows, and vents fill as
    /// fast as they are fed.
    pub(super) fn check_work(&self, grid: &Grid) -> Result<(), String> {
        for key in &self.schedule {
            let numbers = [Some(key.start_h), key.duration_h, Some(key.m3_per_s)];
            if numbers.iter().flatten().any(|n| !n.is_finite() || *n < 0.0) {
                return Err("start_h, duration_h and m3_per_s of a schedule must be numbers of at least 0".to_owned());
            }
        }
        let law = Law::new(self);
        let whole_s = self.duration_h * HOUR_S;
        let flow = whole_s * 12.0 * self.most_speed_m_per_s / grid.cell_m;
        let fill = |key: &SheetKey| {
            let rise_m_s = key.m3_per_s / grid.cell_area_m2();
            let span_s = (end_s(key).min(whole_s) - key.start_h * HOUR_S).max(0.0);
            if rise_m_s > 0.0 { span_s * rise_m_s / law.pile_m(rise_m_s, grid.cell_m) } else { 0.0 }
        };
        let steps = flow + self.schedule.iter().map(fill).sum::<f64>() + 2.0 * self.schedule.len() as f64;
        if steps > MOST_STEPS {
            return Err(format!(
                "lava may need {steps:.1e} steps in time on cells of {:.3} m, {MOST_STEPS:.0e} at most; lower duration_h, \
                 m3_per_s or most_speed_m_per_s, or take larger cells",
                grid.cell_m
            ));
        }
        Ok(())
    }
}

/// The recipe's vents, else the youngest of the table, else the summit.
fn vents(params: &LavaSheetParams, world: &World) -> Result<Vec<Vent>, String> {
    let (grid, usual) = (&world.grid, world.grid.cell_m);
    let mut vents: Vec<Vent> = params
        .vent
        .iter()
        .map(|vent| Vent {
            from_m: vent.at_km.map(|km| 1e3 * km),
            to_m: vent.to_km.unwrap_or(vent.at_km).map(|km| 1e3 * km),
            radius_m: vent.radius_m.unwrap_or(usual),
            part: vent.part.unwrap_or(1.0),
        })
        .collect();
    if vents.is_empty() {
        let own = outlets(world).into_iter();
        let vent = |Outlet { at_m, radius_m }| (at_m, radius_m.unwrap_or(usual));
        vents = own.map(vent).map(|(at, radius_m)| Vent { from_m: at, to_m: at, radius_m, part: 1.0 }).collect();
    }
    if let Some((i, vent)) = vents.iter().enumerate().find(|(_, vent)| !on(grid, vent.from_m) || !on(grid, vent.to_m)) {
        return Err(off_the_map(i, vent.from_m, vent.to_m, grid));
    }
    if vents.iter().map(|vent| vent.part).sum::<f64>() <= 0.0 {
        return Err("the vents have no part of the lava; give one of them a 'part' above 0".to_owned());
    }
    Ok(vents)
}

fn off_the_map(i: usize, from_m: [f64; 2], to_m: [f64; 2], grid: &Grid) -> String {
    let [w, h] = grid.extent_m().map(|m| 1e-3 * m);
    let [x, y] = if on(grid, from_m) { to_m } else { from_m }.map(|m| 1e-3 * m);
    format!("vent {} at {x} km, {y} km does not lie on the map, which is {w} km by {h} km", i + 1)
}

impl LavaSheetParams {
    /// Refuses vents of the recipe that do not lie on the map, before anything runs.
    pub(super) fn check_vents(&self, grid: &Grid) -> Result<(), String> {
        for (i, vent) in self.vent.iter().enumerate() {
            let [from_m, to_m] = [vent.at_km, vent.to_km.unwrap_or(vent.at_km)].map(|at| at.map(|km| 1e3 * km));
            if !on(grid, from_m) || !on(grid, to_m) {
                return Err(off_the_map(i, from_m, to_m, grid));
            }
        }
        Ok(())
    }
}

impl Vent {
    /// Adds the vent's share to its cells, by how much of each it covers; where it covers no place, to the cell it lies in.
    fn feed(&self, grid: &Grid, share: f64, shares: &mut [f64]) {
        let [low, high] = [f64::min, f64::max].map(|f| [0, 1].map(|axis| f(self.from_m[axis], self.to_m[axis])));
        let size = [grid.width, grid.height];
        let cell = |m: f64, axis: usize| ((m / grid.cell_m).floor().max(0.0) as usize).min(size[axis] - 1);
        let range = |axis: usize| cell(low[axis] - self.radius_m, axis)..=cell(high[axis] + self.radius_m, axis);
        let mut covered = Vec::new();
        for y in range(1) {
            for x in range(0) {
                let within = (0..PLACES * PLACES)
                    .filter(|place| {
                        let part = |k: usize| (k as f64 + 0.5) / PLACES as f64;
                        let at = [x as f64 + part(place % PLACES), y as f64 + part(place / PLACES)];
                        self.distance_m(at.map(|cells| cells * grid.cell_m)) <= self.radius_m
                    })
                    .count();
                if within > 0 {
                    covered.push((grid.index(x, y), within as f64));
                }
            }
        }
        if covered.is_empty() {
            covered.push((grid.index(cell(self.from_m[0], 0), cell(self.from_m[1], 1)), 1.0));
        }
        let whole: f64 = covered.iter().map(|(_, places)| places).sum();
        for (i, places) in covered {
            shares[i] += share * places / whole;
        }
    }

    /// Distance of a place from the line between both ends.
    fn distance_m(&self, at: [f64; 2]) -> f64 {
        let way = [self.to_m[0] - self.from_m[0], self.to_m[1] - self.from_m[1]];
        let off = [at[0] - self.from_m[0], at[1] - self.from_m[1]];
        let long2 = way[0] * way[0] + way[1] * way[1];
        let share = if long2 > 0.0 { ((off[0] * way[0] + off[1] * way[1]) / long2).clamp(0.0, 1.0) } else { 0.0 };
        libm::hypot(off[0] - share * way[0], off[1] - share * way[1])
    }
}
