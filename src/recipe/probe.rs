//! Two stages for tests: one with every kind of parameter, one of many steps.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    grid::Field,
    process::{Context, Process, ProcessError, Shape, State, Step},
    world::{Layer, Matter, World},
};

use super::Setting;

/// Every form a parameter can take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ProbeParams {
    /// Height of the ground.
    #[schemars(range(min = -1000.0, max = 1000.0), extend("x-unit" = "m", "x-effect" = "higher ground"))]
    pub height_m: f64,
    /// A share, if wanted.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub share: Option<f64>,
    /// How many.
    #[schemars(range(min = 1, max = 9))]
    pub count: u32,
    /// How.
    pub style: Style,
    /// How, if at all.
    pub maybe: Option<Style>,
    /// Where.
    #[schemars(extend("x-unit" = "km"))]
    pub at_km: Option<[f64; 2]>,
    /// A line.
    #[schemars(length(min = 1))]
    pub points_km: Vec<[f64; 2]>,
    /// Own lumps.
    pub lump: Vec<Lump>,
    /// A picture.
    #[schemars(extend("x-path" = true))]
    pub map: Option<String>,
}

/// A choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Style {
    /// One way.
    #[default]
    Plain,
    /// Another.
    Fancy,
}

/// A table in a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lump {
    /// Where.
    pub at_km: [f64; 2],
    /// How high.
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("x-unit" = "m"))]
    pub height_m: f64,
}

impl Default for ProbeParams {
    fn default() -> Self {
        Self {
            height_m: 100.0,
            share: None,
            count: 3,
            style: Style::Plain,
            maybe: None,
            at_km: None,
            points_km: vec![[0.0, 0.0]],
            lump: Vec::new(),
            map: None,
        }
    }
}

impl Shape for ProbeParams {
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        // The random part shows which key the stage was given.
        let height = self.height_m + context.key.stream().unit();
        Ok(Field::filled(ground.grid, height as f32))
    }
}

/// A stage of many steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DripParams {
    /// Steps, a year each.
    pub count: u32,
    /// The step that yields a value that is no number.
    pub break_at: Option<u32>,
    /// Whether it steps in turn with the plates.
    pub coupled: bool,
}

impl Default for DripParams {
    fn default() -> Self {
        Self { count: 4, break_at: None, coupled: false }
    }
}

impl DripParams {
    /// The process.
    pub fn process(self, setting: Setting) -> Result<Box<dyn Process>, ProcessError> {
        let count = setting.steps.unwrap_or(u64::from(self.count));
        if count == 0 {
            return Err(ProcessError::Unfit("a drip needs a step".into()));
        }
        Ok(Box::new(Drip { params: self, count, done: 0 }))
    }
}

struct Drip {
    params: DripParams,
    count: u64,
    done: u64,
}

impl Process for Drip {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Sediment]
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        self.done += 1;
        let broken = self.params.break_at.map(u64::from) == Some(self.done);
        let sediment = world.layer_mut(Layer::Sediment);
        sediment.data.iter_mut().for_each(|v| *v += 1.0);
        if broken {
            sediment.data[3] = f32::NAN;
        }
        let area_m2 = world.grid.cell_area_m2() * world.grid.cells() as f64;
        world.ledger.book_in(context.stage, Matter::Rock, area_m2);
        Ok(Step { done: self.done as f64 / self.count as f64, elapsed_yr: 1.0 })
    }

    fn follow(&mut self, world: &mut World, context: &Context, span_yr: f64) -> Result<(), ProcessError> {
        // Lays down 30 m in a million years in the west and nothing in the east.
        let before = world.rock_m3();
        let (width, depth) = (world.grid.width, (span_yr * 30e-6) as f32);
        let sediment = world.layer_mut(Layer::Sediment);
        crate::grid::for_each_row(&mut sediment.data, width, |_, row| {
            row[..width / 2].iter_mut().for_each(|v| *v += depth);
        });
        self.done += 1;
        let laid = world.rock_m3() - before;
        world.ledger.book_in(context.stage, Matter::Rock, laid);
        Ok(())
    }

    fn save(&self) -> State {
        State { fields: Vec::new(), blob: self.done.to_le_bytes().to_vec() }
    }

    fn restore(&mut self, state: State, _context: &Context) -> Result<(), ProcessError> {
        let bytes = state.blob.try_into().map_err(|_| ProcessError::Failed("not a drip's state".into()))?;
        self.done = u64::from_le_bytes(bytes);
        Ok(())
    }
}
