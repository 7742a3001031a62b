//! A world's layers at the picture's raster, of any size: Catmull-Rom, widened to the pixels where there are fewer of
//! them than cells, so that nothing flickers between them. At the world's own size it changes nothing.

use rayon::prelude::*;

use crate::grid::{Edges, Field, Grid, keys};

/// For each pixel along one side, the cells it is made of and their weights.
struct Taps {
    /// Where each pixel's taps begin; one more than pixels.
    begins: Vec<usize>,
    taps: Vec<(usize, f32)>,
}

impl Taps {
    fn new(cells: usize, pixels: usize, edges: Edges) -> Self {
        let scale = cells as f64 / pixels as f64;
        let wide = scale.max(1.0);
        let (mut begins, mut taps) = (vec![0], Vec::new());
        for pixel in 0..pixels {
            let middle = (pixel as f64 + 0.5) * scale - 0.5;
            let first = libm::ceil(middle - 2.0 * wide) as i64;
            let last = libm::floor(middle + 2.0 * wide) as i64;
            let weights: Vec<f64> = (first..=last).map(|cell| keys((cell as f64 - middle) / wide)).collect();
            let sum: f64 = weights.iter().sum();
            for (cell, weight) in (first..=last).zip(weights).filter(|(_, weight)| *weight != 0.0) {
                let cell = match edges {
                    Edges::Wrap => cell.rem_euclid(cells as i64),
                    Edges::Open | Edges::Closed => cell.clamp(0, cells as i64 - 1),
                };
                taps.push((cell as usize, (weight / sum) as f32));
            }
            begins.push(taps.len());
        }
        Self { begins, taps }
    }

    fn of(&self, pixel: usize) -> &[(usize, f32)] {
        &self.taps[self.begins[pixel]..self.begins[pixel + 1]]
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
        let room = || vec![0.0f32; self.from.width];
        out.data.par_chunks_exact_mut(self.to.width).enumerate().for_each_init(room, |line, (y, row)| {
            line.fill(0.0);
            for &(j, weight) in self.rows.of(y) {
                for field in fields {
                    line.iter_mut().zip(field.row(j)).for_each(|(sum, v)| *sum += weight * v);
                }
            }
            for (x, value) in row.iter_mut().enumerate() {
                *value = self.columns.of(x).iter().map(|&(i, weight)| weight * line[i]).sum();
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
