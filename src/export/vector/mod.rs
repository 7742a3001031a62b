//! Vector maps: coast, contours, lakes, rivers, plates and what they do, as lines and polygons.
//!
//! | ending | holds | frame |
//! |---|---|---|
//! | `.geojson` | a FeatureCollection (RFC 7946); the property `layer` says what a feature is | degrees about 0, 0 |
//! | `.svg` | one layer each, named for Inkscape; widths, colours and letters of a printed map | 1000 units along the longer side |
//!
//! | file | owns |
//! |---|---|
//! | `shapes` | clipping, thinning, and rings that become polygons |
//! | `ground` | land, tints, contours, peaks |
//! | `water` | rivers and lakes |
//! | `plates` | outlines, borders, motions |
//! | `geojson`, `svg` | the formats |
//!
//! Inside this module coordinates are metres from the map's north-west corner, x to the east and y to the south. A window
//! cuts everything, and polygons are closed along its rim. RFC 7946 knows only degrees of longitude and latitude, which
//! a made-up land has not: its middle is put at 0, 0, where a degree is as long to the east as to the north, and the
//! file says how many metres a degree stands for.

mod geojson;
mod ground;
mod plates;
mod shapes;
mod svg;
mod water;

use std::{io::Write, path::Path};

use super::{ExportError, raster::Window, write_whole};
use crate::{grid::Grid, world::World};
use shapes::{Line, Polygon};

/// The vector formats, by their endings.
pub const VECTOR_FORMATS: [(&str, VectorFormat); 2] = [("geojson", VectorFormat::GeoJson), ("svg", VectorFormat::Svg)];

/// A vector format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorFormat {
    /// A FeatureCollection of degrees.
    GeoJson,
    /// A layered drawing.
    Svg,
}

/// How a vector map is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VectorOptions {
    /// The part of the map; all of it if absent.
    pub window: Option<Window>,
    /// Metres between contours; a round number that gives the land about a dozen if absent.
    pub contours_m: Option<f64>,
    /// The name of the map.
    pub title: String,
}

/// What is mapped, all of it cut to the window.
struct Map {
    /// North-west corner and extent of the window, m.
    corner_m: [f64; 2],
    extent_m: [f64; 2],
    cell_m: f64,
    title: String,
    interval_m: f64,
    land: Vec<Polygon>,
    /// Flat colours of land and sea, from the lowest: what is above each height.
    tints: Vec<([u8; 3], Vec<Polygon>)>,
    sea_tint: [u8; 3],
    contours: Vec<(f64, Line)>,
    peaks: Vec<Spot>,
    lakes: Vec<water::Lake>,
    rivers: Vec<water::Reach>,
    plates: Vec<(u32, Polygon)>,
    borders: Vec<(&'static str, Line)>,
    motions: Vec<plates::Motion>,
    volcanoes: Vec<Spot>,
}

/// A place with a height.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spot {
    at_m: [f64; 2],
    height_m: f64,
}

impl Map {
    fn of(world: &World, options: &VectorOptions) -> Result<Self, ExportError> {
        let height = world.height();
        if let Some((x, y)) = height.first_non_finite() {
            return Err(ExportError::NotFinite { layer: "height", x, y });
        }
        let [wide_m, high_m] = world.grid.extent_m();
        let (corner_m, extent_m) = match options.window {
            Some(window) => {
                let fit = |from: f64, most: f64| window.size_m.min(most - from);
                ([window.x_m, window.y_m], [fit(window.x_m, wide_m), fit(window.y_m, high_m)])
            }
            None => ([0.0; 2], [wide_m, high_m]),
        };
        let view = View { corner_m, extent_m, grid: world.grid };
        let ground = ground::Ground::of(world, &height, &view);
        let interval_m = options.contours_m.unwrap_or_else(|| ground.interval_m(world.sea_level_m));
        Ok(Self {
            corner_m,
            extent_m,
            cell_m: world.grid.cell_m,
            title: options.title.clone(),
            interval_m,
            land: ground.above(world.sea_level_m),
            tints: ground.tints(world, interval_m),
            sea_tint: ground.sea_tint(world),
            contours: ground.contours(interval_m),
            peaks: ground.peaks(world.sea_level_m),
            lakes: water::lakes(world, &view),
            rivers: water::rivers(world, &view),
            plates: plates::outlines(world, &view),
            borders: plates::borders(world, &view),
            motions: plates::motions(world, &view),
            volcanoes: ground.volcanoes(world),
        })
    }
}

/// The part of the map that is drawn.
struct View {
    corner_m: [f64; 2],
    extent_m: [f64; 2],
    grid: Grid,
}

impl View {
    fn whole(&self) -> bool {
        self.corner_m == [0.0; 2] && self.extent_m == self.grid.extent_m()
    }

    fn far_m(&self) -> [f64; 2] {
        [0, 1].map(|c| self.corner_m[c] + self.extent_m[c])
    }

    fn holds(&self, at_m: [f64; 2]) -> bool {
        let far = self.far_m();
        (0..2).all(|c| at_m[c] >= self.corner_m[c] && at_m[c] <= far[c])
    }
}

/// Writes a vector map of a world.
pub fn write_vector(
    world: &World,
    options: &VectorOptions,
    format: VectorFormat,
    path: &Path,
) -> Result<(), ExportError> {
    let map = Map::of(world, options)?;
    write_whole(path, |file| {
        let text = match format {
            VectorFormat::GeoJson => geojson::text(&map),
            VectorFormat::Svg => svg::text(&map),
        };
        Ok(file.write_all(text.as_bytes())?)
    })
}

#[cfg(test)]
mod tests;
