//! The rain as a family of erosion: its steps, its state, and what it shows.

use crate::{
    bake::{Frame, Tape},
    grid::{Edges, Field, Grid, sum_f64},
    noise::Key,
    sph::Swarm,
};

use super::super::bed::{Bed, Family, Moved, Part, Saved};
use super::{
    contact::Ground,
    exchange::Exchange,
    params::RainParticlesParams,
    rain::{Rain, cull},
    water::Water,
};

/// How far a box of water is off a lattice, in spacings.
const JITTER: f64 = 0.1;
/// Names and units of what is recorded.
pub(super) const COLUMNS: [[&str; 2]; 5] = [["x", "m"], ["y", "m"], ["z", "m"], ["age", "s"], ["load", "m3"]];
/// Names the saved layout.
const MARK: u64 = 0x5250_0001;
/// The field of what waits beside the bed.
const REST: &str = "rain_particles_rest";

/// Rain as particles, bound to its parameters and a grid.
pub struct RainParticles {
    params: RainParticlesParams,
    grid: Grid,
    water: Water,
    exchange: Exchange,
    rain: Rain,
    /// Heights of particles count from here, m.
    datum_m: f32,
    /// Depth and discharge at the end of the stage, when its particles lay down what they carried.
    last: Option<[Field<f32>; 2]>,
}

/// Particles as they are now, for films and pictures. The order changes from step to step; `born` names them.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// From the west rim, m.
    pub x_m: &'a [f32],
    /// From the north rim, m.
    pub y_m: &'a [f32],
    /// Over `datum_m`, m.
    pub z_m: &'a [f32],
    /// What heights count from, above the world's datum, m.
    pub datum_m: f32,
    /// Velocities to the east, to the south and up, m/s.
    pub velocity_m_per_s: [&'a [f32]; 3],
    /// Rock that each carries, m³ of bed.
    pub load_m3: &'a [f64],
    /// How long each still lives, s.
    pub life_s: &'a [f32],
    /// Number of each in the order of birth.
    pub born: &'a [u64],
}

impl RainParticles {
    /// No drop has fallen yet.
    pub fn new(params: &RainParticlesParams, grid: Grid, key: Key) -> Result<Self, String> {
        params.check(&grid)?;
        Ok(Self {
            params: params.clone(),
            grid,
            water: Water::new(params, grid),
            exchange: Exchange::new(&grid),
            rain: Rain::new(key),
            datum_m: 0.0,
            last: None,
        })
    }

    /// Fills a box with water at rest where it is over the ground; heights above the world's datum, m. For a reservoir that
    /// breaks, and for measurements. Says how many particles that took.
    pub fn fill(&mut self, bed: &Bed, low: [f64; 3], high: [f64; 3]) -> usize {
        let ground = Ground::new(bed);
        let (d, datum) = (self.water.spacing(), ground.datum_m as f64);
        let [nx, ny, nz] = [0, 1, 2].map(|axis| ((high[axis] - low[axis]) / d).round() as usize);
        let before = self.water.swarm.len();
        for (z, y, x) in (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (z, y, x)))) {
            // Off the lattice by a little: water is no crystal.
            let mut stream = self.rain.key.with(self.rain.drawn).stream();
            let at = [x, y, z].map(|k| (k as f64 + 0.5 + stream.between(-JITTER, JITTER)) * d);
            let [x, y, z] = [low[0] + at[0], low[1] + at[1], low[2] + at[2] - datum].map(|place| place as f32);
            // Less than half a spacing: the lowest layer of a box that stands on the ground counts.
            if ground.holder(x, y).is_some() && ground.foot(x, y).gap(z) > 0.3 * d as f32 {
                self.water.swarm.add([[x, y, z], [0.0; 3]], self.params.lifespan_s as f32, 0.0, self.rain.drawn);
                self.rain.drawn += 1;
            }
        }
        self.water.swarm.len() - before
    }

    /// The particles.
    pub fn seen(&self) -> Seen<'_> {
        let Swarm { cloud, load, clock_s, born, .. } = &self.water.swarm;
        Seen {
            x_m: &cloud.x,
            y_m: &cloud.y,
            z_m: &cloud.z,
            datum_m: self.datum_m,
            velocity_m_per_s: [&cloud.vx, &cloud.vy, &cloud.vz],
            load_m3: load,
            life_s: clock_s,
            born,
        }
    }

    #[cfg(test)]
    pub(super) fn water(&self) -> &Water {
        &self.water
    }

    /// Sub-steps and steps of single particles so far, for measuring speed.
    pub fn work(&self) -> [u64; 2] {
        self.water.work
    }

    /// Volume of a particle, m³.
    pub fn particle_m3(&self) -> f64 {
        self.water.volume_m3()
    }

    /// Depth of the water, m: every particle spread over the cells that it covers. As the last step of a stage left it, once
    /// that is over.
    pub fn depth_m(&self) -> Field<f32> {
        let each = self.water.volume_m3() / self.grid.cell_area_m2();
        self.last.as_ref().map_or_else(|| self.spread(|_| each), |[depth, _]| depth.clone())
    }

    /// Water that passes cells, m³/s: what stands on a cell, by the time in which it crosses that. Spread as the depth.
    pub fn discharge(&self) -> Field<f32> {
        let (cloud, per_m) = (&self.water.swarm.cloud, self.water.volume_m3() / self.grid.cell_m);
        let along = |i: usize| per_m * libm::hypot(f64::from(cloud.vx[i]), f64::from(cloud.vy[i]));
        self.last.as_ref().map_or_else(|| self.spread(along), |[_, flow]| flow.clone())
    }

    /// What each particle has, spread over the cells that it covers.
    fn spread(&self, each: impl Fn(usize) -> f64) -> Field<f32> {
        let grid = self.grid;
        let mut sum = vec![0.0f64; grid.cells()];
        // A particle reaches about as far as its kernel, or a cell.
        let reach = (1.2 * self.water.spacing()).max(grid.cell_m) / grid.cell_m;
        let cloud = &self.water.swarm.cloud;
        for (i, (&x, &y)) in cloud.x.iter().zip(&cloud.y).enumerate() {
            let at = [x, y].map(|place| place as f64 / grid.cell_m - 0.5);
            let mut covered = [(0, 0.0); 25];
            let (mut count, mut total) = (0, 0.0);
            let first = at.map(|at| (at - reach).ceil() as i64);
            for cy in first[1]..=(at[1] + reach).floor() as i64 {
                for cx in first[0]..=(at[0] + reach).floor() as i64 {
                    let (dx, dy) = (cx as f64 - at[0], cy as f64 - at[1]);
                    let near = (1.0 - (dx * dx + dy * dy) / (reach * reach)).max(0.0);
                    if let Some(cell) = cell(&grid, cx, cy)
                        && count < covered.len()
                    {
                        covered[count] = (cell, near * near);
                        (count, total) = (count + 1, total + near * near);
                    }
                }
            }
            let each = each(i);
            for &(cell, weight) in covered[..count].iter().filter(|_| total > 0.0) {
                sum[cell] += each * weight / total;
            }
        }
        Field { grid, data: sum.into_iter().map(|sum| sum as f32).collect() }
    }
}

/// The cell `(x, y)`, wrapped; `None` beyond a rim.
fn cell(grid: &Grid, x: i64, y: i64) -> Option<usize> {
    let (width, height) = (grid.width as i64, grid.height as i64);
    let (x, y) = if grid.edges == Edges::Wrap { (x.rem_euclid(width), y.rem_euclid(height)) } else { (x, y) };
    ((0..width).contains(&x) && (0..height).contains(&y)).then(|| (y * width + x) as usize)
}

impl Family for RainParticles {
    fn advance(&mut self, bed: &mut Bed, part: Part) -> Moved {
        // Without a tape there is none that could be full.
        self.advance_on(bed, part, None).unwrap_or_default()
    }

    fn advance_on(&mut self, bed: &mut Bed, part: Part, tape: Option<&dyn Tape>) -> Result<Moved, String> {
        let [from, to] = part.of(self.params.duration_s());
        let take =
            |frames: Vec<Frame>| frames.into_iter().try_for_each(|frame| tape.map_or(Ok(()), |tape| tape.take(frame)));
        self.water.glimpses.look(tape.map_or(0.0, |tape| tape.per_s()), from);
        take(self.water.glimpses.idle(from, COLUMNS.len()))?;
        let mut left = to - from;
        let mut ground = Ground::new(bed);
        self.datum_m = ground.datum_m;
        let rate = Rain::rate_m3_per_s(&self.params, bed);
        let volume = self.water.volume_m3();
        let idle = 16.0 * self.params.least_step_s(self.water.spacing());
        let mut moved = Moved::default();
        while left > 0.0 {
            let lost = cull(bed, &mut ground, &mut self.water, &mut self.exchange);
            moved.rock_left_m3 += lost.rock_left_m3;
            moved.water_left_m3 += lost.water_left_m3;
            self.water.sort();
            let born = self.rain.fall(&self.params, bed, &ground, &mut self.water);
            if born > 0 {
                moved.water_in_m3 += born as f64 * volume;
                self.water.sort();
            }
            let now = to - left;
            let still = self.water.swarm.is_empty();
            let dt = if still {
                // Until there is enough for a particle.
                let wait = if rate > 0.0 { (volume - self.rain.owed_m3).max(0.0) / rate } else { left };
                wait.max(idle).min(left)
            } else {
                self.water.look(now);
                let dt = self.water.block(&ground, left);
                self.exchange.run(&self.params, bed, &mut ground, &mut self.water, dt);
                for life in &mut self.water.swarm.clock_s {
                    *life -= dt as f32;
                }
                dt
            };
            self.rain.owed_m3 += rate * dt;
            let next = if dt >= left { to } else { now + dt };
            take(if still {
                self.water.glimpses.idle(next, COLUMNS.len())
            } else {
                self.water.develop(dt, self.datum_m)?
            })?;
            // The last sub-step ends where the step does.
            left -= dt;
        }
        Ok(moved)
    }

    fn carried_m3(&self) -> f64 {
        self.water.swarm.load.iter().sum::<f64>() + self.exchange.waiting_m3(&self.grid)
    }

    fn settle(&mut self, bed: &mut Bed) -> Moved {
        self.last = Some([self.depth_m(), self.discharge()]);
        for life in &mut self.water.swarm.clock_s {
            *life = 0.0;
        }
        let mut ground = Ground::new(bed);
        // Those over an open rim lay down on it: there is no step left to count them in.
        // Inside by more than what rounding moves a place by, when it is counted in cells.
        let extent = self.grid.extent_m().map(|extent| (extent * (1.0 - 1e-6)) as f32);
        for (values, extent) in [(&mut self.water.swarm.cloud.x, extent[0]), (&mut self.water.swarm.cloud.y, extent[1])]
        {
            for value in values {
                *value = value.clamp(0.0, extent);
            }
        }
        let lost = cull(bed, &mut ground, &mut self.water, &mut self.exchange);
        self.exchange.settle(bed);
        // The water stays where it was.
        let stays = self.last.as_ref().map_or(0.0, |[depth, _]| sum_f64(&depth.data)) * self.grid.cell_area_m2();
        Moved { water_left_m3: lost.water_left_m3 - stays, ..lost }
    }

    fn save(&self) -> Saved {
        let water = &self.water;
        let mut blob = Vec::new();
        let words = [
            MARK,
            self.rain.drawn,
            self.rain.owed_m3.to_bits(),
            self.exchange.adrift_m3.to_bits(),
            water.sound.to_bits(),
            self.datum_m.to_bits() as u64,
            water.swarm.len() as u64,
        ];
        let mut word = |word: u64| blob.extend(word.to_le_bytes());
        words.into_iter().for_each(&mut word);
        water.swarm.born.iter().copied().for_each(&mut word);
        water.swarm.load.iter().map(|load| load.to_bits()).for_each(&mut word);
        for values in water.swarm.cloud.arrays().into_iter().chain([&water.swarm.clock_s]) {
            blob.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        }
        Saved { fields: vec![(REST, self.exchange.rest.clone())], blob }
    }

    fn restore(&mut self, field: &dyn Fn(&str) -> Option<Vec<f32>>, blob: &[u8]) -> Option<()> {
        let rest = field(REST)?;
        let (words, mut values) = (blob.as_chunks::<8>().0, blob.get(56..)?);
        let word = |k: usize| words.get(k).map(|word| u64::from_le_bytes(*word));
        let n = usize::try_from(word(6)?).ok()?;
        // Seven words, two a particle, and seven values of four bytes.
        let right = blob.len() == n.checked_mul(44)?.checked_add(56)?;
        if word(0)? != MARK || rest.len() != self.grid.cells() || !right {
            return None;
        }
        let mut take = |bytes: usize| values.split_off(..bytes);
        let wide = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word)).collect::<Vec<_>>();
        let narrow = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|word| f32::from_le_bytes(*word)).collect();
        let born = wide(take(8 * n)?);
        let load_m3 = wide(take(8 * n)?).into_iter().map(f64::from_bits).collect();
        let mut cloud = crate::sph::Cloud::default();
        for values in cloud.arrays_mut() {
            *values = narrow(take(4 * n)?);
        }
        let life_s: Vec<f32> = narrow(take(4 * n)?);
        if cloud.arrays().into_iter().chain([&life_s]).flatten().any(|value| !value.is_finite()) {
            return None;
        }
        self.rain.drawn = word(1)?;
        self.rain.owed_m3 = f64::from_bits(word(2)?);
        self.exchange.adrift_m3 = f64::from_bits(word(3)?);
        self.exchange.rest = rest;
        self.water.sound = f64::from_bits(word(4)?);
        self.datum_m = f32::from_bits(word(5)? as u32);
        let swarm = &mut self.water.swarm;
        (swarm.cloud, swarm.clock_s, swarm.load, swarm.born) = (cloud, life_s, load_m3, born);
        Some(())
    }
}
