//! A rectangle cut by straight lines: the planar graph of its vertices, edges and faces.
//!
//! All crossings are found pairwise, sorted along each line and joined to edges; faces are read off the half-edges, each
//! followed by the next one clockwise around its end. O(c²·log c) for `c` lines. With `X` crossings inside there are
//! `1 + c + X` faces (Euler).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::noise::Key;

/// Share of the rectangle's longer side within which two crossings count as one.
const SAME: f64 = 1e-9;

/// A convex face of an arrangement.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Corners in order, m.
    pub outline: Vec<[f64; 2]>,
    /// The faces that share an edge with it, in the order of its edges.
    pub neighbours: Vec<usize>,
}

/// How faces are taken, one after the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Breadth first: a compact massif.
    #[default]
    Breadth,
    /// Depth first: a chain that wanders off.
    Depth,
}

/// A rectangle from the origin to `extent`, cut by lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrangement {
    /// All faces inside the rectangle.
    pub faces: Vec<Face>,
    /// Crossings of two or more lines inside the rectangle.
    pub crossings: usize,
}

/// A chord of the rectangle: where a line enters and where it leaves.
type Chord = [[f64; 2]; 2];

impl Arrangement {
    /// The rectangle cut by `count` random lines. Directions and offsets are uniform among the lines that meet the
    /// rectangle, so that no place is favoured (a line through two random points would favour the centre).
    pub fn random(extent_m: [f64; 2], count: usize, key: Key) -> Self {
        let chords = (0..count).filter_map(|i| random_chord(extent_m, key.with(i as u64))).collect::<Vec<_>>();
        Self::of_chords(extent_m, &chords)
    }

    /// The rectangle cut by the given chords, each with both ends on the rim.
    fn of_chords(extent_m: [f64; 2], chords: &[Chord]) -> Self {
        let [w, h] = extent_m;
        let mut graph = Graph { tolerance: SAME * w.max(h), points: Vec::new(), edges: Vec::new() };
        let rim = [[[0.0, 0.0], [w, 0.0]], [[w, 0.0], [w, h]], [[w, h], [0.0, h]], [[0.0, h], [0.0, 0.0]]];
        let lines: Vec<Chord> = rim.iter().chain(chords).copied().collect();
        let mut on: Vec<Vec<(f64, usize)>> = vec![Vec::new(); lines.len()];
        let mut crossings = Vec::new();
        for (i, line) in lines.iter().enumerate() {
            for (t, &end) in line.iter().enumerate() {
                let point = graph.point(end);
                on[i].push((t as f64, point));
            }
            for (j, other) in lines.iter().enumerate().take(i) {
                if let Some((s, t, at)) = crossing(line, other) {
                    let point = graph.point(at);
                    on[i].push((s, point));
                    on[j].push((t, point));
                    if j >= rim.len() {
                        crossings.push(point);
                    }
                }
            }
        }
        for points in &mut on {
            points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            points.dedup_by_key(|p| p.1);
            graph.edges.extend(points.windows(2).map(|pair| [pair[0].1, pair[1].1]));
        }
        crossings.sort_unstable();
        crossings.dedup();
        Self { faces: graph.faces(), crossings: crossings.len() }
    }

    /// The face that holds a point, if the point lies in the rectangle.
    pub fn face_at(&self, at_m: [f64; 2]) -> Option<usize> {
        self.faces.iter().position(|face| holds(&face.outline, at_m))
    }

    /// The first `count` faces from `start` on, itself first.
    pub fn first_faces(&self, start: usize, count: usize, order: Order) -> Vec<usize> {
        let mut seen = vec![false; self.faces.len()];
        let mut waiting = std::collections::VecDeque::from([start]);
        let mut taken = Vec::with_capacity(count.min(self.faces.len()));
        while taken.len() < count {
            let next = match order {
                Order::Breadth => waiting.pop_front(),
                Order::Depth => waiting.pop_back(),
            };
            let Some(face) = next else { break };
            if std::mem::replace(&mut seen[face], true) {
                continue;
            }
            taken.push(face);
            waiting.extend(self.faces[face].neighbours.iter().copied().filter(|&n| !seen[n]));
        }
        taken
    }
}

/// A uniform random line that meets the rectangle, as a chord.
fn random_chord([w, h]: [f64; 2], key: Key) -> Option<Chord> {
    let mut stream = key.stream();
    let radius = 0.5 * (w * w + h * h).sqrt();
    // Half of the lines at random offsets within the circle meet the rectangle, or more; 64 misses in a row don't occur.
    for _ in 0..64 {
        let angle = stream.between(0.0, std::f64::consts::PI);
        let offset = stream.between(-radius, radius);
        let (sin, cos) = libm::sincos(angle);
        let middle = [0.5 * w + offset * cos, 0.5 * h + offset * sin];
        if let Some(chord) = chord_through(middle, [-sin, cos], [w, h]) {
            return Some(chord);
        }
    }
    None
}

/// The part of a line inside the rectangle, by slabs; the ends lie exactly on the rim.
fn chord_through(at: [f64; 2], direction: [f64; 2], extent: [f64; 2]) -> Option<Chord> {
    let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0, 0.0), (f64::INFINITY, 0, 0.0));
    for axis in 0..2 {
        let (d, size) = (direction[axis], extent[axis]);
        if d.abs() < 1e-12 {
            if at[axis] <= 0.0 || at[axis] >= size {
                return None;
            }
            continue;
        }
        let (low, high) = if d > 0.0 { (0.0, size) } else { (size, 0.0) };
        let (first, last) = ((low - at[axis]) / d, (high - at[axis]) / d);
        if first > enter.0 {
            enter = (first, axis, low);
        }
        if last < leave.0 {
            leave = (last, axis, high);
        }
    }
    let end = |(t, axis, rim): (f64, usize, f64)| {
        let mut p = [at[0] + t * direction[0], at[1] + t * direction[1]];
        p[axis] = rim;
        p
    };
    (leave.0 - enter.0 > SAME * extent[0].max(extent[1])).then(|| [end(enter), end(leave)])
}

/// Where two chords meet: the parameters on both and the point. Parallel ones don't.
fn crossing(a: &Chord, b: &Chord) -> Option<(f64, f64, [f64; 2])> {
    let d = [a[1][0] - a[0][0], a[1][1] - a[0][1]];
    let e = [b[1][0] - b[0][0], b[1][1] - b[0][1]];
    let turn = cross(d, e);
    if turn.abs() <= 1e-12 * (dot(d, d) * dot(e, e)).sqrt() {
        return None;
    }
    let gap = [b[0][0] - a[0][0], b[0][1] - a[0][1]];
    let (s, t) = (cross(gap, e) / turn, cross(gap, d) / turn);
    let within = |v: f64| (-1e-12..=1.0 + 1e-12).contains(&v);
    (within(s) && within(t)).then(|| (s, t, [a[0][0] + s * d[0], a[0][1] + s * d[1]]))
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Even-odd test with half-open edges, so that a point on a shared edge belongs to one face.
fn holds(outline: &[[f64; 2]], p: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}

struct Graph {
    tolerance: f64,
    points: Vec<[f64; 2]>,
    edges: Vec<[usize; 2]>,
}

impl Graph {
    /// The vertex at a place, made if there is none.
    fn point(&mut self, at: [f64; 2]) -> usize {
        let near = |p: &[f64; 2]| (p[0] - at[0]).abs() <= self.tolerance && (p[1] - at[1]).abs() <= self.tolerance;
        self.points.iter().position(near).unwrap_or_else(|| {
            self.points.push(at);
            self.points.len() - 1
        })
    }

    /// Half-edge `2k` runs along edge `k`, `2k + 1` back.
    fn origin(&self, half: usize) -> usize {
        self.edges[half / 2][half % 2]
    }

    fn faces(&self) -> Vec<Face> {
        let next = self.successors();
        let halves = next.len();
        let (mut face_of, mut cycles) = (vec![usize::MAX; halves], Vec::new());
        for first in 0..halves {
            if face_of[first] != usize::MAX {
                continue;
            }
            let mut cycle = Vec::new();
            let mut half = first;
            while face_of[half] == usize::MAX {
                face_of[half] = cycles.len();
                cycle.push(half);
                half = next[half];
            }
            cycles.push(cycle);
        }
        // The rim's outer side is the one cycle that turns the other way.
        let area = |cycle: &[usize]| -> f64 {
            cycle.iter().map(|&h| cross(self.points[self.origin(h)], self.points[self.origin(h ^ 1)])).sum()
        };
        let mut number = vec![usize::MAX; cycles.len()];
        let inner: Vec<usize> = (0..cycles.len()).filter(|&c| area(&cycles[c]) > 0.0).collect();
        for (i, &cycle) in inner.iter().enumerate() {
            number[cycle] = i;
        }
        inner.iter().map(|&c| self.face(&cycles[c], |h| number[face_of[h]])).collect()
    }

    fn face(&self, cycle: &[usize], face_of: impl Fn(usize) -> usize) -> Face {
        let outline = cycle.iter().map(|&h| self.points[self.origin(h)]).collect();
        let mut neighbours: Vec<usize> = Vec::new();
        for beyond in cycle.iter().map(|&h| face_of(h ^ 1)) {
            if beyond != usize::MAX && !neighbours.contains(&beyond) {
                neighbours.push(beyond);
            }
        }
        Face { outline, neighbours }
    }

    /// For every half-edge the one that follows it around its face: the next clockwise from its twin.
    fn successors(&self) -> Vec<usize> {
        let halves = 2 * self.edges.len();
        let mut around: Vec<Vec<(f64, usize)>> = vec![Vec::new(); self.points.len()];
        for half in 0..halves {
            let (a, b) = (self.points[self.origin(half)], self.points[self.origin(half ^ 1)]);
            around[self.origin(half)].push((libm::atan2(b[1] - a[1], b[0] - a[0]), half));
        }
        let mut next = vec![0; halves];
        for star in &mut around {
            star.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (i, &(_, half)) in star.iter().enumerate() {
                next[half ^ 1] = star[(i + star.len() - 1) % star.len()].1;
            }
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(outline: &[[f64; 2]]) -> f64 {
        (0..outline.len()).map(|i| cross(outline[i], outline[(i + 1) % outline.len()])).sum::<f64>() / 2.0
    }

    #[test]
    fn faces_are_counted_by_euler_and_fill_the_rectangle() {
        for (count, seed) in (0..13).flat_map(|c| (0..20).map(move |s| (c, s))) {
            let cut = Arrangement::random([300.0, 200.0], count, Key::new(seed));
            assert_eq!(cut.faces.len(), 1 + count + cut.crossings);
            let sum: f64 = cut.faces.iter().map(|f| area(&f.outline)).sum();
            assert!((sum - 60_000.0).abs() < 1e-6);
            for (i, face) in cut.faces.iter().enumerate() {
                assert!(face.neighbours.iter().all(|&n| cut.faces[n].neighbours.contains(&i)));
                let corner = |k: usize| face.outline[k % face.outline.len()];
                for k in 0..face.outline.len() {
                    let (a, b, c) = (corner(k), corner(k + 1), corner(k + 2));
                    assert!(cross([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]) > -1e-6, "convex");
                }
            }
        }
    }

    #[test]
    fn two_chords_make_four_faces_in_a_ring() {
        let cut = Arrangement::of_chords([2.0, 2.0], &[[[1.0, 0.0], [1.0, 2.0]], [[0.0, 1.0], [2.0, 1.0]]]);
        assert_eq!((cut.faces.len(), cut.crossings), (4, 1));
        assert!(cut.faces.iter().all(|f| f.outline.len() == 4 && f.neighbours.len() == 2));
    }

    #[test]
    fn breadth_stays_near_and_depth_goes_far() {
        let chords: Vec<Chord> =
            (1..8).flat_map(|i| [[[i as f64, 0.0], [i as f64, 8.0]], [[0.0, i as f64], [8.0, i as f64]]]).collect();
        let cut = Arrangement::of_chords([8.0, 8.0], &chords);
        assert_eq!(cut.faces.len(), 64);
        let start = cut.face_at([4.5, 4.5]).unwrap();
        let reach = |order| {
            let taken = cut.first_faces(start, 13, order);
            assert_eq!(taken.len(), 13);
            assert_eq!(taken[0], start);
            for (i, f) in taken.iter().enumerate().skip(1) {
                assert!(taken[..i].iter().any(|t| cut.faces[*t].neighbours.contains(f)), "touches an earlier face");
            }
            let off = |f: &usize| {
                let p = cut.faces[*f].outline[0];
                (p[0].min(8.0) - 4.0).abs() + (p[1] - 4.0).abs()
            };
            taken.iter().map(off).fold(0.0, f64::max)
        };
        // The 13 squares within two steps are exactly the breadth-first ones, corner by corner at most 4 off.
        assert!(reach(Order::Breadth) <= 4.0);
        assert!(reach(Order::Depth) > 4.0);
        assert_eq!(cut.first_faces(start, 1000, Order::Breadth).len(), 64);
        assert_eq!(cut.face_at([9.0, 1.0]), None);
    }
}
