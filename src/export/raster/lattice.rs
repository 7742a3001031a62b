//! Where the samples of a raster file lie on the map, and reading a layer there.
//!
//! Samples are centres of cells, or, for engines and tiles, vertices: the first and the last lie on the very edge, so
//! that neighbouring tiles share theirs. Quantities are brought there by [`resample_at`] and never leave the range of
//! the source.

use crate::grid::{Edges, Field, Grid, Places, for_each_row, resample_at};

/// What a sample stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Sampling {
    /// The middle of a cell; the raster covers one sample's width per sample.
    #[serde(rename = "cell centres")]
    Cells,
    /// A corner of a mesh; the outer samples lie on the edge of what is covered.
    #[serde(rename = "vertices")]
    Vertices,
}

/// A square part of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// West edge, m from the map's.
    pub x_m: f64,
    /// North edge, m south of the map's.
    pub y_m: f64,
    /// Side, m.
    pub size_m: f64,
}

/// Places on a map: `width` x `height` samples, `spacing_m` apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Samples from west to east.
    pub width: usize,
    /// Samples from north to south.
    pub height: usize,
    /// North-west corner of what is covered, m.
    pub corner_m: [f64; 2],
    /// Distance between neighbouring samples, m.
    pub spacing_m: f64,
    /// What a sample stands for.
    pub sampling: Sampling,
    /// North-south extent of the whole map, m: northings count from its south.
    pub map_height_m: f64,
}

impl Lattice {
    /// The cells of a world as they are.
    pub fn cells(grid: &Grid) -> Self {
        Self {
            width: grid.width,
            height: grid.height,
            corner_m: [0.0; 2],
            spacing_m: grid.cell_m,
            sampling: Sampling::Cells,
            map_height_m: grid.extent_m()[1],
        }
    }

    /// `side` samples along the longer side of the window, or of the whole map.
    pub fn over(grid: &Grid, window: Option<Window>, side: usize, sampling: Sampling) -> Self {
        let corner_m = window.map_or([0.0; 2], |w| [w.x_m, w.y_m]);
        let [wide_m, high_m] = window.map_or(grid.extent_m(), |w| [w.size_m; 2]);
        let gaps = match sampling {
            Sampling::Cells => side.max(1),
            Sampling::Vertices => side.max(2) - 1,
        };
        let spacing_m = wide_m.max(high_m) / gaps as f64;
        let count = |extent_m: f64| {
            let gaps = ((extent_m / spacing_m).round() as usize).max(1);
            if sampling == Sampling::Cells { gaps } else { gaps + 1 }
        };
        let map_height_m = grid.extent_m()[1];
        Self { width: count(wide_m), height: count(high_m), corner_m, spacing_m, sampling, map_height_m }
    }

    /// What is covered from west to east and from north to south, m.
    pub fn extent_m(&self) -> [f64; 2] {
        let inner = usize::from(self.sampling == Sampling::Vertices);
        [self.width, self.height].map(|count| (count - inner) as f64 * self.spacing_m)
    }

    /// The north-west sample, m.
    pub fn first_m(&self) -> [f64; 2] {
        let inset_m = if self.sampling == Sampling::Cells { 0.5 * self.spacing_m } else { 0.0 };
        self.corner_m.map(|m| m + inset_m)
    }

    /// `width` x `height` of the samples, beginning at `(x, y)`.
    pub fn part(&self, x: usize, y: usize, width: usize, height: usize) -> Self {
        let corner_m = [self.corner_m[0] + x as f64 * self.spacing_m, self.corner_m[1] + y as f64 * self.spacing_m];
        Self { width, height, corner_m, ..*self }
    }

    /// The samples as a grid, for slopes between them.
    fn grid(&self) -> Grid {
        Grid { width: self.width, height: self.height, cell_m: self.spacing_m, edges: Edges::Closed }
    }

    /// A quantity at the samples.
    pub fn read(&self, field: &Field<f32>) -> Field<f32> {
        let from = field.grid;
        if *self == Lattice::cells(&from) {
            return field.clone();
        }
        let step = self.spacing_m / from.cell_m;
        let [x, y] = self.first_m().map(|m| m / from.cell_m - 0.5);
        let places = |first: f64, count: usize| Places { first, step, count };
        let mut data = resample_at(field, places(x, self.width), places(y, self.height));
        let (low, high) = field.range().unwrap_or((f32::MIN, f32::MAX));
        for_each_row(&mut data, self.width, |_, row| row.iter_mut().for_each(|v| *v = v.clamp(low, high)));
        Field { grid: self.grid(), data }
    }

    /// An identity or a class at the samples: that of the cell a sample lies in.
    pub fn pick(&self, field: &Field<f32>) -> Field<f32> {
        let from = field.grid;
        let [x0, y0] = self.first_m();
        let cell = |first_m: f64, i: usize, count: usize| {
            // On the border of two cells the one to the east or south; on the map's own edge the last.
            let at = (first_m + i as f64 * self.spacing_m) / from.cell_m + 1e-6;
            at.clamp(0.0, (count - 1) as f64) as usize
        };
        Field::from_fn(self.grid(), |x, y| field.at(cell(x0, x, from.width), cell(y0, y, from.height)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::cubic;

    fn hills(size: usize) -> Field<f32> {
        Field::from_fn(Grid::new(size, size, size as f64 * 100.0, Edges::Open), |x, y| {
            (libm::sin(x as f64 * 0.31) * 300.0 + libm::cos(y as f64 * 0.23) * 200.0) as f32
        })
    }

    #[test]
    fn samples_on_cells_are_the_cells() {
        let field = hills(64);
        let window = Window { x_m: 1000.0, y_m: 2000.0, size_m: 3000.0 };
        let cut = Lattice::over(&field.grid, Some(window), 30, Sampling::Cells);
        let read = cut.read(&field);
        assert_eq!((cut.width, cut.height, cut.spacing_m), (30, 30, 100.0));
        assert!((0..30).all(|y| (0..30).all(|x| read.at(x, y) == field.at(x + 10, y + 20))));
        assert_eq!(cut.pick(&field).data, read.data);
        let whole = Lattice::over(&field.grid, None, 64, Sampling::Cells);
        assert_eq!(whole.read(&field).data, field.data);
    }

    #[test]
    fn enlarging_is_the_grids_own_cubic() {
        let field = hills(32);
        let fine = Lattice::over(&field.grid, None, 96, Sampling::Vertices);
        let read = fine.read(&field);
        let (low, high) = field.range().unwrap();
        for (x, y) in [(0, 0), (1, 1), (40, 17), (95, 95), (50, 0)] {
            let at = [x, y].map(|i| i as f64 * fine.spacing_m);
            let want = (cubic(&field, at) as f32).clamp(low, high);
            // Two roundings to f32 of numbers below 500.
            assert!((read.at(x, y) - want).abs() < 1e-4, "{x} {y}: {} {want}", read.at(x, y));
        }
    }

    #[test]
    fn shrinking_averages_away_what_cannot_be_carried() {
        let grid = Grid::new(128, 128, 12800.0, Edges::Wrap);
        let board = Field::from_fn(grid, |x, y| if (x + y) % 2 == 0 { 100.0 } else { -100.0 });
        let small = Lattice::over(&grid, None, 16, Sampling::Cells).read(&board);
        assert!(small.data.iter().all(|v| v.abs() < 1.0), "{:?}", small.range());
        // Slow waves survive: 8 samples a wave lose under a tenth.
        let waves = Field::from_fn(grid, |x, _| (libm::sin(x as f64 * std::f64::consts::TAU / 64.0) * 100.0) as f32);
        let small = Lattice::over(&grid, None, 16, Sampling::Cells).read(&waves);
        let (low, high) = small.range().unwrap();
        assert!(low < -85.0 && high > 85.0 && high <= 100.0, "{low} {high}");
    }

    #[test]
    fn vertices_reach_the_edge_and_tiles_share_them() {
        let grid = Grid::new(60, 30, 6000.0, Edges::Open);
        let vertices = Lattice::over(&grid, None, 61, Sampling::Vertices);
        assert_eq!((vertices.width, vertices.height, vertices.spacing_m), (61, 31, 100.0));
        assert_eq!((vertices.first_m(), vertices.extent_m()), ([0.0; 2], [6000.0, 3000.0]));
        let tile = vertices.part(30, 0, 31, 31);
        assert_eq!((tile.corner_m, tile.extent_m()), ([3000.0, 0.0], [3000.0, 3000.0]));
        let ids = Field::from_fn(grid, |x, _| (x / 10) as f32);
        let picked = vertices.pick(&ids);
        assert_eq!((picked.at(9, 0), picked.at(10, 0), picked.at(60, 30)), (0.0, 1.0, 5.0));
    }

    #[test]
    fn a_seamless_world_stays_seamless() {
        let grid = Grid::new(48, 48, 480.0, Edges::Wrap);
        let field = Field::from_fn(grid, |x, y| ((x * 37 + y * 91) % 53) as f32);
        for side in [17, 49, 130] {
            let read = Lattice::over(&grid, None, side, Sampling::Vertices).read(&field);
            // The last vertices are the first ones; only the sum's own rounding may differ.
            assert!((0..side).all(|y| (read.at(0, y) - read.at(side - 1, y)).abs() < 1e-4), "{side}");
            assert!((0..side).all(|x| (read.at(x, 0) - read.at(x, side - 1)).abs() < 1e-4), "{side}");
        }
    }

    #[test]
    fn nothing_leaves_the_range_of_the_source() {
        let grid = Grid::new(40, 40, 40.0, Edges::Open);
        let cliff = Field::from_fn(grid, |x, _| if x < 20 { 0.0 } else { 1.0 });
        for side in [13, 27, 163] {
            let read = Lattice::over(&grid, None, side, Sampling::Vertices).read(&cliff);
            assert_eq!(read.range(), Some((0.0, 1.0)), "{side}");
        }
    }
}
