//! Pits: level patches of land with no lower neighbour, on the ground as it is. Where a lake stands in one (layer
//! `lake_depth`) it is counted as a lake. The rim of an open map lets water out and has none.

use crate::{flow, grid::Field};

/// Pits and lakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pits {
    /// Closed hollows without a lake.
    pub pits: usize,
    /// Closed hollows with one.
    pub lakes: usize,
    /// Cells of land.
    pub land: usize,
}

impl Pits {
    /// Pits in ten thousand cells of land; `None` without land.
    pub fn per_10_000(&self) -> Option<f64> {
        (self.land > 0).then(|| self.pits as f64 * 1e4 / self.land as f64)
    }
}

/// Counts the pits of a ground.
pub fn pits(height: &Field<f32>, sea_level_m: f64, lake_depth: Option<&Field<f32>>) -> Pits {
    let grid = height.grid;
    let outlet = flow::outlets(height, sea_level_m);
    let z = &height.data;
    let mut seen = vec![false; z.len()];
    let mut found = Pits { pits: 0, lakes: 0, land: z.iter().filter(|&&h| h as f64 > sea_level_m).count() };
    let mut patch = Vec::new();
    for start in 0..z.len() {
        if seen[start] || outlet[start] || flow::neighbours(grid, start).any(|(j, _)| z[j] < z[start]) {
            continue;
        }
        // The patch of one height; it is closed if nowhere on it water finds a way down or out.
        patch.clear();
        patch.push(start);
        seen[start] = true;
        let (mut closed, mut lake, mut at) = (true, false, 0);
        while let Some(&i) = patch.get(at) {
            at += 1;
            closed &= !outlet[i];
            lake |= lake_depth.is_some_and(|depth| depth.data[i] > 0.0);
            for (j, _) in flow::neighbours(grid, i) {
                closed &= z[j] >= z[i];
                if z[j] == z[i] && !std::mem::replace(&mut seen[j], true) {
                    patch.push(j);
                }
            }
        }
        // A hollow at the sea's own height is a shore, not land.
        if closed && z[start] as f64 > sea_level_m {
            *(if lake { &mut found.lakes } else { &mut found.pits }) += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn hollows_are_counted_once_and_lakes_apart() {
        let grid = Grid::new(40, 30, 40.0, Edges::Open);
        let mut ground = Field::from_fn(grid, |x, y| 100.0 + (x + y) as f32);
        let hole = |x: usize, y: usize| grid.index(x, y);
        ground.data[hole(10, 10)] = 5.0;
        for x in 20..24 {
            ground.data[hole(x, 20)] = 6.0;
        }
        assert_eq!(pits(&ground, 0.0, None), Pits { pits: 2, lakes: 0, land: 1200 });
        let mut lake = Field::filled(grid, 0.0);
        lake.data[hole(22, 20)] = 3.0;
        let found = pits(&ground, 0.0, Some(&lake));
        assert_eq!(found, Pits { pits: 1, lakes: 1, land: 1200 });
        assert!((found.per_10_000().unwrap() - 1e4 / 1200.0).abs() < 1e-9);
        // Under the sea there are none; nor on a level map, which lets water out over its rim.
        assert_eq!(pits(&ground, 50.0, None).pits, 0);
        assert_eq!(pits(&Field::filled(grid, 1.0), 0.0, None).pits, 0);
        assert_eq!(pits(&ground, 1e6, None).per_10_000(), None);
    }
}
