//! Midpoint displacement on a square that covers the map.
//!
//! The square's side is the map's longer side. It begins with random heights at `blocks + 1` points a side; level `j`
//! halves the spacing: first **all** diamond centres (mean of four
//! corners and a displacement), then **all** square points (mean of their three or four neighbours and a displacement),
//! displacements uniform within `±r₀·2^(−jH)`. Levels follow until the spacing is at most a cell; cell centres read the
//! lattice bilinearly. A displacement's key is the point's level and place in it: a finer grid adds levels and leaves the
//! coarse points as they are. Creases along the axes belong to the method (Miller 1986).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::longer_side_m;
use crate::{
    grid::{Field, for_each_row},
    noise::Key,
    process::{Context, ProcessError, Shape},
};

/// Land by repeated halving: diamond-square.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DiamondSquareParams {
    /// Largest height of the first points above or below the mean, and of the first displacements.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "higher summits and deeper basins"))]
    pub height_m: f64,
    /// Mean height of the land.
    #[schemars(range(min = -12000.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "more land, less sea"))]
    pub base_m: f64,
    /// Hurst exponent: displacements shrink by 2^(−H) with every halving.
    #[schemars(range(min = 0.05, max = 1.2), extend("x-unit" = "1", "x-effect" = "smoother land"))]
    pub hurst: f64,
    /// Squares along the map's longer side before halving begins.
    #[schemars(range(min = 1, max = 64), extend("x-unit" = "1", "x-effect" = "more and smaller landmasses"))]
    pub blocks: u32,
}

impl Default for DiamondSquareParams {
    fn default() -> Self {
        Self { height_m: 2500.0, base_m: 0.0, hurst: 0.85, blocks: 3 }
    }
}

impl Shape for DiamondSquareParams {
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let key = context.key.named("diamond-square");
        let cells = grid.width.max(grid.height);
        let mut lattice = Lattice::first(key, self.height_m, self.blocks.max(1) as usize);
        while lattice.side - 1 < cells {
            context.check()?;
            lattice = lattice.halved(key, self.height_m, self.hurst);
        }
        let per_metre = (lattice.side - 1) as f64 / longer_side_m(&grid);
        Ok(Field::from_fn(grid, |x, y| {
            let [px, py] = grid.center_m(x, y);
            (self.base_m + lattice.at([px * per_metre, py * per_metre])) as f32
        }))
    }
}

/// Heights at `side` x `side` points, `blocks·2^level + 1` a side.
struct Lattice {
    level: u32,
    side: usize,
    values: Vec<f32>,
}

/// Uniform in −1 to 1.
fn displacement(key: Key, x: usize, y: usize) -> f32 {
    (key.lattice(x as i32, y as i32) as i64 as f64 / 9_223_372_036_854_775_808.0) as f32
}

impl Lattice {
    fn first(key: Key, range_m: f64, blocks: usize) -> Self {
        let (key, side) = (key.named("first"), blocks + 1);
        let values = (0..side * side).map(|i| range_m as f32 * displacement(key, i % side, i / side)).collect();
        Self { level: 0, side, values }
    }

    /// The lattice of half the spacing. Old points keep their heights.
    fn halved(&self, key: Key, range_m: f64, hurst: f64) -> Self {
        let (n, key) = (self.side, key.with(self.level as u64));
        let range = (range_m * libm::exp2(-(self.level as f64) * hurst)) as f32;
        let mut centres = vec![0.0; (n - 1) * (n - 1)];
        for_each_row(&mut centres, n - 1, |y, row| {
            let (north, south) = (&self.values[y * n..][..n], &self.values[(y + 1) * n..][..n]);
            for (x, v) in row.iter_mut().enumerate() {
                let mean = 0.25 * ((north[x] + north[x + 1]) + (south[x] + south[x + 1]));
                *v = mean + range * displacement(key, 2 * x + 1, 2 * y + 1);
            }
        });
        let side = 2 * n - 1;
        let mut values = vec![0.0; side * side];
        for_each_row(&mut values, side, |y, row| {
            for (x, v) in row.iter_mut().enumerate() {
                *v = match (x % 2, y % 2) {
                    (0, 0) => self.values[y / 2 * n + x / 2],
                    (1, 1) => centres[y / 2 * (n - 1) + x / 2],
                    _ => self.edge_mean(&centres, x, y) + range * displacement(key, x, y),
                };
            }
        });
        Self { level: self.level + 1, side, values }
    }

    /// Mean of the neighbours of a square point: two old points along its edge, and the centres to either side.
    fn edge_mean(&self, centres: &[f32], x: usize, y: usize) -> f32 {
        let n = self.side;
        let old = |x: usize, y: usize| self.values[y * n + x];
        let centre = |x: usize, y: usize| centres[y * (n - 1) + x];
        let (i, j) = (x / 2, y / 2);
        let (ends, before, after) = if x % 2 == 1 {
            (old(i, j) + old(i + 1, j), (j > 0).then(|| centre(i, j - 1)), (j + 1 < n).then(|| centre(i, j)))
        } else {
            (old(i, j) + old(i, j + 1), (i > 0).then(|| centre(i - 1, j)), (i + 1 < n).then(|| centre(i, j)))
        };
        match (before, after) {
            (Some(a), Some(b)) => 0.25 * (ends + (a + b)),
            (Some(a), None) | (None, Some(a)) => (ends + a) / 3.0,
            (None, None) => 0.5 * ends,
        }
    }

    /// Bilinear height at a place in lattice spacings.
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let last = self.side - 2;
        let (i, j) = ((x as usize).min(last), (y as usize).min(last));
        let (fx, fy) = (x - i as f64, y - j as f64);
        let v = |x: usize, y: usize| self.values[y * self.side + x] as f64;
        let (north, south) =
            (v(i, j) + fx * (v(i + 1, j) - v(i, j)), v(i, j + 1) + fx * (v(i + 1, j + 1) - v(i, j + 1)));
        north + fy * (south - north)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_never_moves_a_point() {
        let key = Key::new(77);
        let mut lattice = Lattice::first(key, 1000.0, 3);
        for level in 0..8 {
            let finer = lattice.halved(key, 1000.0, 0.8);
            assert_eq!(finer.side, (3 << (level + 1)) + 1);
            for i in 0..lattice.values.len() {
                let (x, y) = (i % lattice.side, i / lattice.side);
                assert_eq!(finer.values[2 * y * finer.side + 2 * x], lattice.values[i]);
            }
            lattice = finer;
        }
    }

    #[test]
    fn structure_function_has_the_hurst_slope() {
        // Log-log slope 2H at H = 0.5; single maps scatter, so squares are averaged over 40 of them.
        let hurst = 0.5;
        let mut sums = [0.0; 5];
        for seed in 0..40 {
            let key = Key::new(seed);
            let mut lattice = Lattice::first(key, 1.0, 1);
            while lattice.side < 257 {
                lattice = lattice.halved(key, 1.0, hurst);
            }
            for (k, sum) in sums.iter_mut().enumerate() {
                let d = 2 << k;
                for y in (0..257).step_by(4) {
                    for x in 0..257 - d {
                        let row = &lattice.values[y * 257..];
                        *sum += ((row[x + d] - row[x]) as f64).powi(2) / (257 - d) as f64;
                    }
                }
            }
        }
        let slope = (sums[4] / sums[0]).log2() / 4.0;
        assert!((slope - 2.0 * hurst).abs() < 0.2, "{slope}");
    }
}
