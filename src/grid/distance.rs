//! Exact Euclidean distance to the nearest marked cell, and which cell that is.
//!
//! Separable lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012), O(cells), rows and columns in parallel.
//! Rims never wrap.

use super::{Field, Grid, for_each_row};

/// For each cell the nearest marked one.
#[derive(Clone, Debug)]
pub struct Nearest {
    /// Row-major index of the nearest marked cell, `u32::MAX` where none is marked.
    pub index: Field<u32>,
    /// Distance to it between cell centres, m; infinite where none is marked.
    pub distance_m: Field<f32>,
}

const NONE: u32 = u32::MAX;

/// The nearest cell for which `marked(index)` holds, from every cell.
pub fn nearest_feature(grid: Grid, marked: impl Fn(usize) -> bool + Sync) -> Nearest {
    let (w, h) = (grid.width, grid.height);
    // Pass 1, stored transposed: in each column, the row of the nearest marked cell.
    let mut rows = vec![NONE; w * h];
    for_each_row(&mut rows, h, |x, column| {
        let mut last: Option<usize> = None;
        for (y, row) in column.iter_mut().enumerate() {
            if marked(y * w + x) {
                last = Some(y);
            }
            *row = last.map_or(NONE, |r| r as u32);
        }
        last = None;
        for y in (0..h).rev() {
            if column[y] == y as u32 {
                last = Some(y);
            }
            if let Some(below) = last
                && (column[y] == NONE || below - y < y - column[y] as usize)
            {
                column[y] = below as u32;
            }
        }
    });
    // Pass 2: along each row, the lower envelope of the columns' parabolas.
    let mut index = Field::filled(grid, NONE);
    for_each_row(&mut index.data, w, |y, out| envelope(&rows, w, h, y, out));
    let mut distance_m = Field::filled(grid, f32::INFINITY);
    for_each_row(&mut distance_m.data, w, |y, out| {
        for (x, d) in out.iter_mut().enumerate() {
            let at = index.data[y * w + x];
            if at != NONE {
                let (fx, fy) = grid.cell_of(at as usize);
                let (dx, dy) = (fx as f64 - x as f64, fy as f64 - y as f64);
                *d = ((dx * dx + dy * dy).sqrt() * grid.cell_m) as f32;
            }
        }
    });
    Nearest { index, distance_m }
}

fn envelope(rows: &[u32], w: usize, h: usize, y: usize, out: &mut [u32]) {
    let height = |x: usize| {
        let r = rows[x * h + y];
        (r != NONE).then(|| (r as i64 - y as i64).pow(2))
    };
    // Parabola apexes and, for each, the first column where it is the lowest.
    let mut apex: Vec<(usize, i64)> = Vec::with_capacity(w);
    let mut from: Vec<i64> = Vec::with_capacity(w);
    for x in 0..w {
        let Some(hx) = height(x) else { continue };
        loop {
            let Some(&(v, hv)) = apex.last() else {
                apex.push((x, hx));
                from.push(0);
                break;
            };
            // First column at which x is strictly lower than v; ties stay with the left one.
            let (xi, vi) = (x as i64, v as i64);
            let start = (hx + xi * xi - hv - vi * vi).div_euclid(2 * (xi - vi)) + 1;
            if start <= *from.last().unwrap_or(&0) && apex.len() > 1 {
                apex.pop();
                from.pop();
                continue;
            }
            if start <= 0 && apex.len() == 1 {
                apex.pop();
                from.pop();
                continue;
            }
            if start < w as i64 {
                apex.push((x, hx));
                from.push(start);
            }
            break;
        }
    }
    let mut k = 0;
    for (x, value) in out.iter_mut().enumerate() {
        while k + 1 < apex.len() && from[k + 1] <= x as i64 {
            k += 1;
        }
        *value = apex.get(k).map_or(NONE, |&(v, _)| rows[v * h + y] * w as u32 + v as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn equals_brute_force() {
        let grid = Grid::new(23, 17, 230.0, Edges::Open);
        for seed in 0..40u64 {
            let marked: Vec<bool> = (0..grid.cells())
                .map(|i| (i as u64 * 2654435761 + seed * 97).wrapping_mul(0x9E3779B97F4A7C15) >> 58 == 0)
                .collect();
            let found = nearest_feature(grid, |i| marked[i]);
            for i in 0..grid.cells() {
                let (x, y) = grid.cell_of(i);
                let best = (0..grid.cells()).filter(|&j| marked[j]).map(|j| {
                    let (a, b) = grid.cell_of(j);
                    (a.abs_diff(x).pow(2) + b.abs_diff(y).pow(2)) as f64
                });
                let best = best.fold(f64::INFINITY, f64::min).sqrt() * 10.0;
                assert_eq!(found.distance_m.data[i], best as f32, "seed {seed} cell {x},{y}");
            }
        }
    }
}
