//! What the Voronoi stages share: a peak or a line raised again and again, in several widths at once.
//!
//! Octave `j` draws cells half as wide as octave `j − 1` (four times the sites) and gives them a smaller share of the height:
//! massif, chain, crest. It makes half as many draws; each of `n` draws raises the cells it visits by `share_j·height/n`, times their random weight over
//! its mean, so that the expected height on the path is `height`. Work follows the cells raised.
//!
//! Drawn along the bare path alone, all octaves would average to one smooth cone or dam. So octave `j` also follows spurs,
//! branched `j − 1` deep, that leave the path to both sides; what it raises away from the path is scaled by `p(u)` of the
//! widest octave, so that spurs come down with the massif's flanks.

use rayon::prelude::*;

use crate::{
    grid::{Field, Grid},
    noise::Key,
    process::{Context, ProcessError},
    rmp::{MEAN_WEIGHT, Probe, Raised, density_for_half_width, raise},
};

/// Longest path, in half widths of the narrowest octave.
const LONGEST: f64 = 20_000.0;

/// Draws that a narrow octave makes at least.
const FEWEST_DRAWS: u32 = 24;

/// Steps in which a spur is drawn; further spurs leave it at the steps in [`FORKS`].
const STEPS: usize = 6;
const FORKS: [usize; 3] = [2, 3, 4];

/// A peak or a line to raise.
pub(super) struct Massif {
    pub path_m: Vec<[f64; 2]>,
    pub height_m: f64,
    /// Distance at which the widest octave falls to half its height.
    pub half_width_m: f64,
    pub iterations: u32,
    pub octaves: u32,
    /// Height of an octave over that of the one before.
    pub octave_share: f64,
    pub random_weights: bool,
    /// Spurs on each half width of the path; on a peak, a fifth of the number of spurs around it.
    pub spurs: f64,
}

impl Massif {
    pub fn heights(&self, grid: Grid, key: Key, context: &Context) -> Result<Field<f32>, ProcessError> {
        self.check()?;
        let mut heights = Field::filled(grid, 0.0);
        let total: f64 = (0..self.octaves).map(|j| self.octave_share.powi(j as i32)).sum();
        for octave in 0..self.octaves {
            let share = self.octave_share.powi(octave as i32) / total;
            let density = density_for_half_width(self.half_width_m / libm::exp2(octave as f64));
            // The polygons of a narrow octave are too small to show, and many more: fewer draws do.
            let draws = (self.iterations >> octave.min(31)).max(FEWEST_DRAWS.min(self.iterations));
            let step_m = share * self.height_m / draws as f64;
            let probe = Probe::new(&self.tour(octave.saturating_sub(1), key.named("spurs")), density);
            // A few draws at a time bound the memory.
            for first in (0..draws).step_by(64) {
                context.check()?;
                let raised: Vec<Vec<Raised>> = (first..(first + 64).min(draws))
                    .into_par_iter()
                    .map(|draw| self.draw(&probe, step_m, grid.cell_m, key.with(octave as u64).with(draw as u64)))
                    .collect();
                raise(&mut heights, &raised.concat());
            }
        }
        Ok(heights)
    }

    fn draw(&self, probe: &Probe, step_m: f64, cell_m: f64, key: Key) -> Vec<Raised> {
        let cells = probe.cells(key);
        let raised = cells.into_iter().map(|cell| {
            let weight = if self.random_weights { cell.weight / MEAN_WEIGHT } else { 1.0 };
            let decline = if self.spurs > 0.0 { self.decline(&cell.outline) } else { 1.0 };
            let outline = cell.outline.iter().map(|p| [p[0] / cell_m, p[1] / cell_m]).collect();
            Raised { outline, amount: (weight * decline * step_m) as f32 }
        });
        raised.collect()
    }

    /// What the widest octave leaves of its height at a cell; all of it where the path runs through the cell.
    fn decline(&self, outline: &[[f64; 2]]) -> f64 {
        let n = outline.len() as f64;
        let middle = outline.iter().fold([0.0, 0.0], |sum, p| [sum[0] + p[0] / n, sum[1] + p[1] / n]);
        let radius2 = outline.iter().map(|&p| squared(p, middle)).sum::<f64>() / n;
        let nearest2 = self.path_m.iter().map(|&p| squared(p, middle)).fold(f64::INFINITY, f64::min);
        let off_m = nearest2.sqrt() - radius2.sqrt();
        let u = 0.442 * off_m.max(0.0) / self.half_width_m;
        libm::exp(-u * (1.16 + 0.96 * u))
    }

    /// A walk along the path and all spurs up to `depth` branchings, out and back again. A deeper tour only adds to it.
    fn tour(&self, depth: u32, key: Key) -> Vec<[f64; 2]> {
        let mut tour = vec![self.path_m[0]];
        if depth == 0 || self.spurs <= 0.0 {
            return self.path_m.clone();
        }
        let reach_m = 1.6 * self.half_width_m;
        if self.path_m.len() == 1 {
            let count = (5.0 * self.spurs).ceil() as usize;
            let mut stream = key.stream();
            for i in 0..count {
                let heading = (i as f64 + 0.7 * stream.unit()) / count as f64 * std::f64::consts::TAU;
                spur(&mut tour, heading, reach_m, depth, key.with(i as u64));
            }
            return tour;
        }
        let (mut ahead_m, mut side, mut number) = (0.0, 1.0, 0);
        for leg in self.path_m.windows(2) {
            let along = [leg[1][0] - leg[0][0], leg[1][1] - leg[0][1]];
            tour.push(leg[1]);
            ahead_m -= libm::hypot(along[0], along[1]);
            if ahead_m < 0.0 {
                let mut stream = key.with(number).named("start").stream();
                let heading = libm::atan2(along[1], along[0]) + side * stream.between(0.8, 1.5);
                spur(&mut tour, heading, reach_m * stream.between(0.6, 1.2), depth, key.with(number));
                ahead_m += self.half_width_m / self.spurs * stream.between(0.6, 1.4);
                side = -side;
                number += 1;
            }
        }
        tour
    }

    pub fn check(&self) -> Result<(), ProcessError> {
        let narrowest_m = self.half_width_m / libm::exp2(self.octaves as f64 - 1.0);
        let length_m: f64 = self.path_m.windows(2).map(|s| libm::hypot(s[1][0] - s[0][0], s[1][1] - s[0][1])).sum();
        let furthest_m = self.path_m.iter().flatten().fold(0.0, |far: f64, v| far.max(v.abs()));
        if length_m.max(furthest_m) <= LONGEST * narrowest_m {
            return Ok(());
        }
        Err(ProcessError::Unfit(format!(
            "half_width_km = {} with {} octaves is too narrow for a mountain {:.0} km long or away (widen it, or use fewer \
             octaves)",
            self.half_width_m / 1e3,
            self.octaves,
            length_m.max(furthest_m) / 1e3
        )))
    }
}

fn squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])
}

/// Adds a winding spur from the tour's last point, its own spurs, and the way back.
fn spur(tour: &mut Vec<[f64; 2]>, heading: f64, length_m: f64, depth: u32, key: Key) {
    let Some(&root) = tour.last() else { return };
    let mut stream = key.stream();
    let mut way = vec![root];
    let (mut at, mut heading) = (root, heading);
    let mut side = if stream.unit() < 0.5 { -1.0 } else { 1.0 };
    for step in 1..=STEPS {
        heading += stream.between(-0.45, 0.45);
        let stride_m = length_m / STEPS as f64;
        at = [at[0] + stride_m * libm::cos(heading), at[1] + stride_m * libm::sin(heading)];
        tour.push(at);
        way.push(at);
        let (turn, part) = (stream.between(0.6, 1.2), stream.between(0.4, 0.7));
        if depth > 1 && FORKS.contains(&step) {
            spur(tour, heading + side * turn, part * length_m, depth - 1, key.with(step as u64));
            side = -side;
        }
    }
    tour.extend(way.into_iter().rev().skip(1));
}
