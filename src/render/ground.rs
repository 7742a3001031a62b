//! What the passes read of a world: rasters of heights, slopes, covers and states, each with its smaller copies, made on the
//! processor, rows in parallel.

use rayon::prelude::*;

use super::{RenderError, cover::Covers, fire::with_molten, shade::sky_share};
use crate::{
    grid::Field,
    scene::{SceneParams, Surround},
    world::World,
};

/// How the map lies in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lie {
    /// West-east and north-south extent, m.
    pub extent_m: [f64; 2],
    /// Side of a cell, m.
    pub cell_m: f64,
    /// Height of the sea, m.
    pub sea_m: f64,
    /// Lowest and highest ground, m.
    pub range_m: [f64; 2],
    /// How much higher than it is the land is drawn.
    pub exaggeration: f64,
    /// Whether most of the rim is sea.
    pub rim_at_sea: bool,
}

/// Extent up to which land is drawn as high as it is, km.
const TRUE_KM: f64 = 40.0;
/// Share of the extent that the relief of a larger map is to have.
const RELIEF: f64 = 0.045;
/// Share of the rim under the sea from which the sea goes on around the map.
const SEA_RIM: f64 = 0.7;

impl Lie {
    fn new(world: &World, height: &Field<f32>, scene: &SceneParams) -> Self {
        let extent_m = world.grid.extent_m();
        let (low, high) = height.range().map_or((0.0, 0.0), |(a, b)| (f64::from(a), f64::from(b)));
        let mut lie = Self {
            extent_m,
            cell_m: world.grid.cell_m,
            sea_m: world.sea_level_m,
            range_m: [low, high],
            exaggeration: 1.0,
            rim_at_sea: rim_at_sea(height, world.sea_level_m as f32),
        };
        lie.exaggeration = scene.exaggeration.unwrap_or_else(|| lie.usual_exaggeration());
        lie
    }

    /// From the sea or the lowest land to the highest, m.
    pub fn relief_m(&self) -> f64 {
        (self.range_m[1] - self.range_m[0].max(self.sea_m.min(self.range_m[1]))).max(1e-3 * self.extent_m[0].min(1e4))
    }

    fn usual_exaggeration(&self) -> f64 {
        let longer = self.extent_m[0].max(self.extent_m[1]);
        if longer <= TRUE_KM * 1000.0 {
            return 1.0;
        }
        (RELIEF * longer / self.relief_m()).clamp(1.0, 12.0)
    }

    /// Height of the block's bottom, drawn, m.
    pub fn floor_m(&self) -> f64 {
        let longer = self.extent_m[0].max(self.extent_m[1]);
        self.range_m[0].min(self.sea_m) * self.exaggeration - 0.025 * longer
    }

    /// Depth in which light falls to 37 %: a few metres in nature, more where a map is so wide that no shelf would show.
    pub fn clarity_m(&self) -> f64 {
        (self.extent_m[0] * 1.2e-4).clamp(6.0, 110.0)
    }

    /// Distance from a river's middle up to which its map tells it, m: so far a river may be widened to be seen.
    pub fn river_reach_m(&self) -> f64 {
        1.6e-3 * self.extent_m[0].max(self.extent_m[1])
    }

    /// Length of the longest waves: as wind makes them, longer where none would be seen.
    pub fn wave_m(&self) -> f64 {
        (self.extent_m[0] * 2.5e-3).clamp(24.0, 2500.0)
    }
}

/// The same scene with what it leaves to the world settled by this one, so that all pictures of a film are drawn alike.
pub fn settled(world: &World, scene: &SceneParams) -> SceneParams {
    let lie = Lie::new(world, &world.height(), scene);
    let surround = match scene.surround {
        Surround::Auto if lie.rim_at_sea => Surround::Sea,
        Surround::Auto => Surround::Block,
        given => given,
    };
    SceneParams { exaggeration: Some(lie.exaggeration), surround, ..scene.clone() }
}

fn rim_at_sea(height: &Field<f32>, sea_m: f32) -> bool {
    let (w, h) = (height.grid.width, height.grid.height);
    let rim = (0..w).flat_map(|x| [(x, 0), (x, h - 1)]).chain((0..h).flat_map(|y| [(0, y), (w - 1, y)]));
    let under = rim.filter(|&(x, y)| height.at(x, y) < sea_m).count();
    under as f64 >= SEA_RIM * 2.0 * (w + h) as f64
}

/// Rasters of the world, ready for textures.
pub struct Rasters {
    /// How the map lies.
    pub lie: Lie,
    /// Height, m.
    pub height: Field<f32>,
    /// Slope to the east and to the north.
    pub slope: Vec<[f32; 2]>,
    /// sRGB of what grows or lies there, and how much grows.
    pub cover: Vec<[u8; 4]>,
    /// Shares of snow, nothing, loose ground and open sky.
    pub state: Vec<[u8; 4]>,
}

impl Rasters {
    /// Those of a world.
    pub fn new(world: &World, scene: &SceneParams) -> Result<Self, RenderError> {
        let height = if scene.lava.on { with_molten(world, world.height()) } else { world.height() };
        if let Some((layer, x, y)) = world.first_non_finite() {
            return Err(RenderError::NotFinite { layer: layer.name(), x, y });
        }
        let lie = Lie::new(world, &height, scene);
        let slope = slopes(&height);
        let open = sky_share(&height, lie.exaggeration);
        let covers = Covers::of(world, &lie, scene);
        let pixels: Vec<([u8; 4], [u8; 4])> = (0..height.data.len())
            .into_par_iter()
            .map(|i| {
                let (cover, [snow, loose]) = covers.at(i, height.data[i]);
                (cover, [byte(snow), 0, byte(loose), byte(open.data[i])])
            })
            .collect();
        let (cover, state) = pixels.into_iter().unzip();
        Ok(Self { lie, height, slope, cover, state })
    }
}

/// A share as a byte.
pub fn byte(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn slopes(height: &Field<f32>) -> Vec<[f32; 2]> {
    let width = height.grid.width;
    (0..height.data.len())
        .into_par_iter()
        .map(|i| {
            let [east, south] = height.gradient(i % width, i / width);
            [east as f32, -south as f32]
        })
        .collect()
}

/// A value of a raster that can be averaged.
pub trait Average: Copy + Send + Sync {
    /// The mean of four.
    fn mean(four: [Self; 4]) -> Self;
}

impl Average for f32 {
    fn mean(four: [f32; 4]) -> f32 {
        four.iter().sum::<f32>() * 0.25
    }
}

impl<const N: usize> Average for [f32; N] {
    fn mean(four: [Self; 4]) -> Self {
        std::array::from_fn(|c| four.iter().map(|v| v[c]).sum::<f32>() * 0.25)
    }
}

impl<const N: usize> Average for [u8; N] {
    fn mean(four: [Self; 4]) -> Self {
        std::array::from_fn(|c| (four.iter().map(|v| u32::from(v[c])).sum::<u32>().div_ceil(4)) as u8)
    }
}

/// A raster and its smaller copies, each half the size, down to one texel.
pub fn copies<T: Average>(size: [usize; 2], data: Vec<T>) -> Vec<([usize; 2], Vec<T>)> {
    let mut all = vec![(size, data)];
    while let Some(([w, h], data)) = all.last().map(|(size, data)| (*size, data)).filter(|([w, h], _)| w * h > 1) {
        let (to_w, to_h) = ((w / 2).max(1), (h / 2).max(1));
        let mut next = vec![data[0]; to_w * to_h];
        next.par_chunks_mut(to_w).enumerate().for_each(|(y, row)| {
            let (north, south) = ((2 * y).min(h - 1), (2 * y + 1).min(h - 1));
            for (x, out) in row.iter_mut().enumerate() {
                let (west, east) = ((2 * x).min(w - 1), (2 * x + 1).min(w - 1));
                *out = T::mean([
                    data[north * w + west],
                    data[north * w + east],
                    data[south * w + west],
                    data[south * w + east],
                ]);
            }
        });
        all.push(([to_w, to_h], next));
    }
    all
}
