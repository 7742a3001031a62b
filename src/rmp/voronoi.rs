//! Poisson-Voronoi cells along a path.
//!
//! The sites of one key and density are one fixed, endless scatter: each square of side `1/√λ` holds a Poisson number of
//! sites (mean one) at uniform places, drawn from the square's own stream. Only squares near the path are filled, so a
//! draw costs what it raises, and no rim widens a mountain.

use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation, handles::FixedVertexHandle};

use super::Cell;
use crate::noise::Key;

/// How far from the path sites are drawn, in units of `1/√λ`. A cell at the path whose neighbour is further away than
/// this has a chance below 1e-6; a rim at 2 would still be felt in one draw of some thousands.
const REACH: f64 = 3.0;

/// A path that goes this far (in `1/√λ`) has more cells than any map can show; it is refused, not filled.
const LONGEST: f64 = 1e5;

struct Site {
    at: [f64; 2],
    weight: f64,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.at[0], self.at[1])
    }
}

/// One draw of a random Voronoi partition with `sites_per_m2` sites, and the cells of it that `path` visits: a polyline
/// in metres, or a single point for a peak. Outlines are whole cells, also where they leave the map.
///
/// Two paths under one key see the same partition. Cells come in the order of the walk, each once. A path that is empty
/// or not finite, or a density that is not positive, visits nothing. Many draws along one path share a [`Probe`].
pub fn cells_along(path: &[[f64; 2]], sites_per_m2: f64, key: Key) -> Vec<Cell> {
    Probe::new(path, sites_per_m2).cells(key)
}

/// A path made ready for many draws.
#[derive(Clone, Debug)]
pub struct Probe {
    /// In units of `1/√λ`, like everything in here; empty if there is nothing to visit.
    path: Vec<[f64; 2]>,
    /// Units a metre, `√λ`.
    scale: f64,
    /// The squares `(row, column)` whose sites matter.
    squares: Vec<(i32, i32)>,
    /// Four places so far out that they close every cell that could be visited.
    guards: [[f64; 2]; 4],
}

impl Probe {
    /// A polyline in metres (or a point), and the density of the sites to draw.
    pub fn new(path_m: &[[f64; 2]], sites_per_m2: f64) -> Self {
        let scale = sites_per_m2.sqrt();
        let mut path: Vec<[f64; 2]> = path_m.iter().map(|p| [p[0] * scale, p[1] * scale]).collect();
        let sound = |v: &f64| v.is_finite() && v.abs() < LONGEST;
        if sites_per_m2.is_nan() || sites_per_m2 <= 0.0 || !path.iter().flatten().all(sound) {
            path.clear();
        }
        let bound = |axis: usize, pick: fn(f64, f64) -> f64| path.iter().map(|p| p[axis]).reduce(pick).unwrap_or(0.0);
        let (low, high) = ([bound(0, f64::min), bound(1, f64::min)], [bound(0, f64::max), bound(1, f64::max)]);
        let far = 4.0 * (high[0] - low[0] + high[1] - low[1]) + 8.0 * REACH;
        let ([left, top], [right, bottom]) = ([low[0] - far, low[1] - far], [high[0] + far, high[1] + far]);
        let guards = [[left, top], [right, top], [right, bottom], [left, bottom]];
        Self { squares: squares_near(&path), path, scale, guards }
    }

    /// The cells visited in the draw of this key.
    pub fn cells(&self, key: Key) -> Vec<Cell> {
        if self.path.is_empty() {
            return Vec::new();
        }
        let Ok(mosaic) = DelaunayTriangulation::<Site>::bulk_load(self.sites(key)) else { return Vec::new() };
        walk(&mosaic, &self.path).into_iter().filter_map(|vertex| cell(&mosaic, vertex, self.scale)).collect()
    }

    fn sites(&self, key: Key) -> Vec<Site> {
        let mut sites = Vec::with_capacity(self.squares.len() + self.squares.len() / 4 + 8);
        for &(iy, ix) in &self.squares {
            let mut stream = key.with(key.lattice(ix, iy)).stream();
            for _ in 0..poisson_one(stream.unit()) {
                let at = [ix as f64 + stream.unit(), iy as f64 + stream.unit()];
                let colour = [1.0 - stream.unit(), 1.0 - stream.unit(), 1.0 - stream.unit()];
                let weight = (colour.iter().map(|c| c * c).sum::<f64>() / 3.0).sqrt();
                sites.push(Site { at, weight });
            }
        }
        sites.extend(self.guards.map(|at| Site { at, weight: 1.0 }));
        sites
    }
}

/// The unit squares `(row, column)` whose centre lies within reach of the path, sorted, each once.
fn squares_near(path: &[[f64; 2]]) -> Vec<(i32, i32)> {
    // Half a diagonal, so that every point within reach lies in a chosen square.
    let reach = REACH + 0.5 * std::f64::consts::SQRT_2;
    let mut squares = Vec::new();
    for i in 0..path.len().saturating_sub(1).max(path.len().min(1)) {
        let (a, b) = (path[i], path[(i + 1).min(path.len() - 1)]);
        let (top, bottom) = (a[1].min(b[1]) - reach, a[1].max(b[1]) + reach);
        for iy in (top - 0.5).ceil() as i32..=(bottom - 0.5).floor() as i32 {
            let y = iy as f64 + 0.5;
            // The part of the segment that this row can feel gives the columns to look at.
            let along = |at: f64| if a[1] == b[1] { 0.0 } else { ((at - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0) };
            let (s, t) = if a[1] == b[1] { (0.0, 1.0) } else { (along(y - reach), along(y + reach)) };
            let (xs, xt) = (a[0] + s * (b[0] - a[0]), a[0] + t * (b[0] - a[0]));
            let (left, right) = (xs.min(xt) - reach, xs.max(xt) + reach);
            for ix in (left - 0.5).ceil() as i32..=(right - 0.5).floor() as i32 {
                if distance_squared([ix as f64 + 0.5, y], a, b) <= reach * reach {
                    squares.push((iy, ix));
                }
            }
        }
    }
    squares.sort_unstable();
    squares.dedup();
    squares
}

fn distance_squared(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length2 = d[0] * d[0] + d[1] * d[1];
    let dot = (p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1];
    let t = if length2 > 0.0 { (dot / length2).clamp(0.0, 1.0) } else { 0.0 };
    let e = [p[0] - a[0] - t * d[0], p[1] - a[1] - t * d[1]];
    e[0] * e[0] + e[1] * e[1]
}

/// The Poisson number of mean one that a uniform number stands for.
fn poisson_one(uniform: f64) -> u32 {
    let (mut count, mut chance) = (0, 1.0 / std::f64::consts::E);
    let mut sum = chance;
    while uniform >= sum && count < 20 {
        count += 1;
        chance /= count as f64;
        sum += chance;
    }
    count
}

/// The cells under the path: from the cell of its first point, over each bisector that the path crosses.
fn walk(mosaic: &DelaunayTriangulation<Site>, path: &[[f64; 2]]) -> Vec<FixedVertexHandle> {
    let off = |at: [f64; 2]| (at[0] - path[0][0]).powi(2) + (at[1] - path[0][1]).powi(2);
    let start = mosaic.vertices().min_by(|a, b| off(a.data().at).total_cmp(&off(b.data().at)));
    let Some(mut current) = start else { return Vec::new() };
    let mut seen = vec![false; mosaic.num_vertices()];
    seen[current.fix().index()] = true;
    let mut visited = vec![current.fix()];
    for segment in path.windows(2) {
        let (a, d) = (segment[0], [segment[1][0] - segment[0][0], segment[1][1] - segment[0][1]]);
        loop {
            // Equal distance to both sites at a + t·d. Only neighbours that lie ahead count, so the walk always gains
            // along d and ends.
            let from = current.data().at;
            let crossing = current.out_edges().filter_map(|edge| {
                let to = edge.to();
                let s = [to.data().at[0] - from[0], to.data().at[1] - from[1]];
                let ahead = d[0] * s[0] + d[1] * s[1];
                let middle = [0.5 * (from[0] + to.data().at[0]) - a[0], 0.5 * (from[1] + to.data().at[1]) - a[1]];
                (ahead > 0.0).then(|| ((middle[0] * s[0] + middle[1] * s[1]) / ahead, to))
            });
            let next = crossing.min_by(|p, q| p.0.total_cmp(&q.0));
            let Some((_, to)) = next.filter(|&(t, _)| t < 1.0) else { break };
            current = to;
            if !std::mem::replace(&mut seen[current.fix().index()], true) {
                visited.push(current.fix());
            }
        }
    }
    visited
}

/// A bounded cell in metres; the guards' own cells are not bounded.
fn cell(mosaic: &DelaunayTriangulation<Site>, vertex: FixedVertexHandle, scale: f64) -> Option<Cell> {
    let vertex = mosaic.vertex(vertex);
    let outline = vertex
        .as_voronoi_face()
        .adjacent_edges()
        .map(|edge| edge.from().position().map(|p| [p.x / scale, p.y / scale]))
        .collect::<Option<Vec<_>>>()?;
    Some(Cell { outline, weight: vertex.data().weight })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inside(outline: &[[f64; 2]], p: [f64; 2]) -> bool {
        let side = |i: usize| {
            let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
            (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
        };
        (0..outline.len()).all(|i| side(i) >= -1e-9) || (0..outline.len()).all(|i| side(i) <= 1e-9)
    }

    #[test]
    fn the_path_lies_in_the_cells_and_each_cell_once() {
        let path = [[0.0, 0.0], [40.0, 13.0], [22.0, 50.0], [21.0, 50.0]];
        for draw in 0..40 {
            let cells = cells_along(&path, 0.04, Key::new(3).with(draw));
            for leg in path.windows(2) {
                for step in 0..=400 {
                    let t = step as f64 / 400.0;
                    let p = [leg[0][0] + t * (leg[1][0] - leg[0][0]), leg[0][1] + t * (leg[1][1] - leg[0][1])];
                    let holders = cells.iter().filter(|c| inside(&c.outline, p)).count();
                    assert!(holders == 1 || (holders > 0 && step % 400 == 0), "draw {draw}: {holders} cells at {p:?}");
                }
            }
            assert!(cells.iter().all(|c| c.weight > 0.0 && c.weight <= 1.0 && c.outline.len() >= 3));
        }
    }

    #[test]
    fn paths_under_one_key_share_the_partition() {
        let key = Key::new(8);
        let whole = cells_along(&[[0.0, 0.0], [100.0, 0.0]], 0.01, key);
        let peak = cells_along(&[[50.0, 0.0]], 0.01, key);
        assert_eq!(peak.len(), 1);
        let twin = whole.iter().find(|c| c.weight == peak[0].weight).unwrap();
        assert_eq!(twin.outline.len(), peak[0].outline.len());
        assert!(peak[0].outline.iter().all(|p| twin.outline.iter().any(|q| (p[0] - q[0]).hypot(p[1] - q[1]) < 1e-6)));
    }

    #[test]
    fn nonsense_visits_nothing() {
        let key = Key::new(1);
        assert!(cells_along(&[], 1.0, key).is_empty());
        assert!(cells_along(&[[f64::NAN, 0.0]], 1.0, key).is_empty());
        assert!(cells_along(&[[0.0, 0.0], [1e300, 0.0]], 1.0, key).is_empty());
        for density in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(cells_along(&[[1.0, 2.0]], density, key).is_empty());
        }
    }
}
