//! Ground that other stages carve while the plates move. What they carved drifts with its plate, what they took off the
//! crust lets it rise, and what the plates raise meanwhile is handed on as a rate of uplift.
//!
//! Every step follows each cell of the map back to where its ground lay before. Ground keeps what was carved into it,
//! the plates' own smooth surface changes below it, and a load that was taken off comes back up by the ratio of the
//! densities of crust and mantle, spread over the width that the lithosphere's strength spreads it. New sea floor
//! begins bare; land that comes in over the rim stands as high as the land it joins, but nobody has carved it yet.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    grid::{Corners, Field, Grid, Stencil, blur, cubic, linear},
    world::{Layer, World},
};

use super::{
    domain::Domain,
    engine::Pose,
    exchange::cell_index,
    params::PlatesParams,
    raise,
    simulation::Simulation,
    surface::{Plains, Surface},
    warp::{Reader, Warp},
    window::Window,
};

/// Width over which the strength of the lithosphere spreads the answer to a load, m: the standard deviation that comes
/// nearest to the flexure of a plate about 5 km thick.
const FLEXURE_M: f64 = 20e3;
/// How far ground may stand beyond the band between the plates' own surface and the sea, m. Rivers and the sea's sediment
/// bring the one towards the other; what would end further out was carved or filled where another border was, such as
/// the fill of a trench that a collision has closed, and has gone down or slid off with it.
const BEYOND_M: f64 = 1_500.0;
/// Less than this, m, is nothing: none of what is carried can be less, and numbers that fade out are slow to count with.
const LEAST_M: f32 = 1e-6;
/// No tectonic cell.
const OUTSIDE: u32 = u32::MAX;
/// What lies on the bedrock and what is told of the ground: both drift with it.
const CARRIED: [Layer; 4] = [Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit];

/// A map that the plates share with others.
pub struct Carved {
    /// Where each cell of the map reads the plates, east and south, m.
    reads_m: [Field<f32>; 2],
    /// The tectonic cell that each cell of the map reads, [`OUTSIDE`] where there is none.
    under: Vec<u32>,
    /// Tectonic cells on the map that no cell of it reads, and where it shows them, m: most of them where it is coarser.
    unread: Vec<(usize, DVec2)>,
    /// The plates' surface when they moved last.
    surface: Surface,
    /// Its height as the map reads it, m.
    shown_m: Field<f32>,
    poses: Vec<Pose>,
    /// Height that the map would have now, had nobody carved it, m.
    expected: Field<f32>,
    /// What was worn off the tectonic cells before each step, m; with it a run can be replayed.
    worn: Vec<Field<f32>>,
}

/// A cell's ground after the plates have moved below it.
#[derive(Clone, Copy, Default)]
struct Ground {
    /// Height before it is raised, m.
    height_m: f32,
    /// What the plates raise it by in the step, m.
    lift_m: f32,
    /// What it brought with it, in the order of [`CARRIED`].
    carried: [f32; CARRIED.len()],
}

/// Where the plates were before a step, and where they are.
struct Motion<'a> {
    domain: &'a Domain,
    now: &'a Surface,
    /// Of each plate, from where it is to where it was.
    back: Vec<Back>,
    kept: &'a Field<f32>,
    span_myr: f64,
}

/// A rigid motion: a turn, then a shift, m.
struct Back {
    turn: DVec2,
    by_m: DVec2,
}

impl Back {
    /// From a pose to the one before it.
    fn between(now: &Pose, before: &Pose) -> Self {
        let turn = before.turn.rotate(DVec2::new(now.turn.x, -now.turn.y));
        Self { turn, by_m: before.at_m - turn.rotate(now.at_m) }
    }

    #[inline]
    fn apply(&self, at_m: DVec2) -> DVec2 {
        self.turn.rotate(at_m) + self.by_m
    }
}

impl Carved {
    /// The map as it is before the plates move, and its heights, m.
    pub fn begin(
        run: &Simulation,
        (warp, window): (&Warp, Window),
        params: &PlatesParams,
        map: Grid,
        plains: &Plains,
    ) -> Self {
        let reads = Field::from_fn(map, |x, y| {
            let at = warp.read_at(map.center_m(x, y).into());
            [at.x as f32, at.y as f32]
        });
        let reads_m = [0, 1].map(|axis| reads.map(|at| at[axis]));
        let surface = Surface::of(run, params, window);
        let under = under(&reads_m, &run.domain);
        let unread = unread(&under, &run.domain, warp);
        let expected = Field::filled(map, 0.0);
        let mut carved = Self {
            shown_m: surface.shown(&reads_m),
            reads_m,
            under,
            unread,
            poses: poses(run),
            expected,
            surface,
            worn: Vec::new(),
        };
        carved.expected =
            Field::from_fn(map, |x, y| bare(&carved.surface, carved.reads_at(x, y), map.center_m(x, y), plains));
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
        (self.surface, self.poses) = (Surface::of(run, params, self.surface.window), poses(run));
        self.shown_m = self.surface.shown(&self.reads_m);
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
        let (now, poses) = (Surface::of(run, params, self.surface.window), poses(run));
        let sea_m = world.sea_level_m;
        let kept = self.relief_kept(&run.domain);
        let back = poses.iter().zip(&self.poses).map(|(now, before)| Back::between(now, before)).collect();
        let motion = Motion { domain: &run.domain, now: &now, back, kept: &kept, span_myr: span_yr * 1e-6 };
        let (height, shown_m) = (world.height(), now.shown(&self.reads_m));
        let carried = CARRIED.map(|layer| world.layer(layer));
        let carved = self.carved_on_the_whole(&height, &run.domain);
        let extent_m = world.grid.extent_m();
        let beyond = |at_m: [f64; 2]| (0..2).any(|k| at_m[k] < 0.0 || at_m[k] > extent_m[k]);
        let ground = Field::from_fn(world.grid, |x, y| match self.origin(x, y, &motion) {
            Some((from_m, _)) if beyond(from_m) => {
                let rim = Corners::at(&world.grid, [0, 1].map(|k| from_m[k].clamp(0.0, extent_m[k])));
                let reads = DVec2::new(rim.read(&self.reads_m[0]), rim.read(&self.reads_m[1]));
                let height_m = bare(&now, self.reads_at(x, y), world.grid.center_m(x, y), plains);
                let carved_m = linear(&carved, run.domain.in_square(reads)) as f32;
                Ground { height_m: height_m + carved_m, ..Ground::default() }
            }
            Some((from_m, kept_m)) => {
                let from = Stencil::at(&height.grid, from_m);
                let (height_m, own_m) = (from.read(&height), f64::from(shown_m.at(x, y)));
                let raised_m = height_m + own_m - from.read(&self.shown_m) + kept_m;
                let held_m = raised_m.clamp(own_m.min(sea_m) - BEYOND_M, own_m.max(sea_m) + BEYOND_M);
                // Cubic reading overshoots by a little, and spreads what is next to nothing.
                let part = |field: &Field<f32>| Some(from.read_f32(field)).filter(|&v| v > LEAST_M).unwrap_or(0.0);
                let carried = carried.map(|field| field.map_or(0.0, part));
                Ground { height_m: height_m as f32, lift_m: (held_m - height_m) as f32, carried }
            }
            None => {
                let height_m = bare(&now, self.reads_at(x, y), world.grid.center_m(x, y), plains);
                Ground { height_m, ..Ground::default() }
            }
        });
        (self.surface, self.poses, self.shown_m) = (now, poses, shown_m);
        self.write(&ground, span_yr, world);
    }

    /// How much higher the ground is than the plates' own surface, without its valleys, on the tectonic cells, m.
    fn carved_on_the_whole(&self, height: &Field<f32>, domain: &Domain) -> Field<f32> {
        let over = Field::from_fn(height.grid, |x, y| height.at(x, y) - self.shown_m.at(x, y));
        blur(&self.on_plates(&over, domain), FLEXURE_M / domain.cell_m())
    }

    /// Where a cell's ground lay before, on the map, m, and what it keeps of what was worn off, m; new sea floor comes from
    /// nowhere.
    fn origin(&self, x: usize, y: usize, motion: &Motion) -> Option<([f64; 2], f64)> {
        let at = self.reads_at(x, y);
        let here = Corners::at(&motion.now.height.grid, motion.now.at(at));
        if motion.now.is_newer(&here, motion.span_myr) {
            return None;
        }
        let before = motion.back[motion.now.plate_at(&here) as usize].apply(at);
        let kept_m = linear(motion.kept, motion.domain.in_square(before));
        Some((self.shown_at(x, y, before - at), kept_m))
    }

    fn write(&mut self, ground: &Field<Ground>, span_yr: f64, world: &mut World) {
        let to_mm_per_yr = (1e3 / span_yr) as f32;
        self.expected = ground.map(|g| g.height_m + g.lift_m);
        world.set_layer(Layer::Uplift, ground.map(|g| g.lift_m * to_mm_per_yr));
        let mut below = [false; CARRIED.len()];
        for (k, layer) in CARRIED.into_iter().enumerate() {
            if world.layer(layer).is_none() {
                continue;
            }
            below[k] = Layer::COLUMN.contains(&layer);
            world.set_layer(layer, ground.map(|g| g.carried[k]));
        }
        // What lies on it makes up the rest of the height.
        let cover =
            |g: &Ground| g.carried.iter().zip(below).map(|(v, counts)| if counts { *v } else { 0.0 }).sum::<f32>();
        world.set_layer(Layer::Bedrock, ground.map(|g| g.height_m - cover(&g)));
    }

    fn reads_at(&self, x: usize, y: usize) -> DVec2 {
        DVec2::new(self.reads_m[0].at(x, y) as f64, self.reads_m[1].at(x, y) as f64)
    }

    /// The point of the map that reads the plates `by` metres from where cell `(x, y)` does: Newton's method with the
    /// Jacobian at the cell, two steps of it, good to a small share of a cell for motions this short.
    fn shown_at(&self, x: usize, y: usize, by: DVec2) -> [f64; 2] {
        let grid = &self.reads_m[0].grid;
        let [east, south] = [0, 1].map(|k| DVec2::from(self.reads_m[k].gradient(x, y)));
        let per = 1.0 / east.perp_dot(south);
        let solve = |d: DVec2| DVec2::new(south.y * d.x - east.y * d.y, east.x * d.y - south.x * d.x) * per;
        let (here, wanted) = (DVec2::from(grid.center_m(x, y)), self.reads_at(x, y) + by);
        let extent = DVec2::from(grid.extent_m());
        let mut at = here + solve(by);
        if at.cmpge(DVec2::ZERO).all() && at.cmple(extent).all() {
            let corners = Corners::at(grid, at.into());
            at += solve(wanted - DVec2::new(corners.read(&self.reads_m[0]), corners.read(&self.reads_m[1])));
        }
        at.into()
    }

    /// What the ground keeps of what was worn off before this step, m: the plates' own surface has sunk with the thinner
    /// crust, so that the two together leave the answer of isostasy, spread over the width of the lithosphere's strength.
    fn relief_kept(&self, domain: &Domain) -> Field<f32> {
        match self.worn.last() {
            Some(wear) => blur(wear, FLEXURE_M / wear.grid.cell_m),
            None => Field::filled(domain.grid(), 0.0),
        }
    }

    /// Means over the tectonic cells of something on the map; where it reads none of a cell, what it shows there.
    fn on_plates(&self, field: &Field<f32>, domain: &Domain) -> Field<f32> {
        let mut sums = vec![(0.0f64, 0u32); domain.cells * domain.cells];
        for (&value, &cell) in field.data.iter().zip(&self.under) {
            if let Some((sum, count)) = sums.get_mut(cell as usize) {
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
}

/// Height of ground that nobody has carved, m.
fn bare(surface: &Surface, reads_m: DVec2, at_m: [f64; 2], plains: &Plains) -> f32 {
    let q = surface.at(reads_m);
    let base = cubic(&surface.height, q);
    (base + plains.height(at_m, base, linear(&surface.kind, q))) as f32
}

/// The tectonic cell that each cell of the map reads.
fn under(reads_m: &[Field<f32>; 2], domain: &Domain) -> Vec<u32> {
    let cell = |(&x, &y): (&f32, &f32)| cell_index(domain, DVec2::new(x as f64, y as f64));
    let cells = reads_m[0].data.par_iter().zip(&reads_m[1].data).map(cell);
    cells.map(|cell| cell.map_or(OUTSIDE, |cell| cell as u32)).collect()
}

/// The tectonic cells on the map that no cell of it reads, and where it shows them.
fn unread(under: &[u32], domain: &Domain, warp: &Warp) -> Vec<(usize, DVec2)> {
    let mut read = vec![false; domain.cells * domain.cells];
    for &cell in under.iter().filter(|&&cell| cell != OUTSIDE) {
        read[cell as usize] = true;
    }
    let [low, high] = warp.reads_m();
    let shown = |reader: &mut Reader, cell: usize| {
        let center_m = domain.cell_center_m(cell % domain.cells, cell / domain.cells);
        if center_m.cmplt(low).any() || center_m.cmpgt(high).any() {
            return None;
        }
        let at_m = reader.shown_at(center_m);
        domain.on_map(at_m).then_some((cell, at_m))
    };
    let row = |y: usize| {
        let mut reader = warp.reader();
        let cells = (y * domain.cells..(y + 1) * domain.cells).filter(|&cell| !read[cell]);
        cells.filter_map(|cell| shown(&mut reader, cell)).collect::<Vec<_>>()
    };
    (0..domain.cells).into_par_iter().flat_map_iter(row).collect()
}

fn poses(run: &Simulation) -> Vec<Pose> {
    run.plates.iter().map(|plate| plate.pose).collect()
}

impl Simulation {
    /// Takes off each plate what was worn off the tectonic cells that it owns, and books it; m.
    pub fn wear(&mut self, wear: &Field<f32>) {
        let area = self.domain.cell_m() * self.domain.cell_m();
        for (p, plate) in self.plates.iter_mut().enumerate() {
            let ([xs, ys], width) = (plate.span(), plate.frame.width);
            for (x, y) in ys.flat_map(|y| xs.clone().map(move |x| (x, y))) {
                let cell = y * width + x;
                if !plate.owned[cell] {
                    continue;
                }
                let under = cell_index(&self.domain, plate.pose.to_map(plate.frame.middle_m(x, y)));
                let Some(under) = under.filter(|&under| self.owners.top[under] as usize == p) else { continue };
                let rock = &mut plate.rock[cell];
                let (old, most) = (rock.worn_m, rock.crust_m + rock.added_m - raise::THINNEST_M);
                rock.worn_m = (old + wear.data[under]).min(most.max(old));
                self.books.worn_m3 += (rock.worn_m as f64 - old as f64) * area;
            }
        }
    }
}
