//! Lakes as things: which cells, how high, where the water leaves.

use super::{Drainage, neighbours};

/// Standing water that a surface would hold if rain filled every depression.
#[derive(Clone, Debug, PartialEq)]
pub struct Lake {
    /// Its cells, by index.
    pub cells: Vec<u32>,
    /// Height of its water, m.
    pub level_m: f64,
    /// The cell outside it that its water goes to.
    pub outlet: u32,
    /// Area, m².
    pub area_m2: f64,
    /// Volume, m³.
    pub volume_m3: f64,
}

impl Drainage {
    /// The lakes on the ground that was routed, largest first; of equals the one whose first cell has the lower index.
    pub fn lakes(&self, height_m: &[f64]) -> Vec<Lake> {
        let wet = |i: usize| self.surface_m[i] > height_m[i];
        let mut seen = vec![false; self.len()];
        let mut lakes = Vec::new();
        for first in 0..self.len() {
            if seen[first] || !wet(first) {
                continue;
            }
            let level_m = self.surface_m[first];
            seen[first] = true;
            let (mut cells, mut at) = (vec![first as u32], 0);
            while at < cells.len() {
                for (j, _) in neighbours(self.grid, cells[at] as usize) {
                    if !seen[j] && wet(j) && self.surface_m[j] == level_m {
                        seen[j] = true;
                        cells.push(j as u32);
                    }
                }
                at += 1;
            }
            cells.sort_unstable();
            lakes.push(self.lake(height_m, level_m, cells));
        }
        lakes.sort_by_key(|lake| std::cmp::Reverse(lake.cells.len()));
        lakes
    }

    fn lake(&self, height_m: &[f64], level_m: f64, cells: Vec<u32>) -> Lake {
        let away = |&i: &u32| Some(self.receiver[i as usize]).filter(|r| cells.binary_search(r).is_err());
        let outlet = cells.iter().find_map(away).unwrap_or(cells[0]);
        let cell_m2 = self.grid.cell_area_m2();
        let depth: f64 = cells.iter().map(|&i| level_m - height_m[i as usize]).sum();
        Lake { area_m2: cells.len() as f64 * cell_m2, volume_m3: depth * cell_m2, cells, level_m, outlet }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn a_bowl_holds_what_its_rim_allows() {
        // A square bowl of 5 x 5 cells, 3 m deep, in a plain at 10 m that falls outside it; a notch at 9 m in the east.
        let grid = Grid::new(9, 9, 90.0, Edges::Open);
        let height: Vec<f64> = (0..81)
            .map(|i| match grid.cell_of(i) {
                (2..=6, 2..=6) => 7.0,
                (7, 4) => 9.0,
                (x, y) if x == 0 || y == 0 || x == 8 || y == 8 => 5.0,
                _ => 10.0,
            })
            .collect();
        let outlet: Vec<bool> = height.iter().map(|&z| z == 5.0).collect();
        let lakes = Drainage::of(grid, &height, &outlet).lakes(&height);
        assert_eq!(lakes.len(), 1);
        let lake = &lakes[0];
        assert_eq!((lake.level_m, lake.cells.len(), lake.outlet), (9.0, 25, 4 * 9 + 7));
        assert_eq!((lake.area_m2, lake.volume_m3), (2500.0, 5000.0));
    }
}
