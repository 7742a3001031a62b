//! Where particles are and how fast they go, in flat arrays.

use rayon::prelude::*;

use super::RUN;

/// Positions, m, and velocities, m/s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// To the east.
    pub x: Vec<f32>,
    /// To the south.
    pub y: Vec<f32>,
    /// Up.
    pub z: Vec<f32>,
    /// Velocity to the east.
    pub vx: Vec<f32>,
    /// Velocity to the south.
    pub vy: Vec<f32>,
    /// Velocity up.
    pub vz: Vec<f32>,
}

impl Cloud {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// One particle more.
    pub fn push(&mut self, at: [f32; 3], velocity: [f32; 3]) {
        for (values, value) in self.arrays_mut().into_iter().zip([at, velocity].concat()) {
            values.push(value);
        }
    }

    /// The six arrays: position, then velocity.
    pub fn arrays(&self) -> [&Vec<f32>; 6] {
        [&self.x, &self.y, &self.z, &self.vx, &self.vy, &self.vz]
    }

    /// The six arrays to be written to; they have to keep one length.
    pub fn arrays_mut(&mut self) -> [&mut Vec<f32>; 6] {
        [&mut self.x, &mut self.y, &mut self.z, &mut self.vx, &mut self.vy, &mut self.vz]
    }

    /// Puts the particles `order` in that order, and drops those that it does not name.
    pub fn reorder(&mut self, order: &[u32], spare: &mut Vec<f32>) {
        for values in self.arrays_mut() {
            gather(values, order, spare);
        }
    }
}

/// Replaces `values` by `values[order]`; `spare` is used in between.
pub fn gather<T: Copy + Default + Send + Sync>(values: &mut Vec<T>, order: &[u32], spare: &mut Vec<T>) {
    spare.clear();
    spare.resize(order.len(), T::default());
    spare.par_chunks_mut(16 * RUN).zip(order.par_chunks(16 * RUN)).for_each(|(to, from)| {
        for (to, &from) in to.iter_mut().zip(from) {
            *to = values[from as usize];
        }
    });
    std::mem::swap(values, spare);
}
