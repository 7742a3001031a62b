//! The stage `droplets`: parcels of rain run down slopes one after another, take up rock, and lay it down where they
//! slow (after Beyer 2015), in metres and years.
//!
//! A droplet stands for the rain of the stage on its share of the map, so that the number of droplets smooths the
//! result but does not deepen it. `morphological_factor` says how many years of land each of its years of rain stands
//! for: a droplet then carries as many times the rock, and the world's clock goes on by as many times the years.
//!
//! Its speed is `v² = (v² + 2·g·drop) / (1 + drag·step)`; it carries `capacity·water·sine of the slope·v`, and nears
//! that over a distance, so that cells of another size give the same valleys. No droplet digs below the next place of
//! its path nor builds above the one before, and what finds no room at its end spreads until it does.
//!
//! Droplets run one after another within windows that are cut anew for each phase (`window.rs`), and those of several
//! windows at a time in the lanes of a vector (`team.rs`, `step.rs`). The other way, to trace many against frozen ground
//! and add up what they did, needs batches so small that two hardly ever share a gully, and still digs where they do.

mod ground;
mod kernel;
mod lanes;
mod params;
mod places;
mod process;
mod step;
mod team;
#[cfg(test)]
mod tests;
mod walk;
mod window;

pub use params::DropletsParams;

use std::sync::Mutex;

use rayon::prelude::*;

use crate::{
    grid::{Grid, sum_f64},
    noise::{Key, Stream},
};

use super::{
    bed::{Bed, Family, Moved, Part, Saved},
    leftover,
};
use kernel::Kernel;
use team::Phase;
use walk::{Droplet, Law};
use window::Window;

/// Rounds in which the rain falls, at least: it comes to all of the map before it comes again.
const ROUNDS: f64 = 16.0;
/// Droplets on a cell in a round, at most.
const DENSITY: f64 = 1.0 / 16.0;
/// Phases after the last round of a step: those that are not through then end where they are.
const PHASES: usize = 4096;
/// Passes in which what found no room spreads after each step.
const PASSES: usize = 2;
/// Seconds in a year.
const YEAR_S: f64 = 3600.0 * 8766.0;
/// Cells a side below which there is no slope to run down.
const LEAST_SIDE: usize = 4;

/// Cells that droplets keep from a cut: what they touch, and a step.
fn margin(radius_cells: f64) -> usize {
    (radius_cells + 0.5) as usize + 2
}

/// Droplets bound to their parameters and a grid.
pub struct Droplets {
    law: Law,
    kernel: Kernel,
    grid: Grid,
    key: Key,
    rounds: f64,
    /// Droplets of a round, west to east and north to south.
    strata: [usize; 2],
    rain_m: f64,
    /// Rock that has not found room, m by cell. Empty where there is none.
    rest: Vec<f32>,
    /// Droplets that have passed cells, by the share of their water that was left.
    passed: Vec<f32>,
    /// Share of the rain that has fallen.
    fallen: f64,
    /// Water of a droplet over the time that all the rain takes, m³/s.
    droplet_m3_per_s: f64,
    windows: Vec<Window>,
    waiting: Vec<Droplet>,
    steps: u64,
}

impl Droplets {
    /// Droplets under a key.
    pub fn new(params: &DropletsParams, grid: &Grid, key: Key) -> Self {
        let rounds = (params.droplets_per_cell / DENSITY).ceil().max(ROUNDS);
        let per_side = (params.droplets_per_cell / rounds).sqrt();
        let strata = [grid.width, grid.height].map(|size| ((size as f64 * per_side).round() as usize).max(1));
        let share = grid.cells() as f64 / (rounds * (strata[0] * strata[1]) as f64);
        let rain_m = params.rain_m();
        let seconds = (YEAR_S * params.duration_yr).max(1.0);
        Self {
            law: params.law(grid, rain_m * share),
            kernel: Kernel::new(params.radius_cells(grid)),
            grid: *grid,
            key,
            rounds,
            strata,
            rain_m,
            rest: Vec::new(),
            passed: vec![0.0; grid.cells()],
            fallen: 0.0,
            droplet_m3_per_s: rain_m * share * grid.cell_area_m2() / seconds,
            windows: Vec::new(),
            waiting: Vec::new(),
            steps: 0,
        }
    }

    /// Steps that droplets have taken since this was made: what its speed is counted in.
    pub fn steps_taken(&self) -> u64 {
        self.steps
    }

    /// Water that passes cells, m³/s: the mean over the years that have gone by.
    pub fn discharge(&self) -> Vec<f32> {
        let per_droplet = if self.fallen > 0.0 { self.droplet_m3_per_s / self.fallen } else { 0.0 };
        self.passed.iter().map(|&droplets| (f64::from(droplets) * per_droplet) as f32).collect()
    }

    /// The rain of a round: one droplet somewhere in each of as many equal parts of the map.
    fn rain(&mut self, stream: &mut Stream) {
        let g = &self.grid;
        // Places are counted from the first cell's centre; a map that wraps goes on to the first again.
        let wraps = g.edges == crate::grid::Edges::Wrap;
        let span = [g.width, g.height].map(|size| if wraps { size as f64 } else { (size - 1) as f64 });
        let [columns, rows] = self.strata;
        for j in 0..rows {
            for i in 0..columns {
                let x = (i as f64 + stream.unit()) / columns as f64 * span[0];
                let y = (j as f64 + stream.unit()) / rows as f64 * span[1];
                self.waiting.push(Droplet::new([x, y]));
            }
        }
    }

    /// Cuts the map anew and gives all droplets that wait to the windows; the first window of each row of the map, and
    /// how many there are across.
    fn share_out(&mut self, stream: &mut Stream) -> (Vec<usize>, usize) {
        let (grid, windows) = (self.grid, &mut self.windows);
        let columns = window::cut(grid.width, grid.edges, stream.unit());
        let rows = window::cut(grid.height, grid.edges, stream.unit());
        let (across, count) = (columns.len(), columns.len() * rows.len());
        windows.resize_with(count.max(windows.len()), Window::default);
        for (k, window) in windows.iter_mut().take(count).enumerate() {
            window.shut([columns[k % across], rows[k / across]]);
        }
        let of_column = window::owners(&columns, grid.width);
        let first: Vec<usize> = window::owners(&rows, grid.height).iter().map(|row| row * across).collect();
        for droplet in self.waiting.drain(..) {
            let [x, y] = droplet.at.map(|v| v as usize);
            windows[first[y] + of_column[x]].queue.push(droplet);
        }
        (first, across)
    }

    /// Runs all droplets that wait, each until it ends or comes near to a cut; what left over the rim, m of a cell.
    fn phase(&mut self, bed: &mut Bed, stream: &mut Stream) -> f64 {
        let (first, across) = self.share_out(stream);
        let mut open: Vec<&mut Window> = self.windows.iter_mut().filter(|window| !window.queue.is_empty()).collect();
        // Those with most droplets begin first.
        open.sort_by_key(|window| window.queue.len());
        let threads = rayon::current_num_threads();
        let width = open.len().div_ceil(threads);
        let (open, margin) = (Mutex::new(open), self.kernel.reach + 2);
        let phase = Phase { bed, law: &self.law, kernel: &self.kernel, margin };
        (0..threads).into_par_iter().for_each(|_| team::run(phase, &open, width));
        let (grid, windows) = (self.grid, &self.windows);
        let rows = bed.change.par_chunks_exact_mut(grid.width).zip(self.passed.par_chunks_exact_mut(grid.width));
        rows.enumerate().for_each(|(y, (row, passed))| {
            windows[first[y]..][..across].iter().for_each(|window| window.close(&grid, y, row, passed));
        });
        self.gather()
    }

    /// Takes from the windows what came of their droplets; what left over the rim, m of a cell.
    fn gather(&mut self) -> f64 {
        let mut left = 0.0;
        for window in &mut self.windows {
            self.waiting.append(&mut window.later);
            left += std::mem::take(&mut window.left);
            self.steps += std::mem::take(&mut window.steps);
            for (cell, load) in window.rest.drain(..) {
                self.rest.resize(self.grid.cells(), 0.0);
                self.rest[cell] += load as f32;
            }
        }
        left
    }
}

impl Family for Droplets {
    fn advance(&mut self, bed: &mut Bed, part: Part) -> Moved {
        let area = self.grid.cell_area_m2();
        let rounds = part.of(self.rounds).map(|at| at.round() as u64);
        let rain = (rounds[1] - rounds[0]) as f64 / self.rounds * self.rain_m * self.grid.cells() as f64 * area;
        let mut left = 0.0;
        if self.grid.width.min(self.grid.height) >= LEAST_SIDE {
            for round in rounds[0]..rounds[1] {
                let mut stream = self.key.with(round).stream();
                self.rain(&mut stream);
                left += self.phase(bed, &mut stream);
            }
            let mut stream = self.key.named("last").with(part.step).stream();
            for _ in 0..PHASES {
                if self.waiting.is_empty() {
                    break;
                }
                left += self.phase(bed, &mut stream);
            }
            for droplet in self.waiting.drain(..).filter(|droplet| droplet.load != 0.0) {
                self.rest.resize(self.grid.cells(), 0.0);
                self.rest[self.grid.index(droplet.at[0] as usize, droplet.at[1] as usize)] += droplet.load as f32;
            }
            leftover::lay_down(bed, &mut self.rest, PASSES);
        }
        self.fallen = rounds[1] as f64 / self.rounds;
        Moved { rock_left_m3: left * area, water_in_m3: rain, water_left_m3: rain }
    }

    fn carried_m3(&self) -> f64 {
        sum_f64(&self.rest) * self.grid.cell_area_m2()
    }

    fn settle(&mut self, bed: &mut Bed) -> Moved {
        leftover::lay_all(bed, &mut self.rest);
        self.rest.clear();
        Moved::default()
    }

    fn save(&self) -> Saved {
        let mut fields = vec![("passed", self.passed.clone())];
        if !self.rest.is_empty() {
            fields.push(("rest", self.rest.clone()));
        }
        Saved { fields, blob: self.fallen.to_le_bytes().to_vec() }
    }

    fn restore(&mut self, field: &dyn Fn(&str) -> Option<Vec<f32>>, blob: &[u8]) -> Option<()> {
        let cells = self.grid.cells();
        self.fallen = f64::from_le_bytes(blob.try_into().ok()?);
        self.passed = field("passed").filter(|passed| passed.len() == cells)?;
        self.rest = field("rest").unwrap_or_default();
        (self.rest.is_empty() || self.rest.len() == cells).then_some(())
    }
}
