//! The ground under lava: a surface that rises where lava freezes, and what of that the world has been told.

use crate::{
    grid::{Edges, Field, Grid, Mesh},
    world::{Layer, Matter, World},
};

/// Thickness of lava at which the ground has become about as hard as it, m.
const SKIN_M: f32 = 0.25;

/// The ground.
#[derive(Clone, Debug)]
pub(super) struct Land {
    pub(super) mesh: Mesh,
    grid: Grid,
    /// Heights of particles and mesh count from here, m above the world's datum.
    pub(super) datum_m: f32,
    /// Heights over that when the stage began, m.
    pub(super) start: Vec<f32>,
    /// Thickness of lava on it when the stage began, m.
    pub(super) old: Vec<f32>,
    /// What sediment under lava had left over for it when it became bedrock, m.
    pub(super) slivers: Vec<f64>,
    /// Thickness that has frozen since, m.
    pub(super) raised: Vec<f64>,
    /// Cells that have risen since the world was told, and by how much and how hot, m and m·°C.
    fresh: Vec<(u32, f64, f64)>,
}

/// Where a volume comes to lie: cells and shares, which add up to 1.
struct Spread {
    cells: Vec<(u32, f64)>,
}

impl Land {
    /// The ground of a world.
    pub(super) fn new(world: &World) -> Self {
        let height = world.height();
        let datum_m = height.data.iter().fold(f32::INFINITY, |a, &b| a.min(b)).floor();
        let start = height.data.iter().map(|z| z - datum_m).collect();
        let old = match world.layer(Layer::Lava) {
            Some(lava) => lava.data.clone(),
            None => vec![0.0; world.grid.cells()],
        };
        let none = || vec![0.0; world.grid.cells()];
        Self::restored(world.grid, datum_m, [start, old], [none(), none()])
    }

    /// The ground as it was saved.
    pub(super) fn restored(
        grid: Grid,
        datum_m: f32,
        [start, old]: [Vec<f32>; 2],
        [raised, slivers]: [Vec<f64>; 2],
    ) -> Self {
        let mesh = Mesh::new(grid, |i| (f64::from(start[i]) + raised[i]) as f32);
        Self { mesh, grid, datum_m, start, old, raised, slivers, fresh: Vec::new() }
    }

    /// Lets volumes freeze, each at a place at a temperature: m, m³, °C. What lies beyond the rim lies down on it.
    pub(super) fn lay(&mut self, frozen: &[([f32; 2], f64)], volume_m3: f64, reach_m: f64) {
        let each = volume_m3 / self.grid.cell_area_m2();
        let mut touched = Vec::new();
        for &(at, degc) in frozen {
            for (cell, share) in self.spread(at, reach_m).cells {
                let thick = each * share;
                self.raised[cell as usize] += thick;
                self.fresh.push((cell, thick, thick * degc));
                touched.push(cell);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        let Self { mesh, start, raised, .. } = self;
        mesh.renew(&touched, |i| (f64::from(start[i]) + raised[i]) as f32);
    }

    /// The cells about a place, by how near they are.
    fn spread(&self, at: [f32; 2], reach_m: f64) -> Spread {
        let grid = &self.grid;
        let extent = grid.extent_m();
        let reach = reach_m.max(1.2 * grid.cell_m) / grid.cell_m;
        let place = [0, 1].map(|axis| {
            let at = f64::from(at[axis]);
            let at = if grid.edges == Edges::Wrap { at } else { at.clamp(0.0, extent[axis]) };
            at / grid.cell_m - 0.5
        });
        let first = place.map(|at| (at - reach).ceil() as i64);
        let last = place.map(|at| (at + reach).floor() as i64);
        let (mut cells, mut whole) = (Vec::new(), 0.0);
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let (dx, dy) = (x as f64 - place[0], y as f64 - place[1]);
                let near = (1.0 - (dx * dx + dy * dy) / (reach * reach)).max(0.0);
                let weight = near * near;
                if let (Some(cell), true) = (cell(grid, x, y), weight > 0.0) {
                    cells.push((cell as u32, weight));
                    whole += weight;
                }
            }
        }
        cells.iter_mut().for_each(|(_, weight)| *weight /= whole);
        Spread { cells }
    }

    /// Depth of particles that flow, m, and their mean temperature, °C.
    pub(super) fn depth_m(&self, at: [&[f32]; 2], degc: &[f64], volume_m3: f64, reach_m: f64) -> [Field<f32>; 2] {
        let each = volume_m3 / self.grid.cell_area_m2();
        let [mut depth, mut warm] = [0; 2].map(|_| vec![0.0f64; self.grid.cells()]);
        for ((&x, &y), degc) in at[0].iter().zip(at[1]).zip(degc) {
            for (cell, share) in self.spread([x, y], reach_m).cells {
                depth[cell as usize] += each * share;
                warm[cell as usize] += each * share * degc;
            }
        }
        for (warm, depth) in warm.iter_mut().zip(&depth).filter(|(_, depth)| **depth > 0.0) {
            *warm /= depth;
        }
        [depth, warm].map(|values| Field { grid: self.grid, data: values.into_iter().map(|v| v as f32).collect() })
    }

    /// Tells the world what has frozen since it was told last, and books it. `hardness` is that of lava.
    pub(super) fn write(&mut self, world: &mut World, hardness: f32, stage: &str) {
        let (width, stock) = (world.grid.width, world.rock_m3());
        let waits = self.waiting_m(world.layer(Layer::Lava));
        let fresh = self.gathered();
        for layer in [Layer::Bedrock, Layer::Lava, Layer::Hardness, Layer::LavaTemperature, Layer::LavaDate] {
            world.layer_mut(layer);
        }
        self.bury(world, &fresh);
        let (date, old, raised, slivers) = (world.time_yr as f32, &self.old, &self.raised, &self.slivers);
        let lava = world.layer_mut(Layer::Lava);
        crate::grid::map_cells(&mut lava.data, width, |x, y| {
            let i = y * width + x;
            (f64::from(old[i]) + (raised[i] + slivers[i])) as f32
        });
        for &(cell, thick, warm) in &fresh {
            let i = cell as usize;
            // As if skins were laid one by one: it does not matter in how many steps they came.
            let below = libm::expf(-(thick as f32) / SKIN_M);
            let hard = &mut world.layer_mut(Layer::Hardness).data[i];
            *hard = hardness + (*hard - hardness) * below;
            // Of this eruption's lava: nobody knows how much of the older one had which.
            let before = (raised[i] - thick).max(0.0);
            let degc = &mut world.layer_mut(Layer::LavaTemperature).data[i];
            *degc = ((f64::from(*degc) * before + warm) / (before + thick)) as f32;
            world.layer_mut(Layer::LavaDate).data[i] = date;
        }
        let booked = (waits - self.waiting_m(world.layer(Layer::Lava))) * world.grid.cell_area_m2();
        let stored = world.rock_m3() - stock;
        // The sum over a whole world is good to some 1e-13 of it. Within that, what is there decides.
        let agrees = (stored - booked).abs() <= 1e-12 * stock.abs().max(world.rock_m3().abs());
        world.ledger.book_in(stage, Matter::Rock, if agrees { stored } else { booked });
    }

    /// What the layer does not hold of the lava that is there, m: what froze since it was told, and what `f32` cannot hold.
    fn waiting_m(&self, lava: Option<&Field<f32>>) -> f64 {
        let thick = |i: usize| f64::from(self.old[i]) + (self.raised[i] + self.slivers[i]);
        // A world without the layer holds none.
        let there = |i: usize| lava.map_or(0.0, |lava| f64::from(lava.data[i]));
        (0..self.old.len()).map(|i| thick(i) - there(i)).sum()
    }

    /// What has risen since the world was told, a row a cell, in order.
    fn gathered(&mut self) -> Vec<(u32, f64, f64)> {
        let mut fresh = std::mem::take(&mut self.fresh);
        // Stable: the sums have the order in which lava froze.
        fresh.sort_by_key(|&(cell, ..)| cell);
        let mut rows: Vec<(u32, f64, f64)> = Vec::new();
        for (cell, thick, warm) in fresh {
            match rows.last_mut() {
                Some(last) if last.0 == cell => (last.1, last.2) = (last.1 + thick, last.2 + warm),
                _ => rows.push((cell, thick, warm)),
            }
        }
        rows
    }

    /// Turns sediment under fresh lava to bedrock. What bedrock's `f32` cannot hold of it becomes lava.
    fn bury(&mut self, world: &mut World, fresh: &[(u32, f64, f64)]) {
        let Some(mut sediment) = world.remove_layer(Layer::Sediment) else { return };
        let bedrock = world.layer_mut(Layer::Bedrock);
        for &(cell, ..) in fresh {
            let i = cell as usize;
            let loose = sediment.data[i];
            if loose > 0.0 {
                let whole = f64::from(bedrock.data[i]) + f64::from(loose);
                let mut solid = whole as f32;
                if f64::from(solid) > whole {
                    solid = solid.next_down();
                }
                bedrock.data[i] = solid;
                self.slivers[i] += whole - f64::from(solid);
                sediment.data[i] = 0.0;
            }
        }
        world.set_layer(Layer::Sediment, sediment);
    }
}

/// The cell `(x, y)`, wrapped; `None` beyond a rim.
fn cell(grid: &Grid, x: i64, y: i64) -> Option<usize> {
    let (width, height) = (grid.width as i64, grid.height as i64);
    let (x, y) = if grid.edges == Edges::Wrap { (x.rem_euclid(width), y.rem_euclid(height)) } else { (x, y) };
    ((0..width).contains(&x) && (0..height).contains(&y)).then(|| (y * width + x) as usize)
}
