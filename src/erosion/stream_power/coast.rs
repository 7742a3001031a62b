//! What rivers bring to the sea is laid down along the coast.
//!
//! Each mouth's load spreads over the sea as by diffusion over the step, `K_m·t`; where that would rise above the sea the
//! surplus spreads on from there, over what room is left. What is still left after some rounds fills the sea evenly.

use rayon::prelude::*;

use crate::{
    erosion::diffusion::{both, diffuse},
    grid::Grid,
};

/// Rounds of spreading.
const ROUNDS: usize = 4;

/// Lays `load_m` (thickness, at the cells where it arrives) over the sea and gives what found no room, m.
/// `room_m` is the depth of water a cell can take, 0 on land.
pub(super) fn lay(grid: Grid, load_m: Vec<f64>, room_m: &mut [f64], spread_m2: f64, laid_m: &mut [f64]) -> f64 {
    let mut load = load_m;
    let mut open = vec![0.0f32; load.len()];
    for _ in 0..ROUNDS {
        // What is full lets nothing pass but what has yet to leave it.
        open.par_iter_mut().zip(&*room_m).zip(&load).for_each(|((open, &room), &load)| {
            *open = if room > 0.0 || load > 0.0 { 1.0 } else { 0.0 };
        });
        diffuse(grid, &mut load, spread_m2, &open, both);
        (&mut load, &mut *room_m, &mut *laid_m).into_par_iter().for_each(|(load, room, laid)| {
            let settles = load.min(*room).max(0.0);
            *laid += settles;
            *room -= settles;
            *load -= settles;
        });
        if load.iter().all(|&load| load <= 0.0) {
            return 0.0;
        }
    }
    let (left, room): (f64, f64) = (load.iter().sum(), room_m.iter().sum());
    if room <= 0.0 {
        return left;
    }
    let share = (left / room).min(1.0);
    for (room, laid) in room_m.iter_mut().zip(laid_m) {
        *laid += share * *room;
        *room -= share * *room;
    }
    left - share * room
}
