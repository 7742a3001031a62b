//! The two passes of an iteration over a row of cells.
//!
//! Their loops have no branch, so that they run in whatever vectors a processor has. All widths do the same arithmetic
//! in the same order: the same bits.

use super::{
    super::bed::{Bed, Coast},
    params::Steepness,
    rim::DIAGONAL,
};

/// Depth below which a ratio to it means nothing, m.
const DRY: f32 = 1e-20;
/// Most of the fall to the lowest neighbour that a cell loses in an iteration.
const CUT: f32 = 0.2;
/// Most of the rise to the highest neighbour that gives water by which a cell is filled up in an iteration.
const FILL: f32 = 0.2;

/// Slope of both banks at which water cuts no deeper between them, 45°: what it would cut falls in from the sides, and
/// slots of one cell's width are no valleys.
const BANKS: f32 = 1.0;

/// What an iteration does.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// Rain, m.
    pub rain_m: f32,
    /// Share of the water that does not dry up.
    pub kept: f32,
    /// Rock that a metre of water dissolves, m.
    pub dissolved: f32,
    /// Rock that a metre of water carries on the steepest slope, m.
    pub capacity: f32,
    /// Share of that on level ground.
    pub flat: f32,
    /// 1 / cell, 1/m.
    pub per_cell: f32,
    /// How long it takes, s.
    pub iteration_s: f64,
    /// Which slopes resist.
    pub steepness: Steepness,
    /// The sea, and how far heights stay from it.
    pub coast: Coast,
    /// Whether land stays land, and sea sea.
    pub locked: bool,
}

impl Law {
    /// The same over a bed.
    pub fn over(self, bed: &Bed) -> Self {
        Self { coast: Coast { sea_m: bed.sea_m, margin_m: bed.margin_m }, locked: bed.locked, ..self }
    }
}

/// A row of a ringed raster and the rows beside it: cell `x` is at `x + 1`.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    north: &'a [f32],
    here: &'a [f32],
    south: &'a [f32],
}

impl<'a> Around<'a> {
    /// The rows around row `y` of the map.
    pub fn of(data: &'a [f32], y: usize, stride: usize) -> Self {
        let row = |y: usize| &data[y * stride..][..stride];
        Self { north: row(y), here: row(y + 1), south: row(y + 2) }
    }

    /// The eight neighbours of `width` cells, those across a side first, then those across a corner.
    #[inline(always)]
    fn eight(&self, width: usize) -> [&'a [f32]; 8] {
        let cut = |row: &'a [f32], from: usize| &row[from..][..width];
        [
            cut(self.north, 1),
            cut(self.here, 0),
            cut(self.here, 2),
            cut(self.south, 1),
            cut(self.north, 0),
            cut(self.north, 2),
            cut(self.south, 0),
            cut(self.south, 2),
        ]
    }
}

/// The sum of what passes to or from the eight neighbours, in the same order. What one cell gives is to the bit what others
/// take, and in double precision the sums of both are as good as exact.
#[inline(always)]
fn whole(parts: [f32; 8]) -> f64 {
    let [n, w, e, s, nw, ne, sw, se] = parts.map(f64::from);
    ((n + s) + (w + e)) + ((nw + se) + (ne + sw))
}

/// Sums over the four neighbours across a side and the four across a corner, opposite ones first, so that turned and
/// mirrored ground gives the same bits.
#[inline(always)]
fn sides_and_corners([n, w, e, s, nw, ne, sw, se]: [f32; 8]) -> [f32; 2] {
    [(n + s) + (w + e), (nw + se) + (ne + sw)]
}

/// Defines a function that runs a body in the widest vectors there are.
macro_rules! widest {
    ($(#[$doc:meta])* $name:ident = $body:ident($($arg:ident: $kind:ty),* $(,)?)) => {
        $(#[$doc])*
        pub fn $name($($arg: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw")]
                fn in_512($($arg: $kind),*) {
                    $body($($arg),*)
                }
                #[target_feature(enable = "avx2")]
                fn in_256($($arg: $kind),*) {
                    $body($($arg),*)
                }
                let wide = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
                if wide && is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512bw") {
                    // SAFETY: the processor has these instructions, it was just asked.
                    return unsafe { in_512($($arg),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: as above.
                    return unsafe { in_256($($arg),*) };
                }
            }
            $body($($arg),*)
        }
    };
}

widest! {
    /// What leaves a row: `flow` and `drift` get water and load by unit of weighted fall; `water` and `load` lose them.
    leave = leave_body(level: Around, flow: &mut [f32], drift: &mut [f32], water: &mut [f32], load: &mut [f64])
}

widest! {
    /// What arrives in a row, dries up, is laid down, rains and is dissolved. `around` holds level, flow and drift,
    /// `ground` the heights at the start and the rates.
    arrive = arrive_body(law: &Law, around: [Around; 3], ground: [&[f32]; 2], next: &mut [f32], water: &mut [f32],
        load: &mut [f64], change: &mut [f32])
}

#[inline(always)]
pub fn leave_body(level: Around, flow: &mut [f32], drift: &mut [f32], water: &mut [f32], load: &mut [f64]) {
    let width = water.len();
    let (flow, drift, load) = (&mut flow[..width], &mut drift[..width], &mut load[..width]);
    let (here, near) = (&level.here[1..][..width], level.eight(width));
    for x in 0..width {
        let (mut falls, mut lower) = ([0.0; 8], 1.0);
        for (fall, near) in falls.iter_mut().zip(near) {
            *fall = (here[x] - near[x]).max(0.0);
            lower += if *fall > 0.0 { 1.0 } else { 0.0 };
        }
        let [side, corner] = sides_and_corners(falls);
        // Above the mean level of the cell and its lower neighbours.
        let above = (side + corner) / lower;
        let out = water[x].min(above);
        let by_fall = out / (side + corner * DIAGONAL).max(DRY);
        let laden = load[x] as f32 / water[x].max(DRY);
        let by_load = by_fall * laden;
        let mut given = [0.0; 8];
        for k in 0..8 {
            let part = if k < 4 { 1.0 } else { DIAGONAL };
            given[k] = by_load * (falls[k] * part);
        }
        flow[x] = by_fall;
        drift[x] = by_load;
        water[x] -= out;
        load[x] -= whole(given);
    }
}

#[inline(always)]
pub fn arrive_body(
    law: &Law,
    around: [Around; 3],
    ground: [&[f32]; 2],
    next: &mut [f32],
    water: &mut [f32],
    load: &mut [f64],
    change: &mut [f32],
) {
    // The choice is made once a row, not once a cell.
    match law.steepness {
        Steepness::Even => arrive_with(law, around, ground, next, water, load, change, |_| 1.0),
        Steepness::HardCliffs => arrive_with(law, around, ground, next, water, load, change, |cos| cos * cos * cos),
        Steepness::SoftCliffs => {
            arrive_with(law, around, ground, next, water, load, change, |cos| (1.0 - cos) * (1.0 - cos) * (1.0 - cos));
        }
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn arrive_with(
    law: &Law,
    around: [Around; 3],
    ground: [&[f32]; 2],
    next: &mut [f32],
    water: &mut [f32],
    load: &mut [f64],
    change: &mut [f32],
    soft: impl Fn(f32) -> f32,
) {
    let width = water.len();
    let (next, load, change) = (&mut next[..width], &mut load[..width], &mut change[..width]);
    let [start, rate] = ground.map(|data| &data[..width]);
    let here = &around[0].here[1..][..width];
    let [level, flow, drift] = around.map(|data| data.eight(width));
    let (coast, free) = (law.coast, if law.locked { 0.0 } else { f32::INFINITY });
    for x in 0..width {
        let (mut wets, mut rocks, mut rises, mut fall, mut above) = ([0.0; 8], [0.0; 8], [0.0f32; 8], 0.0f32, 0.0f32);
        for k in 0..8 {
            let part = if k < 4 { 1.0 } else { DIAGONAL };
            let rise = (level[k][x] - here[x]) * part;
            let down = rise.max(0.0);
            rises[k] = rise;
            wets[k] = flow[k][x] * down;
            rocks[k] = drift[k][x] * down;
            fall = fall.max(-rise);
            above = above.max(if flow[k][x] > 0.0 { down } else { 0.0 });
        }
        let [side, corner] = sides_and_corners(wets);
        let wet = side + corner;
        // The lower bank across the way, whichever that is.
        let [n, w, e, s, nw, ne, sw, se] = rises;
        let banks = n.min(s).max(w.min(e)).max(nw.min(se).max(ne.min(sw)));
        let open = (1.0 - banks * law.per_cell / BANKS).clamp(0.0, 1.0);
        let height = start[x] + change[x];
        let sea = height < coast.sea_m;
        let slope = fall * law.per_cell;
        let cos = 1.0 / (1.0 + slope * slope).sqrt();
        let wet = (water[x] + wet) * law.kept;
        let all = load[x] + whole(rocks);
        let rock = all as f32;
        let can = law.capacity * wet * (law.flat + (1.0 - law.flat) * slope * cos);
        let wet = if sea { 0.0 } else { wet + law.rain_m };
        // No higher than the water, and than half the way to where it comes from.
        let laid = if sea { rock } else { (rock - can).max(0.0).min(wet + FILL * above) };
        let taken = (law.dissolved * wet * soft(cos) * open).min(CUT * fall);
        let room = free.max(coast.room(height));
        let moves = ((laid - taken) * rate[x]).max(-room).min(room);
        let changed = change[x] + moves;
        // Half the way may round to the whole.
        let crosses = coast.crosses(height, start[x] + changed);
        let changed = if law.locked & crosses { change[x] } else { changed };
        // What single precision rounds away of the bed stays in the water.
        load[x] = all - (f64::from(changed) - f64::from(change[x]));
        change[x] = changed;
        water[x] = wet;
        next[x] = (start[x] + changed).max(coast.sea_m) + wet;
    }
}
