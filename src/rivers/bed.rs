//! Shape of rivers, and the beds they have in the ground.
//!
//! Width and depth at bank-full flow follow the downstream hydraulic geometry of Leopold and Maddock (1953),
//! w = a·Q^0.5 and d = c·Q^0.4, with the constants that Moody and Troutman (2002) found over six decades of discharge:
//! a = 7.2 and c = 0.27 in m and m³/s (their exponents are 0.50 and 0.39).

use super::{course::River, hollows::least_fall_m, waters::Waters};
use crate::grid::Grid;

/// Width of a river of this bank-full discharge, m.
pub fn width_m(bankfull_m3_s: f64) -> f64 {
    7.2 * bankfull_m3_s.max(0.0).sqrt()
}

/// Depth of a river of this bank-full discharge, m.
pub fn depth_m(bankfull_m3_s: f64) -> f64 {
    if bankfull_m3_s > 0.0 { 0.27 * libm::pow(bankfull_m3_s, 0.39) } else { 0.0 }
}

/// The ground with beds in it, and the surface of water and ground.
pub struct Beds {
    /// Height of the ground, m.
    pub ground_m: Vec<f64>,
    /// The same with lakes on it, m.
    pub surface_m: Vec<f64>,
}

/// Cuts a bed of depth `cut_m` into every cell for which it is above 0. Beds fall all the way to the sea, a lake or the
/// rim, and never below them. The sills over which lakes spill stay, so that lakes keep their levels.
pub fn cut(waters: &Waters, z: &[f64], sea_m: f64, cut_m: impl Fn(usize) -> f64) -> Beds {
    let fall = least_fall_m(waters.way.grid);
    let mut ground_m = z.to_vec();
    let mut surface_m = z.to_vec();
    let mut sill = vec![false; z.len()];
    for &i in waters.lakes.iter().flat_map(|lake| &lake.cells) {
        sill[waters.way.receiver[i as usize] as usize] = true;
    }
    for &i in &waters.way.order {
        let (i, r) = (i as usize, waters.way.receiver[i as usize] as usize);
        let lake = waters.lake_of[i];
        if lake > 0 {
            let lake = &waters.lakes[lake as usize - 1];
            surface_m[i] = match lake.dry {
                true => z[i],
                false if r == i || lake.closed => lake.level_m,
                false => surface_m[r].max(z[i]),
            };
            continue;
        }
        // A rim cell's bed has the sea for its only floor.
        let floor_m = if r == i { sea_m } else { surface_m[r].max(sea_m) };
        let depth_m = cut_m(i);
        if depth_m > 0.0 && !sill[i] {
            ground_m[i] = (z[i] - depth_m).max(floor_m + fall).min(z[i]);
        }
        surface_m[i] = ground_m[i];
    }
    Beds { ground_m, surface_m }
}

/// Rivers narrower than this many cells have the bed of one cell.
const NARROW_CELLS: f64 = 1.5;

/// Gives rivers that are wider than a cell a bed of their width, parabolic across, along their smooth lines; what is `wet`
/// stays. `shape` is the bank-full ratio and the share of the depth that is cut. Says whether there was any to widen.
pub fn widen(grid: Grid, ground_m: &mut [f64], rivers: &[River], shape: [f64; 2], wet: impl Fn(usize) -> bool) -> bool {
    let [ratio, carve] = shape;
    let mut any = false;
    for pair in rivers.iter().flat_map(|river| river.points.windows(2)) {
        let (a, b) = (pair[0], pair[1]);
        let bankfull = ratio * a.discharge_m3_s;
        let (half_m, depth_m) = (0.5 * width_m(bankfull), carve * depth_m(bankfull));
        if 2.0 * half_m < NARROW_CELLS * grid.cell_m || depth_m <= 0.0 {
            continue;
        }
        any = true;
        let cells = |c: usize, size: usize| {
            let (low, high) = (a.at_m[c].min(b.at_m[c]) - half_m, a.at_m[c].max(b.at_m[c]) + half_m);
            let cell = |m: f64| ((m / grid.cell_m).max(0.0) as usize).min(size - 1);
            cell(low)..=cell(high)
        };
        let d = [b.at_m[0] - a.at_m[0], b.at_m[1] - a.at_m[1]];
        let length2 = (d[0] * d[0] + d[1] * d[1]).max(1e-12);
        for y in cells(1, grid.height) {
            for x in cells(0, grid.width) {
                let i = grid.index(x, y);
                let at = grid.center_m(x, y);
                let to = [at[0] - a.at_m[0], at[1] - a.at_m[1]];
                let t = ((to[0] * d[0] + to[1] * d[1]) / length2).clamp(0.0, 1.0);
                let off = [to[0] - t * d[0], to[1] - t * d[1]];
                let across2 = (off[0] * off[0] + off[1] * off[1]) / (half_m * half_m);
                if across2 <= 1.0 && !wet(i) {
                    ground_m[i] = ground_m[i].min(a.z_m + t * (b.z_m - a.z_m) + depth_m * across2);
                }
            }
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rivers_of_known_size() {
        // Mississippi at Vicksburg: bank-full about 40000 m³/s, 1000 to 1500 m wide and some 20 m deep.
        assert!((1000.0..1600.0).contains(&width_m(40_000.0)));
        assert!((13.0..22.0).contains(&depth_m(40_000.0)));
        assert_eq!((width_m(0.0), depth_m(0.0)), (0.0, 0.0));
    }
}
