//! What passes from particle to particle by conduction, and where a liquid ends.
//!
//! In `f64`, and the same product for both of a pair, so that what one gains is to the last bit what the other loses.

use rayon::prelude::*;

use super::{Cloud, Domain, Kernel, Lists, RUN, Scale};

/// A particle among its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Around {
    /// `Σ V/(n_i·n_j)·2·(u_j − u_i)·|∇W|/r`: the Laplacian of what diffuses (Cleary and Monaghan 1999), times 1/m².
    pub laplacian: f64,
    /// `Σ V·∇W`: it points into the liquid, and its length is the share of a surface that a metre of depth has, 1/m.
    pub inward: [f32; 3],
    /// Whether someone is higher than it and less than a radius (a ball of its volume) beside it.
    pub covered: bool,
}

/// Looks at the neighbours of every particle: `values` diffuse, `thin` is `1/n`.
pub fn look_around<K: Kernel>(
    cloud: &Cloud,
    lists: &Lists,
    (domain, scale): (Domain, &Scale),
    (values, thin): (&[f64], &[f32]),
    out: &mut Vec<Around>,
) {
    let n = lists.particles();
    assert!(cloud.len() == n && values.len() == n && thin.len() == n);
    out.resize(n, Around::default());
    let (h, beside) = (scale.h_m, 0.62 * scale.spacing_m);
    let weight = scale.volume_m3 / (h * h * h * h * h);
    out.par_chunks_mut(RUN).enumerate().for_each(|(r, run)| {
        for (k, out) in run.iter_mut().enumerate() {
            let i = r * RUN + k;
            let mut sum = Around::default();
            for j in lists.of(i) {
                let way = domain.nearest([cloud.x[i] - cloud.x[j], cloud.y[i] - cloud.y[j], cloud.z[i] - cloud.z[j]]);
                let level = way[0] * way[0] + way[1] * way[1];
                let slope = weight * K::slope((level + way[2] * way[2]).sqrt() / h);
                sum.laplacian += f64::from(-2.0 * slope * (thin[i] * thin[j])) * (values[j] - values[i]);
                for (inward, way) in sum.inward.iter_mut().zip(way) {
                    *inward += slope * way;
                }
                sum.covered |= way[2] < 0.0 && level < beside * beside;
            }
            *out = sum;
        }
    });
}
