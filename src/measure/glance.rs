//! A world in a few numbers, cheap enough to be taken after every step, and what two of them say about the time between.

use rayon::prelude::*;

use crate::world::{Layer, World};

/// Sums over a world at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    /// The world's clock, years.
    pub time_yr: f64,
    /// Area of land, m².
    pub land_m2: f64,
    /// Area of the map, m².
    pub map_m2: f64,
    /// Mean height of the land over the sea, m; 0 where there is no land.
    pub mean_height_m: f64,
    /// Highest less lowest land, m.
    pub relief_m: f64,
    /// Rock and soil worn since the world began, m³, where streams have carved.
    pub worn_m3: Option<f64>,
    /// What of it lies on land, m³.
    pub laid_on_land_m3: f64,
}

/// What happened between two moments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Mean rate at which land is worn.
    pub erosion_mm_per_yr: f64,
    /// Sediment that leaves the land, for the sea or over the map's rim.
    pub sediment_m3_per_yr: f64,
}

#[derive(Clone, Copy)]
struct Row {
    land: f64,
    height: f64,
    lowest: f64,
    highest: f64,
    worn: f64,
    laid: f64,
}

impl Glance {
    /// Looks at a world.
    pub fn of(world: &World) -> Self {
        let (wear, deposit) = (world.layer(Layer::Wear), world.layer(Layer::Deposit));
        let column: Vec<_> = Layer::COLUMN.iter().filter_map(|&layer| world.layer(layer)).collect();
        let sea_m = world.sea_level_m;
        let row = |y: usize| {
            let mut row = Row { land: 0.0, height: 0.0, lowest: f64::MAX, highest: f64::MIN, worn: 0.0, laid: 0.0 };
            for x in 0..world.grid.width {
                // As `World::height` adds them.
                let height = column.iter().map(|part| part.at(x, y)).reduce(|sum, v| sum + v).unwrap_or(0.0) as f64;
                row.worn += wear.map_or(0.0, |wear| wear.at(x, y) as f64);
                if height > sea_m {
                    row.land += 1.0;
                    row.height += height - sea_m;
                    (row.lowest, row.highest) = (row.lowest.min(height), row.highest.max(height));
                    row.laid += deposit.map_or(0.0, |deposit| deposit.at(x, y) as f64);
                }
            }
            row
        };
        let rows: Vec<Row> = (0..world.grid.height).into_par_iter().map(row).collect();
        let sum = |part: fn(&Row) -> f64| rows.iter().map(part).sum::<f64>();
        let (land, cell_m2) = (sum(|row| row.land), world.grid.cell_area_m2());
        let lowest = rows.iter().map(|row| row.lowest).fold(f64::MAX, f64::min);
        let highest = rows.iter().map(|row| row.highest).fold(f64::MIN, f64::max);
        Self {
            time_yr: world.time_yr,
            land_m2: land * cell_m2,
            map_m2: world.grid.cells() as f64 * cell_m2,
            mean_height_m: if land > 0.0 { sum(|row| row.height) / land } else { 0.0 },
            relief_m: if land > 0.0 { highest - lowest } else { 0.0 },
            worn_m3: wear.map(|_| sum(|row| row.worn) * cell_m2),
            laid_on_land_m3: sum(|row| row.laid) * cell_m2,
        }
    }

    /// Share of the map that is land.
    pub fn land_share(&self) -> f64 {
        self.land_m2 / self.map_m2
    }

    /// What happened since an earlier moment; nothing to be told where no time passed, streams carve nothing, or the map is
    /// another.
    pub fn since(&self, earlier: &Glance) -> Option<Rates> {
        let span_yr = self.time_yr - earlier.time_yr;
        let worn_m3 = self.worn_m3? - earlier.worn_m3.unwrap_or(0.0);
        if span_yr <= 0.0 || self.map_m2 != earlier.map_m2 {
            return None;
        }
        let laid_m3 = self.laid_on_land_m3 - earlier.laid_on_land_m3;
        Some(Rates {
            erosion_mm_per_yr: if self.land_m2 > 0.0 { worn_m3 / self.land_m2 / span_yr * 1e3 } else { 0.0 },
            sediment_m3_per_yr: (worn_m3 - laid_m3) / span_yr,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Field, Grid};

    #[test]
    fn rates_are_what_moved() {
        let grid = Grid::new(10, 10, 1000.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, _| x as f32 * 10.0 - 5.0));
        let before = Glance::of(&world);
        // Nine of ten columns are land, from 5 to 85 m.
        assert_eq!((before.land_share(), before.mean_height_m, before.relief_m), (0.9, 45.0, 80.0));
        assert_eq!(before.since(&before), None);
        world.time_yr = 1000.0;
        world.set_layer(Layer::Wear, Field::from_fn(grid, |x, _| f32::from(x > 0) * 2.0));
        world.set_layer(Layer::Deposit, Field::from_fn(grid, |x, _| f32::from(x == 0) * 6.0 + f32::from(x == 1)));
        let rates = Glance::of(&world).since(&before).unwrap();
        assert_eq!(rates.erosion_mm_per_yr, 2.0);
        // 90 cells lost 2 m, of which 10 cells of land got 1 m; a cell is 10,000 m².
        assert_eq!(rates.sediment_m3_per_yr, (180.0 - 10.0) * 1e4 / 1e3);
    }
}
