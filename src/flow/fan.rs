//! Flow that parts: each cell gives to all its lower neighbours, more to the steeper (Freeman 1991). For wetness and
//! pictures; a stream has one receiver, as [`Drainage`] says.

use super::{Drainage, LENGTHS, compass::Compass};

/// Freeman's exponent: 1 parts in proportion to slope, large values follow the steepest.
pub const FREEMAN: f64 = 1.1;

impl Drainage {
    /// What gathers at each cell if `source` runs to all lower neighbours, parted by the `exponent`th power of slope. On
    /// flats and lakes it follows the receivers. Outlets keep what comes.
    pub fn accumulate_parted(&self, source: &[f64], exponent: f64) -> Vec<f64> {
        let compass = Compass::new(self.grid);
        let surface = &self.surface_m;
        let mut place = vec![0u32; self.len()];
        for (at, &i) in self.order.iter().enumerate() {
            place[i as usize] = at as u32;
        }
        // The highest first; on a level the one further up the forest.
        let mut falling: Vec<u32> = (0..self.len() as u32).collect();
        falling.sort_unstable_by(|&a, &b| {
            let level = surface[b as usize].total_cmp(&surface[a as usize]);
            level.then(place[b as usize].cmp(&place[a as usize]))
        });
        let mut sum = source.to_vec();
        for i in falling.into_iter().map(|i| i as usize).filter(|&i| !self.is_outlet(i)) {
            let mut weights = [0.0; 8];
            compass.each(i, |way, j| {
                let slope = (surface[i] - surface[j]) / LENGTHS[way as usize];
                if slope > 0.0 {
                    weights[way as usize] = libm::pow(slope, exponent);
                }
            });
            let (whole, held) = (weights.iter().sum::<f64>(), sum[i]);
            if whole > 0.0 && whole.is_finite() {
                compass.each(i, |way, j| sum[j] += held * (weights[way as usize] / whole));
            } else {
                sum[self.receiver[i] as usize] += held;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn a_cone_sheds_evenly_and_all_of_it_arrives() {
        let grid = Grid::new(101, 101, 101.0, Edges::Open);
        let from_middle = |i: usize| {
            let (x, y) = grid.cell_of(i);
            ((x as f64 - 50.0).powi(2) + (y as f64 - 50.0).powi(2)).sqrt()
        };
        let height: Vec<f64> = (0..grid.cells()).map(|i| 100.0 - from_middle(i)).collect();
        let outlet: Vec<bool> = (0..grid.cells()).map(|i| from_middle(i) >= 48.0).collect();
        let d = Drainage::of(grid, &height, &outlet);
        let parted = d.accumulate_parted(&vec![1.0; grid.cells()], FREEMAN);
        let arrived: f64 = (0..grid.cells()).filter(|&i| outlet[i]).map(|i| parted[i]).sum();
        assert!((arrived / grid.cells() as f64 - 1.0).abs() < 1e-12);
        // Round a ring the areas of single receivers scatter by more than their mean; parted ones far less.
        let scatter = |area: &[f64]| {
            let ring: Vec<f64> =
                (0..grid.cells()).filter(|&i| (from_middle(i) - 35.0).abs() < 0.5).map(|i| area[i]).collect();
            let mean = ring.iter().sum::<f64>() / ring.len() as f64;
            (ring.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / ring.len() as f64).sqrt() / mean
        };
        let (one, many) = (scatter(&d.area_m2()), scatter(&parted));
        assert!(many < 0.25 && one > 2.0 * many, "{one} {many}");
    }
}
