//! The stage `thermal`.

use super::{Thermal, ThermalParams};
use crate::{
    erosion::{
        bed::Bed,
        stage::{FamilyParams, Lock, Stage},
        weathering::pace,
    },
    grid::Grid,
    noise::Key,
    process::{Placement, Process, ProcessError},
    world::{Layer, World},
};

/// Passes beyond which a run would take days.
const MOST_PASSES: f64 = 1e6;

impl ThermalParams {
    /// The stage as a process; `steps` asks for that many.
    pub fn process(self, placement: Placement, steps: Option<u64>) -> Box<dyn Process> {
        Box::new(Stage::new(self, placement, steps))
    }
}

impl FamilyParams for ThermalParams {
    type Solver = Thermal;
    const WRITES: &'static [Layer] = &[Layer::Bedrock, Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit];
    const WATER: bool = false;
    const STEPS: u64 = 50;

    fn lock(&self) -> Lock {
        self.lock
    }

    fn weathers(&self) -> bool {
        self.weathering
    }

    fn duration_yr(&self) -> f64 {
        self.duration_yr
    }

    fn check(&self, _grid: &Grid) -> Result<(), String> {
        let passes = self.rate_per_yr * self.duration_yr / self.most();
        if passes > MOST_PASSES {
            return Err(format!(
                "{passes:.1e} passes over the map would take days; lower duration_yr or rate_per_yr (their product may be {:.1e})",
                MOST_PASSES * self.most()
            ));
        }
        Ok(())
    }

    fn remarks(&self, _grid: &Grid) -> Vec<String> {
        let idle = self.coarse_levels > 0 && self.lock == Lock::Coast;
        idle.then(|| {
            "coarse_levels does nothing with lock = \"coast\": cells on a coast are not taken together".to_owned()
        })
        .into_iter()
        .collect()
    }

    fn solver(&self, bed: &Bed, world: &World, _key: Key) -> Result<Thermal, ProcessError> {
        let loose = world.layer(Layer::Sediment).map_or_else(|| vec![0.0; bed.start.len()], |s| s.data.clone());
        let most = self.weathering.then(|| pace(world)).flatten().map_or(1.0, |pace| pace.most);
        Ok(Thermal::new(Self { rate_per_yr: self.rate_per_yr * most, ..self.clone() }, bed, loose))
    }
}
