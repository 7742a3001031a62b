//! Rivers and lakes as tables: one row a point of a river, one a lake, one a corner of a lake's outline.

use crate::{
    grid::{Contour, Edges, Field, Grid, contour_rings},
    world::Table,
};

use super::{
    bed,
    course::{Into, River},
    waters::{Lake, Waters},
};

/// The table `rivers`, points downstream, rivers from the largest.
pub fn rivers(rivers: &[River], bankfull_ratio: f64) -> Table {
    let points = || rivers.iter().zip(1..).flat_map(|(river, id)| river.points.iter().map(move |p| (id, river, p)));
    let numbers = |f: &dyn Fn(u32, &River, &super::course::Point) -> f64| -> Vec<f64> {
        points().map(|(id, river, point)| f(id, river, point)).collect()
    };
    let into = |river: &River| match river.into {
        Into::Sea => ("sea", 0),
        Into::Lake(id) => ("lake", id),
        Into::River(id) => ("river", id),
        Into::Rim => ("rim", 0),
        Into::Seam(id) => ("rim", id),
        Into::Sink => ("sink", 0),
    };
    Table::new("rivers")
        .number("river", "1", numbers(&|id, _, _| id as f64))
        .number("x_km", "km", numbers(&|_, _, p| p.at_m[0] * 1e-3))
        .number("y_km", "km", numbers(&|_, _, p| p.at_m[1] * 1e-3))
        .number("z_m", "m", numbers(&|_, _, p| p.z_m))
        .number("discharge_m3_s", "m3/s", numbers(&|_, _, p| p.discharge_m3_s))
        .number("width_m", "m", numbers(&|_, _, p| bed::width_m(p.discharge_m3_s * bankfull_ratio)))
        .number("order", "1", numbers(&|_, _, p| p.order as f64))
        .text("into", points().map(|(_, river, _)| into(river).0.to_owned()).collect())
        .number("into_id", "1", numbers(&|_, river, _| into(river).1 as f64))
}

/// The table `lakes`, from the largest.
pub fn lakes(waters: &Waters, grid: Grid, ground_m: &[f64], surface_m: &[f64]) -> Table {
    let depth = |i: u32| (surface_m[i as usize] - ground_m[i as usize]).max(0.0);
    let numbers = |f: &dyn Fn(&Lake) -> f64| waters.wet_lakes().map(f).collect::<Vec<f64>>();
    let middle = |lake: &Lake, axis: usize| {
        let (x, y) = grid.cell_of(lake.bottom as usize);
        grid.center_m(x, y)[axis] * 1e-3
    };
    let volume = |lake: &Lake| lake.cells.iter().map(|&i| depth(i)).sum::<f64>() * grid.cell_area_m2() * 1e-9;
    let outflow = |lake: &Lake| {
        let leaves = |&&i: &&u32| {
            let r = waters.way.receiver[i as usize] as usize;
            waters.lake_of[r] != waters.lake_of[i as usize]
        };
        lake.cells.iter().filter(leaves).map(|&i| waters.discharge_m3_s[i as usize].max(0.0)).sum::<f64>()
    };
    Table::new("lakes")
        .number("lake", "1", (1..=waters.wet_lakes().count()).map(|id| id as f64).collect())
        .number("x_km", "km", numbers(&|lake| middle(lake, 0)))
        .number("y_km", "km", numbers(&|lake| middle(lake, 1)))
        .number("level_m", "m", numbers(&|lake| surface_m[lake.bottom as usize]))
        .number("depth_m", "m", numbers(&|lake| depth(lake.bottom)))
        .number("area_km2", "km2", numbers(&|lake| lake.cells.len() as f64 * grid.cell_area_m2() * 1e-6))
        .number("volume_km3", "km3", numbers(&volume))
        .number("outflow_m3_s", "m3/s", numbers(&outflow))
}

/// The table `lake_outlines`: rings around water (clockwise) and around islands (the other way).
pub fn outlines(waters: &Waters, grid: Grid, ground_m: &[f64], surface_m: &[f64]) -> Table {
    let (mut id, mut ring, mut x, mut y) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (lake, number) in waters.wet_lakes().zip(1..) {
        let level_m = surface_m[lake.bottom as usize];
        let wet = |i: usize| waters.lake_of[i] == number;
        let rings = rings(grid, lake, |i| {
            let above = ground_m[i] - level_m;
            // Ground below the level that is no lake lies beyond the brim.
            if wet(i) { (-above).max(0.0) } else { -above.abs().max(0.05) }
        });
        for (contour, k) in rings.iter().zip(0..) {
            for point in &contour.points {
                id.push(number as f64);
                ring.push(k as f64);
                x.push(point[0] * 1e-3);
                y.push(point[1] * 1e-3);
            }
        }
    }
    Table::new("lake_outlines")
        .number("lake", "1", id)
        .number("ring", "1", ring)
        .number("x_km", "km", x)
        .number("y_km", "km", y)
}

/// Rings around the cells of a lake, found in a window around it.
fn rings(grid: Grid, lake: &Lake, depth_m: impl Fn(usize) -> f64 + Sync) -> Vec<Contour> {
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for &i in &lake.cells {
        let (x, y) = grid.cell_of(i as usize);
        low = [low[0].min(x), low[1].min(y)];
        high = [high[0].max(x), high[1].max(y)];
    }
    let low = low.map(|v| v.saturating_sub(1));
    let high = [(high[0] + 1).min(grid.width - 1), (high[1] + 1).min(grid.height - 1)];
    let part = Grid { width: high[0] + 1 - low[0], height: high[1] + 1 - low[1], edges: Edges::Open, ..grid };
    let field = Field::from_fn(part, |x, y| depth_m(grid.index(low[0] + x, low[1] + y)) as f32);
    let shift = low.map(|v| v as f64 * grid.cell_m);
    let mut rings = contour_rings(&field, 0.0);
    for point in rings.iter_mut().flat_map(|ring| &mut ring.points) {
        *point = [point[0] + shift[0], point[1] + shift[1]];
    }
    rings
}
