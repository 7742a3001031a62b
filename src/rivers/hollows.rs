//! Hollows of the ground: which are lakes, and how the others are drained or filled.

use crate::{
    flow::{Drainage, neighbours},
    grid::{Grid, map_cells},
};

/// A connected part of the ground below one spill level.
#[derive(Clone, Debug, PartialEq)]
pub struct Hollow {
    /// Its cells.
    pub cells: Vec<u32>,
    /// Its deepest cell.
    pub bottom: u32,
    /// Height of the brim, m.
    pub level_m: f64,
    /// Depth at the bottom, m.
    pub depth_m: f64,
    /// Room below the brim, m³.
    pub volume_m3: f64,
}

/// The hollows of a ground `z` below its filled `surface`, in the order of their first cells.
pub fn hollows(grid: Grid, z: &[f64], surface: &[f64]) -> Vec<Hollow> {
    let mut seen = vec![false; z.len()];
    let mut found = Vec::new();
    for start in 0..z.len() {
        if seen[start] || surface[start] <= z[start] {
            continue;
        }
        seen[start] = true;
        let level_m = surface[start];
        let (mut cells, mut next) = (vec![start as u32], 0);
        while let Some(&i) = cells.get(next) {
            next += 1;
            for (j, _) in neighbours(grid, i as usize) {
                if !seen[j] && surface[j] == level_m && z[j] < level_m {
                    seen[j] = true;
                    cells.push(j as u32);
                }
            }
        }
        let depth = |i: u32| level_m - z[i as usize];
        let bottom = cells.iter().copied().fold(start as u32, |a, b| if depth(b) > depth(a) { b } else { a });
        let volume_m3 = cells.iter().map(|&i| depth(i)).sum::<f64>() * grid.cell_area_m2();
        found.push(Hollow { depth_m: depth(bottom), cells, bottom, level_m, volume_m3 });
    }
    found
}

/// A fall that is still one when heights are stored in `f32`, as a sum of layers, m.
const LEAST_FALL_M: f64 = 2e-3;

/// Least fall that is made from a cell to the next, m: a hundred thousandth of the way, and enough to be stored.
pub fn least_fall_m(grid: Grid) -> f64 {
    (1e-5 * grid.cell_m).max(LEAST_FALL_M)
}

/// Tilts cells without any fall by next to nothing, `tilt_m`, so that plains and levelled ground are drained by branching
/// rivers: on a true level the flood would run in straight, parallel lines. The tilt is too small to be seen.
pub fn tilt_plains(grid: Grid, z: &mut [f64], outlets: &[bool], tilt_m: impl Fn(usize) -> f64 + Sync) {
    let level: &[f64] = z;
    let mut tilt = vec![0.0; z.len()];
    map_cells(&mut tilt, grid.width, |x, y| {
        let i = grid.index(x, y);
        let drained = outlets[i] || neighbours(grid, i).any(|(j, _)| level[j] < level[i]);
        if drained { 0.0 } else { tilt_m(i) }
    });
    z.iter_mut().zip(tilt).for_each(|(z, tilt)| *z += tilt);
}

/// Drains or fills every hollow that is no kept lake, each by what moves less rock. `z` is changed; under the lakes it stays
/// as it is.
pub fn level(grid: Grid, z: &mut [f64], outlets: &[bool], lakes: &[Hollow]) {
    let fall = least_fall_m(grid);
    let mut ends = outlets.to_vec();
    lakes.iter().for_each(|lake| ends[lake.bottom as usize] = true);
    let under = under(outlets, lakes);
    let way = Drainage::of(grid, z, &ends);
    for hollow in hollows(grid, z, &way.surface_m) {
        // Under water there is nothing to be gained by a ditch.
        if !under[hollow.bottom as usize] {
            breach(&way, z, &hollow, fall);
        }
    }
    fill(grid, z, &under);
}

/// The outlets, and all cells under lakes.
pub fn under(outlets: &[bool], lakes: &[Hollow]) -> Vec<bool> {
    let mut under = outlets.to_vec();
    lakes.iter().flat_map(|lake| &lake.cells).for_each(|&i| under[i as usize] = true);
    under
}

/// Fills every hollow that has no end in it; what is filled, and what lies all but level, falls to its outlet.
pub fn fill(grid: Grid, z: &mut [f64], ends: &[bool]) {
    let fall = least_fall_m(grid);
    let way = Drainage::of(grid, z, ends);
    for &i in &way.order {
        let (i, r) = (i as usize, way.receiver[i as usize] as usize);
        // Heights are rounded when they are stored: what falls by less might rise then.
        if r != i && z[i] < z[r] + LEAST_FALL_M {
            z[i] = z[r] + fall;
        }
    }
}

/// Cuts a ditch from the bottom of a hollow to lower ground, where that moves less rock than filling it.
fn breach(way: &Drainage, z: &mut [f64], hollow: &Hollow, fall: f64) {
    let mut path = Vec::new();
    let mut cut_m3 = 0.0;
    let mut bed = z[hollow.bottom as usize];
    let mut at = hollow.bottom as usize;
    while !way.is_outlet(at) {
        at = way.receiver[at] as usize;
        bed -= fall;
        if z[at] <= bed {
            break;
        }
        if way.is_outlet(at) {
            // The sea and the bottoms of lakes stay as they are: too high an end means that a ditch does not help.
            return;
        }
        cut_m3 += (z[at] - bed) * way.grid.cell_area_m2();
        if cut_m3 >= hollow.volume_m3 {
            return;
        }
        path.push((at, bed));
    }
    path.into_iter().for_each(|(i, bed)| z[i] = bed);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    /// A slope to the west with a dam across it.
    fn dammed(dam_m: f64) -> (Grid, Vec<f64>, Vec<bool>) {
        let grid = Grid::new(12, 9, 12_000.0, Edges::Open);
        let z = (0..grid.cells()).map(|i| {
            let (x, y) = grid.cell_of(i);
            let side = 3.0 * (y as f64 - 4.0).abs();
            10.0 * x as f64 + side + if x == 4 { dam_m } else { 0.0 }
        });
        let outlet = (0..grid.cells()).map(|i| grid.cell_of(i).0 == 0).collect();
        (grid, z.collect(), outlet)
    }

    fn pits(grid: Grid, z: &[f64]) -> usize {
        let lower = |i: usize| neighbours(grid, i).all(|(j, _)| z[j] > z[i]);
        (0..z.len()).filter(|&i| grid.cell_of(i).0 > 0 && lower(i)).count()
    }

    #[test]
    fn a_thin_dam_is_cut_and_a_small_hole_filled() {
        let (grid, mut z, outlet) = dammed(30.0);
        z[grid.index(9, 2)] -= 30.0;
        let before = z.clone();
        let filled = Drainage::of(grid, &z, &outlet).surface_m;
        assert_eq!(hollows(grid, &z, &filled).len(), 2);
        level(grid, &mut z, &outlet, &[]);
        assert_eq!(pits(grid, &z), 0);
        let dam = grid.index(4, 4);
        assert!(z[dam] < before[dam] - 15.0, "the dam is cut");
        let hole = grid.index(9, 2);
        assert!(z[hole] > before[hole] + 10.0, "the hole is filled");
        let filled = Drainage::of(grid, &z, &outlet).surface_m;
        assert_eq!(filled, z, "nothing is left to fill");
    }

    #[test]
    fn a_lake_that_is_kept_keeps_its_floor() {
        let (grid, mut z, outlet) = dammed(60.0);
        // A second bowl under the same water.
        z[grid.index(6, 2)] -= 25.0;
        let before = z.clone();
        let filled = Drainage::of(grid, &z, &outlet).surface_m;
        let lakes = hollows(grid, &z, &filled);
        level(grid, &mut z, &outlet, &lakes);
        let left = hollows(grid, &z, &Drainage::of(grid, &z, &outlet).surface_m);
        assert_eq!((left.len(), pits(grid, &z)), (1, 2));
        assert_eq!(left, lakes);
        assert!(lakes[0].cells.iter().all(|&i| z[i as usize] == before[i as usize]));
    }

    #[test]
    fn what_lies_all_but_level_falls_far_enough_to_be_stored() {
        let grid = Grid::new(30, 3, 3000.0, Edges::Closed);
        let mut z: Vec<f64> = (0..grid.cells()).map(|i| 84.0 + 1e-7 * grid.cell_of(i).0 as f64).collect();
        let ends: Vec<bool> = (0..grid.cells()).map(|i| grid.cell_of(i).0 == 0).collect();
        fill(grid, &mut z, &ends);
        let stored: Vec<f64> = z.iter().map(|&z| z as f32 as f64).collect();
        let way = Drainage::of(grid, &z, &ends);
        assert!((0..z.len()).filter(|&i| !ends[i]).all(|i| stored[way.receiver[i] as usize] < stored[i]));
    }
}
