//! The heightmap every engine reads: a PNG of 16-bit gray values.
//!
//! Black is the lowest cell, white the highest, linear between: `height_m = black_m + value/65535 · (white_m − black_m)`.
//! Row 0 is the north. The two ends are returned, for they stand in no PNG.

use std::path::Path;

use serde::Serialize;

use super::{
    ExportError,
    raster::{Lattice, Layout, Levels, Raster, Samples, png_image},
    write_whole,
};
use crate::{grid::Field, world::World};

/// The heights that black and white stand for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeightRange {
    /// Height of value 0, m.
    pub black_m: f64,
    /// Height of value 65535, m.
    pub white_m: f64,
}

/// Writes the world's heights. A flat world gets a range of 1 m, so that its value is 0 everywhere.
pub fn write_height_png(world: &World, path: &Path) -> Result<HeightRange, ExportError> {
    let height = world.height();
    let Some(levels) = Levels::of(&height) else {
        let (x, y) = height.first_non_finite().unwrap_or_default();
        return Err(ExportError::NotFinite { layer: "height", x, y });
    };
    write_levels(&height, levels, path)?;
    Ok(HeightRange { black_m: levels.black, white_m: levels.white })
}

/// Writes the world's heights over a range that is given; returns how many cells were lower or higher than that.
pub fn write_height_png_within(world: &World, range: HeightRange, path: &Path) -> Result<u64, ExportError> {
    let height = world.height();
    if let Some((x, y)) = height.first_non_finite() {
        return Err(ExportError::NotFinite { layer: "height", x, y });
    }
    let (black, white) = (range.black_m as f32, range.white_m as f32);
    let cut = height.data.iter().filter(|&&h| h < black || h > white).count() as u64;
    let levels = Levels { black: range.black_m, white: range.white_m };
    write_levels(&height, levels, path)?;
    Ok(cut)
}

fn write_levels(height: &Field<f32>, levels: Levels, path: &Path) -> Result<(), ExportError> {
    let samples = Samples::U16(levels.to_u16(height));
    let raster = Raster { lattice: Lattice::cells(&height.grid), channels: 1, samples, levels: Some(levels) };
    write_whole(path, |out| {
        png_image::encode(&raster, Layout::default(), out)
            .map_err(|cause| ExportError::Encode { path: path.to_owned(), cause })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Grid},
        world::Layer,
    };

    fn world(heights: impl Fn(usize, usize) -> f32 + Sync) -> World {
        let grid = Grid::new(40, 30, 4000.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, heights));
        world
    }

    #[test]
    fn heights_come_back_within_half_a_step() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("height.png");
        let world = world(|x, y| (x as f32 * 1.7).sin() * 3000.0 - y as f32 * 100.0);
        let range = write_height_png(&world, &path).unwrap();
        let image::DynamicImage::ImageLuma16(picture) = image::open(&path).unwrap() else { panic!("not 16-bit gray") };
        assert_eq!(picture.dimensions(), (40, 30));
        let step = (range.white_m - range.black_m) / 65535.0;
        let height = world.height();
        for (x, y, pixel) in picture.enumerate_pixels() {
            let read = range.black_m + pixel.0[0] as f64 * step;
            assert!((read - height.at(x as usize, y as usize) as f64).abs() <= step * 0.5001, "{x} {y}");
        }
        let values: Vec<u16> = picture.into_raw();
        assert_eq!((values.iter().min(), values.iter().max()), (Some(&0), Some(&65535)));
    }

    #[test]
    fn a_flat_world_has_a_range_of_one_metre() {
        let folder = tempfile::tempdir().unwrap();
        let range = write_height_png(&world(|_, _| -20.0), &folder.path().join("h.png")).unwrap();
        assert_eq!(range, HeightRange { black_m: -20.0, white_m: -19.0 });
    }

    #[test]
    fn what_cannot_be_written_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_height_png(&world(|_, _| f32::NAN), &folder.path().join("h.png")).unwrap_err();
        assert!(error.to_string().contains("(0, 0)"));
        let error = write_height_png(&world(|_, _| 0.0), &folder.path().join("no/h.png")).unwrap_err();
        assert!(error.to_string().contains("h.png"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
