//! The forest of receivers over a surface without depressions.

use crate::grid::Grid;

use super::Router;

/// Every cell's way to an outlet.
#[derive(Clone, Debug)]
pub struct Drainage {
    /// The raster.
    pub grid: Grid,
    /// The cell that each cell drains to, the steepest way down, out of a depression towards
    /// its lowest pass; its own index at an outlet.
    pub receiver: Vec<u32>,
    /// All cells, each after its receiver.
    pub order: Vec<u32>,
    /// Height with depressions filled to their spill point, m; above the ground where a lake stands.
    pub surface_m: Vec<f64>,
}

impl Drainage {
    /// Routes a surface to its outlets. Ties go to the neighbour that comes first in [`super::STEPS`].
    pub fn of(grid: Grid, height_m: &[f64], outlet: &[bool]) -> Self {
        let mut router = Router::new(grid);
        router.route(height_m, outlet);
        let mut surface_m = height_m.to_vec();
        for (i, level) in router.flooded(height_m) {
            surface_m[i] = level;
        }
        let receiver = (0..grid.cells()).map(|i| router.receiver(i) as u32).collect();
        Self { grid, receiver, order: router.upward().collect(), surface_m }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.receiver.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.receiver.is_empty()
    }

    /// Whether water leaves at this cell.
    pub fn is_outlet(&self, i: usize) -> bool {
        self.receiver[i] as usize == i
    }

    /// Distance from a cell to its receiver, m; 0 at an outlet.
    pub fn step_m(&self, i: usize) -> f64 {
        let r = self.receiver[i] as usize;
        if r == i {
            return 0.0;
        }
        let ((x, y), (rx, ry)) = (self.grid.cell_of(i), self.grid.cell_of(r));
        if x != rx && y != ry { self.grid.cell_m * std::f64::consts::SQRT_2 } else { self.grid.cell_m }
    }

    /// What gathers at each cell from itself and all cells above it.
    pub fn accumulate(&self, source: &[f64]) -> Vec<f64> {
        let mut sum = source.to_vec();
        for &i in self.order.iter().rev() {
            let (i, r) = (i as usize, self.receiver[i as usize] as usize);
            if r != i {
                sum[r] += sum[i];
            }
        }
        sum
    }

    /// Catchment area, m².
    pub fn area_m2(&self) -> Vec<f64> {
        self.accumulate(&vec![self.grid.cell_area_m2(); self.len()])
    }

    /// The outlet that each cell drains to.
    pub fn basin(&self) -> Vec<u32> {
        let mut basin = self.receiver.clone();
        for &i in &self.order {
            basin[i as usize] = basin[self.receiver[i as usize] as usize];
        }
        basin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        flow::{flood::flood, neighbours, outlets},
        grid::{Edges, Field},
    };

    fn rough(size: usize, edges: Edges) -> Field<f32> {
        let grid = Grid::new(size, size, size as f64, edges);
        // A multiplicative hash: no two neighbours alike, ties among a thousand heights.
        let hash = |x: usize, y: usize| (x as u32 + 977 * y as u32).wrapping_mul(0x9E37_79B1) >> 12;
        Field::from_fn(grid, |x, y| (hash(x, y) % 1000) as f32)
    }

    fn drainage(field: &Field<f32>) -> Drainage {
        let height: Vec<f64> = field.data.iter().map(|&v| v as f64).collect();
        Drainage::of(field.grid, &height, &outlets(field, f64::MIN))
    }

    #[test]
    fn every_cell_has_a_way_out_and_all_area_arrives() {
        for edges in [Edges::Open, Edges::Closed, Edges::Wrap] {
            let field = rough(33, edges);
            let d = drainage(&field);
            let mut place = vec![0; d.len()];
            for (at, &i) in d.order.iter().enumerate() {
                place[i as usize] = at;
            }
            for i in (0..d.len()).filter(|&i| !d.is_outlet(i)) {
                let r = d.receiver[i] as usize;
                assert!(place[r] < place[i] && d.surface_m[r] <= d.surface_m[i], "{edges:?} {i}");
            }
            let area = d.area_m2();
            let out: f64 = (0..d.len()).filter(|&i| d.is_outlet(i)).map(|i| area[i]).sum();
            assert_eq!(out, 33.0 * 33.0, "{edges:?}");
        }
    }

    #[test]
    fn levels_are_those_of_the_flood() {
        // Taller than a strip, with pits everywhere, and long flats where heights are coarse.
        for (size, coarse) in [(33, 1.0), (150, 1.0), (300, 1.0), (150, 200.0), (150, 2000.0)] {
            for edges in [Edges::Open, Edges::Wrap] {
                let field = rough(size, edges).map(|v| (v / coarse).floor());
                let height: Vec<f64> = field.data.iter().map(|&v| v as f64).collect();
                let outlet = outlets(&field, f64::MIN);
                let d = Drainage::of(field.grid, &height, &outlet);
                assert_eq!(d.surface_m, flood(field.grid, &height, &outlet).surface_m, "{size} {edges:?} {coarse}");
                let mut order = d.order.clone();
                order.sort_unstable();
                assert!(order.into_iter().eq(0..d.len() as u32));
            }
        }
    }

    #[test]
    fn filling_twice_changes_nothing() {
        let d = drainage(&rough(40, Edges::Open));
        let again = Drainage::of(d.grid, &d.surface_m, &(0..d.len()).map(|i| d.is_outlet(i)).collect::<Vec<_>>());
        assert_eq!(again.surface_m, d.surface_m);
    }

    #[test]
    fn the_fill_is_the_lowest_that_drains() {
        // Against repeated relaxation from above, the definition itself.
        let field = rough(20, Edges::Open);
        let d = drainage(&field);
        let mut level: Vec<f64> = vec![f64::MAX; d.len()];
        for i in (0..d.len()).filter(|&i| d.is_outlet(i)) {
            level[i] = field.data[i] as f64;
        }
        loop {
            let mut changed = false;
            for i in 0..d.len() {
                let least = neighbours(d.grid, i).map(|(j, _)| level[j]).fold(f64::MAX, f64::min);
                let want = least.max(field.data[i] as f64).min(level[i]);
                changed |= want != level[i];
                level[i] = want;
            }
            if !changed {
                break;
            }
        }
        assert_eq!(level, d.surface_m);
    }
}
