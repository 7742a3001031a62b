//! A film of lava by itself, without a world: for measuring how fast it runs.

use super::{cells::Sheet, law::Law, params::LavaSheetParams};
use crate::grid::{Field, Grid};

/// Lava on ground, stepped in time.
#[derive(Clone, Debug)]
pub struct Film {
    grid: Grid,
    sheet: Sheet,
    law: Law,
}

impl Film {
    /// Lava of a depth everywhere on ground of these heights, m, as hot as it comes out; far above the sea.
    pub fn new(params: &LavaSheetParams, bed_m: &Field<f32>, depth_m: f64) -> Self {
        let (grid, law) = (bed_m.grid, Law::new(params));
        let mut sheet = Sheet::new(&grid, |x, y| f64::from(bed_m.at(x, y)), -1e6);
        let cells: Vec<(usize, f64, f64)> =
            (0..grid.cells()).map(|i| (sheet.cell(&grid, i), depth_m, depth_m * law.fresh)).collect();
        sheet.put(&cells);
        Self { grid, sheet, law }
    }

    /// One step in time, at most so long; returns how long, s.
    pub fn advance(&mut self, most_s: f64) -> f64 {
        self.sheet.advance(&self.law, &[], most_s)
    }

    /// Volume that flows, m³.
    pub fn molten_m3(&self) -> f64 {
        self.sheet.molten.iter().sum::<f64>() * self.grid.cell_area_m2()
    }
}
