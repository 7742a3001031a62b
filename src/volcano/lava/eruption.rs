//! An eruption: what comes out of vents, flows, freezes and leaves.

use super::{
    flow::Flow,
    heat::Lost,
    land::Land,
    law::Law,
    params::LavaParams,
    vents::{APART, Source},
};
use crate::{
    bake::{Frame, Tape},
    grid::{Edges, Field},
    noise::Key,
    sph::Swarm,
    volcano::{
        outlet::{Outlet, outlets},
        schedule::Schedule,
    },
    world::{Mask, World},
};

/// How far below the lowest ground a particle is out of the world, m.
const DEEP_M: f32 = 1e4;
/// Names and units of what is recorded.
pub(super) const COLUMNS: [[&str; 2]; 5] = [["x", "m"], ["y", "m"], ["z", "m"], ["temperature", "degC"], ["age", "s"]];
/// Time between looks at vents where nothing flows, s.
const IDLE_S: f64 = 0.05;

/// An eruption at work.
pub struct Eruption {
    pub(super) law: Law,
    pub(super) schedule: Schedule,
    pub(super) flow: Flow,
    pub(super) land: Land,
    pub(super) sources: Vec<Source>,
    pub(super) key: Key,
    /// Particles that came out.
    pub(super) drawn: u64,
    /// Particles that froze.
    pub(super) froze: u64,
    /// Particles that left over the rim, or were dropped in the end.
    pub(super) left: u64,
    /// Of these, those that left over the rim.
    pub(super) over_rim: u64,
}

/// Particles as they are now, for films and pictures. The order changes from step to step; `born` names them.
#[derive(Clone, Debug)]
pub struct Seen<'a> {
    /// From the west and the north rim, and over `datum_m`, m.
    pub place_m: [&'a [f32]; 3],
    /// What heights count from, above the world's datum, m.
    pub datum_m: f32,
    /// Velocities to the east, to the south and up, m/s.
    pub velocity_m_per_s: [&'a [f32]; 3],
    /// Temperatures, °C.
    pub degc: Vec<f64>,
    /// Since each came out, s.
    pub age_s: &'a [f32],
    /// Number of each in the order in which they came out.
    pub born: &'a [u64],
}

impl Eruption {
    /// Nothing has come out yet.
    pub fn new(params: &LavaParams, world: &World, mask: Option<&Mask>, key: Key) -> Result<Self, String> {
        let law = Law::new(params, &world.grid);
        law.check(&world.grid)?;
        let mut vents = outlets(&params.vent, world, 2.0 * law.spacing)?;
        if let Some(mask) = mask {
            let mask: Field<f32> = mask.evaluate(world).map_err(|e| e.to_string())?;
            for vent in &mut vents {
                vent.share *= crate::grid::linear(&mask, vent.from_m).clamp(0.0, 1.0);
            }
        }
        let schedule = params.schedule()?;
        Ok(Self::at(law, schedule, (Land::new(world), world.sea_level_m), vents, key))
    }

    /// From what it is made of.
    pub(super) fn at(law: Law, schedule: Schedule, ground: (Land, f64), vents: Vec<Outlet>, key: Key) -> Self {
        let (land, sea_m) = ground;
        let grid = *land.mesh.grid();
        let mut flow = Flow::new(law.clone(), grid);
        flow.sea = (sea_m - f64::from(land.datum_m)) as f32;
        let sources = vents.into_iter().map(|vent| Source::new(vent, &law)).collect();
        Self { law, schedule, flow, land, sources, key, drawn: 0, froze: 0, left: 0, over_rim: 0 }
    }

    /// Runs from a moment to another, s after the eruption began.
    pub fn run(&mut self, from_s: f64, to_s: f64) -> Result<(), String> {
        self.run_on(from_s, to_s, None)
    }

    /// The same, with a tape on which it is recorded: first at the beginning, then on where it was left.
    pub fn run_on(&mut self, from_s: f64, to_s: f64, tape: Option<&dyn Tape>) -> Result<(), String> {
        let take =
            |frames: Vec<Frame>| frames.into_iter().try_for_each(|frame| tape.map_or(Ok(()), |tape| tape.take(frame)));
        self.flow.glimpses.look(tape.map_or(0.0, |tape| tape.per_s()), from_s);
        take(self.flow.glimpses.idle(from_s, COLUMNS.len()))?;
        let mut now = from_s;
        while now < to_s {
            self.freeze();
            self.flow.sort();
            self.emit();
            let left = to_s - now;
            let still = self.flow.swarm.is_empty();
            let dt = if still { self.pause(now, left) } else { self.block(now, left)? };
            // The last block ends where the run does.
            let next = if dt >= left { to_s } else { now + dt };
            take(if still { self.flow.glimpses.idle(next, COLUMNS.len()) } else { self.develop(dt)? })?;
            let due = self.schedule.particles(now, next, self.law.volume_m3());
            for source in &mut self.sources {
                source.owed += due * source.vent.share;
            }
            now = next;
        }
        Ok(())
    }

    /// A block of steps from a moment on.
    fn block(&mut self, now: f64, left: f64) -> Result<f64, String> {
        let mut glimpses = std::mem::take(&mut self.flow.glimpses);
        glimpses.open(now, || self.flow.heat_and_age());
        self.flow.glimpses = glimpses;
        self.flow.block(&self.land, left)
    }

    /// The frames that were due in a block that lasted so long.
    fn develop(&mut self, lasted_s: f64) -> Result<Vec<Frame>, String> {
        let mut glimpses = std::mem::take(&mut self.flow.glimpses);
        let (flow, datum_m) = (&self.flow, self.land.datum_m);
        let frames = glimpses.develop((lasted_s, datum_m), &flow.swarm.born, || flow.heat_and_age());
        self.flow.glimpses = glimpses;
        frames
    }

    /// How long nothing happens where nothing flows.
    fn pause(&self, now: f64, left: f64) -> f64 {
        let waits = self.sources.iter().any(|source| source.owed >= 1.0);
        let runs = self.schedule.particles(now, now + IDLE_S, self.law.volume_m3()) > 0.0;
        if waits || runs {
            return IDLE_S.min(left);
        }
        self.schedule.next_change(now).map_or(left, |next| next - now).min(left)
    }

    /// Lets those come out that are due and find room.
    pub(super) fn emit(&mut self) {
        for k in 0..self.sources.len() {
            let room = (self.law.params.max_particles as usize).saturating_sub(self.flow.swarm.len());
            let (near, mut places) = ((APART * self.law.spacing) as f32, Vec::new());
            let (flow, law, land) = (&self.flow, &self.law, &self.land);
            let key = self.key.with(k as u64).with(self.drawn);
            self.sources[k].emit(
                (&land.mesh, law, key),
                room,
                |at| !flow.swarm.any_within(at, near),
                |at| places.push(at),
            );
            if places.is_empty() {
                continue;
            }
            let velocity = [0.0, 0.0, self.law.params.exit_speed_m_per_s as f32];
            for at in places {
                self.flow.add(at, velocity, self.law.params.temperature_degc, self.drawn);
                self.drawn += 1;
            }
            self.flow.sort();
        }
    }

    /// Turns to ground what is rock and lies on it, and forgets what left the map.
    fn freeze(&mut self) {
        let n = self.flow.swarm.len();
        let rock = match self.law.params.freeze && self.flow.has_ground() {
            true => self.flow.frozen(&self.land),
            false => vec![false; n],
        };
        self.sift(|out| {
            if out.0 {
                Fate::Left
            } else if rock[out.1] {
                Fate::Rock
            } else {
                Fate::Stays
            }
        });
    }

    /// Ends it: what is due comes out, and what is left freezes where it lies, or is dropped.
    pub fn settle(&mut self) {
        self.flow.sort();
        self.emit();
        let keep = self.law.params.settle && self.flow.has_ground();
        self.sift(|out| if out.0 || !keep { Fate::Left } else { Fate::Rock });
    }

    /// Sorts particles by what becomes of them; `fate` is told whether one left the map, and which.
    fn sift(&mut self, fate: impl Fn((bool, usize)) -> Fate) {
        let n = self.flow.swarm.len();
        let (mut stays, mut rock) = (Vec::with_capacity(n), Vec::new());
        for i in 0..n {
            let at = [self.flow.swarm.cloud.x[i], self.flow.swarm.cloud.y[i]];
            let out = self.is_out(i);
            self.over_rim += u64::from(out);
            match fate((out, i)) {
                Fate::Stays => stays.push(i as u32),
                Fate::Rock => rock.push((at, self.flow.temperature(i))),
                Fate::Left => self.left += 1,
            }
        }
        if stays.len() == n {
            return;
        }
        self.froze += rock.len() as u64;
        self.land.lay(&rock, self.law.volume_m3(), 1.2 * self.law.spacing);
        self.flow.swarm.reorder(&stays);
    }

    fn is_out(&self, i: usize) -> bool {
        let cloud = &self.flow.swarm.cloud;
        let open = self.land.mesh.grid().edges == Edges::Open;
        (open && self.land.mesh.holder(cloud.x[i], cloud.y[i]).is_none()) || cloud.z[i] < -DEEP_M
    }

    /// The particles.
    pub fn seen(&self) -> Seen<'_> {
        let Swarm { cloud, clock_s, born, .. } = &self.flow.swarm;
        Seen {
            place_m: [&cloud.x, &cloud.y, &cloud.z],
            datum_m: self.land.datum_m,
            velocity_m_per_s: [&cloud.vx, &cloud.vy, &cloud.vz],
            degc: (0..cloud.len()).map(|i| self.flow.temperature(i)).collect(),
            age_s: clock_s,
            born,
        }
    }

    /// Particles that came out, froze, and left; the others flow.
    pub fn counts(&self) -> [u64; 3] {
        [self.drawn, self.froze, self.left]
    }

    /// Particles that left over the rim.
    pub fn over_rim(&self) -> u64 {
        self.over_rim
    }

    /// Particles that were due and found no room.
    pub fn owed(&self) -> f64 {
        self.sources.iter().map(|source| source.owed).sum()
    }

    /// Heat that left, J.
    pub fn lost(&self) -> Lost {
        self.flow.lost
    }

    /// Volume of a particle, m³.
    pub fn particle_m3(&self) -> f64 {
        self.law.volume_m3()
    }

    /// Steps, and steps of single particles, so far, for measuring speed.
    pub fn work(&self) -> [u64; 2] {
        self.flow.work
    }
}

/// What becomes of a particle.
enum Fate {
    Stays,
    Rock,
    Left,
}

impl LavaParams {
    /// The schedule, from the recipe or its file.
    pub(super) fn schedule(&self) -> Result<Schedule, String> {
        match &self.schedule_file {
            None => Schedule::new(&self.schedule),
            Some(path) => {
                let text = std::fs::read_to_string(path).map_err(|e| format!("schedule_file {path}: {e}"))?;
                Schedule::from_json(&text).map_err(|what| format!("schedule_file {path}: {what}"))
            }
        }
    }
}
