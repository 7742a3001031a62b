//! What a droplet takes and lays down around it: a cone whose tip is at the droplet, not at a cell's centre.

use super::{super::bed::Coast, ground::Ground, lanes::whole};

/// Narrowest radius, cells: below it the cone would fall between the cells.
pub const LEAST_RADIUS: f64 = 1.5;
/// Places of the tip within a cell, a side.
const PLACES: usize = 4;
/// Cells that are worked on together.
const RUN: usize = 8;
/// A value of each of them.
pub type Run = [f32; RUN];
/// Most of the height above the next place of its path that a droplet takes from a cell.
const CUT: f32 = 0.5;

/// Weights of the cells around a tip; their sum is 1 for every place of the tip.
pub struct Kernel {
    /// Cells on either side of the tip's.
    pub reach: usize,
    /// Runs of lanes in a row of weights.
    runs: usize,
    weights: Vec<Run>,
    /// The rows that weigh anything, for every place of the tip.
    spans: Vec<[usize; 2]>,
}

/// What is done to the cells around a droplet.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// The cell that the droplet is in.
    pub cell: [usize; 2],
    /// Which of the places within it, row by row.
    pub place: usize,
    /// Taken or laid down in all, m of a cell.
    pub amount: f32,
    /// Height that is not dug below or not built above, m.
    pub bound_m: f32,
    /// Share of the height up to the bound that may be laid down: below 0 to take what is above it.
    pub part: f32,
    /// 1 to lay down, -1 to take.
    pub sign: f32,
}

/// The share of the height up to a bound, and the sign, of what lays down.
pub const LAYS: [f32; 2] = [1.0, 1.0];
/// The same of what takes.
pub const TAKES: [f32; 2] = [-CUT, -1.0];

impl Kernel {
    /// A cone of this radius in cells.
    pub fn new(radius: f64) -> Self {
        let reach = (radius + 0.5).floor() as usize;
        let side = 2 * reach + 1;
        let row = side.next_multiple_of(RUN);
        let mut weights = vec![0.0; PLACES * PLACES * side * row];
        let mut spans = Vec::new();
        for (place, weights) in weights.chunks_exact_mut(side * row).enumerate() {
            let tip = [place % PLACES, place / PLACES].map(|p| (p as f64 + 0.5) / PLACES as f64 - 0.5);
            let away = |x: usize, y: usize| {
                let [dx, dy] = [x as f64 - reach as f64 - tip[0], y as f64 - reach as f64 - tip[1]];
                (1.0 - (dx * dx + dy * dy).sqrt() / radius).max(0.0)
            };
            let sum: f64 = (0..side * side).map(|i| away(i % side, i / side)).sum();
            for (i, weight) in weights.iter_mut().enumerate().filter(|(i, _)| i % row < side) {
                *weight = (away(i % row, i / row) / sum) as f32;
            }
            let weighs = |y: &usize| weights[y * row..][..row].iter().any(|&weight| weight > 0.0);
            let first = (0..side).find(weighs).unwrap_or(0);
            spans.push([first, (0..side).rev().find(weighs).map_or(first, |last| last + 1)]);
        }
        Self { reach, runs: row / RUN, weights: weights.as_chunks().0.to_vec(), spans }
    }

    /// Columns beyond a window that a row of weights may touch, if only with weight 0.
    pub fn overhang(&self) -> usize {
        self.runs * RUN
    }

    /// The cell that a point is in, and which of the places within it.
    #[inline(always)]
    pub fn place([x, y]: [f32; 2]) -> ([i32; 2], i32) {
        let ((left, column), (top, row)) = (whole(x + 0.5), whole(y + 0.5));
        let part = |v: f32| whole(v * PLACES as f32).1.min(PLACES as i32 - 1);
        ([column, row], part(y + 0.5 - top) * PLACES as i32 + part(x + 0.5 - left))
    }

    /// Works on the cells around a droplet; what was really added, to be summed up.
    #[inline(always)]
    pub fn work(&self, ground: &mut Ground, work: &Work, coast: Option<Coast>) -> Run {
        // What most kernels are gets loops of its own.
        match (self.runs, coast) {
            (1, None) => self.work_on(ground, work, 1, |_, _, new| new),
            (runs, None) => self.work_on(ground, work, runs, |_, _, new| new),
            (runs, Some(coast)) => {
                self.work_on(ground, work, runs, |start, old, new| keep_sides(coast, start, old, &new))
            }
        }
    }

    /// Works on rows of so many runs of lanes. `keep(start, old, new)` has the last word on what changes.
    #[inline(always)]
    fn work_on(&self, ground: &mut Ground, work: &Work, runs: usize, keep: impl Fn(&Run, &Run, Run) -> Run) -> Run {
        let (side, [x, y]) = (2 * self.reach + 1, work.cell);
        // The rows that weigh anything and are on the map.
        let span = self.spans[work.place];
        let (from, to) = (span[0].max(self.reach.saturating_sub(y)), span[1].min(ground.rows + self.reach - y));
        // The frame is as wide as the overhang, so that no index is below 0.
        let mut first = ground.framed(x, y + from - self.reach) - self.reach;
        let mut of_rate = first - (y + from - self.reach) * (ground.stride - ground.rate_stride);
        let mut of_weights = (work.place * side + from) * runs;
        let start = &ground.start[..];
        let change = &mut ground.change[..start.len()];
        let mut added = [0.0; RUN];
        for _ in from..to {
            for run in 0..runs {
                let at = first + run * RUN;
                // They are all there, thanks to the frame.
                let Some(start) = start[at..].first_chunk::<RUN>() else { break };
                let Some(change) = change[at..].first_chunk_mut::<RUN>() else { break };
                let Some(rate) = ground.rate[of_rate + run * RUN..].first_chunk::<RUN>() else { break };
                let old = *change;
                let new = keep(start, &old, work.changed(&self.weights[of_weights + run], rate, start, &old));
                for i in 0..RUN {
                    added[i] += new[i] - old[i];
                }
                *change = new;
            }
            first += ground.stride;
            of_rate += ground.rate_stride;
            of_weights += runs;
        }
        added
    }
}

impl Work {
    /// Changes of cells after this was done to them.
    #[inline(always)]
    fn changed(&self, weights: &Run, rate: &Run, start: &Run, old: &Run) -> Run {
        let mut new = [0.0; RUN];
        for i in 0..RUN {
            let room = (self.part * (self.bound_m - (start[i] + old[i]))).max(0.0);
            let share = weights[i] * rate[i] * self.amount;
            new[i] = old[i] + self.sign * if share < room { share } else { room };
        }
        new
    }
}

/// New changes that go at most half the way to the sea's level, and never over it.
#[inline(always)]
fn keep_sides(coast: Coast, start: &Run, old: &Run, new: &Run) -> Run {
    let mut kept = [0.0; RUN];
    for i in 0..RUN {
        let height = start[i] + old[i];
        let room = coast.room(height);
        let changed = old[i] + (new[i] - old[i]).max(-room).min(room);
        // Half the way may round to the whole.
        let crosses = coast.crosses(height, start[i] + changed);
        kept[i] = if crosses { old[i] } else { changed };
    }
    kept
}
