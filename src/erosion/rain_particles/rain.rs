//! Where water comes from and where it ends.

use crate::{grid::Edges, noise::Key};

use super::super::bed::{Bed, Moved};
use super::{contact::Ground, exchange::Exchange, params::RainParticlesParams, water::Water};

/// Places that a drop tries before it is given up: the sea, off the map, or full of water.
const TRIES: usize = 4;
/// Layers of water that rain may come down on.
const LAYERS: usize = 12;
/// Nearest that a particle is born to another, in spacings; nearer, pressure would throw them apart.
const APART: f64 = 0.9;

/// The rain so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rain {
    pub(super) key: Key,
    /// Drops drawn, those given up too.
    pub(super) drawn: u64,
    /// Rain that has not made a particle yet, m³.
    pub(super) owed_m3: f64,
}

impl Rain {
    pub(super) fn new(key: Key) -> Self {
        Self { key: key.named("rain"), drawn: 0, owed_m3: 0.0 }
    }

    /// Rain on the map, m³/s.
    pub(super) fn rate_m3_per_s(params: &RainParticlesParams, bed: &Bed) -> f64 {
        let [width, height] = bed.grid.extent_m();
        let radius = params.rain_radius * width.min(height);
        let area = if radius > 0.0 { std::f64::consts::PI * radius * radius } else { width * height };
        area * params.rain_mm_per_h / 3.6e6
    }

    /// Lets what is owed fall on sorted water; says how many particles that made.
    pub(super) fn fall(
        &mut self,
        params: &RainParticlesParams,
        bed: &Bed,
        ground: &Ground,
        water: &mut Water,
    ) -> usize {
        let volume = water.volume_m3();
        let alive = water.swarm.len();
        let free = (params.particles as usize).saturating_sub(alive);
        let drops = ((self.owed_m3 / volume) as usize).min(free);
        self.owed_m3 = (self.owed_m3 - drops as f64 * volume).min(volume);
        let apart = (APART * water.spacing()) as f32;
        let mut fallen: Vec<[f32; 3]> = Vec::new();
        for _ in 0..drops {
            let mut stream = self.key.with(self.drawn).stream();
            let life = params.lifespan_s * stream.between(0.75, 1.25);
            let found = (0..TRIES).find_map(|_| {
                let [x, y] = place(params, bed, [stream.unit(), stream.unit()])?;
                let cell = ground.holder(x, y)?;
                if bed.height(cell) < bed.sea_m {
                    return None;
                }
                let (foot, step) = (ground.foot(x, y), water.spacing() as f32);
                let low = foot.height + 0.5 * step / foot.face[2].max(0.2);
                (0..LAYERS).map(|layer| [x, y, low + layer as f32 * step]).find(|&at| {
                    let near = |other: &[f32; 3]| {
                        let d = [0, 1, 2].map(|axis| at[axis] - other[axis]);
                        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < apart * apart
                    };
                    !water.swarm.any_within(at, apart) && !fallen.iter().any(near)
                })
            });
            if let Some(at) = found {
                fallen.push(at);
                water.swarm.add([at, [0.0; 3]], life as f32, 0.0, self.drawn);
            }
            self.drawn += 1;
        }
        fallen.len()
    }
}

/// A place under the rain, m; `None` off the map.
fn place(params: &RainParticlesParams, bed: &Bed, [a, b]: [f64; 2]) -> Option<[f32; 2]> {
    let extent = bed.grid.extent_m();
    let radius = params.rain_radius * extent[0].min(extent[1]);
    if radius <= 0.0 {
        return Some([(a * extent[0]) as f32, (b * extent[1]) as f32]);
    }
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * a);
    let r = radius * b.sqrt();
    let at = [params.rain_x * extent[0] + r * cos, params.rain_y * extent[1] + r * sin];
    if bed.grid.edges == Edges::Wrap {
        return Some([0, 1].map(|axis| at[axis].rem_euclid(extent[axis]) as f32));
    }
    at.iter().zip(extent).all(|(at, extent)| (0.0..extent).contains(at)).then(|| at.map(|at| at as f32))
}

/// Takes away water that left over an open rim, reached the sea or ended, and lays down what it carried.
pub(super) fn cull(bed: &mut Bed, ground: &mut Ground, water: &mut Water, exchange: &mut Exchange) -> Moved {
    let mut moved = Moved::default();
    let (mut kept, mut changed) = (Vec::with_capacity(water.swarm.len()), Vec::new());
    let open = bed.grid.edges == Edges::Open;
    let extent = bed.grid.extent_m().map(|extent| extent as f32);
    for i in 0..water.swarm.len() {
        let at = [water.swarm.cloud.x[i], water.swarm.cloud.y[i]];
        let holder = ground.holder(at[0], at[1]);
        let left = open && holder.is_none();
        let drowned = holder.is_some_and(|cell| bed.height(cell) < bed.sea_m);
        if !left && !drowned && water.swarm.clock_s[i] > 0.0 {
            kept.push(i as u32);
            continue;
        }
        moved.water_left_m3 += water.volume_m3();
        if left {
            moved.rock_left_m3 += water.swarm.load[i];
        } else {
            // Rounding may put a particle of a closed or wrapping world on the very rim.
            let at = [0, 1].map(|axis| at[axis].clamp(0.0, extent[axis].next_down()));
            exchange.drop_load(bed, at, water.swarm.load[i], &mut changed);
        }
    }
    if kept.len() < water.swarm.len() {
        water.swarm.reorder(&kept);
        ground.renew(bed, &changed);
    }
    moved
}
