//! Base shapes: land to start from, or to lay over what is there. Fractal noise, warping, terraces, midpoint
//! displacement, faults, and mountains by repeated magnification and probing (RMP).
//!
//! Every stage is one file: its parameters and how they become heights. This module runs them, blends the result into the
//! bedrock and books it. Nothing here moves matter or takes time.
//!
//! All lengths are in metres or kilometres and all random numbers are keyed by place or count, never by the grid: another
//! size refines the land and does not change it. Lengths that are not given follow the map's longer side.

mod diamond_square;
mod fault;
mod fbm;
mod massif;
mod multifractal;
mod rmp_graph;
mod rmp_peak;
mod rmp_ridge;
mod terrace;
mod warp;

pub use diamond_square::DiamondSquareParams;
pub use fault::FaultParams;
pub use fbm::FbmParams;
pub use multifractal::{Form, MultifractalParams};
pub use rmp_graph::RmpGraphParams;
pub use rmp_peak::RmpPeakParams;
pub use rmp_ridge::RmpRidgeParams;
pub use terrace::TerraceParams;
pub use warp::WarpParams;

use crate::{
    grid::{Field, Grid, for_each_row},
    noise::{Octaves, Sampler},
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, World},
};

/// A base shape: parameters that become heights in one go.
pub trait Shape: Send + 'static {
    /// Layers that must be there before.
    const READS: &'static [Layer] = &[];

    /// Whether the parameters go together with a map of this grid.
    fn fit(&self, _grid: &Grid) -> Result<(), ProcessError> {
        Ok(())
    }

    /// The shape's heights over the map, m. `ground` is the bedrock as it stands; only shapes that rework it look at more
    /// than its grid.
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError>;

    /// The process that puts these heights into a world.
    fn process(self, placement: Placement) -> Box<dyn Process>
    where
        Self: Sized,
    {
        Box::new(Shaping { shape: self, placement })
    }
}

struct Shaping<S> {
    shape: S,
    placement: Placement,
}

impl<S: Shape> Process for Shaping<S> {
    fn reads(&self) -> &'static [Layer] {
        S::READS
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.shape.fit(grid)
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let ground = self.placement.over(world)?;
        let heights = self.shape.heights(&ground.base, context)?;
        context.check()?;
        ground.put(&heights, world, context);
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

/// The map's longer side, m.
fn longer_side_m(grid: &Grid) -> f64 {
    let [w, h] = grid.extent_m();
    w.max(h)
}

/// A length given in km, or a share of the map's longer side; m.
fn length_m(given_km: Option<f64>, share: f64, grid: &Grid) -> f64 {
    given_km.map_or(share * longer_side_m(grid), |km| km * 1e3)
}

/// A place given in km, or the middle of the map; m.
fn place_m(given_km: Option<[f64; 2]>, grid: &Grid) -> [f64; 2] {
    let [w, h] = grid.extent_m();
    given_km.map_or([0.5 * w, 0.5 * h], |[x, y]| [x * 1e3, y * 1e3])
}

/// Heights `f(noise, x, y)` at every cell, with a sampler of `sum` for each row.
fn sampled(grid: Grid, sum: &Octaves, f: impl Fn(&mut Sampler, usize, usize) -> f64 + Sync) -> Field<f32> {
    let mut heights = Field::filled(grid, 0.0);
    for_each_row(&mut heights.data, grid.width, |y, row| {
        let mut sampler = sum.sampler();
        for (x, height) in row.iter_mut().enumerate() {
            *height = f(&mut sampler, x, y) as f32;
        }
    });
    heights
}
