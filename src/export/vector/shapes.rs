//! Lines and polygons: cut to a rectangle, thinned, and rings sorted into polygons with holes.

use super::View;
use crate::grid::Contour;

/// Points in a row; closed where the last is the first.
pub type Line = Vec<[f64; 2]>;

/// A ring around an area and rings around its holes; the first point of a ring is not repeated.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The outer ring, clockwise as seen on the map.
    pub outer: Line,
    /// The holes, counterclockwise.
    pub holes: Vec<Line>,
}

/// The area inside a ring; positive if it turns clockwise on the map.
pub fn area(ring: &[[f64; 2]]) -> f64 {
    0.5 * ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>()
}

/// Length of a line.
pub fn length(line: &[[f64; 2]]) -> f64 {
    line.windows(2).map(|w| libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1])).sum()
}

/// Sorts rings into polygons: each hole goes to the smallest outer ring around it. What is smaller than `least` is left out.
pub fn polygons(rings: Vec<Line>, least: f64) -> Vec<Polygon> {
    let sized = rings.into_iter().map(|ring| (area(&ring), ring)).filter(|(area, _)| area.abs() > least);
    let (mut outers, mut holes): (Vec<_>, Vec<_>) = sized.partition(|(area, _)| *area > 0.0);
    // The smallest first, so that the first that fits is the one.
    outers.sort_by(|a, b| a.0.total_cmp(&b.0));
    holes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let boxes: Vec<[f64; 4]> = outers.iter().map(|(_, ring)| bounds(ring)).collect();
    let mut polygons: Vec<Polygon> =
        outers.into_iter().map(|(_, outer)| Polygon { outer, holes: Vec::new() }).collect();
    for (_, hole) in holes {
        let [x, y] = hole[0];
        let around = |(polygon, b): &(&mut Polygon, &[f64; 4])| {
            x >= b[0] && y >= b[1] && x <= b[2] && y <= b[3] && inside(&polygon.outer, [x, y])
        };
        if let Some((polygon, _)) = polygons.iter_mut().zip(&boxes).find(around) {
            polygon.holes.push(hole);
        }
    }
    polygons.reverse();
    polygons
}

/// West, north, east and south of a line.
pub fn bounds(line: &[[f64; 2]]) -> [f64; 4] {
    line.iter().fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |b, p| {
        [b[0].min(p[0]), b[1].min(p[1]), b[2].max(p[0]), b[3].max(p[1])]
    })
}

fn inside(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut odd = false;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        if (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            odd = !odd;
        }
    }
    odd
}

/// A contour as a line.
pub fn line_of(contour: Contour) -> Line {
    let mut points = contour.points;
    if contour.closed {
        points.extend(points.first().copied());
    }
    points
}

/// The parts of a line within the view.
pub fn cut_line(line: &[[f64; 2]], view: &View) -> Vec<Line> {
    let mut parts: Vec<Line> = Vec::new();
    let mut open: Option<Line> = None;
    for pair in line.windows(2) {
        match clip(pair[0], pair[1], view) {
            Some((a, b)) => {
                let part = open.get_or_insert_with(|| vec![a]);
                if part.last() != Some(&b) {
                    part.push(b);
                }
                if b != pair[1] {
                    parts.extend(open.take());
                }
            }
            None => parts.extend(open.take()),
        }
    }
    parts.extend(open);
    parts.retain(|part| part.len() > 1);
    parts
}

/// The part of a segment within the view (Liang and Barsky 1984); ends inside stay to the bit.
fn clip(a: [f64; 2], b: [f64; 2], view: &View) -> Option<([f64; 2], [f64; 2])> {
    let far = view.far_m();
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for c in 0..2 {
        let d = b[c] - a[c];
        for (p, q) in [(-d, a[c] - view.corner_m[c]), (d, far[c] - a[c])] {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                t0 = t0.max(q / p);
            } else {
                t1 = t1.min(q / p);
            }
        }
    }
    let at = |t: f64| [0, 1].map(|c| (a[c] + (b[c] - a[c]) * t).clamp(view.corner_m[c], far[c]));
    (t0 < t1).then(|| (if t0 > 0.0 { at(t0) } else { a }, if t1 < 1.0 { at(t1) } else { b }))
}

/// A ring cut to the view (Sutherland and Hodgman 1974).
pub fn cut_ring(ring: &[[f64; 2]], view: &View) -> Line {
    let far = view.far_m();
    let sides = [(0, view.corner_m[0], 1.0), (0, far[0], -1.0), (1, view.corner_m[1], 1.0), (1, far[1], -1.0)];
    let mut ring = ring.to_vec();
    for (c, bound, sign) in sides {
        let depth = |p: &[f64; 2]| (p[c] - bound) * sign;
        let mut cut: Line = Vec::with_capacity(ring.len() + 4);
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let (da, db) = (depth(a), depth(b));
            if da >= 0.0 {
                cut.push(*a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                let t = da / (da - db);
                let mut p = [0, 1].map(|k| a[k] + (b[k] - a[k]) * t);
                p[c] = bound;
                cut.push(p);
            }
        }
        cut.dedup();
        ring = cut;
    }
    ring
}

/// Leaves out points that lie within `reach` of the line through the others (Douglas and Peucker 1973).
pub fn thin(line: &[[f64; 2]], reach: f64) -> Line {
    let last = line.len().saturating_sub(1);
    let mut keep = vec![false; line.len()];
    let mut spans = vec![(0, last)];
    // A closed line is anchored at the point farthest from its beginning as well.
    if line.len() > 3 && line[0] == line[last] {
        let far = (1..last).fold(1, |m, k| if gap(line[k], line[0]) > gap(line[m], line[0]) { k } else { m });
        spans = vec![(0, far), (far, last)];
    }
    for &(a, b) in &spans {
        (keep[a], keep[b]) = (true, true);
    }
    while let Some((a, b)) = spans.pop() {
        let mut most = (reach, None);
        for k in a + 1..b {
            let away = distance(line[k], line[a], line[b]);
            if away > most.0 {
                most = (away, Some(k));
            }
        }
        if let Some(k) = most.1 {
            keep[k] = true;
            spans.extend([(a, k), (k, b)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

fn gap(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// Distance from a point to a segment.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length2 = d[0] * d[0] + d[1] * d[1];
    let t = if length2 > 0.0 { (((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
    gap(p, [a[0] + d[0] * t, a[1] + d[1] * t])
}
