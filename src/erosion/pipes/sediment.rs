//! What water does to a row of cells: its depth, what it carries, what it takes from the bed and lays down.

use std::hint::select_unpredictable;

use super::{
    flow::{hi, lo},
    rules::{BUMP, Beat, CALM, FROUDE, GRAVITY, POND_M, Rules, SHEET_M, SLOW, STILL_M, STRIDE, THICKEST, TIMID},
};

/// A row of cells before the step. Rows of `ground` and `depth` begin one cell west of the map.
pub struct Before<'a> {
    /// Heights of the rows to the north, here and to the south.
    pub ground: [&'a [f32]; 3],
    pub depth: &'a [f32],
    /// Share of exchange that cells have; none in the sea.
    pub act: &'a [f32],
    /// Faces from west to east, of water and of sediment.
    pub x: [&'a [f32]; 2],
    pub north: [&'a [f32]; 2],
    pub south: [&'a [f32]; 2],
}

/// A smooth step from 0 to 1.
#[inline(always)]
pub fn ramp(t: f32) -> f32 {
    let t = lo(hi(t, 0.0), 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// How far a height is from the margin at the sea's level that it may not enter, m.
#[inline(always)]
pub fn room(rules: &Rules, height: f32) -> f32 {
    hi((height - rules.sea_m).abs() - rules.margin_m, 0.0)
}

/// What the water of a row does: its depth after the step, and in `able` the sediment that it can carry, m. `speed2` becomes
/// the square of the speed, m²/s², `dried` the water that dried up, m, `made` what rounding added, `stands` what share of
/// it stands rather than runs (below 0 none, above 1 all), and `flux` what passed over the faces to the west and north.
/// Single slices, so that the compiler knows that none overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments)]
pub fn run(
    rules: &Rules,
    beat: &Beat,
    before: &Before,
    new_depth: &mut [f32],
    able: &mut [f32],
    speed2: &mut [f32],
    dried: &mut [f32],
    made: &mut [f32],
    stands: &mut [f32],
    flux_x: &mut [f32],
    flux_y: &mut [f32],
) {
    let n = able.len();
    // Slices of one length, each cut on its own (`map` hides their length), need no check in the loop.
    let [north, here, south] = before.ground;
    let (west, east) = (&here[..n], &here[2..][..n]);
    let (north, south, depth) = (&north[1..][..n], &south[1..][..n], &before.depth[1..][..n]);
    let (qw, qe, qn, qs) = (&before.x[0][..n], &before.x[0][1..][..n], &before.north[0][..n], &before.south[0][..n]);
    let (new_depth, speed2) = (&mut new_depth[..n], &mut speed2[..n]);
    let (dried, made, stands) = (&mut dried[..n], &mut made[..n], &mut stands[..n]);
    let (flux_x, flux_y) = (&mut flux_x[..n], &mut flux_y[..n]);
    let (swift, slow) = (FROUDE * FROUDE * GRAVITY, 1.0 / (SLOW * SLOW * GRAVITY));
    let slopes = 0.5 / rules.cell_m;
    for i in 0..n {
        let d1 = depth[i];
        let came = beat.pace * ((qw[i] - qe[i]) + (qn[i] - qs[i]));
        let d2 = hi(d1 + came, 0.0);
        let mean = hi(0.5 * (d1 + d2), STILL_M);
        let per_depth = 1.0 / mean;
        // Squares before the mean: where a stream turns, each face has half of it, and it is as fast as where it is straight.
        let through2 = (qw[i] * qw[i] + qe[i] * qe[i]) + (qn[i] * qn[i] + qs[i] * qs[i]);
        // Where a front comes to dry ground, depths say little; water is no faster there than elsewhere.
        let v2 = lo(0.5 * through2 * (per_depth * per_depth), swift * mean);
        let (u, v) = (0.5 * (qw[i] + qe[i]) * per_depth, 0.5 * (qn[i] + qs[i]) * per_depth);
        let (gx, gy) = (slopes * (east[i] - west[i]), slopes * (south[i] - north[i]));
        let g2 = gx * gx + gy * gy;
        let sine2 = hi(g2 / (1.0 + g2), rules.tilt2);
        let deep = ramp(d2 * rules.per_film) * (1.0 - ramp((d2 - rules.shallow_m) * rules.per_deep));
        let thick = lo(rules.capacity * deep * (v2 * sine2).sqrt(), THICKEST);
        able[i] = thick * d2;
        let left = hi(d2 - beat.dry_m, 0.0);
        new_depth[i] = left;
        dried[i] = d2 - left;
        // What the depth gained and no flux brought: rounding, and the cut at nothing.
        made[i] = (d2 - d1) - came;
        speed2[i] = if d2 > SHEET_M { u * u + v * v } else { 0.0 };
        stands[i] = lo(d2 * (1.0 / POND_M), 1.0 - slow * v2 * per_depth);
        (flux_x[i], flux_y[i]) = (qw[i], qn[i]);
    }
}

/// Brings a row's sediment over its faces, and exchanges it with the bed (`able` it can be, under water `deep`): `bed` becomes what is to be added to that, m.
#[inline(always)]
pub fn exchange(
    rules: &Rules,
    beat: &Beat,
    before: &Before,
    [able, deep]: [&[f32]; 2],
    soft: &[f32],
    load: &mut [f32],
    bed: &mut [f32],
) {
    let n = bed.len();
    let [north, here, south] = before.ground;
    let (west, east) = (&here[..n], &here[2..][..n]);
    let (north, here, south) = (&north[1..][..n], &here[1..][..n], &south[1..][..n]);
    let (able, deep, soft, act, load) = (&able[..n], &deep[..n], &soft[..n], &before.act[1..][..n], &mut load[..n]);
    let (sw, se, sn, ss) = (&before.x[1][..n], &before.x[1][1..][..n], &before.north[1][..n], &before.south[1][..n]);
    let (stride_m, bump_m, per_factor) = (STRIDE * rules.cell_m, BUMP * rules.cell_m, 1.0 / rules.factor);
    let free = |z: f32| if rules.locked { 0.25 * room(rules, z) } else { f32::MAX };
    for i in 0..n {
        let brought = beat.pace * ((sw[i] - se[i]) + (sn[i] - ss[i]));
        let had = load[i];
        let carried = hi(had + brought, 0.0);
        let lack = able[i] - carried;
        // Not an `if`: a softness that is only read where it is needed is slow to read.
        let share = select_unpredictable(lack > 0.0, beat.dissolve * soft[i], beat.settle);
        let (z, w, e, n, s) = (here[i], west[i], east[i], north[i], south[i]);
        let low = lo(lo(w, e), lo(n, s));
        let mean = 0.25 * ((w + e) + (n + s));
        let most = lo(lo(stride_m, CALM * deep[i]), free(z));
        let dig = lo(TIMID * hi(z - low, 0.0), most);
        let fill = lo(TIMID * hi(mean - z + bump_m, 0.0), most);
        let worn = hi(lo(rules.factor * (share * act[i] * lack), dig), -fill);
        let worn = hi(worn, -rules.factor * carried);
        load[i] = hi(carried + worn * per_factor, 0.0);
        // Of the bed comes what the load really gained besides what fluxes brought, rounding and all.
        bed[i] = -rules.factor * ((load[i] - had) - brought);
    }
}

/// Keeps the surface of standing water where it is while its bed gets `bed`. In the hours that the bed's time has and the
/// water's has not, what it displaces runs off: that is counted with `dried`.
#[inline(always)]
pub fn keep_level(rules: &Rules, land: &[f32], stands: &[f32], bed: &[f32], depth: &mut [f32], dried: &mut [f32]) {
    let n = depth.len();
    let (land, stands, bed, dried) = (&land[..n], &stands[..n], &bed[..n], &mut dried[..n]);
    for i in 0..n {
        let had = depth[i];
        let share = rules.keep * land[i] * lo(hi(stands[i], 0.0), 1.0);
        let left = hi(had - share * hi(bed[i], 0.0), 0.0);
        depth[i] = left;
        dried[i] += had - left;
    }
}

/// Adds to a bed what it is to get; `rest` keeps what is too small for the sum. Softness follows.
#[inline(always)]
pub fn lay(bed: &[f32], change: &mut [f32], rest: &mut [f32]) {
    let n = change.len();
    let (bed, rest) = (&bed[..n], &mut rest[..n]);
    for i in 0..n {
        // Knuth's two-sum: the sum and what rounding took from it.
        let add = bed[i] + rest[i];
        let old = change[i];
        let sum = old + add;
        let back = sum - old;
        rest[i] = (old - (sum - back)) + (add - back);
        change[i] = sum;
    }
}

/// Puts what came to cells without any rate, by rounding, back to `rest`: they stay to the last bit.
#[inline(always)]
pub fn stay(rate: &[f32], old: &[f32], change: &mut [f32], rest: &mut [f32]) {
    let n = change.len();
    let (rate, old, rest) = (&rate[..n], &old[..n], &mut rest[..n]);
    for i in 0..n {
        let (got, was) = (change[i], old[i]);
        let kept = select_unpredictable(rate[i] > 0.0, got, was);
        rest[i] += got - kept;
        change[i] = kept;
    }
}

/// Puts what a locked bed got too much back to `rest`: heights stay clear of the sea's level, or where they were.
#[inline(always)]
pub fn hold(rules: &Rules, start: &[f32], ground: &[f32], old: &[f32], change: &mut [f32], rest: &mut [f32]) {
    let n = change.len();
    let (start, ground, old, rest) = (&start[..n], &ground[..n], &old[..n], &mut rest[..n]);
    for i in 0..n {
        let (under, got) = (ground[i] < rules.sea_m, change[i]);
        let top = hi((rules.sea_m - rules.margin_m) - start[i], old[i]);
        let bottom = lo((rules.sea_m + rules.margin_m) - start[i], old[i]);
        let kept = if under { lo(got, top) } else { hi(got, bottom) };
        rest[i] += got - kept;
        change[i] = kept;
    }
}

/// What is laid down is loose; what is worn off brings the rock up again.
#[inline(always)]
pub fn soften(rules: &Rules, bed: &[f32], soft: &mut [f32]) {
    for (soft, bed) in soft.iter_mut().zip(bed) {
        *soft = lo(hi(*soft + rules.softening * bed, rules.rock_softness), 1.0);
    }
}
