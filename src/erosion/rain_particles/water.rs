//! The water itself: particles, their neighbours, and how they move for a few sub-steps.

use rayon::prelude::*;

use crate::{
    bake::{Frame, Glimpses},
    grid::{Edges, Grid},
    sph::{Cloud, Forces, Kernel, Liquid, RUN, Reader, Scale, Swarm, Touch, WendlandC2, Work, widest},
};

use super::{
    contact::Ground,
    params::{GRAVITY, NUMERIC, RATIO, RainParticlesParams, SOUND},
};

/// How far lists reach beyond the support, in spacings.
const SKIN: f64 = 0.5;
/// Most sub-steps of a block: the bed rests and nobody is born or lost meanwhile.
const MOST_STEPS: usize = 12;
/// How much of its speed of sound water keeps from block to block when it calms down.
const FADE: f64 = 0.95;

/// Particles of water.
pub(super) struct Water {
    params: RainParticlesParams,
    grid: Grid,
    spacing: f64,
    touch: Touch,
    liquid: Liquid,
    /// Speed of sound of the last block, m/s.
    pub(super) sound: f64,
    /// Sub-steps, and steps of single particles, since it was made.
    pub(super) work: [u64; 2],
    /// The particles: their clocks are what is left of their lives, their loads the rock that they carry, in m³ of bed.
    pub(super) swarm: Swarm,
    /// What a recording sees of it.
    pub(super) glimpses: Glimpses,
    /// Distance from the ground, m.
    pub(super) gap: Vec<f32>,
    normal: [Vec<f32>; 3],
    beyond: Vec<f32>,
    forces: Forces,
}

/// The greatest of what particles did in a sub-step.
#[derive(Clone, Copy, Debug, Default)]
struct Most {
    /// Square of a speed, m²/s².
    speed2: f32,
    /// Square of the way since the lists were made, m².
    way2: f32,
    /// Height over the ground, m.
    gap: f32,
}

impl Most {
    fn of(self, other: Self) -> Self {
        Self { speed2: self.speed2.max(other.speed2), way2: self.way2.max(other.way2), gap: self.gap.max(other.gap) }
    }
}

impl Water {
    /// No water yet.
    pub(super) fn new(params: &RainParticlesParams, grid: Grid) -> Self {
        let spacing = params.spacing(&grid);
        let scale = Scale::new::<WendlandC2>(spacing, RATIO);
        Self {
            params: params.clone(),
            grid,
            spacing,
            touch: Touch {
                radius: (0.5 * spacing) as f32,
                restitution: params.restitution as f32,
                calm: (0.2 * (GRAVITY * spacing).sqrt()) as f32,
                friction_per_m: (params.friction / spacing) as f32,
                layer: spacing as f32,
            },
            liquid: Liquid {
                scale,
                sound_m_per_s: 0.0,
                viscosity_m2_per_s: 0.0,
                cohesion_per_s2: params.cohesion(RATIO * spacing) as f32,
            },
            sound: 0.0,
            work: [0; 2],
            swarm: Swarm::new(&grid, scale.support_m()),
            glimpses: Glimpses::default(),
            gap: Vec::new(),
            normal: Default::default(),
            beyond: Vec::new(),
            forces: Forces::default(),
        }
    }

    /// Distance of particles at rest, m.
    pub(super) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Volume of one, m³.
    pub(super) fn volume_m3(&self) -> f64 {
        self.spacing * self.spacing * self.spacing
    }

    /// Density over that at rest, as of the last sub-step.
    #[cfg(test)]
    pub(super) fn density(&self) -> &[f32] {
        &self.forces.density
    }

    /// What a recording has besides the place: ages, s, and loads, m³.
    fn age_and_load(&self) -> Vec<Vec<f64>> {
        let lifespan_s = self.params.lifespan_s;
        let ages = self.swarm.clock_s.iter().map(|&left| (lifespan_s - f64::from(left)).max(0.0)).collect();
        vec![ages, self.swarm.load.clone()]
    }

    /// A block begins now, s after the stage did; somebody may look.
    pub(super) fn look(&mut self, now_s: f64) {
        let mut glimpses = std::mem::take(&mut self.glimpses);
        glimpses.open(now_s, || self.age_and_load());
        self.glimpses = glimpses;
    }

    /// The frames that were due in a block that lasted so long.
    pub(super) fn develop(&mut self, lasted_s: f64, datum_m: f32) -> Result<Vec<Frame>, String> {
        let mut glimpses = std::mem::take(&mut self.glimpses);
        let frames = glimpses.develop((lasted_s, datum_m), &self.swarm.born, || self.age_and_load());
        self.glimpses = glimpses;
        frames
    }

    fn radius(&self) -> f32 {
        self.liquid.scale.support_m() + (SKIN * self.spacing) as f32
    }

    /// Brings particles back into a world that wraps and sorts them by cell.
    pub(super) fn sort(&mut self) {
        self.swarm.sort(&self.grid, self.radius());
    }

    /// Moves sorted particles for up to `left_s`: as many sub-steps as one list serves. Gives the time that has passed.
    pub(super) fn block(&mut self, ground: &Ground, left_s: f64) -> f64 {
        let n = self.swarm.len();
        let radius = self.radius();
        self.swarm.meet(radius);
        for values in self.normal.iter_mut().chain([&mut self.gap, &mut self.beyond]) {
            values.resize(n, 0.0);
        }
        let mut most = self.stand(ground);
        let params = &self.params;
        let top = params.most_speed(self.spacing);
        // A fall from where the highest is, or two layers of water at rest.
        let fall = (2.0 * GRAVITY * (most.gap as f64).max(self.spacing)).sqrt();
        self.sound = (SOUND * (most.speed2 as f64).sqrt().max(fall)).max(FADE * self.sound).min(SOUND * top);
        let viscosity = params.viscosity_m2_per_s.max(NUMERIC * RATIO * self.spacing * self.sound);
        self.liquid.sound_m_per_s = self.sound as f32;
        self.liquid.viscosity_m2_per_s = viscosity as f32;
        let (least, half) = (params.least_step_s(self.spacing), 0.5 * SKIN * self.spacing);
        let mut done = 0.0;
        for _ in 0..MOST_STEPS {
            let limit = self.params.step_s(self.spacing, (most.speed2 as f64).sqrt(), self.sound).max(least);
            let left = left_s - done;
            let last = left <= limit;
            let dt = if last { left } else { limit };
            self.work = [self.work[0] + 1, self.work[1] + n as u64];
            self.forces.densities::<WendlandC2>(
                &self.swarm.cloud,
                &self.swarm.lists,
                self.swarm.domain,
                &self.liquid,
                &self.beyond,
            );
            self.forces.accelerations::<WendlandC2>(
                &self.swarm.cloud,
                &self.swarm.lists,
                self.swarm.domain,
                &self.liquid,
            );
            most = self.walk(ground, dt as f32, top as f32);
            done = if last { left_s } else { done + dt };
            let Cloud { x, y, z, vx, vy, vz } = &self.swarm.cloud;
            self.glimpses.pass(done, [x, y, z], [vx, vy, vz]);
            if last || (most.way2 as f64).sqrt() > half {
                break;
            }
        }
        done
    }

    /// Finds the ground under everyone.
    fn stand(&mut self, ground: &Ground) -> Most {
        let cloud = &self.swarm.cloud;
        let [nx, ny, nz] = &mut self.normal;
        (
            self.gap.par_chunks_mut(RUN),
            self.beyond.par_chunks_mut(RUN),
            nx.par_chunks_mut(RUN),
            ny.par_chunks_mut(RUN),
            nz.par_chunks_mut(RUN),
        )
            .into_par_iter()
            .enumerate()
            .map(|(r, (gap, beyond, nx, ny, nz))| {
                let mut most = Most::default();
                for k in 0..gap.len() {
                    let i = r * RUN + k;
                    let foot = ground.foot(cloud.x[i], cloud.y[i]);
                    gap[k] = foot.gap(cloud.z[i]);
                    beyond[k] = WendlandC2::beyond(gap[k] / self.liquid.scale.h_m);
                    [nx[k], ny[k], nz[k]] = foot.normal;
                    let [a, b, c] = [cloud.vx[i], cloud.vy[i], cloud.vz[i]];
                    most = most.of(Most { speed2: a * a + b * b + c * c, way2: 0.0, gap: gap[k] });
                }
                most
            })
            .reduce(Most::default, Most::of)
    }

    /// Velocities, then places, then the ground: symplectic Euler.
    fn walk(&mut self, ground: &Ground, dt: f32, top: f32) -> Most {
        let extent = self.grid.extent_m().map(|extent| extent as f32);
        let walls = (self.grid.edges == Edges::Closed).then_some(extent);
        let [fx, fy, fz] = self.swarm.lists.made_for();
        let from = [fx, fy, fz];
        let pull = [0, 1, 2].map(|axis| &self.forces.pull[axis][..]);
        let (touch, h, push) = (self.touch, self.liquid.scale.h_m, &self.forces.push[..]);
        let Cloud { x, y, z, vx, vy, vz } = &mut self.swarm.cloud;
        let [nx, ny, nz] = &mut self.normal;
        let place = (x.par_chunks_mut(RUN), y.par_chunks_mut(RUN), z.par_chunks_mut(RUN));
        let speed = (vx.par_chunks_mut(RUN), vy.par_chunks_mut(RUN), vz.par_chunks_mut(RUN));
        let normal = (nx.par_chunks_mut(RUN), ny.par_chunks_mut(RUN), nz.par_chunks_mut(RUN));
        let near = (self.gap.par_chunks_mut(RUN), self.beyond.par_chunks_mut(RUN));
        (place.0, place.1, place.2, speed.0, speed.1, speed.2, normal.0, normal.1, normal.2, near.0, near.1)
            .into_par_iter()
            .enumerate()
            .map(|(r, (x, y, z, vx, vy, vz, nx, ny, nz, gap, beyond))| {
                let run = Walk { place: [x, y, z], speed: [vx, vy, vz], normal: [nx, ny, nz], gap, beyond };
                widest(Stride { run, first: r * RUN, from, pull, push, ground, touch, h, dt, top, walls })
            })
            .reduce(Most::default, Most::of)
    }
}

/// What a sub-step writes of a run of particles.
struct Walk<'a> {
    place: [&'a mut [f32]; 3],
    speed: [&'a mut [f32]; 3],
    normal: [&'a mut [f32]; 3],
    gap: &'a mut [f32],
    beyond: &'a mut [f32],
}

/// A sub-step of a run of particles.
struct Stride<'a> {
    run: Walk<'a>,
    first: usize,
    from: [&'a [f32]; 3],
    pull: [&'a [f32]; 3],
    push: &'a [f32],
    ground: &'a Ground,
    touch: Touch,
    h: f32,
    dt: f32,
    top: f32,
    walls: Option<[f32; 2]>,
}

impl Work for Stride<'_> {
    type Out = Most;

    #[inline(always)]
    fn run<R: Reader>(self) -> Most {
        let Self { run, first, from, pull, push, ground, touch, h, dt, top, walls } = self;
        let mut most = Most::default();
        for k in 0..run.gap.len() {
            let i = first + k;
            let old = [0, 1, 2].map(|axis| run.place[axis][k]);
            // The ground mirrors the water's pressure.
            let off = 2.0 * push[i] * WendlandC2::beyond_slope(run.gap[k] / h) / h;
            let mut v = [0, 1, 2].map(|axis| {
                let down = if axis == 2 { GRAVITY as f32 } else { 0.0 };
                run.speed[axis][k] + dt * (pull[axis][i] + off * run.normal[axis][k] - down)
            });
            let speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if speed2 > top * top {
                let less = top / speed2.sqrt();
                v = v.map(|v| v * less);
            }
            let mut to = [0, 1, 2].map(|axis| old[axis] + dt * v[axis]);
            if let Some(walls) = walls {
                for axis in 0..2 {
                    let (low, high) = (touch.radius, (walls[axis] - touch.radius).max(touch.radius));
                    if to[axis] < low || to[axis] > high {
                        to[axis] = to[axis].clamp(low, high);
                        v[axis] = 0.0;
                    }
                }
            }
            let (to, v, foot) = touch.land(ground, old, to, v, dt);
            for axis in 0..3 {
                run.place[axis][k] = to[axis];
                run.speed[axis][k] = v[axis];
                run.normal[axis][k] = foot.normal[axis];
            }
            run.gap[k] = foot.gap(to[2]);
            run.beyond[k] = WendlandC2::beyond(run.gap[k] / h);
            let way = [0, 1, 2].map(|axis| to[axis] - from[axis][i]);
            most = most.of(Most {
                speed2: v[0] * v[0] + v[1] * v[1] + v[2] * v[2],
                way2: way[0] * way[0] + way[1] * way[1] + way[2] * way[2],
                gap: run.gap[k],
            });
        }
        most
    }
}
