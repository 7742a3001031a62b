//! From what pulls to where everyone is next.

use rayon::prelude::*;

use super::{choices::Contact, engine::Most};
use crate::{
    grid::Mesh,
    sph::{Cloud, RUN, Touch, Weights},
};

/// Velocities at the end of a step, without the ground: the drag of the ground is taken implicitly, it brakes and never turns
/// around. `pulls` at the beginning and, for schemes that look twice, half a step ahead.
pub(super) fn fresh_speeds(
    cloud: &Cloud,
    pulls: [&[[f32; 3]]; 2],
    drag: Option<&[f32]>,
    (weights, dt): (&Weights, f32),
    fresh: &mut Vec<[f32; 3]>,
) {
    fresh.resize(cloud.len(), [0.0; 3]);
    fresh.par_chunks_mut(RUN).enumerate().for_each(|(r, run)| {
        for (k, fresh) in run.iter_mut().enumerate() {
            let i = r * RUN + k;
            let (a, b) = (pulls[0][i], pulls[1].get(i).copied().unwrap_or_default());
            let v = [cloud.vx[i], cloud.vy[i], cloud.vz[i]];
            let slower = 1.0 / (1.0 + dt * drag.map_or(0.0, |drag| drag[i]));
            *fresh = [0, 1, 2].map(|axis| slower * weights.speed(v[axis], [a[axis], b[axis]], dt));
        }
    });
}

/// Everyone half a step ahead, as an explicit half step finds it; the ground does not stop it.
pub(super) fn half_ahead(cloud: &Cloud, pull: &[[f32; 3]], drag: Option<&[f32]>, dt: f32, half: &mut Cloud) {
    half.clone_from(cloud);
    let ahead = 0.5 * dt;
    for i in 0..cloud.len() {
        let slower = 1.0 / (1.0 + ahead * drag.map_or(0.0, |drag| drag[i]));
        half.x[i] += ahead * cloud.vx[i];
        half.y[i] += ahead * cloud.vy[i];
        half.z[i] += ahead * cloud.vz[i];
        half.vx[i] = slower * (cloud.vx[i] + ahead * pull[i][0]);
        half.vy[i] = slower * (cloud.vy[i] + ahead * pull[i][1]);
        half.vz[i] = slower * (cloud.vz[i] + ahead * pull[i][2]);
    }
}

/// A step of everyone's place.
pub(super) struct Stride<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) contact: Contact,
    pub(super) touch: Touch,
    /// Friction along the ground over onto it, where lava slips.
    pub(super) friction: f32,
    pub(super) walls: Option<[f32; 2]>,
    /// A speed that nobody exceeds, m/s.
    pub(super) top: f32,
    pub(super) weights: Weights,
    pub(super) dt: f32,
    /// Where everyone was when the lists were made.
    pub(super) from: [&'a [f32]; 3],
    /// Everyone half a step ahead, for schemes that look twice.
    pub(super) half: &'a Cloud,
    /// What the ground's pressure gives, m/s².
    pub(super) off: &'a [f32],
    /// Velocities at the end.
    pub(super) fresh: &'a [[f32; 3]],
}

impl Stride<'_> {
    /// Takes it.
    pub(super) fn go(&self, cloud: &mut Cloud) -> Most {
        let Cloud { x, y, z, vx, vy, vz } = cloud;
        let place = (x.par_chunks_mut(RUN), y.par_chunks_mut(RUN), z.par_chunks_mut(RUN));
        let speed = (vx.par_chunks_mut(RUN), vy.par_chunks_mut(RUN), vz.par_chunks_mut(RUN));
        (place.0, place.1, place.2, speed.0, speed.1, speed.2)
            .into_par_iter()
            .enumerate()
            .map(|(r, (x, y, z, vx, vy, vz))| {
                let mut most = Most::default();
                for k in 0..x.len() {
                    let i = r * RUN + k;
                    let (old, v) = ([x[k], y[k], z[k]], [vx[k], vy[k], vz[k]]);
                    let (to, v) = self.one(i, old, v);
                    [x[k], y[k], z[k]] = to;
                    [vx[k], vy[k], vz[k]] = v;
                    let way = [0, 1, 2].map(|axis| to[axis] - self.from[axis][i]);
                    let [speed2, way2] = [v, way].map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                    most = most.of(Most { speed2, way2, gap: 0.0, finite: (speed2 + way2).is_finite() });
                }
                most
            })
            .reduce(Most::default, Most::of)
    }

    /// Where a particle is next, and how fast.
    #[inline(always)]
    fn one(&self, i: usize, old: [f32; 3], before: [f32; 3]) -> ([f32; 3], [f32; 3]) {
        let mut v = self.fresh[i];
        let speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        if speed2 > self.top * self.top {
            let less = self.top / speed2.sqrt();
            v = v.map(|v| v * less);
        }
        let half = if self.weights.half > 0.0 { [self.half.vx[i], self.half.vy[i], self.half.vz[i]] } else { [0.0; 3] };
        let mut to = [0, 1, 2].map(|axis| self.weights.place(old[axis], [before[axis], half[axis], v[axis]], self.dt));
        if let Some(walls) = self.walls {
            for axis in 0..2 {
                let (low, high) = (self.touch.radius, (walls[axis] - self.touch.radius).max(self.touch.radius));
                if to[axis] < low || to[axis] > high {
                    to[axis] = to[axis].clamp(low, high);
                    v[axis] = 0.0;
                }
            }
        }
        match self.contact {
            Contact::Off => (to, v),
            Contact::Document => {
                let foot = self.mesh.foot(to[0], to[1]);
                if to[2] < foot.height { ([to[0], to[1], foot.height], [0.0; 3]) } else { (to, v) }
            }
            Contact::Stick => {
                let (to, v, _) = self.touch.land(self.mesh, old, to, v, self.dt);
                (to, v)
            }
            Contact::Slip => self.slip(i, old, to, v),
        }
    }

    /// Friction by how much the ground held it off.
    fn slip(&self, i: usize, old: [f32; 3], to: [f32; 3], v: [f32; 3]) -> ([f32; 3], [f32; 3]) {
        let (to, after, foot) = self.touch.land(self.mesh, old, to, v, self.dt);
        let n = foot.normal;
        let off = |v: [f32; 3]| v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
        let held = (off(after) - off(v)).max(0.0) + self.dt * self.off[i];
        let along = [0, 1, 2].map(|axis| after[axis] - off(after) * n[axis]);
        let speed = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt();
        let left = if speed > 0.0 { (1.0 - self.friction * held / speed).max(0.0) } else { 0.0 };
        (to, [0, 1, 2].map(|axis| off(after) * n[axis] + left * along[axis]))
    }
}
