//! The stage `hillslope`: soil creeps down slopes, faster the nearer they are to the slope that fails.
//!
//! `∂z/∂t = ∇·(D·∇z / (1 − (S/S_c)²))`, with `S` the slope at a face and `S_c` the critical one (Roering, Kirchner and
//! Dietrich 1999); without a critical slope it is plain diffusion. The conductance is taken from the ground before each
//! step and held during it. It grows without bound at `S_c`, so it is capped; what is steeper than the cap allows goes as
//! fast as the cap lets it. Steps are explicit, each within the limit of the steepest face there is.
//!
//! The sea floor rests; what reaches it stays at the coast. Nothing crosses the rim. Where a climate is known, the diffusivity
//! goes with the pace at which rock weathers there.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    grid::{Field, Grid, for_each_row, max_rows},
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, World},
};

use super::{
    column::{Change, Column, Ground},
    weathering::pace,
};

/// Most that nearness to the critical slope can speed creep up.
const FASTEST: f64 = 100.0;
/// Most of `D·t / cell²` in an explicit step, at the fastest face; stable to a quarter.
const EXPLICIT: f64 = 0.2;
/// Steps after which a run is shared out to be stopped in between.
const STEPS: u64 = 20;

/// Soil creeps down slopes and rounds crests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HillslopeParams {
    /// How long it creeps.
    #[schemars(range(min = 0.001, max = 1000000.0), extend("x-unit" = "ky", "x-effect" = "rounder hills"))]
    pub duration_kyr: f64,
    /// Diffusivity on gentle slopes.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "m2/yr", "x-effect" = "rounder hills in the same time"))]
    pub diffusivity_m2_per_yr: f64,
    /// Slope near which everything slides; 90 for plain diffusion.
    #[schemars(range(min = 5.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "steeper slopes can stand"))]
    pub critical_slope_deg: f64,
    /// Whether temperature and rain set the pace, where a climate is known; the diffusivity is then that of 10 °C and 1000 mm.
    #[schemars(extend("x-effect" = "true: quick where it is warm and wet or freezes and thaws, slow where it is dry"))]
    pub weathering: bool,
}

impl Default for HillslopeParams {
    fn default() -> Self {
        Self { duration_kyr: 100.0, diffusivity_m2_per_yr: 0.02, critical_slope_deg: 45.0, weathering: true }
    }
}

impl HillslopeParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage { params: self, placement, steps: steps.unwrap_or(STEPS).max(1), done: 0, run: None })
    }

    /// Rise over run at which everything slides.
    fn critical(&self) -> f64 {
        if self.critical_slope_deg >= 90.0 { f64::INFINITY } else { libm::tan(self.critical_slope_deg.to_radians()) }
    }
}

struct Stage {
    params: HillslopeParams,
    placement: Placement,
    steps: u64,
    done: u64,
    run: Option<Run>,
}

struct Run {
    /// Share of the diffusivity that cells have by mask and weather.
    share: Option<Field<f32>>,
    /// What the diffusivity is multiplied by where that share is 1.
    most: f64,
    column: Column,
}

impl Run {
    fn begin(stage: &Stage, world: &World) -> Result<Self, ProcessError> {
        let mask = stage.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let Some(pace) = stage.params.weathering.then(|| pace(world)).flatten() else {
            return Ok(Self { share: mask, most: 1.0, column: Column::new(world.grid) });
        };
        let mut share = Field { grid: world.grid, data: pace.share };
        if let Some(mask) = mask {
            share.data.iter_mut().zip(&mask.data).for_each(|(share, mask)| *share *= mask);
        }
        Ok(Self { share: Some(share), most: pace.most, column: Column::new(world.grid) })
    }
}

impl Process for Stage {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        // What the gentlest ground needs; the steepest may need a hundred times that.
        let moves = self.params.diffusivity_m2_per_yr * 1e3 * self.params.duration_kyr;
        let steps = moves / (EXPLICIT * grid.cell_area_m2());
        if steps > 1e6 {
            return Err(ProcessError::Unfit(format!(
                "cells of {:.3} m are too fine for this much creep (a million steps and more); lower duration_kyr or \
                 diffusivity_m2_per_yr, or raise extent_km",
                grid.cell_m
            )));
        }
        Ok(())
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mut run = match self.run.take() {
            Some(run) => run,
            None => Run::begin(self, world)?,
        };
        let years = 1e3 * self.params.duration_kyr / self.steps as f64;
        let mut before = Vec::new();
        run.column.read(world, &mut before);
        let (sea_m, share) = (world.sea_level_m, &run.share);
        let open: Vec<f32> = before
            .par_iter()
            .enumerate()
            .map(|(i, &z)| if z < sea_m { 0.0 } else { share.as_ref().map_or(1.0, |share| share.data[i]) })
            .collect();
        let creep = Creep { grid: world.grid, critical: self.params.critical(), open: &open };
        let mut height_m = before.clone();
        // Cancelled half way, the world has not been written to.
        let spread_m2 = self.params.diffusivity_m2_per_yr * run.most * years;
        if let Err(stopped) = creep.run(&mut height_m, spread_m2, || context.check()) {
            self.run = Some(run);
            return Err(stopped);
        }
        let change = Change { ground: Ground::Heights([&before, &height_m]), lifted_m3: 0.0, left_m3: 0.0 };
        run.column.write(world, &change, context.stage);
        self.run = Some(run);
        self.done += 1;
        Ok(Step { done: self.done as f64 / self.steps as f64, elapsed_yr: years })
    }

    fn save(&self) -> State {
        let fields = self.run.iter().flat_map(|run| {
            let share = run.share.iter().map(|share| ("share".to_owned(), share.clone()));
            std::iter::once(("rest".to_owned(), run.column.rest().clone())).chain(share)
        });
        let most = self.run.as_ref().map_or(1.0, |run| run.most);
        State { fields: fields.collect(), blob: [self.done.to_le_bytes(), most.to_le_bytes()].concat() }
    }

    fn restore(&mut self, state: State, _context: &Context) -> Result<(), ProcessError> {
        let broken = || ProcessError::Failed("the saved state of hillslope is broken".to_owned());
        let (words, []) = state.blob.as_chunks::<8>() else { return Err(broken()) };
        let &[done, most] = words else { return Err(broken()) };
        let most = f64::from_le_bytes(most);
        self.done = u64::from_le_bytes(done);
        let field = |wanted: &str| state.fields.iter().find(|(name, _)| name == wanted).map(|(_, field)| field.clone());
        self.run = field("rest").map(|rest| Run { share: field("share"), most, column: Column::restored(rest) });
        Ok(())
    }
}

/// Non-linear diffusion over a raster.
struct Creep<'a> {
    grid: Grid,
    critical: f64,
    /// Share of the diffusivity that a cell has; a face is open where one of its cells is.
    open: &'a [f32],
}

impl Creep<'_> {
    /// Goes on until `D·t` reaches `spread_m2`.
    fn run(
        &self,
        value: &mut Vec<f64>,
        spread_m2: f64,
        check: impl Fn() -> Result<(), ProcessError>,
    ) -> Result<(), ProcessError> {
        let (mut left, mut next) = (spread_m2, vec![0.0; value.len()]);
        while left > 0.0 {
            check()?;
            // Rounded up to a power of two, so that the last bit of a slope does not decide on the number of steps.
            let most = EXPLICIT * self.grid.cell_area_m2() / libm::exp2(libm::ceil(libm::log2(self.fastest(value))));
            let step = if left <= most { left } else { left / (left / most).ceil() };
            self.step(value, &mut next, step / self.grid.cell_area_m2());
            std::mem::swap(value, &mut next);
            left = if step == left { 0.0 } else { left - step };
        }
        Ok(())
    }

    /// How much a slope speeds creep up.
    fn speed_up(&self, slope: f64) -> f64 {
        let near = (slope / self.critical) * (slope / self.critical);
        if near < 1.0 - 1.0 / FASTEST { 1.0 / (1.0 - near) } else { FASTEST }
    }

    /// The greatest speed-up of any face, with what it adds when slopes change: `(1 + s²) / (1 − s²)²`, up to the cap.
    fn fastest(&self, value: &[f64]) -> f64 {
        let (grid, width) = (self.grid, self.grid.width);
        let steepest = max_rows(&grid, |y| {
            let (row, south) = (&value[y * width..][..width], &value[grid.row(y, 1) * width..][..width]);
            let fall = |x: usize| (row[x] - row[grid.column(x, 1)]).abs().max((row[x] - south[x]).abs());
            (0..width).map(fall).fold(0.0, f64::max)
        });
        let speed = self.speed_up(steepest / grid.cell_m);
        if self.critical.is_finite() { (2.0 * speed * speed).min(FASTEST) } else { 1.0 }
    }

    fn step(&self, value: &[f64], next: &mut [f64], share: f64) {
        let (grid, width) = (self.grid, self.grid.width);
        for_each_row(next, width, |y, out| {
            let (here, north, south) = (y * width, grid.row(y, -1) * width, grid.row(y, 1) * width);
            for (x, out) in out.iter_mut().enumerate() {
                let (v, a) = (value[here + x], self.open[here + x]);
                let flow = |j: usize| {
                    let fall = value[j] - v;
                    fall * self.speed_up(fall.abs() / grid.cell_m) * a.max(self.open[j]) as f64
                };
                let (west, east) = (here + grid.column(x, -1), here + grid.column(x, 1));
                *out = v + share * (flow(north + x) + flow(west) + flow(east) + flow(south + x));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn creep(grid: Grid, critical: f64, value: &mut Vec<f64>, spread_m2: f64) {
        let open = vec![1.0; grid.cells()];
        Creep { grid, critical, open: &open }.run(value, spread_m2, || Ok(())).unwrap();
    }

    fn strip(width: usize, f: impl Fn(f64) -> f64) -> (Grid, Vec<f64>) {
        let grid = Grid { width, height: 3, cell_m: 10.0, edges: Edges::Wrap };
        (grid, (0..grid.cells()).map(|i| f(grid.center_m(i % width, 0)[0])).collect())
    }

    #[test]
    fn a_wave_decays_as_it_should() {
        let (length, d) = (1000.0, 400.0);
        let k = std::f64::consts::TAU / length;
        let (grid, mut z) = strip(100, |x| 30.0 * (k * x).cos());
        creep(grid, f64::INFINITY, &mut z, 50.0 * d);
        // The discrete wave number of 100 cells a wave is 1.6e-4 below k²; the rest is the order of explicit steps.
        let want = (-k * k * 50.0 * d).exp();
        assert!((z[0] / (30.0 * (5.0 * k).cos()) / want - 1.0).abs() < 1e-3, "{} {want}", z[0]);
    }

    /// A ridge that rises at `uplift` between two streams 210 m apart that keep their height, after it has found its
    /// balance: eight times the 4500 m² that a bump of this width takes to fade. The streams are put back after each
    /// `spread_m2`, which has to be a single step.
    fn ridge(critical: f64, uplift: f64, d: f64, spread_m2: f64) -> Vec<f64> {
        let (grid, mut z) = strip(21, |_| 0.0);
        for _ in 0..(36e3 / spread_m2) as usize {
            creep(grid, critical, &mut z, spread_m2);
            for (i, z) in z.iter_mut().enumerate() {
                *z = if i % 21 == 0 { 0.0 } else { *z + uplift * spread_m2 / d };
            }
        }
        z[..21].to_vec()
    }

    #[test]
    fn a_ridge_in_balance_is_a_parabola() {
        // 1 mm/yr and D of 0.05 m²/yr: z = U·x·(L − x) / 2D.
        let z = ridge(f64::INFINITY, 1e-3, 0.05, 20.0);
        for (i, z) in z.iter().enumerate().skip(1) {
            let x = 10.0 * i as f64;
            let want = 1e-3 * x * (210.0 - x) / 0.1;
            // What a step lifts, 0.4 m, is on top when it is looked at.
            assert!((z - want).abs() < 0.01 * want + 0.4, "{i}: {z} for {want}");
        }
    }

    #[test]
    fn near_the_critical_slope_a_ridge_is_straighter() {
        // In balance the flux at x from the crest is U·x, whatever the law: q = D·S / (1 − (S/Sc)²).
        let (uplift, d, critical) = (4e-4, 0.05, 0.8);
        let z = ridge(critical, uplift, d, 2.0);
        for i in 2..10 {
            let slope = (z[i] - z[i - 1]) / 10.0;
            let from_crest = 105.0 - 10.0 * (i as f64 - 0.5);
            let flux = d * slope / (1.0 - (slope / critical) * (slope / critical));
            assert!((flux / (uplift * from_crest) - 1.0).abs() < 0.03, "{i}: {flux} {}", uplift * from_crest);
        }
    }

    #[test]
    fn a_cliff_comes_down_without_a_swing_and_nothing_is_lost() {
        let grid = Grid::new(40, 30, 400.0, Edges::Open);
        let mut z: Vec<f64> = (0..grid.cells()).map(|i| if i % 40 < 20 { 500.0 } else { 0.0 }).collect();
        let before: f64 = z.iter().sum();
        creep(grid, 0.8, &mut z, 300.0);
        let (least, most) = z.iter().fold((f64::MAX, f64::MIN), |(a, b), &z| (a.min(z), b.max(z)));
        assert!(least >= 0.0 && most <= 500.0, "{least} {most}");
        assert!((z.iter().sum::<f64>() / before - 1.0).abs() < 1e-13);
        assert!(z.chunks(40).all(|row| row.windows(2).all(|pair| pair[0] >= pair[1] - 1e-9)));
    }
}
