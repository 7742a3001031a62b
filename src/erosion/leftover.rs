//! Lays down what found no room where it fell, so that no needle rises from it.
//!
//! A cell takes as much as fills it to its highest neighbour; the rest spreads to all sides and tries again.

use crate::grid::{Edges, for_each_row, sum_f64};

use super::bed::Bed;

/// Share of a difference that passes between two neighbours in a pass; stable to 1/8.
const SPREAD: f32 = 0.1;
/// Passes before what is left is spread over the whole map.
const PASSES: usize = 128;
/// Most that a cell gets at once where it cannot be helped, m.
const THIN_M: f64 = 1e-3;

/// Lays down what fits of `rest`, m of rock by cell, in at most so many passes. What has found no room stays in `rest`.
pub fn lay_down(bed: &mut Bed, rest: &mut [f32], passes: usize) {
    let mut buffer = Vec::new();
    for _ in 0..passes {
        // A thin coat makes no needle: not worth another pass.
        if rest.iter().all(|&v| (v.abs() as f64) < THIN_M) {
            return;
        }
        if buffer.is_empty() {
            buffer = vec![0.0f32; rest.len()];
        }
        fill(bed, rest, &mut buffer);
        spread(bed, rest, &mut buffer);
    }
}

/// Lays down all of `rest`: the stage is over.
pub fn lay_all(bed: &mut Bed, rest: &mut [f32]) {
    lay_down(bed, rest, PASSES);
    for i in 0..rest.len() {
        let thin = (rest[i].abs() as f64) < THIN_M && bed.rate(i) > 0.0;
        put(bed, rest, i, if thin { rest[i] } else { 0.0 });
    }
    let sum = sum_f64(rest);
    rest.fill(0.0);
    if sum == 0.0 {
        return;
    }
    // A thin coat on cells all over the map, on land where sea has to stay sea.
    let open = |bed: &Bed, i: usize| bed.rate(i) > 0.0 && (!bed.locked || bed.height(i) > bed.sea_m + THIN_M as f32);
    let mut places: Vec<usize> = (0..rest.len()).filter(|&i| open(bed, i)).collect();
    if places.is_empty() {
        places = (0..rest.len()).collect();
    }
    let count = ((sum.abs() / THIN_M).ceil() as usize).clamp(1, places.len());
    let mut left = sum;
    for k in 0..count {
        let i = places[k * places.len() / count];
        let old = bed.change[i];
        bed.change[i] = (old as f64 + left / (count - k) as f64) as f32;
        left -= bed.change[i] as f64 - old as f64;
    }
}

/// The eight neighbours of a cell that are on the map, with itself in the place of those that are not.
#[inline]
fn around(bed: &Bed, x: usize, y: usize) -> [usize; 8] {
    let g = &bed.grid;
    if x > 0 && y > 0 && x + 1 < g.width && y + 1 < g.height {
        let (i, w) = (g.index(x, y), g.width);
        return [i - w - 1, i - w, i - w + 1, i - 1, i + 1, i + w - 1, i + w, i + w + 1];
    }
    let (w, e, n, s) = (g.column(x, -1), g.column(x, 1), g.row(y, -1), g.row(y, 1));
    let stop = g.edges != Edges::Wrap;
    [(w, n), (x, n), (e, n), (w, y), (e, y), (w, s), (x, s), (e, s)].map(|(i, j)| {
        // A diagonal that was stopped at one rim alone would count a neighbour twice.
        let diagonal = (stop && (i == x) != (j == y)) && ((i == x && n != j && s != j) || (j == y && w != i && e != i));
        if diagonal { g.index(x, y) } else { g.index(i, j) }
    })
}

/// Every cell takes what fills it to its highest neighbour, in the sea no more than to the sea's level.
fn fill(bed: &mut Bed, rest: &mut [f32], taken: &mut [f32]) {
    let width = bed.grid.width;
    let frozen = &*bed;
    let held = &*rest;
    for_each_row(taken, width, |y, row| {
        for (x, taken) in row.iter_mut().enumerate() {
            let i = y * width + x;
            *taken = 0.0;
            if held[i] == 0.0 {
                continue;
            }
            let height = frozen.height(i);
            let mut top = around(frozen, x, y).iter().map(|&j| frozen.height(j)).fold(height, f32::max);
            if height < frozen.sea_m {
                top = top.max(height + 0.5 * (frozen.sea_m - height)).min(frozen.sea_m);
            }
            let most = (0.5 * (top - height)).min(frozen.room(height)) * frozen.rate(i);
            *taken = held[i].clamp(-most, most);
        }
    });
    for (i, &by) in taken.iter().enumerate() {
        put(bed, rest, i, by);
    }
}

/// Moves `by` from the rest of a cell to its ground, unless land would become sea or sea land that must not.
fn put(bed: &mut Bed, rest: &mut [f32], i: usize, by: f32) {
    let (old, start) = (bed.change[i], bed.start[i]);
    let new = old + by;
    // Half the way may round to the whole.
    if by != 0.0 && !(bed.locked && (start + old < bed.sea_m) != (start + new < bed.sea_m)) {
        bed.change[i] = new;
        rest[i] -= new - old;
    }
}

/// Differences of what is left even out.
fn spread(bed: &Bed, rest: &mut [f32], next: &mut [f32]) {
    let width = bed.grid.width;
    let held = &*rest;
    for_each_row(next, width, |y, row| {
        for (x, next) in row.iter_mut().enumerate() {
            let here = held[y * width + x];
            let mut flow = 0.0;
            for j in around(bed, x, y) {
                flow += held[j] - here;
            }
            *next = here + SPREAD * flow;
        }
    });
    rest.copy_from_slice(next);
}
