//! A map's colours without its light, for those who lay them over land in space, and what stands beside such a picture.

use image::RgbImage;

use super::{
    Options, ReliefError, View, absent,
    film::{Sheet, Words},
    finite,
    furniture::Legend,
    layers, painted,
    palette::Encoder,
    swatches::Colours,
    tint::Scene,
};
use crate::world::World;

/// A map's flat colours, a pixel a cell.
#[derive(Clone)]
pub struct Drape {
    /// North up.
    pub colours: RgbImage,
    legend: Legend,
}

impl Drape {
    /// The colours that a map of this world has, with plate borders and motions if they are asked for.
    pub fn of(world: &World, view: &View, overlay: bool) -> Result<Self, ReliefError> {
        let side = world.grid.width.max(world.grid.height);
        let options = Options { overlay, exaggeration: Some(0.0), ..Options::bare(side) };
        let painting = painted(world, view, &options)?;
        Ok(Self { colours: painting.canvas.into_image(), legend: painting.legend })
    }

    /// The colours that a film's map of this world has, whose scale depends on no world. A layer that no process has made
    /// yet is empty.
    pub fn in_film(world: &World, view: &View, climate: bool) -> Result<Self, ReliefError> {
        let fixed = match view {
            View::Relief => None,
            View::Layer(layer) => Colours::fixed(*layer).map(|colours| (*layer, colours)),
        };
        let Some((layer, colours)) = fixed else { return Self::of(world, view, false) };
        let values = match (world.view(layer), layer.derived()) {
            (Some(values), _) => Some(finite(layer, values)?),
            (None, true) => return Err(absent(world, layer)),
            (None, false) => None,
        };
        let (encoder, grid) = (Encoder::new(), world.grid);
        let colour = |x: u32, y: u32| {
            let value = values.as_ref().map_or(0.0, |values| values.at(x as usize, y as usize));
            image::Rgb(encoder.bytes(colours.at(value)))
        };
        let colours = RgbImage::from_fn(grid.width as u32, grid.height as u32, colour);
        // Heights have no part in it.
        let scene = Scene::over([0.0, 0.0], 0.0);
        Ok(Self { colours, legend: layers::fixed_legend(view, &scene, climate) })
    }

    /// The colours on the way from one moment to another.
    pub fn between(from: &Self, to: &Self, share: f32) -> RgbImage {
        if from.colours.dimensions() != to.colours.dimensions() || share >= 1.0 {
            return to.colours.clone();
        }
        let mut colours = from.colours.clone();
        for (value, to) in colours.iter_mut().zip(to.colours.iter()) {
            *value = (f32::from(*value) + (f32::from(*to) - f32::from(*value)) * share).round() as u8;
        }
        colours
    }
}

/// Paper with a title and a legend beside a picture, or words on it.
pub struct Margins {
    sheet: Sheet,
    size: [usize; 2],
    inner: [usize; 2],
}

/// Share of the width that the paper takes, and least share of the shorter side.
const PAPER: [f64; 2] = [0.25, 0.32];

impl Margins {
    /// None: what is written stands on the picture.
    pub fn none(size: [usize; 2]) -> Self {
        let legend = Legend::swatches(String::new(), Vec::new());
        Self { sheet: Sheet::new(size, size, None, &legend), size, inner: size }
    }

    /// Beside a picture of draped colours, in a picture of this size.
    pub fn beside(size: [usize; 2], drape: &Drape, title: Option<&str>) -> Self {
        let [width, height] = size.map(|side| side as f64);
        let paper = (PAPER[0] * width).max(PAPER[1] * width.min(height)).ceil() as usize;
        let inner = [size[0].saturating_sub(paper).max(1), size[1]];
        Self { sheet: Sheet::new(size, inner, title, &drape.legend), size, inner }
    }

    /// Width and height left for the picture, pixels.
    pub fn inner(&self) -> [usize; 2] {
        self.inner
    }

    /// Puts a picture, as large as is left for it, and words into a whole one: rows of red, green, blue.
    pub fn lay(&self, inner: &RgbImage, words: Words, picture: &mut [u8]) {
        assert_eq!(picture.len(), self.size[0] * self.size[1] * 3, "a picture has its size");
        self.sheet.lay(picture);
        for (row, from) in
            picture.chunks_exact_mut(self.size[0] * 3).zip(inner.as_raw().chunks_exact(self.inner[0] * 3))
        {
            row[..from.len()].copy_from_slice(from);
        }
        self.sheet.write(words, picture);
    }
}
