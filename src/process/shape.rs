//! Base shapes: parameters that become heights in one go, and the process that lays them into the bedrock and books it.

use super::{Context, Placement, Process, ProcessError, State, Step};
use crate::{
    grid::{Field, Grid},
    world::{Layer, World},
};

/// A base shape: parameters that become heights in one go.
pub trait Shape: Send + 'static {
    /// Layers that must be there before.
    const READS: &'static [Layer] = &[];

    /// Whether the parameters go together with a map of this grid.
    fn fit(&self, _grid: &Grid) -> Result<(), ProcessError> {
        Ok(())
    }

    /// The shape's heights over the map, m. `ground` is the bedrock as it stands; only shapes that rework it look at more
    /// than its grid.
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError>;

    /// The process that puts these heights into a world.
    fn process(self, placement: Placement) -> Box<dyn Process>
    where
        Self: Sized,
    {
        Box::new(Shaping { shape: self, placement })
    }
}

struct Shaping<S> {
    shape: S,
    placement: Placement,
}

impl<S: Shape> Process for Shaping<S> {
    fn reads(&self) -> &'static [Layer] {
        S::READS
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.shape.fit(grid)
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let ground = self.placement.over(world)?;
        let heights = self.shape.heights(&ground.base, context)?;
        context.check()?;
        ground.put(&heights, world, context);
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}
