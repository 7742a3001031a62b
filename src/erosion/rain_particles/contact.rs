//! The ground as water meets it: a mesh of triangles on the cell centres, and what happens to a particle that reaches it.

use std::hint::select_unpredictable;

use crate::grid::{Edges, Grid, for_each_row};

use super::super::bed::Bed;

/// The ground at a cell: height over the datum and slope.
#[derive(Clone, Copy, Debug, Default)]
struct Spot {
    height: f32,
    slope: [f32; 2],
}

/// The ground, ready for particles.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    grid: Grid,
    per_cell: f32,
    cell_m: f32,
    /// Heights are counted from here, so that `f32` resolves a film of water high up, m.
    pub(super) datum_m: f32,
    spots: Vec<Spot>,
    /// When each slope was last read anew, in renewals.
    renewed: Vec<u32>,
    renewals: u32,
}

/// The ground under a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    /// Height of the triangle over the datum, m.
    pub(super) height: f32,
    /// Upward normal of the triangle.
    pub(super) face: [f32; 3],
    /// Upward normal, bilinear between the cell centres and normalised: it does not jump from triangle to triangle.
    pub(super) normal: [f32; 3],
}

impl Foot {
    /// Distance from the plane of the triangle, m.
    #[inline(always)]
    pub(super) fn gap(&self, z: f32) -> f32 {
        (z - self.height) * self.face[2]
    }

    /// Sine of the slope.
    pub(super) fn sine(&self) -> f32 {
        (1.0 - self.normal[2] * self.normal[2]).max(0.0).sqrt()
    }
}

#[inline(always)]
fn normal(slope: [f32; 2]) -> [f32; 3] {
    let up = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
    [-slope[0] * up, -slope[1] * up, up]
}

/// The whole part of a place in cells, and the rest.
#[inline(always)]
fn split(place: f32) -> (i32, f32) {
    let whole = place as i32;
    let whole = if whole as f32 > place { whole.saturating_sub(1) } else { whole };
    (whole, (place - whole as f32).clamp(0.0, 1.0))
}

impl Ground {
    /// The ground of a bed. Heights count from the lowest ground when the stage began.
    pub(super) fn new(bed: &Bed) -> Self {
        let grid = bed.grid;
        let datum_m = bed.start.iter().fold(f32::INFINITY, |a, &b| a.min(b));
        let (cell_m, per_cell) = (grid.cell_m as f32, (1.0 / grid.cell_m) as f32);
        let (spots, renewed) = (vec![Spot::default(); grid.cells()], vec![0; grid.cells()]);
        let mut ground = Self { grid, per_cell, cell_m, datum_m, spots, renewed, renewals: 0 };
        for_each_row(&mut ground.spots, grid.width, |y, row| {
            for (x, spot) in row.iter_mut().enumerate() {
                let i = y * grid.width + x;
                spot.height = (bed.start[i] - datum_m) + bed.change[i];
            }
        });
        let slopes = {
            let ground = &ground;
            let mut slopes = vec![[0.0; 2]; grid.cells()];
            for_each_row(&mut slopes, grid.width, |y, row| {
                for (x, slope) in row.iter_mut().enumerate() {
                    *slope = ground.slope_of(x, y);
                }
            });
            slopes
        };
        for (spot, slope) in ground.spots.iter_mut().zip(slopes) {
            spot.slope = slope;
        }
        ground
    }

    /// Reads the heights of some cells anew, and the slopes there and beside.
    pub(super) fn renew(&mut self, bed: &Bed, cells: &[u32]) {
        for &i in cells {
            self.spots[i as usize].height = (bed.start[i as usize] - self.datum_m) + bed.change[i as usize];
        }
        self.renewals = self.renewals.wrapping_add(1);
        for &i in cells {
            let (x, y) = self.grid.cell_of(i as usize);
            let beside = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)];
            for (x, y) in beside.map(|(dx, dy)| (self.grid.column(x, dx), self.grid.row(y, dy))) {
                let i = y * self.grid.width + x;
                if self.renewed[i] != self.renewals {
                    self.renewed[i] = self.renewals;
                    self.spots[i].slope = self.slope_of(x, y);
                }
            }
        }
    }

    /// Height of a cell over the datum, m.
    pub(super) fn height(&self, i: usize) -> f32 {
        self.spots[i].height
    }

    /// Central differences, one-sided at a rim.
    fn slope_of(&self, x: usize, y: usize) -> [f32; 2] {
        let g = &self.grid;
        let (w, e, n, s) = (g.column(x, -1), g.column(x, 1), g.row(y, -1), g.row(y, 1));
        let rise = |a: usize, b: usize, two: bool| {
            let cells = if two { 2.0 } else { 1.0 };
            (self.spots[b].height - self.spots[a].height) / (cells * self.cell_m)
        };
        let wrap = g.edges == Edges::Wrap;
        let row = y * g.width;
        [
            rise(row + w, row + e, wrap || (x > 0 && x + 1 < g.width)),
            rise(n * g.width + x, s * g.width + x, wrap || (y > 0 && y + 1 < g.height)),
        ]
    }

    /// The two cells on either side of a place, wrapped, or the rim's twice beyond it.
    #[inline(always)]
    fn pair(&self, at: i32, size: usize) -> [usize; 2] {
        if at >= 0 && (at as usize) + 1 < size {
            return [at as usize, at as usize + 1];
        }
        match self.grid.edges {
            Edges::Wrap => [at, at.saturating_add(1)].map(|at| at.rem_euclid(size as i32) as usize),
            Edges::Open | Edges::Closed => [at, at.saturating_add(1)].map(|at| at.clamp(0, size as i32 - 1) as usize),
        }
    }

    /// The cell that holds a place; `None` beyond the rim.
    pub(super) fn holder(&self, x: f32, y: f32) -> Option<usize> {
        let (cx, cy) = (split(x * self.per_cell).0, split(y * self.per_cell).0);
        let inside = cx >= 0 && cy >= 0 && (cx as usize) < self.grid.width && (cy as usize) < self.grid.height;
        inside.then(|| cy as usize * self.grid.width + cx as usize)
    }

    /// The ground under a place.
    #[inline(always)]
    pub(super) fn foot(&self, x: f32, y: f32) -> Foot {
        let ((cx, u), (cy, v)) = (split(x * self.per_cell - 0.5), split(y * self.per_cell - 0.5));
        let ([w, e], [n, s]) = (self.pair(cx, self.grid.width), self.pair(cy, self.grid.height));
        let (north, south) = (n * self.grid.width, s * self.grid.width);
        let [a, b, c, d] = [north + w, north + e, south + w, south + e].map(|i| self.spots[i]);
        // The square is split from its north-east to its south-west corner. Which half it is cannot be guessed: no branch.
        let half = |north_west: f32, south_east: f32| select_unpredictable(u + v < 1.0, north_west, south_east);
        let du = half(b.height, d.height) - half(a.height, c.height);
        let dv = half(c.height, d.height) - half(a.height, b.height);
        let height = half(a.height, d.height) + half(u, u - 1.0) * du + half(v, v - 1.0) * dv;
        let smooth = [0, 1].map(|axis| {
            let north = a.slope[axis] + u * (b.slope[axis] - a.slope[axis]);
            let south = c.slope[axis] + u * (d.slope[axis] - c.slope[axis]);
            north + v * (south - north)
        });
        Foot { height, face: normal([du, dv].map(|rise| rise * self.per_cell)), normal: normal(smooth) }
    }
}

/// How water meets the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Radius of a particle, m.
    pub(super) radius: f32,
    /// Speed off the ground over speed onto it.
    pub(super) restitution: f32,
    /// Speed onto the ground below which nothing bounces, m/s.
    pub(super) calm: f32,
    /// Friction over the thickness of a layer, 1/m.
    pub(super) friction_per_m: f32,
    /// Centres nearer than this feel friction, m.
    pub(super) layer: f32,
}

impl Touch {
    /// Moves a particle from `from` to `to`, stopped by the ground; gives where it is, its velocity and the ground there.
    #[inline(always)]
    pub(super) fn land(
        &self,
        ground: &Ground,
        from: [f32; 3],
        mut to: [f32; 3],
        mut v: [f32; 3],
        dt: f32,
    ) -> ([f32; 3], [f32; 3], Foot) {
        let mut foot = ground.foot(to[0], to[1]);
        let mut gap = foot.gap(to[2]);
        if gap < self.radius {
            // Out along the triangle, by as much as it came nearer, and slowly what is missing then: where the ground bends,
            // a triangle that it was never over may be nearer than a radius at once. Again where that led under the next one.
            let nearer: f32 = (0..3).map(|axis| (from[axis] - to[axis]) * foot.face[axis]).sum();
            let mut most = nearer.max(0.0) + self.calm * dt;
            for _ in 0..3 {
                let out = (self.radius - gap).min(most);
                most -= out;
                for (to, face) in to.iter_mut().zip(foot.face) {
                    *to += out * face;
                }
                foot = ground.foot(to[0], to[1]);
                gap = foot.gap(to[2]);
                if gap >= 0.9 * self.radius || most <= 0.0 {
                    break;
                }
            }
            if gap < 0.0 {
                // A notch or a wall: back to where it was, at rest, and out of ground that may have risen meanwhile.
                foot = ground.foot(from[0], from[1]);
                to = [from[0], from[1], from[2].max(foot.height)];
                v = [0.0; 3];
            }
            let n = foot.normal;
            let onto = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
            if onto < 0.0 {
                let back = if onto < -self.calm { 1.0 + self.restitution } else { 1.0 };
                for axis in 0..3 {
                    v[axis] -= back * onto * n[axis];
                }
            }
        }
        if gap < self.layer {
            // Quadratic friction on what goes along the ground, implicit: it brakes and never turns around.
            let n = foot.normal;
            let off = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
            let along = [0, 1, 2].map(|axis| v[axis] - off * n[axis]);
            let speed = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt();
            let left = 1.0 / (1.0 + self.friction_per_m * speed * dt);
            v = [0, 1, 2].map(|axis| off * n[axis] + left * along[axis]);
        }
        (to, v, foot)
    }
}
