//! Lays down what found no room where it fell, so that no needle rises from it.
//!
//! A cell takes as much as fills it to its highest neighbour; the rest spreads to all sides and tries again.

use multiversion::multiversion;
use rayon::prelude::*;

use crate::grid::{Edges, for_each_row, sum_f64};

use super::bed::{Bed, Coast};

/// Share of a difference that passes between two neighbours in a pass; stable to 1/8.
const SPREAD: f32 = 0.1;
/// Cells that one thread works on at a time.
const RUN: usize = 8192;
/// Passes before what is left is spread over the whole map.
const PASSES: usize = 128;
/// Rounds in which the last of it finds its places.
const ROUNDS: usize = 16;
/// Most that a cell gets at once where it cannot be helped, m.
const THIN_M: f64 = 1e-3;

/// Lays down what fits of `rest`, m of rock by cell, in at most so many passes. What has found no room stays in `rest`.
pub fn lay_down(bed: &mut Bed, rest: &mut [f32], passes: usize) {
    // A thin coat makes no needle: not worth another pass.
    let thin = |rest: &[f32]| rest.iter().all(|&v| (v.abs() as f64) < THIN_M);
    if passes == 0 || thin(rest) {
        return;
    }
    let mut buffer = vec![0.0f32; rest.len()];
    let (mut held, mut other) = (rest, &mut buffer[..]);
    let mut done = 0;
    while done < passes && !thin(held) {
        fill(bed, held, other);
        spread(bed, held, other);
        std::mem::swap(&mut held, &mut other);
        done += 1;
    }
    if done % 2 == 1 {
        other.copy_from_slice(held);
    }
}

/// Lays down all of `rest`: the stage is over.
pub fn lay_all(bed: &mut Bed, rest: &mut [f32]) {
    // What the ground has to come to: passes in single precision round, and what they round away is laid down last.
    let whole = sum_f64(&bed.change) + sum_f64(rest);
    lay_down(bed, rest, PASSES);
    for i in 0..rest.len() {
        let thin = (rest[i].abs() as f64) < THIN_M && bed.rate(i) > 0.0 && bed.room(bed.height(i)) > rest[i].abs();
        put(bed, rest, i, if thin { rest[i] } else { 0.0 });
    }
    let sum = whole - sum_f64(&bed.change);
    rest.fill(0.0);
    if sum == 0.0 {
        return;
    }
    // A thin coat on cells all over the map, on land where sea has to stay sea.
    let may = |bed: &Bed, i: usize| bed.rate(i) > 0.0 && way(bed, i, sum) > THIN_M;
    let land = |bed: &Bed, i: usize| !bed.locked || bed.height(i) >= bed.sea_m;
    let among = |fits: &dyn Fn(usize) -> bool| (0..rest.len()).filter(|&i| fits(i)).collect::<Vec<_>>();
    let mut places = among(&|i| may(bed, i) && land(bed, i));
    if places.is_empty() {
        places = among(&|i| may(bed, i));
    }
    if places.is_empty() {
        places = among(&|i| bed.rate(i) > 0.0);
    }
    if places.is_empty() {
        places = among(&|_| true);
    }
    let mut count = ((sum.abs() / THIN_M).ceil() as usize).clamp(1, places.len());
    let mut left = sum;
    // Places that are full at their share leave more to the others; where none has room, rock is kept before the coast.
    for round in 1..=ROUNDS {
        for k in 0..count {
            let i = places[k * places.len() / count];
            let (old, most) = (bed.change[i], if round < ROUNDS { way(bed, i, sum) } else { f64::INFINITY });
            let share = (left / (count - k) as f64).clamp(-most, most);
            bed.change[i] = (old as f64 + share) as f32;
            left -= bed.change[i] as f64 - old as f64;
        }
        if !bed.locked || left.abs() <= 1e-6 * sum.abs() {
            break;
        }
        count = places.len();
    }
}

/// How far a height may go up (or down, where `sum` is below 0) without crossing the coast, m.
fn way(bed: &Bed, i: usize, sum: f64) -> f64 {
    let height = bed.height(i);
    match bed.coast() {
        Some(coast) if (height < coast.sea_m) == (sum > 0.0) => f64::from(coast.free(height)),
        _ => f64::INFINITY,
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
    let (width, height) = (bed.grid.width, bed.grid.height);
    let (frozen, held) = (&*bed, &*rest);
    for_each_row(taken, width, |y, row| {
        if y > 0 && y + 1 < height {
            take_within(frozen, held, y, row);
        }
        for x in rim(width, height, y) {
            let i = y * width + x;
            let height = frozen.height(i);
            let top = around(frozen, x, y).iter().map(|&j| frozen.height(j)).fold(height, f32::max);
            row[x] = fitting(held[i], [height, top], frozen.sea_m, frozen.room(height), frozen.rate(i));
        }
    });
    let (taken, start, coast) = (&*taken, &bed.start, bed.coast());
    bed.change.par_chunks_mut(RUN).zip(rest.par_chunks_mut(RUN)).enumerate().for_each(|(k, (change, rest))| {
        let of = k * RUN..k * RUN + rest.len();
        put_all(change, rest, &start[of.clone()], &taken[of], coast);
    });
}

/// Cells of row `y` whose neighbours are not all on the map, or on its other side.
fn rim(width: usize, height: usize, y: usize) -> impl Iterator<Item = usize> {
    let step = if y > 0 && y + 1 < height && width > 1 { width - 1 } else { 1 };
    (0..width).step_by(step)
}

/// What cells take within row `y`, which is not at the rim.
#[multiversion(targets("x86_64+avx2"))]
fn take_within(bed: &Bed, held: &[f32], y: usize, taken: &mut [f32]) {
    let held = within(held, bed.grid.width, y)[4];
    if bed.rate.is_empty() {
        take_at(bed, held, y, taken, |_| 1.0);
    } else {
        let rate = within(&bed.rate, bed.grid.width, y)[4];
        take_at(bed, held, y, taken, |x| rate[x]);
    }
}

/// The same under a rate.
#[inline(always)]
fn take_at(bed: &Bed, held: &[f32], y: usize, taken: &mut [f32], rate: impl Fn(usize) -> f32) {
    let (starts, changes) = (within(&bed.start, bed.grid.width, y), within(&bed.change, bed.grid.width, y));
    let (sea_m, coast) = (bed.sea_m, bed.coast());
    for (x, taken) in taken[1..][..held.len()].iter_mut().enumerate() {
        let height = starts[4][x] + changes[4][x];
        let mut top = height;
        for k in 0..9 {
            let other = starts[k][x] + changes[k][x];
            top = if other > top { other } else { top };
        }
        let most = coast.map_or(f32::INFINITY, |coast| coast.room(height));
        *taken = fitting(held[x], [height, top], sea_m, most, rate(x));
    }
}

/// The cells of row `y` of a raster but its first and last, and the eight cells around each: ninefold, the row itself in
/// the middle.
#[inline(always)]
fn within(of: &[f32], width: usize, y: usize) -> [&[f32]; 9] {
    let many = width.saturating_sub(2);
    let mut all = [&[][..]; 9];
    for (k, all) in all.iter_mut().enumerate() {
        *all = &of[(y + k / 3 - 1) * width..][..width][(k % 3).min(width - many)..][..many];
    }
    all
}

/// How much of what is held finds room in a cell of a height below the highest of its neighbours, where a height may
/// change by `most` at once.
#[inline(always)]
fn fitting(held: f32, [height, top]: [f32; 2], sea_m: f32, most: f32, rate: f32) -> f32 {
    let in_sea = top.max(height + 0.5 * (sea_m - height)).min(sea_m);
    let top = if height < sea_m { in_sea } else { top };
    let most = (0.5 * (top - height)).min(most) * rate;
    held.max(-most).min(most)
}

/// Moves what is taken from the rest of cells to their ground.
#[multiversion(targets("x86_64+avx2"))]
fn put_all(change: &mut [f32], rest: &mut [f32], start: &[f32], taken: &[f32], coast: Option<Coast>) {
    for (((change, rest), &start), &by) in change.iter_mut().zip(rest).zip(start).zip(taken) {
        let new = moved(*change, start, by, coast);
        *rest -= new - *change;
        *change = new;
    }
}

/// The change of a cell with `by` more, unless land would become sea or sea land that must not.
#[inline(always)]
fn moved(old: f32, start: f32, by: f32, coast: Option<Coast>) -> f32 {
    let new = old + by;
    // Half the way may round to the whole.
    let crosses = |coast: Coast| coast.crosses(start + old, start + new);
    if by == 0.0 || coast.is_some_and(crosses) { old } else { new }
}

/// Moves `by` from the rest of a cell to its ground, where it may.
fn put(bed: &mut Bed, rest: &mut [f32], i: usize, by: f32) {
    let old = bed.change[i];
    let new = moved(old, bed.start[i], by, bed.coast());
    bed.change[i] = new;
    rest[i] -= new - old;
}

/// Differences of what is left even out.
fn spread(bed: &Bed, rest: &[f32], next: &mut [f32]) {
    let (width, height) = (bed.grid.width, bed.grid.height);
    for_each_row(next, width, |y, row| {
        if y > 0 && y + 1 < height {
            spread_within(rest, width, y, row);
        }
        for x in rim(width, height, y) {
            let here = rest[y * width + x];
            let flow = around(bed, x, y).iter().fold(0.0, |flow, &j| flow + (rest[j] - here));
            row[x] = here + SPREAD * flow;
        }
    });
}

/// What is left within row `y`, which is not at the rim.
#[multiversion(targets("x86_64+avx2"))]
fn spread_within(rest: &[f32], width: usize, y: usize, next: &mut [f32]) {
    let held = within(rest, width, y);
    let many = held[4].len();
    for (x, next) in next.iter_mut().skip(1).take(many).enumerate() {
        let here = held[4][x];
        let mut flow = 0.0;
        for k in [0, 1, 2, 3, 5, 6, 7, 8] {
            flow += held[k][x] - here;
        }
        *next = here + SPREAD * flow;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;

    /// An all but drowned map takes what is left into its sea, up to the coast, and land never sinks under it.
    #[test]
    fn what_is_left_stays_on_its_side_of_the_coast() {
        let grid = Grid::new(4, 1, 40.0, Edges::Closed);
        let bed = |start: [f32; 4]| Bed { locked: true, margin_m: 1e-3, sea_m: 0.0, ..Bed::new(grid, start.to_vec()) };
        for (start, sum) in [
            ([-0.5, -2.0, -0.001, -0.0005], 2.2f32),
            ([-0.5, -2.0, 0.0005, -1.0], 50.0),
            ([0.5, 2.0, 0.001, 0.0005], -2.2),
        ] {
            let mut own = bed(start);
            lay_all(&mut own, &mut [sum, 0.0, 0.0, 0.0]);
            let laid: f64 = sum_f64(&own.change);
            assert!((laid - f64::from(sum)).abs() < 1e-5, "{laid} of {sum}");
            for (i, z) in start.into_iter().enumerate() {
                assert_eq!(z < 0.0, own.height(i) < 0.0, "{z} became {}", own.height(i));
            }
        }
    }
}
