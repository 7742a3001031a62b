//! The sheet as a stage of a recipe: reads the ground, lets lava run for a share of its time, writes what froze into the
//! column of rock and what flows into its layer, and books both.

use super::{cells::Sheet, emission::sources, law::Law, params::LavaSheetParams};
use crate::{
    grid::{Field, Grid},
    process::{Context, Placement, Process, ProcessError, State, Step},
    volcano::{
        over_rim,
        schedule::{HOUR_S, Schedule},
    },
    world::{Layer, Matter, Plume, World},
};

/// Steps of a stage where the recipe does not say.
const STEPS: u64 = 48;
/// Hours of a Julian year.
const YEAR_H: f64 = 8766.0;
/// Lava that lies so thick has its own hardness; m.
const COVER_M: f64 = 1.0;
/// Sizes of cells it is made for, m.
const CELLS_M: [f64; 2] = [1.0, 500.0];

/// Lava of a cell of the map between two steps: depth, m, and heat, m·J/kg.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Melt {
    cell: u32,
    depth: f64,
    heat: f64,
}

/// An eruption at work.
struct Stage {
    params: LavaSheetParams,
    placement: Placement,
    steps: u64,
    done: u64,
    run: Option<Run>,
}

#[derive(Clone, Debug)]
struct Run {
    /// Cells that lava comes out of, and their shares.
    sources: Vec<(usize, f64)>,
    /// Smoke that the world is to hear of with the first step that is whole.
    smoke: Vec<Plume>,
    melt: Vec<Melt>,
    /// What the layers of the column could not hold yet, m.
    rest: Field<f32>,
    /// Lava that left over the rim so far, m³.
    over_rim_m3: f64,
}

impl LavaSheetParams {
    /// The stage, in `steps` steps if given.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage { params: self, placement, steps: steps.unwrap_or(STEPS).max(1), done: 0, run: None })
    }
}

impl Stage {
    fn begin(&self, world: &mut World, context: &Context) -> Result<Run, ProcessError> {
        let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let sources = sources(&self.params, world, mask.as_ref()).map_err(ProcessError::Unfit)?;
        let smoke = self.params.plumes(world, mask.as_ref(), context.key)?;
        world.ledger.open(context.stage, Matter::Lava, 0.0);
        Ok(Run { sources, smoke, melt: Vec::new(), rest: Field::filled(world.grid, 0.0), over_rim_m3: 0.0 })
    }

    /// The seconds between which a step runs.
    fn span_s(&self) -> [f64; 2] {
        let at = |step: u64| self.params.duration_h * HOUR_S * (step as f64 / self.steps as f64);
        [at(self.done), at(self.done + 1)]
    }

    /// Lava on the ground as it is, run from one moment to another.
    fn flow(&self, run: &Run, world: &World, context: &Context) -> Result<Sheet, ProcessError> {
        let law = Law::new(&self.params);
        let parts: Vec<&Field<f32>> = Layer::COLUMN.iter().filter_map(|&layer| world.layer(layer)).collect();
        let ground = |x: usize, y: usize| {
            parts.iter().fold(f64::from(run.rest.at(x, y)), |sum, part| sum + f64::from(part.at(x, y)))
        };
        let grid = world.grid;
        let mut sheet = Sheet::new(&grid, ground, world.sea_level_m);
        let fed = run.sources.iter().map(|&(i, _)| (sheet.cell(&grid, i), 0.0, 0.0));
        let molten = run.melt.iter().map(|melt| (sheet.cell(&grid, melt.cell as usize), melt.depth, melt.heat));
        let all: Vec<(usize, f64, f64)> = molten.chain(fed).collect();
        sheet.put(&all);
        let schedule = Schedule::of_sheet(&self.params.schedule).map_err(ProcessError::Unfit)?;
        let [mut now, end] = self.span_s();
        while now < end {
            context.check()?;
            let change = schedule.next_change(now).map_or(end, |change| change.min(end));
            let rise = schedule.rate_m3_per_s(now) / grid.cell_area_m2();
            let source: Vec<(usize, f64)> =
                run.sources.iter().map(|&(i, share)| (sheet.cell(&grid, i), rise * share)).collect();
            let left = change - now;
            let took = sheet.advance(&law, &source, left);
            // A step too short for the clock to see ends the span.
            now = if took >= left || now + took <= now { change } else { now + took };
        }
        Ok(sheet)
    }

    /// Writes what a step did into the world and its books.
    fn write(&self, run: &mut Run, sheet: &Sheet, world: &mut World, context: &Context) {
        let law = Law::new(&self.params);
        let over = self.done + 1 >= self.steps;
        let grid = world.grid;
        let area = grid.cell_area_m2();
        let [mut depth, mut warm] = [0; 2].map(|_| Field::filled(grid, 0.0f32));
        let mut melt = Vec::new();
        let mut settled = 0.0;
        let mut cells = Vec::new();
        for (i, k) in (0..grid.cells()).map(|i| (i, sheet.cell(&grid, i))) {
            let (molten, heat) = (sheet.molten[k], sheet.heat[k]);
            let mut fresh = Fresh { cell: i, frozen: sheet.frozen[k], degc: self.params.solidus_degc };
            if molten > 0.0 && over {
                let whole = fresh.frozen + molten;
                fresh.degc = (fresh.degc * fresh.frozen + law.melt.degc(heat / molten) * molten) / whole;
                fresh.frozen = whole;
                settled += molten;
            } else if molten > 0.0 {
                melt.push(Melt { cell: i as u32, depth: molten, heat });
                depth.data[i] = molten as f32;
                warm.data[i] = law.melt.degc(heat / molten) as f32;
            }
            if molten > 0.0 || fresh.frozen > 0.0 {
                cells.push(fresh);
            }
        }
        let frozen_m3 = (sheet.books.frozen + settled) * area;
        let date = (world.time_yr + self.elapsed_yr()) as f32;
        run.lay(world, &cells, frozen_m3, (date, self.params.hardness as f32), context.stage);
        world.set_layer(Layer::MoltenLava, depth);
        world.set_layer(Layer::MoltenTemperature, warm);
        world.ledger.book_in(context.stage, Matter::Lava, sheet.books.erupted * area);
        world.ledger.book_out(context.stage, Matter::Lava, sheet.books.left * area + frozen_m3);
        let flows_m3 = melt.iter().map(|melt| melt.depth).sum::<f64>() * area;
        world.ledger.close(context.stage, Matter::Lava, flows_m3);
        run.melt = melt;
        run.over_rim_m3 += sheet.books.left * area;
    }

    fn elapsed_yr(&self) -> f64 {
        let [from, to] = self.span_s();
        (to - from) / HOUR_S / YEAR_H
    }
}

/// Lava that froze on a cell, m, and its mean temperature.
#[derive(Clone, Copy, Debug)]
struct Fresh {
    cell: usize,
    frozen: f64,
    degc: f64,
}

impl Run {
    /// Lays lava on the column. Sediment that lava has come over is bedrock from then on.
    fn lay(&mut self, world: &mut World, cells: &[Fresh], frozen_m3: f64, (date, hard): (f32, f32), stage: &str) {
        let (stock, waited) = (world.rock_m3(), crate::grid::sum_f64(&self.rest.data));
        let kept =
            [Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Hardness, Layer::LavaTemperature, Layer::LavaDate];
        let mut layers =
            kept.map(|layer| std::mem::replace(world.layer_mut(layer), Field::filled(self.rest.grid, 0.0)));
        let [bedrock, lava, sediment, hardness, degc, dates] = &mut layers;
        for fresh in cells {
            let i = fresh.cell;
            let parts = [bedrock.data[i], lava.data[i], sediment.data[i], self.rest.data[i]].map(f64::from);
            let top = parts.iter().sum::<f64>() + fresh.frozen;
            if sediment.data[i] != 0.0 {
                bedrock.data[i] = (parts[0] + parts[2]) as f32;
                sediment.data[i] = 0.0;
            }
            if fresh.frozen > 0.0 {
                let old = if degc.data[i] == 0.0 { 0.0 } else { parts[1].max(0.0) };
                degc.data[i] =
                    ((old * f64::from(degc.data[i]) + fresh.frozen * fresh.degc) / (old + fresh.frozen)) as f32;
                dates.data[i] = date;
                let covers = 1.0 - libm::exp(-fresh.frozen / COVER_M);
                hardness.data[i] += (hard - hardness.data[i]) * covers as f32;
            }
            lava.data[i] = ((top - f64::from(bedrock.data[i])) as f32).max(0.0);
            self.rest.data[i] = (top - f64::from(bedrock.data[i]) - f64::from(lava.data[i])) as f32;
        }
        for (layer, field) in kept.into_iter().zip(layers) {
            world.set_layer(layer, field);
        }
        // What waits has not come in yet. The sum over a world is good to some 1e-13 of it: within that, what is there
        // decides.
        let waits = (crate::grid::sum_f64(&self.rest.data) - waited) * world.grid.cell_area_m2();
        let (booked, stored) = (frozen_m3 - waits, world.rock_m3() - stock);
        let agrees = (stored - booked).abs() <= 1e-12 * stock.abs().max(world.rock_m3().abs());
        let gained = if agrees { stored } else { booked };
        if gained >= 0.0 {
            world.ledger.book_in(stage, Matter::Rock, gained);
        } else {
            world.ledger.book_out(stage, Matter::Rock, -gained);
        }
    }

    fn save(&self) -> State {
        let mut blob = self.over_rim_m3.to_le_bytes().to_vec();
        blob.extend((self.sources.len() as u64).to_le_bytes());
        for &(cell, share) in &self.sources {
            blob.extend((cell as u64).to_le_bytes());
            blob.extend(share.to_le_bytes());
        }
        for melt in &self.melt {
            blob.extend(u64::from(melt.cell).to_le_bytes());
            blob.extend(melt.depth.to_le_bytes());
            blob.extend(melt.heat.to_le_bytes());
        }
        State { fields: vec![("rest".to_owned(), self.rest.clone())], blob }
    }

    fn restored(fields: &[(String, Field<f32>)], blob: &[u8]) -> Option<Self> {
        let rest = fields.iter().find(|(name, _)| name == "rest").map(|(_, field)| field.clone())?;
        let cells = rest.data.len() as u64;
        let words: Vec<[u8; 8]> = blob.chunks_exact(8).filter_map(|word| word.try_into().ok()).collect();
        if blob.len() != 8 * words.len() {
            return None;
        }
        let (&[over_rim, count], words) = words.split_first_chunk()?;
        let count = usize::try_from(u64::from_le_bytes(count)).ok()?;
        let (sources, melt) = words.split_at_checked(count.checked_mul(2)?)?;
        let cell = |word: [u8; 8]| Some(u64::from_le_bytes(word)).filter(|&cell| cell < cells);
        let pair = |two: &[[u8; 8]]| Some((cell(two[0])? as usize, f64::from_le_bytes(two[1])));
        let sources = sources.chunks_exact(2).map(pair).collect::<Option<Vec<_>>>()?;
        let three = |three: &[[u8; 8]]| {
            let [depth, heat] = [three[1], three[2]].map(f64::from_le_bytes);
            Some(Melt { cell: u32::try_from(cell(three[0])?).ok()?, depth, heat })
        };
        let whole = melt.len().is_multiple_of(3);
        let melt = melt.chunks_exact(3).map(three).collect::<Option<Vec<_>>>().filter(|_| whole)?;
        Some(Self { sources, smoke: Vec::new(), melt, rest, over_rim_m3: f64::from_le_bytes(over_rim) })
    }
}

impl Process for Stage {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[
            Layer::Bedrock,
            Layer::Lava,
            Layer::Sediment,
            Layer::Hardness,
            Layer::MoltenLava,
            Layer::MoltenTemperature,
            Layer::LavaTemperature,
            Layer::LavaDate,
        ]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        let params = &self.params;
        params.check().and_then(|()| params.check_work(grid)).map_err(ProcessError::Unfit)
    }

    fn remarks(&self, grid: &Grid) -> Vec<String> {
        let [least_m, most_m] = CELLS_M;
        let cell_m = grid.cell_m;
        let fits = (least_m..=most_m).contains(&cell_m);
        let text = format!("a sheet of lava suits cells of {least_m} to {most_m} m; these are {cell_m:.3} m wide");
        if fits { Vec::new() } else { vec![text] }
    }

    fn findings(&self) -> Vec<String> {
        let over_m3 = self.run.as_ref().map_or(0.0, |run| run.over_rim_m3);
        // Less than it can say is not worth a line.
        if self.done < self.steps || over_m3 < 0.5 { Vec::new() } else { vec![over_rim(over_m3)] }
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mut run = match self.run.take() {
            Some(run) => run,
            None => self.begin(world, context)?,
        };
        match self.flow(&run, world, context) {
            Ok(sheet) => self.write(&mut run, &sheet, world, context),
            Err(stopped) => {
                // Nothing has changed but that it has begun.
                self.run = (self.done > 0).then_some(run);
                return Err(stopped);
            }
        }
        world.add_plumes(&std::mem::take(&mut run.smoke));
        let elapsed_yr = self.elapsed_yr();
        self.run = Some(run);
        self.done += 1;
        Ok(Step { done: self.done as f64 / self.steps as f64, elapsed_yr })
    }

    fn save(&self) -> State {
        let State { fields, blob } = self.run.as_ref().map(Run::save).unwrap_or_default();
        State { fields, blob: [&self.done.to_le_bytes()[..], &blob].concat() }
    }

    fn restore(&mut self, state: State, _context: &Context) -> Result<(), ProcessError> {
        let broken = || ProcessError::Failed("the saved state of this stage is broken".to_owned());
        let (done, blob) = state.blob.split_first_chunk::<8>().ok_or_else(broken)?;
        self.done = u64::from_le_bytes(*done);
        self.run = match self.done {
            0 => None,
            _ => Some(Run::restored(&state.fields, blob).ok_or_else(broken)?),
        };
        Ok(())
    }
}
