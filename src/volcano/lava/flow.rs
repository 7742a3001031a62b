//! The lava itself: particles, and how they move and cool for a few steps.

use rayon::prelude::*;

use super::{
    choices::{Contact, Smoothing, Viscosity},
    engine::{Engine, Most, Setting, Stiffness},
    heat::{Lost, Place},
    land::Land,
    law::{Law, SEA},
    stride::{Stride, fresh_speeds, half_ahead},
};
use crate::{
    bake::Glimpses,
    grid::{Edges, Grid},
    sph::{Around, Cloud, CubicSpline, DesbrunGascuel, Kernel, Liquid, RUN, Swarm, WendlandC2, look_around},
    volcano::heat::GRAVITY,
};

/// How far lists reach beyond the support, in spacings.
const SKIN: f64 = 0.4;
/// Most steps of a block: the ground rests and nobody is born or freezes meanwhile.
const MOST_STEPS: usize = 12;
/// How much of its speed of sound lava keeps from block to block when it calms down.
const FADE: f64 = 0.95;
/// How much stiffer it gets from block to block.
const GROW: f64 = 1.1;
/// Speeds and heights over the root of their mean squares that lava is made stiff for.
const MANY: f64 = 3.0;

/// Particles of lava.
pub(super) struct Flow {
    pub(super) law: Law,
    pub(super) grid: Grid,
    /// Weight, m/s²: down, except in tests.
    pub(super) gravity: [f32; 3],
    /// Height of the sea over the land's datum, m.
    pub(super) sea: f32,
    /// Speed of sound of the last block, m/s.
    pub(super) sound: f64,
    /// Steps, and steps of single particles, since it was made.
    pub(super) work: [u64; 2],
    /// The particles: their clocks are the time since they came out, their loads the enthalpy of a kilogram, J/kg.
    pub(super) swarm: Swarm,
    /// Heat that has left, J.
    pub(super) lost: Lost,
    pub(super) engine: Engine,
    /// What a recording sees of it.
    pub(super) glimpses: Glimpses,
    stiffness: Stiffness,
    pulls: [Vec<[f32; 3]>; 2],
    fresh: Vec<[f32; 3]>,
    half: Cloud,
    around: Vec<Around>,
    degc: Vec<f64>,
}

impl Flow {
    /// No lava yet.
    pub(super) fn new(law: Law, grid: Grid) -> Self {
        let weight = if law.params.gravity { -GRAVITY as f32 } else { 0.0 };
        Self {
            swarm: Swarm::new(&grid, law.scale.support_m()),
            law,
            grid,
            gravity: [0.0, 0.0, weight],
            sea: f32::NEG_INFINITY,
            sound: 0.0,
            work: [0; 2],
            lost: Lost::default(),
            engine: Engine::default(),
            glimpses: Glimpses::default(),
            stiffness: Stiffness::default(),
            pulls: Default::default(),
            fresh: Vec::new(),
            half: Cloud::default(),
            around: Vec::new(),
            degc: Vec::new(),
        }
    }

    /// One particle more.
    pub(super) fn add(&mut self, at: [f32; 3], velocity: [f32; 3], degc: f64, born: u64) {
        self.swarm.add([at, velocity], 0.0, self.law.enthalpy(degc), born);
    }

    fn radius(&self) -> f32 {
        self.law.scale.support_m() + (SKIN * self.law.spacing) as f32
    }

    /// Brings particles back into a world that wraps and sorts them by cell.
    pub(super) fn sort(&mut self) {
        self.swarm.sort(&self.grid, self.radius());
    }

    /// Moves and cools sorted particles for up to `left_s`: as many steps as one list serves. Gives the time that has passed,
    /// or what went wrong.
    pub(super) fn block(&mut self, land: &Land, left_s: f64) -> Result<f64, String> {
        match self.law.params.kernel {
            Smoothing::Wendland => self.block_of::<WendlandC2>(land, left_s),
            Smoothing::Cubic => self.block_of::<CubicSpline>(land, left_s),
            Smoothing::Desbrun => self.block_of::<DesbrunGascuel>(land, left_s),
        }
    }

    fn block_of<K: Kernel>(&mut self, land: &Land, left_s: f64) -> Result<f64, String> {
        let radius = self.radius();
        self.swarm.meet(radius);
        let mut setting = self.setting();
        let mut most = self.engine.stand::<K>(&self.swarm.cloud, &land.mesh, &setting);
        self.tune(&most);
        setting.liquid.sound_m_per_s = self.sound as f32;
        let stiffest = self.stiffen(setting.sharpness_s);
        let half_skin = 0.5 * SKIN * self.law.spacing;
        let mut done = 0.0;
        for step in 0..MOST_STEPS {
            let pace = self.law.pace(f64::from(most.speed2).sqrt(), self.sound, stiffest);
            setting.implicit = pace.implicit;
            let left = left_s - done;
            let last = left <= pace.dt;
            let dt = if last { left } else { pace.dt };
            if step > 0 {
                self.engine.stand::<K>(&self.swarm.cloud, &land.mesh, &setting);
            }
            most = self.step::<K>(land, &setting, dt as f32);
            self.check(&most, dt)?;
            done = if last { left_s } else { done + dt };
            let Cloud { x, y, z, vx, vy, vz } = &self.swarm.cloud;
            self.glimpses.pass(done, [x, y, z], [vx, vy, vz]);
            if last || f64::from(most.way2).sqrt() > half_skin {
                break;
            }
        }
        self.cool::<K>(land, &setting, done);
        self.swarm.clock_s.iter_mut().for_each(|age| *age += done as f32);
        Ok(done)
    }

    /// Makes lava as stiff as what most of it does needs: a lone drop in the air is no reason. What is stiffer pushes harder
    /// where it is pressed together already, so that it becomes so by and by.
    fn tune(&mut self, most: &Most) {
        let (cloud, gap) = (&self.swarm.cloud, &self.engine.gap);
        let n = cloud.len();
        let square = |v: f32| f64::from(v) * f64::from(v);
        let runs: Vec<[f64; 2]> = (0..n.div_ceil(RUN))
            .into_par_iter()
            .map(|r| {
                let mut sums = [0.0; 2];
                for i in r * RUN..n.min((r + 1) * RUN) {
                    sums[0] += square(cloud.vx[i]) + square(cloud.vy[i]) + square(cloud.vz[i]);
                }
                for &gap in gap[r * RUN..n.min((r + 1) * RUN)].iter().filter(|gap| gap.is_finite()) {
                    sums[1] += square(gap);
                }
                sums
            })
            .collect();
        let usual = [0, 1].map(|k| (runs.iter().map(|sums| sums[k]).sum::<f64>() / n.max(1) as f64).sqrt());
        let speed = f64::from(most.speed2).sqrt().min(MANY * usual[0]);
        let wanted = self.law.sound(speed, f64::from(most.gap).min(MANY * usual[1]));
        let fixed = self.law.params.stiffness_m2_per_s2 > 0.0 || self.sound == 0.0;
        self.sound = if fixed { wanted } else { wanted.clamp(FADE * self.sound, GROW * self.sound) };
    }

    fn setting(&self) -> Setting {
        let p = &self.law.params;
        let liquid = Liquid {
            scale: self.law.scale,
            sound_m_per_s: self.sound as f32,
            viscosity_m2_per_s: 0.0,
            cohesion_per_s2: 0.0,
        };
        Setting {
            domain: self.swarm.domain,
            liquid,
            gravity: self.gravity,
            sea: (self.sea, (1.0 - SEA / p.density_kg_per_m3).clamp(0.0, 1.0) as f32),
            pressure: p.pressure,
            viscosity: p.viscosity,
            contact: p.ground,
            sharpness_s: if p.yield_pa > 0.0 { p.yield_sharpness_s as f32 } else { 0.0 },
            implicit: false,
        }
    }

    /// How stiff everyone is at its temperature; gives the greatest viscosity that a step has to follow, m²/s.
    fn stiffen(&mut self, sharpness_s: f32) -> f64 {
        let n = self.swarm.len();
        let Stiffness { viscosity, yields } = &mut self.stiffness;
        viscosity.resize(n, 0.0);
        yields.resize(n, 0.0);
        let (law, sound, heat) = (&self.law, self.sound, &self.swarm.load);
        let runs = (viscosity.par_chunks_mut(RUN), yields.par_chunks_mut(RUN)).into_par_iter().enumerate();
        // The greatest does not depend on the order.
        runs.map(|(r, (viscosity, yields))| {
            let mut stiffest = 0.0f64;
            for k in 0..viscosity.len() {
                let degc = law.degc(heat[r * RUN + k]);
                let mut whole = 0.0;
                match law.params.viscosity {
                    Viscosity::Off => viscosity[k] = 0.0,
                    Viscosity::Document => {
                        viscosity[k] = law.document_alpha(degc) as f32;
                        whole = law.document_viscosity(degc);
                    }
                    Viscosity::Pairs => {
                        whole = law.viscosity(degc, sound);
                        viscosity[k] = whole as f32;
                        if sharpness_s > 0.0 {
                            yields[k] = law.yield_m2_per_s2(degc) as f32;
                            whole += f64::from(yields[k] * sharpness_s);
                        }
                    }
                }
                stiffest = stiffest.max(whole);
            }
            stiffest
        })
        .reduce(|| 0.0, f64::max)
    }

    /// A step in time.
    fn step<K: Kernel>(&mut self, land: &Land, setting: &Setting, dt: f32) -> Most {
        let n = self.swarm.len();
        self.work = [self.work[0] + 1, self.work[1] + n as u64];
        let scheme = self.law.params.integrator;
        let weights = scheme.weights();
        let [first, second] = &mut self.pulls;
        self.engine.pull::<K>((&self.swarm.cloud, &self.swarm.lists), &self.stiffness, setting, first);
        if scheme.looks_twice() {
            let drags = self.engine.drags(setting);
            half_ahead(&self.swarm.cloud, first, drags.then_some(&self.engine.drag[..]), dt, &mut self.half);
            self.engine.stand::<K>(&self.half, &land.mesh, setting);
            self.engine.pull::<K>((&self.half, &self.swarm.lists), &self.stiffness, setting, second);
        } else {
            second.clear();
        }
        let drags = self.engine.drags(setting);
        let drag = drags.then_some(&self.engine.drag[..]);
        fresh_speeds(&self.swarm.cloud, [first, second], drag, (&weights, dt), &mut self.fresh);
        if setting.implicit {
            self.engine.rub::<K>(&self.swarm.lists, setting, dt, &mut self.fresh);
        }
        let stride = Stride {
            mesh: &land.mesh,
            contact: setting.contact,
            touch: self.law.touch(),
            friction: self.law.params.friction as f32,
            walls: (self.grid.edges == Edges::Closed).then_some(self.grid.extent_m().map(|extent| extent as f32)),
            top: if self.law.params.force_time_step { f32::INFINITY } else { self.law.most_speed() as f32 },
            weights,
            dt,
            from: self.swarm.lists.made_for(),
            half: &self.half,
            off: &self.engine.off,
            fresh: &self.fresh,
        };
        stride.go(&mut self.swarm.cloud)
    }

    /// An error where lava has flown apart.
    fn check(&self, most: &Most, dt: f64) -> Result<(), String> {
        // Further than its support in a step: it has met nobody that it should have.
        let top = (2.0 * self.law.most_speed()).min(f64::from(self.law.scale.support_m()) / dt.max(1e-9));
        let fits = !self.law.params.force_time_step || f64::from(most.speed2).sqrt() <= top;
        if most.finite && fits {
            return Ok(());
        }
        let limit = self.law.free_pace(self.sound);
        Err(format!(
            "lava flew apart at a time step of {dt:.4} s; sound alone allows {limit:.4} s: lower time_step_s, or set \
             force_time_step = false"
        ))
    }

    /// Lets heat flow for a time.
    fn cool<K: Kernel>(&mut self, land: &Land, setting: &Setting, time_s: f64) {
        if time_s <= 0.0 || self.law.params.cooling_factor == 0.0 {
            return;
        }
        self.engine.stand::<K>(&self.swarm.cloud, &land.mesh, setting);
        // As many times as conduction asks for; where it would be endless, as often as a block has steps.
        let times = (time_s / self.law.conduction_limit_s()).ceil().clamp(1.0, 64.0);
        let dt = time_s / times;
        for _ in 0..times as usize {
            self.exchange::<K>(dt);
        }
    }

    fn exchange<K: Kernel>(&mut self, dt: f64) {
        let law = &self.law;
        self.degc.clear();
        self.degc.extend(self.swarm.load.iter().map(|&heat| law.degc(heat)));
        let thin = &self.engine.forces.thin;
        look_around::<K>(
            &self.swarm.cloud,
            &self.swarm.lists,
            (self.swarm.domain, &law.scale),
            (&self.degc, thin),
            &mut self.around,
        );
        let (cloud, engine, around, sea) = (&self.swarm.cloud, &self.engine, &self.around, self.sea);
        let lost: Vec<Lost> = self
            .swarm
            .load
            .par_chunks_mut(RUN)
            .enumerate()
            .map(|(r, heat)| {
                let mut lost = Lost::default();
                for (k, heat) in heat.iter_mut().enumerate() {
                    let i = r * RUN + k;
                    if law.params.conduct {
                        *heat += dt * law.conducted(around[i].laplacian);
                    }
                    let place = Place {
                        around: around[i],
                        density: engine.forces.density[i],
                        gap: engine.gap[i],
                        normal: engine.normal[i],
                        submerged: cloud.z[i] < sea,
                    };
                    *heat = law.cooled::<K>(*heat, &place, dt, &mut lost);
                }
                lost
            })
            .collect();
        for run in lost {
            self.lost.ground += run.ground;
            self.lost.air += run.air;
            self.lost.sky += run.sky;
            self.lost.sea += run.sea;
        }
    }

    /// Particles that are rock and lie on the ground, or are past saving.
    pub(super) fn frozen(&self, land: &Land) -> Vec<bool> {
        let reach = self.law.spacing as f32;
        let rock = self.law.enthalpy(self.law.params.solidus_degc);
        (0..self.swarm.len())
            .into_par_iter()
            .map(|i| {
                let grounded =
                    || land.mesh.foot(self.swarm.cloud.x[i], self.swarm.cloud.y[i]).gap(self.swarm.cloud.z[i]) < reach;
                self.swarm.load[i] < rock && grounded()
            })
            .collect()
    }

    /// What a recording has besides the place: temperatures, °C, and ages, s.
    pub(super) fn heat_and_age(&self) -> Vec<Vec<f64>> {
        let degc = (0..self.swarm.len()).map(|i| self.temperature(i)).collect();
        vec![degc, self.swarm.clock_s.iter().map(|&age| f64::from(age)).collect()]
    }

    /// Temperature of a particle, °C.
    pub(super) fn temperature(&self, i: usize) -> f64 {
        self.law.degc(self.swarm.load[i])
    }

    /// Density over that at rest, as of the last step.
    #[cfg(test)]
    pub(super) fn density(&self) -> &[f32] {
        &self.engine.forces.density
    }

    /// Whether there is ground to freeze on.
    pub(super) fn has_ground(&self) -> bool {
        self.law.params.ground != Contact::Off
    }
}
