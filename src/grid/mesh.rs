//! Heights as a surface to stand on: a mesh of triangles on the cell centres, read in single precision.

use std::hint::select_unpredictable;

use super::{Edges, Grid, for_each_row};

/// The surface at a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Spot {
    height: f32,
    slope: [f32; 2],
}

/// Heights over a grid as triangles.
#[derive(Clone, Debug)]
pub struct Mesh {
    grid: Grid,
    per_cell: f32,
    cell_m: f32,
    spots: Vec<Spot>,
    /// When each slope was last read anew, in renewals.
    renewed: Vec<u32>,
    renewals: u32,
}

/// The surface under a place.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// Height of the triangle, m.
    pub height: f32,
    /// Upward normal of the triangle.
    pub face: [f32; 3],
    /// Upward normal, bilinear between the cell centres and normalised: it does not jump from triangle to triangle.
    pub normal: [f32; 3],
}

impl Foot {
    /// Distance from the plane of the triangle, m.
    #[inline(always)]
    pub fn gap(&self, z: f32) -> f32 {
        (z - self.height) * self.face[2]
    }

    /// Sine of the slope.
    pub fn sine(&self) -> f32 {
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

impl Mesh {
    /// The surface through heights at the cell centres, m, given cell by cell. Count them from near what matters, so that `f32`
    /// resolves a film high up.
    pub fn new(grid: Grid, height: impl Fn(usize) -> f32 + Sync + Send) -> Self {
        let (cell_m, per_cell) = (grid.cell_m as f32, (1.0 / grid.cell_m) as f32);
        let (spots, renewed) = (vec![Spot::default(); grid.cells()], vec![0; grid.cells()]);
        let mut mesh = Self { grid, per_cell, cell_m, spots, renewed, renewals: 0 };
        for_each_row(&mut mesh.spots, grid.width, |y, row| {
            for (x, spot) in row.iter_mut().enumerate() {
                spot.height = height(y * grid.width + x);
            }
        });
        let slopes = {
            let mesh = &mesh;
            let mut slopes = vec![[0.0; 2]; grid.cells()];
            for_each_row(&mut slopes, grid.width, |y, row| {
                for (x, slope) in row.iter_mut().enumerate() {
                    *slope = mesh.slope_of(x, y);
                }
            });
            slopes
        };
        for (spot, slope) in mesh.spots.iter_mut().zip(slopes) {
            spot.slope = slope;
        }
        mesh
    }

    /// Reads the heights of some cells anew, and the slopes there and beside.
    pub fn renew(&mut self, cells: &[u32], height: impl Fn(usize) -> f32) {
        for &i in cells {
            self.spots[i as usize].height = height(i as usize);
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

    /// Height of a cell, m.
    pub fn height(&self, i: usize) -> f32 {
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

    /// The raster.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The cell that holds a place; `None` beyond the rim.
    pub fn holder(&self, x: f32, y: f32) -> Option<usize> {
        let (cx, cy) = (split(x * self.per_cell).0, split(y * self.per_cell).0);
        let inside = cx >= 0 && cy >= 0 && (cx as usize) < self.grid.width && (cy as usize) < self.grid.height;
        inside.then(|| cy as usize * self.grid.width + cx as usize)
    }

    /// The surface under a place.
    #[inline(always)]
    pub fn foot(&self, x: f32, y: f32) -> Foot {
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
