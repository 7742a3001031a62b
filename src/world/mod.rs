//! What all processes meet through: layers over one grid, tables, a clock and the books.
//!
//! This room knows what a layer means (name, unit, range, palette) but no process. It alone touches zarrs.

mod catalogue;
mod forcing;
mod ledger;
mod mask;
mod picture;
mod plumes;
pub mod store;
mod table;
mod vents;

pub use catalogue::{Kind, Layer, Palette, Spec};
pub use forcing::Inflow;
pub use ledger::{Account, Clocks, Ledger, Matter};
pub use mask::{Mask, MaskError};
pub use picture::{PictureError, open_picture, sample};
pub use plumes::{Plume, Puff};
pub use table::{Column, Table, Values};
pub use vents::Vent;

use std::collections::BTreeMap;

use crate::grid::{Field, Grid, sum_f64};

/// A world at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// The raster of every layer.
    pub grid: Grid,
    /// Height of the sea, m.
    pub sea_level_m: f64,
    /// Years since the recipe began.
    pub time_yr: f64,
    /// What came in, left, or changed kind.
    pub ledger: Ledger,
    layers: BTreeMap<Layer, Field<f32>>,
    tables: BTreeMap<String, Table>,
}

impl World {
    /// A world with nothing in it: no layer, no table, time 0.
    pub fn new(grid: Grid, sea_level_m: f64) -> Self {
        Self {
            grid,
            sea_level_m,
            time_yr: 0.0,
            ledger: Ledger::default(),
            layers: BTreeMap::new(),
            tables: BTreeMap::new(),
        }
    }

    /// A stored layer, if a process made it.
    pub fn layer(&self, layer: Layer) -> Option<&Field<f32>> {
        self.layers.get(&layer)
    }

    /// A stored layer to write to; zero everywhere if no process made it before.
    pub fn layer_mut(&mut self, layer: Layer) -> &mut Field<f32> {
        assert!(!layer.derived(), "{} is derived, not stored", layer.name());
        self.layers.entry(layer).or_insert_with(|| Field::filled(self.grid, 0.0))
    }

    /// Puts a whole layer in place.
    pub fn set_layer(&mut self, layer: Layer, field: Field<f32>) {
        assert!(!layer.derived() && field.grid == self.grid, "{} does not fit this world", layer.name());
        self.layers.insert(layer, field);
    }

    /// Goes over to another raster: every stored layer as `remade` has it there.
    pub fn regrid(&mut self, grid: Grid, remade: impl Fn(Layer, &Field<f32>) -> Field<f32>) {
        self.grid = grid;
        for (&layer, field) in &mut self.layers {
            *field = remade(layer, field);
            assert!(field.grid == grid, "{} does not fit this world", layer.name());
        }
    }

    /// Takes a layer out.
    pub fn remove_layer(&mut self, layer: Layer) -> Option<Field<f32>> {
        self.layers.remove(&layer)
    }

    /// The stored layers, in catalogue order.
    pub fn layers(&self) -> impl Iterator<Item = (Layer, &Field<f32>)> {
        self.layers.iter().map(|(&layer, field)| (layer, field))
    }

    /// A table by name.
    pub fn table(&self, name: &str) -> Option<&Table> {
        self.tables.get(name)
    }

    /// Puts a table in place, under its own name.
    pub fn set_table(&mut self, table: Table) {
        self.tables.insert(table.name.clone(), table);
    }

    /// Takes a table out.
    pub fn remove_table(&mut self, name: &str) -> Option<Table> {
        self.tables.remove(name)
    }

    /// The tables, by name.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.tables.values()
    }

    /// Height of the ground, m: the sum of the column of rock that is present; 0 where there is none.
    pub fn height(&self) -> Field<f32> {
        let mut column = Layer::COLUMN.iter().filter_map(|&layer| self.layer(layer));
        let mut height = column.next().cloned().unwrap_or_else(|| Field::filled(self.grid, 0.0));
        for part in column {
            crate::grid::for_each_row(&mut height.data, self.grid.width, |y, row| {
                for (h, v) in row.iter_mut().zip(part.row(y)) {
                    *h += v;
                }
            });
        }
        height
    }

    /// Any layer one can look at: a stored one, or a derived one worked out now.
    pub fn view(&self, layer: Layer) -> Option<Field<f32>> {
        match layer {
            Layer::Height => Some(self.height()),
            Layer::Slope => {
                let height = self.height();
                Some(Field::from_fn(self.grid, |x, y| {
                    let [gx, gy] = height.gradient(x, y);
                    libm::atan((gx * gx + gy * gy).sqrt()).to_degrees() as f32
                }))
            }
            stored => self.layer(stored).cloned(),
        }
    }

    /// Every layer `view` gives for this world.
    pub fn viewable(&self) -> Vec<Layer> {
        Layer::ALL.iter().copied().filter(|&layer| layer.derived() || self.layers.contains_key(&layer)).collect()
    }

    /// Volume of rock in the column (bedrock, lava, sediment), m³, above the datum.
    pub fn rock_m3(&self) -> f64 {
        let sum: f64 = Layer::COLUMN.iter().filter_map(|&l| self.layer(l)).map(|f| sum_f64(&f.data)).sum();
        // An empty sum is -0.
        (sum + 0.0) * self.grid.cell_area_m2()
    }

    /// The first stored layer and cell whose value is not finite.
    pub fn first_non_finite(&self) -> Option<(Layer, usize, usize)> {
        self.layers().find_map(|(layer, field)| field.first_non_finite().map(|(x, y)| (layer, x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn height_is_the_sum_of_the_column() {
        let mut world = World::new(Grid::new(2, 1, 2.0, Edges::Open), 0.0);
        assert_eq!(world.height().data, [0.0, 0.0]);
        world.layer_mut(Layer::Bedrock).data.copy_from_slice(&[1.0, -2.0]);
        world.layer_mut(Layer::Sediment).data.copy_from_slice(&[0.5, 0.25]);
        assert_eq!(world.height().data, [1.5, -1.75]);
        assert_eq!(world.rock_m3(), -0.25);
    }
}
