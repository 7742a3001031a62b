//! Shade on the ground, worked out on the processor: how much of the sky each place sees, and how high the shade of the land
//! reaches over it for one direction of the sun.

use rayon::prelude::*;

use super::ground::copies;
use crate::grid::{Field, Grid};

/// Directions in which the horizon is looked for, and how many times farther each look goes.
const DIRECTIONS: usize = 12;
const LOOKS: usize = 7;

/// Share of the sky's light that level ground receives, 0 to 1: the mean over all directions of the squared cosine of the
/// horizon's height. Far looks read smaller copies. The rim's value goes on beyond it.
pub fn sky_share(height: &Field<f32>, exaggeration: f64) -> Field<f32> {
    let grid = height.grid;
    let all = copies([grid.width, grid.height], height.data.clone());
    let per_cell = (exaggeration / grid.cell_m) as f32;
    let mut out = Field::filled(grid, 1.0f32);
    let ways: Vec<[f32; 2]> = (0..DIRECTIONS)
        .map(|k| {
            let turn = (k as f64 + 0.5) / DIRECTIONS as f64 * std::f64::consts::TAU;
            [libm::cos(turn) as f32, libm::sin(turn) as f32]
        })
        .collect();
    out.data.par_chunks_mut(grid.width).enumerate().for_each(|(y, row)| {
        for (x, out) in row.iter_mut().enumerate() {
            let here = height.data[y * grid.width + x];
            let mut sum = 0.0;
            for way in &ways {
                let mut steep: f32 = 0.0;
                for look in 0..LOOKS {
                    let away = 1.5 * (1 << look) as f32;
                    let level = look.saturating_sub(1).min(all.len() - 1);
                    let ([w, h], data) = &all[level];
                    let scale = 1.0 / (1 << level) as f32;
                    let at = |base: usize, way: f32, size: usize| {
                        (((base as f32 + 0.5 + way * away) * scale) as isize).clamp(0, size as isize - 1) as usize
                    };
                    let there = data[at(y, way[1], *h) * w + at(x, way[0], *w)];
                    steep = steep.max((there - here) * per_cell / away);
                }
                sum += 1.0 / (1.0 + steep * steep);
            }
            *out = sum / DIRECTIONS as f32;
        }
    });
    out
}

/// How high shade reaches over the ground, m as drawn (negative: the sun is seen from so far below the ground), and how far
/// away is what throws it, cells.
pub type Shade = [f32; 2];

/// The shade for a sun in a direction (east, north, up): a sweep away from it, row by row or column by column, each cell from the two
/// it lies behind. Linear in the cells.
pub fn sweep(height: &Field<f32>, exaggeration: f64, toward: [f64; 3]) -> Vec<Shade> {
    let grid = height.grid;
    let flat = libm::hypot(toward[0], toward[1]);
    if toward[2] <= 0.0 {
        return vec![[1e6, 1.0]; grid.cells()];
    }
    if flat < 1e-6 {
        return vec![[-1e6, 1.0]; grid.cells()];
    }
    // Steps run along the axis that is nearer to the sun's; south is down in the raster.
    let (east, south) = (toward[0] / flat, -toward[1] / flat);
    let along_x = east.abs() > south.abs();
    let (main, cross) = if along_x { (east, south) } else { (south, east) };
    let aside = (cross / main.abs()) as f32;
    let step_cells = (1.0 / main.abs()) as f32;
    let fall = (f64::from(step_cells) * grid.cell_m * toward[2] / flat) as f32;
    let (lanes, steps) = if along_x { (grid.height, grid.width) } else { (grid.width, grid.height) };
    let index = |lane: usize, step: usize| {
        let step = if main > 0.0 { steps - 1 - step } else { step };
        if along_x { lane * grid.width + step } else { step * grid.width + lane }
    };
    let drawn = |i: usize| height.data[i] * exaggeration as f32;
    let mut out = vec![[-1e6f32, 1.0f32]; grid.cells()];
    // The shade's height over the datum, and the distance to what throws it, of the step before.
    let mut before: Vec<Shade> = (0..lanes).map(|lane| [drawn(index(lane, 0)) - 1e6, 1.0]).collect();
    let mut now = before.clone();
    for step in 1..steps {
        for lane in 0..lanes {
            let at = (lane as f32 + aside).clamp(0.0, (lanes - 1) as f32);
            let (low, t) = (at as usize, at.fract());
            let high = (low + 1).min(lanes - 1);
            let top = |lane: usize| {
                let ground = drawn(index(lane, step - 1));
                let [shade, away] = before[lane];
                if ground >= shade { [ground, 0.0] } else { [shade, away] }
            };
            let (a, b) = (top(low), top(high));
            let reach = [a[0] + (b[0] - a[0]) * t - fall, a[1] + (b[1] - a[1]) * t + step_cells];
            now[lane] = reach;
            out[index(lane, step)] = [reach[0] - drawn(index(lane, step)), reach[1]];
        }
        std::mem::swap(&mut before, &mut now);
    }
    out
}

/// The raster on which shade is worked out: the world's own, or a coarser one.
pub fn coarse(height: &Field<f32>, most: usize) -> Field<f32> {
    let grid = height.grid;
    let longer = grid.width.max(grid.height);
    if longer <= most {
        return height.clone();
    }
    let level = (longer as f64 / most as f64).log2().ceil() as usize;
    let ([w, h], data) = copies([grid.width, grid.height], height.data.clone()).swap_remove(level);
    Field { grid: Grid { width: w, height: h, cell_m: grid.extent_m()[0] / w as f64, edges: grid.edges }, data }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn wall(at: usize, high_m: f32) -> Field<f32> {
        let grid = Grid::new(64, 64, 640.0, Edges::Open);
        Field::from_fn(grid, |x, _| if x == at { high_m } else { 0.0 })
    }

    #[test]
    fn a_wall_throws_a_shade_as_long_as_the_sun_is_low() {
        let height = wall(40, 100.0);
        for altitude in [20.0f64, 35.0, 60.0] {
            let (a, toward_east) = (altitude.to_radians(), 1.0);
            let shade = sweep(&height, 1.0, [libm::cos(a) * toward_east, 0.0, libm::sin(a)]);
            let length = 100.0 / libm::tan(a);
            let row = &shade[20 * 64..21 * 64];
            let shaded = row.iter().take(40).filter(|s| s[0] > 0.0).count();
            assert!((shaded as f64 - length / 10.0).abs() <= 1.0, "{altitude}: {shaded}");
            assert!(row[41..].iter().all(|s| s[0] < 0.0));
            // Ten cells behind it the shade reaches as high as the wall less the sun's fall.
            if libm::tan(a) < 1.0 {
                assert!((f64::from(row[30][0]) - (100.0 - 100.0 * libm::tan(a))).abs() < 1e-2);
                assert_eq!(row[30][1], 10.0);
            }
        }
    }

    #[test]
    fn shade_turns_with_the_sun() {
        let grid = Grid::new(65, 65, 650.0, Edges::Open);
        let hill = Field::from_fn(grid, |x, y| if x == 32 && y == 32 { 80.0 } else { 0.0 });
        for (east, north) in [(1.0, 0.0), (-0.6, 0.8), (0.3, -0.954), (-0.8, -0.6)] {
            let shade = sweep(&hill, 1.0, [east * 0.9, north * 0.9, 0.3]);
            let behind = |cells: f64| {
                let x = (32.0 - east * cells).round() as usize;
                let y = (32.0 + north * cells).round() as usize;
                shade[y * 65 + x][0]
            };
            assert!(behind(6.0) > 0.0, "{east} {north}");
            assert!(behind(-6.0) < 0.0);
        }
    }

    #[test]
    fn open_ground_sees_the_sky_and_a_pit_does_not() {
        let grid = Grid::new(64, 64, 640.0, Edges::Open);
        let plain = sky_share(&Field::filled(grid, 5.0), 1.0);
        assert!(plain.data.iter().all(|&v| v == 1.0));
        let pit = Field::from_fn(grid, |x, y| if x.abs_diff(32) + y.abs_diff(32) < 2 { -100.0 } else { 0.0 });
        let seen = sky_share(&pit, 1.0);
        assert!(seen.at(32, 32) < 0.1 && seen.at(2, 2) > 0.99);
    }
}
