//! The registry of stages: one row a kind. To add a stage, add its row to `table`.

use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::{
    climate::ClimateParams,
    edit::{HardnessParams, ImportParams, UpliftParams, ZoomParams},
    erosion::{
        DropletsParams, HillslopeParams, HydraulicCellsParams, PipesParams, RainParticlesParams, StreamPowerParams,
        ThermalParams,
    },
    process::{Placement, Process, ProcessError, Shape},
    rivers::RiversParams,
    tectonics::PlatesParams,
    volcano::{AshParams, IslandParams, LavaParams, LavaSheetParams, VolcanoParams},
};

use super::schema;

/// What every stage is given besides its own parameters.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// Blend and mask.
    pub placement: Placement,
    /// An expert's number of steps.
    pub steps: Option<u64>,
    /// Whether other stages step in turn with this one.
    pub leads: bool,
}

type Build = Box<dyn Fn(&Json, Setting) -> Result<Box<dyn Process>, ProcessError> + Send + Sync>;

/// One kind of stage.
pub struct StageKind {
    /// The name in a recipe.
    pub kind: &'static str,
    /// The name for people.
    pub title: &'static str,
    /// What it does, in a sentence.
    pub about: &'static str,
    /// Whether its heights join by `blend`.
    pub blends: bool,
    /// Whether other stages may be coupled to it.
    pub leads: bool,
    /// JSON schema of its own parameters.
    pub schema: Json,
    /// Its parameters' defaults.
    pub defaults: Json,
    build: Build,
}

impl std::fmt::Debug for StageKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StageKind").field("kind", &self.kind).finish_non_exhaustive()
    }
}

impl StageKind {
    /// The process for validated parameters.
    pub fn build(&self, params: &Json, setting: Setting) -> Result<Box<dyn Process>, ProcessError> {
        (self.build)(params, setting)
    }
}

/// A row of the registry: a base shape, whose heights join by `blend` and `mask`.
fn ground<P>(kind: &'static str, title: &'static str, about: &'static str) -> StageKind
where
    P: Shape + Default + Serialize + DeserializeOwned + JsonSchema,
{
    let build = |params: P, setting: Setting| Ok(params.process(setting.placement));
    StageKind { blends: true, ..row(kind, title, about, build) }
}

/// A row of the registry: any stage.
fn row<P>(
    kind: &'static str,
    title: &'static str,
    about: &'static str,
    make: impl Fn(P, Setting) -> Result<Box<dyn Process>, ProcessError> + Send + Sync + 'static,
) -> StageKind
where
    P: Default + Serialize + DeserializeOwned + JsonSchema,
{
    let build = move |params: &Json, setting: Setting| {
        let params = serde_json::from_value(params.clone()).map_err(|e| ProcessError::Unfit(e.to_string()))?;
        make(params, setting)
    };
    let defaults = serde_json::to_value(P::default()).unwrap_or_default();
    StageKind {
        kind,
        title,
        about,
        blends: false,
        leads: false,
        schema: schema::of::<P>(),
        defaults,
        build: Box::new(build),
    }
}

#[rustfmt::skip]
fn table() -> Vec<StageKind> {
    use crate::terrain as t;
    vec![
        StageKind {
            blends: true,
            leads: true,
            ..row("plates", "Plates", "Rigid plates drift and collide; ranges rise where they meet.", |plates: PlatesParams, setting| {
                Ok(plates.process(setting.placement, setting.steps, setting.leads))
            })
        },
        ground::<t::FbmParams>("fbm", "Fractal ground", "Fractional Brownian motion: hills whose roughness is a number."),
        ground::<t::MultifractalParams>("multifractal", "Multifractal ground", "Smooth valleys below rough crests."),
        ground::<t::WarpParams>("warp", "Warp", "Bends the ground that is there, as if it were rubber."),
        ground::<t::TerraceParams>("terrace", "Terraces", "Cuts the ground that is there into benches."),
        ground::<t::DiamondSquareParams>("diamond_square", "Diamond-square", "Midpoint displacement, finer and finer."),
        ground::<t::FaultParams>("fault", "Faults", "Random lines, each raising one side and lowering the other."),
        ground::<t::RmpPeakParams>("rmp_peak", "Peak", "A mountain of many random Voronoi cells about a point."),
        ground::<t::RmpRidgeParams>("rmp_ridge", "Ridge", "A range of many random Voronoi cells along a drawn line."),
        ground::<t::RmpGraphParams>("rmp_graph", "Line-cut massif", "A massif of faces between random lines."),
        ground::<IslandParams>("island", "Island", "A cone with a flat core, and islets around it."),
        StageKind {
            blends: true,
            ..row("volcano", "Volcano", "Volcanoes with craters: one, several, a chain behind a hot spot, or along arcs.", |volcano: VolcanoParams, setting| {
                Ok(volcano.process(setting.placement))
            })
        },
        row("lava_sheet", "Lava sheet", "Lava as a sheet that runs for kilometres, cools and freezes into the ground.", |lava: LavaSheetParams, setting| {
            Ok(lava.process(setting.placement, setting.steps))
        }),
        row("ash", "Ash fall", "Ash of an eruption falls downwind and drapes the ground.", |ash: AshParams, setting| {
            Ok(ash.process(setting.placement))
        }),
        row("climate", "Climate", "Wind, rain, temperature, snow line, and what grows.", |climate: ClimateParams, setting| {
            Ok(climate.process(setting.placement))
        }),
        StageKind {
            blends: true,
            ..row("import", "Import", "Lays a heightmap from a file into the ground.", |import: ImportParams, setting| {
                Ok(import.process(setting.placement))
            })
        },
        row("stream_power", "Erosion by rivers", "Rivers cut into rising land over geologic time.", |rivers: StreamPowerParams, setting| {
            Ok(rivers.process(setting.placement, setting.steps))
        }),
        row("hillslope", "Hillslopes", "Soil creeps down slopes and rounds crests.", |creep: HillslopeParams, setting| {
            Ok(creep.process(setting.placement, setting.steps))
        }),
        row("thermal", "Slides", "What is too steep slides down, and lies as scree below.", |slides: ThermalParams, setting| {
            Ok(slides.process(setting.placement, setting.steps))
        }),
        row("hydraulic_cells", "Storm water, cellular", "Rain dissolves rock, carries it and dries up: Olsen's automaton.", |cells: HydraulicCellsParams, setting| {
            Ok(cells.process(setting.placement, setting.steps))
        }),
        row("pipes", "Storm water", "Shallow water runs over the land, carves it, and lays down what it carries.", |pipes: PipesParams, setting| {
            Ok(pipes.process(setting.placement, setting.steps))
        }),
        row("rain_particles", "Rain as particles", "Particles of water run down the ground, dig rills and lay down fans.", |rain: RainParticlesParams, setting| {
            Ok(rain.process(setting.placement, setting.steps))
        }),
        row("droplets", "Droplets", "Droplets run down slopes, cut gullies and lay down fans.", |droplets: DropletsParams, setting| {
            Ok(droplets.process(setting.placement, setting.steps))
        }),
        row("lava", "Lava", "Lava wells up, runs down, cools and freezes into the ground.", |lava: LavaParams, setting| {
            Ok(lava.process(setting.placement, setting.steps))
        }),
        row("uplift", "Uplift", "Sets how fast rock is raised, where and when.", |uplift: UpliftParams, setting| {
            Ok(uplift.process(setting.placement))
        }),
        row("hardness", "Hardness", "Lays bands of hard rock into soft rock.", |hardness: HardnessParams, setting| {
            Ok(hardness.process(setting.placement))
        }),
        row("zoom", "Zoom", "Goes on with a part of the map at a finer scale.", |zoom: ZoomParams, setting| {
            zoom.process(setting.placement)
        }),
        row("rivers", "Rivers", "Gathers rain to rivers and lakes, and cuts their beds.", |rivers: RiversParams, setting| {
            Ok(rivers.process(setting.placement))
        }),
        #[cfg(test)]
        ground::<super::probe::ProbeParams>("probe", "Probe", "A level ground for tests."),
        #[cfg(test)]
        row("drip", "Drip", "Adds a metre a step, for tests.", super::probe::DripParams::process),
    ]
}

/// Every stage kind, in the order in which a reader meets them.
pub fn all() -> &'static [StageKind] {
    static ALL: OnceLock<Vec<StageKind>> = OnceLock::new();
    ALL.get_or_init(table)
}

/// The stage of that kind.
pub fn find(kind: &str) -> Option<&'static StageKind> {
    all().iter().find(|stage| stage.kind == kind)
}
