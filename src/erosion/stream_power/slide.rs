//! Slopes that fail in whatever direction they face: no gradient steeper than the talus angle is left.
//!
//! What remains is the highest surface below the one given that rises nowhere faster than the angle allows, which solves
//! `|∇z| = S` wherever something failed. Godunov's upwind differences, swept up and down the rows until they rest (Zhao 2005):
//! a slope stands alike in all directions, where the eight ways of the water would cut it into stripes and facets.

use rayon::prelude::*;

use crate::grid::Grid;

/// Change in a round of sweeps below which a surface has settled, m; the next step begins with what is left.
const SETTLED_M: f64 = 1e-3;
/// Rounds after which it has to have: a straight slope takes one, each bend in the way down to its foot another.
const MOST_ROUNDS: usize = 16;

/// Sweeps with buffers kept.
#[derive(Default)]
pub(super) struct Slide {
    /// The lower of the cells above and below each cell of a row.
    beside: Vec<f64>,
    /// Whether a row or one next to it has changed since it was last swept.
    waits: Vec<bool>,
}

impl Slide {
    /// Lowers `surface` until it rises by at most `steepest` in any direction; cells that `rest` keep their height.
    pub(super) fn settle(&mut self, grid: Grid, steepest: f64, rest: &[bool], surface: &mut [f64]) {
        let width = grid.width;
        self.beside.resize(width, 0.0);
        self.waits.clear();
        self.waits.resize(grid.height, false);
        let rise = steepest * grid.cell_m;
        let shared = &*surface;
        self.waits.par_iter_mut().enumerate().for_each(|(y, waits)| {
            let row = |step| &shared[grid.row(y, step) * width..][..width];
            let (north, own, south) = (row(-1), row(0), row(1));
            *waits = (0..width).any(|x| {
                let least = own[grid.column(x, -1)].min(own[grid.column(x, 1)]).min(north[x].min(south[x]));
                own[x] > least + rise * std::f64::consts::FRAC_1_SQRT_2
            });
        });
        for _ in 0..MOST_ROUNDS {
            let down = (0..grid.height).fold(0.0, |most, y| self.sweep(grid, rise, rest, y, surface).max(most));
            let most = (0..grid.height).rev().fold(down, |most, y| self.sweep(grid, rise, rest, y, surface).max(most));
            if most < SETTLED_M {
                break;
            }
        }
    }

    /// One row, eastward and back; gives the greatest change.
    fn sweep(&mut self, grid: Grid, rise: f64, rest: &[bool], y: usize, surface: &mut [f64]) -> f64 {
        if !self.waits[y] {
            return 0.0;
        }
        let (width, north, south) = (grid.width, grid.row(y, -1), grid.row(y, 1));
        for (x, beside) in self.beside.iter_mut().enumerate() {
            *beside = surface[north * width + x].min(surface[south * width + x]);
        }
        let (row, rest) = (&mut surface[y * width..][..width], &rest[y * width..][..width]);
        let beside = &self.beside;
        let mut most = 0.0f64;
        let mut visit = |x: usize| {
            let (own, a, b) = (row[x], row[grid.column(x, -1)].min(row[grid.column(x, 1)]), beside[x]);
            // Lower by any pair of neighbours than this it cannot be.
            if own <= a.min(b) + rise * std::f64::consts::FRAC_1_SQRT_2 || rest[x] {
                return;
            }
            let bound = bound(a, b, rise);
            if bound < own {
                most = most.max(own - bound);
                row[x] = bound;
            }
        };
        (0..width).for_each(&mut visit);
        (0..width).rev().for_each(&mut visit);
        self.waits[y] = false;
        if most > 0.0 {
            self.waits[north] = true;
            self.waits[south] = true;
        }
        most
    }
}

/// The height at which the slope to the lower neighbour along each axis is `rise` a cell.
fn bound(a: f64, b: f64, rise: f64) -> f64 {
    let apart = (a - b).abs();
    if apart >= rise { a.min(b) + rise } else { 0.5 * (a + b + (2.0 * rise * rise - apart * apart).sqrt()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn a_high_block_falls_to_cones_about_what_rests() {
        // All of it far too high but for a foot in the middle: what is left is a cone upside down.
        let grid = Grid { width: 201, height: 201, cell_m: 5.0, edges: Edges::Open };
        let foot = grid.index(100, 100);
        let mut z = vec![1e4; grid.cells()];
        z[foot] = 300.0;
        Slide::default().settle(grid, 0.7, &vec![false; z.len()], &mut z);
        let mut worst = 0.0f64;
        for (i, z) in z.iter().enumerate() {
            let (x, y) = grid.cell_of(i);
            let away_m = 5.0 * ((x as f64 - 100.0).powi(2) + (y as f64 - 100.0).powi(2)).sqrt();
            if away_m > 100.0 {
                worst = worst.max(((z - 300.0) / (0.7 * away_m) - 1.0).abs());
            }
        }
        // The eight ways would be 8 % too high between them; this errs by the logarithm of the distance in cells, over it.
        assert!(worst < 0.06, "{worst}");
    }

    #[test]
    fn what_is_gentle_or_rests_stays_and_a_wrapped_map_has_no_rim() {
        for edges in [Edges::Open, Edges::Wrap] {
            let grid = Grid { width: 64, height: 48, cell_m: 10.0, edges };
            let wave = |i: usize| {
                let (x, y) = grid.cell_of(i);
                40.0 * (x as f64 * std::f64::consts::TAU / 64.0).sin()
                    + 20.0 * (y as f64 * std::f64::consts::TAU / 48.0).cos()
            };
            let gentle: Vec<f64> = (0..grid.cells()).map(wave).collect();
            let mut z = gentle.clone();
            Slide::default().settle(grid, 1.0, &vec![false; z.len()], &mut z);
            assert_eq!(z, gentle);
            let mut z: Vec<f64> = gentle.iter().map(|z| 9.0 * z).collect();
            let (steep, mut rest) = (z.clone(), vec![false; z.len()]);
            rest[grid.index(16, 0)] = true;
            Slide::default().settle(grid, 1.0, &rest, &mut z);
            assert_eq!(z[grid.index(16, 0)], steep[grid.index(16, 0)]);
            assert!(z.iter().zip(&steep).all(|(z, steep)| z <= steep));
            let (west, east) = (grid.index(0, 24), grid.index(63, 24));
            if edges == Edges::Wrap {
                assert!((z[west] - z[east]).abs() <= 10.0 + SETTLED_M, "{} {}", z[west], z[east]);
            }
        }
    }
}
