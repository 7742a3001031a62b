//! Rivers that lay a share of their load down again: `z = raised + g·Q − R·(z − below)^n`, where `Q` is what came from
//! above and `g` is `G` over the catchment's cells (Yuan and others 2019).
//!
//! Every height hangs on those below it by its slope, and on those above it by their load. On a tree that is no circle:
//! the load that leaves a catchment is linear in the height it ends at, `a + b·z`, and so is what all its tributaries
//! bring. One pass down gathers the two numbers, one pass up solves each cell with them, exactly where the law is linear
//! and no cell changes its kind. What bends the law (an exponent other than 1, a slope that slides, a lake that drowns
//! a cell or is full) is made linear about the last round: Newton's method over the whole network.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::flow::{ROOT, Router};

use super::law::settle;

/// Rounds after which heights have to have settled; most steps take three.
const MOST_ROUNDS: usize = 30;
/// Change of level in a round below which they have, m: what is left to change falls with its square.
const SETTLED_M: f64 = 0.05;

/// The law along the network.
pub(super) struct Slopes<'a> {
    /// `R` of each cell, `K·Q^m·t / length^n`.
    pub ratio: &'a [f64],
    /// `n`.
    pub exponent: f64,
    /// Greatest drop to a receiver for each way, m.
    pub steepest_m: [f64; 8],
}

/// What comes down to a cell, linear in the level it ends at: thickness at level 0, and its change for a metre.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    at_zero: f64,
    per_m: f64,
}

impl std::ops::AddAssign for Load {
    fn add_assign(&mut self, other: Load) {
        self.at_zero += other.at_zero;
        self.per_m += other.per_m;
    }
}

/// Deposition on the way, with buffers kept.
#[derive(Default)]
pub(super) struct Deposition {
    load: Vec<Load>,
    /// `g` of each cell.
    share: Vec<f64>,
}

impl Deposition {
    /// Solves a step. `surface` begins as what was raised, with the level of every outlet, and ends as ground with the water on it; `height`
    /// ends as the ground, of which nothing in a lake has risen yet.
    pub(super) fn settle(
        &mut self,
        router: &Router,
        slopes: &Slopes,
        deposition: f64,
        raised: &[f64],
        surface: &mut [f64],
        height: &mut [f64],
    ) {
        self.share.clear();
        self.share.resize(raised.len(), 1.0);
        router.descend(&mut self.share, |_, cells| *cells);
        self.share.par_iter_mut().for_each(|cells| *cells = (deposition / *cells).min(1.0));
        self.load.clear();
        self.load.resize(raised.len(), Load::default());
        // Without any load first: that tells where rivers run, what slides and what drowns.
        self.climb(router, slopes, raised, surface);
        for _ in 0..MOST_ROUNDS {
            self.gather(router, slopes, raised, surface);
            if !self.climb(router, slopes, raised, surface) {
                break;
            }
        }
        ground(router, raised, surface, height);
    }

    /// One pass up: every cell above its receiver, with the load that it will have; tells whether any has yet to settle.
    fn climb(&self, router: &Router, slopes: &Slopes, raised: &[f64], surface: &mut [f64]) -> bool {
        let (way, n) = (router.ways(), slopes.exponent);
        let level = |i: usize, below: f64| {
            let (g, load) = (self.share[i], self.load[i]);
            let stiff = 1.0 - g * load.per_m;
            let filled = (raised[i] + g * load.at_zero) / stiff;
            if filled <= below {
                return below;
            }
            let settled = settle(filled, below, slopes.ratio[i] / stiff, n);
            below + (settled - below).clamp(0.0, slopes.steepest_m[way[i] as usize & 7])
        };
        let moves = AtomicBool::new(false);
        router.climb(surface, |i, before, below| {
            let level = level(i, below);
            if (level - before).abs() > SETTLED_M && !moves.load(Ordering::Relaxed) {
                moves.store(true, Ordering::Relaxed);
            }
            level
        });
        moves.into_inner()
    }

    /// One pass down: what leaves each cell, about the levels of the last round.
    fn gather(&mut self, router: &Router, slopes: &Slopes, raised: &[f64], surface: &[f64]) {
        let (way, n, share) = (router.ways(), slopes.exponent, &self.share);
        self.load.par_iter_mut().for_each(|load| *load = Load::default());
        router.descend(&mut self.load, |i, load| {
            let (level, below) = (surface[i], surface[router.receiver(i)]);
            let (g, came, drop) = (share[i], *load, level - below);
            if drop <= 0.0 {
                let room = level - raised[i].min(level);
                return if came.at_zero + came.per_m * level < room {
                    Load::default()
                } else {
                    came.leaving(raised[i], 0.0, 1.0)
                };
            }
            let steepest = slopes.steepest_m[way[i] as usize & 7];
            // What slides ends there but for rounding.
            if drop >= steepest * (1.0 - 1e-12) {
                return came.leaving(raised[i], steepest, 1.0);
            }
            let power = if n == 1.0 { 1.0 } else { libm::pow(drop, n - 1.0) };
            let pull = n * slopes.ratio[i] * power;
            let bend = (n - 1.0) * slopes.ratio[i] * power * drop;
            let stiff = 1.0 - g * came.per_m + pull;
            came.leaving(raised[i], (raised[i] + bend + g * came.at_zero) / stiff, pull / stiff)
        });
    }
}

/// The ground below the surface: what is drowned, or level with the water below it, keeps its height.
fn ground(router: &Router, raised: &[f64], surface: &[f64], height: &mut [f64]) {
    let way = router.ways();
    let cells = height.par_iter_mut().zip(surface).zip(raised).enumerate();
    cells.for_each(|(i, ((z, &level), &raised))| {
        let drowned = way[i] == ROOT || level <= surface[router.receiver(i)];
        *z = if drowned { raised.min(level) } else { level };
    });
}

impl Load {
    /// What leaves a cell that was raised to `raised` and ends at `at + per·below`.
    fn leaving(self, raised: f64, at: f64, per: f64) -> Load {
        let own = self.per_m - 1.0;
        Load { at_zero: self.at_zero + raised + own * at, per_m: own * per }
    }
}
