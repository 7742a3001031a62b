//! The reference that tests hold the lake graph against: priority-flood, which fills every depression to its spill point
//! (Barnes, Lehman and Mulla 2014).

use std::{
    cmp::Ordering,
    collections::{BinaryHeap, VecDeque},
};

use crate::grid::Grid;

use super::neighbours;

/// A flooded surface.
pub struct Flood {
    /// Height without depressions, m.
    pub surface_m: Vec<f64>,
}

#[derive(PartialEq)]
struct Front {
    z: f64,
    turn: u32,
    cell: u32,
}

impl Eq for Front {}

impl Ord for Front {
    /// The lowest first; of equals the one that came first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.z.total_cmp(&self.z).then(other.turn.cmp(&self.turn))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Floods a surface from its outlets.
pub fn flood(grid: Grid, height_m: &[f64], outlet: &[bool]) -> Flood {
    let cells = grid.cells();
    let mut surface_m = height_m.to_vec();
    let mut seen = outlet.to_vec();
    let mut heap = BinaryHeap::new();
    let mut turn = 0;
    for i in (0..cells).filter(|&i| outlet[i]) {
        heap.push(Front { z: surface_m[i], turn, cell: i as u32 });
        turn += 1;
    }
    // Cells raised to the level of the flood need no sorting.
    let mut pool: VecDeque<u32> = VecDeque::new();
    while let Some(cell) = pool.pop_front().or_else(|| heap.pop().map(|front| front.cell)) {
        let level = surface_m[cell as usize];
        for (j, _) in neighbours(grid, cell as usize) {
            if std::mem::replace(&mut seen[j], true) {
                continue;
            }
            if surface_m[j] <= level {
                surface_m[j] = level;
                pool.push_back(j as u32);
            } else {
                heap.push(Front { z: surface_m[j], turn, cell: j as u32 });
                turn += 1;
            }
        }
    }
    Flood { surface_m }
}
