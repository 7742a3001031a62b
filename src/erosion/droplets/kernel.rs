//! What a droplet takes and lays down around it: a cone whose tip is at the droplet, not at a cell's centre.

use super::window::Ground;

/// Narrowest radius, cells: below it the cone would fall between the cells.
pub const LEAST_RADIUS: f64 = 1.5;
/// Places of the tip within a cell, a side.
const PLACES: usize = 4;
/// Cells that are worked on together.
const LANES: usize = 8;
/// Most of the height above the next place of its path that a droplet takes from a cell.
const CUT: f32 = 0.5;

/// Weights of the cells around a tip; their sum is 1 for every place of the tip.
pub struct Kernel {
    /// Cells on either side of the tip's.
    pub reach: usize,
    /// Cells in a row of weights, a multiple of the lanes.
    row: usize,
    weights: Vec<f32>,
}

impl Kernel {
    /// A cone of this radius in cells.
    pub fn new(radius: f64) -> Self {
        let reach = (radius + 0.5).floor() as usize;
        let (side, row) = (2 * reach + 1, (2 * reach + 1).next_multiple_of(LANES));
        let mut weights = vec![0.0; PLACES * PLACES * side * row];
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
        }
        Self { reach, row, weights }
    }

    /// Cells beyond a window that a row of weights may touch, if only with weight 0.
    pub fn overhang(&self) -> usize {
        self.row
    }

    /// Takes up to `amount` (m of a cell) around a point, nothing from below `floor`; what was taken.
    #[inline(always)]
    pub fn take(&self, ground: &mut Ground, at: [f32; 2], amount: f32, floor: f32) -> f32 {
        -self.change(ground, at, |height, share| -(share * amount).min((CUT * (height - floor)).max(0.0)))
    }

    /// Lays down up to `amount` (m of a cell) around a point, nothing above `level`; what was laid down.
    #[inline(always)]
    pub fn put(&self, ground: &mut Ground, at: [f32; 2], amount: f32, level: f32) -> f32 {
        self.change(ground, at, |height, share| (share * amount).min((level - height).max(0.0)))
    }

    /// Adds `by(height, weight)` to the cells around a point; the sum of what was really added.
    #[inline(always)]
    fn change(&self, ground: &mut Ground, at: [f32; 2], by: impl Fn(f32, f32) -> f32) -> f32 {
        let (cell, place) = (at.map(|v| (v + 0.5) as usize), |v: f32, cell: usize| {
            (((v + 0.5 - cell as f32) * PLACES as f32) as usize).min(PLACES - 1)
        });
        let place = place(at[1], cell[1]) * PLACES + place(at[0], cell[0]);
        let side = 2 * self.reach + 1;
        let size = side * self.row;
        let weights = &self.weights[place * size..][..size];
        let (locked, sea_m) = (ground.locked, ground.sea_m);
        let mut added = [0.0f32; LANES];
        for (k, weights) in weights.chunks_exact(self.row).enumerate() {
            // Windows have a frame as wide as the overhang, so that no index is below 0.
            let first = ground.framed(cell[0], cell[1] + k) - self.reach - self.reach * ground.stride;
            let weights = weights.as_chunks::<LANES>().0;
            let start = ground.start[first..][..self.row].as_chunks::<LANES>().0;
            let rate = ground.rate[first..][..self.row].as_chunks::<LANES>().0;
            let change = ground.change[first..][..self.row].as_chunks_mut::<LANES>().0;
            for (((weights, start), rate), change) in weights.iter().zip(start).zip(rate).zip(change) {
                let old = *change;
                let mut new = [0.0f32; LANES];
                for i in 0..LANES {
                    new[i] = old[i] + by(start[i] + old[i], weights[i] * rate[i]);
                }
                if locked {
                    new = keep_sides(sea_m, start, &old, &new);
                }
                for i in 0..LANES {
                    added[i] += new[i] - old[i];
                }
                *change = new;
            }
        }
        added.iter().sum()
    }
}

/// New changes that go at most half the way to the sea's level, and never over it.
#[inline(always)]
fn keep_sides(sea_m: f32, start: &[f32; LANES], old: &[f32; LANES], new: &[f32; LANES]) -> [f32; LANES] {
    let mut kept = [0.0f32; LANES];
    for i in 0..LANES {
        let height = start[i] + old[i];
        let room = 0.5 * (height - sea_m).abs();
        let changed = old[i] + (new[i] - old[i]).max(-room).min(room);
        // Half the way may round to the whole.
        let crosses = (height < sea_m) != (start[i] + changed < sea_m);
        kept[i] = if crosses { old[i] } else { changed };
    }
    kept
}
