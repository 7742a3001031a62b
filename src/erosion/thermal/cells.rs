//! One pass of an automaton over a raster: first what each cell sheds for each metre that a neighbour lies lower, then what
//! that gives and takes. Olsen's sheds to neighbours that lie too low; the other to all that lie lower, by slope: what slides
//! spreads, so that a scree has no ribs along the raster.

use multiversion::multiversion;
use rayon::prelude::*;

use super::{
    flux::{Slope, Terms, row_of},
    raster::Raster,
};

/// One pass, to all lower neighbours or to those that lie too low; adds what each cell gained to `change`. `shed` is room for
/// what the pass works out.
pub(super) fn pass(
    slope: &mut Slope,
    (shed, to_all): (&mut Raster, bool),
    terms: &Terms,
    start: &[f32],
    change: &mut [f32],
) {
    match (to_all, terms.coast.is_some(), slope.mask.is_some()) {
        (false, false, false) => pass_of::<false, false, false>(slope, shed, terms, start, change),
        (false, false, true) => pass_of::<false, false, true>(slope, shed, terms, start, change),
        (false, true, false) => pass_of::<false, true, false>(slope, shed, terms, start, change),
        (false, true, true) => pass_of::<false, true, true>(slope, shed, terms, start, change),
        (true, false, false) => pass_of::<true, false, false>(slope, shed, terms, start, change),
        (true, false, true) => pass_of::<true, false, true>(slope, shed, terms, start, change),
        (true, true, false) => pass_of::<true, true, false>(slope, shed, terms, start, change),
        (true, true, true) => pass_of::<true, true, true>(slope, shed, terms, start, change),
    }
}

fn pass_of<const ALL: bool, const LOCKED: bool, const RATE: bool>(
    slope: &mut Slope,
    shed: &mut Raster,
    terms: &Terms,
    start: &[f32],
    change: &mut [f32],
) {
    let (width, stride) = (slope.grid.width, slope.z.stride());
    {
        let (z, soft, drop) = (&slope.z, &slope.soft, &slope.drop);
        shed.write(|y, out| {
            let rows = [0, 1, 2].map(|k| z.row(y + k));
            let own = (row_of(drop, y + 1), row_of(soft, y + 1));
            match drop.is_some() {
                false => sheds::<ALL, false, RATE>(rows, own, terms, out),
                true => sheds::<ALL, true, RATE>(rows, own, terms, out),
            }
        });
    }
    shed.join(slope.grid.edges);
    let (z, drop, mask, shed) = (&slope.z, &slope.drop, &slope.mask, &*shed);
    let rows = |y: usize| {
        [0, 1, 2].map(|k| Rows {
            z: z.row(y + k),
            shed: shed.row(y + k),
            drop: row_of(drop, y + k),
            mask: row_of(mask, y + k),
        })
    };
    let height = slope.grid.height;
    let next = slope.next.0.data.par_chunks_exact_mut(stride).skip(1).take(height);
    let ground = (next, change.par_chunks_exact_mut(width)).into_par_iter().enumerate();
    match &mut slope.next.1 {
        Some(next_drop) => {
            let drops = next_drop.data.par_chunks_exact_mut(stride).skip(1).take(height);
            ground.zip((drops, slope.loose.par_chunks_exact_mut(width))).for_each(
                |((y, (z, change)), (drop, loose))| {
                    let (z, drop) = (&mut z[1..=width], &mut drop[1..=width]);
                    moves::<ALL, LOCKED, true, RATE>(&rows(y), terms, &start[y * width..], z, drop, change, loose);
                },
            );
        }
        None => ground.for_each(|(y, (z, change))| {
            moves::<ALL, LOCKED, false, RATE>(
                &rows(y),
                terms,
                &start[y * width..],
                &mut z[1..=width],
                &mut [],
                change,
                &mut [],
            );
        }),
    }
    slope.turn();
}

/// One end of a face: height, what is shed for each metre that the other lies lower, and how far it may.
#[derive(Clone, Copy)]
struct Cell {
    z: f32,
    shed: f32,
    stands: f32,
    mask: f32,
}

/// How far apart the middles of two neighbours are, cells.
#[inline(always)]
fn apart<const DIAGONALLY: bool>() -> f32 {
    if DIAGONALLY { std::f32::consts::SQRT_2 } else { 1.0 }
}

/// How much lower a neighbour lies, and how much of that is too much.
#[inline(always)]
fn lower<const DIAGONALLY: bool>(here: f32, there: f32, stands: f32) -> (f32, f32) {
    let fall = here - there;
    (fall, fall - apart::<DIAGONALLY>() * stands)
}

/// A neighbour's part in what a cell sheds, and by how much it lies too low, m.
#[inline(always)]
fn offer<const ALL: bool, const DIAGONALLY: bool>(here: f32, there: f32, stands: f32) -> (f32, f32) {
    let (fall, excess) = lower::<DIAGONALLY>(here, there, stands);
    match ALL {
        // By slope, not by height: a diagonal neighbour is further away.
        true => (fall.max(0.0) * (1.0 / apart::<DIAGONALLY>()), excess * (1.0 / apart::<DIAGONALLY>())),
        false => (if excess > 0.0 { fall } else { 0.0 }, excess),
    }
}

/// What a cell gives to a neighbour and takes from it, m.
#[inline(always)]
fn face<const ALL: bool, const LOCKED: bool, const DIAGONALLY: bool>(
    terms: &Terms,
    here: Cell,
    there: Cell,
) -> (f32, f32) {
    // Nothing leaves a mask, nor comes in.
    let open = here.mask.min(there.mask);
    let give = here.shed * open * offer::<ALL, DIAGONALLY>(here.z, there.z, here.stands).0;
    let take = there.shed * open * offer::<ALL, DIAGONALLY>(there.z, here.z, there.stands).0;
    match LOCKED {
        true => (terms.whole(terms.keep(give, here.z, there.z)), terms.whole(terms.keep(take, there.z, here.z))),
        false => (terms.whole(give), terms.whole(take)),
    }
}

/// What a row's cells shed for each metre that a neighbour lies lower: nothing where none lies too low.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn sheds<const ALL: bool, const DROP: bool, const RATE: bool>(
    z: [&[f32]; 3],
    (drop, soft): (&[f32], &[f32]),
    terms: &Terms,
    out: &mut [f32],
) {
    let n = out.len();
    let z = [&z[0][..n + 2], &z[1][..n + 2], &z[2][..n + 2]];
    let (drop, soft) = (&drop[..if DROP { n + 2 } else { 0 }], &soft[..if RATE { n + 2 } else { 0 }]);
    for x in 0..n {
        let here = z[1][x + 1];
        let stands = if DROP { drop[x + 1] } else { terms.drop_m[0] };
        // Plain functions, written out: a closure handed to another function is not drawn into the loop.
        let falls = [
            offer::<ALL, true>(here, z[0][x], stands),
            offer::<ALL, false>(here, z[0][x + 1], stands),
            offer::<ALL, true>(here, z[0][x + 2], stands),
            offer::<ALL, false>(here, z[1][x], stands),
            offer::<ALL, false>(here, z[1][x + 2], stands),
            offer::<ALL, true>(here, z[2][x], stands),
            offer::<ALL, false>(here, z[2][x + 1], stands),
            offer::<ALL, true>(here, z[2][x + 2], stands),
        ];
        let (mut most, mut sum) = (0.0f32, 0.0f32);
        for (part, excess) in falls {
            most = most.max(excess);
            sum += part;
        }
        let share = if RATE { terms.share * soft[x + 1] } else { terms.share };
        out[x] = if sum > 0.0 { share * most / sum } else { 0.0 };
    }
}

/// A row's rasters: heights, what is shed a metre, how far a neighbour may lie below, and the mask.
struct Rows<'a> {
    z: &'a [f32],
    shed: &'a [f32],
    drop: &'a [f32],
    mask: &'a [f32],
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn moves<const ALL: bool, const LOCKED: bool, const DROP: bool, const RATE: bool>(
    rows: &[Rows; 3],
    terms: &Terms,
    start: &[f32],
    next: &mut [f32],
    next_drop: &mut [f32],
    change: &mut [f32],
    loose: &mut [f32],
) {
    let n = next.len();
    let own = if DROP { n } else { 0 };
    let (start, change, next) = (&start[..n], &mut change[..n], &mut next[..n]);
    let (next_drop, loose) = (&mut next_drop[..own], &mut loose[..own]);
    let z = [&rows[0].z[..n + 2], &rows[1].z[..n + 2], &rows[2].z[..n + 2]];
    let sheds = [&rows[0].shed[..n + 2], &rows[1].shed[..n + 2], &rows[2].shed[..n + 2]];
    let [long, masked] = [DROP, RATE].map(|there| if there { n + 2 } else { 0 });
    let drop = [&rows[0].drop[..long], &rows[1].drop[..long], &rows[2].drop[..long]];
    let mask = [&rows[0].mask[..masked], &rows[1].mask[..masked], &rows[2].mask[..masked]];
    for x in 0..n {
        let at = |k: usize, x: usize| Cell {
            z: z[k][x],
            shed: sheds[k][x],
            stands: if DROP { drop[k][x] } else { terms.drop_m[0] },
            mask: if RATE { mask[k][x] } else { 1.0 },
        };
        let here = at(1, x + 1);
        let faces = [
            face::<ALL, LOCKED, true>(terms, here, at(0, x)),
            face::<ALL, LOCKED, false>(terms, here, at(0, x + 1)),
            face::<ALL, LOCKED, true>(terms, here, at(0, x + 2)),
            face::<ALL, LOCKED, false>(terms, here, at(1, x)),
            face::<ALL, LOCKED, false>(terms, here, at(1, x + 2)),
            face::<ALL, LOCKED, true>(terms, here, at(2, x)),
            face::<ALL, LOCKED, false>(terms, here, at(2, x + 1)),
            face::<ALL, LOCKED, true>(terms, here, at(2, x + 2)),
        ];
        let (mut given, mut taken) = (0.0f32, 0.0f32);
        for (give, take) in faces {
            (given, taken) = (given + give, taken + take);
        }
        change[x] += taken - given;
        next[x] = start[x] + change[x];
        if DROP {
            loose[x] = (loose[x] - given).max(0.0) + taken;
            next_drop[x] = terms.standing(loose[x]);
        }
    }
}
