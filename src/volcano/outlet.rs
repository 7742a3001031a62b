//! Where a world erupts that is not told where: at the youngest vents of its table, or at its summit.

use crate::{
    grid::Grid,
    world::{Vent, World},
};

/// A place to erupt from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outlet {
    /// From the map's north-west corner, m.
    pub(super) at_m: [f64; 2],
    /// A crater's radius, m, where there is one.
    pub(super) radius_m: Option<f64>,
}

/// The youngest vents that lie on the map, or the middle of the highest cell; never none.
pub(super) fn outlets(world: &World) -> Vec<Outlet> {
    let vents = youngest(world);
    if vents.is_empty() { vec![summit(world)] } else { vents }
}

/// Whether a place lies on the map.
pub(super) fn on(grid: &Grid, at_m: [f64; 2]) -> bool {
    let extent = grid.extent_m();
    (0..2).all(|axis| (0.0..=extent[axis]).contains(&at_m[axis]))
}

fn youngest(world: &World) -> Vec<Outlet> {
    let vents: Vec<Vent> = world.vents().into_iter().filter(|vent| on(&world.grid, vent.at_m)).collect();
    let least = vents.iter().map(|vent| vent.age_yr).fold(f64::INFINITY, f64::min);
    let young = vents.into_iter().filter(|vent| vent.age_yr <= least);
    young.map(|vent| Outlet { at_m: vent.at_m, radius_m: Some(vent.radius_m) }).collect()
}

fn summit(world: &World) -> Outlet {
    let height = world.height();
    let mut top = 0;
    for (i, &z) in height.data.iter().enumerate() {
        if z > height.data[top] {
            top = i;
        }
    }
    let (x, y) = world.grid.cell_of(top);
    Outlet { at_m: world.grid.center_m(x, y), radius_m: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Field},
        world::Layer,
    };

    #[test]
    fn the_youngest_vents_erupt_else_the_summit() {
        let mut world = World::new(Grid::new(4, 4, 400.0, Edges::Open), 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(world.grid, |x, y| if (x, y) == (2, 1) { 9.0 } else { 0.0 }));
        assert_eq!(outlets(&world), [Outlet { at_m: [250.0, 150.0], radius_m: None }]);
        let vent = |x, radius_m, age_yr| Vent { at_m: [x, 1.0], radius_m, age_yr };
        world.set_vents(&[vent(10.0, 5.0, 3.0), vent(20.0, 6.0, 2.0), vent(30.0, 7.0, 2.0), vent(900.0, 8.0, 0.0)]);
        let young = [(20.0, 6.0), (30.0, 7.0)].map(|(x, r)| Outlet { at_m: [x, 1.0], radius_m: Some(r) });
        assert_eq!(outlets(&world), young);
    }
}
