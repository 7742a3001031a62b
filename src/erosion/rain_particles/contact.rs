//! The ground as water meets it: the bed as a mesh, its heights counted from the lowest ground.

use std::ops::Deref;

use super::super::bed::Bed;
use crate::grid::Mesh;

/// The ground, ready for particles.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    mesh: Mesh,
    /// Heights are counted from here, so that `f32` resolves a film of water high up, m.
    pub(super) datum_m: f32,
}

impl Ground {
    /// The ground of a bed. Heights count from the lowest ground when the stage began.
    pub(super) fn new(bed: &Bed) -> Self {
        let datum_m = bed.start.iter().fold(f32::INFINITY, |a, &b| a.min(b));
        Self { mesh: Mesh::new(bed.grid, |i| over(bed, datum_m, i)), datum_m }
    }

    /// Reads the heights of some cells anew, and the slopes there and beside.
    pub(super) fn renew(&mut self, bed: &Bed, cells: &[u32]) {
        let datum_m = self.datum_m;
        self.mesh.renew(cells, |i| over(bed, datum_m, i));
    }
}

impl Deref for Ground {
    type Target = Mesh;

    fn deref(&self) -> &Mesh {
        &self.mesh
    }
}

/// Height of a cell over the datum, m.
fn over(bed: &Bed, datum_m: f32, i: usize) -> f32 {
    (bed.start[i] - datum_m) + bed.change[i]
}
