//! What a film keeps of a world.

use rayon::prelude::*;

use super::{
    super::{ReliefError, View, absent, cover::Cover, palette::Rgb, rivers::Waters, shade::shade, tint::Scene},
    resample::Resampler,
};
use crate::{
    grid::{Field, Grid},
    world::{Kind, Layer, Plume, World},
};

/// A moment of a world at the picture's raster.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Height, m.
    pub(super) height: Field<f32>,
    /// How bright each pixel is, -1 to 1.
    pub(super) tone: Vec<f32>,
    /// The values of the layer that is shown, where it is not the relief.
    pub(super) values: Option<Vec<f32>>,
    /// The land's flat colours in linear light, red, green and blue apart, where there is weather or lava.
    pub(super) ground: Option<[Vec<f32>; 3]>,
    /// Rivers and lakes, where the relief is shown and there are any.
    pub(super) waters: Option<Waters>,
    /// Smoke that there is or was.
    pub(super) plumes: Vec<Plume>,
    /// Height of the sea, m.
    pub(super) sea_m: f32,
    /// Years since the recipe began.
    pub(super) time_yr: f64,
}

impl Shot {
    pub(super) fn of(
        world: &World,
        view: &View,
        resampler: &Resampler,
        (map, scene): (Grid, &Scene),
    ) -> Result<Self, ReliefError> {
        let column: Vec<&Field<f32>> = Layer::COLUMN.iter().filter_map(|&layer| world.layer(layer)).collect();
        let height = resampler.sum(&column);
        if !height.data.iter().all(|v| v.is_finite()) {
            let (layer, x, y) = world.first_non_finite().unwrap_or((Layer::Height, 0, 0));
            return Err(ReliefError::NotFinite { layer: layer.name(), x, y });
        }
        let values = match view {
            View::Layer(layer) if *layer != Layer::Height => Some(values(world, *layer, resampler)?.data),
            View::Layer(_) => Some(height.data.clone()),
            View::Relief => None,
        };
        let waters = if *view == View::Relief { Waters::of(world, &map) } else { None };
        let sea_m = world.sea_level_m as f32;
        let cover = Some(view).filter(|view| **view == View::Relief);
        let cover = cover.and_then(|_| Cover::of(world, |field| resampler.sum(&[field])));
        // The scene is over a sea at zero.
        let plain = |height_m: f32| scene.land((height_m - sea_m).max(0.0));
        let ground = cover.map(|cover| colours(&cover, &height, plain));
        let has_land = height.data.iter().any(|&h| h > sea_m);
        let tone = shade(&height, |h| h > sea_m || !has_land, None).data;
        let plumes = world.plumes();
        Ok(Self { height, tone, values, ground, waters, plumes, sea_m, time_yr: world.time_yr })
    }

    /// The flat ground before the first stage.
    pub fn before(&self) -> Self {
        Self {
            height: Field::filled(self.height.grid, 0.0),
            tone: vec![0.0; self.tone.len()],
            values: self.values.clone(),
            ground: None,
            waters: None,
            plumes: Vec::new(),
            sea_m: 0.0,
            time_yr: 0.0,
        }
    }

    /// Years since the recipe began.
    pub fn time_yr(&self) -> f64 {
        self.time_yr
    }
}

/// The land's flat colours, red, green and blue apart.
fn colours(cover: &Cover, height: &Field<f32>, plain: impl Fn(f32) -> Rgb + Sync) -> [Vec<f32>; 3] {
    let (cells, width) = (height.grid.cells(), height.grid.width);
    let [mut red, mut green, mut blue] = [0; 3].map(|_| vec![0.0; cells]);
    let rows = red.par_chunks_mut(width).zip(green.par_chunks_mut(width)).zip(blue.par_chunks_mut(width));
    rows.enumerate().for_each(|(y, ((red, green), blue))| {
        for x in 0..width {
            [red[x], green[x], blue[x]] = cover.at(height, x, y, || plain(height.at(x, y)));
        }
    });
    [red, green, blue]
}

/// A layer that no process has made yet is empty.
fn values(world: &World, layer: Layer, resampler: &Resampler) -> Result<Field<f32>, ReliefError> {
    let empty = || Field::filled(world.grid, 0.0f32);
    let derived;
    let field = match world.layer(layer) {
        Some(stored) => stored,
        None => {
            derived = match layer.derived() {
                true => world.view(layer).ok_or_else(|| absent(world, layer))?,
                false => empty(),
            };
            &derived
        }
    };
    Ok(if matches!(layer.spec().kind, Kind::Continuous) { resampler.sum(&[field]) } else { resampler.nearest(field) })
}
