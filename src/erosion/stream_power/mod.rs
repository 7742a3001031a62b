//! The stage `stream_power`: rivers cut into rising land over geologic time.

mod base;
mod carver;
mod coast;
mod deposition;
mod lake;
mod law;
mod slide;
mod solver;
#[cfg(test)]
mod tests;

pub use carver::{Carver, Forcing, Law, Moved};
pub use solver::Solver;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    grid::Grid,
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, World},
};

/// Steps beyond which a run would take days.
const MOST_STEPS: f64 = 1e5;
/// The same for each million years of the plates that a coupled stage follows.
const MOST_STEPS_A_MYR: f64 = 2e4;

/// What the rim of an open map is to rivers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Rim {
    /// The land goes on beyond it: rivers leave with the slope they arrive with.
    #[default]
    Free,
    /// As free, but rivers leave no lower than they did: for windows, whose surroundings do not sink away.
    Held,
    /// A base level that keeps its height.
    Fixed,
}

/// How water chooses among the eight neighbours of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Routing {
    /// The steepest way down: on even slopes valleys keep to the eight directions of the raster.
    #[default]
    Steepest,
    /// Between the two ways about the line of fall by a chance that each cell keeps, so that valleys run as the slope does
    /// and meet (Fairfield and Leymarie 1991).
    Rho8,
}

/// Rivers cut, carry and lay down over geologic time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StreamPowerParams {
    /// How long rivers work.
    #[schemars(range(min = 0.000001, max = 1000.0), extend("x-unit" = "My", "x-effect" = "deeper valleys, until uplift and erosion balance"))]
    pub duration_myr: f64,
    /// Erodibility K for a rain of 1000 mm/yr. Relief in balance grows as (uplift / K)^(1/n); change it with m.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "m^(1-2m)/yr", "x-effect" = "lower relief, quicker valleys"))]
    pub erodibility: f64,
    /// Exponent of discharge.
    #[schemars(range(min = 0.1, max = 1.5), extend("x-unit" = "1", "x-effect" = "large rivers cut more; m/n is the concavity of their profiles"))]
    pub m: f64,
    /// Exponent of slope.
    #[schemars(range(min = 0.3, max = 4.0), extend("x-unit" = "1", "x-effect" = "steep reaches cut more"))]
    pub n: f64,
    /// Rain where no stage has made a map of it.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "mm/yr", "x-effect" = "more water in every river"))]
    pub rain_mm_per_yr: f64,
    /// Deposition G: how readily a river lays its load down again. 0 is quickest; 1 is common.
    #[schemars(range(min = 0.0, max = 2.0), extend("x-unit" = "1", "x-effect" = "gentler lower courses, plains before ranges"))]
    pub deposition: f64,
    /// Diffusivity of hillslopes.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "m2/yr", "x-effect" = "rounder crests"))]
    pub diffusivity_m2_per_yr: f64,
    /// Distance from its mouth over which a river's load falls to 1/e in the sea.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "km", "x-effect" = "carries sediment further out"))]
    pub marine_reach_km: f64,
    /// Steepest slope down to a river; what is steeper slides.
    #[schemars(range(min = 1.0, max = 89.0), extend("x-unit" = "deg", "x-effect" = "steeper walls"))]
    pub talus_angle_deg: f64,
    /// What is too steep slides in whatever direction it faces, not only down the way of its water.
    #[schemars(extend("x-effect" = "slopes without stripes in the eight directions of the raster; for cells under some 100 m"))]
    pub talus_all_round: bool,
    /// Catchment at which channels begin; where it is smaller, slopes creep and slide, but hardly any water cuts them.
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "m2", "x-effect" = "smooth slopes between fewer gullies"))]
    pub channel_area_m2: f64,
    /// How water chooses among the eight neighbours of a cell.
    #[schemars(extend("x-effect" = "rho8: by a chance that is fair to all directions, for even slopes and fine cells"))]
    pub routing: Routing,
    /// Longest step. Water keeps its way through a step, so steps of more than a million years would leave walls and pits.
    #[schemars(range(min = 0.001, max = 1000.0), extend("x-unit" = "ky", "x-effect" = "faster, blurs the moment a valley is cut"))]
    pub step_kyr: f64,
    /// What the rim of an open map is.
    #[schemars(extend("x-effect" = "held: rivers leave no lower than they did, as in a window; fixed: the rim keeps its height and what reaches it is gone"))]
    pub rim: Rim,
    /// Uplift also moves the sea floor, as it always does where plates are coupled. Else the sea is a base that stays.
    #[schemars(extend("x-effect" = "islands rise out of the sea, sunken land goes on sinking"))]
    pub lift_sea_floor: bool,
    /// Steps in turn with the plates stage before it; uplift then also moves the sea floor.
    #[schemars(extend("x-effect" = "ranges are carved while they rise"))]
    pub coupled: bool,
}

impl Default for StreamPowerParams {
    fn default() -> Self {
        Self {
            duration_myr: 5.0,
            // Keeps ranges of 2 to 4 km under 0.5 to 1 mm/yr of uplift, for rivers of 100 to 200 km.
            erodibility: 2.2e-6,
            m: 0.5,
            n: 1.0,
            rain_mm_per_yr: 1000.0,
            deposition: 0.0,
            diffusivity_m2_per_yr: 0.01,
            marine_reach_km: 15.0,
            talus_angle_deg: 35.0,
            talus_all_round: false,
            channel_area_m2: 0.0,
            routing: Routing::Steepest,
            step_kyr: 100.0,
            rim: Rim::Free,
            lift_sea_floor: false,
            coupled: false,
        }
    }
}

impl StreamPowerParams {
    /// The constants of the law.
    pub fn law(&self) -> Law {
        Law {
            erodibility: self.erodibility,
            area_exponent: self.m,
            slope_exponent: self.n,
            deposition: self.deposition,
            channel_area_m2: self.channel_area_m2,
            slides_all_round: self.talus_all_round,
            steepest: libm::tan(self.talus_angle_deg.to_radians()),
            diffusivity_m2_per_yr: self.diffusivity_m2_per_yr,
            marine_reach_m: 1e3 * self.marine_reach_km,
            rim: self.rim,
            lifts_base: self.coupled || self.lift_sea_floor,
        }
    }

    /// The stage as a process; `steps` asks for that many instead of as many as `step_kyr` needs.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        let steps = steps.unwrap_or((1e3 * self.duration_myr / self.step_kyr - 1e-9).ceil() as u64).max(1);
        Box::new(Stage { params: self, placement, steps, done: 0, solver: None })
    }
}

struct Stage {
    params: StreamPowerParams,
    placement: Placement,
    steps: u64,
    done: u64,
    solver: Option<Solver>,
}

impl Stage {
    /// The solver; made when it is first asked for, since the mask is evaluated before the stage changes what it looks at.
    fn solver(&mut self, world: &World, context: &Context) -> Result<&mut Solver, ProcessError> {
        match &mut self.solver {
            Some(solver) => Ok(solver),
            empty => {
                let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
                Ok(empty.insert(Solver::new(&self.params, world, mask, context.key)))
            }
        }
    }
}

impl Process for Stage {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit]
    }

    fn fit(&self, _grid: &Grid) -> Result<(), ProcessError> {
        let (kyr, coupled) = (self.params.step_kyr, self.params.coupled);
        // Coupled, its time is the plates'.
        let (myr, most) = if coupled { (1.0, MOST_STEPS_A_MYR) } else { (self.params.duration_myr, MOST_STEPS) };
        let steps = 1e3 * myr / kyr;
        if steps <= most {
            return Ok(());
        }
        let span = if coupled { "each My of the plates".to_owned() } else { format!("{myr} My") };
        let least = 1e3 * myr / most;
        let text = format!("{span} in steps of {kyr} ky are {steps:.0} steps; raise step_kyr to {least} or more");
        Err(ProcessError::Unfit(text))
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let span_yr = |steps: u64| 1e6 * self.params.duration_myr * (steps as f64 / self.steps as f64);
        let elapsed_yr = span_yr(self.done + 1) - span_yr(self.done);
        let solver = self.solver(world, context)?;
        solver.advance(world, elapsed_yr, context.stage);
        self.done += 1;
        Ok(Step { done: self.done as f64 / self.steps as f64, elapsed_yr })
    }

    fn follow(&mut self, world: &mut World, context: &Context, span_yr: f64) -> Result<(), ProcessError> {
        self.solver(world, context)?.advance(world, span_yr, context.stage);
        Ok(())
    }

    fn save(&self) -> State {
        let fields = self.solver.as_ref().map(Solver::save).unwrap_or_default();
        State { fields, blob: self.done.to_le_bytes().to_vec() }
    }

    fn restore(&mut self, state: State, context: &Context) -> Result<(), ProcessError> {
        let broken = || ProcessError::Failed("the saved state of stream_power is broken".to_owned());
        self.done = u64::from_le_bytes(state.blob.try_into().map_err(|_| broken())?);
        if !state.fields.is_empty() {
            self.solver = Some(Solver::restored(&self.params, &state.fields, context.key).ok_or_else(broken)?);
        }
        Ok(())
    }
}
