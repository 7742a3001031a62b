//! Rivers as lines: the network of cells is cut into main stems, and each becomes a smooth line that keeps to its valley.
//!
//! At a confluence the donor of greatest discharge goes on as the river, the others end on its line. A river also ends in
//! the sea, in a lake, or at the rim; what leaves a lake is another river.

use crate::grid::{Edges, Grid};

use super::{bed::Beds, waters::Waters};

/// Where a river ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Into {
    /// In the sea.
    Sea,
    /// In the lake of that number.
    Lake(u32),
    /// In the river of that number.
    River(u32),
    /// Beyond the map.
    Rim,
    /// Over the seam of a seamless map, where it goes on as the river of that number.
    Seam(u32),
    /// In the ground's lowest place, where it stays.
    Sink,
}

/// A point of a river.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Place, m.
    pub at_m: [f64; 2],
    /// Height of the bed, at its ends that of the water it meets, m.
    pub z_m: f64,
    /// A year's mean, m³/s.
    pub discharge_m3_s: f64,
    /// Strahler's order.
    pub order: u8,
}

/// A river from its head to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct River {
    /// Points downstream.
    pub points: Vec<Point>,
    /// Its end.
    pub into: Into,
    /// The lake it leaves at its head.
    pub from_lake: Option<u32>,
}

/// What courses are found from.
pub struct Network<'a> {
    /// The waters.
    pub waters: &'a Waters,
    /// The ground they run in.
    pub beds: &'a Beds,
    /// Height of the sea, m.
    pub sea_m: f64,
    /// Strahler's order; 0 for what is no river.
    pub order: &'a [u8],
}

/// The last point of a line, m, and the height there, m.
type End = ([f64; 2], f64);

const NONE: u32 = u32::MAX;

impl Network<'_> {
    fn grid(&self) -> Grid {
        self.waters.way.grid
    }

    fn is_sea(&self, i: usize) -> bool {
        self.waters.way.is_outlet(i) && self.beds.ground_m[i] <= self.sea_m
    }

    /// Whether a river runs in a cell.
    fn runs(&self, i: usize) -> bool {
        self.order[i] > 0 && self.waters.lake_of[i] == 0 && !self.is_sea(i)
    }

    /// Whether the way from a cell leads over the seam of a seamless map.
    fn over_seam(&self, i: usize) -> bool {
        let (grid, r) = (self.grid(), self.waters.way.receiver[i] as usize);
        let ((x, y), (rx, ry)) = (grid.cell_of(i), grid.cell_of(r));
        grid.edges == Edges::Wrap && (x.abs_diff(rx) > 1 || y.abs_diff(ry) > 1)
    }

    /// The rivers, largest at their ends first; a river's number is its place in the list, from 1.
    pub fn rivers(&self) -> Vec<River> {
        let cells = self.order.len();
        let (q, receiver) = (&self.waters.discharge_m3_s, &self.waters.way.receiver);
        // The donor that goes on as the river: a river's or a lake's cell.
        let mut main = vec![NONE; cells];
        for i in (0..cells).filter(|&i| self.order[i] > 0 && !self.is_sea(i)) {
            let r = receiver[i] as usize;
            if r != i && self.runs(r) && !self.over_seam(i) && (main[r] == NONE || q[i] > q[main[r] as usize]) {
                main[r] = i as u32;
            }
        }
        let ends = |i: usize| main[receiver[i] as usize] != i as u32;
        let mut mouths: Vec<u32> = (0..cells).filter(|&i| self.runs(i) && ends(i)).map(|i| i as u32).collect();
        mouths.sort_by(|&a, &b| q[b as usize].total_cmp(&q[a as usize]).then(a.cmp(&b)));
        // Where the line of a river passes each of its cells, and whose it is.
        let mut passed = vec![(NONE, [0.0; 2]); cells];
        let mut rivers: Vec<River> = Vec::new();
        for &mouth in &mouths {
            let mut stem = vec![mouth as usize];
            while let Some(&last) = stem.last()
                && self.runs(last)
                && main[last] != NONE
            {
                stem.push(main[last] as usize);
            }
            stem.reverse();
            let Some((end, into)) = self.end(mouth as usize, &passed) else { continue };
            if let Some(river) = self.line(&stem, end, into, &mut passed, rivers.len()) {
                rivers.push(river);
            }
        }
        rivers
    }

    /// Where the line of a river ends that has its last cell here: the place, its height, and what is there.
    fn end(&self, mouth: usize, passed: &[(u32, [f64; 2])]) -> Option<(Option<End>, Into)> {
        let (grid, r) = (self.grid(), self.waters.way.receiver[mouth] as usize);
        let center = |i: usize| {
            let (x, y) = grid.cell_of(i);
            grid.center_m(x, y)
        };
        let ground = |i: usize| self.beds.ground_m[i];
        let at = center(mouth);
        if r == mouth {
            let rim = grid.edges == Edges::Open;
            return Some(match rim.then(|| beyond(grid, mouth)).flatten() {
                Some(edge) => (Some((edge, ground(mouth))), Into::Rim),
                None => (None, Into::Sink),
            });
        }
        if self.over_seam(mouth) {
            // The river goes on at the other side under another number.
            let next = passed[r].0;
            let into = if next == NONE { Into::Rim } else { Into::Seam(next + 1) };
            return Some((beyond(grid, mouth).map(|edge| (edge, ground(mouth))), into));
        }
        if self.is_sea(r) {
            let (high, low) = (ground(mouth), ground(r));
            let t = if high > low { ((high - self.sea_m) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
            let to = center(r);
            let coast = [at[0] + (to[0] - at[0]) * t, at[1] + (to[1] - at[1]) * t];
            return Some((Some((coast, self.sea_m)), Into::Sea));
        }
        match self.waters.lake_of[r] {
            0 => {
                let (river, place) = passed[r];
                // The larger river comes first; a cell that none passed belongs to one too short to be drawn.
                (river != NONE).then(|| (Some((place, ground(r))), Into::River(river + 1)))
            }
            lake => Some((Some((center(r), self.beds.surface_m[r])), Into::Lake(lake))),
        }
    }

    fn line(
        &self,
        stem: &[usize],
        end: Option<End>,
        into: Into,
        passed: &mut [(u32, [f64; 2])],
        number: usize,
    ) -> Option<River> {
        let grid = self.grid();
        let mut places: Vec<[f64; 2]> = stem
            .iter()
            .map(|&i| {
                let (x, y) = grid.cell_of(i);
                grid.center_m(x, y)
            })
            .collect();
        places.extend(end.map(|(place, _)| place));
        if places.len() < 2 {
            return None;
        }
        relax(&mut places, grid.cell_m);
        for (&i, &place) in stem.iter().zip(&places).filter(|(i, _)| self.runs(**i)) {
            passed[i] = (number as u32, place);
        }
        let q = &self.waters.discharge_m3_s;
        let lake = self.waters.lake_of[stem[0]];
        let nodes: Vec<Point> = places
            .iter()
            .enumerate()
            .map(|(k, &at_m)| {
                let i = stem[k.min(stem.len() - 1)];
                let z_m = match (stem.get(k), end) {
                    (None, Some((_, z_m))) => z_m,
                    (Some(&i), _) if self.waters.lake_of[i] > 0 => self.beds.surface_m[i],
                    _ => self.beds.ground_m[i],
                };
                Point { at_m, z_m, discharge_m3_s: q[i].max(0.0), order: self.order[i] }
            })
            .collect();
        Some(River { points: refine(&nodes), into, from_lake: (lake > 0).then_some(lake) })
    }
}

/// The point of the rim nearest to a cell that touches it.
fn beyond(grid: Grid, i: usize) -> Option<[f64; 2]> {
    let (x, y) = grid.cell_of(i);
    let [px, py] = grid.center_m(x, y);
    let [w, h] = grid.extent_m();
    let sides =
        [(x == 0, [0.0, py]), (x + 1 == grid.width, [w, py]), (y == 0, [px, 0.0]), (y + 1 == grid.height, [px, h])];
    sides.into_iter().find(|(touches, _)| *touches).map(|(_, edge)| edge)
}

/// Takes the stairs out of a line through cell centres: every inner point moves to the middle of its neighbours again and
/// again, but never farther than `REACH` cells from where it was, so that the line stays in its valley.
fn relax(places: &mut [[f64; 2]], cell_m: f64) {
    const ROUNDS: usize = 12;
    const REACH: f64 = 0.8;
    let home = places.to_vec();
    let mut old = home.clone();
    for _ in 0..ROUNDS {
        old.copy_from_slice(places);
        for k in 1..places.len().saturating_sub(1) {
            for c in 0..2 {
                let middle = 0.25 * old[k - 1][c] + 0.5 * old[k][c] + 0.25 * old[k + 1][c];
                places[k][c] = middle.clamp(home[k][c] - REACH * cell_m, home[k][c] + REACH * cell_m);
            }
        }
    }
}

/// Puts a point between any two, on the cubic through their neighbours; what is there stays to the bit.
fn refine(nodes: &[Point]) -> Vec<Point> {
    let mut points = Vec::with_capacity(2 * nodes.len());
    for (k, pair) in nodes.windows(2).enumerate() {
        let (a, b) = (pair[0], pair[1]);
        let (before, after) = (nodes[k.saturating_sub(1)], nodes[(k + 2).min(nodes.len() - 1)]);
        let mut at_m = [0.0; 2];
        for (c, at) in at_m.iter_mut().enumerate() {
            *at = (9.0 * (a.at_m[c] + b.at_m[c]) - before.at_m[c] - after.at_m[c]) / 16.0;
        }
        let half = |p: f64, q: f64| p + 0.5 * (q - p);
        points.push(a);
        points.push(Point {
            at_m,
            z_m: half(a.z_m, b.z_m),
            discharge_m3_s: half(a.discharge_m3_s, b.discharge_m3_s),
            order: a.order,
        });
    }
    points.extend(nodes.last());
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_staircase_becomes_nearly_straight() {
        // Two east, one south-east: the stairs of a direction between two of the eight.
        let mut at = [0.0, 0.0];
        let mut places = vec![at];
        for k in 0..60 {
            at = [at[0] + 1.0, at[1] + f64::from(k % 3 == 2)];
            places.push(at);
        }
        let turn = |places: &[[f64; 2]]| {
            let angle = |w: &[[f64; 2]]| (w[1][1] - w[0][1]).atan2(w[1][0] - w[0][0]);
            let angles: Vec<f64> = places.windows(2).map(angle).collect();
            angles[5..55].windows(2).map(|w| (w[1] - w[0]).abs().to_degrees()).fold(0.0, f64::max)
        };
        assert!(turn(&places) > 40.0);
        relax(&mut places, 1.0);
        assert!(turn(&places) < 2.0, "{}", turn(&places));
        assert_eq!((places[0], places[60]), ([0.0, 0.0], at));
    }
}
