//! Values over a grid.

use super::{Grid, for_each_row};

/// A grid and its row-major values, row 0 at the north.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<T> {
    /// The raster the values lie on.
    pub grid: Grid,
    /// `grid.cells()` values, row by row from the north.
    pub data: Vec<T>,
}

impl<T: Copy + Send + Sync> Field<T> {
    /// The same value everywhere.
    pub fn filled(grid: Grid, value: T) -> Self {
        Self { grid, data: vec![value; grid.cells()] }
    }

    /// `f(x, y)` at every cell, rows in parallel.
    pub fn from_fn(grid: Grid, f: impl Fn(usize, usize) -> T + Sync) -> Self
    where
        T: Default,
    {
        let mut field = Self::filled(grid, T::default());
        for_each_row(&mut field.data, grid.width, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                *value = f(x, y);
            }
        });
        field
    }

    /// `f` of every value.
    pub fn map<U: Copy + Send + Sync + Default>(&self, f: impl Fn(T) -> U + Sync) -> Field<U> {
        Field::from_fn(self.grid, |x, y| f(self.at(x, y)))
    }

    /// The value of cell `(x, y)`.
    pub fn at(&self, x: usize, y: usize) -> T {
        self.data[y * self.grid.width + x]
    }

    /// One row of values.
    pub fn row(&self, y: usize) -> &[T] {
        &self.data[y * self.grid.width..][..self.grid.width]
    }
}

impl Field<f32> {
    /// Central differences `[∂/∂x, ∂/∂y]` per metre, one-sided at a rim that does not wrap. Exact for linear fields.
    #[inline]
    pub fn gradient(&self, x: usize, y: usize) -> [f64; 2] {
        let g = &self.grid;
        if x > 0 && y > 0 && x + 1 < g.width && y + 1 < g.height {
            let (i, two) = (g.index(x, y), 2.0 * g.cell_m);
            let across = |a: usize, b: usize| (self.data[b] as f64 - self.data[a] as f64) / two;
            return [across(i - 1, i + 1), across(i - g.width, i + g.width)];
        }
        let (w, e, n, s) = (g.column(x, -1), g.column(x, 1), g.row(y, -1), g.row(y, 1));
        let slope =
            |a: f32, b: f32, cells: f64| if cells == 0.0 { 0.0 } else { (b as f64 - a as f64) / (cells * g.cell_m) };
        let span = |low: usize, high: usize| if high > low { (high - low).min(2) as f64 } else { 2.0 };
        let (dx, dy) = (if g.width == 1 { 0.0 } else { span(w, e) }, if g.height == 1 { 0.0 } else { span(n, s) });
        [slope(self.at(w, y), self.at(e, y), dx), slope(self.at(x, n), self.at(x, s), dy)]
    }

    /// Least and greatest value; `None` where a value is not finite or the field is empty.
    pub fn range(&self) -> Option<(f32, f32)> {
        let mut range = (f32::INFINITY, f32::NEG_INFINITY);
        for &v in &self.data {
            if !v.is_finite() {
                return None;
            }
            range = (range.0.min(v), range.1.max(v));
        }
        (!self.data.is_empty()).then_some(range)
    }

    /// The value that `share` of the cells reach or exceed: the sea level of a wanted share of land.
    pub fn level_above(&self, share: f64) -> f64 {
        let mut values = self.data.clone();
        let below = ((1.0 - share) * values.len() as f64).round() as usize;
        let Some(last) = values.len().checked_sub(1) else { return 0.0 };
        let (_, &mut value, _) = values.select_nth_unstable_by(below.min(last), f32::total_cmp);
        // All below: just above the highest.
        if below > last { value.next_up() as f64 } else { value as f64 }
    }

    /// The first cell whose value is not finite.
    pub fn first_non_finite(&self) -> Option<(usize, usize)> {
        self.data.iter().position(|v| !v.is_finite()).map(|i| self.grid.cell_of(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn gradient_of_a_plane_is_exact_everywhere() {
        for (w, h) in [(9, 7), (2, 2), (1, 3)] {
            let grid = Grid::new(w, h, w as f64 * 50.0, Edges::Open);
            let plane = Field::from_fn(grid, |x, y| {
                let [px, py] = grid.center_m(x, y);
                (0.25 * px - 0.5 * py) as f32
            });
            for y in 0..h {
                for x in 0..w {
                    let want = [if w > 1 { 0.25 } else { 0.0 }, -0.5];
                    assert_eq!(plane.gradient(x, y), want);
                }
            }
        }
    }

    #[test]
    fn a_level_leaves_the_wanted_share_above() {
        let field = Field::from_fn(Grid::new(10, 10, 10.0, Edges::Open), |x, y| (x + 10 * y) as f32);
        for share in [0.0, 0.25, 0.5, 1.0] {
            let level = field.level_above(share);
            let above = field.data.iter().filter(|&&v| v as f64 >= level).count();
            assert_eq!(above, (share * 100.0) as usize);
        }
    }

    #[test]
    fn a_bad_cell_is_named() {
        let mut field = Field::filled(Grid::new(4, 4, 4.0, Edges::Open), 1.0f32);
        assert_eq!(field.range(), Some((1.0, 1.0)));
        field.data[6] = f32::NAN;
        assert_eq!(field.first_non_finite(), Some((2, 1)));
        assert_eq!(field.range(), None);
    }
}
