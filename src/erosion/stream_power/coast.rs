//! What rivers bring to the sea is laid down off their mouths.
//!
//! The load goes outwards from the mouths, nearest cells first (Dial's buckets over steps of 5 and 7, which is 1 and √2 to one
//! part in a hundred). Each cell keeps the share that makes the load fall to 1/e over the reach, or what fits below a shelf
//! that sinks gently from the mouth, and hands the rest on to its neighbours further out. A mouth that is full becomes land,
//! and the river goes on from there. Only cells that load reaches are visited.

use std::collections::VecDeque;

use crate::flow::Compass;

/// Fall of a full shelf away from the mouth, rise over run; continental shelves have 1 to 2 m a km.
const SHELF_SLOPE: f64 = 1e-3;
/// Load that is not worth dividing, as a share of the largest: what is left of it nine reaches from its mouth.
const LEAST_SHARE: f64 = 1e-4;
/// Lengths of the eight steps, in fifths of a cell.
const FIFTHS: [u32; 8] = [7, 5, 7, 5, 5, 7, 5, 7];
/// One over each of them.
const SHARES: [f64; 8] = {
    let (d, s) = (1.0 / 7.0, 1.0 / 5.0);
    [d, s, d, s, s, d, s, d]
};

/// The waters off a coast, with buffers kept.
#[derive(Default)]
pub(super) struct Coast {
    /// Distance from the nearest mouth in fifths of a cell; `u32::MAX` where no load has come.
    distance: Vec<u32>,
    touched: Vec<u32>,
    /// Cells by distance, from the one at hand on.
    rings: VecDeque<Vec<u32>>,
}

impl Coast {
    /// Lays `load_m` down: thickness, where it arrives; used up. `room_m` is the depth of water a cell can take, 0 on
    /// land. Adds to `ground_m` and gives what found no room, as thickness summed over cells.
    pub(super) fn lay(
        &mut self,
        compass: &Compass,
        load_m: &mut [f64],
        room_m: &[f64],
        reach_m: f64,
        ground_m: &mut [f64],
    ) -> f64 {
        self.distance.resize(load_m.len(), u32::MAX);
        self.rings.clear();
        self.rings.resize_with(8, Vec::new);
        let mut least_m = 0.0f64;
        for i in (0..load_m.len()).filter(|&i| load_m[i] > 0.0) {
            least_m = least_m.max(LEAST_SHARE * load_m[i]);
            self.distance[i] = 0;
            self.touched.push(i as u32);
            self.rings[0].push(i as u32);
        }
        let keeps = 1.0 - libm::exp(-compass.grid.cell_m / reach_m.max(1e-3 * compass.grid.cell_m));
        let fall = SHELF_SLOPE * compass.grid.cell_m / 5.0;
        let (mut left, mut at) = (0.0, 0u32);
        while self.rings.iter().any(|ring| !ring.is_empty()) {
            let mut ring = self.rings.pop_front().unwrap_or_default();
            for i in ring.drain(..).map(|i| i as usize) {
                // Listed again nearer by.
                if self.distance[i] != at {
                    continue;
                }
                let load = std::mem::take(&mut load_m[i]);
                let wants = if load < least_m { load } else { keeps * load };
                let settles = wants.min(room_m[i] - fall * at as f64).max(0.0);
                ground_m[i] += settles;
                left += self.hand_on(compass, i, load - settles, load_m, room_m);
            }
            self.rings.push_back(ring);
            at += 1;
        }
        for i in self.touched.drain(..) {
            self.distance[i as usize] = u32::MAX;
        }
        left
    }

    /// Divides a load among the neighbours that have not had their turn; gives it back where there is none.
    fn hand_on(&mut self, compass: &Compass, i: usize, load: f64, load_m: &mut [f64], room_m: &[f64]) -> f64 {
        if load <= 0.0 {
            return 0.0;
        }
        let at = self.distance[i];
        let (mut further, mut count, mut shares) = ([(0, 0); 8], 0, 0.0);
        compass.each(i, |way, j| {
            if room_m[j] > 0.0 && self.distance[j] > at {
                further[count] = (FIFTHS[way as usize], j);
                count += 1;
                shares += SHARES[way as usize];
            }
        });
        if count == 0 {
            return load;
        }
        let per_share = load / shares;
        for &(step, j) in &further[..count] {
            load_m[j] += per_share / step as f64;
            if at + step < self.distance[j] {
                if self.distance[j] == u32::MAX {
                    self.touched.push(j as u32);
                }
                self.distance[j] = at + step;
                self.rings[step as usize - 1].push(j as u32);
            }
        }
        0.0
    }
}

/// Fills a sea evenly with what found no other place; gives what is more than it holds, as thickness summed over cells.
pub(super) fn fill_evenly(left_m: f64, sea_level_m: f64, is_sea: impl Fn(usize) -> bool, ground_m: &mut [f64]) -> f64 {
    let depth = |i: usize, z: f64| if is_sea(i) { (sea_level_m - z).max(0.0) } else { 0.0 };
    let room: f64 = ground_m.iter().enumerate().map(|(i, &z)| depth(i, z)).sum();
    if room <= 0.0 {
        return left_m;
    }
    let share = (left_m / room).min(1.0);
    for (i, z) in ground_m.iter_mut().enumerate() {
        *z += share * depth(i, *z);
    }
    left_m - share * room
}
