//! What a recording sees of particles that move: frames at their own times, whatever the steps are.
//!
//! Solvers go in blocks of a few steps, in which nobody is born or lost. A frame that is due within a step shows everyone on the
//! way that the step has just gone. What else is known of them changes a block at a time, and lies in proportion between its
//! two ends. Nothing of the flow is changed by being seen.

use super::{Frame, SLACK_S, due_s, frames_by};

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
pub struct Glimpses {
    /// Frames a second; 0: nobody looks.
    per_s: f64,
    /// The next frame.
    next: u64,
    /// When the block began, s.
    began_s: f64,
    /// What else was known of everyone then, a list a column.
    before: Vec<Vec<f64>>,
    seen: Vec<Glimpse>,
}

impl Glimpses {
    /// Looks so many times a second (0: never), behind a moment up to which all has been seen; at 0 nothing has.
    pub fn look(&mut self, per_s: f64, from_s: f64) {
        let next = if from_s > 0.0 && per_s > 0.0 { frames_by(from_s, per_s) } else { 0 };
        *self = Self { per_s, next, ..Self::default() };
    }

    /// Whether a frame is due by then.
    fn due(&self, time_s: f64) -> bool {
        self.per_s > 0.0 && frames_by(time_s, self.per_s) > self.next
    }

    /// A block begins; `others` are the columns besides the place.
    pub fn open(&mut self, began_s: f64, others: impl FnOnce() -> Vec<Vec<f64>>) {
        if self.per_s > 0.0 {
            (self.began_s, self.before) = (began_s, others());
        }
    }

    /// A step of the block is done, so long after the block began: places and velocities after it.
    pub fn pass(&mut self, since_s: f64, place: [&[f32]; 3], velocity: [&[f32]; 3]) {
        let now_s = self.began_s + since_s;
        while self.due(now_s) {
            let time_s = due_s(self.next, self.per_s);
            // A frame at the step's end shows that, and not what rounding makes of it.
            let at_end = (now_s - time_s).abs() <= SLACK_S;
            let back_s = if at_end { 0.0 } else { (now_s - time_s) as f32 };
            let back = |axis: usize| place[axis].iter().zip(velocity[axis]).map(|(at, v)| at - back_s * v).collect();
            let place = [back(0), back(1), back(2)];
            let then_s = if at_end { since_s } else { (time_s - self.began_s).clamp(0.0, since_s) };
            self.seen.push(Glimpse { time_s, since_s: then_s, place });
            self.next += 1;
        }
    }

    /// Nothing moves until then: the empty frames that are due, with so many columns.
    pub fn idle(&mut self, time_s: f64, columns: usize) -> Vec<Frame> {
        let mut frames = Vec::new();
        while self.due(time_s) {
            frames.push(Frame::empty(due_s(self.next, self.per_s), columns));
            self.next += 1;
        }
        frames
    }

    /// The frames of a block that is over and lasted so long. Heights count from `datum_m`; `born` numbers everyone, and `others`
    /// are the columns besides the place as they are now.
    pub fn develop(
        &mut self,
        (lasted_s, datum_m): (f64, f32),
        born: &[u64],
        others: impl FnOnce() -> Vec<Vec<f64>>,
    ) -> Result<Vec<Frame>, String> {
        if self.seen.is_empty() {
            return Ok(Vec::new());
        }
        let mut order: Vec<usize> = (0..born.len()).collect();
        order.sort_unstable_by_key(|&i| born[i]);
        let id: Result<Vec<u32>, _> = order.iter().map(|&i| u32::try_from(born[i])).collect();
        let id =
            id.map_err(|_| format!("a recording numbers {} particles and no more; bake a shorter run", u32::MAX))?;
        let (before, after) = (std::mem::take(&mut self.before), others());
        let develop = |glimpse: Glimpse| {
            let over = glimpse.since_s >= lasted_s;
            let share = if over { 1.0 } else { glimpse.since_s / lasted_s };
            let wide = |axis: usize, from: f64| {
                order.iter().map(|&i| f64::from(glimpse.place[axis][i]) + from).collect::<Vec<f64>>()
            };
            let between = |(a, b): (&Vec<f64>, &Vec<f64>)| {
                order.iter().map(|&i| if over { b[i] } else { a[i] + (b[i] - a[i]) * share }).collect()
            };
            let mut columns = vec![wide(0, 0.0), wide(1, 0.0), wide(2, f64::from(datum_m))];
            columns.extend(before.iter().zip(&after).map(between));
            Frame { time_s: glimpse.time_s, id: id.clone(), columns }
        };
        Ok(std::mem::take(&mut self.seen).into_iter().map(develop).collect())
    }
}
