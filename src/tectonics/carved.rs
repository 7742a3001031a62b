//! Ground that other stages carve while the plates move. What they carved drifts with its plate, what they took off the
//! crust lets it rise, and what the plates raise meanwhile is handed on as a rate of uplift.
//!
//! Every step follows each cell of the map back to where its ground lay before. Ground keeps what was carved into it,
//! the plates' own smooth surface changes below it, and a load that was taken off comes back up by the ratio of the
//! densities of crust and mantle, spread over the width that the lithosphere's strength spreads it. New sea floor
//! begins bare.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    crust,
    grid::{Field, Grid, cubic, linear},
    world::{Layer, World},
};

use super::{
    domain::Domain,
    engine::Pose,
    exchange::cell_index,
    params::PlatesParams,
    simulation::Simulation,
    surface::{Plains, Surface, blurred},
    warp::Warp,
};

/// Width over which the strength of the lithosphere spreads the answer to a load, m: the standard deviation that comes
/// nearest to the flexure of a plate about 5 km thick.
const FLEXURE_M: f64 = 20e3;
/// What lies on the bedrock and what is told of the ground: both drift with it.
const CARRIED: [Layer; 4] = [Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit];

/// A map that the plates share with others.
pub struct Carved {
    /// Where each cell of the map reads the plates, east and south, m.
    reads_m: [Field<f32>; 2],
    /// Tectonic cells on the map that no cell of it reads, and where it shows them, m: most of them where it is coarser.
    unread: Vec<(usize, DVec2)>,
    /// The plates' surface when they moved last.
    surface: Surface,
    poses: Vec<Pose>,
    /// Height that the map would have now, had nobody carved it, m.
    expected: Field<f32>,
    /// What was worn off the tectonic cells before each step, m; with it a run can be replayed.
    worn: Vec<Field<f32>>,
}

/// Where a cell's ground lay before the step.
#[derive(Clone, Copy, Default)]
struct Origin {
    /// On the map, m.
    at_m: [f64; 2],
    /// What is added to its height, m.
    lift_m: f32,
    /// New sea floor: its height. It comes from nowhere.
    bare_m: Option<f32>,
}

impl Carved {
    /// The map as it is before the plates move, and its heights, m.
    pub fn begin(run: &Simulation, warp: &Warp, params: &PlatesParams, map: Grid, plains: &Plains) -> Self {
        let reads = Field::from_fn(map, |x, y| {
            let at = warp.read_at(map.center_m(x, y).into());
            [at.x as f32, at.y as f32]
        });
        let reads_m = [0, 1].map(|axis| reads.map(|at| at[axis]));
        let surface = Surface::of(run, params);
        let unread = unread(&reads_m, &run.domain, warp);
        let expected = Field::filled(map, 0.0);
        let mut carved = Self { reads_m, unread, poses: poses(run), expected, surface, worn: Vec::new() };
        carved.expected = Field::from_fn(map, |x, y| carved.new_ground(map, x, y, plains));
        carved
    }

    /// Height that the map would have, had nobody carved it since the last step, m.
    pub fn expected(&self) -> &Field<f32> {
        &self.expected
    }

    /// What the plates know besides the ground, read onto the map.
    pub fn read_crust(&self, border_m: f64) -> Vec<(Layer, Field<f32>)> {
        self.surface.read_crust(&self.reads_m, border_m)
    }

    /// What was worn off before each step so far.
    pub fn worn(&self) -> &[Field<f32>] {
        &self.worn
    }

    /// Takes up a saved run, replayed up to here.
    pub fn restore(&mut self, run: &Simulation, params: &PlatesParams, expected: Field<f32>, worn: Vec<Field<f32>>) {
        (self.surface, self.poses) = (Surface::of(run, params), poses(run));
        (self.expected, self.worn) = (expected, worn);
    }

    /// What others took off the tectonic cells since the last step (less than nothing where they laid down), m.
    pub fn read_wear(&mut self, world: &World, domain: &Domain) -> &Field<f32> {
        let mut off = world.height();
        for (height, expected) in off.data.iter_mut().zip(&self.expected.data) {
            *height = expected - *height;
        }
        let wear = self.on_plates(&off, domain);
        self.worn.push(wear);
        &self.worn[self.worn.len() - 1]
    }

    /// Lets the ground drift with its plates after they have moved: writes the column, what goes with it, and the rate at
    /// which it is being raised over `span_yr`.
    pub fn carry(&mut self, run: &Simulation, params: &PlatesParams, plains: &Plains, span_yr: f64, world: &mut World) {
        let now = Surface::of(run, params);
        let poses = poses(run);
        let rebound = self.rebound(world.sea_level_m);
        let born_myr = span_yr * 1e-6;
        let origins = Field::from_fn(world.grid, |x, y| {
            let at = self.reads_at(x, y);
            let q = now.at(at);
            let plate = now.plate_at(q) as usize;
            if now.is_newer(q, born_myr) {
                return Origin {
                    bare_m: Some(
                        (cubic(&now.height, q) + plains.height(world.grid.center_m(x, y), cubic(&now.height, q), 0.0))
                            as f32,
                    ),
                    ..Origin::default()
                };
            }
            let before = self.poses[plate].to_map(poses[plate].to_body(at));
            let q_before = self.surface.at(before);
            let lift = cubic(&now.height, q) - cubic(&self.surface.height, q_before) + linear(&rebound, q_before);
            Origin { at_m: self.shown_at(x, y, before - at), lift_m: lift as f32, bare_m: None }
        });
        (self.surface, self.poses) = (now, poses);
        self.write(&origins, span_yr, world);
    }

    fn write(&mut self, origins: &Field<Origin>, span_yr: f64, world: &mut World) {
        let grid = world.grid;
        let height = world.height();
        let read = |field: &Field<f32>, x, y, bare: f32| {
            let origin: Origin = origins.at(x, y);
            origin.bare_m.map_or_else(|| cubic(field, origin.at_m) as f32, |_| bare)
        };
        let mut bedrock = Field::from_fn(grid, |x, y| read(&height, x, y, origins.at(x, y).bare_m.unwrap_or(0.0)));
        let lift = |i: usize| if origins.data[i].bare_m.is_some() { 0.0 } else { origins.data[i].lift_m };
        crate::grid::map_cells(&mut self.expected.data, grid.width, |x, y| bedrock.at(x, y) + lift(grid.index(x, y)));
        let to_mm_per_yr = (1e3 / span_yr) as f32;
        world.set_layer(Layer::Uplift, Field::from_fn(grid, |x, y| lift(grid.index(x, y)) * to_mm_per_yr));
        for layer in CARRIED {
            let Some(field) = world.layer(layer) else { continue };
            // Cubic reading overshoots by a little; none of these can be less than nothing.
            let moved = Field::from_fn(grid, |x, y| read(field, x, y, 0.0).max(0.0));
            if Layer::COLUMN.contains(&layer) {
                bedrock.data.iter_mut().zip(&moved.data).for_each(|(rock, thickness)| *rock -= thickness);
            }
            world.set_layer(layer, moved);
        }
        world.set_layer(Layer::Bedrock, bedrock);
    }

    fn reads_at(&self, x: usize, y: usize) -> DVec2 {
        DVec2::new(self.reads_m[0].at(x, y) as f64, self.reads_m[1].at(x, y) as f64)
    }

    /// The point of the map that reads the plates `by` metres from where cell `(x, y)` does; Newton's method with the
    /// Jacobian at the cell, good to a small share of a cell for steps this short.
    fn shown_at(&self, x: usize, y: usize, by: DVec2) -> [f64; 2] {
        let grid = &self.reads_m[0].grid;
        let [east, south] = [0, 1].map(|k| DVec2::from(self.reads_m[k].gradient(x, y)));
        let determinant = east.perp_dot(south);
        let solve = |d: DVec2| DVec2::new(south.y * d.x - east.y * d.y, east.x * d.y - south.x * d.x) / determinant;
        let (here, wanted) = (DVec2::from(grid.center_m(x, y)), self.reads_at(x, y) + by);
        let extent = DVec2::from(grid.extent_m());
        let mut at = here + solve(by);
        for _ in 0..2 {
            if at.cmplt(DVec2::ZERO).any() || at.cmpgt(extent).any() {
                break;
            }
            let reads = DVec2::new(linear(&self.reads_m[0], at.into()), linear(&self.reads_m[1], at.into()));
            at += solve(wanted - reads);
        }
        at.into()
    }

    /// How far the crust comes back up where it was relieved before this step, m.
    fn rebound(&self, sea_m: f64) -> Field<f32> {
        let Some(wear) = self.worn.last() else { return Field::filled(self.surface.height.grid, 0.0) };
        let dry = (crust::CONTINENTAL / crust::MANTLE) as f32;
        let wet = ((crust::CONTINENTAL - crust::SEA_WATER) / (crust::MANTLE - crust::SEA_WATER)) as f32;
        let load = Field::from_fn(wear.grid, |x, y| {
            wear.at(x, y) * if (self.surface.height.at(x, y) as f64) < sea_m { wet } else { dry }
        });
        blurred(&load, FLEXURE_M)
    }

    /// Means over the tectonic cells of something on the map; where it reads none of a cell, what it shows there.
    fn on_plates(&self, field: &Field<f32>, domain: &Domain) -> Field<f32> {
        let mut sums = vec![(0.0f64, 0u32); domain.cells * domain.cells];
        for (i, &value) in field.data.iter().enumerate() {
            let (x, y) = field.grid.cell_of(i);
            if let Some(cell) = cell_index(domain, self.reads_at(x, y)) {
                let (sum, count) = &mut sums[cell];
                (*sum, *count) = (*sum + value as f64, *count + 1);
            }
        }
        let mut means = Field { grid: domain.grid(), data: Vec::new() };
        means.data = sums.iter().map(|&(sum, count)| (sum / f64::from(count.max(1))) as f32).collect();
        for &(cell, at_m) in &self.unread {
            means.data[cell] = linear(field, at_m.into()) as f32;
        }
        means
    }

    fn new_ground(&self, map: Grid, x: usize, y: usize, plains: &Plains) -> f32 {
        let q = self.surface.at(self.reads_at(x, y));
        let base = cubic(&self.surface.height, q);
        (base + plains.height(map.center_m(x, y), base, linear(&self.surface.kind, q))) as f32
    }
}

/// The tectonic cells on the map that no cell of it reads, and where it shows them.
fn unread(reads_m: &[Field<f32>; 2], domain: &Domain, warp: &Warp) -> Vec<(usize, DVec2)> {
    let mut read = vec![false; domain.cells * domain.cells];
    for (&x, &y) in reads_m[0].data.iter().zip(&reads_m[1].data) {
        if let Some(cell) = cell_index(domain, DVec2::new(x as f64, y as f64)) {
            read[cell] = true;
        }
    }
    let shown = |cell: usize| {
        let at_m = warp.shown_at(domain.cell_center_m(cell % domain.cells, cell / domain.cells));
        domain.on_map(at_m).then_some((cell, at_m))
    };
    (0..read.len()).into_par_iter().filter(|&cell| !read[cell]).filter_map(shown).collect()
}

fn poses(run: &Simulation) -> Vec<Pose> {
    run.plates.iter().map(|plate| plate.pose).collect()
}

impl Simulation {
    /// Takes off each plate what was worn off the tectonic cells that it owns, and books it; m.
    pub fn wear(&mut self, wear: &Field<f32>) {
        let area = self.domain.cell_m() * self.domain.cell_m();
        for (p, plate) in self.plates.iter_mut().enumerate() {
            for cell in (0..plate.owned.len()).filter(|&cell| plate.owned[cell]).collect::<Vec<_>>() {
                let under = cell_index(&self.domain, plate.center_m(cell));
                let Some(under) = under.filter(|&under| self.owners.top[under] as usize == p) else { continue };
                let old = plate.rock[cell].worn_m;
                plate.rock[cell].worn_m = old + wear.data[under];
                self.books.worn_m3 += (plate.rock[cell].worn_m as f64 - old as f64) * area;
            }
        }
    }
}
