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
        Box::new(Climate { params: self, placement })
    }
}

struct Climate {
    params: ClimateParams,
    placement: Placement,
}

impl Climate {
    fn weather(&self, world: &World) -> Result<Weather, ProcessError> {
        let share = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        Ok(Weather::over(&world.height(), world.sea_level_m, &self.params, share.as_ref()))
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
        let weather = self.weather(world)?;
        context.check()?;
        show(weather, world);
        Ok(Step::WHOLE)
    }

    fn follow(&mut self, world: &mut World, _context: &Context, _span_yr: f64) -> Result<(), ProcessError> {
        show(self.weather(world)?, world);
        Ok(())
    }

    fn publish(&mut self, world: &mut World, _context: &Context) -> Result<(), ProcessError> {
        // Those it steps in turn with have changed the ground since.
        if self.params.coupled {
            show(self.weather(world)?, world);
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
