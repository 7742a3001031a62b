//! The stage `uplift`: how fast rock is being raised, where, and how that changes in time.
//!
//! It takes no time and moves nothing: it sets the layer `uplift`, and the table `uplift_steps` where the rate changes.
//! Stages that raise the ground read both.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::region::{Outline, Region};
use crate::{
    grid::{Field, Grid},
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, Mask, World},
};

/// The speed at which rock is raised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct UpliftParams {
    /// Where: everywhere alike, in a block, or as bright as a picture.
    #[schemars(extend("x-effect" = "uniform: all of the map; block: a rectangle or disc; image: white rises, black does not"))]
    pub shape: UpliftShape,
    /// The rate, inside the block or where the picture is white; below 0 the ground sinks.
    #[schemars(range(min = -20.0, max = 20.0), extend("x-unit" = "mm/yr", "x-effect" = "faster uplift, higher and steeper land"))]
    pub mm_per_yr: f64,
    /// The rate outside the block, or where the picture is black.
    #[schemars(range(min = -20.0, max = 20.0), extend("x-unit" = "mm/yr", "x-effect" = "the surroundings rise too"))]
    pub outside_mm_per_yr: f64,
    /// What a block looks like from above.
    #[schemars(extend("x-effect" = "rectangle or disc"))]
    pub outline: Outline,
    /// Middle of a block, east and south of the map's north-west corner; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves the block east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Lengths of a block's sides, or diameters of a disc; half of the map's if not given.
    #[schemars(inner(range(min = 0.001, max = 100000.0)), extend("x-unit" = "km", "x-effect" = "a larger block"))]
    pub size_km: Option<[f64; 2]>,
    /// Turn of a block, clockwise.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the block clockwise"))]
    pub angle_deg: f64,
    /// Width of a block's edge, over which the rate fades; 0 is a fault.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "km", "x-effect" = "a softer edge"))]
    pub edge_km: f64,
    /// The picture, stretched over the map.
    #[schemars(extend("x-path" = true, "x-effect" = "draws the rate"))]
    pub path: Option<String>,
    /// Later rates: from so long after this stage on, what `mm_per_yr` is then; the rest of the map changes with it.
    #[schemars(extend("x-effect" = "uplift that begins, ends, or changes while the land is carved"))]
    pub change: Vec<UpliftChange>,
    /// Adds to the rates that are there instead of replacing them.
    #[schemars(extend("x-effect" = "several blocks, or a block on what plates raise"))]
    pub add: bool,
}

/// Where the ground rises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum UpliftShape {
    /// Everywhere alike.
    #[default]
    Uniform,
    /// A rectangle or a disc.
    Block,
    /// By the brightness of a picture.
    Image,
}

/// A change of the rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UpliftChange {
    /// When, after this stage.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "My"))]
    pub from_myr: f64,
    /// The rate from then on.
    #[schemars(range(min = -20.0, max = 20.0), extend("x-unit" = "mm/yr"))]
    pub mm_per_yr: f64,
}

impl Default for UpliftParams {
    fn default() -> Self {
        Self {
            shape: UpliftShape::Uniform,
            mm_per_yr: 0.5,
            outside_mm_per_yr: 0.0,
            outline: Outline::Rectangle,
            at_km: None,
            size_km: None,
            angle_deg: 0.0,
            edge_km: 0.0,
            path: None,
            change: Vec::new(),
            add: false,
        }
    }
}

impl UpliftParams {
    /// The stage as a process.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Uplift { params: self, placement })
    }

    /// What does not go together.
    fn check(&self) -> Result<(), ProcessError> {
        let unfit = |what: &str| Err(ProcessError::Unfit(what.to_owned()));
        if self.shape == UpliftShape::Image && self.path.is_none() {
            return unfit("shape = \"image\" needs a picture: path = \"FILE.png\"");
        }
        if self.add && !self.change.is_empty() {
            return unfit("'change' is for all of the map's uplift; give it to the stage that does not 'add'");
        }
        if !self.change.is_sorted_by(|a, b| a.from_myr < b.from_myr) {
            return unfit("'change' must be in order of time, each from_myr later than the one before");
        }
        Ok(())
    }

    /// The rate that the layer holds, and the factors on it from each moment after the stage, years: the strongest rate there
    /// ever is, so that a rise may begin or end with none.
    fn in_time(&self) -> (f64, Vec<(f64, f64)>) {
        let strongest = self
            .change
            .iter()
            .map(|change| change.mm_per_yr)
            .fold(self.mm_per_yr, |most, rate| if rate.abs() > most.abs() { rate } else { most });
        if self.change.is_empty() || strongest == 0.0 {
            return (self.mm_per_yr, Vec::new());
        }
        let later = self.change.iter().map(|change| (change.from_myr * 1e6, change.mm_per_yr / strongest));
        (strongest, std::iter::once((0.0, self.mm_per_yr / strongest)).chain(later).collect())
    }

    /// How much of each cell lies within the shape.
    fn shares(&self, world: &World) -> Result<Field<f32>, ProcessError> {
        let grid: Grid = world.grid;
        Ok(match (self.shape, &self.path) {
            (UpliftShape::Image, Some(path)) => Mask::Image(PathBuf::from(path)).evaluate(world)?,
            (UpliftShape::Block, _) => {
                let (place, form) = ((self.at_km, self.size_km), (self.angle_deg, self.edge_km));
                let region = Region::new(self.outline, place, form, &grid);
                Field::from_fn(grid, |x, y| region.share(grid.center_m(x, y)) as f32)
            }
            _ => Field::filled(grid, 1.0),
        })
    }
}

struct Uplift {
    params: UpliftParams,
    placement: Placement,
}

impl Process for Uplift {
    fn writes(&self) -> &'static [Layer] {
        &[Layer::Uplift]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.params.check()?;
        if self.params.shape == UpliftShape::Image {
            // Whether the picture can be read does not depend on the world.
            self.params.shares(&World::new(Grid { width: 1, height: 1, ..*grid }, 0.0))?;
        }
        Ok(())
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        self.params.check()?;
        let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let shares = self.params.shares(world)?;
        context.check()?;
        let (rate, steps) = self.params.in_time();
        let outside = self.params.outside_mm_per_yr;
        let width = world.grid.width;
        let uplift = world.layer_mut(Layer::Uplift);
        crate::grid::for_each_row(&mut uplift.data, width, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                let new = (outside + (rate - outside) * shares.at(x, y) as f64) as f32;
                let share = mask.as_ref().map_or(1.0, |mask| mask.at(x, y));
                *value += if self.params.add { new * share } else { (new - *value) * share };
            }
        });
        if !self.params.add {
            let began_yr = world.time_yr;
            let steps: Vec<(f64, f64)> =
                steps.iter().map(|&(after_yr, factor)| (began_yr + after_yr, factor)).collect();
            world.set_uplift_steps(&steps);
        }
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::grid::Edges;

    fn run(world: &mut World, params: UpliftParams) -> Result<(), ProcessError> {
        let stay = AtomicBool::new(false);
        params.process(Placement::default()).step(world, &Context::new(1, "uplift#1", &stay)).map(|_| ())
    }

    #[test]
    fn a_rate_may_begin_with_none_and_change() {
        let mut world = World::new(Grid::new(4, 4, 4e3, Edges::Open), 0.0);
        world.time_yr = 2e6;
        let change = |from_myr: f64, mm_per_yr: f64| UpliftChange { from_myr, mm_per_yr };
        let change = vec![change(1.0, 2.0), change(3.0, -0.5)];
        run(&mut world, UpliftParams { mm_per_yr: 0.0, change, ..Default::default() }).unwrap();
        let rate = |world: &World, myr: f64| {
            world.layer(Layer::Uplift).unwrap().at(1, 1) as f64 * world.uplift_factor(myr * 1e6, myr * 1e6)
        };
        assert_eq!([2.0, 2.9, 3.0, 4.9, 5.0, 9.0].map(|myr| rate(&world, myr)), [0.0, 0.0, 2.0, 2.0, -0.5, -0.5]);
        run(&mut world, UpliftParams::default()).unwrap();
        assert_eq!(rate(&world, 3.0), 0.5);
    }

    #[test]
    fn blocks_add_up() {
        let mut world = World::new(Grid::new(8, 8, 8e3, Edges::Open), 0.0);
        run(&mut world, UpliftParams::default()).unwrap();
        let block = UpliftParams { shape: UpliftShape::Block, mm_per_yr: 1.0, add: true, ..Default::default() };
        run(&mut world, block).unwrap();
        let uplift = world.layer(Layer::Uplift).unwrap();
        assert_eq!([uplift.at(0, 0), uplift.at(4, 4), uplift.at(2, 5), uplift.at(1, 4)], [0.5, 1.5, 1.5, 0.5]);
    }

    #[test]
    fn what_contradicts_itself_is_refused() {
        let change = |from_myr: f64| UpliftChange { from_myr, mm_per_yr: 1.0 };
        let bad = [
            UpliftParams { shape: UpliftShape::Image, ..Default::default() },
            UpliftParams { add: true, change: vec![change(1.0)], ..Default::default() },
            UpliftParams { change: vec![change(2.0), change(1.0)], ..Default::default() },
        ];
        let mut world = World::new(Grid::new(4, 4, 4e3, Edges::Open), 0.0);
        for params in bad {
            assert!(matches!(run(&mut world, params), Err(ProcessError::Unfit(_))));
        }
        assert!(world.layer(Layer::Uplift).is_none());
    }
}
