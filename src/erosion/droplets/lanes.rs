//! Droplets that go on together, one to a lane of a vector.

use super::{ground::Ground, walk::Droplet};

/// Droplets that go on together.
pub const LANES: usize = 8;

/// A value of each lane.
pub type Lane<T = f32> = [T; LANES];

/// The whole part of a number from 0 to a million, as a number and as an index. All lanes at once need few instructions
/// for it; a cast minds what is out of range, lane by lane.
#[inline(always)]
pub fn whole(v: f32) -> (f32, i32) {
    // From here on, numbers have no bits for a fraction.
    const WHOLE: f32 = (1 << 23) as f32;
    let near = (v + WHOLE) - WHOLE;
    let low = if near > v { near - 1.0 } else { near };
    (low, ((low + WHOLE).to_bits() as i32).wrapping_sub(WHOLE.to_bits() as i32))
}

/// Where a droplet may be, cells of its window.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// First and last place that it may go on from.
    pub inner: [[f32; 2]; 2],
    /// The map's rim: infinite where there is a cut.
    pub rim: [[f32; 2]; 2],
    /// Last cell that has one after it.
    pub most: [f32; 2],
}

impl Bounds {
    /// Whether a droplet may go on from a place.
    pub fn holds(&self, at: [f32; 2]) -> bool {
        (0..2).all(|k| at[k] >= self.inner[k][0] && at[k] <= self.inner[k][1])
    }
}

/// Droplets on their way, and where they may be. Places are cells of their windows.
#[derive(Default)]
pub struct Lanes {
    /// As in [`Droplet`].
    pub at: [Lane; 2],
    /// As in [`Droplet`].
    pub way: [Lane; 2],
    /// As in [`Droplet`].
    pub speed2: Lane,
    /// As in [`Droplet`].
    pub water: Lane,
    /// As in [`Droplet`].
    pub steps: Lane,
    /// As in [`Droplet`].
    pub from_m: Lane,
    /// As in [`Droplet`].
    pub load: Lane<f64>,
    /// As in [`Bounds`].
    pub inner: [[Lane; 2]; 2],
    /// As in [`Bounds`].
    pub rim: [[Lane; 2]; 2],
    /// As in [`Bounds`].
    pub most: [Lane; 2],
    /// Cells from a row of the window's ground to the next.
    pub stride: Lane<i32>,
    /// Cells before the first one of a row.
    pub frame: Lane<i32>,
}

impl Lanes {
    /// Puts a droplet that is at `at` of its window into a lane.
    pub fn put(&mut self, l: usize, at: [f32; 2], drop: &Droplet) {
        (self.at[0][l], self.at[1][l]) = (at[0], at[1]);
        (self.way[0][l], self.way[1][l]) = (drop.way[0], drop.way[1]);
        self.speed2[l] = drop.speed2;
        self.water[l] = drop.water;
        self.steps[l] = drop.steps;
        self.from_m[l] = drop.from_m;
        self.load[l] = drop.load;
    }

    /// Leaves a lane empty: what is in it has come to its end and stays where it is.
    pub fn park(&mut self, l: usize) {
        self.put(l, [0.0; 2], &Droplet { steps: f32::INFINITY, ..Droplet::new([0.0; 2]) });
    }

    /// The droplet of a lane; its place is one of its window.
    pub fn droplet(&self, l: usize) -> Droplet {
        Droplet {
            at: [0, 1].map(|k: usize| self.at[k][l] as f64),
            way: [0, 1].map(|k: usize| self.way[k][l]),
            speed2: self.speed2[l],
            water: self.water[l],
            steps: self.steps[l],
            from_m: self.from_m[l],
            load: self.load[l],
        }
    }

    /// Sets where a lane's droplet may be.
    pub fn bound(&mut self, l: usize, bounds: &Bounds, ground: &Ground) {
        (self.stride[l], self.frame[l]) = (ground.stride as i32, ground.frame as i32);
        for k in 0..2 {
            for end in 0..2 {
                self.inner[k][end][l] = bounds.inner[k][end];
                self.rim[k][end][l] = bounds.rim[k][end];
            }
            self.most[k][l] = bounds.most[k];
        }
    }

    /// Where a lane's droplet is.
    #[inline(always)]
    pub fn at(&self, l: usize) -> [f32; 2] {
        [self.at[0][l], self.at[1][l]]
    }

    /// Lanes whose droplets are not where they may be, a bit each.
    #[inline(always)]
    pub fn outside(&self) -> u32 {
        let mut outside = 0;
        for l in 0..LANES {
            let within = |k: usize| (self.at[k][l] >= self.inner[k][0][l]) & (self.at[k][l] <= self.inner[k][1][l]);
            outside |= (!(within(0) & within(1)) as u32) << l;
        }
        outside
    }
}
