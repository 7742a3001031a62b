//! Weather: wind, rain, temperature and the snow line. Writes layers; carves nothing.
//!
//! The stage `climate` takes no time: it looks at the ground and says what weather a year brings on the mean. Coupled to
//! the plates it looks again after each of their steps, so that ranges stand in the rain they make.
//!
//! | file | owns |
//! |---|---|
//! | `params` | what a recipe can say |
//! | `zones` | what latitude alone decides: wind, warmth, how readily it rains |
//! | `air` | moisture carried over the land by one wind, and the water it loses |
//! | `weather` | the rain of several winds, brought to the map |
//! | `water` | how warm, how high the snow lies, what runs off |
//! | `biome` | what grows |
//!
//! Air has a raster of its own ([`CELLS`] on the longer side), so that a map has the same weather at every size.

mod air;
mod biome;
mod params;
#[cfg(test)]
mod tests;
mod water;
mod weather;
mod zones;

pub use air::Budget;
pub use biome::Biome;
pub use params::ClimateParams;
pub use water::{runoff_mm_per_yr, snow_temperature_degc};
pub use weather::{CELLS, Weather};
pub use zones::Zone;

use crate::{
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, World},
};

impl ClimateParams {
    /// The stage as a process.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Climate { params: self, placement, dry: false })
    }
}

struct Climate {
    params: ClimateParams,
    placement: Placement,
    /// Whether no rain fell when it last looked.
    dry: bool,
}

impl Climate {
    /// Looks at the ground and writes what weather it has.
    fn look(&mut self, world: &mut World) -> Result<(), ProcessError> {
        let share = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let weather = Weather::over(&world.height(), world.sea_level_m, &self.params, share.as_ref());
        let asked = self.params.rain_mm_per_yr.is_some() || self.placement.mask.is_some();
        self.dry = !asked && weather.rain_mm_per_yr.data.iter().all(|&rain| rain <= 0.0);
        show(weather, world);
        Ok(())
    }
}

fn show(weather: Weather, world: &mut World) {
    world.set_layer(Layer::Rain, weather.rain_mm_per_yr);
    world.set_layer(Layer::Runoff, weather.runoff_mm_per_yr);
    world.set_layer(Layer::Temperature, weather.temperature_degc);
    world.set_layer(Layer::SnowLine, weather.snow_line_m);
    world.set_layer(Layer::Biome, weather.biome);
}

impl Process for Climate {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Rain, Layer::Runoff, Layer::Temperature, Layer::SnowLine, Layer::Biome]
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        self.look(world)?;
        context.check()?;
        Ok(Step::WHOLE)
    }

    fn findings(&self) -> Vec<String> {
        let why = "no rain falls: there is no sea, and no rim over which moist air comes in";
        let dry = self.dry.then(|| format!("{why}; set rain_mm_per_yr if it is to rain all the same"));
        dry.into_iter().collect()
    }

    fn follow(&mut self, world: &mut World, _context: &Context, _span_yr: f64) -> Result<(), ProcessError> {
        self.look(world)
    }

    fn publish(&mut self, world: &mut World, _context: &Context) -> Result<(), ProcessError> {
        // Those it steps in turn with have changed the ground since.
        if self.params.coupled {
            self.look(world)?;
        }
        Ok(())
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}
