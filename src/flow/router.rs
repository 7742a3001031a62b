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
    /// One over what a diagonal step counts as, in cells: a row that holds for all rows, or a value for each cell.
    corner: Vec<f64>,
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
            corner: vec![std::f64::consts::FRAC_1_SQRT_2; grid.width],
            donors: vec![0; grid.cells()],
            strip_cells: (STRIP_ROWS * grid.width).max(1),
            strips: (0..strips).map(|_| Strip::default()).collect(),
            trunk: Vec::new(),
            spill: Spill::default(),
        }
    }

    /// The same, with a chance among the eight ways that makes them fair: where a diagonal step counts as `2 - u` cells, with
    /// `u` of each cell uniform from 0 to 1, water on a plane runs down the plane on the mean, whichever way that faces, and
    /// neighbours meet that would run side by side (Rho8; Fairfield and Leymarie 1991). `chance` gives `u` by cell, and
    /// holds for as long as the router does, so that valleys can settle.
    pub fn fair(grid: Grid, chance: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        let mut corner = vec![0.0; grid.cells()];
        for_each_row(&mut corner, grid.width, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, corner)| *corner = 1.0 / (2.0 - chance(x, y)));
        });
        Self { corner, ..Self::new(grid) }
    }

    /// Routes a surface to its outlets, of which there has to be one: each cell to the neighbour that lies steepest
    /// below it, out of a depression by its lowest pass. Ties go to the neighbour that comes first in [`STEPS`].
    pub fn route(&mut self, height_m: &[f64], outlet: &[bool]) {
        let (compass, corner) = (self.compass, &self.corner);
        let width = compass.grid.width;
        for_each_row(&mut self.way, width, |y, row| {
            let corner = if corner.len() == width { corner } else { &corner[y * width..][..width] };
            find_ways(&compass, [height_m, corner], outlet, y, row);
        });
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

fn find_ways(compass: &Compass, [height_m, corner]: [&[f64]; 2], outlet: &[bool], y: usize, out: &mut [u8]) {
    let width = compass.grid.width;
    let at_rim = |x: usize| {
        let i = y * width + x;
        let around = compass.around(i).map(|(way, j)| (way, height_m[j]));
        steepest(height_m[i], corner[x], around)
    };
    match rows_beside(compass.grid, height_m, y) {
        Some((north, row, south)) if width > 2 => {
            find_ways_inside([north, row, south], corner, out);
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
fn find_ways_inside(rows: [&[f64]; 3], corner: &[f64], out: &mut [u8]) {
    let inside = out.len() - 2;
    let corner = &corner[1..][..inside];
    let around = STEPS.map(|(dx, dy)| &rows[(1 + dy) as usize][(1 + dx) as usize..][..inside]);
    for (x, (out, &z)) in out[1..][..inside].iter_mut().zip(&rows[1][1..]).enumerate() {
        *out = steepest(z, corner[x], (0..8u8).zip(around.map(|row| row[x])));
    }
}

/// The way of the steepest drop; `corner` is one over what a diagonal step counts as, in cells.
#[inline(always)]
fn steepest(z: f64, corner: f64, around: impl Iterator<Item = (u8, f64)>) -> u8 {
    // As wide as the heights, so that the loops over cells become loops over vectors.
    let (mut steepest, mut way) = (0.0, PIT as u64);
    for (step, below) in around {
        let drop = if LENGTHS[step as usize] == 1.0 { z - below } else { (z - below) * corner };
        // Written as two selections, which need no jump.
        way = if drop > steepest { step as u64 } else { way };
        steepest = if drop > steepest { drop } else { steepest };
    }
    way as u8
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_a_chance_water_runs_down_a_plane_whichever_way_it_faces() {
        let grid = Grid { width: 400, height: 400, cell_m: 10.0, edges: Edges::Open };
        // A hash of the place, uniform from 0 to 1.
        let chance = |x: usize, y: usize| {
            let h = (x as u64 * 0x9E37_79B9_7F4A_7C15) ^ (y as u64 * 0xC2B2_AE3D_27D4_EB4F);
            let h = (h ^ h >> 31).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            (h >> 11) as f64 / (1u64 << 53) as f64
        };
        let rim = |i: usize| {
            let (x, y) = grid.cell_of(i);
            x == 0 || y == 0 || x == 399 || y == 399
        };
        let outlet: Vec<bool> = (0..grid.cells()).map(rim).collect();
        for tilt in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let plane: Vec<f64> =
                (0..grid.cells()).map(|i| grid.cell_of(i)).map(|(x, y)| 1e4 - (x as f64 + tilt * y as f64)).collect();
            let steps = 200;
            // How far south water comes that goes so many cells east, from several places: a line of fall comes `tilt` a step.
            let south = |router: &mut Router| -> Vec<f64> {
                router.route(&plane, &outlet);
                let run = |begin: usize| (0..steps).fold(begin, |i, _| router.receiver(i));
                (0..19).map(|k| (run(grid.index(5, 5 + 10 * k)) / 400) as f64 - (5 + 10 * k) as f64).collect()
            };
            let fair = south(&mut Router::fair(grid, chance));
            let mean = fair.iter().sum::<f64>() / fair.len() as f64;
            // A sum of independent choices, five standard deviations; what has met goes on together.
            let spread = (steps as f64 * tilt * (1.0 - tilt)).sqrt();
            assert!((mean - tilt * steps as f64).abs() <= 5.0 * spread, "{tilt}: {mean}");
            if tilt == 0.2 {
                // The eight ways alone follow the axis.
                assert!(south(&mut Router::new(grid)).iter().all(|&south| south == 0.0));
            }
        }
    }
}
