//! A cloud that lives: particles are born, carry something, grow old, are sorted by cell, and go.

use super::{Cells, Cloud, Domain, Lists, gather};
use crate::grid::{Edges, Grid};

/// Particles with what each carries, sorted into cells, and the lists of their neighbours.
#[derive(Clone, Debug, Default)]
pub struct Swarm {
    /// The space they live in.
    pub domain: Domain,
    /// Where they are and how fast.
    pub cloud: Cloud,
    /// A clock of each, s: its age, or what is left of its life.
    pub clock_s: Vec<f32>,
    /// What each carries, in `f64`: it is kept to the last bit.
    pub load: Vec<f64>,
    /// How many came before it: names it for good.
    pub born: Vec<u64>,
    /// Neighbours, as of the last [`Self::meet`].
    pub lists: Lists,
    cells: Cells,
    order: Vec<u32>,
    spare: (Vec<f32>, Vec<f64>, Vec<u64>),
}

impl Swarm {
    /// Nobody yet, on a map; `support_m` is how far a kernel reaches.
    pub fn new(grid: &Grid, support_m: f32) -> Self {
        let extent = grid.extent_m().map(|extent| extent as f32);
        // A world so small that a particle would meet itself does not wrap for pairs.
        let wide = extent.iter().all(|&extent| extent > 4.0 * support_m);
        let wrap_m = (grid.edges == Edges::Wrap && wide).then_some(extent);
        Self { domain: Domain { wrap_m }, ..Self::default() }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.cloud.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.cloud.is_empty()
    }

    /// One particle more.
    pub fn add(&mut self, [at, velocity]: [[f32; 3]; 2], clock_s: f32, load: f64, born: u64) {
        self.cloud.push(at, velocity);
        self.clock_s.push(clock_s);
        self.load.push(load);
        self.born.push(born);
    }

    /// Keeps the particles `order`, in that order.
    pub fn reorder(&mut self, order: &[u32]) {
        let (narrow, wide, counts) = &mut self.spare;
        self.cloud.reorder(order, narrow);
        gather(&mut self.clock_s, order, narrow);
        gather(&mut self.load, order, wide);
        gather(&mut self.born, order, counts);
    }

    /// Brings particles back into a map that wraps, and sorts them by cells of at least `radius_m`.
    pub fn sort(&mut self, grid: &Grid, radius_m: f32) {
        if grid.edges == Edges::Wrap {
            let extent = grid.extent_m().map(|extent| extent as f32);
            for (values, extent) in [(&mut self.cloud.x, extent[0]), (&mut self.cloud.y, extent[1])] {
                for value in values.iter_mut().filter(|value| **value < 0.0 || **value >= extent) {
                    let back = *value - extent * (*value / extent).floor();
                    *value = if back < extent { back.max(0.0) } else { 0.0 };
                }
            }
        }
        let mut order = std::mem::take(&mut self.order);
        self.cells.sort([&self.cloud.x, &self.cloud.y, &self.cloud.z], radius_m, self.domain, &mut order);
        self.reorder(&order);
        self.order = order;
    }

    /// Makes the lists of all within `radius_m` of each, no more than it was sorted by; right after [`Self::sort`].
    pub fn meet(&mut self, radius_m: f32) {
        self.lists.make(&self.cells, &self.cloud, radius_m);
    }

    /// Whether somebody is within `radius_m`, no more than it was sorted by, of a place; right after [`Self::sort`].
    pub fn any_within(&self, place: [f32; 3], radius_m: f32) -> bool {
        self.cells.any_within([&self.cloud.x, &self.cloud.y, &self.cloud.z], place, radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_particles_carry_goes_with_them() {
        let grid = Grid::new(8, 8, 64.0, Edges::Wrap);
        let mut swarm = Swarm::new(&grid, 2.0);
        for k in 0..40u64 {
            // Every other one has left over the east and comes back in the west.
            let x = if k.is_multiple_of(2) { 63.0 - k as f32 } else { 64.5 + k as f32 };
            swarm.add([[x, 5.0, k as f32], [k as f32, 0.0, 0.0]], k as f32, k as f64, k);
        }
        swarm.sort(&grid, 3.0);
        assert_eq!(swarm.len(), 40);
        let mut seen = swarm.born.clone();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..40) && !swarm.born.is_sorted());
        for i in 0..40 {
            let k = swarm.born[i];
            let x = if k.is_multiple_of(2) { 63.0 - k as f32 } else { 0.5 + k as f32 };
            let cloud = &swarm.cloud;
            let own = [cloud.x[i], cloud.z[i], cloud.vx[i], swarm.clock_s[i], swarm.load[i] as f32];
            assert_eq!(own, [x, k as f32, k as f32, k as f32, k as f32]);
        }
        swarm.reorder(&[7, 3]);
        assert_eq!((swarm.len(), swarm.clock_s.len(), swarm.load.len(), swarm.born.len()), (2, 2, 2, 2));
    }
}
