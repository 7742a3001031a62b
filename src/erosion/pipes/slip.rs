//! Loose ground that is too steep slides: fluxes over the faces to eight neighbours, `k·(fall − talus)` each and over
//! corners `k/√2·(fall − √2·talus)`. Both cells at a face find the same bits, so nothing is lost.

use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::flow::{hi, lo};

/// What is above the talus, either way.
#[inline(always)]
fn excess(fall: f32, talus: f32) -> f32 {
    fall - lo(hi(fall, -talus), talus)
}

/// What slides over a face to a cell from its neighbour, before its share.
#[inline(always)]
fn pull(z: f32, other: f32, talus: f32, others: f32, far: f32) -> f32 {
    // A face is as wet as the wetter of its cells.
    excess(other - z, far * lo(talus, others))
}

/// Of three rows the cells to the west, beneath and to the east of each of `n`: slices of one length, each cut on its own
/// (`map` hides their length), need no check in a loop.
#[inline(always)]
fn around([a, b, c]: [&[f32]; 3], n: usize) -> Around<'_> {
    [
        [&a[..n], &a[1..][..n], &a[2..][..n]],
        [&b[..n], &b[1..][..n], &b[2..][..n]],
        [&c[..n], &c[1..][..n], &c[2..][..n]],
    ]
}

/// Adds to `bed` what slides to and from a row. All rows begin one cell west of the map.
#[inline(always)]
pub fn slide(share: f32, ground: [&[f32]; 3], talus: [&[f32]; 3], bed: &mut [f32]) {
    let n = bed.len();
    let (ground, talus) = (around(ground, n), around(talus, n));
    let (k, across) = (share, share * FRAC_1_SQRT_2);
    for i in 0..n {
        let (z, t) = (ground[1][1][i], talus[1][1][i]);
        let side = |j: usize, m: usize| pull(z, ground[j][m][i], t, talus[j][m][i], 1.0);
        let corner = |j: usize, m: usize| pull(z, ground[j][m][i], t, talus[j][m][i], SQRT_2);
        let sides = (side(1, 0) + side(1, 2)) + (side(0, 1) + side(2, 1));
        let corners = (corner(0, 0) + corner(2, 2)) + (corner(0, 2) + corner(2, 0));
        bed[i] += k * sides + across * corners;
    }
}

/// Values of a row's cells and of all around them.
type Around<'a> = [[&'a [f32]; 3]; 3];

/// What slides to cell `i` from the one at `[j, m]` around it, before its share: each cell has a rate of its own, a face the
/// lesser.
// Inlined at all eight faces: a call in the loop would keep it from running in vectors.
#[inline(always)]
fn rated([ground, talus, rate]: &[Around; 3], [j, m]: [usize; 2], i: usize, far: f32) -> f32 {
    let (a, b) = (rate[1][1][i], rate[j][m][i]);
    pull(ground[1][1][i], ground[j][m][i], talus[1][1][i], talus[j][m][i], far) * lo(a, b)
}

/// The same where cells have rates of their own.
#[inline(always)]
pub fn slide_rated(share: f32, ground: [&[f32]; 3], talus: [&[f32]; 3], rate: [&[f32]; 3], bed: &mut [f32]) {
    let n = bed.len();
    let all = [around(ground, n), around(talus, n), around(rate, n)];
    let (k, across) = (share, share * FRAC_1_SQRT_2);
    for i in 0..n {
        let sides = (rated(&all, [1, 0], i, 1.0) + rated(&all, [1, 2], i, 1.0))
            + (rated(&all, [0, 1], i, 1.0) + rated(&all, [2, 1], i, 1.0));
        let corners = (rated(&all, [0, 0], i, SQRT_2) + rated(&all, [2, 2], i, SQRT_2))
            + (rated(&all, [0, 2], i, SQRT_2) + rated(&all, [2, 0], i, SQRT_2));
        bed[i] += k * sides + across * corners;
    }
}

/// What slides over a face where heights may not cross the sea's level: an eighth of half the lesser room to it, so that all
/// faces leave half of it.
#[inline(always)]
fn within(flux: f32, room: &Around, [j, m]: [usize; 2], i: usize) -> f32 {
    let (a, b) = (room[1][1][i], room[j][m][i]);
    let most = 0.0625 * lo(a, b);
    hi(lo(flux, most), -most)
}

/// The same where, besides, no cell may cross the sea's level (`room` to it, m).
#[inline(always)]
pub fn slide_locked(
    share: f32,
    ground: [&[f32]; 3],
    talus: [&[f32]; 3],
    rate: [&[f32]; 3],
    room: [&[f32]; 3],
    bed: &mut [f32],
) {
    let n = bed.len();
    let (all, room) = ([around(ground, n), around(talus, n), around(rate, n)], around(room, n));
    let (k, across) = (share, share * FRAC_1_SQRT_2);
    // A loop for each pair of faces: eight at once need more places to read from than a processor can hold.
    for [one, two] in [[[1, 0], [1, 2]], [[0, 1], [2, 1]]] {
        for i in 0..n {
            bed[i] += within(k * rated(&all, one, i, 1.0), &room, one, i)
                + within(k * rated(&all, two, i, 1.0), &room, two, i);
        }
    }
    for [one, two] in [[[0, 0], [2, 2]], [[0, 2], [2, 0]]] {
        for i in 0..n {
            bed[i] += within(across * rated(&all, one, i, SQRT_2), &room, one, i)
                + within(across * rated(&all, two, i, SQRT_2), &room, two, i);
        }
    }
}
