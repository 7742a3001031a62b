//! Viscosity that is too stiff to follow: the velocities that it leaves, all at once.
//!
//! `(1 + dt·(D + R))·v = v*` with `R` of [`Rubbing`] and `D` a drag on each particle. All masses are equal and every pair's
//! weight serves both, so the matrix is symmetric, and positive because no weight is negative; it is never written down. Conjugate gradients with its
//! diagonal, the three axes at once, sums in one order.

use rayon::prelude::*;

use super::{Diagonal, Domain, Kernel, Lists, RUN, Rubbing, Scale, sum_pairs};

/// Most steps of a solution: more than lava of any recipe has needed, so that what cannot be solved does not hang.
const MOST_STEPS: usize = 200;

/// What solving needs besides its answer.
#[derive(Clone, Debug, Default)]
pub struct Implicit {
    diagonal: Vec<[f32; 1]>,
    rubbed: Vec<[f32; 3]>,
    /// What is left to explain.
    rest: Vec<[f32; 3]>,
    /// The way, and `n²/ν` beside it.
    way: Vec<[f32; 4]>,
    /// Steps of the last solution.
    pub steps: usize,
}

/// The liquid that rubs.
#[derive(Clone, Copy, Debug)]
pub struct Stiff<'a> {
    /// Sizes.
    pub scale: Scale,
    /// Where.
    pub domain: Domain,
    /// Places, four numbers each; the last is not looked at.
    pub place: &'a [[f32; 4]],
    /// `n²/ν`, s/m².
    pub resist: &'a [f32],
    /// Drag of each one, 1/s.
    pub drag: &'a [f32],
    /// Length of the step, s.
    pub dt: f32,
}

impl Implicit {
    /// Replaces the velocities before viscosity by those after it, to `tolerance` of what they were.
    pub fn solve<K: Kernel>(&mut self, stiff: &Stiff, lists: &Lists, v: &mut [[f32; 3]], tolerance: f64) {
        let n = v.len();
        let Stiff { scale, domain, place, resist, drag, dt } = *stiff;
        let Self { diagonal, rubbed, rest, way, steps } = self;
        let space = (domain, scale.h_m);
        rest.resize(n, [0.0; 3]);
        way.clear();
        way.extend(v.iter().zip(resist).map(|(v, &resist)| [v[0], v[1], v[2], resist]));
        sum_pairs(Diagonal::<K>::new(&scale), [place, way], lists, space, diagonal);
        for (diagonal, drag) in diagonal.iter_mut().zip(drag) {
            diagonal[0] = 1.0 + dt * (drag + diagonal[0]);
        }
        // From the velocities before it: they explain all but what viscosity does.
        sum_pairs(Rubbing::<K>::new(&scale), [place, way], lists, space, rubbed);
        for i in 0..n {
            rest[i] = [0, 1, 2].map(|a| -dt * (rubbed[i][a] + drag[i] * v[i][a]));
            let [x, y, z] = rest[i].map(|r| r / diagonal[i][0]);
            way[i] = [x, y, z, resist[i]];
        }
        let weighed = |rest: &[[f32; 3]], diagonal: &[[f32; 1]]| {
            sums(n, |i| rest[i].map(|r| f64::from(r) * f64::from(r) / f64::from(diagonal[i][0])))
        };
        // What is left to explain, stretched as the last step below stretches it.
        let stretched = |rest: &[[f32; 3]], diagonal: &[[f32; 1]]| {
            let squares = sums(n, |i| {
                let by = f64::from(diagonal[i][0]);
                rest[i].map(|r| by * f64::from(r) * (by * f64::from(r)))
            });
            squares.iter().sum::<f64>()
        };
        let mut size = weighed(rest, diagonal);
        let whole = sums(n, |i| v[i].map(|v| f64::from(v) * f64::from(v)));
        let enough = tolerance * tolerance * whole.iter().sum::<f64>();
        *steps = 0;
        let mut found = stretched(rest, diagonal) <= enough;
        while *steps < MOST_STEPS && !found {
            *steps += 1;
            sum_pairs(Rubbing::<K>::new(&scale), [place, way], lists, space, rubbed);
            rubbed.par_chunks_mut(RUN).enumerate().for_each(|(r, run)| {
                for (k, rubbed) in run.iter_mut().enumerate() {
                    let i = r * RUN + k;
                    *rubbed = [0, 1, 2].map(|a| way[i][a] + dt * (rubbed[a] + drag[i] * way[i][a]));
                }
            });
            let along = sums(n, |i| [0, 1, 2].map(|a| f64::from(way[i][a]) * f64::from(rubbed[i][a])));
            let go = [0, 1, 2].map(|a| if along[a] > 0.0 { (size[a] / along[a]) as f32 } else { 0.0 });
            for i in 0..n {
                for a in 0..3 {
                    v[i][a] += go[a] * way[i][a];
                    rest[i][a] -= go[a] * rubbed[i][a];
                }
            }
            let left = weighed(rest, diagonal);
            let keep = [0, 1, 2].map(|a| if size[a] > 0.0 { (left[a] / size[a]) as f32 } else { 0.0 });
            for i in 0..n {
                for a in 0..3 {
                    way[i][a] = rest[i][a] / diagonal[i][0] + keep[a] * way[i][a];
                }
            }
            size = left;
            found = stretched(rest, diagonal) <= enough;
        }
        if found {
            // What is left to explain, taken as it is: these are the velocities that the pairs' own forces leave, and those
            // keep momentum, however far the solution went.
            for (v, rest) in v.iter_mut().zip(rest) {
                for a in 0..3 {
                    v[a] += rest[a];
                }
            }
        }
    }
}

/// Three sums over all particles, in one order.
fn sums(n: usize, of: impl Fn(usize) -> [f64; 3] + Sync) -> [f64; 3] {
    let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let runs: Vec<[f64; 3]> = (0..n.div_ceil(RUN))
        .into_par_iter()
        .map(|r| (r * RUN..n.min((r + 1) * RUN)).map(&of).fold([0.0; 3], add))
        .collect();
    runs.into_iter().fold([0.0; 3], add)
}
