//! The ring of cells around the map: what lies beyond the rim.

use crate::grid::{Edges, Grid};

use super::super::bed::Bed;

/// A wall that no water climbs, m. Nothing flows from it either, and no product with it overflows.
const WALL_M: f32 = 1e30;
/// The share of a diagonal fall in a flow: it lies √2 cells away.
pub const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Calls `f` with a cell of the ring, the opposite cell on the map (both ringed indices), and the nearest cell on the
/// map with the one behind that.
fn each(grid: &Grid, mut f: impl FnMut(usize, usize, [usize; 2])) {
    let (w, h, stride) = (grid.width, grid.height, grid.width + 2);
    let mut at = |x: usize, y: usize| {
        let near = |v: usize, size: usize| v.clamp(1, size) - 1;
        let behind = |v: usize, size: usize| {
            if v == 0 {
                1.min(size - 1)
            } else if v > size {
                size.max(2) - 2
            } else {
                v - 1
            }
        };
        let over = |v: usize, size: usize| (v + size - 1) % size + 1;
        let inner = [near(y, h) * w + near(x, w), behind(y, h) * w + behind(x, w)];
        f(y * stride + x, over(y, h) * stride + over(x, w), inner);
    };
    for x in 0..stride {
        at(x, 0);
        at(x, h + 1);
    }
    for y in 1..=h {
        at(0, y);
        at(w + 1, y);
    }
}

/// Levels beyond the rim: the other side's, a wall, or dry ground that goes on to fall as the rim fell
/// when the stage began: ground that followed the rim would draw it down without end.
pub fn level(level: &mut [f32], grid: &Grid, bed: &Bed) {
    each(grid, |ring, opposite, [near, behind]| {
        level[ring] = match grid.edges {
            Edges::Wrap => level[opposite],
            Edges::Closed => WALL_M,
            Edges::Open => {
                let [rim, behind] = [bed.start[near], bed.start[behind]];
                (rim - (behind - rim).max(0.0)).max(bed.sea_m)
            }
        }
    });
}

/// What comes from beyond the rim: nothing, or what leaves the other side.
pub fn wrap(data: &mut [f32], grid: &Grid) {
    if grid.edges == Edges::Wrap {
        each(grid, |ring, opposite, _| data[ring] = data[opposite]);
    }
}

/// Water and load that leave over an open rim, m of a cell.
pub fn left(level: &[f32], flow: &[f32], drift: &[f32], grid: &Grid) -> [f64; 2] {
    let mut sum = [0.0; 2];
    if grid.edges != Edges::Open {
        return sum;
    }
    let (w, h, stride) = (grid.width as isize, grid.height as isize, grid.width as isize + 2);
    let mut cell = |x: isize, y: isize| {
        let i = y * stride + x;
        for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
            let inside = (1..=w).contains(&(x + dx)) && (1..=h).contains(&(y + dy));
            if !inside {
                let beyond = (i + dy * stride + dx) as usize;
                let part = if dx != 0 && dy != 0 { DIAGONAL } else { 1.0 };
                let fall = part * (level[i as usize] - level[beyond]).max(0.0);
                sum[0] += (flow[i as usize] * fall) as f64;
                sum[1] += (drift[i as usize] * fall) as f64;
            }
        }
    };
    for x in 1..=w {
        cell(x, 1);
        if h > 1 {
            cell(x, h);
        }
    }
    for y in 2..h {
        cell(1, y);
        if w > 1 {
            cell(w, y);
        }
    }
    sum
}
