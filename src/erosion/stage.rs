//! A family of erosion as a stage of a recipe: reads the column of rock and what stands on it into a bed, lets the family
//! work on it step by step, and writes the column, the books and what the family shows after each.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    bed::{Bed, Family, Moved, Part, Saved},
    column::{Change, Column, Ground},
    weathering::pace,
};
use crate::{
    bake::Subject,
    grid::{Field, Grid, for_each_row, sum_f64, sum_rows},
    noise::Key,
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Clocks, Layer, Matter, World},
};

/// What a stage leaves where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Lock {
    /// Nothing.
    #[default]
    None,
    /// Land stays land, and sea sea.
    Coast,
}

/// Seconds in a day.
const DAY_S: f64 = 86_400.0;

/// How far from the sea's level heights stay at least where coasts are locked, m.
const LEAST_MARGIN_M: f64 = 1e-4;

/// The parameters of a family, and how its solver is made of them.
pub trait FamilyParams: Send + Sync + 'static {
    /// What works on the bed.
    type Solver: Family;

    /// Layers it may change or make.
    const WRITES: &'static [Layer];

    /// Layers of the greatest value so far: begun anew.
    const PEAKS: &'static [Layer] = &[];

    /// Whether water stands on the ground while it works, and is booked.
    const WATER: bool;

    /// Steps that a stage is divided into where the recipe does not say.
    const STEPS: u64;

    /// What stays where it is.
    fn lock(&self) -> Lock;

    /// Whether its rates go with the pace of weathering, where a climate is known. They are then shares of what the fastest
    /// cell has, by which the solver has to multiply.
    fn weathers(&self) -> bool {
        false
    }

    /// What passes on the clock of the land, years.
    fn duration_yr(&self) -> f64;

    /// How long its water runs, and how many times that the bed's clock goes on by.
    fn clocks(&self) -> Option<Clocks> {
        None
    }

    /// What does not go together, in one line with what helps.
    fn check(&self, _grid: &Grid) -> Result<(), String> {
        Ok(())
    }

    /// What does not go together with the world as the stage finds it, in one line with what helps.
    fn meets(&self, _world: &World) -> Result<(), String> {
        Ok(())
    }

    /// What a person should know of it before it runs, a line each.
    fn remarks(&self, _grid: &Grid) -> Vec<String> {
        Vec::new()
    }

    /// What it has to be recorded, if it moves particles.
    fn subject(&self, _grid: &Grid) -> Option<Subject> {
        None
    }

    /// The solver.
    fn solver(&self, bed: &Bed, world: &World, key: Key) -> Result<Self::Solver, ProcessError>;

    /// Writes the layers that it shows besides the ground.
    fn show(&self, _solver: &Self::Solver, _bed: &Bed, _world: &mut World) {}
}

/// What to say where cells are not of the size that a stage is made for, m.
pub(super) fn cell_size(grid: &Grid, least_m: f64, most_m: f64) -> Option<String> {
    let cell_m = grid.cell_m;
    let fits = (least_m..=most_m).contains(&cell_m);
    (!fits).then(|| {
        format!(
            "it is made for cells of {least_m} to {most_m} m; these are {} m wide, so take it as a picture",
            rounded(cell_m)
        )
    })
}

/// How the clocks of water and land go.
pub(super) fn in_words(clocks: Clocks) -> String {
    let Clocks { water_s, morphological_factor } = clocks;
    let (water, bed) = (span(water_s / DAY_S), span(water_s / DAY_S * morphological_factor));
    format!("{water} of water stand for {bed} of land (morphological_factor = {morphological_factor})")
}

/// A span of time in the unit that suits it.
fn span(days: f64) -> String {
    const UNITS: [(f64, &str); 4] =
        [(365.25, "years"), (1.0, "days"), (1.0 / 24.0, "hours"), (1.0 / 1440.0, "minutes")];
    let (size, unit) = UNITS.into_iter().find(|&(size, _)| days >= size).unwrap_or((1.0 / 86_400.0, "seconds"));
    format!("{} {unit}", rounded(days / size))
}

/// A number to three digits, without a tail of zeros.
fn rounded(value: f64) -> String {
    let digits = (2 - libm::floor(libm::log10(value.abs().max(1e-3))) as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A family at work.
pub(super) struct Stage<T: FamilyParams> {
    params: T,
    placement: Placement,
    steps: u64,
    done: u64,
    run: Option<Run<T::Solver>>,
    saved: Option<State>,
}

struct Run<S> {
    bed: Bed,
    solver: S,
    column: Column,
}

impl<T: FamilyParams> Stage<T> {
    /// Ready for its first step; `steps` asks for that many.
    pub(super) fn new(params: T, placement: Placement, steps: Option<u64>) -> Self {
        Self { params, placement, steps: steps.unwrap_or(T::STEPS).max(1), done: 0, run: None, saved: None }
    }

    /// The bed as the stage finds it.
    fn begin(&self, world: &mut World, context: &Context) -> Result<Run<T::Solver>, ProcessError> {
        self.params.meets(world).map_err(ProcessError::Unfit)?;
        let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let bed = self.bed(world, mask);
        let solver = self.params.solver(&bed, world, context.key)?;
        if let Some(clocks) = self.params.clocks() {
            world.ledger.set_clocks(context.stage, clocks);
        }
        let found_m3 = water_m3(world);
        for &layer in T::PEAKS {
            world.remove_layer(layer);
        }
        if T::WATER {
            // What the family has no place for, such as puddles in the sea, is gone before it begins.
            world.ledger.open(context.stage, Matter::Water, found_m3);
            self.params.show(&solver, &bed, world);
            let gone_m3 = found_m3 - water_m3(world);
            world.ledger.book_out(context.stage, Matter::Water, gone_m3);
        }
        Ok(Run { column: Column::new(world.grid), bed, solver })
    }

    /// The ground of a world under a mask, its heights above the middle of the range so that single precision serves it
    /// best.
    fn bed(&self, world: &World, mask: Option<Field<f32>>) -> Bed {
        let height = world.height();
        let (low, high) = height.range().unwrap_or((0.0, 0.0));
        // A whole number of metres, so that taking it away is exact for all but the highest ground.
        let datum = (0.5 * (f64::from(low) + f64::from(high))).round();
        let mask = mask.map(|mask| mask.data);
        Bed {
            grid: world.grid,
            start: height.data.iter().map(|&z| (f64::from(z) - datum) as f32).collect(),
            change: vec![0.0; height.data.len()],
            rate: self.rates(world, mask.as_deref()),
            mask: mask.unwrap_or_default(),
            sea_m: (world.sea_level_m - datum) as f32,
            locked: self.params.lock() == Lock::Coast,
            margin_m: margin_m(world, datum),
        }
    }

    /// Share of every rate by mask, hardness and weather; empty where there is none of them.
    fn rates(&self, world: &World, mask: Option<&[f32]>) -> Vec<f32> {
        let soft = world.layer(Layer::Hardness).map(|hardness| hardness.map(|h| (1.0 - h).clamp(0.0, 1.0)).data);
        let pace = self.params.weathers().then(|| pace(world)).flatten().map(|pace| pace.share);
        let shares = [mask.map(<[f32]>::to_vec), soft, pace].into_iter().flatten();
        let both = |a: Vec<f32>, b: Vec<f32>| a.iter().zip(&b).map(|(a, b)| a * b).collect();
        shares.reduce(both).unwrap_or_default()
    }

    /// A run from its saved state.
    fn resume(&self, state: &State, world: &World, context: &Context) -> Option<Run<T::Solver>> {
        let cells = world.grid.cells();
        let field = |name: &str| {
            let found = state.fields.iter().find(|(saved, _)| saved == name);
            found.map(|(_, field)| field.data.clone()).filter(|data| data.len() == cells)
        };
        let blob = state.blob.get(8..)?;
        let bed = Bed {
            grid: world.grid,
            start: field("start")?,
            change: field("change")?,
            rate: field("rate").unwrap_or_default(),
            mask: field("mask").unwrap_or_default(),
            sea_m: f32::from_le_bytes(blob.get(..4)?.try_into().ok()?),
            locked: self.params.lock() == Lock::Coast,
            margin_m: f32::from_le_bytes(blob.get(4..8)?.try_into().ok()?),
        };
        let mut solver = self.params.solver(&bed, world, context.key).ok()?;
        solver.restore(&|name| field(&own(name)), blob.get(8..)?)?;
        let column = Column::restored(Field { grid: world.grid, data: field("rest")? });
        Some(Run { bed, solver, column })
    }

    /// Writes what has happened since `before` into the world.
    fn write(
        &self,
        run: &mut Run<T::Solver>,
        world: &mut World,
        (before, carried_m3): (&[f32], f64),
        moved: &Moved,
        stage: &str,
    ) {
        // What is on its way has left the ground.
        let left_m3 = moved.rock_left_m3 + run.solver.carried_m3() - carried_m3;
        let ground = Ground::Changes([before, &run.bed.change]);
        run.column.write(world, &Change { ground, lifted_m3: 0.0, left_m3 }, stage);
        // What came from one place and lies in another was moved: it left, and came in again.
        let laid_m3 = laid_m(&world.grid, before, &run.bed.change) * world.grid.cell_area_m2();
        world.ledger.book_in(stage, Matter::Rock, laid_m3);
        world.ledger.book_out(stage, Matter::Rock, laid_m3);
        self.params.show(&run.solver, &run.bed, world);
        if T::WATER {
            world.ledger.book_in(stage, Matter::Water, moved.water_in_m3);
            world.ledger.book_out(stage, Matter::Water, moved.water_left_m3);
            let stands_m3 = water_m3(world);
            world.ledger.close(stage, Matter::Water, stands_m3);
        }
    }
}

/// What a family's field is saved as: apart from the stage's own.
fn own(name: &str) -> String {
    format!("family_{name}")
}

/// How far a height may be from the world's after it was moved to a datum and parted into layers, m: each of the three
/// layers, their sum, the bed and its sea round by half a step of single precision at most.
fn margin_m(world: &World, datum: f64) -> f32 {
    let parts = Layer::COLUMN.iter().filter_map(|&layer| world.layer(layer)).filter_map(Field::range);
    let largest = parts.fold(world.sea_level_m.abs() + datum.abs(), |most, (low, high)| {
        most.max(f64::from(low.abs())).max(f64::from(high.abs()))
    });
    (4.0 * f64::from(f32::EPSILON) * largest).max(LEAST_MARGIN_M) as f32
}

/// What was laid down between two states of a change, m summed over the cells.
fn laid_m(grid: &Grid, before: &[f32], after: &[f32]) -> f64 {
    sum_rows(grid.height, |y| {
        let [was, now] = [before, after].map(|all| &all[y * grid.width..][..grid.width]);
        now.iter().zip(was).map(|(&now, &was)| (f64::from(now) - f64::from(was)).max(0.0)).sum()
    })
}

/// Raises a layer to these values wherever they are greater.
pub(super) fn peak(world: &mut World, layer: Layer, values: &[f32]) {
    let width = world.grid.width;
    for_each_row(&mut world.layer_mut(layer).data, width, |y, row| {
        for (most, &now) in row.iter_mut().zip(&values[y * width..]) {
            *most = most.max(now);
        }
    });
}

/// Water that stands on the land, m³.
fn water_m3(world: &World) -> f64 {
    world.layer(Layer::Water).map_or(0.0, |water| sum_f64(&water.data)) * world.grid.cell_area_m2()
}

impl<T: FamilyParams> Process for Stage<T> {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        T::WRITES
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.params.check(grid).map_err(ProcessError::Unfit)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        self.params.remarks(grid)
    }

    fn subject(&self, grid: &Grid) -> Option<Subject> {
        self.params.subject(grid)
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mut run = match (self.run.take(), &self.saved) {
            (Some(run), _) => run,
            (None, Some(state)) => self
                .resume(state, world, context)
                .ok_or_else(|| ProcessError::Failed("the saved state of this stage is broken".to_owned()))?,
            (None, None) => self.begin(world, context)?,
        };
        self.saved = None;
        let part = Part { step: self.done, steps: self.steps };
        let (before, carried_m3) = (run.bed.change.clone(), run.solver.carried_m3());
        let moved = run.solver.advance_on(&mut run.bed, part, context.tape());
        let mut moved = moved.map_err(ProcessError::Failed)?;
        if part.step + 1 >= part.steps {
            moved += run.solver.settle(&mut run.bed);
        }
        self.write(&mut run, world, (&before, carried_m3), &moved, context.stage);
        self.run = Some(run);
        self.done += 1;
        let [from, to] = part.of(self.params.duration_yr());
        Ok(Step { done: self.done as f64 / self.steps as f64, elapsed_yr: to - from })
    }

    fn save(&self) -> State {
        let Some(run) = &self.run else {
            return self
                .saved
                .clone()
                .unwrap_or_else(|| State { fields: Vec::new(), blob: self.done.to_le_bytes().to_vec() });
        };
        let Saved { fields, blob } = run.solver.save();
        let grid = run.bed.grid;
        let lay = |name: &str, data: &[f32]| (name.to_owned(), Field { grid, data: data.to_vec() });
        let mut all = vec![
            lay("start", &run.bed.start),
            lay("change", &run.bed.change),
            ("rest".to_owned(), run.column.rest().clone()),
        ];
        for (name, shares) in [("rate", &run.bed.rate), ("mask", &run.bed.mask)] {
            if !shares.is_empty() {
                all.push(lay(name, shares));
            }
        }
        all.extend(fields.into_iter().map(|(name, data)| (own(name), Field { grid, data })));
        let [sea, margin] = [run.bed.sea_m, run.bed.margin_m].map(f32::to_le_bytes);
        let blob = [&self.done.to_le_bytes()[..], &sea, &margin, &blob].concat();
        State { fields: all, blob }
    }

    fn restore(&mut self, state: State, _context: &Context) -> Result<(), ProcessError> {
        let done = state.blob.get(..8).and_then(|bytes| bytes.try_into().ok()).map(u64::from_le_bytes);
        self.done = done.ok_or_else(|| ProcessError::Failed("the saved state of this stage is broken".to_owned()))?;
        self.saved = (!state.fields.is_empty()).then_some(state);
        Ok(())
    }
}
