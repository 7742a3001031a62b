//! Reading a field between its cell centres.

use super::{Edges, Field, Grid};

/// The whole part of a position in cell units, counted from cell centres, and what is left of it.
#[inline]
fn split(at: f64) -> (i64, f64) {
    let at = at - 0.5;
    // The floor without a call: processors without an instruction for it are still about.
    let whole = at as i64;
    let base = if whole as f64 > at { whole - 1 } else { whole };
    (base, at - base as f64)
}

/// The column (or row) of an index that may lie beyond the rim.
#[inline]
fn pick(at: i64, size: usize, edges: Edges) -> usize {
    match edges {
        Edges::Wrap => at.rem_euclid(size as i64) as usize,
        Edges::Open | Edges::Closed => at.clamp(0, size as i64 - 1) as usize,
    }
}

/// Bilinear value at a point in metres; the rim's value is continued beyond it.
pub fn linear(field: &Field<f32>, at_m: [f64; 2]) -> f64 {
    Corners::at(&field.grid, at_m).read(field)
}

/// The four cells around a point and the point's place between them: reads several fields of one grid at one place.
#[derive(Clone, Copy, Debug)]
pub struct Corners {
    columns: [usize; 2],
    rows: [usize; 2],
    across: f64,
    down: f64,
}

impl Corners {
    /// The cells around a point in metres.
    #[inline(always)]
    pub fn at(grid: &Grid, at_m: [f64; 2]) -> Self {
        let (x, across) = split(at_m[0] / grid.cell_m);
        let (y, down) = split(at_m[1] / grid.cell_m);
        let columns = [pick(x, grid.width, grid.edges), pick(x + 1, grid.width, grid.edges)];
        let rows = [pick(y, grid.height, grid.edges), pick(y + 1, grid.height, grid.edges)];
        Self { columns, rows, across, down }
    }

    /// Row-major indices of the four cells: the northern two from west to east, then the southern two.
    #[inline]
    pub fn cells(&self, grid: &Grid) -> [usize; 4] {
        let ([west, east], [north, south]) = (self.columns, self.rows);
        [(west, north), (east, north), (west, south), (east, south)].map(|(x, y)| grid.index(x, y))
    }

    /// Weights of [`Self::cells`].
    #[inline]
    pub fn weights(&self) -> [f64; 4] {
        let (a, d) = (self.across, self.down);
        [(1.0 - a) * (1.0 - d), a * (1.0 - d), (1.0 - a) * d, a * d]
    }

    /// The one of [`Self::cells`] that holds the point.
    #[inline]
    pub fn holder(&self) -> usize {
        usize::from(self.across >= 0.5) + 2 * usize::from(self.down >= 0.5)
    }

    /// The value of a field there.
    #[inline(always)]
    pub fn read(&self, field: &Field<f32>) -> f64 {
        let [west, east] = self.columns;
        let [top, bottom] = self.rows.map(|y| {
            let (a, b) = (field.at(west, y) as f64, field.at(east, y) as f64);
            a + (b - a) * self.across
        });
        top + (bottom - top) * self.down
    }
}

/// Catmull-Rom value at a point in metres: smooth slopes, exact at cell centres, may overshoot by a little.
pub fn cubic(field: &Field<f32>, at_m: [f64; 2]) -> f64 {
    Stencil::at(&field.grid, at_m).read(field)
}

/// The sixteen cells around a point and their Catmull-Rom weights: reads several fields of one grid at one place.
#[derive(Clone, Copy, Debug)]
pub struct Stencil {
    cells: Sixteen,
    across: [f64; 4],
    down: [f64; 4],
}

/// Which cells those are.
#[derive(Clone, Copy, Debug)]
enum Sixteen {
    /// Away from the rim four rows of four stand side by side; the first cell, and how far it is to the next row.
    Inside {
        first: usize,
        width: usize,
    },
    Rim {
        columns: [usize; 4],
        rows: [usize; 4],
    },
}

impl Stencil {
    /// The stencil around a point in metres.
    #[inline(always)]
    pub fn at(grid: &Grid, at_m: [f64; 2]) -> Self {
        let ((x, fx), (y, fy)) = (split(at_m[0] / grid.cell_m), split(at_m[1] / grid.cell_m));
        let inside = x >= 1 && y >= 1 && x + 2 < grid.width as i64 && y + 2 < grid.height as i64;
        let cells = if inside {
            Sixteen::Inside { first: (y as usize - 1) * grid.width + x as usize - 1, width: grid.width }
        } else {
            let around = |at: i64, size: usize| [-1, 0, 1, 2].map(|step| pick(at + step, size, grid.edges));
            Sixteen::Rim { columns: around(x, grid.width), rows: around(y, grid.height) }
        };
        Self { cells, across: weights(fx), down: weights(fy) }
    }

    /// The value of a field there.
    #[inline(always)]
    pub fn read(&self, field: &Field<f32>) -> f64 {
        self.weigh(field, self.across, self.down)
    }

    /// The same in single precision, at half the work.
    #[inline(always)]
    pub fn read_f32(&self, field: &Field<f32>) -> f32 {
        self.weigh(field, self.across.map(|w| w as f32), self.down.map(|w| w as f32))
    }

    #[inline(always)]
    fn weigh<T: Number>(&self, field: &Field<f32>, across: [T; 4], down: [T; 4]) -> T {
        match &self.cells {
            Sixteen::Inside { first, width } => {
                let data = &field.data[*first..][..3 * width + 4];
                weighted(across, down, |k| [0, 1, 2, 3].map(|j| data[k * width + j]))
            }
            Sixteen::Rim { columns, rows } => weighted(across, down, |k| columns.map(|x| field.at(x, rows[k]))),
        }
    }
}

/// The sum over four rows of four.
#[inline(always)]
fn weighted<T: Number>(across: [T; 4], down: [T; 4], row: impl Fn(usize) -> [f32; 4]) -> T {
    // Down first: four sums side by side.
    let mut sums = [T::from(0.0); 4];
    for (k, down) in down.into_iter().enumerate() {
        for (sum, value) in sums.iter_mut().zip(row(k)) {
            *sum += down * T::from(value);
        }
    }
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| sums[k] * across[k]);
    (a + b) + (c + d)
}

/// What weights and sums are made of.
trait Number: Copy + From<f32> + std::ops::Add<Output = Self> + std::ops::Mul<Output = Self> + std::ops::AddAssign {}

impl Number for f32 {}
impl Number for f64 {}

#[inline]
fn weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_reproduce_a_plane_and_the_samples() {
        let grid = Grid::new(8, 8, 80.0, Edges::Open);
        let plane = Field::from_fn(grid, |x, y| (3 * x + 2 * y) as f32);
        for at in [[25.0, 35.0], [31.4, 47.2], [40.0, 40.0]] {
            let want = 3.0 * (at[0] / 10.0 - 0.5) + 2.0 * (at[1] / 10.0 - 0.5);
            assert!((linear(&plane, at) - want).abs() < 1e-9);
            assert!((cubic(&plane, at) - want).abs() < 1e-9);
        }
    }

    #[test]
    fn wrapping_reads_across_the_seam() {
        let grid = Grid::new(4, 4, 4.0, Edges::Wrap);
        let field = Field::from_fn(grid, |x, _| x as f32);
        assert!((linear(&field, [0.0, 2.0]) - 1.5).abs() < 1e-9);
    }
}
