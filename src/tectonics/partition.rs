//! Cutting a square into convex plates by random lines: half-plane clipping, slivers refused.
//!
//! A cut splits a polygon by the sign of `cross(direction, vertex - point)`; both halves of a convex polygon are convex
//! and keep its winding (Sutherland and Hodgman 1974).

use glam::DVec2;

use crate::noise::{Key, Stream};

/// A convex polygon, counter-clockwise in engine axes.
pub type Polygon = Vec<DVec2>;

/// Smallest area of a plate as a share of the mean plate.
const LEAST_AREA: f64 = 0.3;
/// Shortest edge as a share of the mean plate's side.
const LEAST_EDGE: f64 = 0.12;
/// Greatest perimeter² / (4π area): 1 for a disc, 1.27 for a square.
const MOST_ELONGATED: f64 = 2.0;
/// Cuts tried on one polygon before the next is tried.
const TRIES: usize = 60;

/// Twice the signed area is the cross product summed over edges.
pub fn area(polygon: &[DVec2]) -> f64 {
    edges(polygon).map(|(a, b)| a.perp_dot(b)).sum::<f64>() / 2.0
}

/// Centroid of a convex polygon.
pub fn centroid(polygon: &[DVec2]) -> DVec2 {
    let origin = polygon[0];
    let sum: DVec2 = edges(polygon).map(|(a, b)| (a + b - 2.0 * origin) * (a - origin).perp_dot(b - origin)).sum();
    origin + sum / (6.0 * area(polygon))
}

/// Edges in order, the last one back to the first vertex.
pub fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// The parts of `polygon` left and right of the line through `point` along `direction`; empty where there is none.
pub fn split(polygon: &[DVec2], point: DVec2, direction: DVec2) -> [Polygon; 2] {
    let side = |v: DVec2| direction.perp_dot(v - point);
    let mut parts = [Vec::new(), Vec::new()];
    for (a, b) in edges(polygon) {
        let (sa, sb) = (side(a), side(b));
        if sa >= 0.0 {
            parts[0].push(a);
        }
        if sa <= 0.0 {
            parts[1].push(a);
        }
        if sa * sb < 0.0 {
            let cut = a + (b - a) * (sa / (sa - sb));
            parts[0].push(cut);
            parts[1].push(cut);
        }
    }
    parts.map(|part| if part.len() < 3 || area(&part) <= 0.0 { Vec::new() } else { part })
}

/// Cuts `square` into `count` convex plates: again and again a random line halves one of the larger plates.
pub fn cut(square: Polygon, count: usize, key: Key) -> Vec<Polygon> {
    let mean_area = area(&square) / count as f64;
    let mut plates = vec![square];
    let mut stream = key.stream();
    while plates.len() < count {
        // The largest plate first; one that resists all tries gives way to the next.
        let mut order: Vec<usize> = (0..plates.len()).collect();
        order.sort_by(|&a, &b| area(&plates[b]).total_cmp(&area(&plates[a])).then(a.cmp(&b)));
        let halves = order.iter().find_map(|&i| halve(&plates[i], mean_area, &mut stream).map(|halves| (i, halves)));
        match halves {
            Some((i, [left, right])) => {
                plates[i] = left;
                plates.push(right);
            }
            None => break,
        }
    }
    plates
}

/// Cuts by whole chords of the square, as the thesis does: each runs from side to side through every plate in its way.
/// A chord that would leave a sliver anywhere is refused.
pub fn cut_by_chords(square: Polygon, chords: usize, key: Key) -> Vec<Polygon> {
    let mean_area = area(&square) / (1 + chords) as f64 / 3.0;
    let (low, high) = (square[0], square[2]);
    let mut plates = vec![square];
    let mut stream = key.stream();
    for _ in 0..chords {
        for _ in 0..TRIES {
            let (u, v) = (stream.unit(), stream.unit());
            let at = |t: f64, from: f64, to: f64| from + (to - from) * t;
            let (a, b) = if stream.unit() < 0.5 {
                (DVec2::new(low.x, at(u, low.y, high.y)), DVec2::new(high.x, at(v, low.y, high.y)))
            } else {
                (DVec2::new(at(u, low.x, high.x), low.y), DVec2::new(at(v, low.x, high.x), high.y))
            };
            let parts: Vec<Polygon> =
                plates.iter().flat_map(|p| split(p, a, b - a)).filter(|part| !part.is_empty()).collect();
            if parts.iter().all(|part| sound(part, mean_area * 0.2, 6.0)) {
                plates = parts;
                break;
            }
        }
    }
    plates
}

fn halve(polygon: &[DVec2], mean_area: f64, stream: &mut Stream) -> Option<[Polygon; 2]> {
    let size = area(polygon).sqrt();
    (0..TRIES).find_map(|_| {
        let turn = stream.between(0.0, std::f64::consts::TAU);
        let offset = DVec2::new(stream.between(-0.25, 0.25), stream.between(-0.25, 0.25)) * size;
        let direction = DVec2::new(libm::cos(turn), libm::sin(turn));
        let halves = split(polygon, centroid(polygon) + offset, direction);
        halves.iter().all(|half| sound(half, mean_area * LEAST_AREA, MOST_ELONGATED)).then_some(halves)
    })
}

fn sound(polygon: &[DVec2], least_area: f64, most_elongated: f64) -> bool {
    if polygon.is_empty() {
        return false;
    }
    let area = area(polygon);
    let perimeter: f64 = edges(polygon).map(|(a, b)| a.distance(b)).sum();
    let least_edge = (least_area / LEAST_AREA).sqrt() * LEAST_EDGE;
    area >= least_area
        && perimeter * perimeter / (4.0 * std::f64::consts::PI * area) <= most_elongated
        && edges(polygon).all(|(a, b)| a.distance(b) >= least_edge)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tectonics::domain::SIDE_UNITS;

    fn square() -> Polygon {
        let h = SIDE_UNITS / 2.0;
        vec![DVec2::new(-h, -h), DVec2::new(h, -h), DVec2::new(h, h), DVec2::new(-h, h)]
    }

    fn assert_tiles(plates: &[Polygon]) {
        let total: f64 = plates.iter().map(|p| area(p)).sum();
        assert!((total / (SIDE_UNITS * SIDE_UNITS) - 1.0).abs() < 1e-12);
        for plate in plates {
            for (i, (a, b)) in edges(plate).enumerate() {
                let c = plate[(i + 2) % plate.len()];
                assert!((b - a).perp_dot(c - b) > -1e-9, "not convex");
                // The middle of each edge lies on the square's side or on exactly one other plate's edge.
                let middle = (a + b) / 2.0;
                let on_rim = middle.abs().max_element() > SIDE_UNITS / 2.0 - 1e-9;
                let shared =
                    plates.iter().filter(|other| !std::ptr::eq(*other, plate)).filter(|other| on_edge(other, middle));
                assert_eq!(shared.count(), usize::from(!on_rim));
            }
        }
    }

    fn on_edge(polygon: &[DVec2], p: DVec2) -> bool {
        edges(polygon).any(|(a, b)| {
            let along = (p - a).dot(b - a) / (b - a).length_squared();
            (-1e-9..=1.0 + 1e-9).contains(&along) && ((b - a).perp_dot(p - a) / a.distance(b)).abs() < 1e-9
        })
    }

    #[test]
    fn plates_tile_the_square_and_are_convex() {
        for seed in 0..50 {
            for count in [2, 4, 12, 20] {
                let plates = cut(square(), count, Key::new(seed));
                assert_eq!(plates.len(), count, "seed {seed}");
                assert_tiles(&plates);
            }
        }
    }

    #[test]
    fn chords_tile_the_square_too() {
        for seed in 0..20 {
            let plates = cut_by_chords(square(), 6, Key::new(seed));
            assert!(plates.len() > 6, "{}", plates.len());
            assert_tiles(&plates);
        }
    }

    #[test]
    fn centroid_of_a_triangle() {
        let triangle = [DVec2::new(0.0, 0.0), DVec2::new(3.0, 0.0), DVec2::new(0.0, 6.0)];
        assert!((centroid(&triangle) - DVec2::new(1.0, 2.0)).length() < 1e-12);
        assert_eq!(area(&triangle), 9.0);
    }
}
