//! Where a stage acts, and how strongly: a layer, a range of one (`slope > 30`), or an image.

use std::path::{Path, PathBuf};

use crate::grid::{Edges, Field, Grid, linear};

use super::{Layer, PictureError, World, open_picture};

/// A stage's mask: values 0 (nothing) to 1 (fully) over the map.
#[derive(Clone, Debug, PartialEq)]
pub enum Mask {
    /// A layer, its catalogue range stretched to 0 ... 1.
    Layer(Layer),
    /// 1 where a layer is above the bound, else 0.
    Above(Layer, f64),
    /// 1 where a layer is below the bound, else 0.
    Below(Layer, f64),
    /// The brightness of an image, stretched over the map.
    Image(PathBuf),
}

/// Why a mask cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MaskError {
    /// The text is neither a layer, a comparison, nor an image file.
    #[error("mask '{0}' is neither a layer (height), a range of one (slope > 30), nor an image file (.png, .jpg)")]
    Unreadable(String),
    /// No process before this stage made the layer.
    #[error("mask needs the layer '{0}', which no earlier stage makes")]
    Absent(&'static str),
    /// The image could not be read.
    #[error("mask image {0}")]
    Image(#[from] PictureError),
}

impl Mask {
    /// Reads `height`, `slope > 30`, `height < 1200` or a path to an image, relative to `folder`.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, MaskError> {
        let unreadable = || MaskError::Unreadable(text.to_owned());
        let text = text.trim();
        if let Some(at) = text.find(['<', '>']) {
            let layer = Layer::from_name(text[..at].trim()).ok_or_else(unreadable)?;
            let bound: f64 = text[at + 1..].trim().parse().map_err(|_| unreadable())?;
            if !bound.is_finite() {
                return Err(unreadable());
            }
            return Ok(if text[at..].starts_with('>') { Mask::Above(layer, bound) } else { Mask::Below(layer, bound) });
        }
        if let Some(layer) = Layer::from_name(text) {
            return Ok(Mask::Layer(layer));
        }
        let is_image = [".png", ".jpg", ".jpeg"].iter().any(|end| text.to_lowercase().ends_with(end));
        if is_image && text.starts_with("sample:") {
            Ok(Mask::Image(text.into()))
        } else if is_image {
            Ok(Mask::Image(folder.join(text)))
        } else {
            Err(unreadable())
        }
    }

    /// The mask over a world as it stands.
    pub fn evaluate(&self, world: &World) -> Result<Field<f32>, MaskError> {
        let view = |layer: Layer| world.view(layer).ok_or(MaskError::Absent(layer.name()));
        Ok(match self {
            Mask::Layer(layer) => {
                let [low, high] = layer.spec().range.map(|v| v as f32);
                view(*layer)?.map(|v| ((v - low) / (high - low)).clamp(0.0, 1.0))
            }
            Mask::Above(layer, bound) => view(*layer)?.map(|v| f32::from(v as f64 > *bound)),
            Mask::Below(layer, bound) => view(*layer)?.map(|v| f32::from((v as f64) < *bound)),
            Mask::Image(path) => read_image(path, world.grid)?,
        })
    }
}

fn read_image(path: &Path, grid: Grid) -> Result<Field<f32>, MaskError> {
    let image = open_picture(path)?.into_luma16();
    let (w, h) = (image.width() as usize, image.height() as usize);
    let data = image.into_raw().into_iter().map(|v| v as f32 / 65535.0).collect();
    let picture = Field { grid: Grid { width: w, height: h, cell_m: 1.0, edges: Edges::Closed }, data };
    Ok(Field::from_fn(grid, |x, y| {
        let at = [(x as f64 + 0.5) / grid.width as f64 * w as f64, (y as f64 + 0.5) / grid.height as f64 * h as f64];
        linear(&picture, at) as f32
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_forms_are_read() {
        let here = Path::new("maps");
        assert_eq!(Mask::parse("slope > 30", here), Ok(Mask::Above(Layer::Slope, 30.0)));
        assert_eq!(Mask::parse("height<-5", here), Ok(Mask::Below(Layer::Height, -5.0)));
        assert_eq!(Mask::parse("hardness", here), Ok(Mask::Layer(Layer::Hardness)));
        assert_eq!(Mask::parse("m.png", here), Ok(Mask::Image(here.join("m.png"))));
        for bad in ["", "slop > 3", "slope > x", "slope > nan", "m.gif"] {
            assert!(Mask::parse(bad, here).is_err(), "{bad}");
        }
    }

    #[test]
    fn ranges_and_absent_layers() {
        let mut world = World::new(Grid::new(2, 1, 2.0, Edges::Open), 0.0);
        assert_eq!(Mask::Layer(Layer::Hardness).evaluate(&world), Err(MaskError::Absent("hardness")));
        world.layer_mut(Layer::Bedrock).data.copy_from_slice(&[10.0, 20.0]);
        assert_eq!(Mask::Above(Layer::Height, 15.0).evaluate(&world).unwrap().data, [0.0, 1.0]);
        assert_eq!(Mask::Below(Layer::Height, 15.0).evaluate(&world).unwrap().data, [1.0, 0.0]);
    }
}
