//! Water on land as a second surface over the ground: lakes and what runs, each at its own height.

use super::terrain::{PATCH, Patch};
use crate::{
    grid::{Field, nearest_within},
    world::{Layer, World},
};

/// Depth from which running water is drawn, m: less is wet ground.
const LEAST_M: f32 = 0.03;
/// Depth from which a lake is drawn, m.
const LEAST_LAKE_M: f32 = 0.05;
/// How far the surface goes on into the dry, cells: as far as interpolation between coarse copies reads.
const REACH: f64 = 12.0;
/// How far the surface lies under dry ground that is lower than it, m.
const UNDER_M: f32 = 0.5;

/// The surface of a world's inland water.
pub struct Inland {
    /// Height of the surface and depth of the water, m, a cell; less than 0 deep where the ground is dry. Taken out for the
    /// adapter.
    pub cells: Vec<[f32; 2]>,
    /// Which of the finest patches have any.
    wet: Vec<bool>,
    /// Patches a side.
    sides: [usize; 2],
}

impl Inland {
    /// That of a world over its ground; `None` where it is dry.
    pub fn of(world: &World, height: &Field<f32>) -> Option<Self> {
        let depth = depths(world)?;
        let grid = height.grid;
        let near = nearest_within(grid, REACH * grid.cell_m, |i| depth[i] > 0.0);
        let cells: Vec<[f32; 2]> = (0..depth.len())
            .map(|i| {
                let ground = height.data[i];
                if depth[i] > 0.0 {
                    return [ground + depth[i], depth[i]];
                }
                // The shore is where the neighbour's surface meets the ground. Lower ground is not flooded: there the water ends.
                let nearest = near.index.data[i] as usize;
                let level = depth.get(nearest).map(|depth| height.data[nearest] + depth);
                let surface = level.filter(|level| *level <= ground).unwrap_or(ground - UNDER_M);
                [surface, surface - ground]
            })
            .collect();
        let sides = [grid.width, grid.height].map(|n| (n - 1).div_ceil(PATCH).max(1));
        let mut wet = vec![false; sides[0] * sides[1]];
        for (i, _) in depth.iter().enumerate().filter(|(_, depth)| **depth > 0.0) {
            let (x, y) = (i % grid.width, i / grid.width);
            // A cell at the border of two patches is a corner of both.
            for y in [y.saturating_sub(1), y + 1].map(|y| (y / PATCH).min(sides[1] - 1)) {
                for x in [x.saturating_sub(1), x + 1].map(|x| (x / PATCH).min(sides[0] - 1)) {
                    wet[y * sides[0] + x] = true;
                }
            }
        }
        Some(Self { cells, wet, sides })
    }

    /// Whether a patch has any water.
    pub fn touches(&self, patch: &Patch) -> bool {
        let [x, y, step, _] = patch.patch.map(|v| v as usize);
        let range = |from: usize, side: usize| from / PATCH..(from / PATCH + step).min(side);
        range(y, self.sides[1]).any(|y| range(x, self.sides[0]).any(|x| self.wet[y * self.sides[0] + x]))
    }
}

/// Depth of water on land, m, a cell: lakes, and what runs; 0 where it is dry. `None` where all is.
fn depths(world: &World) -> Option<Vec<f32>> {
    let mut all = vec![0.0f32; world.grid.cells()];
    for (layer, least) in [(Layer::LakeDepth, LEAST_LAKE_M), (Layer::Water, LEAST_M)] {
        let Some(field) = world.layer(layer) else { continue };
        for (all, &depth) in all.iter_mut().zip(&field.data).filter(|(_, depth)| **depth >= least) {
            *all = all.max(depth);
        }
    }
    all.iter().any(|&depth| depth > 0.0).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    /// A valley along y, 2 m of relief a cell, with a lake at 10 m whose southern end is a sill to lower ground.
    fn valley() -> (World, Field<f32>) {
        let grid = Grid::new(64, 64, 640.0, Edges::Open);
        let height = Field::from_fn(grid, |x, y| {
            let side = 2.0 * x.abs_diff(32) as f32;
            if y < 40 { side } else { side - 8.0 }
        });
        let mut world = World::new(grid, -100.0);
        let lake = Field::from_fn(grid, |x, y| if y < 40 { (10.0 - height.at(x, y)).max(0.0) } else { 0.0 });
        world.set_layer(Layer::LakeDepth, lake);
        (world, height)
    }

    #[test]
    fn a_lake_is_level_and_ends_where_its_shore_rises() {
        let (world, height) = valley();
        let inland = Inland::of(&world, &height).unwrap();
        for (i, [surface, depth]) in inland.cells.iter().enumerate() {
            assert_eq!(surface - height.data[i], *depth);
        }
        // On the slope above the shore the surface goes on at the lake's level, so the line of no depth is where it would be.
        let row = &inland.cells[20 * 64..21 * 64];
        assert!(row[20..45].iter().all(|c| c[0] == 10.0), "{row:?}");
        let ([_, a], [_, b]) = (row[36], row[38]);
        let shore = 36.0 + 2.0 * a / (a - b);
        assert_eq!(shore, 37.0);
        // Lower ground beyond the sill stays dry.
        assert!((40..64).all(|y| inland.cells[y * 64 + 32][1] < 0.0));
    }

    #[test]
    fn films_of_rain_are_no_water() {
        let (mut world, height) = valley();
        world.remove_layer(Layer::LakeDepth);
        assert!(Inland::of(&world, &height).is_none());
        world.set_layer(Layer::Water, Field::filled(world.grid, 0.01));
        assert!(Inland::of(&world, &height).is_none());
        world.layer_mut(Layer::Water).data[64 * 40 + 40] = 0.2;
        let inland = Inland::of(&world, &height).unwrap();
        assert_eq!(inland.cells.iter().filter(|c| c[1] > 0.0).count(), 1);
    }

    #[test]
    fn patches_without_water_are_left_out() {
        let (mut world, height) = valley();
        world.remove_layer(Layer::LakeDepth);
        world.set_layer(Layer::Water, Field::filled(world.grid, 0.0));
        world.layer_mut(Layer::Water).data[64 * 50 + 10] = 1.0;
        let inland = Inland::of(&world, &height).unwrap();
        let patch = |x: f32, y: f32, step: f32| Patch { patch: [x, y, step, 0.0], range: [0.0; 4] };
        assert!(inland.touches(&patch(0.0, 32.0, 1.0)) && inland.touches(&patch(0.0, 0.0, 2.0)));
        assert!(!inland.touches(&patch(32.0, 32.0, 1.0)) && !inland.touches(&patch(0.0, 0.0, 1.0)));
    }
}
