//! What a forest of receivers says of its rivers: orders, basins by size, main stems, lengths.

use super::Drainage;

/// Stands for no cell.
pub const NONE: u32 = u32::MAX;

impl Drainage {
    /// Strahler's order of every cell that `is_stream`, 0 elsewhere. A stream has order 1 at its source; where two of the
    /// highest order meet it rises by one.
    pub fn strahler(&self, is_stream: impl Fn(usize) -> bool) -> Vec<u8> {
        let mut order = vec![0u8; self.len()];
        // Whether a donor of the cell's present order has come before.
        let mut twice = vec![false; self.len()];
        for i in self.order.iter().rev().map(|&i| i as usize) {
            if !is_stream(i) {
                order[i] = 0;
                continue;
            }
            order[i] = match (order[i], twice[i]) {
                (0, _) => 1,
                (highest, two) => highest.saturating_add(u8::from(two)),
            };
            let (own, r) = (order[i], self.receiver[i] as usize);
            if r != i {
                twice[r] = if own == order[r] { true } else { twice[r] && own < order[r] };
                order[r] = order[r].max(own);
            }
        }
        order
    }

    /// The basin of every cell, numbered from the largest, 1; 0 in the water that `is_sea`. A basin ends where it reaches
    /// the sea or leaves the map. Of two as large the one whose mouth has the lower index comes first.
    pub fn basins_by_size(&self, is_sea: impl Fn(usize) -> bool) -> Vec<u32> {
        let mut mouth = vec![NONE; self.len()];
        let mut cells = vec![0u32; self.len()];
        for i in self.order.iter().map(|&i| i as usize).filter(|&i| !is_sea(i)) {
            let r = self.receiver[i] as usize;
            mouth[i] = if r == i || is_sea(r) { i as u32 } else { mouth[r] };
            cells[mouth[i] as usize] += 1;
        }
        let mut mouths: Vec<u32> = (0..self.len() as u32).filter(|&i| cells[i as usize] > 0).collect();
        mouths.sort_by_key(|&i| std::cmp::Reverse(cells[i as usize]));
        let mut number = vec![0u32; self.len()];
        for (&mouth, place) in mouths.iter().zip(1..) {
            number[mouth as usize] = place;
        }
        mouth.iter().map(|&mouth| if mouth == NONE { 0 } else { number[mouth as usize] }).collect()
    }

    /// Of the cells that drain to each one the greatest by `weight`, catchment area as a rule: the way a main stem goes on
    /// upstream. [`NONE`] at a source; of equals the one of the lowest index.
    pub fn main_donors(&self, weight: &[f64]) -> Vec<u32> {
        let mut donor = vec![NONE; self.len()];
        for i in (0..self.len()).filter(|&i| !self.is_outlet(i)) {
            let best = &mut donor[self.receiver[i] as usize];
            if *best == NONE || weight[i] > weight[*best as usize] {
                *best = i as u32;
            }
        }
        donor
    }

    /// The main stem above a cell, from there up to its source.
    pub fn main_stem(&self, main_donors: &[u32], from: usize) -> Vec<u32> {
        let up = |&i: &u32| Some(main_donors[i as usize]).filter(|&donor| donor != NONE);
        std::iter::successors(Some(from as u32), up).collect()
    }

    /// Length of the longest way that water takes to each cell, m.
    pub fn longest_way_m(&self) -> Vec<f64> {
        let mut length = vec![0.0f64; self.len()];
        for i in self.order.iter().rev().map(|&i| i as usize) {
            let r = self.receiver[i] as usize;
            if r != i {
                length[r] = length[r].max(length[i] + self.step_m(i));
            }
        }
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    /// A forest on a 5 x 3 map: two sources meet, the stream of order 2 takes one of order 1 and then another of order 2.
    fn forest() -> Drainage {
        let grid = Grid::new(5, 3, 5.0, Edges::Closed);
        // 0 and 2 flow to 6; 5 to 6; 6 to 7; 4 and 14 to 8, 8 to 7; 7 to 12, the outlet; the rest are outlets by themselves.
        let mut receiver: Vec<u32> = (0..15).collect();
        for (from, to) in [(0, 6), (2, 6), (5, 6), (6, 7), (4, 8), (14, 8), (8, 7), (7, 12)] {
            receiver[from] = to;
        }
        let order = vec![12, 7, 6, 8, 0, 2, 5, 4, 14, 1, 3, 9, 10, 11, 13];
        Drainage { grid, receiver, order, surface_m: vec![0.0; 15] }
    }

    #[test]
    fn orders_rise_where_equals_meet() {
        let d = forest();
        let order = d.strahler(|_| true);
        assert_eq!([0, 2, 5, 4, 14].map(|i| order[i]), [1; 5]);
        assert_eq!([6, 8, 7, 12].map(|i| order[i]), [2, 2, 3, 3]);
        // Without the stream from the east the trunk keeps its order.
        let west = d.strahler(|i| i != 14 && i != 4 && i != 8);
        assert_eq!([6, 7, 12, 8].map(|i| west[i]), [2, 2, 2, 0]);
    }

    #[test]
    fn basins_stems_and_lengths() {
        let d = forest();
        let basin = d.basins_by_size(|i| i == 1);
        assert_eq!((basin[0], basin[14], basin[12], basin[1]), (1, 1, 1, 0));
        assert_eq!((basin[3], basin[9], basin[13]), (2, 3, 6));
        // Where the sea begins at the outlet the basin ends before it.
        assert_eq!(d.basins_by_size(|i| i == 12)[7], 1);
        let donors = d.main_donors(&d.area_m2());
        assert_eq!(d.main_stem(&donors, 12), [12, 7, 6, 0]);
        let way = d.longest_way_m();
        assert!((way[12] - (2.0 + std::f64::consts::SQRT_2)).abs() < 1e-12, "{}", way[12]);
    }
}
