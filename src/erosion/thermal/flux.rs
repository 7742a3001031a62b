//! One pass of the flux form over a raster.
//!
//! Gather only: a cell works out what it gives to and takes from each neighbour. Both ends of a face come to the same bits,
//! because one's difference is exactly the other's with the sign turned, so what leaves here arrives there.

use multiversion::multiversion;
use rayon::prelude::*;

use super::raster::{BEYOND, Raster};
use crate::{
    erosion::bed::Coast,
    grid::{Edges, Grid},
};

/// Loose ground of this thickness hides the rock below it, m.
const COVER_M: f32 = 1.0;
/// Of what stands between a height and the sea, the share that one face may move where coasts are locked: eight faces
/// together leave half of it.
const COAST_SHARE: f32 = 1.0 / 16.0;
/// `1/√2`.
const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// What holds for a whole raster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    /// Share of an excess over the talus that a straight face moves.
    pub(super) share: f32,
    /// How much lower than its neighbour a cell of loose ground and of rock may lie, m.
    pub(super) drop_m: [f32; 2],
    /// Everything moved is a multiple of this power of two, m.
    pub(super) quantum_m: f32,
    /// Where land has to stay land, and sea sea.
    pub(super) coast: Option<Coast>,
}

impl Terms {
    /// How far a neighbour may lie below a cell with so much loose ground, m.
    #[inline(always)]
    pub(super) fn standing(&self, loose_m: f32) -> f32 {
        let cover = (loose_m * (1.0 / COVER_M)).clamp(0.0, 1.0);
        let [ground, rock] = self.drop_m;
        rock + (ground - rock) * cover
    }

    /// Whole quanta: adding and taking away one and a half times 2^23 of them rounds to the nearest.
    #[inline(always)]
    pub(super) fn whole(&self, m: f32) -> f32 {
        let large = self.quantum_m * 12_582_912.0;
        (m + large) - large
    }

    /// What may pass from one height to another where coasts are locked: land gives, and sea takes, no more than leaves
    /// it what it is.
    #[inline(always)]
    pub(super) fn keep(&self, m: f32, from: f32, to: f32) -> f32 {
        let Some(coast) = self.coast else { return m };
        let gives = if from >= coast.sea_m { coast.free(from) * COAST_SHARE } else { f32::INFINITY };
        let takes = if to >= coast.sea_m { f32::INFINITY } else { coast.free(to) * COAST_SHARE };
        m.min(gives).min(takes)
    }
}

/// Shares of the rate by cell: all of them, or none where they are 1 everywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Shares {
    /// How soft a cell is: what it gives goes by that.
    pub(super) soft: Vec<f32>,
    /// Its mask: what passes between two cells goes by the lesser of theirs.
    pub(super) mask: Vec<f32>,
}

impl Shares {
    /// Whether all cells have all of the rate.
    pub(super) fn none(&self) -> bool {
        self.mask.is_empty()
    }
}

/// The ground that slides.
#[derive(Clone, Debug)]
pub(super) struct Slope {
    pub(super) grid: Grid,
    /// Height, m.
    pub(super) z: Raster,
    /// How far a neighbour may lie below a cell, m; where loose ground and rock stand at the same angle it is the same
    /// everywhere, and this is empty.
    pub(super) drop: Option<Raster>,
    /// How soft cells are, and their mask; nothing where all have all of the rate.
    pub(super) soft: Option<Raster>,
    pub(super) mask: Option<Raster>,
    /// Loose ground, m.
    pub(super) loose: Vec<f32>,
    /// The next pass's heights and drops.
    pub(super) next: (Raster, Option<Raster>),
}

impl Slope {
    /// Ground of these heights, with so much loose ground on it.
    pub(super) fn new(grid: Grid, height: &[f32], loose: Vec<f32>, shares: &Shares, terms: &Terms) -> Self {
        let lay = |values: &[f32], beyond: f32| {
            let mut raster = Raster::filled(&grid, beyond);
            raster.write(|y, row| row.copy_from_slice(&values[y * grid.width..][..grid.width]));
            raster
        };
        let z = lay(height, BEYOND);
        let drop = (terms.drop_m[0] != terms.drop_m[1]).then(|| {
            let drops: Vec<f32> = loose.iter().map(|&loose| terms.standing(loose)).collect();
            lay(&drops, 0.0)
        });
        let [soft, mask] = [&shares.soft, &shares.mask].map(|values| {
            (!shares.none()).then(|| {
                let mut raster = lay(values, 0.0);
                raster.join(grid.edges);
                raster
            })
        });
        let next = (z.clone(), drop.clone());
        let mut slope = Self { grid, z, drop, soft, mask, loose, next };
        slope.join();
        slope
    }

    fn join(&mut self) {
        let edges: Edges = self.grid.edges;
        self.z.join(edges);
        if let Some(drop) = &mut self.drop {
            drop.join(edges);
        }
    }

    /// One pass; adds what each cell gained to `change`. Heights are those at the `start` plus their change.
    pub(super) fn pass(&mut self, terms: &Terms, start: &[f32], change: &mut [f32]) {
        match (self.drop.is_some(), self.mask.is_some()) {
            (false, false) => self.rows::<false, false>(terms, start, change),
            (false, true) => self.rows::<false, true>(terms, start, change),
            (true, false) => self.rows::<true, false>(terms, start, change),
            (true, true) => self.rows::<true, true>(terms, start, change),
        }
        self.turn();
    }

    /// The next pass's ground becomes this one's.
    pub(super) fn turn(&mut self) {
        std::mem::swap(&mut self.z, &mut self.next.0);
        std::mem::swap(&mut self.drop, &mut self.next.1);
        self.join();
    }

    fn rows<const DROP: bool, const RATE: bool>(&mut self, terms: &Terms, start: &[f32], change: &mut [f32]) {
        let (width, stride) = (self.grid.width, self.z.stride());
        let (z, drop, soft, mask) = (&self.z, &self.drop, &self.soft, &self.mask);
        let next_drop: &mut [f32] = match &mut self.next.1 {
            Some(raster) => &mut raster.data,
            // A raster that nobody reads needs no second one; this stands in for it.
            None => &mut [],
        };
        let height = self.grid.height;
        let body = |y: usize, (z_out, drop_out, change, loose): Out| {
            let rows = [0, 1, 2].map(|k| Rows {
                z: z.row(y + k),
                drop: row_of(drop, y + k),
                soft: row_of(soft, y + k),
                mask: row_of(mask, y + k),
            });
            match terms.coast {
                Some(_) => row::<DROP, RATE, true>(&rows, terms, &start[y * width..], z_out, drop_out, change, loose),
                None => row::<DROP, RATE, false>(&rows, terms, &start[y * width..], z_out, drop_out, change, loose),
            }
        };
        let outs = self.next.0.data.par_chunks_exact_mut(stride).skip(1).take(height);
        let own = (change.par_chunks_exact_mut(width), self.loose.par_chunks_mut(width.max(1)));
        if DROP {
            (outs, next_drop.par_chunks_exact_mut(stride).skip(1).take(height), own.0, own.1)
                .into_par_iter()
                .enumerate()
                .for_each(|(y, (z, drop, change, loose))| {
                    body(y, (&mut z[1..=width], &mut drop[1..=width], change, loose));
                });
        } else {
            (outs, own.0).into_par_iter().enumerate().for_each(|(y, (z, change))| {
                body(y, (&mut z[1..=width], &mut [], change, &mut []));
            });
        }
    }
}

/// A row of a raster; nothing where there is none.
pub(super) fn row_of(raster: &Option<Raster>, y: usize) -> &[f32] {
    raster.as_ref().map_or(&[], |raster| raster.row(y))
}

/// A row and its rim, as it is before a pass.
struct Rows<'a> {
    z: &'a [f32],
    drop: &'a [f32],
    soft: &'a [f32],
    mask: &'a [f32],
}

/// A row as a pass leaves it, without its rim: heights, drops, change and loose ground. Single slices, not a struct of
/// them: the compiler then knows that none of them overlap, and uses wide registers.
pub(super) type Out<'a> = (&'a mut [f32], &'a mut [f32], &'a mut [f32], &'a mut [f32]);

/// One end of a face.
#[derive(Clone, Copy)]
struct Cell {
    z: f32,
    drop: f32,
    share: f32,
    mask: f32,
}

/// What a cell gives to a neighbour and takes from it, m.
#[inline(always)]
fn face<const LOCKED: bool, const DIAGONALLY: bool>(terms: &Terms, here: Cell, there: Cell) -> (f32, f32) {
    let (apart, per) = if DIAGONALLY { (std::f32::consts::SQRT_2, DIAGONAL) } else { (1.0, 1.0) };
    let fall = here.z - there.z;
    // Nothing leaves a mask, nor comes in.
    let open = here.mask.min(there.mask);
    let give = here.share * open * per * (fall - apart * here.drop).max(0.0);
    let take = there.share * open * per * (-fall - apart * there.drop).max(0.0);
    match LOCKED {
        true => (terms.whole(terms.keep(give, here.z, there.z)), terms.whole(terms.keep(take, there.z, here.z))),
        false => (terms.whole(give), terms.whole(take)),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn row<const DROP: bool, const RATE: bool, const LOCKED: bool>(
    rows: &[Rows; 3],
    terms: &Terms,
    start: &[f32],
    next_z: &mut [f32],
    next_drop: &mut [f32],
    change: &mut [f32],
    loose: &mut [f32],
) {
    let n = next_z.len();
    let z: [&[f32]; 3] = [&rows[0].z[..n + 2], &rows[1].z[..n + 2], &rows[2].z[..n + 2]];
    // Rows of known length need no check in the loop.
    let drop: [&[f32]; 3] = [0, 1, 2].map(|k| &rows[k].drop[..if DROP { n + 2 } else { 0 }]);
    let soft: [&[f32]; 3] = [0, 1, 2].map(|k| &rows[k].soft[..if RATE { n + 2 } else { 0 }]);
    let mask: [&[f32]; 3] = [0, 1, 2].map(|k| &rows[k].mask[..if RATE { n + 2 } else { 0 }]);
    let (start, next_z, change) = (&start[..n], &mut next_z[..n], &mut change[..n]);
    let own = if DROP { n } else { 0 };
    let (next_drop, loose) = (&mut next_drop[..own], &mut loose[..own]);
    for x in 0..n {
        let at = |k: usize, x: usize| Cell {
            z: z[k][x],
            drop: if DROP { drop[k][x] } else { terms.drop_m[0] },
            share: if RATE { terms.share * soft[k][x] } else { terms.share },
            mask: if RATE { mask[k][x] } else { 1.0 },
        };
        let here = at(1, x + 1);
        let faces = [
            face::<LOCKED, true>(terms, here, at(0, x)),
            face::<LOCKED, false>(terms, here, at(0, x + 1)),
            face::<LOCKED, true>(terms, here, at(0, x + 2)),
            face::<LOCKED, false>(terms, here, at(1, x)),
            face::<LOCKED, false>(terms, here, at(1, x + 2)),
            face::<LOCKED, true>(terms, here, at(2, x)),
            face::<LOCKED, false>(terms, here, at(2, x + 1)),
            face::<LOCKED, true>(terms, here, at(2, x + 2)),
        ];
        let (mut given, mut taken) = (0.0f32, 0.0f32);
        for (give, take) in faces {
            (given, taken) = (given + give, taken + take);
        }
        let gained = taken - given;
        change[x] += gained;
        next_z[x] = start[x] + change[x];
        if DROP {
            loose[x] = (loose[x] - given).max(0.0) + taken;
            next_drop[x] = terms.standing(loose[x]);
        }
    }
}
