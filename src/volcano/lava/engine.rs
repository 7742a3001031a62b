//! What pulls at lava: pressure, viscosity, weight, and the ground.
//!
//! The ground mirrors pressure (the kernel's share below it) and, where lava sticks, speed: half a space of ghosts that move
//! backwards in proportion to their depth drags a particle `g` above it by `2ν/g·∫W` over the plane's slices, which is exact
//! for a flow whose speed grows from 0 in proportion to height.

use rayon::prelude::*;

use crate::{
    grid::Mesh,
    sph::{
        Cloud, Domain, Drawn, Flowing, Forces, Implicit, Kernel, Liquid, Lists, RUN, Shear, Stiff, pack, shear_rate,
        sum_pairs,
    },
};

use super::choices::{Contact, Viscosity};

/// What is the same for all lava and all of a block of steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub(super) domain: Domain,
    pub(super) liquid: Liquid,
    /// Weight, m/s².
    pub(super) gravity: [f32; 3],
    /// Height of the sea, and the share of its weight that lava has in it.
    pub(super) sea: (f32, f32),
    pub(super) pressure: bool,
    pub(super) viscosity: Viscosity,
    pub(super) contact: Contact,
    /// How sharply lava stops (Papanastasiou's m), s; 0: no yield stress.
    pub(super) sharpness_s: f32,
    /// Whether viscosity is left out of the sums, to be solved for.
    pub(super) implicit: bool,
}

/// How stiff each particle is.
#[derive(Clone, Debug, Default)]
pub(super) struct Stiffness {
    /// Kinematic viscosity, m²/s; for the document's the α over the rest density, 1/s.
    pub(super) viscosity: Vec<f32>,
    /// Yield stress over density, m²/s².
    pub(super) yields: Vec<f32>,
}

/// The greatest of what particles do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Most {
    /// Square of a speed, m²/s².
    pub(super) speed2: f32,
    /// Square of the way since the lists were made, m².
    pub(super) way2: f32,
    /// Height over the ground, m.
    pub(super) gap: f32,
    /// Whether every number is one.
    pub(super) finite: bool,
}

impl Default for Most {
    fn default() -> Self {
        Self { speed2: 0.0, way2: 0.0, gap: 0.0, finite: true }
    }
}

impl Most {
    pub(super) fn of(self, other: Self) -> Self {
        Self {
            speed2: self.speed2.max(other.speed2),
            way2: self.way2.max(other.way2),
            gap: self.gap.max(other.gap),
            finite: self.finite && other.finite,
        }
    }
}

/// The sums, and what they need.
#[derive(Clone, Debug, Default)]
pub(super) struct Engine {
    /// Distance from the ground, m; endless where there is none.
    pub(super) gap: Vec<f32>,
    /// Upward normal of the ground.
    pub(super) normal: Vec<[f32; 3]>,
    /// Densities and pressures.
    pub(super) forces: Forces,
    /// Drag of the ground, 1/s.
    pub(super) drag: Vec<f32>,
    /// Speed off the ground that its pressure gave in a second, m/s².
    pub(super) off: Vec<f32>,
    beyond: Vec<f32>,
    resist: Vec<f32>,
    place: Vec<[f32; 4]>,
    flow: Vec<[f32; 4]>,
    pulled: Vec<[f32; 3]>,
    drawn: Vec<[f32; 6]>,
    shear: Vec<[f32; 12]>,
    implicit: Implicit,
}

impl Engine {
    /// Finds the ground under everyone.
    pub(super) fn stand<K: Kernel>(&mut self, cloud: &Cloud, mesh: &Mesh, setting: &Setting) -> Most {
        let n = cloud.len();
        self.gap.resize(n, 0.0);
        self.beyond.resize(n, 0.0);
        self.normal.resize(n, [0.0; 3]);
        let h = setting.liquid.scale.h_m;
        (self.gap.par_chunks_mut(RUN), self.beyond.par_chunks_mut(RUN), self.normal.par_chunks_mut(RUN))
            .into_par_iter()
            .enumerate()
            .map(|(r, (gap, beyond, normal))| {
                let mut most = Most::default();
                for k in 0..gap.len() {
                    let i = r * RUN + k;
                    if setting.contact == Contact::Off {
                        (gap[k], beyond[k], normal[k]) = (f32::INFINITY, 0.0, [0.0, 0.0, 1.0]);
                    } else {
                        let foot = mesh.foot(cloud.x[i], cloud.y[i]);
                        gap[k] = foot.gap(cloud.z[i]);
                        normal[k] = foot.normal;
                        beyond[k] = if setting.contact == Contact::Document { 0.0 } else { K::beyond(gap[k] / h) };
                        most.gap = most.gap.max(gap[k]);
                    }
                    let [a, b, c] = [cloud.vx[i], cloud.vy[i], cloud.vz[i]];
                    most.speed2 = most.speed2.max(a * a + b * b + c * c);
                }
                most
            })
            .reduce(Most::default, Most::of)
    }

    /// What pulls at everyone, m/s², after [`Self::stand`]; what the ground's drag takes is left to the caller.
    pub(super) fn pull<K: Kernel>(
        &mut self,
        (cloud, lists): (&Cloud, &Lists),
        stiffness: &Stiffness,
        setting: &Setting,
        out: &mut Vec<[f32; 3]>,
    ) {
        let n = cloud.len();
        let (domain, liquid) = (setting.domain, &setting.liquid);
        let space = (domain, liquid.scale.h_m);
        self.forces.densities::<K>(cloud, lists, domain, liquid, &self.beyond);
        if !setting.pressure {
            self.forces.push.fill(0.0);
        }
        out.resize(n, [0.0; 3]);
        if setting.viscosity == Viscosity::Document {
            pack(&mut self.place, [&cloud.x, &cloud.y, &cloud.z, &self.forces.push]);
            pack(&mut self.flow, [&cloud.vx, &cloud.vy, &cloud.vz, &self.forces.thin]);
            sum_pairs(Drawn::<K>::new(&liquid.scale), [&self.place, &self.flow], lists, space, &mut self.drawn);
        } else {
            if setting.sharpness_s > 0.0 {
                pack(&mut self.place, [&cloud.x, &cloud.y, &cloud.z, &self.forces.thin]);
                pack(&mut self.flow, [&cloud.vx, &cloud.vy, &cloud.vz, &self.forces.thin]);
                sum_pairs(Shear::<K>::new(&liquid.scale), [&self.place, &self.flow], lists, space, &mut self.shear);
            }
            self.stiffen::<K>(stiffness, setting);
            pack(&mut self.place, [&cloud.x, &cloud.y, &cloud.z, &self.forces.push]);
            let none = vec![f32::INFINITY; if setting.implicit { n } else { 0 }];
            let notes = if setting.implicit { &none } else { &self.resist };
            pack(&mut self.flow, [&cloud.vx, &cloud.vy, &cloud.vz, notes]);
            sum_pairs(Flowing::<K>::new(&liquid.scale), [&self.place, &self.flow], lists, space, &mut self.pulled);
        }
        self.off.resize(n, 0.0);
        let (h, document) = (liquid.scale.h_m, setting.viscosity == Viscosity::Document);
        let mirrors = !matches!(setting.contact, Contact::Off | Contact::Document);
        let Self { gap, normal, forces, pulled, drawn, off, .. } = self;
        (out.par_chunks_mut(RUN), off.par_chunks_mut(RUN)).into_par_iter().enumerate().for_each(|(r, (out, off))| {
            for k in 0..out.len() {
                let i = r * RUN + k;
                off[k] = if mirrors { 2.0 * forces.push[i] * K::beyond_slope(gap[i] / h) / h } else { 0.0 };
                let light = if cloud.z[i] < setting.sea.0 { setting.sea.1 } else { 1.0 };
                out[k] = [0, 1, 2].map(|axis| {
                    let pairs = if document {
                        drawn[i][axis] + stiffness.viscosity[i] * forces.thin[i] * drawn[i][3 + axis]
                    } else {
                        pulled[i][axis]
                    };
                    pairs + off[k] * normal[i][axis] + light * setting.gravity[axis]
                });
            }
        });
    }

    /// How much each resists being rubbed, and the ground's drag.
    fn stiffen<K: Kernel>(&mut self, stiffness: &Stiffness, setting: &Setting) {
        let n = stiffness.viscosity.len();
        self.resist.resize(n, 0.0);
        self.drag.resize(n, 0.0);
        let Self { gap, forces, shear, resist, drag, .. } = self;
        let scale = setting.liquid.scale;
        let (h, least) = (scale.h_m, 0.1 * scale.spacing_m);
        let sticks = setting.contact == Contact::Stick;
        (resist.par_chunks_mut(RUN), drag.par_chunks_mut(RUN)).into_par_iter().enumerate().for_each(
            |(r, (resist, drag))| {
                for k in 0..resist.len() {
                    let i = r * RUN + k;
                    let mut viscosity = stiffness.viscosity[i];
                    if setting.sharpness_s > 0.0 {
                        viscosity += plastic(shear_rate(&shear[i]), stiffness.yields[i], setting.sharpness_s);
                    }
                    resist[k] = forces.density[i] * forces.density[i] / viscosity;
                    let off = gap[i].max(least);
                    let slices = if sticks { K::beyond_slope(off / h) } else { 0.0 };
                    drag[k] = 2.0 * viscosity * forces.thin[i] * slices / (off * h);
                }
            },
        );
    }

    /// Replaces velocities before viscosity by those after it.
    pub(super) fn rub<K: Kernel>(&mut self, lists: &Lists, setting: &Setting, dt: f32, v: &mut [[f32; 3]]) {
        let stiff = Stiff {
            scale: setting.liquid.scale,
            domain: setting.domain,
            place: &self.place,
            resist: &self.resist,
            drag: &self.drag,
            dt,
        };
        self.implicit.solve::<K>(&stiff, lists, v, TOLERANCE);
    }

    /// Whether the ground's drag is to be taken by whoever steps: the solver takes it itself.
    pub(super) fn drags(&self, setting: &Setting) -> bool {
        setting.viscosity == Viscosity::Pairs && setting.contact == Contact::Stick && !setting.implicit
    }
}

/// What solving for viscosity may be off by, as a share of what it changes.
const TOLERANCE: f64 = 1e-3;

/// What a yield stress adds to viscosity at a rate of shear (Papanastasiou 1987), m²/s.
fn plastic(rate: f32, yields: f32, sharpness_s: f32) -> f32 {
    let x = f64::from(rate) * f64::from(sharpness_s);
    // 1 − x/2 for small x.
    let whole = if x < 1e-4 { 1.0 - 0.5 * x } else { -libm::expm1(-x) / x };
    yields * sharpness_s * whole as f32
}
