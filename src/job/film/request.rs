//! What is asked of a film, and whether it can be done.

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use super::{
    HOLD_S,
    pace::{Clip, clips},
    range::{EARTH_M, range_over_sea, trial},
};
use crate::{
    export::video::{Encoder, Format, Rate, Settings},
    job::{
        JobError, picture,
        scene::{self, SceneRequest, View},
    },
    recipe::Plan,
    relief::{self, CLIMATE, film},
    scene::SceneParams,
    world::{Layer, World},
};

/// A film as it is asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilmRequest {
    /// The film; one in the world's folder where there is no name.
    pub file: Option<PathBuf>,
    /// Frames a second; the format's usual ones where absent.
    pub rate: Option<Rate>,
    /// Width and height, pixels; the format's usual ones where absent.
    pub size: Option<[usize; 2]>,
    /// `relief`, a layer's name, `scene`, or `scene:` and one of the former.
    pub view: String,
    /// Whether the time is shown.
    pub clock: bool,
    /// Whether smoke is drawn over the relief where vents erupt.
    pub smoke: bool,
    /// What ffmpeg is told besides.
    pub ffmpeg_args: Vec<String>,
    /// What flags say of the scene.
    pub scene: SceneRequest,
    /// Length of a film of the finished world, s, instead of one of its growth.
    pub seconds: Option<f64>,
    /// Whether it takes the place of a film that is there.
    pub replace: bool,
}

/// A film that can be made.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmPlan {
    /// Where it is put; a bare name belongs to the world's folder.
    pub file: PathBuf,
    /// Whether it belongs to the world's folder.
    pub in_folder: bool,
    pub(super) encoding: Settings,
    pub(super) animation: film::Options,
    /// The scene, where it is none of maps.
    pub(super) scene: Option<SceneFilm>,
    pub(super) clips: Vec<Clip>,
    pub(super) clock: bool,
}

/// A film of scenes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SceneFilm {
    pub scene: SceneParams,
    /// The scene as the last world settles what it leaves to worlds, and the extent of that world's map, m.
    pub settled: Option<([f64; 2], SceneParams)>,
    /// The map whose colours lie over the land.
    pub drape: Option<relief::View>,
}

impl FilmPlan {
    /// Checks a request against the recipe, up to the stage of place `until`. Finds how high the land will be, for which
    /// a small trial may run.
    pub fn new(
        request: &FilmRequest,
        plan: &Plan,
        until: Option<usize>,
        cancel: &AtomicBool,
    ) -> Result<Self, JobError> {
        let (mut planned, view) = Self::of(request, &plan.title, request.scene.of_recipe(&plan.scene)?)?;
        let made = made(plan, until)?;
        if let Some(layer) = view.layer() {
            check_layer(&made, layer)?;
        }
        if planned.scene.is_some()
            && let Some(last) = trial(plan, until, cancel)?
        {
            planned.settle(&last);
        }
        planned.animation.climate = CLIMATE.iter().all(|layer| made.contains(layer));
        planned.animation.range_m = range_over_sea(plan, until, cancel)?;
        planned.clips = clips(plan, until, planned.encoding.rate.per_second());
        Ok(planned)
    }

    /// What a request says by itself: no clip yet, and no range.
    pub(super) fn of(request: &FilmRequest, title: &str, scene: SceneParams) -> Result<(Self, View), JobError> {
        let file = match &request.file {
            Some(file) => file.clone(),
            // Smaller, but there.
            None if !Encoder::has_ffmpeg() => PathBuf::from("film.png"),
            None => PathBuf::from("film.mp4"),
        };
        let format = Format::of(&file)?;
        let size = format.fit(request.size.unwrap_or(format.usual_size()));
        let rate = request.rate.unwrap_or(format.usual_rate());
        format.check(rate, request.size.unwrap_or(size))?;
        if request.file.is_some() {
            check_place(&file, format, request.replace)?;
        }
        let view = View::parse(&request.view)?;
        let scene = match view {
            View::Map(_) => request.scene.refuse_for_maps().map(|()| None)?,
            View::Scene(drape) => {
                scene::check_build()?;
                Some(SceneFilm { scene: quiet(scene, request, drape), settled: None, drape })
            }
        };
        let ffmpeg_args = request.ffmpeg_args.clone();
        let animation = film::Options {
            size,
            view: view.map().unwrap_or_default(),
            range_m: EARTH_M,
            climate: false,
            smoke: request.smoke,
            title: Some(title.to_owned()),
        };
        let planned = Self {
            in_folder: request.file.is_none(),
            encoding: Settings { format, size, rate, hold_s: HOLD_S, ffmpeg_args },
            animation,
            scene,
            clips: Vec::new(),
            clock: request.clock,
            file,
        };
        Ok((planned, view))
    }

    /// Settles what a scene leaves to worlds by the one that it is to end with, so that all its pictures are drawn alike.
    #[cfg_attr(not(feature = "render"), expect(unused_variables, reason = "this build draws no scenes"))]
    pub(super) fn settle(&mut self, last: &World) {
        #[cfg(feature = "render")]
        if let Some(film) = &mut self.scene {
            film.settled = Some((last.grid.extent_m(), crate::render::settled(last, &film.scene)));
        }
    }

    /// The same film in a folder.
    pub fn within(mut self, folder: &Path) -> Self {
        if self.in_folder {
            self.file = folder.join(self.file);
        }
        self
    }
}

/// The scene without what is not to be seen.
fn quiet(mut scene: SceneParams, request: &FilmRequest, drape: Option<relief::View>) -> SceneParams {
    scene.smoke.on &= request.smoke;
    if drape.is_some() {
        scene::dry(&mut scene);
    }
    scene
}

/// Refuses early what could not be written at the end.
fn check_place(file: &Path, format: Format, replace: bool) -> Result<(), JobError> {
    if !format.numbered() {
        picture::check_place(file)?;
        if !replace && file.exists() {
            let shown = file.display();
            return Err(JobError::Refused(format!("{shown}: exists; choose another name, or replace it with --force")));
        }
    }
    if format.needs_ffmpeg() && !Encoder::has_ffmpeg() {
        return Err(JobError::Refused(format!(
            "{}: this film needs ffmpeg, which is not installed (Debian, Ubuntu: apt install ffmpeg; macOS: brew install \
             ffmpeg; Windows: winget install ffmpeg); a film.png needs none",
            file.display()
        )));
    }
    Ok(())
}

/// The layers that the stages make.
pub(crate) fn made(plan: &Plan, until: Option<usize>) -> Result<Vec<Layer>, JobError> {
    let mut made: Vec<Layer> = Vec::new();
    let running = plan.running().filter(|(i, _)| until.is_none_or(|end| *i <= end));
    for stage in running.flat_map(|(_, stage)| std::iter::once(stage).chain(&stage.coupled)) {
        let process = stage.build().map_err(|e| JobError::Refused(e.to_string()))?;
        made.extend(process.writes());
    }
    Ok(made)
}

/// Refuses a layer that no stage makes.
fn check_layer(made: &[Layer], layer: Layer) -> Result<(), JobError> {
    if layer.derived() || made.contains(&layer) {
        return Ok(());
    }
    let names: Vec<_> = Layer::ALL.iter().filter(|l| l.derived() || made.contains(l)).map(|l| l.name()).collect();
    let what = format!(
        "--view {}: no stage of this recipe makes that layer (it has: relief, {})",
        layer.name(),
        names.join(", ")
    );
    Err(JobError::Refused(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::{Overrides, find_preset};

    #[test]
    fn stages_that_step_in_turn_make_their_layers_too() {
        let plan = Plan::new(&find_preset("collision").unwrap().source(), &Overrides::default()).unwrap();
        let made = made(&plan, None).unwrap();
        assert!(CLIMATE.iter().chain(&[Layer::PlateId, Layer::Wear]).all(|layer| made.contains(layer)), "{made:?}");
        assert!(!made.contains(&Layer::Hardness));
    }
}
