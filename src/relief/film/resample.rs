//! A world's layers at the picture's raster, of any size: Catmull-Rom, widened to the pixels where there are fewer of
//! them than cells, so that nothing flickers between them. At the world's own size it changes nothing.

use multiversion::multiversion;
use rayon::prelude::*;

use crate::grid::{Edges, Field, Grid, keys};

/// For each pixel along one side, the cells it is made of and their weights.
struct Taps {
    /// Cells of a pixel.
    wide: usize,
    /// The first cell of each pixel, counted from `before` cells before the side.
    first: Vec<usize>,
    weights: Vec<f32>,
    /// Room before the side, cells; there is as much behind it.
    before: usize,
    cells: usize,
    edges: Edges,
}

impl Taps {
    fn new(cells: usize, pixels: usize, edges: Edges) -> Self {
        let scale = cells as f64 / pixels as f64;
        let reach = 2.0 * scale.max(1.0);
        let wide = libm::floor(2.0 * reach) as usize + 1;
        let before = libm::ceil(reach) as usize + 1;
        let (mut first, mut weights) = (Vec::new(), Vec::new());
        for pixel in 0..pixels {
            let middle = (pixel as f64 + 0.5) * scale - 0.5;
            let begin = libm::ceil(middle - reach) as i64;
            let own = (0..wide as i64).map(|k| keys(((begin + k) as f64 - middle) / (0.5 * reach)));
            let sum: f64 = own.clone().sum();
            weights.extend(own.map(|weight| (weight / sum) as f32));
            first.push((begin + before as i64) as usize);
        }
        Self { wide, first, weights, before, cells, edges }
    }

    /// The cells and weights of a pixel.
    fn of(&self, pixel: usize) -> impl Iterator<Item = (usize, f32)> {
        let weights = &self.weights[pixel * self.wide..][..self.wide];
        let cells = (self.first[pixel]..).map(|place| self.cell(place));
        cells.zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0)
    }

    /// The cell at a place, also before and behind the side.
    fn cell(&self, place: usize) -> usize {
        let (cell, cells) = (place as i64 - self.before as i64, self.cells as i64);
        match self.edges {
            Edges::Wrap => cell.rem_euclid(cells) as usize,
            Edges::Open | Edges::Closed => cell.clamp(0, cells - 1) as usize,
        }
    }

    /// Fills what lies before and behind the side in a line with room for it.
    fn pad(&self, line: &mut [f32]) {
        for place in (0..self.before).chain(self.before + self.cells..line.len()) {
            line[place] = line[self.before + self.cell(place)];
        }
    }
}

/// From a world's cells to the picture's pixels.
pub struct Resampler {
    from: Grid,
    to: Grid,
    columns: Taps,
    rows: Taps,
}

impl Resampler {
    /// Between two rasters over the same ground.
    pub fn new(from: Grid, to: Grid) -> Self {
        let columns = Taps::new(from.width, to.width, from.edges);
        let rows = Taps::new(from.height, to.height, from.edges);
        Self { from, to, columns, rows }
    }

    /// The sum of some fields of a quantity.
    pub fn sum(&self, fields: &[&Field<f32>]) -> Field<f32> {
        let mut out = Field::filled(self.to, 0.0);
        let Taps { before, wide, first, weights, .. } = &self.columns;
        let room = || vec![0.0f32; self.from.width + 2 * before];
        out.data.par_chunks_exact_mut(self.to.width).enumerate().for_each_init(room, |line, (y, row)| {
            let own = &mut line[*before..][..self.from.width];
            own.fill(0.0);
            for (j, weight) in self.rows.of(y) {
                fields.iter().for_each(|field| add(weight, field.row(j), own));
            }
            self.columns.pad(line);
            for ((value, &first), weights) in row.iter_mut().zip(first).zip(weights.chunks_exact(*wide)) {
                *value = line[first..first + wide].iter().zip(weights).map(|(v, weight)| v * weight).sum();
            }
        });
        out
    }

    /// An identity: that of the cell in the middle of each pixel.
    pub fn nearest(&self, field: &Field<f32>) -> Field<f32> {
        let pick = |pixel: usize, pixels: usize, cells: usize| (2 * pixel + 1) * cells / (2 * pixels);
        let (from, to) = (self.from, self.to);
        Field::from_fn(to, |x, y| field.at(pick(x, to.width, from.width), pick(y, to.height, from.height)))
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn add(weight: f32, values: &[f32], sums: &mut [f32]) {
    for (sum, v) in sums.iter_mut().zip(values) {
        *sum += weight * v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_own_size_changes_nothing() {
        let grid = Grid::new(31, 17, 310.0, Edges::Open);
        let (a, b) = (Field::from_fn(grid, |x, y| (x * y) as f32 * 0.37), Field::from_fn(grid, |x, _| x as f32));
        let both = Resampler::new(grid, grid).sum(&[&a, &b]);
        assert!(both.data.iter().enumerate().all(|(i, &v)| v == a.data[i] + b.data[i]));
        assert_eq!(Resampler::new(grid, grid).nearest(&a).data, a.data);
    }

    #[test]
    fn a_plane_stays_a_plane_and_ripples_vanish() {
        let from = Grid::new(100, 80, 100.0, Edges::Open);
        let to = Grid::new(30, 24, 100.0, Edges::Open);
        let small = Resampler::new(from, to);
        let plane = small.sum(&[&Field::from_fn(from, |x, y| (2 * x + 3 * y) as f32)]);
        // Away from the rim, where the kernel finds no more plane.
        for y in 3..21 {
            for x in 3..27 {
                let [px, py] = to.center_m(x, y);
                let want = 2.0 * (px - 0.5) + 3.0 * (py - 0.5);
                assert!((plane.at(x, y) as f64 - want).abs() < 0.02, "{x} {y}: {} {want}", plane.at(x, y));
            }
        }
        let ripples = small.sum(&[&Field::from_fn(from, |x, _| if x % 2 == 0 { 100.0 } else { -100.0 })]);
        let most = (3..27).map(|x| ripples.at(x, 12).abs()).fold(0.0, f32::max);
        // Worked out by hand for this kernel: 1.2 of 100.
        assert!(most < 2.0, "{most}");
    }
}
