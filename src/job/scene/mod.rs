//! What is asked of a scene, and stills of it. Without the feature `render` a scene is refused in a line.

mod request;
#[cfg(feature = "render")]
mod still;
mod view;

pub use request::{CameraChoice, SceneRequest, TIMES_H};
pub(crate) use view::View;

use super::{JobError, Picture};
use crate::scene::{Movement, SceneParams, Surround};

/// Whether this build draws scenes.
pub(crate) fn check_build() -> Result<(), JobError> {
    if cfg!(feature = "render") {
        return Ok(());
    }
    let what = "--view scene: this build draws no scenes; build it with the feature 'render' (cargo build --release \
                --features render)";
    Err(JobError::Refused(what.to_owned()))
}

/// Draws a still.
#[cfg(feature = "render")]
pub(super) fn still(
    picture: &Picture,
    world: &crate::world::World,
    provenance: &crate::world::store::Provenance,
    drape: Option<crate::relief::View>,
) -> Result<image::RgbImage, JobError> {
    still::draw(picture, world, provenance, drape)
}

/// Draws a still.
#[cfg(not(feature = "render"))]
pub(super) fn still(
    _: &Picture,
    _: &crate::world::World,
    _: &crate::world::store::Provenance,
    _: Option<crate::relief::View>,
) -> Result<image::RgbImage, JobError> {
    check_build().and(Err(JobError::Refused("no scenes".to_owned())))
}

/// How far away the whole block is seen, in longer sides of the map.
const WHOLE_SIDES: f64 = 1.9;

/// Takes out of a scene what would hide a map's colours: the sea's floor and the beds of lakes have some, too.
pub(crate) fn dry(scene: &mut SceneParams) {
    (scene.water.sea, scene.water.inland) = (false, false);
    (scene.lava.on, scene.smoke.on, scene.fog.on) = (false, false, false);
    scene.surround = Surround::Block;
    if scene.camera.movement == Movement::Orbit && scene.camera.keys.is_empty() {
        scene.camera.distance.get_or_insert(WHOLE_SIDES);
    }
}
