//! The process: what it reads from the world, and what it writes and books.

use super::{
    RiversParams,
    bed::{self, Beds},
    course::Network,
    hollows::{Hollow, fill, hollows, least_fall_m, level, tilt_plains, under},
    tables,
    waters::{Climate, Waters},
    wetness,
};
use crate::{
    flow::{Drainage, outlets_but},
    grid::Field,
    noise::Fbm,
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, Matter, World},
};

/// Seconds of a Julian year.
const YEAR_S: f64 = 31_557_600.0;
/// Share of the map whose mean runoff is a river, where no discharge is given.
const RIVER_SHARE: f64 = 1.0 / 4000.0;
/// Share of the map that a hollow must cover to be a lake, where no area is given.
const LAKE_SHARE: f64 = 1e-4;
/// And how many cells at least.
const LAKE_CELLS: f64 = 4.0;
/// Size of the largest swells of a plain.
const PLAIN_KM: f64 = 30.0;
/// Height of its swells: it decides only where nothing else does.
const TILT_M: f64 = 1e-6;

impl RiversParams {
    /// The process.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Rivers { params: self, placement, dry: 0 })
    }
}

struct Rivers {
    params: RiversParams,
    placement: Placement,
    /// Hollows large enough for a lake that no water comes to.
    dry: usize,
}

impl Process for Rivers {
    fn reads(&self) -> &'static [Layer] {
        &[]
    }

    fn writes(&self) -> &'static [Layer] {
        &[
            Layer::Bedrock,
            Layer::Lava,
            Layer::Sediment,
            Layer::Wear,
            Layer::Deposit,
            Layer::Discharge,
            Layer::RiverWidth,
            Layer::RiverDepth,
            Layer::LakeDepth,
            Layer::Basin,
            Layer::StreamOrder,
            Layer::Wetness,
        ]
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let found = self.find(world, context)?;
        context.check()?;
        self.dry = found.waters.lakes.len() - found.waters.wet_lakes().count();
        self.write(found, mask.as_ref(), world, context);
        Ok(Step::WHOLE)
    }

    fn findings(&self) -> Vec<String> {
        let dry = (self.dry > 0).then(|| format!("no water comes to {} hollows, which are dry and no lakes", self.dry));
        dry.into_iter().collect()
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

/// All that is to be written.
struct Found {
    waters: Waters,
    beds: Beds,
    order: Vec<u8>,
    sea: Vec<bool>,
}

impl Rivers {
    fn find(&self, world: &World, context: &Context) -> Result<Found, ProcessError> {
        let (grid, sea_m, params) = (world.grid, world.sea_level_m, &self.params);
        let height = world.height();
        let sea: Vec<bool> = height.data.iter().map(|&h| (h as f64) <= sea_m).collect();
        let outlet = outlets_but(&height, sea_m, &world.inflow_gates());
        let mut z: Vec<f64> = height.data.iter().map(|&h| h as f64).collect();

        // Dry land is higher than the sea, be it by a hair.
        let shore_m = sea_m + least_fall_m(grid);
        z.iter_mut().zip(&sea).filter(|(_, sea)| !**sea).for_each(|(z, _)| *z = z.max(shore_m));
        let plains = Fbm::new(PLAIN_KM * 1e3, 0.5).octaves(context.key.named("plains"), grid.cell_m);
        tilt_plains(grid, &mut z, &outlet, |i| {
            let (x, y) = grid.cell_of(i);
            TILT_M * plains.value(grid.center_m(x, y))
        });
        let surface_m = Drainage::of(grid, &z, &outlet).surface_m;
        let mut lakes = hollows(grid, &z, &surface_m);
        let smallest = params
            .smallest_lake_km2
            .map_or((grid.cells() as f64 * LAKE_SHARE).max(LAKE_CELLS), |km2| km2 * 1e6 / grid.cell_area_m2());
        let worth = |lake: &Hollow| lake.cells.len() as f64 >= smallest && lake.depth_m >= params.shallowest_lake_m;
        lakes.retain(worth);
        // A ditch can drain a lake as well: what is left of it is judged again, until all that are left are lakes.
        let way = loop {
            context.check()?;
            level(grid, &mut z, &outlet, &lakes);
            let way = Drainage::of(grid, &z, &outlet);
            let mut left = hollows(grid, &z, &way.surface_m);
            let (found, before) = (left.len(), lakes.len());
            left.retain(worth);
            lakes = left;
            if lakes.len() == found {
                break way;
            }
            // Fewer at each turn, so that it ends; else what is no lake is filled.
            if lakes.len() >= before {
                fill(grid, &mut z, &under(&outlet, &lakes));
                break Drainage::of(grid, &z, &outlet);
            }
        };
        context.check()?;

        let climate = self.climate(world, &sea);
        let waters = Waters::of(way, &mut z, &outlet, &climate, worth);
        context.check()?;
        let order = waters.order(self.least_m3_s(&climate, &sea));
        let bankfull = |i: usize| waters.discharge_m3_s[i] * params.bankfull_ratio;
        let cut = |i: usize| {
            let river = order[i] > 0 && !sea[i];
            if river { params.carve * bed::depth_m(bankfull(i)) } else { 0.0 }
        };
        let beds = bed::cut(&waters, &z, sea_m, cut);
        Ok(Found { waters, beds, order, sea })
    }

    /// What each cell sheds: the layer `runoff`, or else `rain`, or else the parameter; and what other maps send in.
    fn climate(&self, world: &World, sea: &[bool]) -> Climate {
        let per_mm = 1e-3 * world.grid.cell_area_m2() / YEAR_S;
        let layer = world.layer(Layer::Runoff).or(world.layer(Layer::Rain));
        let mm = |i: usize| layer.map_or(self.params.rain_mm_per_yr, |field| (field.data[i] as f64).max(0.0));
        let mut runoff_m3_s: Vec<f64> = (0..sea.len()).map(|i| if sea[i] { 0.0 } else { mm(i) * per_mm }).collect();
        for inflow in world.inflows() {
            if !sea[inflow.cell] {
                runoff_m3_s[inflow.cell] += inflow.discharge_m3_s;
            }
        }
        Climate { runoff_m3_s, loss_m3_s: self.params.lake_loss_mm_per_yr * per_mm }
    }

    fn least_m3_s(&self, climate: &Climate, sea: &[bool]) -> f64 {
        self.params.least_discharge_m3_s.unwrap_or_else(|| {
            let land = sea.iter().filter(|&&sea| !sea).count().max(1);
            climate.runoff_m3_s.iter().sum::<f64>() / land as f64 * sea.len() as f64 * RIVER_SHARE
        })
    }

    fn write(&self, found: Found, mask: Option<&Field<f32>>, world: &mut World, context: &Context) {
        let Found { waters, mut beds, order, sea } = found;
        let grid = world.grid;
        let rivers = Network { waters: &waters, beds: &beds, sea_m: world.sea_level_m, order: &order }.rivers();
        let ratio = self.params.bankfull_ratio;
        let wet = |i: usize| sea[i] || waters.lake_of[i] > 0;
        let mut ground_m = beds.ground_m.clone();
        if bed::widen(grid, &mut ground_m, &rivers, [ratio, self.params.carve], wet) {
            let ends: Vec<bool> = (0..sea.len()).map(|i| wet(i) || waters.way.is_outlet(i)).collect();
            fill(grid, &mut ground_m, &ends);
            beds.ground_m = ground_m;
        }
        world.set_table(tables::rivers(&rivers, ratio));
        world.set_table(tables::lakes(&waters, grid, &beds.ground_m, &beds.surface_m));
        world.set_table(tables::outlines(&waters, grid, &beds.ground_m, &beds.surface_m));

        reshape(world, &beds.ground_m, mask, context.stage);
        let basin = waters.basins(|i| !sea[i]);
        let q = |i: usize| if sea[i] { 0.0 } else { waters.discharge_m3_s[i].max(0.0) };
        let river = |i: usize| order[i] > 0 && !sea[i] && waters.lake_of[i] == 0;
        let mut put = |layer: Layer, f: &(dyn Fn(usize) -> f64 + Sync)| {
            world.set_layer(layer, Field::from_fn(grid, |x, y| f(grid.index(x, y)) as f32));
        };
        put(Layer::Discharge, &q);
        put(Layer::RiverWidth, &|i| if river(i) { bed::width_m(q(i) * ratio) } else { 0.0 });
        put(Layer::RiverDepth, &|i| if river(i) { bed::depth_m(q(i) * ratio) } else { 0.0 });
        let lake = |i: usize| waters.lake_of[i] > 0;
        put(Layer::LakeDepth, &|i| if lake(i) { (beds.surface_m[i] - beds.ground_m[i]).max(0.0) } else { 0.0 });
        put(Layer::Basin, &|i| basin[i] as f64);
        put(Layer::StreamOrder, &|i| if river(i) { order[i] as f64 } else { 0.0 });
        let wetness = wetness::index(&waters.way);
        put(Layer::Wetness, &|i| if sea[i] { 0.0 } else { wetness[i] });
    }
}

/// Brings the ground to new heights where they differ, and books it: sediment is taken first, then lava, then bedrock;
/// what is filled is sediment.
fn reshape(world: &mut World, ground_m: &[f64], mask: Option<&Field<f32>>, stage: &str) {
    let height = world.height();
    let mut column = [Layer::Bedrock, Layer::Lava, Layer::Sediment].map(|layer| {
        let there = world.remove_layer(layer);
        (there.is_some() || layer != Layer::Lava).then(|| there.unwrap_or_else(|| Field::filled(world.grid, 0.0)))
    });
    let mut wear = world.remove_layer(Layer::Wear).unwrap_or_else(|| Field::filled(world.grid, 0.0));
    let mut deposit = world.remove_layer(Layer::Deposit).unwrap_or_else(|| Field::filled(world.grid, 0.0));
    let (mut came_m, mut left_m) = (0.0, 0.0);
    for (i, &wanted_m) in ground_m.iter().enumerate() {
        let old = height.data[i];
        let share = mask.map_or(1.0, |mask| mask.data[i] as f64);
        let new = (old as f64 + (wanted_m - old as f64) * share) as f32;
        if new == old {
            continue;
        }
        let mut gained = 0.0;
        if new > old {
            if let Some(sediment) = &mut column[2] {
                gained += change(&mut sediment.data[i], new - old);
            }
        } else {
            let mut wanted = old - new;
            for (k, field) in column.iter_mut().enumerate().rev() {
                let Some(field) = field else { continue };
                let take = if k == 0 { wanted } else { wanted.min(field.data[i]).max(0.0) };
                gained += change(&mut field.data[i], -take);
                wanted -= take;
            }
        }
        if gained > 0.0 {
            came_m += gained;
            deposit.data[i] += gained as f32;
        } else {
            left_m -= gained;
            wear.data[i] -= gained as f32;
        }
    }
    for (layer, field) in [Layer::Bedrock, Layer::Lava, Layer::Sediment].into_iter().zip(column) {
        if let Some(field) = field {
            world.set_layer(layer, field);
        }
    }
    world.set_layer(Layer::Wear, wear);
    world.set_layer(Layer::Deposit, deposit);
    let area_m2 = world.grid.cell_area_m2();
    world.ledger.book_in(stage, Matter::Rock, came_m * area_m2);
    world.ledger.book_out(stage, Matter::Rock, left_m * area_m2);
}

/// Adds to a value; what was really added, m.
fn change(value: &mut f32, by: f32) -> f64 {
    let old = *value;
    *value += by;
    *value as f64 - old as f64
}
