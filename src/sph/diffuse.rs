//! What passes from particle to particle by conduction, and where a liquid ends.
//!
//! In `f64`, and the same product for both of a pair, so that what one gains is to the last bit what the other loses.

use std::marker::PhantomData;

use rayon::prelude::*;

use super::{
    Cloud, Domain, Kernel, LANES, Lists, RUN, Reader, Scale, Work,
    cells::away,
    forces::{Pairs, check, eight, pack, total},
    widest,
};

/// Radius of a ball of a particle's volume, in spacings.
const BESIDE: f32 = 0.62;

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
    check(cloud, lists);
    assert!(values.len() == n && thin.len() == n);
    out.resize(n, Around::default());
    let mut place = Vec::new();
    pack(&mut place, [&cloud.x, &cloud.y, &cloud.z, thin]);
    (lists.runs().par_iter(), out.par_chunks_mut(RUN)).into_par_iter().enumerate().for_each(|(r, (run, out))| {
        let pairs = Pairs { place: &place, domain, rows: &run.rows, first: r * RUN };
        match domain.wrap_m {
            None => widest(Look::<K, false> { pairs, scale, values, out, kernel: PhantomData }),
            Some(_) => widest(Look::<K, true> { pairs, scale, values, out, kernel: PhantomData }),
        }
    });
}

struct Look<'a, K, const WRAP: bool> {
    pairs: Pairs<'a>,
    scale: &'a Scale,
    values: &'a [f64],
    out: &'a mut [Around],
    kernel: PhantomData<K>,
}

impl<K: Kernel, const WRAP: bool> Work for Look<'_, K, WRAP> {
    type Out = ();

    #[inline(always)]
    fn run<R: Reader>(self) {
        let Self { pairs: Pairs { place, domain, rows, first }, scale, values, out, .. } = self;
        let [wx, wy] = domain.wrap_m.unwrap_or_default();
        let (h, beside) = (scale.h_m, BESIDE * scale.spacing_m);
        let (per_h, weight, beside2) = (1.0 / h, scale.volume_m3 / (h * h * h * h * h), beside * beside);
        for (k, out) in out.iter_mut().enumerate() {
            let ([x, y, z, thin], value) = (place[first + k], values[first + k]);
            let mut laplacian = [0.0f64; LANES];
            let (mut ax, mut ay, mut az) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            let mut above = [0u32; LANES];
            for js in rows.of(k).as_chunks().0 {
                let [xs, ys, zs, thins] = eight::<R>(place, js);
                let mut theirs = [0.0f64; LANES];
                for l in 0..LANES {
                    theirs[l] = values[js[l] as usize];
                }
                // The particle itself, with which lists are filled up, is 0 away and as hot: it adds nothing.
                for l in 0..LANES {
                    let (dx, dy) = (away::<WRAP>(x, xs[l], wx), away::<WRAP>(y, ys[l], wy));
                    let dz = z - zs[l];
                    let level = dx * dx + dy * dy;
                    let slope = weight * K::slope((level + dz * dz).sqrt() * per_h);
                    laplacian[l] += f64::from(-2.0 * slope * (thin * thins[l])) * (theirs[l] - value);
                    ax[l] += slope * dx;
                    ay[l] += slope * dy;
                    az[l] += slope * dz;
                    above[l] |= u32::from((dz < 0.0) & (level < beside2));
                }
            }
            let [a, b, c, d] = [0, 1, 2, 3].map(|l| laplacian[l] + laplacian[l + 4]);
            *out = Around {
                laplacian: (a + c) + (b + d),
                inward: [total(ax), total(ay), total(az)],
                covered: above != [0; LANES],
            };
        }
    }
}
