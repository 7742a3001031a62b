//! Bringing a field to another number of samples: band-limited where it shrinks, Catmull-Rom where it grows.
//!
//! Keys' cubic (a = -1/2), stretched by the ratio of sizes where the result is coarser, so that no wave shorter than two of
//! its cells folds into a longer one. West-east first, then north-south. The same size gives the same bits.

use super::{Edges, Field, for_each_row};

/// Where the new samples lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// In the middles of equal cells that tile the map.
    Centres,
    /// On a lattice whose outermost points lie on the rim.
    Corners,
}

/// Evenly spaced places along an axis, in cells: 0 is the middle of the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places {
    /// The first place.
    pub first: f64,
    /// Cells from one place to the next.
    pub step: f64,
    /// How many there are.
    pub count: usize,
}

impl Places {
    fn over(from: usize, count: usize, points: Points) -> Self {
        // A single point on a rim of two has no second to measure from; it stands in the middle like a centre.
        let corners = points == Points::Corners && count > 1;
        let step = from as f64 / if corners { count - 1 } else { count } as f64;
        Self { first: if corners { -0.5 } else { 0.5 * step - 0.5 }, step, count }
    }
}

/// `width` x `height` samples over the same map, row by row from the north.
pub fn resample(field: &Field<f32>, width: usize, height: usize, points: Points) -> Vec<f32> {
    let grid = field.grid;
    resample_at(field, Places::over(grid.width, width, points), Places::over(grid.height, height, points))
}

/// Samples where `across` and `along` meet, row by row from the north. Only the rows that they need are read.
pub fn resample_at(field: &Field<f32>, across: Places, along: Places) -> Vec<f32> {
    let (grid, width) = (field.grid, across.count);
    let across = taps(grid.width, across, grid.edges);
    let along = taps(grid.height, along, grid.edges);
    let rows = || along.iter().flatten().map(|&(i, _)| i);
    let (top, bottom) = (rows().min().unwrap_or(0), rows().max().unwrap_or(0));
    let mut narrow = vec![0.0f32; width * (bottom - top + 1)];
    for_each_row(&mut narrow, width, |y, out| {
        let row = field.row(top + y);
        for (value, tap) in out.iter_mut().zip(&across) {
            *value = tap.iter().map(|&(i, weight)| weight * row[i] as f64).sum::<f64>() as f32;
        }
    });
    let mut out = vec![0.0f32; width * along.len()];
    for_each_row(&mut out, width, |y, row| {
        let mut sums = vec![0.0f64; width];
        for &(i, weight) in &along[y] {
            for (sum, &v) in sums.iter_mut().zip(&narrow[(i - top) * width..][..width]) {
                *sum += weight * v as f64;
            }
        }
        for (value, sum) in row.iter_mut().zip(sums) {
            *value = sum as f32;
        }
    });
    out
}

/// For each new sample along an axis, which old ones it takes, and how much of each.
fn taps(from: usize, places: Places, edges: Edges) -> Vec<Vec<(usize, f64)>> {
    let stretch = places.step.max(1.0);
    (0..places.count)
        .map(|k| {
            let at = places.first + k as f64 * places.step;
            // Hair's breadths that rounding makes must not blur samples that lie on cells.
            let at = if (at - at.round()).abs() < 1e-6 { at.round() } else { at };
            let reach = 2.0 * stretch;
            let (low, high) = ((at - reach).ceil() as i64, (at + reach).floor() as i64);
            let weighed: Vec<(usize, f64)> = (low..=high)
                .map(|i| (inside(i, from, edges), keys((i as f64 - at) / stretch)))
                .filter(|&(_, weight)| weight != 0.0)
                .collect();
            let sum: f64 = weighed.iter().map(|&(_, weight)| weight).sum();
            weighed.into_iter().map(|(i, weight)| (i, weight / sum)).collect()
        })
        .collect()
}

fn inside(i: i64, size: usize, edges: Edges) -> usize {
    match edges {
        Edges::Wrap => i.rem_euclid(size as i64) as usize,
        Edges::Open | Edges::Closed => i.clamp(0, size as i64 - 1) as usize,
    }
}

/// Keys' cubic convolution kernel (1981) with a = -1/2.
pub(crate) fn keys(t: f64) -> f64 {
    let t = t.abs();
    if t < 1.0 {
        (1.5 * t - 2.5) * t * t + 1.0
    } else if t < 2.0 {
        ((-0.5 * t + 2.5) * t - 4.0) * t + 2.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;

    fn field(width: usize, height: usize, f: impl Fn(usize, usize) -> f32 + Sync) -> Field<f32> {
        Field::from_fn(Grid::new(width, height, width as f64, Edges::Open), f)
    }

    #[test]
    fn the_same_size_gives_the_same_bits() {
        let rough = field(37, 23, |x, y| ((x * 7919 + y * 104_729) % 1009) as f32 * 1.37 - 300.0);
        assert_eq!(resample(&rough, 37, 23, Points::Centres), rough.data);
    }

    #[test]
    fn planes_stay_planes_inside() {
        let plane = field(60, 40, |x, y| 3.0 * (x as f32 + 0.5) - 2.0 * (y as f32 + 0.5));
        for (w, h, points) in [(90, 80, Points::Centres), (30, 10, Points::Centres), (31, 21, Points::Corners)] {
            let out = resample(&plane, w, h, points);
            let (steps, first) = if points == Points::Corners { ((w - 1, h - 1), 0.0) } else { ((w, h), 0.5) };
            // The rim's value is continued beyond it, which bends a plane as far as the kernel reaches.
            let margin = (2.0 * h as f64 / 40.0).max(2.0).ceil() as usize + 1;
            for y in margin..h - margin {
                for x in margin..w - margin {
                    let at = [(x as f64 + first) * 60.0 / steps.0 as f64, (y as f64 + first) * 40.0 / steps.1 as f64];
                    let want = 3.0 * at[0] - 2.0 * at[1];
                    assert!((out[y * w + x] as f64 - want).abs() < 1e-4, "{w} {x} {y}: {} {want}", out[y * w + x]);
                }
            }
        }
    }

    #[test]
    fn what_is_too_fine_for_the_result_vanishes() {
        // A wave of 3 cells, shrunk 4 to 1: plain picking would keep its height of 1.
        let wave = field(240, 240, |x, _| (x as f32 * std::f32::consts::TAU / 3.0).sin());
        let out = resample(&wave, 60, 60, Points::Centres);
        let inner = out.iter().enumerate().filter(|(i, _)| (4..56).contains(&(i % 60)));
        let most = inner.fold(0.0f32, |most, (_, v)| most.max(v.abs()));
        assert!(most < 0.02, "{most}");
    }
}
