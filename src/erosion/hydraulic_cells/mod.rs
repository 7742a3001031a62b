//! The stage `hydraulic_cells`: rain, dissolving, carrying and drying up as four steps of a cellular automaton (Olsen
//! 2004), in metres and hours.
//!
//! In every iteration rain falls; water takes up rock in proportion to its depth; water above the mean level of a cell
//! and its lower neighbours goes to these in proportion to the fall, and what it carries goes with it; part of the
//! water dries up, and what the rest cannot carry is laid down. Water moves one cell an iteration. So an iteration is
//! the time in which `flow_m_per_s` crosses a cell, and all rates are per hour: the result does not hang on the cells'
//! size.
//!
//! Water and what it carries are remembered between iterations. Each pass reads the state before it and writes its own
//! cell, one cell around.
//!
//! The sea takes what reaches it. Beyond an open rim the ground is dry and goes on to fall.

mod params;
mod passes;
mod process;
mod rim;
#[cfg(test)]
mod tests;

pub use params::{HydraulicCellsParams, Steepness};

use rayon::prelude::*;

use crate::grid::{Grid, sum_f64, sum_rows};

use super::{
    bed::{Bed, Family, Moved, Part, Saved},
    leftover,
};
use passes::{Around, Law};

/// Rows that are at least worth another thread's while.
const ROWS: usize = 8;

/// The automaton bound to its parameters and a grid.
pub struct HydraulicCells {
    law: Law,
    iterations: f64,
    grid: Grid,
    /// Depth of water, m.
    water: Vec<f32>,
    /// Rock that the water carries, m: in double precision, as it passes through many cells before it comes to rest.
    load: Vec<f64>,
    /// Most water that left cells at the end of a step, m an iteration.
    passed: Vec<f32>,
    /// Level of ground and water, m, with a ring of cells around the map, as the three below.
    level: Vec<f32>,
    /// Level after the iteration.
    next: Vec<f32>,
    /// Water that leaves, by unit of weighted fall.
    flow: Vec<f32>,
    /// Load that leaves, by unit of weighted fall.
    drift: Vec<f32>,
}

impl HydraulicCells {
    /// The automaton on a dry map.
    pub fn new(params: &HydraulicCellsParams, grid: &Grid) -> Self {
        let ringed = || vec![0.0; (grid.width + 2) * (grid.height + 2)];
        let cells = || vec![0.0; grid.cells()];
        Self {
            law: params.law(grid),
            iterations: params.iterations(grid),
            grid: *grid,
            water: cells(),
            load: vec![0.0; grid.cells()],
            passed: cells(),
            level: ringed(),
            next: ringed(),
            flow: ringed(),
            drift: ringed(),
        }
    }

    /// With so much water on the ground to begin with, m.
    pub fn on(mut self, water: Vec<f32>) -> Self {
        self.water = water;
        self
    }

    /// Water on the ground, m.
    pub fn water(&self) -> &[f32] {
        &self.water
    }

    /// Water that passed cells in the last iteration, m³/s.
    pub fn discharge(&self) -> Vec<f32> {
        let per_s = self.grid.cell_area_m2() / self.law.iteration_s;
        self.passed.iter().map(|&out| (f64::from(out) * per_s) as f32).collect()
    }

    /// Sets the levels from bed and water.
    fn begin(&mut self, bed: &Bed) {
        let (width, water) = (self.grid.width, &self.water);
        let inner = &mut self.level[width + 2..];
        inner.par_chunks_exact_mut(width + 2).take(self.grid.height).enumerate().for_each(|(y, row)| {
            for (x, level) in row[1..=width].iter_mut().enumerate() {
                let i = y * width + x;
                *level = bed.height(i).max(bed.sea_m) + water[i];
            }
        });
    }

    /// One iteration; what leaves over the rim: water and rock, m of a cell. Where it is `seen`, notes what passes cells.
    fn iterate(&mut self, bed: &mut Bed, ones: &[f32], seen: bool) -> [f64; 2] {
        let (grid, law) = (self.grid, self.law.over(bed));
        let (width, stride) = (grid.width, grid.width + 2);
        rim::level(&mut self.level, &grid, bed);
        if seen {
            self.passed.copy_from_slice(&self.water);
        }

        let level = &self.level;
        let flow = self.flow[stride..stride * (grid.height + 1)].par_chunks_exact_mut(stride);
        let drift = self.drift[stride..stride * (grid.height + 1)].par_chunks_exact_mut(stride);
        let water = self.water.par_chunks_exact_mut(width);
        let load = self.load.par_chunks_exact_mut(width);
        (flow, drift, water, load).into_par_iter().with_min_len(ROWS).enumerate().for_each(
            |(y, (flow, drift, water, load))| {
                passes::leave(Around::of(level, y, stride), &mut flow[1..=width], &mut drift[1..=width], water, load);
            },
        );

        if seen {
            self.passed.iter_mut().zip(&self.water).for_each(|(passed, left)| *passed -= left);
        }
        rim::wrap(&mut self.flow, &grid);
        rim::wrap(&mut self.drift, &grid);
        let left = rim::left(&self.level, &self.flow, &self.drift, &grid);

        let (flow, drift, start, rate) = (&self.flow, &self.drift, &bed.start, &bed.rate);
        let next = self.next[stride..stride * (grid.height + 1)].par_chunks_exact_mut(stride);
        let water = self.water.par_chunks_exact_mut(width);
        let load = self.load.par_chunks_exact_mut(width);
        let change = bed.change.par_chunks_exact_mut(width);
        (next, water, load, change).into_par_iter().with_min_len(ROWS).enumerate().for_each(
            |(y, (next, water, load, change))| {
                let around = [level, flow, drift].map(|data| Around::of(data, y, stride));
                let row = y * width..(y + 1) * width;
                let ground = [&start[row.clone()], rate.get(row).unwrap_or(ones)];
                passes::arrive(&law, around, ground, &mut next[1..=width], water, load, change);
            },
        );
        std::mem::swap(&mut self.level, &mut self.next);
        left
    }
}

impl Family for HydraulicCells {
    fn advance(&mut self, bed: &mut Bed, part: Part) -> Moved {
        let area = self.grid.cell_area_m2();
        let [from, to] = part.of(self.iterations).map(|at| at.round() as u64);
        let before = sum_f64(&self.water);
        let ones = vec![1.0; self.grid.width];
        let mut rock = 0.0;
        self.begin(bed);
        for k in from..to {
            rock += self.iterate(bed, &ones, k + 1 == to)[1];
        }
        let rain = (to - from) as f64 * self.law.rain_m as f64 * self.grid.cells() as f64;
        Moved {
            rock_left_m3: rock * area,
            water_in_m3: rain * area,
            water_left_m3: (before + rain - sum_f64(&self.water)) * area,
        }
    }

    fn carried_m3(&self) -> f64 {
        let width = self.grid.width;
        sum_rows(self.grid.height, |y| self.load[y * width..][..width].iter().sum()) * self.grid.cell_area_m2()
    }

    fn settle(&mut self, bed: &mut Bed) -> Moved {
        let mut rounded = 0.0;
        // What single precision takes from one cell's load it gives to the next.
        let single = |load: &mut f64| {
            let wanted = std::mem::take(load) + rounded;
            rounded = wanted - f64::from(wanted as f32);
            wanted as f32
        };
        let mut rest: Vec<f32> = self.load.iter_mut().map(single).collect();
        leftover::lay_all(bed, &mut rest);
        Moved::default()
    }

    fn save(&self) -> Saved {
        let blob = self.load.iter().flat_map(|load| load.to_le_bytes()).collect();
        Saved { fields: vec![("water", self.water.clone())], blob }
    }

    fn restore(&mut self, field: &dyn Fn(&str) -> Option<Vec<f32>>, blob: &[u8]) -> Option<()> {
        let (words, []) = blob.as_chunks() else { return None };
        let load: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        let water = field("water")?;
        let right = water.len() == self.grid.cells() && load.len() == water.len();
        (self.water, self.load) = right.then_some((water, load))?;
        Some(())
    }
}
