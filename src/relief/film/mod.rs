//! The map in motion: any number of pictures of one growing world, all of one size and one scale of colours.
//!
//! What a world costs is paid once, when it becomes a [`Shot`]: its layers are brought to the picture's raster and
//! smoothed there. A picture is drawn between two shots, with every quantity in proportion, so that a film runs smoothly
//! where a process shows itself seldom; plates, classes and other names, which have no between, change half way. A shot
//! keeps nothing of the world but a few fields of the picture's size, so that memory does not grow with the world.
//!
//! A height has the same colour in all pictures. The light follows the land, as on the map: every shot is lit as its own
//! map would be, and what lies between two goes from one's light to the other's.

mod paint;
mod resample;
mod sheet;
mod shore;
mod shot;
mod tints;

pub use shot::Shot;

use super::{
    ReliefError, View,
    frame::unit_of,
    layers,
    palette::Encoder,
    swatches::Colours,
    tint::{Brush, Scene},
};
use crate::{
    grid::{Field, Grid},
    world::{Layer, World},
};
use resample::Resampler;
pub(super) use sheet::Sheet;
use shore::Shore;
use tints::Tints;

/// What all pictures of a film share.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// What is shown.
    pub view: View,
    /// Lowest and highest ground to be expected, m over the sea. More than 1500 m apart, they make no difference: a
    /// colour then stands for the same metres on every map.
    pub range_m: [f64; 2],
    /// Whether there will be weather, by which the relief is then coloured.
    pub climate: bool,
    /// Whether smoke is drawn over the relief.
    pub smoke: bool,
    /// The film's name.
    pub title: Option<String>,
}

impl Options {
    /// Whether pictures need no more of a world than its ground and its weather.
    pub fn shows_ground_alone(&self) -> bool {
        matches!(self.view, View::Relief | View::Layer(Layer::Height))
    }
}

/// What is written on a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Words<'a> {
    /// What is going on.
    pub caption: &'a str,
    /// When; empty for no clock.
    pub clock: &'a str,
}

/// Draws a film's pictures.
pub struct Animation {
    /// The map's pixels over the world's ground.
    map: Grid,
    size: [usize; 2],
    view: View,
    smoke: bool,
    resampler: Resampler,
    scene: Scene,
    colours: Option<Colours>,
    sheet: Sheet,
    // What is the same for all pictures, or room that all of them use.
    encoder: Encoder,
    brush: Brush,
    tints: Tints,
    unit: f32,
    heights: Field<f32>,
    shore: Shore,
}

impl Animation {
    /// For worlds over this grid.
    pub fn new(grid: Grid, options: &Options) -> Self {
        let [width, height] = options.size;
        let scale = (width as f64 / grid.width as f64).min(height as f64 / grid.height as f64);
        let side = |cells: usize, most: usize| ((cells as f64 * scale).round() as usize).clamp(1, most);
        let (map_w, map_h) = (side(grid.width, width), side(grid.height, height));
        let cell_m = grid.extent_m()[0] / map_w as f64;
        let map = Grid { width: map_w, height: map_h, cell_m, edges: grid.edges };
        let scene = Scene::over(options.range_m, 0.0);
        let colours = match options.view {
            View::Relief => None,
            View::Layer(layer) => Colours::fixed(layer),
        };
        let (encoder, brush) = (Encoder::new(), Brush::new(unit_of(&map)));
        let tints = Tints::new(&scene, &brush, &encoder);
        let legend = layers::fixed_legend(&options.view, &scene, options.climate);
        Self {
            map,
            size: options.size,
            view: options.view,
            smoke: options.smoke && options.view == View::Relief,
            resampler: Resampler::new(grid, map),
            tints,
            scene,
            colours,
            sheet: Sheet::new(options.size, [map_w, map_h], options.title.as_deref(), &legend),
            encoder,
            brush,
            unit: unit_of(&map),
            heights: Field::filled(map, 0.0),
            shore: Shore::new(map),
        }
    }

    /// Width and height of the map in the picture's upper left corner, pixels.
    pub fn map_size(&self) -> [usize; 2] {
        [self.map.width, self.map.height]
    }

    /// Bytes of a picture: three a pixel.
    pub fn bytes(&self) -> usize {
        self.size[0] * self.size[1] * 3
    }

    /// What a film keeps of a world.
    pub fn shot(&self, world: &World) -> Result<Shot, ReliefError> {
        Shot::of(world, &self.view, &self.resampler, (self.map, &self.scene))
    }

    /// Draws the picture at `share` of the way between two shots: rows of red, green, blue from the top left.
    pub fn draw(&mut self, [from, to]: [&Shot; 2], share: f32, words: Words, picture: &mut [u8]) {
        assert_eq!(picture.len(), self.bytes(), "a picture has the film's size");
        self.sheet.lay(picture);
        self.paint([from, to], share, picture);
        self.sheet.write(words, picture);
    }
}
