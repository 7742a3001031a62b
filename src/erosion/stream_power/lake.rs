//! What rivers bring to a lake settles on its floor, lowest places first, so that a lake becomes shallower before it
//! becomes smaller.

use rayon::prelude::*;

use crate::flow::Router;

/// Spreads what was laid down in drowned cells over the floors of their lakes: `laid` has each drowned cell with its own
/// part, m; `height` becomes the floors. A lake is all that drains through one drowned cell to a dry one.
pub(super) fn settle(router: &Router, laid: &[(usize, f64)], height: &mut [f64]) {
    let ends = ends(router, laid);
    let floor = |(&lake, &(cell, laid_m)): (&u32, &(usize, f64))| Floor { lake, cell, laid_m, height_m: height[cell] };
    let mut floors: Vec<Floor> = ends.par_iter().zip(laid).map(floor).collect();
    floors.par_sort_unstable_by(|a, b| {
        a.lake.cmp(&b.lake).then(a.height_m.total_cmp(&b.height_m)).then(a.cell.cmp(&b.cell))
    });
    for lake in floors.chunk_by(|a, b| a.lake == b.lake) {
        fill(lake, height);
    }
}

/// A drowned cell.
struct Floor {
    /// The last drowned cell of its lake.
    lake: u32,
    cell: usize,
    laid_m: f64,
    /// Height before anything settles, m.
    height_m: f64,
}

/// The last drowned cell below each drowned cell.
fn ends(router: &Router, laid: &[(usize, f64)]) -> Vec<u32> {
    /// Not known yet.
    const OPEN: u32 = u32::MAX;
    // Each drowned cell's place in the list, from 1.
    let mut places = vec![0u32; router.grid().cells()];
    for (&(cell, _), place) in laid.iter().zip(1..) {
        places[cell] = place;
    }
    let mut ends = vec![OPEN; laid.len()];
    let mut path = Vec::new();
    for first in 0..laid.len() {
        let mut at = first;
        let end = loop {
            if ends[at] != OPEN {
                break ends[at];
            }
            path.push(at);
            match places[router.receiver(laid[at].0)] {
                0 => break laid[at].0 as u32,
                next => at = next as usize - 1,
            }
        };
        path.drain(..).for_each(|at| ends[at] = end);
    }
    ends
}

/// Raises the lowest of a lake's cells, which come in the order of their heights, to one level that takes it all.
fn fill(lake: &[Floor], height: &mut [f64]) {
    let mut volume: f64 = lake.iter().map(|floor| floor.laid_m).sum();
    if volume <= 0.0 {
        return;
    }
    let mut level = lake[0].height_m;
    for (count, floor) in lake.iter().enumerate().skip(1) {
        let wants = (floor.height_m - level) * count as f64;
        if wants >= volume {
            return raise(&lake[..count], level + volume / count as f64, height);
        }
        volume -= wants;
        level = floor.height_m;
    }
    raise(lake, level + volume / lake.len() as f64, height);
}

fn raise(cells: &[Floor], level: f64, height: &mut [f64]) {
    for floor in cells {
        height[floor.cell] = level;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn each_lake_gets_one_floor_and_all_of_its_sediment() {
        // A row that falls to the west, with two bowls of five cells; what lies in them drains over their rims.
        let grid = Grid::new(20, 1, 20.0, Edges::Closed);
        let bed = |x: usize| match x {
            3..=7 | 11..=15 => [8.0, 3.0, 1.0, 2.0, 9.0][(x - 3) % 8] + x as f64,
            _ => 40.0 + x as f64,
        };
        let ground: Vec<f64> = (0..20).map(|x| if x == 0 { 0.0 } else { bed(x) }).collect();
        let mut router = Router::new(grid);
        router.route(&ground, &(0..20).map(|x| x == 0).collect::<Vec<_>>());
        let drowned: Vec<(usize, f64)> =
            router.flooded(&ground).into_iter().map(|(i, _)| (i, if i == 7 { 6.0 } else { 0.25 })).collect();
        assert_eq!(drowned.iter().map(|&(i, _)| i).collect::<Vec<_>>(), [3, 4, 5, 6, 7, 11, 12, 13, 14, 15]);
        let mut z = ground.clone();
        settle(&router, &drowned, &mut z);
        let gained = |cells: std::ops::RangeInclusive<usize>| cells.map(|i| z[i] - ground[i]).sum::<f64>();
        assert!((gained(3..=7) - 7.0).abs() < 1e-12 && (gained(11..=15) - 1.25).abs() < 1e-12, "{z:?}");
        // 7 m over floors at 6, 7 and 8 m: up to 28/3 m; 1.25 m over one at 14 m and one at 15 m.
        assert!([4, 5, 6].iter().all(|&i| (z[i] - 28.0 / 3.0).abs() < 1e-12), "{z:?}");
        assert!(
            z[12] == 15.125 && z[13] == 15.125 && z[3] == ground[3] && z[7] == ground[7] && z[11] == ground[11],
            "{z:?}"
        );
    }
}
