//! The ground as a camera takes it in: smooth, and nowhere lower than what is there, so that a camera that keeps above
//! it neither touches the ground nor jitters over it.

use super::ground::Lie;
use crate::grid::{Edges, Field, Grid};

/// Cells around a coarse cell whose highest ground it stands for: as far as the curve below reaches.
const AROUND: usize = 2;

/// Smooth surfaces over the ground, at a size of their own.
pub struct Overview {
    lie: Lie,
    /// Highest ground around each coarse cell.
    tops: Field<f32>,
    /// Mean height of each.
    means: Field<f32>,
}

impl Overview {
    /// With coarse cells about `wide_m` wide; at least the ground's own.
    pub fn new(height: &Field<f32>, lie: &Lie, wide_m: f64) -> Self {
        let block = ((wide_m / height.grid.cell_m) as usize).clamp(1, height.grid.width.max(height.grid.height));
        let (w, h) = (height.grid.width.div_ceil(block), height.grid.height.div_ceil(block));
        let cell_m = height.grid.cell_m * block as f64;
        let grid = Grid { width: w, height: h, cell_m, edges: Edges::Closed };
        let within = |at: usize, most: usize| at * block..((at + 1) * block).min(most);
        let over = |x: usize, y: usize| {
            let columns = within(x, height.grid.width);
            within(y, height.grid.height).flat_map(move |y| height.row(y)[columns.clone()].iter().copied())
        };
        let sea_m = lie.sea_m as f32;
        let own = Field::from_fn(grid, |x, y| over(x, y).fold(sea_m, f32::max));
        let means = Field::from_fn(grid, |x, y| {
            let (sum, count) = over(x, y).fold((0.0f64, 0), |(sum, n), v| (sum + f64::from(v.max(sea_m)), n + 1));
            (sum / f64::from(count.max(1))) as f32
        });
        let near = |at: usize, most: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(most);
        let rows = Field::from_fn(grid, |x, y| near(y, h).map(|y| own.at(x, y)).fold(sea_m, f32::max));
        let tops = Field::from_fn(grid, |x, y| near(x, w).map(|x| rows.at(x, y)).fold(sea_m, f32::max));
        Self { lie: *lie, tops, means }
    }

    /// A height as drawn, m, that no ground or sea there is above.
    pub fn top_m(&self, east: f64, north: f64) -> f64 {
        self.smooth(&self.tops, east, north)
    }

    /// The height around a place as drawn, m.
    pub fn mean_m(&self, east: f64, north: f64) -> f64 {
        self.smooth(&self.means, east, north)
    }

    /// A cubic B-spline over the coarse cells: twice differentiable, and between the least and the greatest of the four
    /// cells a side that it is made of.
    fn smooth(&self, field: &Field<f32>, east: f64, north: f64) -> f64 {
        let [w, h] = self.lie.extent_m;
        let grid = &field.grid;
        let place = |at_m: f64, extent_m: f64| (at_m.clamp(0.0, extent_m)) / grid.cell_m - 0.5;
        let (u, v) = (place(east + 0.5 * w, w), place(0.5 * h - north, h));
        let (columns, across) = taps(u, grid.width);
        let (rows, down) = taps(v, grid.height);
        let line = |y: usize| (0..4).map(|k| across[k] * f64::from(field.at(columns[k], y))).sum::<f64>();
        (0..4).map(|k| down[k] * line(rows[k])).sum::<f64>() * self.lie.exaggeration
    }
}

/// The four cells around a place and their weights.
fn taps(at: f64, cells: usize) -> ([usize; 4], [f64; 4]) {
    let first = libm::floor(at);
    let t = at - first;
    let (a, t2, t3) = (1.0 - t, t * t, t * t * t);
    let weights = [a * a * a, 3.0 * t3 - 6.0 * t2 + 4.0, 3.0 * (t + t2 - t3) + 1.0, t3].map(|w| w / 6.0);
    let cell = |k: usize| (first as i64 - 1 + k as i64).clamp(0, cells as i64 - 1) as usize;
    ([0, 1, 2, 3].map(cell), weights)
}
