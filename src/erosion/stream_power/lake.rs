//! What rivers bring to a lake settles on its floor, lowest places first, so that a lake becomes shallower before it
//! becomes smaller.

use std::collections::HashMap;

use crate::flow::Router;

/// Spreads what was laid down in drowned cells over the floors of their lakes: `laid` has each drowned cell with its own
/// part, m; `height` becomes the floors. A lake is all that drains through one drowned cell to a dry one.
pub(super) fn settle(router: &Router, laid: &[(usize, f64)], height: &mut [f64]) {
    let mut floors: Vec<Floor> = Vec::with_capacity(laid.len());
    let mut lakes = Lakes { router, ends: laid.iter().map(|&(cell, _)| (cell, None)).collect() };
    for &(cell, laid_m) in laid {
        floors.push(Floor { lake: lakes.end_of(cell), cell, laid_m });
    }
    floors.sort_unstable_by(|a, b| {
        a.lake.cmp(&b.lake).then(height[a.cell].total_cmp(&height[b.cell])).then(a.cell.cmp(&b.cell))
    });
    for lake in floors.chunk_by(|a, b| a.lake == b.lake) {
        fill(lake, height);
    }
}

/// A drowned cell.
struct Floor {
    lake: usize,
    cell: usize,
    laid_m: f64,
}

/// The last drowned cell below each drowned cell, as far as it is known.
struct Lakes<'a> {
    router: &'a Router,
    ends: HashMap<usize, Option<usize>>,
}

impl Lakes<'_> {
    fn end_of(&mut self, cell: usize) -> usize {
        let (mut way, mut at) = (Vec::new(), cell);
        let end = loop {
            if let Some(&Some(end)) = self.ends.get(&at) {
                break end;
            }
            way.push(at);
            let next = self.router.receiver(at);
            if !self.ends.contains_key(&next) {
                break at;
            }
            at = next;
        };
        for at in way {
            self.ends.insert(at, Some(end));
        }
        end
    }
}

/// Raises the lowest of a lake's cells, which come in the order of their heights, to one level that takes it all.
fn fill(lake: &[Floor], height: &mut [f64]) {
    let mut volume: f64 = lake.iter().map(|floor| floor.laid_m).sum();
    if volume <= 0.0 {
        return;
    }
    let mut level = height[lake[0].cell];
    for (count, floor) in lake.iter().enumerate().skip(1) {
        let wants = (height[floor.cell] - level) * count as f64;
        if wants >= volume {
            return raise(&lake[..count], level + volume / count as f64, height);
        }
        volume -= wants;
        level = height[floor.cell];
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
        let drowned: Vec<usize> = router.flooded(&ground).map(|(i, _)| i).collect();
        let mut drowned: Vec<(usize, f64)> =
            drowned.into_iter().map(|i| (i, if i == 7 { 6.0 } else { 0.25 })).collect();
        drowned.sort_unstable_by_key(|&(i, _)| i);
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
