//! What water takes from the bed and gives back.
//!
//! A particle near the ground tends to the load `K_c·V·sin α·(|v_t| − v_least)`, at a rate, times the bed's own time over the
//! water's. Its share is spread over nine cells by the quadratic B-spline around it, renormalised at a rim. Nothing is dug
//! below the lowest neighbour nor laid above the highest in one go: what all particles ask of a cell is cut alike. Cells are
//! summed up in the order of particles, in `f64`; what `f32` cannot hold of a change waits beside it.

use rayon::prelude::*;

use crate::grid::{Edges, Grid, sum_f64};

use super::super::bed::Bed;
use super::{contact::Ground, params::RainParticlesParams, water::Water};

/// Slope up to which a heap may grow on level ground.
const HEAP: f32 = 0.03;
/// Rise over run of what is laid down at once where water ends.
const CONE: f64 = 0.05;
/// Cells that such a heap reaches at most.
const WIDEST: i64 = 8;

/// What the bed and the water owe each other.
#[derive(Clone, Debug)]
pub(super) struct Exchange {
    /// What has been laid on a cell (or taken off) and does not show in its height yet, m.
    pub(super) rest: Vec<f32>,
    /// What found no cell that takes it, m³.
    pub(super) adrift_m3: f64,
    dig: Vec<f64>,
    lay: Vec<f64>,
    touched: Vec<u32>,
    wants: Vec<f64>,
    asks: Vec<Ask>,
    got: Vec<f64>,
}

/// A particle that wants something from the bed, or to give it something.
#[derive(Clone, Debug)]
struct Ask {
    particle: u32,
    /// What it wants, m³.
    want: f64,
    /// Where.
    nine: Nine,
}

/// Nine cells around a place, row-major, and their weights; 0 beyond the rim.
#[derive(Clone, Debug)]
struct Nine {
    cells: [usize; 9],
    weights: [f64; 9],
}

impl Nine {
    fn at(grid: &Grid, x: f32, y: f32) -> Self {
        let side = |place: f32, size: usize| {
            let at = place as f64 / grid.cell_m;
            let holder = at.floor();
            let d = at - holder - 0.5;
            let weights = [0.5 * (0.5 - d) * (0.5 - d), 0.75 - d * d, 0.5 * (0.5 + d) * (0.5 + d)];
            [0, 1, 2].map(|k| {
                let to = holder as i64 + k as i64 - 1;
                match grid.edges {
                    Edges::Wrap => (to.rem_euclid(size as i64) as usize, weights[k]),
                    _ if (0..size as i64).contains(&to) => (to as usize, weights[k]),
                    _ => (0, 0.0),
                }
            })
        };
        let (columns, rows) = (side(x, grid.width), side(y, grid.height));
        let mut nine = Self { cells: [0; 9], weights: [0.0; 9] };
        let mut total = 0.0;
        for (k, (cell, weight)) in nine.cells.iter_mut().zip(&mut nine.weights).enumerate() {
            *cell = rows[k / 3].0 * grid.width + columns[k % 3].0;
            *weight = rows[k / 3].1 * columns[k % 3].1;
            total += *weight;
        }
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        nine.weights = nine.weights.map(|weight| weight * scale);
        nine
    }

    fn each(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.cells.iter().copied().zip(self.weights).filter(|&(_, weight)| weight > 0.0)
    }
}

impl Exchange {
    pub(super) fn new(grid: &Grid) -> Self {
        Self {
            rest: vec![0.0; grid.cells()],
            adrift_m3: 0.0,
            dig: vec![0.0; grid.cells()],
            lay: vec![0.0; grid.cells()],
            touched: Vec::new(),
            wants: Vec::new(),
            asks: Vec::new(),
            got: Vec::new(),
        }
    }

    /// Rock that is neither in the bed's height nor in water, m³.
    pub(super) fn waiting_m3(&self, grid: &Grid) -> f64 {
        self.adrift_m3 + sum_f64(&self.rest) * grid.cell_area_m2()
    }

    /// Digs and lays down for `dt` of the water's time.
    pub(super) fn run(
        &mut self,
        params: &RainParticlesParams,
        bed: &mut Bed,
        ground: &mut Ground,
        water: &mut Water,
        dt: f64,
    ) {
        let grid = bed.grid;
        let share = -libm::expm1(-params.acidity_per_s * dt);
        let full = params.capacity_s_per_m * water.volume_m3() * params.morphological_factor;
        let fade = 1.0 / (0.25 * params.lifespan_s);
        let (seen, stand) = (&*water, &*ground);
        let want = |i: usize| {
            let (x, y) = (seen.swarm.cloud.x[i], seen.swarm.cloud.y[i]);
            if seen.gap[i] >= seen.spacing() as f32 || stand.holder(x, y).is_none() {
                return 0.0;
            }
            let foot = stand.foot(x, y);
            let (v, n) = ([seen.swarm.cloud.vx[i], seen.swarm.cloud.vy[i], seen.swarm.cloud.vz[i]], foot.normal);
            let off = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
            let along = [v[0] - off * n[0], v[1] - off * n[1], v[2] - off * n[2]];
            let speed = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt() as f64;
            let strength = (speed - params.least_speed_m_per_s).max(0.0) * foot.sine() as f64;
            let capacity = full * strength * (seen.swarm.clock_s[i] as f64 * fade).clamp(0.0, 1.0);
            share * (capacity - seen.swarm.load[i])
        };
        (0..seen.swarm.len()).into_par_iter().with_min_len(1024).map(want).collect_into_vec(&mut self.wants);
        let asked = |&(particle, &want): &(usize, &f64)| {
            let nine = Nine::at(&grid, seen.swarm.cloud.x[particle], seen.swarm.cloud.y[particle]);
            Ask { particle: particle as u32, want, nine }
        };
        let asking: Vec<_> = self.wants.iter().enumerate().filter(|(_, want)| **want != 0.0).collect();
        asking.par_iter().with_min_len(256).map(asked).collect_into_vec(&mut self.asks);
        for Ask { want, nine, .. } in &self.asks {
            for (cell, weight) in nine.each() {
                if self.dig[cell] == 0.0 && self.lay[cell] == 0.0 {
                    self.touched.push(cell as u32);
                }
                let asked = weight * want * bed.rate(cell) as f64;
                *(if *want > 0.0 { &mut self.dig[cell] } else { &mut self.lay[cell] }) += asked.abs();
            }
        }
        // Cells that only gave nothing may have been noted twice.
        self.touched.sort_unstable();
        self.touched.dedup();
        let area = grid.cell_area_m2();
        let touched = std::mem::take(&mut self.touched);
        // Sums become the shares of what was asked that are granted; net changes wait in `net`.
        let mut net = Vec::with_capacity(touched.len());
        for &cell in &touched {
            let cell = cell as usize;
            let [deepest, highest] = limits(&grid, ground, bed, cell);
            let granted = |asked: f64, room: f32| if asked > 0.0 { (room as f64 * area / asked).min(1.0) } else { 0.0 };
            let (dig, lay) = (granted(self.dig[cell], deepest), granted(self.lay[cell], highest));
            net.push((self.lay[cell] * lay - self.dig[cell] * dig) / area);
            (self.dig[cell], self.lay[cell]) = (dig, lay);
        }
        let (dig, lay, rates) = (&self.dig, &self.lay, &*bed);
        let got = |Ask { want, nine, .. }: &Ask| -> f64 {
            let granted = if *want > 0.0 { dig } else { lay };
            nine.each().map(|(cell, weight)| weight * want * rates.rate(cell) as f64 * granted[cell]).sum()
        };
        self.asks.par_iter().with_min_len(256).map(got).collect_into_vec(&mut self.got);
        for (ask, got) in self.asks.iter().zip(&self.got) {
            water.swarm.load[ask.particle as usize] += got;
        }
        for (&cell, net) in touched.iter().zip(net) {
            self.put(bed, cell as usize, net);
            (self.dig[cell as usize], self.lay[cell as usize]) = (0.0, 0.0);
        }
        ground.renew(bed, &touched);
        self.touched = touched;
        self.touched.clear();
    }

    /// Lays `metres` on a cell, as far as `f32` resolves them and land and sea allow; the rest waits.
    fn put(&mut self, bed: &mut Bed, cell: usize, metres: f64) {
        let (old, height) = (bed.change[cell], bed.height(cell));
        let (wanted, room) = (metres + self.rest[cell] as f64, bed.room(height) as f64);
        bed.change[cell] = (old as f64 + wanted.clamp(-room, room)) as f32;
        if bed.coast().is_some_and(|coast| coast.crosses(height, bed.height(cell))) {
            bed.change[cell] = old;
        }
        self.rest[cell] = (wanted - (bed.change[cell] as f64 - old as f64)) as f32;
    }

    /// Lays everything of a particle's load in a low heap around it, wide enough to stay gentle.
    pub(super) fn drop_load(&mut self, bed: &mut Bed, at: [f32; 2], load_m3: f64, changed: &mut Vec<u32>) {
        if load_m3 <= 0.0 {
            self.adrift_m3 += load_m3;
            return;
        }
        let grid = bed.grid;
        let [cx, cy] = at.map(|place| (place as f64 / grid.cell_m).floor() as i64);
        for radius in 1..=WIDEST {
            let mut heap = Vec::new();
            for dy in -radius..=radius {
                for dx in -radius..=radius {
                    let weight = ((radius + 1) * (radius + 1) - dx * dx - dy * dy) as f64;
                    if let Some(cell) = inside(&grid, cx + dx, cy + dy)
                        && weight > 0.0
                        && bed.rate(cell) > 0.0
                        && bed.room(bed.height(cell)) > 0.0
                    {
                        heap.push((cell, weight));
                    }
                }
            }
            let total: f64 = heap.iter().map(|&(_, weight)| weight).sum();
            let each = load_m3 / (total * grid.cell_area_m2());
            let peak = each * ((radius + 1) * (radius + 1)) as f64;
            if !heap.is_empty() && (peak <= CONE * grid.cell_m * radius as f64 || radius == WIDEST) {
                for (cell, weight) in heap {
                    self.put(bed, cell, each * weight);
                    changed.push(cell as u32);
                }
                return;
            }
        }
        self.adrift_m3 += load_m3;
    }

    /// Lays down what still waits: around its cell, or wherever the bed takes it.
    pub(super) fn settle(&mut self, bed: &mut Bed) {
        let grid = bed.grid;
        let area = grid.cell_area_m2();
        // What a cell could not take at once it takes in a few goes, half the way to the sea's level each.
        for _ in 0..8 {
            for cell in 0..grid.cells() {
                if self.rest[cell] != 0.0 {
                    self.put(bed, cell, 0.0);
                }
            }
            let open: Vec<usize> = (0..grid.cells())
                .filter(|&cell| bed.rate(cell) > 0.0 && bed.room(bed.height(cell)) as f64 > 1e-3 * grid.cell_m)
                .collect();
            if self.adrift_m3 == 0.0 || open.is_empty() {
                continue;
            }
            let each = std::mem::take(&mut self.adrift_m3) / (area * open.len() as f64);
            for cell in open {
                self.put(bed, cell, each);
            }
        }
    }
}

/// The cell `(x, y)`, wrapped; `None` beyond a rim.
fn inside(grid: &Grid, x: i64, y: i64) -> Option<usize> {
    let (width, height) = (grid.width as i64, grid.height as i64);
    let (x, y) = if grid.edges == Edges::Wrap { (x.rem_euclid(width), y.rem_euclid(height)) } else { (x, y) };
    ((0..width).contains(&x) && (0..height).contains(&y)).then(|| (y * width + x) as usize)
}

/// How deep a cell may be dug and how high it may be filled in one go, m: half of the way to its lowest neighbour, and to
/// its highest, or to a low heap on level ground.
fn limits(grid: &Grid, ground: &Ground, bed: &Bed, cell: usize) -> [f32; 2] {
    let (x, y) = grid.cell_of(cell);
    let (mut low, mut high, mut sum) = (f32::INFINITY, f32::NEG_INFINITY, 0.0);
    for dy in [-1, 0, 1] {
        for dx in [-1, 0, 1] {
            if (dx, dy) != (0, 0) {
                let height = ground.height(grid.row(y, dy) * grid.width + grid.column(x, dx));
                (low, high, sum) = (low.min(height), high.max(height), sum + height);
            }
        }
    }
    let height = ground.height(cell);
    let room = bed.room(bed.height(cell));
    let heap = sum / 8.0 + HEAP * grid.cell_m as f32;
    [(0.5 * (height - low)).max(0.0).min(room), (0.5 * (high.max(heap) - height)).max(0.0).min(room)]
}
