//! Base shapes: land to start from, or to lay over what is there. Fractal noise, warping, terraces, midpoint
//! displacement, faults, and mountains by repeated magnification and probing (RMP).
//!
//! Every stage is one file: its parameters and how they become heights. [`crate::process::Shape`] runs them, blends the result
//! into the bedrock and books it. Nothing here moves matter or takes time.
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
};

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
