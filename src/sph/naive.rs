//! The loop over all pairs: what lists of neighbours have to give, and what they spare.

use super::{Cloud, Domain};

/// The others nearer than a radius of every particle, in ascending order, by looking at all of them: on one thread, for
/// comparison alone.
pub fn naive_neighbours(cloud: &Cloud, domain: Domain, radius_m: f32) -> Vec<Vec<u32>> {
    let near = |i: usize, j: usize| {
        let [x, y, z] = domain.nearest([cloud.x[i] - cloud.x[j], cloud.y[i] - cloud.y[j], cloud.z[i] - cloud.z[j]]);
        x * x + y * y + z * z < radius_m * radius_m
    };
    let of = |i: usize| (0..cloud.len()).filter(|&j| j != i && near(i, j)).map(|j| j as u32).collect();
    (0..cloud.len()).map(of).collect()
}
