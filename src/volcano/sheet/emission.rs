//! Of which cells lava comes out, and what that may take.

use std::f64::consts::PI;

use super::{law::Law, params::LavaSheetParams};
use crate::{
    grid::{Field, Grid},
    volcano::{
        outlet::{Outlet, VentParams, check, outlets},
        schedule::{HOUR_S, Schedule},
    },
    world::World,
};

/// Places a side of a cell that are asked whether they lie in a vent.
const PLACES: usize = 4;
/// Most steps in time that a run may need.
const MOST_STEPS: f64 = 1e7;
/// Most steps of single cells: some three hours of CPU time, measured on maps that lava covers.
const MOST_WORK: f64 = 1.5e11;
/// Depth to which a sheet lies, about, where it has room, m: with its volume, the cells that work.
const USUAL_M: f64 = 10.0;
/// Most lava over the whole map, m: beyond that it is no flow on a land, but the land.
const MOST_DEEP_M: f64 = 300.0;
/// Share of a step's limit that lava may pile up by on a vent before it flows off.
const PILE: f64 = 0.5;

/// The cells that a recipe's lava comes out of, in ascending order, with their shares of the whole; a mask takes its share
/// off what comes out under it, else their sum is 1.
pub(super) fn sources(
    params: &LavaSheetParams,
    world: &World,
    mask: Option<&Field<f32>>,
) -> Result<Vec<(usize, f64)>, String> {
    let mut shares = vec![0.0; world.grid.cells()];
    for outlet in outlets(&params.vent, world, world.grid.cell_m)? {
        feed(&outlet, &world.grid, &mut shares);
    }
    let masked = |i: usize, share: f64| share * mask.map_or(1.0, |mask| f64::from(mask.data[i]).clamp(0.0, 1.0));
    let cells = shares.iter().enumerate().map(|(i, &share)| (i, masked(i, share)));
    Ok(cells.filter(|(_, share)| *share > 0.0).collect())
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
    /// Refuses vents off the map, and what would not end in hours: fronts pass a cell in as many steps as their speed allows,
    /// and vents fill as fast as they are fed.
    pub(super) fn check_work(&self, grid: &Grid) -> Result<(), String> {
        check(&self.vent, grid)?;
        let schedule = Schedule::of_sheet(&self.schedule)?;
        let law = Law::new(self);
        let whole_s = self.duration_h * HOUR_S;
        let flow = whole_s * 12.0 * self.most_speed_m_per_s / grid.cell_m;
        let open_m2 = self.open_m2(grid);
        let volume_m3: f64 = schedule.until(whole_s).map(|(span_s, m3_per_s)| span_s * m3_per_s).sum();
        let deep_m = volume_m3 / (grid.cells() as f64 * grid.cell_area_m2());
        if deep_m > MOST_DEEP_M {
            return Err(format!(
                "the schedule's {volume_m3:.1e} m3 of lava would lie {deep_m:.0} m deep over the whole map, \
                 {MOST_DEEP_M} m at most; lower m3_per_s or the keys' duration_h, or raise extent_km"
            ));
        }
        let fill = |(span_s, m3_per_s): (f64, f64)| {
            let rise_m_s = m3_per_s / open_m2;
            if rise_m_s > 0.0 { span_s * rise_m_s / law.pile_m(rise_m_s, grid.cell_m) } else { 0.0 }
        };
        let steps = flow + schedule.until(whole_s).map(fill).sum::<f64>() + 2.0 * self.schedule.len() as f64;
        if steps > MOST_STEPS {
            return Err(format!(
                "lava may need {steps:.1e} steps in time on cells of {:.3} m, {MOST_STEPS:.0e} at most; lower duration_h, \
                 m3_per_s or most_speed_m_per_s, or take larger cells",
                grid.cell_m
            ));
        }
        let covered = (volume_m3 / USUAL_M / grid.cell_area_m2()).min(grid.cells() as f64);
        if steps * covered > MOST_WORK {
            return Err(format!(
                "lava may cover {covered:.1e} cells for {steps:.1e} steps in time, hours of work; lower m3_per_s, duration_h \
                 or most_speed_m_per_s, or take a smaller size"
            ));
        }
        Ok(())
    }

    /// Area that lava comes out of, m²: of the recipe's vents, or of the smallest that a world may offer.
    fn open_m2(&self, grid: &Grid) -> f64 {
        let area = |vent: &VentParams| {
            let radius_m = vent.radius_m.unwrap_or(grid.cell_m);
            let to_km = vent.to_km.unwrap_or(vent.at_km);
            let long_m = 1e3 * libm::hypot(to_km[0] - vent.at_km[0], to_km[1] - vent.at_km[1]);
            (PI * radius_m * radius_m + 2.0 * radius_m * long_m).max(grid.cell_area_m2())
        };
        let areas: f64 = self.vent.iter().filter(|vent| vent.part != Some(0.0)).map(area).sum();
        if areas > 0.0 { areas } else { PI * grid.cell_area_m2() }
    }
}

/// Adds a vent's share to its cells, by how much of each it covers; where it covers no place, to the cell it lies in.
fn feed(vent: &Outlet, grid: &Grid, shares: &mut [f64]) {
    let [low, high] = vent.box_m();
    let size = [grid.width, grid.height];
    let cell = |m: f64, axis: usize| ((m / grid.cell_m).floor().max(0.0) as usize).min(size[axis] - 1);
    let range = |axis: usize| cell(low[axis] - vent.radius_m, axis)..=cell(high[axis] + vent.radius_m, axis);
    let mut covered = Vec::new();
    for y in range(1) {
        for x in range(0) {
            let within = (0..PLACES * PLACES)
                .filter(|place| {
                    let part = |k: usize| (k as f64 + 0.5) / PLACES as f64;
                    let at = [x as f64 + part(place % PLACES), y as f64 + part(place / PLACES)];
                    vent.distance_m(at.map(|cells| cells * grid.cell_m)) <= vent.radius_m
                })
                .count();
            if within > 0 {
                covered.push((grid.index(x, y), within as f64));
            }
        }
    }
    if covered.is_empty() {
        covered.push((grid.index(cell(vent.from_m[0], 0), cell(vent.from_m[1], 1)), 1.0));
    }
    let whole: f64 = covered.iter().map(|(_, places)| places).sum();
    for (i, places) in covered {
        shares[i] += vent.share * places / whole;
    }
}
