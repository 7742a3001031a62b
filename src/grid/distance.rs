//! Exact Euclidean distance to the nearest marked cell, and which cell that is.
//!
//! Separable lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012), O(cells), rows and columns in parallel.
//! Rims never wrap.

use rayon::prelude::*;

use super::{Field, Grid, for_each_row};

/// For each cell the nearest marked one.
#[derive(Clone, Debug)]
pub struct Nearest {
    /// Row-major index of the nearest marked cell, `u32::MAX` where none was found.
    pub index: Field<u32>,
    /// Distance to it between cell centres, m; infinite where none was found.
    pub distance_m: Field<f32>,
}

const NONE: u32 = u32::MAX;

/// The nearest cell for which `marked(index)` holds, from every cell.
pub fn nearest_feature(grid: Grid, marked: impl Fn(usize) -> bool + Sync) -> Nearest {
    nearest_within(grid, f64::INFINITY, marked)
}

/// [`nearest_feature`] for cells that have one within `reach_m`; others may have none. Short reaches cost less.
pub fn nearest_within(grid: Grid, reach_m: f64, marked: impl Fn(usize) -> bool + Sync) -> Nearest {
    let (w, h) = (grid.width, grid.height);
    // A cell to spare for rounding.
    let reach = ((reach_m / grid.cell_m).ceil() as usize).saturating_add(1);
    // Pass 1, stored transposed: in each column, the row of the nearest marked cell.
    let mut rows = vec![NONE; w * h];
    for_each_row(&mut rows, h, |x, column| {
        let mut last: Option<usize> = None;
        for (y, row) in column.iter_mut().enumerate() {
            if marked(y * w + x) {
                last = Some(y);
            }
            *row = last.filter(|r| y - r <= reach).map_or(NONE, |r| r as u32);
        }
        last = None;
        for y in (0..h).rev() {
            if column[y] == y as u32 {
                last = Some(y);
            }
            if let Some(below) = last.filter(|below| below - y <= reach)
                && (column[y] == NONE || below - y < y - column[y] as usize)
            {
                column[y] = below as u32;
            }
        }
    });
    // Pass 2: along each row, the lower envelope of the columns' parabolas.
    let mut index = Field::filled(grid, NONE);
    let mut distance_m = Field::filled(grid, f32::INFINITY);
    let lines = index.data.par_chunks_exact_mut(w.max(1)).zip(distance_m.data.par_chunks_exact_mut(w.max(1)));
    lines.enumerate().for_each(|(y, (index, distance_m))| {
        envelope(&rows, w, h, y, |x, column, row| {
            index[x] = (row * w + column) as u32;
            let (dx, dy) = (column as f64 - x as f64, row as f64 - y as f64);
            distance_m[x] = ((dx * dx + dy * dy).sqrt() * grid.cell_m) as f32;
        });
    });
    Nearest { index, distance_m }
}

/// What [`nearest_feature`] finds from one cell, column by column away from it: for few cells, near to what they look
/// for.
pub fn nearest_from(grid: Grid, cell: usize, marked: impl Fn(usize) -> bool) -> Option<usize> {
    let (x, y) = grid.cell_of(cell);
    // By distance, then by column, then by row.
    let mut best: Option<[usize; 3]> = None;
    for dx in 0..grid.width {
        if best.is_some_and(|[least, ..]| dx * dx > least) {
            break;
        }
        let columns = [x.checked_sub(dx), Some(x + dx).filter(|&column| column < grid.width)];
        for column in columns.into_iter().flatten() {
            for dy in 0..grid.height {
                let distance2 = dx * dx + dy * dy;
                if best.is_some_and(|[least, ..]| distance2 > least) {
                    break;
                }
                let rows = [y.checked_sub(dy), Some(y + dy).filter(|&row| row < grid.height)];
                for row in rows.into_iter().flatten().filter(|&row| marked(grid.index(column, row))) {
                    let found = [distance2, column, row];
                    best = Some(best.map_or(found, |best| best.min(found)));
                }
            }
        }
    }
    best.map(|[_, column, row]| grid.index(column, row))
}

/// Calls `put(x, column, row)` for each cell of row `y` that has a nearest one.
fn envelope(rows: &[u32], w: usize, h: usize, y: usize, mut put: impl FnMut(usize, usize, usize)) {
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
    for (k, &(column, _)) in apex.iter().enumerate() {
        let to = from.get(k + 1).map_or(w, |&next| next as usize);
        for x in from[k] as usize..to {
            put(x, column, rows[column * h + y] as usize);
        }
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

    #[test]
    fn a_short_reach_and_a_single_cell_find_the_same() {
        let grid = Grid::new(41, 29, 410.0, Edges::Open);
        for seed in 0..40u64 {
            let marked: Vec<bool> = (0..grid.cells())
                .map(|i| (i as u64 * 2654435761 + seed * 97).wrapping_mul(0x9E3779B97F4A7C15) >> 57 == 0)
                .collect();
            let all = nearest_feature(grid, |i| marked[i]);
            let near = nearest_within(grid, 50.0, |i| marked[i]);
            for i in 0..grid.cells() {
                let (from, found) = (nearest_from(grid, i, |j| marked[j]), all.index.data[i]);
                assert_eq!(from.map_or(NONE, |j| j as u32), found, "seed {seed} cell {i}");
                if all.distance_m.data[i] <= 50.0 {
                    assert_eq!(near.index.data[i], found, "seed {seed} cell {i}");
                    assert_eq!(near.distance_m.data[i], all.distance_m.data[i]);
                } else {
                    assert!(near.distance_m.data[i] > 50.0);
                }
            }
        }
    }
}
