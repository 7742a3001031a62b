//! Pictures of scenes for films: the worlds of two shots, what is between them, and the camera on its way.

use std::sync::Arc;

use super::{JobError, between::between, painter::Stand, request::SceneFilm};
use crate::{
    relief::{
        Drape, Margins,
        film::{Options, Words},
    },
    render::{Gpu, Land, Moment, Path, Renderer, settled},
    scene::{Quality, SceneParams},
    world::{Layer, World},
};

/// A moment of a world, whole.
pub(super) struct SceneShot {
    pub world: World,
    drape: Option<Drape>,
}

impl SceneShot {
    /// The flat ground before the first stage: nothing but bedrock, at the height of the sea.
    pub fn before(&self) -> Self {
        let mut world = World::new(self.world.grid, self.world.sea_level_m);
        world.layer_mut(Layer::Bedrock).data.fill(self.world.sea_level_m as f32);
        Self { world, drape: self.drape.clone() }
    }
}

/// Draws scenes.
pub(super) struct ScenePainter {
    renderer: Renderer,
    film: SceneFilm,
    options: Options,
    clock: bool,
    /// The scene as one world settled it, and the extent of that world's map, m.
    scene: Option<([f64; 2], SceneParams)>,
    margins: Option<Margins>,
    /// The land of a shot that is drawn again and again.
    standing: Option<(Arc<SceneShot>, Land)>,
}

impl ScenePainter {
    pub fn new(film: &SceneFilm, options: &Options, clock: bool) -> Result<Self, JobError> {
        Ok(Self {
            renderer: Renderer::new(Gpu::open()?)?,
            scene: film.settled.clone(),
            film: film.clone(),
            options: options.clone(),
            clock,
            margins: None,
            standing: None,
        })
    }

    pub fn shot(&mut self, world: &World) -> Result<SceneShot, JobError> {
        let extent_m = world.grid.extent_m();
        // What one map settles says nothing about a part of it.
        if self.scene.as_ref().is_none_or(|(of, _)| *of != extent_m) {
            self.scene = Some((extent_m, settled(world, &self.film.scene)));
        }
        let draped = |view| Drape::in_film(world, &view, self.options.climate);
        Ok(SceneShot { world: world.clone(), drape: self.film.drape.map(draped).transpose()? })
    }

    pub fn draw(
        &mut self,
        [from, to]: [&Arc<SceneShot>; 2],
        share: f32,
        stand: Stand,
        words: Words,
        picture: &mut [u8],
    ) -> Result<(), JobError> {
        let Some((_, scene)) = &self.scene else { return Ok(()) };
        let same = Arc::ptr_eq(from, to);
        let (shot, mut land) = match self.standing.take() {
            Some((shot, land)) if same && Arc::ptr_eq(&shot, to) => (shot, land),
            _ => (Arc::clone(to), land(&self.renderer, scene, [from, to], share)?),
        };
        let size = self.options.size;
        let margins = self.margins.get_or_insert_with(|| match &to.drape {
            Some(drape) => Margins::beside(size, drape, self.options.title.as_deref()),
            None => Margins::none(size),
        });
        let inner = margins.inner().map(|side| side as u32);
        let camera = Path::new(&scene.camera, land.lie().extent_m, inner).at(stand.share, &land);
        let quality = scene.quality.unwrap_or(Quality::Normal);
        let moment = Moment { size: inner, share: stand.share, seconds: stand.seconds, quality };
        let drawn = self.renderer.picture(&mut land, scene, &camera, &moment)?;
        // A scene is a picture, not a map: only what was asked for is written on it.
        let plain = Words { caption: "", clock: if self.clock { words.clock } else { "" } };
        margins.lay(&drawn, if to.drape.is_some() { words } else { plain }, picture);
        if same {
            self.standing = Some((shot, land));
        }
        Ok(())
    }
}

/// The land at a share of the way between two shots.
fn land(
    renderer: &Renderer,
    scene: &SceneParams,
    [from, to]: [&Arc<SceneShot>; 2],
    share: f32,
) -> Result<Land, JobError> {
    let still = share >= 1.0 || Arc::ptr_eq(from, to);
    let mut land = match still {
        true => renderer.land(&to.world, scene)?,
        false => renderer.land(&between(&from.world, &to.world, share), scene)?,
    };
    if let (Some(from), Some(to)) = (&from.drape, &to.drape) {
        renderer.drape(&mut land, &Drape::between(from, to, share))?;
    }
    Ok(land)
}
