//! The stage: the heights of all volcanoes in one step, and their vents.

use super::{
    params::{Place, VolcanoParams},
    place::Site,
    surface::{Edifice, Edifices},
};
use crate::{
    grid::{Field, Grid, for_each_row},
    process::{Context, Placement, Process, ProcessError, State, Step},
    volcano::off_map_m,
    world::{Layer, Vent, World},
};

/// Vent of a volcano without a crater, in its radius.
const VENT: f64 = 0.01;

impl VolcanoParams {
    /// The stage as a process.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Volcano { params: self, placement })
    }
}

struct Volcano {
    params: VolcanoParams,
    placement: Placement,
}

impl Process for Volcano {
    fn reads(&self) -> &'static [Layer] {
        // A world with plates, also where it has no arc.
        if self.params.place == Place::Arc { &[Layer::PlateId] } else { &[] }
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.params.check(grid)
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let ground = self.placement.over(world)?;
        let site = Site { world, ground: &ground.base, blend: self.placement.blend, key: context.key.named("volcano") };
        let edifices = self.params.edifices(&site)?;
        let vents = vents(&edifices, &world.grid);
        let heights = heights(&Edifices::new(edifices, world.grid.cell_m), world.grid, self.params.foot_m);
        context.check()?;
        ground.put(&heights, world, context);
        world.add_vents(&vents);
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

fn heights(edifices: &Edifices, grid: Grid, foot_m: f64) -> Field<f32> {
    let mut heights = Field::filled(grid, 0.0);
    for_each_row(&mut heights.data, grid.width, |y, row| {
        let mut reader = edifices.reader();
        for (x, height) in row.iter_mut().enumerate() {
            *height = (foot_m + reader.height(grid.center_m(x, y))) as f32;
        }
    });
    heights
}

/// The vents on the map.
fn vents(edifices: &[Edifice], grid: &Grid) -> Vec<Vent> {
    let on_map = edifices.iter().filter(|edifice| off_map_m(edifice.at_m, grid) == 0.0);
    let vent = |edifice: &Edifice| {
        let radius_m = edifice.cone.crater_radius_m.max(VENT * edifice.cone.radius_m);
        Vent { at_m: edifice.at_m, radius_m, age_yr: edifice.age_yr }
    };
    on_map.map(vent).collect()
}
