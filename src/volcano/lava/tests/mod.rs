//! Lava against what is known of it: closed forms of flow and heat, books of volume, and input that makes no sense.

mod bake;
mod books;
mod flows;
mod heat;
mod steps;

use super::{
    LavaParams,
    choices::{Contact, Solver, Viscosity},
    eruption::Eruption,
    flow::Flow,
    land::Land,
    law::Law,
};
use crate::{
    grid::{Edges, Field, Grid},
    noise::Key,
    volcano::{
        outlet::{Outlet, VentParams},
        schedule::{Key as Timed, Schedule},
    },
    world::{Layer, World},
};

/// A world whose ground is a function of metres.
fn world(grid: Grid, height: impl Fn(f64, f64) -> f64 + Sync) -> World {
    let mut world = World::new(grid, -1e4);
    let ground = Field::from_fn(grid, |x, y| {
        let [x, y] = grid.center_m(x, y);
        height(x, y) as f32
    });
    world.set_layer(Layer::Bedrock, ground);
    world
}

/// Lava without heat on ground of this form.
fn cold(params: &LavaParams, world: &World) -> (Flow, Land) {
    let still = LavaParams { cooling_factor: 0.0, freeze: false, ..params.clone() };
    (Flow::new(Law::new(&still, &world.grid), world.grid), Land::new(world))
}

/// Fills a box with particles at rest, `counts` of them a side, from a corner over the land's datum.
fn fill(flow: &mut Flow, from: [f64; 3], counts: [usize; 3], jitter: f64) {
    let d = flow.law.spacing;
    let mut stream = Key::new(3).named("fill").stream();
    for k in 0..counts[0] * counts[1] * counts[2] {
        let at = [k % counts[0], k / counts[0] % counts[1], k / counts[0] / counts[1]];
        let at = [0, 1, 2].map(|a| (from[a] + d * (at[a] as f64 + 0.5 + stream.between(-jitter, jitter))) as f32);
        let degc = flow.law.params.temperature_degc;
        flow.add(at, [0.0; 3], degc, k as u64);
    }
}

/// Moves lava for a time.
fn flow_for(flow: &mut Flow, land: &Land, time_s: f64) {
    let mut left = time_s;
    while left > 0.0 {
        flow.sort();
        left -= flow.block(land, left).unwrap();
    }
}

/// An eruption on this world.
fn eruption(params: &LavaParams, world: &World) -> Eruption {
    Eruption::new(params, world, None, Key::new(1)).unwrap()
}
