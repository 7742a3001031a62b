//! Sums over pairs: density, and what pressure, viscosity and cohesion add to velocities.
//!
//! Pressure is the symmetric form, viscosity Morris's: each pair's two shares are equal and opposite, so momentum is kept to
//! the rounding of sums. With `p` the pressure over the rest density and `n` the relative density
//! `a_i = Σ V·[−(p_i/n_i² + p_j/n_j²)·∇W + 2ν/(n_i·n_j)·(x·∇W)/r²·v_ij] − κ·Σ V·W·x`.

use std::{
    hint::{black_box, select_unpredictable},
    marker::PhantomData,
};

use rayon::prelude::*;

use super::{
    Cloud, Domain, Kernel, LANES, Lists, RUN, Scale,
    cells::away,
    neighbours::Rows,
    wide::{Reader, Work, widest},
};

/// What a liquid is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Liquid {
    /// How large its particles are.
    pub scale: Scale,
    /// Speed of sound, m/s: how hard it is to press together.
    pub sound_m_per_s: f32,
    /// Kinematic viscosity ν, m²/s.
    pub viscosity_m2_per_s: f32,
    /// Cohesion κ, 1/s².
    pub cohesion_per_s2: f32,
}

/// Sums over the neighbours of every particle.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// Relative density `n`.
    pub density: Vec<f32>,
    /// `p / n²`, m²/s².
    pub push: Vec<f32>,
    /// `1 / n`.
    pub thin: Vec<f32>,
    /// Accelerations to the east, to the south and up, m/s².
    pub pull: [Vec<f32>; 3],
    /// Place and push side by side, as loops over neighbours read them.
    place: Vec<[f32; 4]>,
    /// Velocity and `1 / n` likewise.
    flow: Vec<[f32; 4]>,
}

impl Forces {
    /// Densities, and the pressure `c²·(n − 1)` that goes with them: 0 where the liquid is thinner than at rest, so that a
    /// free surface does not pull. `beyond` is what walls add to each one's density.
    pub fn densities<K: Kernel>(
        &mut self,
        cloud: &Cloud,
        lists: &Lists,
        domain: Domain,
        liquid: &Liquid,
        beyond: &[f32],
    ) {
        check(cloud, lists);
        let n = cloud.len();
        assert!(beyond.len() == n);
        for values in [&mut self.density, &mut self.push, &mut self.thin] {
            values.resize(n, 0.0);
        }
        pack(&mut self.place, [&cloud.x, &cloud.y, &cloud.z, &cloud.z]);
        let place = &self.place;
        (
            lists.runs().par_iter(),
            beyond.par_chunks(RUN),
            self.density.par_chunks_mut(RUN),
            self.push.par_chunks_mut(RUN),
            self.thin.par_chunks_mut(RUN),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(r, (run, beyond, density, push, thin))| {
                let (pairs, out) = (Pairs { place, domain, rows: &run.rows, first: r * RUN }, [density, push, thin]);
                match domain.wrap_m {
                    None => widest(Densities::<K, false> { pairs, liquid, beyond, out, kernel: PhantomData }),
                    Some(_) => widest(Densities::<K, true> { pairs, liquid, beyond, out, kernel: PhantomData }),
                }
            });
    }

    /// What pressure, viscosity and cohesion add to velocities, after [`Self::densities`]; gravity and walls are the
    /// caller's.
    pub fn accelerations<K: Kernel>(&mut self, cloud: &Cloud, lists: &Lists, domain: Domain, liquid: &Liquid) {
        check(cloud, lists);
        for values in &mut self.pull {
            values.resize(cloud.len(), 0.0);
        }
        pack(&mut self.place, [&cloud.x, &cloud.y, &cloud.z, &self.push]);
        pack(&mut self.flow, [&cloud.vx, &cloud.vy, &cloud.vz, &self.thin]);
        let (place, flow) = (&self.place, &self.flow);
        let [x, y, z] = &mut self.pull;
        (lists.runs().par_iter(), x.par_chunks_mut(RUN), y.par_chunks_mut(RUN), z.par_chunks_mut(RUN))
            .into_par_iter()
            .enumerate()
            .for_each(|(r, (run, x, y, z))| {
                let (pairs, out) = (Pairs { place, domain, rows: &run.rows, first: r * RUN }, [x, y, z]);
                match (domain.wrap_m, liquid.cohesion_per_s2 > 0.0) {
                    (None, false) => {
                        widest(Accelerations::<K, false, false> { pairs, flow, liquid, out, kernel: PhantomData });
                    }
                    (None, true) => {
                        widest(Accelerations::<K, false, true> { pairs, flow, liquid, out, kernel: PhantomData });
                    }
                    // A world that wraps is rare enough to carry cohesion along.
                    (Some(_), _) => {
                        widest(Accelerations::<K, true, true> { pairs, flow, liquid, out, kernel: PhantomData });
                    }
                }
            });
    }
}

/// Puts four arrays of one length side by side.
pub fn pack(records: &mut Vec<[f32; 4]>, values: [&[f32]; 4]) {
    records.resize(values[0].len(), [0.0; 4]);
    records.par_chunks_mut(16 * RUN).enumerate().for_each(|(r, records)| {
        let [a, b, c, d] = values.map(|values| &values[r * 16 * RUN..][..records.len()]);
        for (k, record) in records.iter_mut().enumerate() {
            *record = [a[k], b[k], c[k], d[k]];
        }
    });
}

/// Loops read neighbours without a look at bounds: lists have to be those of the cloud.
pub(super) fn check(cloud: &Cloud, lists: &Lists) {
    assert!(cloud.arrays().iter().all(|values| values.len() == lists.particles()));
}

/// The pairs of a run of particles.
#[derive(Clone, Copy)]
pub(super) struct Pairs<'a> {
    pub(super) place: &'a [[f32; 4]],
    pub(super) domain: Domain,
    pub(super) rows: &'a Rows,
    pub(super) first: usize,
}

/// The records of eight neighbours.
#[inline(always)]
pub(super) fn eight<R: Reader>(records: &[[f32; 4]], at: &[u32; LANES]) -> [[f32; LANES]; 4] {
    debug_assert!(at.iter().all(|&j| (j as usize) < records.len()));
    // SAFETY: lists are made for as many particles as there are records (`check`), name only these, and cannot be written to
    // from outside.
    unsafe { R::read(records, at) }
}

/// The sum of eight lanes, always in the same order.
#[inline(always)]
pub(super) fn total(a: [f32; LANES]) -> f32 {
    let b = [a[0] + a[4], a[1] + a[5], a[2] + a[6], a[3] + a[7]];
    (b[0] + b[2]) + (b[1] + b[3])
}

struct Densities<'a, K, const WRAP: bool> {
    pairs: Pairs<'a>,
    liquid: &'a Liquid,
    beyond: &'a [f32],
    out: [&'a mut [f32]; 3],
    kernel: PhantomData<K>,
}

impl<K: Kernel, const WRAP: bool> Work for Densities<'_, K, WRAP> {
    type Out = ();

    #[inline(always)]
    fn run<R: Reader>(self) {
        let Self { pairs: Pairs { place, domain, rows, first }, liquid, beyond, out: [density, push, thin], .. } = self;
        let [wx, wy] = domain.wrap_m.unwrap_or_default();
        let h = liquid.scale.h_m;
        let (per_h, weight) = (1.0 / h, liquid.scale.volume_m3 / (h * h * h));
        let sound2 = liquid.sound_m_per_s * liquid.sound_m_per_s;
        let own = K::shape(0.0);
        for k in 0..density.len() {
            let [x, y, z, _] = place[first + k];
            let mut sum = [0.0; LANES];
            for js in rows.of(k).as_chunks().0 {
                let [xs, ys, zs, _] = eight::<R>(place, js);
                for l in 0..LANES {
                    let (dx, dy) = (away::<WRAP>(x, xs[l], wx), away::<WRAP>(y, ys[l], wy));
                    let dz = z - zs[l];
                    let square = dx * dx + dy * dy + dz * dz;
                    let w = K::shape(square.sqrt() * per_h);
                    // Lists are filled up with the particle itself.
                    sum[l] += select_unpredictable(square > 0.0, w, 0.0);
                }
            }
            // Behind the black box the sum stays eight wide: told how it is added up, the compiler halves the loop's lanes.
            let n = weight * (total(black_box(sum)) + own) + beyond[k];
            density[k] = n;
            thin[k] = 1.0 / n;
            push[k] = sound2 * (n - 1.0).max(0.0) * thin[k] * thin[k];
        }
    }
}

struct Accelerations<'a, K, const WRAP: bool, const COHESION: bool> {
    pairs: Pairs<'a>,
    flow: &'a [[f32; 4]],
    liquid: &'a Liquid,
    out: [&'a mut [f32]; 3],
    kernel: PhantomData<K>,
}

impl<K: Kernel, const WRAP: bool, const COHESION: bool> Work for Accelerations<'_, K, WRAP, COHESION> {
    type Out = ();

    #[inline(always)]
    fn run<R: Reader>(self) {
        let Self { pairs: Pairs { place, domain, rows, first }, flow, liquid, out: [out_x, out_y, out_z], .. } = self;
        let [wx, wy] = domain.wrap_m.unwrap_or_default();
        let h = liquid.scale.h_m;
        let (per_h, weight) = (1.0 / h, liquid.scale.volume_m3 / (h * h * h * h * h));
        // Both kernels' sums are scaled alike, once at the end.
        let cohesion = liquid.cohesion_per_s2 * h * h;
        for k in 0..out_x.len() {
            let ([x, y, z, own], [vx, vy, vz, thin]) = (place[first + k], flow[first + k]);
            let drag = 2.0 * liquid.viscosity_m2_per_s * thin;
            let (mut ax, mut ay, mut az) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for js in rows.of(k).as_chunks().0 {
                let ([xs, ys, zs, push], [us, vs, ws, thins]) = (eight::<R>(place, js), eight::<R>(flow, js));
                // The particle itself, with which lists are filled up, is 0 away and as fast: it adds nothing.
                for l in 0..LANES {
                    let (dx, dy) = (away::<WRAP>(x, xs[l], wx), away::<WRAP>(y, ys[l], wy));
                    let dz = z - zs[l];
                    let q = (dx * dx + dy * dy + dz * dz).sqrt() * per_h;
                    let slope = K::slope(q);
                    let mut out = -(own + push[l]) * slope;
                    if COHESION {
                        out -= cohesion * K::shape(q);
                    }
                    let along = drag * thins[l] * slope;
                    ax[l] += out * dx + along * (vx - us[l]);
                    ay[l] += out * dy + along * (vy - vs[l]);
                    az[l] += out * dz + along * (vz - ws[l]);
                }
            }
            out_x[k] = weight * total(ax);
            out_y[k] = weight * total(ay);
            out_z[k] = weight * total(az);
        }
    }
}
