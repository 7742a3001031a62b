//! Rivers that come from beyond the map: the table `inflows`, which a map cut out of a larger one has.

use crate::{
    grid::{Edges, Grid},
    world::World,
};

/// A river that enters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflow {
    /// The rim cell where it enters.
    pub cell: usize,
    /// A year's mean, m³/s.
    pub discharge_m3_s: f64,
}

/// The rivers that enter a world.
pub fn inflows(world: &World) -> Vec<Inflow> {
    let Some(table) = world.table("inflows") else { return Vec::new() };
    let column = |name: &str| table.numbers(name).unwrap_or_default();
    let places = column("x_km").iter().zip(column("y_km"));
    let grid = world.grid;
    let cell = |km: f64, size: usize| {
        let at = (km * 1e3 / grid.cell_m).floor();
        (at >= 0.0 && at < size as f64).then_some(at as usize)
    };
    places
        .zip(column("discharge_m3_s"))
        .filter_map(|((&x, &y), &q)| {
            let (x, y) = (cell(x, grid.width)?, cell(y, grid.height)?);
            (q > 0.0).then(|| Inflow { cell: grid.index(x, y), discharge_m3_s: q })
        })
        .collect()
}

/// Takes the outlets on the rim away where a river enters, or its water would leave at once.
pub fn open_gates(grid: Grid, outlets: Vec<bool>, inflows: &[Inflow], sea: &[bool]) -> Vec<bool> {
    const REACH: usize = 2;
    if grid.edges != Edges::Open || inflows.is_empty() {
        return outlets;
    }
    let mut left = outlets.clone();
    for inflow in inflows {
        let (x, y) = grid.cell_of(inflow.cell);
        for j in y.saturating_sub(REACH)..=(y + REACH).min(grid.height - 1) {
            for i in x.saturating_sub(REACH)..=(x + REACH).min(grid.width - 1) {
                left[grid.index(i, j)] &= sea[grid.index(i, j)];
            }
        }
    }
    // Water must be able to leave somewhere.
    if left.contains(&true) { left } else { outlets }
}
