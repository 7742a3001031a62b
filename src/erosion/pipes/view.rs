//! What there is to look at while water runs.

use crate::grid::{Edges, for_each_row, map_cells};

use super::super::bed::Bed;
use super::{
    family::Pipes,
    rules::{FROUDE, GRAVITY, SHEET_M},
};

/// Fastest that water of a depth is taken to be, m/s: what left a cell in a step says nothing of the little that stayed.
fn swiftest(depth: f32) -> f32 {
    FROUDE * (GRAVITY * depth.max(SHEET_M)).sqrt()
}

impl Pipes {
    /// Depth of the water on land, m; none in the sea.
    pub fn water_m(&self, bed: &Bed) -> Vec<f32> {
        let sea = self.sea_m();
        let (width, mut water) = (self.grid().width, vec![0.0; self.depth.len()]);
        map_cells(&mut water, width, |x, y| {
            let i = y * width + x;
            if bed.height(i) < sea { 0.0 } else { self.depth[i] }
        });
        water
    }

    /// Velocity to the east (axis 0) or south (axis 1), m/s.
    pub fn velocity(&self, axis: usize) -> Vec<f32> {
        self.over_cells(|here, depth| {
            let most = swiftest(depth);
            let all = (here[0] * here[0] + here[1] * here[1]).sqrt();
            if all > most * depth.max(SHEET_M) { most * here[axis] / all } else { here[axis] / depth.max(SHEET_M) }
        })
    }

    /// Speed, m/s.
    pub fn speed(&self) -> Vec<f32> {
        self.over_cells(|[u, v], depth| ((u * u + v * v).sqrt() / depth.max(SHEET_M)).min(swiftest(depth)))
    }

    /// Water that passes a cell, m³/s.
    pub fn discharge(&self) -> Vec<f32> {
        let side = self.grid().cell_m as f32;
        self.over_cells(|[u, v], _| (u * u + v * v).sqrt() * side)
    }

    /// Rock that the water carries, m.
    pub fn suspended_m(&self) -> &[f32] {
        &self.load
    }

    /// `f` of the fluxes through the middle of a cell, m²/s, and its depth.
    fn over_cells(&self, f: impl Fn([f32; 2], f32) -> f32 + Sync) -> Vec<f32> {
        let grid = *self.grid();
        let mut out = vec![0.0; grid.cells()];
        let net = |axis: usize, i: usize| self.flux[axis][i] - self.back(axis).get(i).copied().unwrap_or(0.0);
        for_each_row(&mut out, grid.width, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                let i = grid.index(x, y);
                let mean = |axis: usize, at: usize, size: usize, next: usize| {
                    let near = net(axis, i);
                    // Beyond the last row and column flows what comes to them.
                    if at + 1 == size && grid.edges != Edges::Wrap { near } else { 0.5 * (near + net(axis, next)) }
                };
                let east = grid.index(grid.column(x, 1), y);
                let south = grid.index(x, grid.row(y, 1));
                *out = f([mean(0, x, grid.width, east), mean(1, y, grid.height, south)], self.depth[i]);
            }
        });
        out
    }
}
