//! The way of one droplet, in steps of a cell.

use crate::grid::{Edges, Grid};

use super::{kernel::Kernel, window::Window};

/// Slope below which ground has no line of fall.
const LEVEL: f32 = 1e-9;
/// Most of the height to where it came from that a droplet fills up.
const FILL: f32 = 0.5;
/// Share of its path after which a droplet's capacity begins to go to 0, so that it ends in a fan, not in a heap.
const WANES: f32 = 0.5;

/// What a step does.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// Share of its direction that a droplet keeps.
    pub kept_way: f32,
    /// Twice the gravity, m/s².
    pub twice_gravity: f32,
    /// Share of the square of its speed that drag leaves.
    pub slowed: f32,
    /// Load at 1 m/s on a wall, m of a cell.
    pub capacity: f32,
    /// Sine of the slope below which the capacity falls no further.
    pub least_sine: f32,
    /// Share of the free capacity that is taken up.
    pub taken: f32,
    /// Share of what is too much that is laid down.
    pub laid: f32,
    /// Share of the water that does not dry up.
    pub kept_water: f32,
    /// Steps at most.
    pub path: f32,
    /// 1 / cell, 1/m.
    pub per_cell: f32,
}

/// A parcel of rain on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Droplet {
    /// Where it is on the map, cells from the first cell's centre.
    pub at: [f64; 2],
    /// Where it heads; 0 at first.
    pub way: [f32; 2],
    /// Square of its speed, m²/s².
    pub speed2: f32,
    /// Share of its water that has not dried up.
    pub water: f32,
    /// Steps taken.
    pub steps: f32,
    /// Height where it came from, m.
    pub from_m: f32,
    /// What it carries, m of a cell.
    pub load: f64,
}

impl Droplet {
    /// A droplet that falls at a place.
    pub fn new(at: [f64; 2]) -> Self {
        Self { at, way: [0.0; 2], speed2: 0.0, water: 1.0, steps: 0.0, from_m: f32::NEG_INFINITY, load: 0.0 }
    }
}

/// How a way ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// On the map.
    Still,
    /// Over the rim.
    Left,
}

/// The square of the speed after a step that goes down by `drop` m: what gravity gives, less drag.
#[inline(always)]
pub fn faster(speed2: f32, drop: f32, law: &Law) -> f32 {
    (speed2 + law.twice_gravity * drop).max(0.0) * law.slowed
}

/// Runs all droplets of a window's queue.
pub fn run(window: &mut Window, law: &Law, kernel: &Kernel, grid: &Grid, margin: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2")]
        fn in_256(window: &mut Window, law: &Law, kernel: &Kernel, grid: &Grid, margin: usize) {
            run_body(window, law, kernel, grid, margin);
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has these instructions, it was just asked.
            return unsafe { in_256(window, law, kernel, grid, margin) };
        }
    }
    run_body(window, law, kernel, grid, margin);
}

#[inline(always)]
fn run_body(window: &mut Window, law: &Law, kernel: &Kernel, grid: &Grid, margin: usize) {
    for k in 0..window.queue.len() {
        let droplet = window.queue[k];
        step_all(window, droplet, law, kernel, grid, margin);
    }
    window.queue.clear();
}

/// Steps a droplet until it ends or comes near to a cut.
#[inline(always)]
fn step_all(window: &mut Window, mut drop: Droplet, law: &Law, kernel: &Kernel, grid: &Grid, margin: usize) {
    let Some(pieces) = window.pieces else { return };
    // Where its cells can be sampled, and where it may be.
    let most = pieces.map(|piece| piece.size.saturating_sub(2));
    let low = pieces.map(|piece| if piece.rim[0] { 0.0 } else { margin as f32 });
    let high = pieces.map(|piece| piece.size as f32 - 1.0 - if piece.rim[1] { 0.0 } else { margin as f32 });
    let size = [grid.width as f64, grid.height as f64];
    let origin = pieces.map(|piece| piece.from as f64);
    let mut at = [0, 1].map(|k| {
        let local = drop.at[k] - origin[k];
        (if local < 0.0 { local + size[k] } else { local }) as f32
    });
    let sea_m = window.ground.sea_m;
    loop {
        if !(at[0] >= low[0] && at[1] >= low[1] && at[0] <= high[0] && at[1] <= high[1]) {
            let global = [0, 1].map(|k| {
                let v = at[k] as f64 + origin[k];
                if v >= size[k] { v - size[k] } else { v }
            });
            window.later.push(Droplet { at: global, ..drop });
            return;
        }
        let (here_m, fall) = window.ground.sample(at, most);
        if here_m < sea_m || drop.steps >= law.path {
            // A delta, or the end of a fan.
            let level = if here_m < sea_m { sea_m } else { here_m.max(here_m + FILL * (drop.from_m - here_m)) };
            drop.load -= kernel.put(&mut window.ground, at, drop.load as f32, level) as f64;
            return window.book(End::Still, at, drop.load, grid);
        }
        let steep = (fall[0] * fall[0] + fall[1] * fall[1]).sqrt();
        if steep * law.per_cell > LEVEL {
            let turned = (1.0 - law.kept_way) / steep;
            drop.way[0] = drop.way[0] * law.kept_way - fall[0] * turned;
            drop.way[1] = drop.way[1] * law.kept_way - fall[1] * turned;
        }
        let norm = (drop.way[0] * drop.way[0] + drop.way[1] * drop.way[1]).sqrt();
        if norm < 1e-6 {
            return window.book(End::Still, at, drop.load, grid);
        }
        drop.way = [drop.way[0] / norm, drop.way[1] / norm];
        let mut to = [at[0] + drop.way[0], at[1] + drop.way[1]];
        let beyond = |k: usize| (pieces[k].rim[0] && to[k] < 0.0) || (pieces[k].rim[1] && to[k] > high[k]);
        if beyond(0) || beyond(1) {
            if grid.edges == Edges::Open {
                return window.book(End::Left, at, drop.load, grid);
            }
            to = [0, 1].map(|k| if beyond(k) { to[k].clamp(0.0, high[k]) } else { to[k] });
            if (to[0] - at[0]).abs() + (to[1] - at[1]).abs() < 0.01 {
                return window.book(End::Still, at, drop.load, grid);
            }
        }
        let (next_m, _) = window.ground.sample(to, most);
        let down = here_m - next_m;
        drop.speed2 = faster(drop.speed2, down, law);
        drop.water *= law.kept_water;
        drop.steps += 1.0;
        window.steps += 1;
        if down <= 0.0 {
            // What lies before a rise is filled up to it.
            drop.load -= kernel.put(&mut window.ground, at, drop.load as f32, next_m) as f64;
            if drop.speed2 <= 0.0 {
                return window.book(End::Still, at, drop.load, grid);
            }
        } else {
            let slope = down * law.per_cell;
            let sine = (slope / (1.0 + slope * slope).sqrt()).max(law.least_sine);
            let wanes = ((1.0 - drop.steps / law.path) / (1.0 - WANES)).min(1.0);
            let carries = law.capacity * drop.water * wanes * sine * drop.speed2.sqrt();
            let spare = carries - drop.load as f32;
            if spare < 0.0 {
                let level = here_m + (FILL * (drop.from_m - here_m)).max(0.0);
                drop.load -= kernel.put(&mut window.ground, at, -spare * law.laid, level) as f64;
            } else {
                drop.load += kernel.take(&mut window.ground, at, spare * law.taken, next_m) as f64;
            }
        }
        drop.from_m = here_m;
        at = to;
    }
}
