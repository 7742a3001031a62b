//! Sums over pairs of what a term makes of two particles: for liquids whose particles differ.
//!
//! The loop is that of `forces`, its inside is given from outside: eight neighbours at a time, always in the same order.

use rayon::prelude::*;

use super::{
    Domain, LANES, Lists, RUN, Reader, Work,
    cells::away,
    forces::{Pairs, eight, total},
    widest,
};

/// What a particle is to a term: place and a number beside it, velocity and a number beside it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Particle {
    /// Place, m.
    pub at: [f32; 3],
    /// The number beside it.
    pub mark: f32,
    /// Velocity, or another vector that is summed.
    pub v: [f32; 3],
    /// The number beside it.
    pub note: f32,
}

/// What a pair adds to `N` sums of the first of the two. It must be 0 for a particle with itself, with which lists are filled
/// up; `of` has to be `#[inline(always)]` and free of branches.
pub trait Term<const N: usize>: Copy + Send + Sync {
    /// `way` leads from the other to the own particle, m; `q` is its length in smoothing lengths.
    fn of(&self, own: &Particle, other: &Particle, way: [f32; 3], q: f32) -> [f32; N];
}

/// Sums a term over the neighbours of every particle. `place` and `flow` are the records of [`Particle`], two of four numbers.
pub fn sum_pairs<const N: usize>(
    term: impl Term<N>,
    [place, flow]: [&[[f32; 4]]; 2],
    lists: &Lists,
    (domain, h_m): (Domain, f32),
    out: &mut Vec<[f32; N]>,
) {
    let n = lists.particles();
    assert!(place.len() == n && flow.len() == n);
    out.resize(n, [0.0; N]);
    (lists.runs().par_iter(), out.par_chunks_mut(RUN)).into_par_iter().enumerate().for_each(|(r, (run, out))| {
        let pairs = Pairs { place, domain, rows: &run.rows, first: r * RUN };
        let per_h = 1.0 / h_m;
        match domain.wrap_m {
            None => widest(Sums::<_, N, false> { pairs, flow, term, per_h, out }),
            Some(_) => widest(Sums::<_, N, true> { pairs, flow, term, per_h, out }),
        }
    });
}

struct Sums<'a, T, const N: usize, const WRAP: bool> {
    pairs: Pairs<'a>,
    flow: &'a [[f32; 4]],
    term: T,
    per_h: f32,
    out: &'a mut [[f32; N]],
}

impl<T: Term<N>, const N: usize, const WRAP: bool> Work for Sums<'_, T, N, WRAP> {
    type Out = ();

    #[inline(always)]
    fn run<R: Reader>(self) {
        let Self { pairs: Pairs { place, domain, rows, first }, flow, term, per_h, out } = self;
        let [wx, wy] = domain.wrap_m.unwrap_or_default();
        for (k, out) in out.iter_mut().enumerate() {
            let ([x, y, z, mark], [vx, vy, vz, note]) = (place[first + k], flow[first + k]);
            let own = Particle { at: [x, y, z], mark, v: [vx, vy, vz], note };
            let mut sums = [[0.0; LANES]; N];
            for js in rows.of(k).as_chunks().0 {
                let ([xs, ys, zs, marks], [us, vs, ws, notes]) = (eight::<R>(place, js), eight::<R>(flow, js));
                for l in 0..LANES {
                    let way = [away::<WRAP>(x, xs[l], wx), away::<WRAP>(y, ys[l], wy), z - zs[l]];
                    let q = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt() * per_h;
                    let at = [xs[l], ys[l], zs[l]];
                    let other = Particle { at, mark: marks[l], v: [us[l], vs[l], ws[l]], note: notes[l] };
                    let adds = term.of(&own, &other, way, q);
                    for n in 0..N {
                        sums[n][l] += adds[n];
                    }
                }
            }
            *out = sums.map(total);
        }
    }
}
