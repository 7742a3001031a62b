//! The thesis's own rules, to compare with: solid plates in a box shaken in pairs of sides; each collision that begins with
//! a two-point contact raises the Voronoi cells its segment crosses by one constant step, once.
//!
//! No crust, no warp, no overlap: heights start flat and straight borders show. Plates of the warm-up step, which touch from
//! the start, raise nothing.

use crate::{
    grid::{Field, Grid},
    noise::Key,
    rmp::{self, Brush},
};

use super::{engine::Engine, params::PlatesParams};

/// Engine steps in one step of the stage: about an engine second.
pub const ENGINE_STEPS: u64 = 30;

/// A run under the thesis's rules.
pub struct Thesis {
    /// The bodies.
    pub engine: Engine,
    /// Heights raised so far, m.
    pub height: Field<f32>,
    /// Plate of every map cell when the run began.
    pub owners: Vec<u8>,
    /// Collisions so far.
    pub collisions: u64,
    step_m: f64,
    sites_per_m2: f64,
    steps: u64,
    in_all: u64,
    step: u64,
    key: Key,
}

impl Thesis {
    /// A run ready for its first step; its warm-up is done.
    pub fn new(mut engine: Engine, owners: Vec<u8>, map: Grid, params: &PlatesParams, key: Key) -> Self {
        engine.step(|_, _| Default::default());
        engine.take_begun();
        let [w, h] = map.extent_m();
        let in_all = engine.fit(params.duration_myr * 1e6);
        let steps = in_all.div_ceil(ENGINE_STEPS);
        Self {
            engine,
            height: Field::filled(map, 0.0),
            owners,
            collisions: 0,
            step_m: params.thesis_step_m,
            sites_per_m2: params.thesis_sites as f64 / (w * h),
            steps,
            in_all,
            step: 0,
            key: key.named("thesis"),
        }
    }

    /// Steps in all, and taken.
    pub fn progress(&self) -> (u64, u64) {
        (self.steps, self.step)
    }

    /// One second of shaking.
    pub fn advance(&mut self) {
        let mut brush = Brush::new();
        for _ in 0..ENGINE_STEPS.min(self.in_all - self.step * ENGINE_STEPS) {
            self.engine.step(|_, _| Default::default());
            for ends in self.engine.take_begun() {
                let path = ends.map(Into::into);
                let cells = rmp::cells_along(&path, self.sites_per_m2, self.key.with(self.collisions));
                let grid = self.height.grid;
                for cell in cells {
                    let outline: Vec<[f64; 2]> = cell.outline.iter().map(|v| v.map(|v| v / grid.cell_m)).collect();
                    let step_m = self.step_m;
                    brush.cover(&outline, grid.width, grid.height, |x, y, coverage| {
                        self.height.data[y * grid.width + x] += (step_m * coverage as f64) as f32;
                    });
                }
                self.collisions += 1;
            }
        }
        self.step += 1;
    }
}
