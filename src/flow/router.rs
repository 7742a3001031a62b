//! Routing made for many steps over one raster: ways, order, and passes up and down the forest, with buffers kept.
//!
//! The map is cut into strips of rows. A cell whose whole catchment lies in its strip is visited with the strip, all
//! strips in parallel; the others, the trunks, one after another: after the strips on the way down, before them on the
//! way up. The cut depends on the raster alone, so sums have one order on any number of threads.

use std::ops::AddAssign;

use multiversion::multiversion;
use rayon::prelude::*;

use super::{
    compass::{Compass, LENGTHS, STEPS, opposite},
    spill::Spill,
};
use crate::grid::{Edges, Grid, for_each_row};

/// The way of a cell where water leaves.
pub const ROOT: u8 = 8;
/// The way, until it spills, of a cell without a lower neighbour.
pub(super) const PIT: u8 = 9;
/// Marks a cell that has been put in order. Eight donors look the same; nobody asks but for none.
const PLACED: u8 = u8::MAX;
/// Rows of a strip. Wider strips leave fewer trunks, more of them use more cores.
const STRIP_ROWS: usize = 64;

/// One strip's part of the order.
#[derive(Default)]
struct Strip {
    /// Cells whose catchment lies in the strip, each after its donors.
    order: Vec<u32>,
    /// Those of them whose receiver lies in another strip, in that order.
    leaving: Vec<u32>,
}

/// Routes surfaces over one raster.
pub struct Router {
    compass: Compass,
    way: Vec<u8>,
    /// The steps to each cell's donors, a bit for each; in [`Router::put_in_order`], to those that have yet to give.
    donors: Vec<u8>,
    strip_cells: usize,
    strips: Vec<Strip>,
    /// Cells with a donor from another strip, or downstream of one; each after its donors.
    trunk: Vec<u32>,
    spill: Spill,
}

impl Router {
    /// A router for surfaces over `grid`.
    pub fn new(grid: Grid) -> Self {
        let strips = grid.height.div_ceil(STRIP_ROWS).max(1);
        Self {
            compass: Compass::new(grid),
            way: vec![ROOT; grid.cells()],
            donors: vec![0; grid.cells()],
            strip_cells: (STRIP_ROWS * grid.width).max(1),
            strips: (0..strips).map(|_| Strip::default()).collect(),
            trunk: Vec::new(),
            spill: Spill::default(),
        }
    }

    /// Routes a surface to its outlets, of which there has to be one: each cell to the neighbour that lies steepest
    /// below it, out of a depression by its lowest pass. Ties go to the neighbour that comes first in [`STEPS`].
    pub fn route(&mut self, height_m: &[f64], outlet: &[bool]) {
        let compass = self.compass;
        for_each_row(&mut self.way, compass.grid.width, |y, row| find_ways(&compass, height_m, outlet, y, row));
        let way = &self.way;
        for_each_row(&mut self.donors, compass.grid.width, |y, row| find_donors(&compass, way, y, row));
        self.spill.drain(height_m, Forest { compass, way: &mut self.way, donors: &mut self.donors });
        self.put_in_order();
    }

    /// Moves over the raster.
    pub fn compass(&self) -> &Compass {
        &self.compass
    }

    /// The raster.
    pub fn grid(&self) -> Grid {
        self.compass.grid
    }

    /// Each cell's way to its receiver, a place in [`STEPS`], or [`ROOT`].
    pub fn ways(&self) -> &[u8] {
        &self.way
    }

    /// The cell that `i` drains to; itself at an outlet.
    #[inline]
    pub fn receiver(&self, i: usize) -> usize {
        if self.way[i] == ROOT { i } else { self.compass.to(i, self.way[i]) }
    }

    /// Cells below the spill point of their depression, by their index, each with that level, m; of the surface last routed.
    pub fn flooded(&self, height_m: &[f64]) -> Vec<(usize, f64)> {
        self.spill.flooded(height_m)
    }

    /// All cells, each after its receiver.
    pub fn upward(&self) -> impl Iterator<Item = u32> + '_ {
        let strips = self.strips.iter().flat_map(|strip| strip.order.iter().rev());
        self.trunk.iter().rev().chain(strips).copied()
    }

    /// From the sources down: `give` tells what a cell hands to its receiver, once all above it have given; it may
    /// change what the cell keeps. Outlets keep all.
    pub fn descend<T: Copy + Send + AddAssign>(&self, value: &mut [T], give: impl Fn(usize, &mut T) -> T + Sync) {
        let parts = self.strips.par_iter().zip(value.par_chunks_mut(self.strip_cells)).enumerate();
        let carried: Vec<Vec<T>> = parts
            .map(|(s, (strip, own))| {
                let begin = s * self.strip_cells;
                let mut carried = Vec::with_capacity(strip.leaving.len());
                for i in strip.order.iter().map(|&i| i as usize).filter(|&i| self.way[i] != ROOT) {
                    let given = give(i, &mut own[i - begin]);
                    match own.get_mut(self.compass.to(i, self.way[i]).wrapping_sub(begin)) {
                        Some(received) => *received += given,
                        None => carried.push(given),
                    }
                }
                carried
            })
            .collect();
        for (strip, carried) in self.strips.iter().zip(carried) {
            for (&i, given) in strip.leaving.iter().zip(carried) {
                value[self.receiver(i as usize)] += given;
            }
        }
        for i in self.trunk.iter().map(|&i| i as usize).filter(|&i| self.way[i] != ROOT) {
            let given = give(i, &mut value[i]);
            value[self.compass.to(i, self.way[i])] += given;
        }
    }

    /// From the outlets up: each cell's value becomes `f(cell, its value, its receiver's new value)`. Outlets keep theirs.
    pub fn climb(&self, value: &mut [f64], f: impl Fn(usize, f64, f64) -> f64 + Sync) {
        for i in self.trunk.iter().rev().map(|&i| i as usize).filter(|&i| self.way[i] != ROOT) {
            value[i] = f(i, value[i], value[self.compass.to(i, self.way[i])]);
        }
        let below: Vec<Vec<f64>> = self
            .strips
            .iter()
            .map(|strip| strip.leaving.iter().map(|&i| value[self.receiver(i as usize)]).collect())
            .collect();
        let parts = self.strips.par_iter().zip(below).zip(value.par_chunks_mut(self.strip_cells)).enumerate();
        parts.for_each(|(s, ((strip, below), own))| {
            let (begin, mut below) = (s * self.strip_cells, below.into_iter().rev());
            for i in strip.order.iter().rev().map(|&i| i as usize).filter(|&i| self.way[i] != ROOT) {
                let receiver = own.get(self.compass.to(i, self.way[i]).wrapping_sub(begin)).copied();
                // One that is not in the strip is the next of those that were noted.
                if let Some(receiver) = receiver.or_else(|| below.next()) {
                    own[i - begin] = f(i, own[i - begin], receiver);
                }
            }
        });
    }

    fn put_in_order(&mut self) {
        let (compass, way, strip_cells) = (self.compass, &self.way, self.strip_cells);
        let parts = self.strips.par_iter_mut().zip(self.donors.par_chunks_mut(strip_cells)).enumerate();
        parts.for_each(|(s, (strip, donors))| strip.fill(&compass, way, donors, s * strip_cells));
        self.trunk.clear();
        for strip in &self.strips {
            for &i in &strip.leaving {
                let mut from = i as usize;
                loop {
                    let c = compass.to(from, way[from]);
                    self.donors[c] &= !donor_bit(way[from]);
                    if self.donors[c] != 0 {
                        break;
                    }
                    self.donors[c] = PLACED;
                    self.trunk.push(c as u32);
                    if way[c] == ROOT {
                        break;
                    }
                    from = c;
                }
            }
        }
    }
}

impl Strip {
    /// Follows the water from every source as long as nothing else has yet to arrive.
    fn fill(&mut self, compass: &Compass, way: &[u8], donors: &mut [u8], begin: usize) {
        self.order.clear();
        self.leaving.clear();
        for source in 0..donors.len() {
            let mut c = source;
            while donors[c] == 0 {
                donors[c] = PLACED;
                let i = begin + c;
                self.order.push(i as u32);
                if way[i] == ROOT {
                    break;
                }
                let r = compass.to(i, way[i]).wrapping_sub(begin);
                if r >= donors.len() {
                    self.leaving.push(i as u32);
                    break;
                }
                donors[r] &= !donor_bit(way[i]);
                c = r;
            }
        }
    }
}

/// The rows above and below, where there are any.
fn rows_beside<T>(grid: Grid, data: &[T], y: usize) -> Option<(&[T], &[T], &[T])> {
    let row = |y: usize| &data[y * grid.width..][..grid.width];
    let inside = grid.edges == Edges::Wrap || (y > 0 && y + 1 < grid.height);
    inside.then(|| (row(grid.row(y, -1)), row(y), row(grid.row(y, 1))))
}

fn find_ways(compass: &Compass, height_m: &[f64], outlet: &[bool], y: usize, out: &mut [u8]) {
    let width = compass.grid.width;
    let at_rim = |x: usize| {
        let i = y * width + x;
        let around = compass.around(i).map(|(way, j)| (way, height_m[j]));
        steepest(height_m[i], around)
    };
    match rows_beside(compass.grid, height_m, y) {
        Some((north, row, south)) if width > 2 => {
            find_ways_inside([north, row, south], out);
            out[0] = at_rim(0);
            out[width - 1] = at_rim(width - 1);
        }
        _ => (0..width).for_each(|x| out[x] = at_rim(x)),
    }
    for (way, &is_outlet) in out.iter_mut().zip(&outlet[y * width..]) {
        *way = if is_outlet { ROOT } else { *way };
    }
}

/// The ways of a row but for its ends; the rows are the one to the north, its own, and the one to the south.
#[multiversion(targets("x86_64+avx2"))]
fn find_ways_inside(rows: [&[f64]; 3], out: &mut [u8]) {
    let inside = out.len() - 2;
    let around = STEPS.map(|(dx, dy)| &rows[(1 + dy) as usize][(1 + dx) as usize..][..inside]);
    for (x, (out, &z)) in out[1..][..inside].iter_mut().zip(&rows[1][1..]).enumerate() {
        *out = steepest(z, (0..8u8).zip(around.map(|row| row[x])));
    }
}

/// The way of the steepest drop.
#[inline(always)]
fn steepest(z: f64, around: impl Iterator<Item = (u8, f64)>) -> u8 {
    // As wide as the heights, so that the loops over cells become loops over vectors.
    let (mut steepest, mut way) = (0.0, PIT as u64);
    for (step, below) in around {
        let drop = (z - below) * CLOSENESS[step as usize];
        // Written as two selections, which need no jump.
        way = if drop > steepest { step as u64 } else { way };
        steepest = if drop > steepest { drop } else { steepest };
    }
    way as u8
}

/// One over each of [`LENGTHS`].
const CLOSENESS: [f64; 8] = {
    let mut closeness = [1.0; 8];
    let mut way = 0;
    while way < 8 {
        closeness[way] = 1.0 / LENGTHS[way];
        way += 1;
    }
    closeness
};

/// The bit that a receiver has for a donor whose way is `way`.
fn donor_bit(way: u8) -> u8 {
    1 << opposite(way)
}

fn find_donors(compass: &Compass, way: &[u8], y: usize, out: &mut [u8]) {
    let width = compass.grid.width;
    let at_rim = |x: usize| {
        let around = compass.around(y * width + x).filter(|&(step, j)| way[j] == opposite(step));
        around.fold(0, |donors, (step, _)| donors | 1 << step)
    };
    match rows_beside(compass.grid, way, y) {
        Some((north, row, south)) if width > 2 => {
            out.fill(0);
            for (step, &(dx, dy)) in STEPS.iter().enumerate() {
                let from = [north, row, south][(dy + 1) as usize];
                let from = &from[(1 + dx) as usize..][..width - 2];
                for (donors, &w) in out[1..width - 1].iter_mut().zip(from) {
                    *donors |= u8::from(w == opposite(step as u8)) << step;
                }
            }
            out[0] = at_rim(0);
            out[width - 1] = at_rim(width - 1);
        }
        _ => (0..width).for_each(|x| out[x] = at_rim(x)),
    }
}

/// Ways, and donors that agree with them.
pub(super) struct Forest<'a> {
    pub(super) compass: Compass,
    pub(super) way: &'a mut [u8],
    donors: &'a mut [u8],
}

impl Forest<'_> {
    /// Gives a cell another way; tells which one it had.
    pub(super) fn lead(&mut self, cell: usize, way: u8) -> u8 {
        let had = std::mem::replace(&mut self.way[cell], way);
        if had < ROOT {
            self.donors[self.compass.to(cell, had)] &= !donor_bit(had);
        }
        self.donors[self.compass.to(cell, way)] |= donor_bit(way);
        had
    }

    /// Calls `f` with each donor of a cell, in the order of [`STEPS`].
    #[inline]
    pub(super) fn each_donor(&self, cell: usize, mut f: impl FnMut(usize)) {
        let mut steps = self.donors[cell];
        while steps != 0 {
            f(self.compass.to(cell, steps.trailing_zeros() as u8));
            steps &= steps - 1;
        }
    }
}
