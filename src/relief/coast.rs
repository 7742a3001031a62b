//! The coast: the contour of sea level between pixel centres (marching squares), as distances from it.

use crate::grid::{Field, nearest_feature};

/// Where land ends, at each pixel.
pub struct Coast {
    /// Share of the pixel that is land.
    pub land: Field<f32>,
    /// Distance to the coast where it is within two pixels, else infinite, pixels.
    pub line_px: Field<f32>,
    /// Distance from the nearest pixel of land, pixels; 0 on land.
    pub offshore_px: Field<f32>,
}

impl Coast {
    /// The coast of `z` at `sea`.
    pub fn new(z: &Field<f32>, sea: f32) -> Self {
        let line_px = Field::from_fn(z.grid, |x, y| distance::<2>(z, sea, x, y));
        let land = Field::from_fn(z.grid, |x, y| land_share(z.at(x, y) > sea, line_px.at(x, y)));
        let offshore = nearest_feature(z.grid, |i| z.data[i] > sea).distance_m;
        let per_m = (1.0 / z.grid.cell_m) as f32;
        Self { land, line_px, offshore_px: offshore.map(|d| d * per_m) }
    }
}

/// Share of a pixel that is land, by the side its centre lies on and the distance to the coast.
#[inline(always)]
pub fn land_share(above: bool, line_px: f32) -> f32 {
    let beyond = line_px.min(1.0);
    (if above { 0.5 + beyond } else { 0.5 - beyond }).clamp(0.0, 1.0)
}

/// Distance from a pixel's centre to the contour in the squares up to `REACH` around it, pixels; infinite where there is
/// none.
pub fn distance<const REACH: usize>(z: &Field<f32>, sea: f32, x: usize, y: usize) -> f32 {
    let (w, h) = (z.grid.width, z.grid.height);
    let (left, right) = (x.saturating_sub(REACH), (x + REACH).min(w - 1));
    let (top, bottom) = (y.saturating_sub(REACH), (y + REACH).min(h - 1));
    let above = z.at(x, y) > sea;
    if (top..=bottom).all(|j| z.row(j)[left..=right].iter().all(|&v| (v > sea) == above)) {
        return f32::INFINITY;
    }
    let mut least = f32::INFINITY;
    for j in top..bottom {
        for i in left..right {
            let corners = [z.at(i, j), z.at(i + 1, j), z.at(i + 1, j + 1), z.at(i, j + 1)].map(|v| v - sea);
            let origin = [i as f32 - x as f32, j as f32 - y as f32];
            least = least.min(square(corners, origin));
        }
    }
    least
}

/// Squared-off marching square: least distance from the point (0, 0) to the contour in a unit square at `origin`.
fn square(corners: [f32; 4], origin: [f32; 2]) -> f32 {
    const AT: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut crossings = [[0.0f32; 2]; 4];
    let mut count = 0;
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        if (a > 0.0) != (b > 0.0) {
            let t = a / (a - b);
            let (p, q) = (AT[k], AT[(k + 1) % 4]);
            crossings[count] = [0, 1].map(|c| origin[c] + p[c] + (q[c] - p[c]) * t);
            count += 1;
        }
    }
    match count {
        2 => segment(crossings[0], crossings[1]),
        4 => {
            // A saddle: the middle's side decides which corners are cut off.
            let middle = corners.iter().sum::<f32>() > 0.0;
            if middle == (corners[0] > 0.0) {
                segment(crossings[0], crossings[1]).min(segment(crossings[2], crossings[3]))
            } else {
                segment(crossings[3], crossings[0]).min(segment(crossings[1], crossings[2]))
            }
        }
        _ => f32::INFINITY,
    }
}

/// Distance from (0, 0) to a segment.
fn segment(a: [f32; 2], b: [f32; 2]) -> f32 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length2 = d[0] * d[0] + d[1] * d[1];
    let t = if length2 > 0.0 { (-(a[0] * d[0] + a[1] * d[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let p = [a[0] + d[0] * t, a[1] + d[1] * t];
    (p[0] * p[0] + p[1] * p[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn distances_from_a_straight_slanting_coast() {
        let grid = Grid::new(40, 40, 40_000.0, Edges::Open);
        let (nx, ny) = (0.6, 0.8);
        let signed = |x: usize, y: usize| (x as f32 - 20.0) * nx + (y as f32 - 19.7) * ny;
        let coast = Coast::new(&Field::from_fn(grid, |x, y| signed(x, y) * 50.0 + 7.0), 7.0);
        for y in 5..35 {
            for x in 5..35 {
                let d = signed(x, y);
                if d.abs() < 1.4 {
                    assert!((coast.line_px.at(x, y) - d.abs()).abs() < 1e-4, "{x} {y}");
                }
                assert!((coast.land.at(x, y) - (0.5 + d).clamp(0.0, 1.0)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn a_world_without_coast_has_none() {
        let grid = Grid::new(5, 3, 5.0, Edges::Open);
        let coast = Coast::new(&Field::filled(grid, 1.0), 0.0);
        assert!(coast.land.data.iter().all(|&v| v == 1.0) && coast.line_px.data.iter().all(|v| v.is_infinite()));
        let sea = Coast::new(&Field::filled(grid, -1.0), 0.0);
        assert!(sea.land.data.iter().all(|&v| v == 0.0) && sea.offshore_px.data.iter().all(|v| v.is_infinite()));
    }
}
