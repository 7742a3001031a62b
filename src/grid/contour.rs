//! Contours of a field by marching squares, as lines or as rings around what is higher.
//!
//! Values are linear between cell centres and constant from the outermost centres to the map's rim. A square whose
//! opposite corners are higher is decided by its middle. Rims never wrap.

use super::Field;

/// A contour line, with the higher ground on its right as it is walked (x to the east, y to the south).
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Points, m; the first is not repeated at the end of a closed line.
    pub points: Vec<[f64; 2]>,
    /// Whether the line returns to its beginning.
    pub closed: bool,
}

impl Contour {
    /// The area inside a closed line, m²: positive around higher ground, negative around lower.
    pub fn area_m2(&self) -> f64 {
        let next = self.points.iter().cycle().skip(1);
        0.5 * self.points.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>()
    }
}

/// Lines where the field passes `level`; they end on the rim of the map.
pub fn contour_lines(field: &Field<f32>, level: f32) -> Vec<Contour> {
    trace(&Lattice { field, ring: 1 }, level)
}

/// Rings around all that is above `level`, closed along the rim of the map; rings around holes turn the other way.
pub fn contour_rings(field: &Field<f32>, level: f32) -> Vec<Contour> {
    trace(&Lattice { field, ring: 2 }, level)
}

/// The cell centres with one ring of nodes on the map's rim, and for rings a second there, which is below everything.
struct Lattice<'a> {
    field: &'a Field<f32>,
    ring: usize,
}

impl Lattice<'_> {
    fn size(&self) -> [usize; 2] {
        [self.field.grid.width + 2 * self.ring, self.field.grid.height + 2 * self.ring]
    }

    fn value(&self, i: usize, j: usize) -> f32 {
        let [w, h] = self.size();
        if self.ring == 2 && (i == 0 || j == 0 || i + 1 == w || j + 1 == h) {
            return f32::NEG_INFINITY;
        }
        let cell = |at: usize, size: usize| at.saturating_sub(self.ring).min(size - 1);
        self.field.at(cell(i, self.field.grid.width), cell(j, self.field.grid.height))
    }

    fn row(&self, j: usize, out: &mut Vec<f32>) {
        out.clear();
        out.extend((0..self.size()[0]).map(|i| self.value(i, j)));
    }

    fn place(&self, i: usize, j: usize) -> [f64; 2] {
        let grid = &self.field.grid;
        let along = |at: usize, size: usize| {
            let cells = at as f64 - self.ring as f64 + 0.5;
            cells.clamp(0.0, size as f64) * grid.cell_m
        };
        [along(i, grid.width), along(j, grid.height)]
    }

    /// Where the edge of that number passes the level.
    fn crossing(&self, edge: u32, level: f32) -> [f64; 2] {
        let (node, down) = ((edge / 2) as usize, (edge % 2) as usize);
        let (i, j) = (node % self.size()[0], node / self.size()[0]);
        let (k, l) = (i + 1 - down, j + down);
        // Always from the lower end, so that both squares at an edge get the same bits.
        let ((i, j), (k, l)) = if self.value(i, j) <= self.value(k, l) { ((i, j), (k, l)) } else { ((k, l), (i, j)) };
        let (low, high) = (self.value(i, j) as f64, self.value(k, l) as f64);
        let (a, b) = (self.place(i, j), self.place(k, l));
        // Never on a node itself, where rings could touch.
        const HAIR: f64 = 1e-3;
        let inner = low.is_finite() && high > low;
        let t = if inner { ((level as f64 - low) / (high - low)).clamp(HAIR, 1.0 - HAIR) } else { 1.0 };
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
    }
}

const NONE: u32 = u32::MAX;

fn trace(lattice: &Lattice, level: f32) -> Vec<Contour> {
    let [w, h] = lattice.size();
    // An edge from a node to the east has an even number, one to the south an odd one.
    let mut next = vec![NONE; 2 * w * h];
    let mut reached = vec![false; 2 * w * h];
    let mut starts = Vec::new();
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    lattice.row(0, &mut upper);
    for j in 0..h - 1 {
        lattice.row(j + 1, &mut lower);
        for i in 0..w - 1 {
            let corners = [upper[i], upper[i + 1], lower[i + 1], lower[i]];
            let above = corners.map(|v| v > level);
            if above == [false; 4] || above == [true; 4] {
                continue;
            }
            let node = (j * w + i) as u32;
            let edges = [2 * node, 2 * (node + 1) + 1, 2 * (node + w as u32), 2 * node + 1];
            for (to, from) in segments(above, corners, level) {
                next[edges[from] as usize] = edges[to];
                reached[edges[to] as usize] = true;
                starts.push(edges[from]);
            }
        }
        std::mem::swap(&mut upper, &mut lower);
    }
    // Open lines first, from their own beginnings; then what is left are rings.
    let mut lines = Vec::new();
    for open in [true, false] {
        for &start in &starts {
            if next[start as usize] != NONE && (!open || !reached[start as usize]) {
                lines.extend(walk(lattice, level, &mut next, start));
            }
        }
    }
    lines
}

/// The ways through a square, as pairs of edges: where its rim, walked clockwise, rises through the level, and where it
/// falls.
fn segments(above: [bool; 4], corners: [f32; 4], level: f32) -> impl Iterator<Item = (usize, usize)> {
    let saddle = above[0] == above[2] && above[1] == above[3];
    let joined = saddle && corners.iter().map(|&v| v as f64 - level as f64).sum::<f64>() > 0.0;
    (0..4).filter(move |&k| !above[k] && above[(k + 1) % 4]).map(move |rise| {
        let falls = |k: usize| above[k] && !above[(k + 1) % 4];
        let fall = if joined {
            // The two higher corners hang together: cut off the lower corner before the rise.
            (1..4).map(|back| (rise + 4 - back) % 4).find(|&k| falls(k))
        } else {
            (1..4).map(|on| (rise + on) % 4).find(|&k| falls(k))
        };
        (rise, fall.unwrap_or(rise))
    })
}

fn walk(lattice: &Lattice, level: f32, next: &mut [u32], start: u32) -> Option<Contour> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut put = |edge: u32| {
        let point = lattice.crossing(edge, level);
        if points.last() != Some(&point) {
            points.push(point);
        }
    };
    let mut at = start;
    put(at);
    let closed = loop {
        let to = std::mem::replace(&mut next[at as usize], NONE);
        if to == NONE {
            break false;
        }
        if to == start {
            break true;
        }
        put(to);
        at = to;
    };
    if closed && points.last() == points.first() {
        points.pop();
    }
    // What is smaller than a point is none.
    (points.len() > if closed { 2 } else { 1 }).then_some(Contour { points, closed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    fn field(rows: &[&[f32]]) -> Field<f32> {
        let grid = Grid { width: rows[0].len(), height: rows.len(), cell_m: 10.0, edges: Edges::Open };
        Field { grid, data: rows.concat() }
    }

    #[test]
    fn a_disc_has_its_area_and_a_ring_its_hole() {
        let grid = Grid::new(200, 160, 200.0, Edges::Open);
        let r = |x: usize, y: usize| ((x as f32 - 99.5).powi(2) + (y as f32 - 79.5).powi(2)).sqrt();
        let disc = contour_rings(&Field::from_fn(grid, |x, y| 60.0 - r(x, y)), 0.0);
        assert_eq!(disc.len(), 1);
        // A polygon inside a circle of 60 cells with more than 300 corners misses less than 1e-3 of it.
        let area = std::f64::consts::PI * 3600.0;
        assert!(disc[0].closed && (disc[0].area_m2() / area - 1.0).abs() < 1e-3, "{}", disc[0].area_m2());
        let ring = contour_rings(&Field::from_fn(grid, |x, y| 20.0 - (r(x, y) - 40.0).abs()), 0.0);
        let mut areas: Vec<f64> = ring.iter().map(Contour::area_m2).collect();
        areas.sort_by(f64::total_cmp);
        assert!((areas[0] / (-400.0 * std::f64::consts::PI) - 1.0).abs() < 1e-2);
        assert!((areas[1] / area - 1.0).abs() < 1e-3);
    }

    #[test]
    fn land_that_reaches_the_rim_is_closed_there_and_lines_end_there() {
        let all = contour_rings(&field(&[&[1.0, 1.0], &[1.0, 1.0]]), 0.0);
        assert_eq!((all.len(), all[0].area_m2()), (1, 400.0));
        let half = field(&[&[1.0, -1.0], &[1.0, -1.0]]);
        assert_eq!(contour_rings(&half, 0.0)[0].area_m2(), 200.0);
        let lines = contour_lines(&half, 0.0);
        assert_eq!(lines.len(), 1);
        assert!(!lines[0].closed);
        let ends = [lines[0].points[0], *lines[0].points.last().unwrap()];
        assert!(ends.contains(&[10.0, 0.0]) && ends.contains(&[10.0, 20.0]));
    }

    #[test]
    fn saddles_follow_their_middle() {
        let joined = field(&[&[3.0, -1.0], &[-1.0, 3.0]]);
        assert_eq!(contour_rings(&joined, 0.0).len(), 1);
        let apart = field(&[&[1.0, -3.0], &[-3.0, 1.0]]);
        assert_eq!(contour_rings(&apart, 0.0).len(), 2);
    }

    #[test]
    fn nothing_has_no_contour() {
        assert!(contour_rings(&field(&[&[-1.0, -1.0]]), 0.0).is_empty());
        assert!(contour_lines(&field(&[&[1.0]]), 0.0).is_empty());
    }
}
