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
fn around([a, b, c]: [&[f32]; 3], n: usize) -> [[&[f32]; 3]; 3] {
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

/// The same where cells have shares of their own (`rate`) or may not cross the sea's level (`room` to it, m): a face has
/// the lesser share and the lesser room of its two cells.
#[inline(always)]
pub fn slide_held(
    share: f32,
    ground: [&[f32]; 3],
    talus: [&[f32]; 3],
    rate: [&[f32]; 3],
    room: [&[f32]; 3],
    bed: &mut [f32],
) {
    let n = bed.len();
    let (ground, talus) = (around(ground, n), around(talus, n));
    let (rate, room) = (around(rate, n), around(room, n));
    let (k, across) = (share, share * FRAC_1_SQRT_2);
    for i in 0..n {
        let (z, t, a, free) = (ground[1][1][i], talus[1][1][i], rate[1][1][i], room[1][1][i]);
        let flux = |j: usize, m: usize, k: f32, far: f32| {
            // An eighth of half the room a face, so that all of them leave half of it.
            let most = 0.0625 * lo(free, room[j][m][i]);
            hi(lo(k * pull(z, ground[j][m][i], t, talus[j][m][i], far) * lo(a, rate[j][m][i]), most), -most)
        };
        let side = |j, m| flux(j, m, k, 1.0);
        let corner = |j, m| flux(j, m, across, SQRT_2);
        let sides = (side(1, 0) + side(1, 2)) + (side(0, 1) + side(2, 1));
        let corners = (corner(0, 0) + corner(2, 2)) + (corner(0, 2) + corner(2, 0));
        bed[i] += sides + corners;
    }
}
