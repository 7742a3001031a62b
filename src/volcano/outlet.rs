//! Where a world erupts: at the vents of a recipe, else at the youngest of its table, else at its summit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    grid::Grid,
    world::{Vent, World},
};

/// Where lava comes out: a disc, or a fissure from one place to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VentParams {
    /// The middle, or where a fissure begins, east and south of the map's north-west corner.
    #[schemars(extend("x-unit" = "km"))]
    pub at_km: [f64; 2],
    /// Where a fissure ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "km"))]
    pub to_km: Option<[f64; 2]>,
    /// Radius of the disc, or half of a fissure's width; if not given two spacings of particles, or a cell of a sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "m"))]
    pub radius_m: Option<f64>,
    /// Part of the lava, beside the other vents' parts; 1 if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub part: Option<f64>,
}

/// A disc, or the surroundings of a line, that something erupts from; m from the map's north-west corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outlet {
    pub(super) from_m: [f64; 2],
    pub(super) to_m: [f64; 2],
    pub(super) radius_m: f64,
    /// Share of what comes out; all outlets together have 1.
    pub(super) share: f64,
}

/// The outlets of a recipe in a world, never none; `usual_m` is the radius of one that has none.
pub(super) fn outlets(own: &[VentParams], world: &World, usual_m: f64) -> Result<Vec<Outlet>, String> {
    check(own, &world.grid)?;
    let mut outlets: Vec<Outlet> = own.iter().map(|vent| Outlet::of(vent, usual_m)).collect();
    if outlets.is_empty() {
        outlets = found(world, usual_m);
    }
    let whole: f64 = outlets.iter().map(|outlet| outlet.share).sum();
    outlets.iter_mut().for_each(|outlet| outlet.share /= whole);
    Ok(outlets)
}

/// Refuses a recipe's vents that do not lie on the map, or that nothing comes out of.
pub(super) fn check(own: &[VentParams], grid: &Grid) -> Result<(), String> {
    for (i, vent) in own.iter().enumerate() {
        let Outlet { from_m, to_m, .. } = Outlet::of(vent, 0.0);
        if let Some(off) = [from_m, to_m].into_iter().find(|at| !on(grid, *at)) {
            let ([x, y], [w, h]) = (off.map(|m| 1e-3 * m), grid.extent_m().map(|m| 1e-3 * m));
            let number = i + 1;
            return Err(format!("vent {number} at {x} km, {y} km does not lie on the map, which is {w} km by {h} km"));
        }
    }
    if !own.is_empty() && own.iter().all(|vent| vent.part == Some(0.0)) {
        return Err("the vents have no part of the lava; give one of them a 'part' above 0".to_owned());
    }
    Ok(())
}

/// Where a world erupts by itself: at the youngest vents that lie on the map, or in the middle of the highest cell.
pub(super) fn found(world: &World, usual_m: f64) -> Vec<Outlet> {
    let vents: Vec<Vent> = world.vents().into_iter().filter(|vent| on(&world.grid, vent.at_m)).collect();
    let least = vents.iter().map(|vent| vent.age_yr).fold(f64::INFINITY, f64::min);
    let young = vents.into_iter().filter(|vent| vent.age_yr <= least);
    let mut found: Vec<Outlet> = young.map(|vent| Outlet::disc(vent.at_m, vent.radius_m)).collect();
    if found.is_empty() {
        found.push(Outlet::disc(summit_m(world), usual_m));
    }
    found
}

fn on(grid: &Grid, at_m: [f64; 2]) -> bool {
    let extent = grid.extent_m();
    (0..2).all(|axis| (0.0..=extent[axis]).contains(&at_m[axis]))
}

/// The middle of the highest cell; of several, the nearest to the middle of the map.
fn summit_m(world: &World) -> [f64; 2] {
    let (height, grid) = (world.height(), world.grid);
    let extent = grid.extent_m();
    let place = |i: usize| {
        let (x, y) = grid.cell_of(i);
        grid.center_m(x, y)
    };
    let off_m = |i: usize| {
        let at = place(i);
        libm::hypot(at[0] - 0.5 * extent[0], at[1] - 0.5 * extent[1])
    };
    let top = height.data.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let tops = (0..height.data.len()).filter(|&i| height.data[i] == top);
    tops.min_by(|&a, &b| off_m(a).total_cmp(&off_m(b))).map_or([0.5 * extent[0], 0.5 * extent[1]], place)
}

impl Outlet {
    fn of(vent: &VentParams, usual_m: f64) -> Self {
        Self {
            from_m: vent.at_km.map(|km| 1e3 * km),
            to_m: vent.to_km.unwrap_or(vent.at_km).map(|km| 1e3 * km),
            radius_m: vent.radius_m.unwrap_or(usual_m),
            share: vent.part.unwrap_or(1.0),
        }
    }

    /// A round one with all that comes out.
    pub(super) fn disc(at_m: [f64; 2], radius_m: f64) -> Self {
        Self { from_m: at_m, to_m: at_m, radius_m, share: 1.0 }
    }

    /// Corners of the box around its line: the north-west and the south-east one.
    pub(super) fn box_m(&self) -> [[f64; 2]; 2] {
        [f64::min, f64::max].map(|f| [0, 1].map(|axis| f(self.from_m[axis], self.to_m[axis])))
    }

    /// Distance of a place from its line, m.
    pub(super) fn distance_m(&self, at_m: [f64; 2]) -> f64 {
        let way = [self.to_m[0] - self.from_m[0], self.to_m[1] - self.from_m[1]];
        let long2 = way[0] * way[0] + way[1] * way[1];
        let rel = [at_m[0] - self.from_m[0], at_m[1] - self.from_m[1]];
        let part = if long2 > 0.0 { ((rel[0] * way[0] + rel[1] * way[1]) / long2).clamp(0.0, 1.0) } else { 0.0 };
        let off = [rel[0] - part * way[0], rel[1] - part * way[1]];
        (off[0] * off[0] + off[1] * off[1]).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Field},
        world::Layer,
    };

    fn hill() -> World {
        let mut world = World::new(Grid::new(4, 4, 400.0, Edges::Open), 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(world.grid, |x, y| if (x, y) == (2, 1) { 9.0 } else { 0.0 }));
        world
    }

    #[test]
    fn the_youngest_vents_erupt_else_the_summit() {
        let mut world = hill();
        assert_eq!(outlets(&[], &world, 3.0).unwrap(), [Outlet::disc([250.0, 150.0], 3.0)]);
        // Level ground has its summit in the middle.
        let level = World::new(Grid::new(5, 5, 500.0, Edges::Open), 0.0);
        assert_eq!(summit_m(&level), [250.0, 250.0]);
        let vent = |x, radius_m, age_yr| Vent { at_m: [x, 1.0], radius_m, age_yr };
        world.set_vents(&[vent(10.0, 5.0, 3.0), vent(20.0, 6.0, 2.0), vent(30.0, 7.0, 2.0), vent(900.0, 8.0, 0.0)]);
        let young = [(20.0, 6.0), (30.0, 7.0)].map(|(x, r)| Outlet { share: 0.5, ..Outlet::disc([x, 1.0], r) });
        assert_eq!(outlets(&[], &world, 3.0).unwrap(), young);
    }

    #[test]
    fn a_recipes_vents_come_first_and_share_what_comes_out() {
        let disc = VentParams { at_km: [0.1, 0.2], radius_m: Some(7.0), ..VentParams::default() };
        let fissure = VentParams { to_km: Some([0.4, 0.2]), part: Some(3.0), radius_m: None, ..disc };
        let [a, b] = outlets(&[disc, fissure], &hill(), 2.0).unwrap()[..] else { panic!("two") };
        assert_eq!(a, Outlet { share: 0.25, ..Outlet::disc([100.0, 200.0], 7.0) });
        assert_eq!((b.to_m, b.radius_m, b.share), ([400.0, 200.0], 2.0, 0.75));
        // Beside the line, and beyond its end.
        assert_eq!([[200.0, 210.0], [403.0, 204.0]].map(|at| b.distance_m(at)), [10.0, 5.0]);
    }
}
