//! What a recording sees of flowing lava: frames at their own times, whatever the steps are.
//!
//! A frame that is due within a step shows everyone on the way that the step has just gone. Heat and age change a block at a
//! time, and lie in proportion between its two ends. Nothing of the flow is changed by being seen.

use crate::{
    bake::{self, Column, Frame},
    sph::Cloud,
};

/// Names and units of what is recorded.
pub(super) const COLUMNS: [[&str; 2]; 5] = [["x", "m"], ["y", "m"], ["z", "m"], ["temperature", "degC"], ["age", "s"]];

/// The columns of a recording of lava.
pub(super) fn columns() -> Vec<Column> {
    COLUMNS.iter().map(|[name, unit]| Column::new(name, unit)).collect()
}

/// Where everyone is at a moment, in the order of the block.
#[derive(Clone, Debug)]
struct Glimpse {
    time_s: f64,
    /// Since the block began, s.
    since_s: f64,
    place: [Vec<f32>; 3],
}

/// The glimpses of a block.
#[derive(Clone, Debug, Default)]
pub(super) struct Glimpses {
    /// Frames a second; 0: nobody looks.
    per_s: f64,
    /// The next frame.
    next: u64,
    /// When the block began, s.
    began_s: f64,
    /// Temperatures then, °C; only where somebody looks.
    before: Vec<f64>,
    seen: Vec<Glimpse>,
}

impl Glimpses {
    /// Looks so many times a second, behind a moment up to which all has been seen; `None` if nothing has.
    pub(super) fn look(&mut self, per_s: f64, behind_s: Option<f64>) {
        (self.per_s, self.next) = (per_s, behind_s.map_or(0, |time_s| bake::frames_by(time_s, per_s)));
    }

    /// Whether the block has shown anything.
    pub(super) fn any(&self) -> bool {
        !self.seen.is_empty()
    }

    /// Whether a frame is due by then.
    fn due(&self, time_s: f64) -> bool {
        self.per_s > 0.0 && bake::frames_by(time_s, self.per_s) > self.next
    }

    /// A block begins.
    pub(super) fn open(&mut self, began_s: f64, degc: impl Iterator<Item = f64>) {
        if self.per_s > 0.0 {
            self.began_s = began_s;
            self.before.clear();
            self.before.extend(degc);
        }
    }

    /// A step of the block is done, so long after the block began.
    pub(super) fn pass(&mut self, since_s: f64, cloud: &Cloud) {
        let now_s = self.began_s + since_s;
        while self.due(now_s) {
            let time_s = bake::due_s(self.next, self.per_s);
            let back_s = (now_s - time_s).max(0.0) as f32;
            let back = |at: &[f32], speed: &[f32]| at.iter().zip(speed).map(|(at, v)| at - back_s * v).collect();
            let place = [back(&cloud.x, &cloud.vx), back(&cloud.y, &cloud.vy), back(&cloud.z, &cloud.vz)];
            self.seen.push(Glimpse { time_s, since_s: (time_s - self.began_s).clamp(0.0, since_s), place });
            self.next += 1;
        }
    }

    /// Nothing flows until then.
    pub(super) fn idle(&mut self, time_s: f64) -> Vec<Frame> {
        let mut frames = Vec::new();
        while self.due(time_s) {
            frames.push(Frame::empty(bake::due_s(self.next, self.per_s), COLUMNS.len()));
            self.next += 1;
        }
        frames
    }

    /// The frames of a block that lasted so long and has now cooled.
    pub(super) fn develop(&mut self, lasted_s: f64, datum_m: f32, now: &Now) -> Result<Vec<Frame>, String> {
        let mut order: Vec<usize> = (0..now.born.len()).collect();
        order.sort_unstable_by_key(|&i| now.born[i]);
        let number = |&i: &usize| u32::try_from(now.born[i]);
        let id: Vec<u32> = order.iter().map(number).collect::<Result<_, _>>().map_err(|_| {
            format!("a recording numbers at most {} particles; bake a shorter or coarser eruption", u32::MAX)
        })?;
        let before = &self.before;
        let develop = |glimpse: Glimpse| {
            let share = if lasted_s > 0.0 { glimpse.since_s / lasted_s } else { 1.0 };
            let wide = |values: &[f32], off: f64| order.iter().map(|&i| f64::from(values[i]) + off).collect();
            let [x, y, z] = &glimpse.place;
            let heat = order.iter().map(|&i| before[i] + (now.degc[i] - before[i]) * share).collect();
            let ages =
                order.iter().map(|&i| (f64::from(now.age_s[i]) - (lasted_s - glimpse.since_s)).max(0.0)).collect();
            let columns = vec![wide(x, 0.0), wide(y, 0.0), wide(z, f64::from(datum_m)), heat, ages];
            Frame { time_s: glimpse.time_s, id: id.clone(), columns }
        };
        Ok(std::mem::take(&mut self.seen).into_iter().map(develop).collect())
    }
}

/// What a block has made of everyone.
pub(super) struct Now<'a> {
    pub(super) born: &'a [u64],
    pub(super) degc: Vec<f64>,
    pub(super) age_s: &'a [f32],
}
