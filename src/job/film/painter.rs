//! Who draws a film's pictures: the map's painter, or that of scenes.

#[cfg(feature = "render")]
use super::scene::{ScenePainter, SceneShot};
use super::{FilmPlan, JobError};
use crate::{
    grid::Grid,
    relief::film::{Animation, Options, Shot as MapShot, Words},
    world::World,
};

/// Draws pictures between two moments of a world.
pub(super) enum Painter {
    Map(Box<MapPainter>),
    #[cfg(feature = "render")]
    Scene(Box<ScenePainter>),
}

/// What a film keeps of a moment.
#[derive(Clone)]
pub(super) enum Shot {
    Map(Box<MapShot>),
    #[cfg(feature = "render")]
    Scene(std::sync::Arc<SceneShot>),
}

/// Where a picture stands in its film.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(feature = "render"), expect(dead_code, reason = "maps do not move"))]
pub(super) struct Stand {
    /// Share of the film that is over.
    pub share: f64,
    /// Seconds since it began.
    pub seconds: f64,
}

/// Draws maps.
pub(super) struct MapPainter {
    animation: Animation,
    options: Options,
}

impl Painter {
    pub fn new(plan: &FilmPlan, grid: Grid) -> Result<Self, JobError> {
        #[cfg(feature = "render")]
        if let Some(scene) = &plan.scene {
            return Ok(Painter::Scene(Box::new(ScenePainter::new(scene, &plan.animation, plan.clock)?)));
        }
        let options = plan.animation.clone();
        Ok(Painter::Map(Box::new(MapPainter { animation: Animation::new(grid, &options), options })))
    }

    /// Goes over to worlds on another grid.
    pub fn regrid(&mut self, grid: Grid) {
        match self {
            Painter::Map(map) => map.animation = Animation::new(grid, &map.options),
            // Each shot has its own grid.
            #[cfg(feature = "render")]
            Painter::Scene(_) => {}
        }
    }

    /// Whether pictures need no more of a world than its ground and its weather.
    pub fn shows_ground_alone(&self) -> bool {
        match self {
            Painter::Map(map) => map.options.shows_ground_alone(),
            #[cfg(feature = "render")]
            Painter::Scene(_) => false,
        }
    }

    pub fn shot(&mut self, world: &World) -> Result<Shot, JobError> {
        Ok(match self {
            Painter::Map(map) => Shot::Map(Box::new(map.animation.shot(world)?)),
            #[cfg(feature = "render")]
            Painter::Scene(scene) => Shot::Scene(std::sync::Arc::new(scene.shot(world)?)),
        })
    }

    /// Draws the picture at `share` of the way between two shots.
    #[cfg_attr(not(feature = "render"), expect(unused_variables, reason = "maps do not move"))]
    pub fn draw(
        &mut self,
        shots: [&Shot; 2],
        share: f32,
        stand: Stand,
        words: Words,
        picture: &mut [u8],
    ) -> Result<(), JobError> {
        match (self, shots) {
            (Painter::Map(map), [Shot::Map(from), Shot::Map(to)]) => {
                map.animation.draw([from, to], share, words, picture);
                Ok(())
            }
            #[cfg(feature = "render")]
            (Painter::Scene(scene), [Shot::Scene(from), Shot::Scene(to)]) => {
                scene.draw([from, to], share, stand, words, picture)
            }
            // A painter is given its own shots.
            #[cfg(feature = "render")]
            _ => Ok(()),
        }
    }
}

impl Shot {
    /// Years since the recipe began.
    pub fn time_yr(&self) -> f64 {
        match self {
            Shot::Map(shot) => shot.time_yr(),
            #[cfg(feature = "render")]
            Shot::Scene(shot) => shot.world.time_yr,
        }
    }

    /// The flat ground before the first stage.
    pub fn before(&self) -> Self {
        match self {
            Shot::Map(shot) => Shot::Map(Box::new(shot.before())),
            #[cfg(feature = "render")]
            Shot::Scene(shot) => Shot::Scene(std::sync::Arc::new(shot.before())),
        }
    }
}
