//! A still of a scene.

use image::RgbImage;

use crate::{
    job::{JobError, Picture},
    relief::{Drape, Margins, View, film::Words},
    render::{Gpu, Moment, Path, Renderer},
    scene::Quality,
    world::{World, store::Provenance},
};

/// Pixels of a still, if nothing else is asked for.
const SIZE: [u32; 2] = [1280, 720];

/// Draws a world's scene, under the colours of a map if one is named.
pub fn draw(
    picture: &Picture,
    world: &World,
    provenance: &Provenance,
    drape: Option<View>,
) -> Result<RgbImage, JobError> {
    let mut scene = picture.scene.of_world(provenance)?;
    let size = picture.scene.size.unwrap_or(SIZE);
    let drape = match (drape, picture.overlay) {
        (None, false) => None,
        (view, overlay) => Some(Drape::of(world, &view.unwrap_or(View::Relief), overlay)?),
    };
    let whole = size.map(|side| side as usize);
    let margins = match &drape {
        Some(drape) => Margins::beside(whole, drape, Some(&provenance.name)),
        None => Margins::none(whole),
    };
    let inner = margins.inner().map(|side| side as u32);
    if drape.is_some() {
        super::dry(&mut scene);
    }
    let mut renderer = Renderer::new(Gpu::open()?)?;
    let mut land = renderer.land(world, &scene)?;
    if let Some(drape) = &drape {
        renderer.drape(&mut land, &drape.colours)?;
    }
    let camera = Path::new(&scene.camera, land.lie().extent_m, inner).at(0.0, &land);
    let quality = scene.quality.unwrap_or(Quality::Full);
    let moment = Moment { size: inner, share: 0.0, seconds: 0.0, quality };
    let drawn = renderer.picture(&mut land, &scene, &camera, &moment)?;
    if drape.is_none() {
        return Ok(drawn);
    }
    let mut sheet = RgbImage::new(size[0], size[1]);
    margins.lay(&drawn, Words::default(), &mut sheet);
    Ok(sheet)
}
