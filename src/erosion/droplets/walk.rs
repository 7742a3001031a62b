//! What a droplet is, and what a step of a cell does to it.

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
