//! What drives streams from outside the layers: uplift that changes in time, and water that enters over the rim.
//!
//! Both are tables, so that they are stored, kept and carried along like everything else; this file says what their columns
//! mean.

use crate::grid::Edges;

use super::{Layer, Table, World};

/// The table of factors on the layer `uplift` in time.
const UPLIFT_STEPS: &str = "uplift_steps";
/// The table of water that comes in over the rim.
const INFLOWS: &str = "inflows";
/// How far along the rim from where a river comes in no water may leave, cells.
const GATE_CELLS: usize = 2;

/// Runoff where no climate says how much, mm/yr.
const USUAL_RUNOFF_MM_PER_YR: f64 = 1000.0;
/// A Julian year.
const SECONDS_PER_YEAR: f64 = 365.25 * 86_400.0;

/// A river that comes in over the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflow {
    /// Row-major index of the cell on the rim.
    pub cell: usize,
    /// Catchment outside the map, m².
    pub area_m2: f64,
    /// What runs off it in a year's mean, m³/s.
    pub discharge_m3_s: f64,
    /// Height of its bed where it comes in, m.
    pub z_m: f64,
}

impl World {
    /// Sets by what the layer `uplift` is multiplied from each moment on, (years on the world's clock, factor), ascending.
    /// Without rows it holds as it is.
    pub fn set_uplift_steps(&mut self, steps: &[(f64, f64)]) {
        self.remove_table(UPLIFT_STEPS);
        if !steps.is_empty() {
            let (from_yr, factor) = steps.iter().copied().unzip();
            self.set_table(Table::new(UPLIFT_STEPS).number("from_yr", "yr", from_yr).number("factor", "1", factor));
        }
    }

    /// By what the layer `uplift` is multiplied, as a mean over a span of years: exact also where it changes within.
    pub fn uplift_factor(&self, from_yr: f64, until_yr: f64) -> f64 {
        let Some(table) = self.table(UPLIFT_STEPS) else { return 1.0 };
        let (Some(begins), Some(factors)) = (table.numbers("from_yr"), table.numbers("factor")) else { return 1.0 };
        // Before the first row the rate holds as it is.
        let starts = std::iter::once(f64::NEG_INFINITY).chain(begins.iter().copied());
        let factors = std::iter::once(1.0).chain(factors.iter().copied());
        let pieces: Vec<(f64, f64)> = starts.zip(factors).collect();
        let ends = pieces.iter().skip(1).map(|piece| piece.0).chain([f64::INFINITY]);
        let span = until_yr - from_yr;
        let mut sum = 0.0;
        for (&(start, factor), end) in pieces.iter().zip(ends) {
            if span > 0.0 {
                sum += factor * (end.min(until_yr) - start.max(from_yr)).max(0.0) / span;
            } else if start <= from_yr && from_yr < end {
                sum = factor;
            }
        }
        sum
    }

    /// Sets what comes in over the rim.
    pub fn set_inflows(&mut self, inflows: &[Inflow]) {
        self.remove_table(INFLOWS);
        if inflows.is_empty() {
            return;
        }
        let column = |f: &dyn Fn(&Inflow) -> f64| inflows.iter().map(f).collect::<Vec<_>>();
        let centre = |inflow: &Inflow| {
            let (x, y) = self.grid.cell_of(inflow.cell);
            self.grid.center_m(x, y)
        };
        let table = Table::new(INFLOWS)
            .number("x_km", "km", column(&|inflow| centre(inflow)[0] * 1e-3))
            .number("y_km", "km", column(&|inflow| centre(inflow)[1] * 1e-3))
            .number("discharge_m3_s", "m3/s", column(&|inflow| inflow.discharge_m3_s))
            .number("area_km2", "km2", column(&|inflow| inflow.area_m2 * 1e-6))
            .number("z_m", "m", column(&|inflow| inflow.z_m));
        self.set_table(table);
    }

    /// What comes in over the rim, in the order of the table.
    pub fn inflows(&self) -> Vec<Inflow> {
        let Some(table) = self.table(INFLOWS) else { return Vec::new() };
        let columns = ["x_km", "y_km", "area_km2", "discharge_m3_s", "z_m"].map(|name| table.numbers(name));
        let [Some(x_km), Some(y_km), Some(area_km2), Some(discharge), Some(z_m)] = columns else { return Vec::new() };
        let cell = |km: f64, count: usize| {
            let at = (km * 1e3 / self.grid.cell_m).floor();
            (at >= 0.0 && at < count as f64).then_some(at as usize)
        };
        (0..table.rows())
            .filter_map(|i| {
                let (x, y) = (cell(x_km[i], self.grid.width)?, cell(y_km[i], self.grid.height)?);
                Some(Inflow {
                    cell: self.grid.index(x, y),
                    area_m2: area_km2[i] * 1e6,
                    discharge_m3_s: discharge[i],
                    z_m: z_m[i],
                })
            })
            .collect()
    }

    /// The catchment that each cell brings to the rivers, m²: its own, and what lies behind a river that comes in there.
    pub fn catchment_sources_m2(&self) -> Vec<f64> {
        let mut area_m2 = vec![self.grid.cell_area_m2(); self.grid.cells()];
        for inflow in self.inflows() {
            area_m2[inflow.cell] += inflow.area_m2;
        }
        area_m2
    }

    /// The water that each cell brings to the rivers, m³/s: runoff where a climate tells it, else rain, else a metre a year,
    /// and what comes in over the rim there.
    pub fn water_sources_m3_s(&self) -> Vec<f64> {
        let water = self.layer(Layer::Runoff).or(self.layer(Layer::Rain));
        let per_mm = 1e-3 * self.grid.cell_area_m2() / SECONDS_PER_YEAR;
        let mut discharge_m3_s: Vec<f64> = match water {
            Some(field) => field.data.iter().map(|&mm| (mm as f64).max(0.0) * per_mm).collect(),
            None => vec![USUAL_RUNOFF_MM_PER_YR * per_mm; self.grid.cells()],
        };
        for inflow in self.inflows() {
            discharge_m3_s[inflow.cell] += inflow.discharge_m3_s;
        }
        discharge_m3_s
    }

    /// The cells of the rim about each inflow: a river comes in there, so no water leaves, though the rim is open. In
    /// ascending order, none twice.
    pub fn inflow_gates(&self) -> Vec<usize> {
        if self.grid.edges != Edges::Open {
            return Vec::new();
        }
        let (w, h) = (self.grid.width, self.grid.height);
        let mut gates = Vec::new();
        for inflow in self.inflows() {
            let (x, y) = self.grid.cell_of(inflow.cell);
            let near = |at: usize, most: usize| at.saturating_sub(GATE_CELLS)..=(at + GATE_CELLS).min(most - 1);
            for j in near(y, h) {
                let rim = |i: &usize| *i == 0 || j == 0 || *i + 1 == w || j + 1 == h;
                gates.extend(near(x, w).filter(rim).map(|i| self.grid.index(i, j)));
            }
        }
        gates.sort_unstable();
        gates.dedup();
        gates
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;

    fn world() -> World {
        World::new(Grid::new(20, 10, 200.0, Edges::Open), 0.0)
    }

    #[test]
    fn a_span_has_the_mean_of_its_factors() {
        let mut world = world();
        assert_eq!(world.uplift_factor(0.0, 5.0), 1.0);
        world.set_uplift_steps(&[(10.0, 0.0), (20.0, 4.0)]);
        let spans = [(0.0, 10.0, 1.0), (5.0, 15.0, 0.5), (10.0, 20.0, 0.0), (0.0, 40.0, 2.25), (20.0, 21.0, 4.0)];
        for (from, until, want) in spans {
            assert_eq!(world.uplift_factor(from, until), want, "{from} to {until}");
        }
        assert_eq!([9.0, 10.0, 20.0].map(|t| world.uplift_factor(t, t)), [1.0, 0.0, 4.0]);
        world.set_uplift_steps(&[]);
        assert_eq!(world.uplift_factor(15.0, 16.0), 1.0);
    }

    #[test]
    fn inflows_come_back_and_keep_their_gates_shut() {
        let mut world = world();
        let inflow = Inflow { cell: world.grid.index(0, 4), area_m2: 3e9, discharge_m3_s: 20.0, z_m: 5.0 };
        world.set_inflows(&[inflow]);
        assert_eq!(world.inflows(), [inflow]);
        assert_eq!(world.inflow_gates(), [40, 60, 80, 100, 120]);
        world.set_inflows(&[Inflow { cell: 0, ..inflow }]);
        assert_eq!(world.inflow_gates(), [0, 1, 2, 20, 40]);
    }
}
