//! What the air took up and gave back.

use crate::grid::Edges;

use super::{Air, Water, saturation_mm};

/// Where the water came from and where it went, kg/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// Evaporated from the sea.
    pub from_sea: f64,
    /// Came in over the rim.
    pub from_rim: f64,
    /// Stayed on the ground: rain less what evaporated again from land.
    pub to_ground: f64,
    /// Left over the rim.
    pub to_rim: f64,
}

impl Budget {
    /// What came in and is not accounted for, kg/s.
    pub fn residual(&self) -> f64 {
        self.from_sea + self.from_rim - self.to_ground - self.to_rim
    }
}

impl Air<'_> {
    /// Where the water came from and where it went.
    pub fn budget(&self) -> Budget {
        let grid = &self.grid;
        let area_m2 = grid.cell_area_m2();
        let all = |water: Water| water.vapour + water.cloud;
        let mut budget = Budget::default();
        for y in 0..grid.height {
            let (supply, row) = (saturation_mm(self.below.zones[y].sea_degc), y * grid.width);
            for (cell, exchange) in self.cells[row..].iter().zip(&self.below.exchange[row..]).take(grid.width) {
                budget.from_sea += exchange * (supply - cell.water.vapour) * area_m2;
                budget.to_ground += (1.0 - cell.recycled) * cell.water.cloud / self.habits.delay_s * area_m2;
            }
            if grid.edges == Edges::Wrap {
                continue;
            }
            let (flow, brings) = (self.inflow(y), all(self.beyond(y)) * area_m2);
            let beside: f64 = flow.beside.iter().filter(|(_, row)| row.is_none()).map(|(rate, _)| rate).sum();
            budget.from_rim += (flow.along + beside * grid.width as f64) * brings;
            let takes = |x: usize| all(self.cells[row + x].water) * area_m2;
            let last = if self.east[y] < 0.0 { 0 } else { grid.width - 1 };
            budget.to_rim += flow.along * takes(last);
            let mut out = 0.0;
            out += if y == 0 { (-self.south[y]).max(0.0) } else { 0.0 };
            out += if y + 1 == grid.height { self.south[y + 1].max(0.0) } else { 0.0 };
            if out > 0.0 {
                budget.to_rim += out / grid.cell_m * (0..grid.width).map(takes).sum::<f64>();
            }
        }
        budget
    }
}
