//! Depressions by their graph (Cordonnier, Bovy and Braun 2019): every pit has a basin, basins touch at passes, and the
//! tree of lowest passes tells where each one spills. What follows water is done only where pits
//! are; labels, borders and levels are looked at row by row over the whole map.
//!
//! The way from a pit to its pass is turned round, so that receivers stay neighbours.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::{
    compass::{Compass, opposite},
    router::{Forest, PIT, ROOT},
};
use crate::grid::{Grid, for_each_row};

/// Basins that one thread takes at a time.
const BASINS: usize = 64;

/// A place where two basins touch.
#[derive(Clone, Copy)]
struct Pass {
    height_m: f64,
    /// Basin of `cell`.
    from: u32,
    /// Basin one step on.
    to: u32,
    cell: u32,
    way: u8,
}

/// Basins of pits, numbered from 1; 0 is what drains to an outlet by itself.
#[derive(Default)]
pub(super) struct Spill {
    label: Vec<AtomicU32>,
    /// Cells of all basins, one basin after another.
    cells: Vec<u32>,
    /// Cells where passes to basins of lower numbers may be.
    border: Vec<bool>,
    /// Where the cells of basin `b` begin, at `b - 1`.
    first: Vec<usize>,
    /// Height to which each basin fills, m.
    level_m: Vec<f64>,
    passes: Vec<Pass>,
}

impl Spill {
    /// Gives every pit a way out.
    pub(super) fn drain(&mut self, z: &[f64], mut forest: Forest) {
        self.gather_basins(z, &mut forest);
        if self.basins() == 0 {
            return;
        }
        self.find_borders(forest.compass.grid);
        self.find_passes(&forest.compass, z);
        self.passes.par_sort_unstable_by(|a, b| {
            a.height_m.total_cmp(&b.height_m).then(a.cell.cmp(&b.cell)).then(a.way.cmp(&b.way))
        });
        let tree = lowest_tree(&self.passes, self.basins());
        self.spill_along(&tree, &mut forest);
    }

    /// Number of pits' basins.
    pub(super) fn basins(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Cells whose ground lies below the level of their basin, by their index, each with that level.
    pub(super) fn flooded(&self, z: &[f64]) -> Vec<(usize, f64)> {
        let cells = self.label.par_iter().zip(z).enumerate();
        let flooded = cells.filter_map(|(i, (label, &z))| {
            let basin = label.load(Relaxed) as usize;
            let level = if basin == 0 { f64::NEG_INFINITY } else { self.level_m[basin] };
            (z < level).then_some((i, level))
        });
        flooded.collect()
    }

    /// Collects what drains to each pit.
    fn gather_basins(&mut self, z: &[f64], forest: &mut Forest) {
        self.label.resize_with(z.len(), AtomicU32::default);
        self.label.par_iter_mut().for_each(|label| *label.get_mut() = 0);
        let pits = find_pits(z, forest);
        let (label, forest) = (&self.label, &*forest);
        // Basins share no cell, so that their labels can be written side by side.
        let blocks: Vec<(Vec<u32>, Vec<usize>)> = pits
            .par_chunks(BASINS)
            .enumerate()
            .map(|(block, pits)| {
                let (mut cells, mut sizes) = (Vec::new(), Vec::with_capacity(pits.len()));
                for (&pit, basin) in pits.iter().zip(block * BASINS + 1..) {
                    let before = cells.len();
                    gather_basin(pit, forest, |i| label[i].store(basin as u32, Relaxed), &mut cells);
                    sizes.push(cells.len() - before);
                }
                (cells, sizes)
            })
            .collect();
        self.cells.clear();
        self.first.clear();
        self.first.push(0);
        let mut end = 0;
        for (cells, sizes) in blocks {
            self.cells.extend(cells);
            self.first.extend(sizes.into_iter().map(|size| {
                end += size;
                end
            }));
        }
    }

    /// Marks the cells that touch a basin of a lower number than their own.
    fn find_borders(&mut self, grid: Grid) {
        let (label, width) = (&self.label, grid.width);
        self.border.resize(label.len(), false);
        for_each_row(&mut self.border, width, |y, out| {
            let [north, row, south] = [grid.row(y, -1), y, grid.row(y, 1)].map(|y| &label[y * width..][..width]);
            let basin = |label: &AtomicU32| label.load(Relaxed);
            let least = |x: usize| basin(&north[x]).min(basin(&row[x])).min(basin(&south[x]));
            let (mut west, mut here) = (least(grid.column(0, -1)), least(0));
            for (x, out) in out.iter_mut().enumerate() {
                let east = least(grid.column(x, 1));
                *out = west.min(here).min(east) < basin(&row[x]);
                (west, here) = (here, east);
            }
        });
    }

    /// The lowest pass between any two basins that touch.
    fn find_passes(&mut self, compass: &Compass, z: &[f64]) {
        let (label, border, cells, first) = (&self.label, &self.border, &self.cells, &self.first);
        let all: Vec<usize> = (1..first.len()).collect();
        // Where the pass already known from the basin at hand to another one stands; what is older is not believed.
        let known = || vec![u32::MAX; first.len()];
        let blocks: Vec<Vec<Pass>> = all
            .par_chunks(BASINS)
            .map_init(known, |known, basins| {
                let mut passes: Vec<Pass> = Vec::new();
                for &basin in basins {
                    let begin = passes.len();
                    for &i in cells[first[basin - 1]..first[basin]].iter().filter(|&&i| border[i as usize]) {
                        compass.each(i as usize, |way, j| {
                            let other = label[j].load(Relaxed);
                            // Each pair is listed by the later of the two.
                            if other as usize >= basin {
                                return;
                            }
                            let height_m = z[i as usize].max(z[j]);
                            let pass = Pass { height_m, from: basin as u32, to: other, cell: i, way };
                            let at = known[other as usize] as usize;
                            match passes.get_mut(at).filter(|pass| at >= begin && pass.to == other) {
                                Some(lowest) if height_m < lowest.height_m => *lowest = pass,
                                Some(_) => (),
                                None => {
                                    known[other as usize] = passes.len() as u32;
                                    passes.push(pass);
                                }
                            }
                        });
                    }
                }
                passes
            })
            .collect();
        self.passes.clear();
        blocks.into_iter().for_each(|passes| self.passes.extend(passes));
    }

    /// Follows the tree from outside in: fills each basin to its pass, and turns the way from its pit to the pass round.
    fn spill_along(&mut self, tree: &[Pass], forest: &mut Forest) {
        let basins = self.basins() + 1;
        let (mut begin, mut touching) = (vec![0u32; basins + 1], vec![0u32; 2 * tree.len()]);
        for pass in tree {
            begin[pass.from as usize + 1] += 1;
            begin[pass.to as usize + 1] += 1;
        }
        for b in 0..basins {
            begin[b + 1] += begin[b];
        }
        let mut next = begin.clone();
        for (at, pass) in tree.iter().enumerate() {
            for basin in [pass.from, pass.to] {
                touching[next[basin as usize] as usize] = at as u32;
                next[basin as usize] += 1;
            }
        }
        self.level_m.clear();
        self.level_m.resize(basins, f64::INFINITY);
        self.level_m[0] = f64::NEG_INFINITY;
        let mut reached = vec![0usize];
        while let Some(basin) = reached.pop() {
            for &at in &touching[begin[basin] as usize..begin[basin + 1] as usize] {
                let pass = tree[at as usize];
                let inward = pass.to as usize == basin;
                let child = if inward { pass.from } else { pass.to } as usize;
                if self.level_m[child] != f64::INFINITY {
                    continue;
                }
                self.level_m[child] = self.level_m[basin].max(pass.height_m);
                if inward {
                    turn_round(pass.cell as usize, pass.way, forest);
                } else {
                    turn_round(forest.compass.to(pass.cell as usize, pass.way), opposite(pass.way), forest);
                }
                reached.push(child);
            }
        }
    }
}

/// The cells without a lower neighbour, row by row. A flat floor is one pit: its other cells are led to its first one.
fn find_pits(z: &[f64], forest: &mut Forest) -> Vec<usize> {
    let (compass, width) = (forest.compass, forest.compass.grid.width);
    let (mut pits, mut floor) = (Vec::new(), Vec::new());
    for y in 0..compass.grid.height {
        let row = y * width..(y + 1) * width;
        if !forest.way[row.clone()].contains(&PIT) {
            continue;
        }
        for pit in row {
            if forest.way[pit] != PIT {
                continue;
            }
            pits.push(pit);
            floor.clear();
            floor.push(pit);
            let mut at = 0;
            while at < floor.len() {
                compass.each(floor[at], |step, k| {
                    if forest.way[k] == PIT && z[k] == z[pit] && k != pit {
                        forest.lead(k, opposite(step));
                        floor.push(k);
                    }
                });
                at += 1;
            }
        }
    }
    pits
}

/// Adds the cells of a pit's basin, and marks them.
fn gather_basin(pit: usize, forest: &Forest, mark: impl Fn(usize), cells: &mut Vec<u32>) {
    let mut at = cells.len();
    mark(pit);
    cells.push(pit as u32);
    while at < cells.len() {
        forest.each_donor(cells[at] as usize, |k| {
            mark(k);
            cells.push(k as u32);
        });
        at += 1;
    }
}

/// Leads the basin of `cell` out by `out`: the way from there down to the pit is turned round.
fn turn_round(mut cell: usize, mut out: u8, forest: &mut Forest) {
    loop {
        let down = forest.lead(cell, out);
        if down == PIT || down == ROOT {
            return;
        }
        cell = forest.compass.to(cell, down);
        out = opposite(down);
    }
}

/// The passes, lowest first, that join basins not joined yet (Kruskal).
fn lowest_tree(passes: &[Pass], basins: usize) -> Vec<Pass> {
    let mut joined: Vec<u32> = (0..=basins as u32).collect();
    let mut tree = Vec::with_capacity(basins);
    for pass in passes {
        let (a, b) = (representative(&mut joined, pass.from), representative(&mut joined, pass.to));
        if a != b {
            joined[a.max(b) as usize] = a.min(b);
            tree.push(*pass);
        }
    }
    tree
}

/// The basin that stands for all that are joined with `b`.
fn representative(joined: &mut [u32], mut b: u32) -> u32 {
    while joined[b as usize] != b {
        let above = joined[joined[b as usize] as usize];
        joined[b as usize] = above;
        b = above;
    }
    b
}
