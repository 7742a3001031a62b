//! Ash as a stage: it falls in one go, on what is there.

use super::{column::Fall, params::AshParams};
use crate::{
    grid::{Field, Grid, map_cells, sum_rows},
    process::{Context, Placement, Process, ProcessError, State, Step},
    volcano::outlet::found,
    world::{Layer, Matter, Plume, World},
};

/// Distance from the middle of a Gaussian beyond which nothing falls, in its standard deviations.
const REACH: f64 = 8.0;

struct Stage {
    params: AshParams,
    placement: Placement,
}

impl AshParams {
    /// The stage.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Stage { params: self, placement })
    }

    /// What falls on a map, as a share of all to a cell.
    pub fn fallen(&self, grid: &Grid, at_m: [f64; 2]) -> Vec<f64> {
        let falls = self.falls();
        let towards = (self.wind_from_deg + 180.0).to_radians();
        let wind = [libm::sin(towards), -libm::cos(towards)];
        let along = |axis: usize, cells: usize| -> Vec<Vec<f64>> {
            falls.iter().map(|fall| strips(at_m[axis] + wind[axis] * fall.drift_m, fall, cells, grid.cell_m)).collect()
        };
        let (columns, rows) = (along(0, grid.width), along(1, grid.height));
        let mut fallen = vec![0.0; grid.cells()];
        crate::grid::for_each_row(&mut fallen, grid.width, |y, row| {
            for ((fall, columns), rows) in falls.iter().zip(&columns).zip(&rows) {
                let share = fall.share * rows[y];
                if share > 0.0 {
                    row.iter_mut().zip(columns).for_each(|(cell, column)| *cell += share * column);
                }
            }
        });
        fallen
    }
}

/// What falls of a Gaussian between the sides of every column of cells: its integral, which sums to 1 without a rim.
fn strips(middle_m: f64, fall: &Fall, cells: usize, cell_m: f64) -> Vec<f64> {
    let root = fall.sigma_m * std::f64::consts::SQRT_2;
    let below = |edge: usize| {
        let off = (edge as f64 * cell_m - middle_m) / root;
        if off.abs() * std::f64::consts::SQRT_2 > REACH { off.signum() } else { libm::erf(off) }
    };
    let edges: Vec<f64> = (0..=cells).map(below).collect();
    edges.windows(2).map(|two| 0.5 * (two[1] - two[0])).collect()
}

impl Process for Stage {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Sediment, Layer::Deposit, Layer::Ash]
    }

    fn fit(&self, _grid: &Grid) -> Result<(), ProcessError> {
        let far = |at: &[f64; 2]| at.iter().any(|km| !km.is_finite() || km.abs() > 1e6);
        if self.params.at_km.iter().any(far) {
            return Err(ProcessError::Unfit("at_km must be two numbers of kilometres, at most a million".to_owned()));
        }
        Ok(())
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let grid = world.grid;
        let columns = match self.params.at_km {
            Some(at_km) => vec![at_km.map(|km| 1e3 * km)],
            None => found(world, 0.0).iter().map(|outlet| outlet.from_m).collect(),
        };
        let plumes: Vec<Plume> = columns
            .iter()
            .enumerate()
            .map(|(k, &at_m)| self.params.plume(at_m, columns.len(), world, context.key.with(k as u64)))
            .collect();
        world.add_plumes(&plumes);
        let each_m3 = 1e9 * self.params.volume_km3 / columns.len() as f64;
        let mut thick = Field::filled(grid, 0.0f32);
        let mut landed_m3 = 0.0;
        for at_m in &columns {
            let fallen = self.params.fallen(&grid, *at_m);
            landed_m3 += each_m3 * sum_rows(grid.height, |y| fallen[y * grid.width..][..grid.width].iter().sum());
            let depth_m = each_m3 / grid.cell_area_m2();
            let before = thick.clone();
            map_cells(&mut thick.data, grid.width, |x, y| {
                before.at(x, y) + (depth_m * fallen[grid.index(x, y)]) as f32
            });
        }
        if let Some(mask) = &mask {
            let whole = thick.clone();
            map_cells(&mut thick.data, grid.width, |x, y| whole.at(x, y) * mask.at(x, y).clamp(0.0, 1.0));
        }
        let stock = world.layer(Layer::Sediment).map_or(0.0, |layer| crate::grid::sum_f64(&layer.data));
        for layer in [Layer::Sediment, Layer::Deposit, Layer::Ash] {
            let before = world.layer_mut(layer).clone();
            map_cells(&mut world.layer_mut(layer).data, grid.width, |x, y| before.at(x, y) + thick.at(x, y));
        }
        // What came in is what the layer could hold of it, and what went past the map.
        let stands = world.layer(Layer::Sediment).map_or(0.0, |layer| crate::grid::sum_f64(&layer.data));
        let laid_m3 = (stands - stock) * grid.cell_area_m2();
        let past_m3 = (each_m3 * columns.len() as f64 - landed_m3).max(0.0);
        world.ledger.book_in(context.stage, Matter::Rock, laid_m3 + past_m3);
        world.ledger.book_out(context.stage, Matter::Rock, past_m3);
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn square(cells: usize, extent_m: f64) -> Grid {
        Grid::new(cells, cells, extent_m, Edges::Open)
    }

    #[test]
    fn on_a_plane_without_end_all_of_it_lands() {
        let ash = AshParams { spread_phi: 0.5, ..AshParams::default() };
        let falls = ash.falls();
        let far = falls.iter().map(|fall| fall.drift_m + 8.0 * fall.sigma_m).fold(0.0, f64::max);
        for cells in [50, 201] {
            let sum: f64 = ash.fallen(&square(cells, 2.0 * far), [far, far]).iter().sum();
            assert!((sum - 1.0).abs() < 1e-9, "{cells}: {sum}");
        }
        // Half of it lands on one side of a line along the wind.
        let half = Grid { height: 100, ..square(200, 2.0 * far) };
        let sum: f64 = ash.fallen(&half, [far, far]).iter().sum();
        assert!((sum - 0.5).abs() < 1e-9, "{sum}");
    }

    #[test]
    fn without_wind_it_lies_round_and_with_wind_downwind() {
        let grid = square(101, 101e3);
        let still = AshParams { wind_m_per_s: 0.0, ..AshParams::default() };
        let middle = [50.5e3, 50.5e3];
        let fallen = still.fallen(&grid, middle);
        let at = |x: usize, y: usize| fallen[grid.index(x, y)];
        // 25 cells off along an axis, and (15, 20) off.
        let (axis, slant) = (at(75, 50), at(65, 70));
        assert!((axis / slant - 1.0).abs() < 0.02, "{axis} {slant}");
        let blown = AshParams { wind_from_deg: 0.0, ..AshParams::default() }.fallen(&grid, middle);
        let south: f64 = blown[51 * 101..].iter().sum();
        let north: f64 = blown[..50 * 101].iter().sum();
        assert!(south > 8.0 * north, "{south} {north}");
        // Nothing stands out: the fan is smooth along its axis.
        let axis: Vec<f64> = (55..100).map(|y| blown[grid.index(50, y)]).collect();
        assert!(axis.windows(3).all(|w| w[1] > 0.97 * w[0].min(w[2]) && w[1] < 1.2 * w[0].max(w[2])), "{axis:?}");
    }

    #[test]
    fn cells_of_another_size_get_the_same_ash() {
        let ash = AshParams::default();
        let [coarse, fine] = [20, 80].map(|cells| (cells, ash.fallen(&square(cells, 40e3), [13e3, 20e3])));
        for y in 0..20 {
            for x in 0..20 {
                let parts: f64 = (0..16).map(|k| fine.1[(4 * y + k / 4) * 80 + 4 * x + k % 4]).sum();
                let whole = coarse.1[y * 20 + x];
                assert!((parts - whole).abs() <= 1e-12 + 1e-9 * whole, "{x} {y}: {parts} {whole}");
            }
        }
    }
}
