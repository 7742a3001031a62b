//! Air over a map that wraps: what leaves a row's end enters its beginning. Crests are followed twice round, a row of water
//! is closed exactly, the map by repeated laps.

use super::{Air, Water, saturation_mm};

/// Laps on a map that wraps end when nothing moves by more than this share.
const STILL: f64 = 1e-12;
const MOST_LAPS: usize = 200;

impl Air<'_> {
    /// Every cell's rates on a map that wraps.
    pub(super) fn rate_laps(&mut self, crest: &mut [f64]) {
        for _ in 0..2 {
            for &y in &self.order {
                self.climb(y, 2, crest);
            }
        }
        for y in 0..self.grid.height {
            self.rate(y, crest);
        }
    }

    /// Carries the water over a map that wraps.
    pub(super) fn blow_laps(&mut self) {
        for _ in 0..MOST_LAPS {
            let before: Vec<Water> = self.cells.iter().map(|cell| cell.water).collect();
            for y in self.order.clone() {
                self.close(y);
            }
            self.balance();
            let (mut moved, mut most) = (0.0f64, 0.0f64);
            for (cell, before) in self.cells.iter().zip(&before) {
                moved = moved.max((cell.water.vapour - before.vapour).abs());
                most = most.max(cell.water.vapour);
            }
            if moved <= STILL * most {
                break;
            }
        }
    }

    /// Solves a row that closes on itself: what leaves its end is linear in what enters its beginning.
    fn close(&mut self, y: usize) {
        if self.east[y] == 0.0 {
            return self.sweep(y, self.beyond(y));
        }
        let mut end = |vapour: f64, cloud: f64| {
            self.sweep(y, Water { vapour, cloud });
            let last = self.columns(y).last().unwrap_or(0);
            self.cells[self.grid.index(last, y)].water
        };
        let (none, one, other) = (end(0.0, 0.0), end(1.0, 0.0), end(0.0, 1.0));
        let (a, c) = (one.vapour - none.vapour, one.cloud - none.cloud);
        let (b, d) = (other.vapour - none.vapour, other.cloud - none.cloud);
        let determinant = (1.0 - a) * (1.0 - d) - b * c;
        let vapour = ((1.0 - d) * none.vapour + b * none.cloud) / determinant;
        let cloud = (c * none.vapour + (1.0 - a) * none.cloud) / determinant;
        self.sweep(y, Water { vapour, cloud });
    }

    /// On a map that wraps, all water in proportion, so that what evaporates is what falls: takes out the slowest error.
    fn balance(&mut self) {
        let (mut given, mut taken) = (0.0, 0.0);
        for (i, cell) in self.cells.iter().enumerate() {
            let exchange = self.below.exchange[i];
            given += exchange * saturation_mm(self.below.zones[i / self.grid.width].sea_degc);
            let kept = (1.0 - cell.recycled) / self.habits.delay_s;
            taken += exchange * cell.water.vapour + kept * cell.water.cloud;
        }
        if taken > 0.0 {
            let factor = given / taken;
            for cell in &mut self.cells {
                cell.water = Water::default().plus(cell.water, factor);
            }
        }
    }
}
