//! Numbers of the river network: a forest of cells, each draining to its receiver.
//!
//! Depressions are filled for routing; heights and slopes are read from the ground as it is. What flows in the sea is
//! not counted. A channel is a cell whose catchment is at least the threshold: 1 km², or 20 cells where cells are so
//! large that fewer would decide where a channel begins.

mod chi;
mod exceedance;
mod hack;
mod horton;
mod slope_area;

pub use chi::{Chi, THETA_REF, chi};
pub use exceedance::{Exceedance, exceedance};
pub use hack::{Hack, hack};
pub use horton::{Horton, OrderRow, horton};
pub use slope_area::{SlopeArea, slope_area, slope_area_points};

use crate::{
    flow::{self, Drainage},
    grid::{Field, Grid},
};

/// Catchment at which a channel begins, m², where cells are small.
pub const CHANNEL_M2: f64 = 1e6;
/// Cells that a channel's catchment has at least.
pub const CHANNEL_CELLS: f64 = 20.0;
/// Laws of size are fitted up to this share of the largest catchment.
const TRUNKS: f64 = 0.05;
/// No mouth: a cell of the sea.
const NONE: u32 = u32::MAX;

/// A forest of flow, and the ground it flows over.
pub struct Network {
    /// The cell that each cell drains to; its own index at an outlet.
    pub receiver: Vec<u32>,
    /// All cells, each after its receiver.
    pub order: Vec<u32>,
    /// Length from a cell to its receiver, m.
    pub step_m: Vec<f64>,
    /// Catchment area, m².
    pub area_m2: Vec<f64>,
    /// Height of the ground, m.
    pub height_m: Vec<f64>,
    /// Height with depressions filled, m.
    pub surface_m: Vec<f64>,
    /// Cells above the sea.
    pub land: Vec<bool>,
    /// Area of a cell, m².
    pub cell_m2: f64,
    /// Catchment at which a channel begins, m².
    pub threshold_m2: f64,
}

impl Network {
    /// Routes a ground to the sea and, where the map is open, over its rim.
    pub fn of(height: &Field<f32>, sea_level_m: f64) -> Self {
        let grid = height.grid;
        let height_m: Vec<f64> = height.data.iter().map(|&h| h as f64).collect();
        let drainage = Drainage::of(grid, &height_m, &flow::outlets(height, sea_level_m));
        let land = height_m.iter().map(|&h| h > sea_level_m).collect();
        let step_m = (0..grid.cells()).map(|i| drainage.step_m(i)).collect();
        let area_m2 = drainage.area_m2();
        let Drainage { receiver, order, surface_m, .. } = drainage;
        let cell_m2 = grid.cell_area_m2();
        Self { receiver, order, step_m, area_m2, height_m, surface_m, land, cell_m2, threshold_m2: threshold_m2(grid) }
    }

    /// The receiver of a cell, if its water goes on over land.
    pub fn below(&self, i: usize) -> Option<usize> {
        let r = self.receiver[i] as usize;
        (r != i && self.land[r]).then_some(r)
    }

    /// Whether a channel runs through a cell.
    pub fn is_channel(&self, i: usize) -> bool {
        self.land[i] && self.area_m2[i] >= self.threshold_m2
    }

    /// Whether routing raised the ground of a cell.
    pub fn is_flooded(&self, i: usize) -> bool {
        self.surface_m[i] > self.height_m[i]
    }

    /// The last cell on land that each cell's water passes; `None` in the sea.
    pub fn mouths(&self) -> Vec<Option<u32>> {
        let mut mouth = vec![NONE; self.receiver.len()];
        for &i in &self.order {
            let i = i as usize;
            if self.land[i] {
                mouth[i] = self.below(i).map_or(i as u32, |r| mouth[r]);
            }
        }
        mouth.into_iter().map(|m| (m != NONE).then_some(m)).collect()
    }

    /// Length of channels over area of land, km/km².
    pub fn density_km_per_km2(&self) -> Option<f64> {
        let (mut length_m, mut land) = (0.0, 0usize);
        for i in 0..self.receiver.len() {
            land += usize::from(self.land[i]);
            length_m += if self.is_channel(i) { self.step_m[i] } else { 0.0 };
        }
        (land > 0).then(|| length_m * 1e-3 / (land as f64 * self.cell_m2 * 1e-6))
    }

    /// Share of the channel cells whose water reaches the sea, the rim or a lake without ever flowing uphill over the
    /// ground as it is.
    pub fn arriving_share(&self, lake_depth: Option<&Field<f32>>) -> Option<f64> {
        let lake = |i: usize| lake_depth.is_some_and(|depth| depth.data[i] > 0.0);
        let (mut arrives, mut channels, mut good) = (vec![true; self.receiver.len()], 0usize, 0usize);
        for &i in &self.order {
            let i = i as usize;
            arrives[i] = self.below(i).is_none_or(|r| lake(i) || arrives[r] && self.height_m[i] >= self.height_m[r]);
            channels += usize::from(self.is_channel(i));
            good += usize::from(self.is_channel(i) && arrives[i]);
        }
        (channels > 0).then(|| good as f64 / channels as f64)
    }
}

/// Catchment at which a channel begins on a grid, m².
pub fn threshold_m2(grid: Grid) -> f64 {
    CHANNEL_M2.max(CHANNEL_CELLS * grid.cell_area_m2())
}

#[cfg(test)]
pub(super) mod shapes {
    //! Networks whose numbers are known.

    use super::*;

    /// A forest given by its receivers, each cell standing after its receiver, with unit steps; area as counted.
    pub fn forest(receiver: Vec<u32>, area: impl Fn(usize) -> f64) -> Network {
        let n = receiver.len();
        let mut area_m2: Vec<f64> = (0..n).map(area).collect();
        for i in (0..n).rev() {
            let r = receiver[i] as usize;
            if r != i {
                area_m2[r] += area_m2[i];
            }
        }
        Network {
            order: (0..n as u32).collect(),
            step_m: vec![1.0; n],
            area_m2,
            height_m: vec![0.0; n],
            surface_m: vec![0.0; n],
            land: vec![true; n],
            cell_m2: 1.0,
            threshold_m2: 0.5,
            receiver,
        }
    }

    /// Links, each with two links above it, `levels` deep.
    pub fn binary(levels: u32) -> Network {
        forest((0..(1u32 << levels) - 1).map(|i| i.saturating_sub(1) / 2).collect(), |_| 1.0)
    }

    /// Peano's basin: each link becomes two in a row with two side branches in the middle, `times` over.
    pub fn peano(times: u32) -> Network {
        // Links as (lower end, upper end); node 0 is the outlet.
        let (mut links, mut nodes) = (vec![(0u32, 1u32)], 2);
        for _ in 0..times {
            let mut next = Vec::with_capacity(links.len() * 4);
            for (low, high) in links {
                let (middle, left, right) = (nodes, nodes + 1, nodes + 2);
                nodes += 3;
                next.extend([(low, middle), (middle, high), (middle, left), (middle, right)]);
            }
            links = next;
        }
        // A link is the cell at its upper end; number them from the outlet upwards.
        let mut above = vec![Vec::new(); nodes as usize];
        links.iter().for_each(|&(low, high)| above[low as usize].push(high));
        let (mut receiver, mut queue) = (vec![], std::collections::VecDeque::from([(above[0][0], 0u32)]));
        while let Some((node, below)) = queue.pop_front() {
            let me = receiver.len() as u32;
            receiver.push(below);
            queue.extend(above[node as usize].iter().map(|&high| (high, me)));
        }
        forest(receiver, |_| 1.0)
    }

    /// Scheidegger's network: on each row of a lattice that closes on itself, water steps down-left or down-right by the
    /// toss of a coin.
    pub fn scheidegger(width: usize, rows: usize) -> Network {
        let mut state = 0x2545_F491_4F6C_DD1Du64;
        let mut toss = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63
        };
        let receiver = (0..width * rows).map(|i| {
            let (x, y) = (i % width, i / width);
            let step = toss() as usize;
            if y == 0 { i as u32 } else { ((y - 1) * width + (x + step) % width) as u32 }
        });
        forest(receiver.collect(), |_| 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    #[test]
    fn a_ramp_drains_in_parallel_to_the_sea() {
        let grid = Grid::new(40, 10, 40_000.0, Edges::Closed);
        let ramp = Field::from_fn(grid, |x, _| x as f32 * 10.0 - 95.0);
        let network = Network::of(&ramp, 0.0);
        let mouths = network.mouths();
        assert!((0..400).all(|i| mouths[i].is_some() == (i % 40 >= 10)));
        assert!((0..400).filter(|i| i % 40 >= 10).all(|i| mouths[i] == Some((i - i % 40 + 10) as u32)));
        // Channels begin at the 20th of 30 cells: 11 of 30 km of each row, on 30 km².
        let density = network.density_km_per_km2().unwrap();
        assert!((density - 11.0 / 30.0).abs() < 1e-12, "{density}");
        assert_eq!(network.arriving_share(None), Some(1.0));
    }

    #[test]
    fn a_dam_stops_a_river_unless_a_lake_stands_behind_it() {
        let grid = Grid::new(60, 5, 60_000.0, Edges::Closed);
        // A row of cells each, walls between them, and a dam at x = 20.
        let wall = |y: usize| if y == 2 { 0.0 } else { 1e4 };
        let dam = Field::from_fn(grid, |x, y| wall(y) + if x == 20 { 300.0 } else { x as f32 * 10.0 - 45.0 });
        let network = Network::of(&dam, 0.0);
        assert!(network.arriving_share(None).unwrap() < 0.6);
        let lake: Vec<f32> = (0..300).map(|i| (network.surface_m[i] - network.height_m[i]).max(0.0) as f32).collect();
        assert_eq!(network.arriving_share(Some(&Field { grid, data: lake })), Some(1.0));
    }
}
