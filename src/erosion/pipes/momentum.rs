//! Momentum that water carries along (Stelling and Duinmeijer 2003), in the form that speaks of the speed `u` of a face:
//! `∂u/∂t = −(∇·(q̄u) − u∇·q̄)/d̄`, upwind, along the flux and across it. With `q̄` the mean flux through the cells and
//! corners around a face and `d̄` the mean depth of its cells, a face's new speed is a mean of old ones: no new extrema.

use crate::grid::{Edges, for_each_row};

use super::{
    flow::{Sides, hi, lo},
    rules::{Beat, PIPE_M, Rules},
};

/// Water on the map before a step.
#[derive(Clone, Copy)]
pub struct Water<'a> {
    pub start: &'a [f32],
    pub change: &'a [f32],
    pub depth: &'a [f32],
    /// Depth a step ago, which the fluxes went with.
    pub past: &'a [f32],
    /// Signed fluxes at the west and north faces of cells.
    pub flux: [&'a [f32]; 2],
}

/// The map's faces, for any place of a raster that may wrap.
struct Faces<'a> {
    rules: &'a Rules,
    beat: &'a Beat,
    old: Water<'a>,
}

impl Faces<'_> {
    /// The cell at a place, if there is one.
    #[inline]
    fn cell(&self, x: isize, y: isize) -> Option<usize> {
        let (w, h) = (self.rules.width as isize, self.rules.height as isize);
        if self.rules.edges == Edges::Wrap {
            Some((y.rem_euclid(h) * w + x.rem_euclid(w)) as usize)
        } else {
            ((0..w).contains(&x) && (0..h).contains(&y)).then_some((y * w + x) as usize)
        }
    }

    /// Depth at the west (axis 0) or north (axis 1) face of a cell.
    #[inline]
    fn deep(&self, depth: &[f32], one: usize, two: usize) -> f32 {
        let old = self.old;
        let (start, depth) = ([old.start[one], old.start[two]], [depth[one], depth[two]]);
        let wet = [old.change[one] + depth[0], old.change[two] + depth[1]];
        fn sides(pair: &[f32; 2]) -> [&[f32]; 2] {
            [&pair[..1], &pair[1..]]
        }
        let face =
            Sides { start: sides(&start), wet: sides(&wet), depth: sides(&depth), land: sides(&wet), sea: false };
        face.fall(0).1
    }

    /// The cells at the two sides of a face, if it is not on the rim.
    #[inline]
    fn sides(&self, axis: usize, x: isize, y: isize) -> Option<[usize; 2]> {
        let [dx, dy] = [[1, 0], [0, 1]][axis];
        Some([self.cell(x - dx, y - dy)?, self.cell(x, y)?])
    }

    /// Flux over a face; none over the rim.
    #[inline]
    fn flux(&self, axis: usize, x: isize, y: isize) -> f32 {
        self.sides(axis, x, y).map_or(0.0, |[_, two]| self.old.flux[axis][two])
    }

    /// Speed at a face; beyond the rim that of `here`.
    #[inline]
    fn speed(&self, axis: usize, x: isize, y: isize, here: f32) -> f32 {
        let Some([one, two]) = self.sides(axis, x, y) else { return here };
        let u = self.old.flux[axis][two] / self.deep(self.old.past, one, two);
        hi(lo(u, self.beat.fastest), -self.beat.fastest)
    }

    /// The flux over a face with the momentum that came to it.
    fn carried(&self, axis: usize, x: isize, y: isize) -> f32 {
        let Some([one, two]) = self.sides(axis, x, y) else { return 0.0 };
        let [dx, dy] = [[1, 0], [0, 1]][axis];
        let u = self.speed(axis, x, y, 0.0);
        let here = self.flux(axis, x, y);
        // What comes to a face: from the two along the flux, and over its two corners.
        let behind = hi(0.5 * (self.flux(axis, x - dx, y - dy) + here), 0.0);
        let before = hi(-0.5 * (here + self.flux(axis, x + dx, y + dy)), 0.0);
        let beside = |x: isize, y: isize| 0.5 * (self.flux(1 - axis, x - dx, y - dy) + self.flux(1 - axis, x, y));
        let (near, far) = (hi(beside(x, y), 0.0), hi(-beside(x + dy, y + dx), 0.0));
        let comes = (behind + before) + (near + far);
        if comes == 0.0 {
            return u * self.deep(self.old.depth, one, two);
        }
        let along =
            behind * (self.speed(axis, x - dx, y - dy, u) - u) + before * (self.speed(axis, x + dx, y + dy, u) - u);
        let across = near * (self.speed(axis, x - dy, y - dx, u) - u) + far * (self.speed(axis, x + dy, y + dx, u) - u);
        let mean = hi(0.5 * (self.old.depth[one] + self.old.depth[two]), PIPE_M);
        // At most all of the water at a face is exchanged.
        let share = lo(self.beat.pace / mean, 1.0 / comes);
        (u + share * (along + across)) * self.deep(self.old.depth, one, two)
    }
}

/// Writes the fluxes with the momentum of a step, along `axis`.
pub fn carry(rules: &Rules, beat: &Beat, old: Water, axis: usize, out: &mut [f32]) {
    let faces = Faces { rules, beat, old };
    for_each_row(out, rules.width, |y, row| {
        for (x, out) in row.iter_mut().enumerate() {
            *out = faces.carried(axis, x as isize, y as isize);
        }
    });
}
