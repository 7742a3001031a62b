//! What a film keeps of a world.

use rayon::prelude::*;

use super::{
    super::{ReliefError, View, absent, cover::Cover, rivers::Waters, shade},
    resample::Resampler,
};
use crate::{
    grid::{Field, Grid, blur},
    world::{Kind, Layer, World},
};

/// A moment of a world at the picture's raster.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Height, m.
    pub(super) height: Field<f32>,
    /// What slopes are taken of: the ground and two smoother copies of it, by their shares.
    pub(super) form: Vec<f32>,
    /// The ground around each pixel.
    pub(super) around: Vec<f32>,
    /// The values of the layer that is shown, where it is not the relief.
    pub(super) values: Option<Vec<f32>>,
    /// The land's flat colours in linear light, red, green and blue apart, where there is weather.
    pub(super) ground: Option<[Vec<f32>; 3]>,
    /// Rivers and lakes, where the relief is shown and there are any.
    pub(super) waters: Option<Waters>,
    /// Height of the sea, m.
    pub(super) sea_m: f32,
    /// Exaggeration of slopes.
    pub(super) exaggeration: f32,
    /// Years since the recipe began.
    pub(super) time_yr: f64,
}

impl Shot {
    pub(super) fn of(world: &World, view: &View, resampler: &Resampler, map: Grid) -> Result<Self, ReliefError> {
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
        let ground = cover.map(|cover| colours(&cover, &height));
        let copy = |i: usize| blur(&height, shade::sigma_px(&height, i));
        let shares = shade::SCALES.map(|(_, share)| share as f32);
        let fine = copy(0);
        let has_land = height.data.iter().any(|&h| h > sea_m);
        let exaggeration = shade::typical_exaggeration(&fine, |h| h > sea_m || !has_land) as f32;
        let mut form = fine.data;
        form.iter_mut().for_each(|form| *form *= shares[0]);
        let mut add = |copy: &Field<f32>, share: f32| {
            crate::grid::for_each_row(&mut form, map.width, |y, row| {
                row.iter_mut().zip(copy.row(y)).for_each(|(form, v)| *form += v * share);
            });
        };
        // One after the other, so that no more than one of them takes room.
        add(&copy(1), shares[1]);
        let around = copy(2);
        add(&around, shares[2]);
        Ok(Self {
            height,
            form,
            around: around.data,
            values,
            ground,
            waters,
            sea_m,
            exaggeration,
            time_yr: world.time_yr,
        })
    }

    /// The flat ground before the first stage, lit as this moment is.
    pub fn before(&self) -> Self {
        let flat = || vec![0.0; self.form.len()];
        Self {
            height: Field::filled(self.height.grid, 0.0),
            form: flat(),
            around: flat(),
            values: self.values.clone(),
            ground: None,
            waters: None,
            sea_m: 0.0,
            exaggeration: self.exaggeration,
            time_yr: 0.0,
        }
    }

    /// Years since the recipe began.
    pub fn time_yr(&self) -> f64 {
        self.time_yr
    }
}

/// The land's flat colours, red, green and blue apart.
fn colours(cover: &Cover, height: &Field<f32>) -> [Vec<f32>; 3] {
    let (cells, width) = (height.grid.cells(), height.grid.width);
    let [mut red, mut green, mut blue] = [0; 3].map(|_| vec![0.0; cells]);
    let rows = red.par_chunks_mut(width).zip(green.par_chunks_mut(width)).zip(blue.par_chunks_mut(width));
    rows.enumerate().for_each(|(y, ((red, green), blue))| {
        for x in 0..width {
            let i = y * width + x;
            [red[x], green[x], blue[x]] = cover.at(i, height.data[i]);
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
