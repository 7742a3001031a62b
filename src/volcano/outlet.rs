//! Where a world erupts that is not told where: at the youngest vents of its table, or at its summit.

use crate::{
    grid::Grid,
    world::{Table, World},
};

/// The table that a volcano leaves.
const TABLE: &str = "vents";

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
    let vents = world.table(TABLE).map(|table| youngest(table, &world.grid)).unwrap_or_default();
    if vents.is_empty() { vec![summit(world)] } else { vents }
}

/// Whether a place lies on the map.
pub(super) fn on(grid: &Grid, at_m: [f64; 2]) -> bool {
    let extent = grid.extent_m();
    (0..2).all(|axis| (0.0..=extent[axis]).contains(&at_m[axis]))
}

fn youngest(table: &Table, grid: &Grid) -> Vec<Outlet> {
    let column = |name: &str| table.numbers(name).unwrap_or(&[]);
    let (x, y, radius, age) = (column("x_m"), column("y_m"), column("radius_m"), column("age_yr"));
    let rows = || x.iter().zip(y).zip(radius).zip(age).filter(|(((x, y), _), _)| on(grid, [**x, **y]));
    let least = rows().map(|(_, age)| *age).fold(f64::INFINITY, f64::min);
    let young = rows().filter(|(_, age)| **age <= least);
    young.map(|(((&x, &y), &radius_m), _)| Outlet { at_m: [x, y], radius_m: Some(radius_m) }).collect()
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
        let column = |values: [f64; 4]| values.to_vec();
        let table = Table::new(TABLE)
            .number("x_m", "m", column([10.0, 20.0, 30.0, 900.0]))
            .number("y_m", "m", column([1.0; 4]))
            .number("radius_m", "m", column([5.0, 6.0, 7.0, 8.0]))
            .number("age_yr", "yr", column([3.0, 2.0, 2.0, 0.0]));
        world.set_table(table);
        let young = [(20.0, 6.0), (30.0, 7.0)].map(|(x, r)| Outlet { at_m: [x, 1.0], radius_m: Some(r) });
        assert_eq!(outlets(&world), young);
    }
}
