//! What flags change in a scene.

use std::path::PathBuf;

use crate::{
    job::JobError,
    recipe::{Source, read_camera, read_scene},
    scene::{CameraParams, Movement, Quality, SceneParams},
    world::store::Provenance,
};

/// Hours that a day may begin and end at.
pub const TIMES_H: [f64; 2] = [48.0, 72.0];

/// Which camera.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraChoice {
    /// One that moves so, and is else as usual.
    Movement(Movement),
    /// One that a file describes.
    File(PathBuf),
}

/// What is asked of a scene besides its recipe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneRequest {
    /// A file whose scene takes the place of the recipe's.
    pub file: Option<PathBuf>,
    /// `scene.PARAM=VALUE` texts.
    pub set: Vec<String>,
    /// Another camera than the scene's.
    pub camera: Option<CameraChoice>,
    /// Time of day at the beginning, and at the end of a film.
    pub time_of_day_h: Option<(f64, Option<f64>)>,
    /// How carefully it is drawn.
    pub quality: Option<Quality>,
    /// Width and height of a still, pixels.
    pub size: Option<[u32; 2]>,
}

impl SceneRequest {
    /// The first flag that was given.
    pub fn flag(&self) -> Option<&'static str> {
        let given = [
            ("--scene", self.file.is_some()),
            ("--set", !self.set.is_empty()),
            ("--camera", self.camera.is_some()),
            ("--time-of-day", self.time_of_day_h.is_some()),
            ("--quality", self.quality.is_some()),
            ("--size", self.size.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(flag, _)| flag)
    }

    /// Refuses what says nothing about a map.
    pub fn refuse_for_maps(&self) -> Result<(), JobError> {
        match self.flag() {
            Some(flag) => Err(JobError::Refused(format!("{flag} is about scenes; ask for one with --view scene"))),
            None => Ok(()),
        }
    }

    /// The scene of a world that was grown before.
    pub fn of_world(&self, provenance: &Provenance) -> Result<SceneParams, JobError> {
        let source = match &self.file {
            Some(file) => Source::read(file)?,
            None => Source {
                name: provenance.name.clone(),
                file: format!("recipe of {}", provenance.name),
                folder: PathBuf::new(),
                text: provenance.recipe.clone(),
            },
        };
        self.over(read_scene(&source, &self.set)?)
    }

    /// The scene of a recipe that is about to run, whose own flags are in it.
    pub fn of_recipe(&self, scene: &SceneParams) -> Result<SceneParams, JobError> {
        let scene = match &self.file {
            Some(file) => read_scene(&Source::read(file)?, &[])?,
            None => scene.clone(),
        };
        self.over(scene)
    }

    fn over(&self, mut scene: SceneParams) -> Result<SceneParams, JobError> {
        match &self.camera {
            Some(CameraChoice::Movement(movement)) => {
                // The target and the lens stay the scene's; the rest is as usual for this movement.
                let CameraParams { target_km, turn_deg, .. } = scene.camera;
                scene.camera = CameraParams { movement: *movement, target_km, turn_deg, ..CameraParams::default() };
            }
            Some(CameraChoice::File(file)) => scene.camera = read_camera(file)?,
            None => {}
        }
        if let Some((from, to)) = self.time_of_day_h {
            let sun = &mut scene.sun;
            (sun.time_of_day_h, sun.to_time_of_day_h) = (from, to);
            (sun.azimuth_deg, sun.altitude_deg) = (None, None);
        }
        scene.quality = self.quality.or(scene.quality);
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_laid_over_the_scene() {
        let mut scene = SceneParams::default();
        scene.camera.target_km = Some([3.0, 4.0]);
        scene.camera.distance = Some(9.0);
        scene.sun.azimuth_deg = Some(10.0);
        let request = SceneRequest {
            camera: Some(CameraChoice::Movement(Movement::Top)),
            time_of_day_h: Some((5.0, Some(21.0))),
            quality: Some(Quality::Draft),
            ..SceneRequest::default()
        };
        let made = request.of_recipe(&scene).unwrap();
        assert_eq!((made.camera.movement, made.camera.target_km), (Movement::Top, Some([3.0, 4.0])));
        assert_eq!((made.camera.distance, made.sun.azimuth_deg), (None, None));
        assert_eq!((made.sun.time_of_day_h, made.sun.to_time_of_day_h), (5.0, Some(21.0)));
        assert_eq!(made.quality, Some(Quality::Draft));
        assert_eq!((request.flag(), SceneRequest::default().flag()), (Some("--camera"), None));
    }
}
