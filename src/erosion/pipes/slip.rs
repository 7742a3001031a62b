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

/// Adds to `bed` what slides to and from a row. All rows begin one cell west of the map.
#[inline(always)]
pub fn slide(share: f32, ground: [&[f32]; 3], talus: [&[f32]; 3], bed: &mut [f32]) {
    let n = bed.len();
    let (ground, talus) = (ground.map(|row| &row[..n + 2]), talus.map(|row| &row[..n + 2]));
    let (k, across) = (share, share * FRAC_1_SQRT_2);
    for i in 0..n {
        let (z, t) = (ground[1][i + 1], talus[1][i + 1]);
        let side = |j: usize, m: usize| pull(z, ground[j][m], t, talus[j][m], 1.0);
        let corner = |j: usize, m: usize| pull(z, ground[j][m], t, talus[j][m], SQRT_2);
        let sides = (side(1, i) + side(1, i + 2)) + (side(0, i + 1) + side(2, i + 1));
        let corners = (corner(0, i) + corner(2, i + 2)) + (corner(0, i + 2) + corner(2, i));
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
    let (ground, talus) = (ground.map(|row| &row[..n + 2]), talus.map(|row| &row[..n + 2]));
    let (rate, room) = (rate.map(|row| &row[..n + 2]), room.map(|row| &row[..n + 2]));
    let (k, across) = (share, share * FRAC_1_SQRT_2);
    for i in 0..n {
        let (z, t, a, free) = (ground[1][i + 1], talus[1][i + 1], rate[1][i + 1], room[1][i + 1]);
        let flux = |j: usize, m: usize, k: f32, far: f32| {
            // An eighth of half the room a face, so that all of them leave half of it.
            let most = 0.0625 * lo(free, room[j][m]);
            hi(lo(k * pull(z, ground[j][m], t, talus[j][m], far) * lo(a, rate[j][m]), most), -most)
        };
        let side = |j, m| flux(j, m, k, 1.0);
        let corner = |j, m| flux(j, m, across, SQRT_2);
        let sides = (side(1, i) + side(1, i + 2)) + (side(0, i + 1) + side(2, i + 1));
        let corners = (corner(0, i) + corner(2, i + 2)) + (corner(0, i + 2) + corner(2, i));
        bed[i] += sides + corners;
    }
}
