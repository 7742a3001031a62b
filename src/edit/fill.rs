//! Heights where a file has none: a membrane hung from the cells around the hole.
//!
//! Solves Laplace's equation in the holes with the cells around them as they are and nothing flowing over the map's rim,
//! by a cascade of grids: each half as fine as the last, solved from the coarsest up, its answer the finer one's start. A
//! membrane has no summit or pit of its own, so nothing is invented.

use rayon::prelude::*;

use crate::grid::{Edges, Field, Grid, linear};

/// Relaxations a grid. What is left after them is smoother than this many cells, and the coarser grid had that right.
const SWEEPS: usize = 100;
/// Damped, so that a chessboard of errors dies out too.
const DAMPING: f32 = 0.8;

/// Replaces every `NaN` of a raster that has at least one height.
pub(super) fn fill(heights: &mut Vec<f32>, width: usize, height: usize) {
    let grid = Grid { width, height, cell_m: 1.0, edges: Edges::Open };
    let mut field = Field { grid, data: std::mem::take(heights) };
    solve(&mut field);
    *heights = field.data;
}

fn solve(field: &mut Field<f32>) {
    let (w, h) = (field.grid.width, field.grid.height);
    let holes: Vec<u32> = (0..field.data.len() as u32).filter(|&i| field.data[i as usize].is_nan()).collect();
    if holes.is_empty() || w * h == 1 {
        return;
    }
    let mut coarse = halved(field);
    solve(&mut coarse);
    let start: Vec<f32> = holes
        .par_iter()
        .map(|&i| {
            let (x, y) = field.grid.cell_of(i as usize);
            linear(&coarse, [0.5 * (x as f64 + 0.5), 0.5 * (y as f64 + 0.5)]) as f32
        })
        .collect();
    put(field, &holes, &start);
    for _ in 0..SWEEPS {
        let next: Vec<f32> = holes.par_iter().map(|&i| relaxed(field, i as usize)).collect();
        put(field, &holes, &next);
    }
}

fn put(field: &mut Field<f32>, at: &[u32], values: &[f32]) {
    for (&i, &v) in at.iter().zip(values) {
        field.data[i as usize] = v;
    }
}

/// A cell nearer to the mean of its neighbours.
fn relaxed(field: &Field<f32>, i: usize) -> f32 {
    let (x, y) = field.grid.cell_of(i);
    let (w, h) = (field.grid.width, field.grid.height);
    let (mut sum, mut count) = (0.0f64, 0.0f64);
    let mut add = |there: bool, j: usize| {
        if there {
            sum += field.data[j] as f64;
            count += 1.0;
        }
    };
    add(x > 0, i.wrapping_sub(1));
    add(x + 1 < w, i + 1);
    add(y > 0, i.wrapping_sub(w));
    add(y + 1 < h, i + w);
    let old = field.data[i];
    old + DAMPING * ((sum / count) as f32 - old)
}

/// Half as many cells a side; each the mean of the heights in it, `NaN` where it has none.
fn halved(field: &Field<f32>) -> Field<f32> {
    let (w, h) = (field.grid.width, field.grid.height);
    let grid = Grid { width: w.div_ceil(2), height: h.div_ceil(2), cell_m: 1.0, edges: Edges::Open };
    Field::from_fn(grid, |x, y| {
        let (mut sum, mut count) = (0.0f64, 0.0f64);
        for row in 2 * y..(2 * y + 2).min(h) {
            for v in &field.row(row)[2 * x..(2 * x + 2).min(w)] {
                if !v.is_nan() {
                    sum += *v as f64;
                    count += 1.0;
                }
            }
        }
        // No height gives 0 / 0, which is what marks a hole.
        (sum / count) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn punched(
        w: usize,
        h: usize,
        height: impl Fn(usize, usize) -> f32,
        hole: impl Fn(usize, usize) -> bool,
    ) -> Vec<f32> {
        let mut heights: Vec<f32> = (0..w * h).map(|i| height(i % w, i / w)).collect();
        for (i, v) in heights.iter_mut().enumerate() {
            if hole(i % w, i / w) {
                *v = f32::NAN;
            }
        }
        fill(&mut heights, w, h);
        heights
    }

    #[test]
    fn a_plane_closes_over_its_hole() {
        let plane = |x: usize, y: usize| 3.0 * x as f32 - 2.0 * y as f32 + 100.0;
        let hole = |x: usize, y: usize| (x as f32 - 40.0).hypot(y as f32 - 30.0) < 20.0;
        let filled = punched(90, 70, plane, hole);
        for (i, v) in filled.iter().enumerate() {
            // A membrane through a plane's rim is the plane; the cascade stops within a quarter of a cell's rise of it.
            assert!((v - plane(i % 90, i / 90)).abs() < 0.9, "{i}: {v}");
        }
    }

    #[test]
    fn holes_stay_between_their_neighbours_and_heights_as_they_were() {
        let rough = |x: usize, y: usize| ((x * 37 + y * 101) % 64) as f32;
        let hole = |x: usize, y: usize| x < 50 && !(x * y + x).is_multiple_of(5);
        let filled = punched(101, 57, rough, hole);
        for (i, &v) in filled.iter().enumerate() {
            assert!((0.0..=63.0).contains(&v));
            assert!(hole(i % 101, i / 101) || v == rough(i % 101, i / 101));
        }
    }

    #[test]
    fn one_height_is_enough() {
        let filled = punched(33, 20, |_, _| 7.5, |x, y| (x, y) != (30, 2));
        assert!(filled.iter().all(|v| *v == 7.5));
    }
}
