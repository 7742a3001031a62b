//! Meshes: the ground as triangles between points of a lattice, for programs that know no heightmaps.
//!
//! | ending | holds | axes, unit |
//! |---|---|---|
//! | `.glb` | positions, normals, colours by height, several levels of detail | x east, y up, z south; m |
//! | `.obj` | positions, normals | x east, y up, z south; m |
//! | `.stl` | a closed solid with walls and a flat base, to be printed | x east, y north, z up; mm |
//!
//! The outermost points lie on the map's rim and the middle of the map is the origin. Heights are brought to the lattice
//! without folding short waves into long ones. Files are streamed row by row.

mod glb;
mod obj;
mod stl;

pub use glb::write_glb;
pub use obj::write_obj;
pub use stl::write_stl;

use std::{
    io::{self, Write},
    path::Path,
};

use super::{ExportError, write_whole};
use crate::{
    grid::{Field, Points, resample},
    world::World,
};

/// Fewest and most points a side.
pub const MESH_SIDES: [usize; 2] = [2, 4096];
/// Points a side below which a level of detail shows nothing any more.
const COARSEST: usize = 9;

/// How a mesh is made.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOptions {
    /// Points along the longer side at most, within [`MESH_SIDES`]; never more than the map has corners.
    pub size: usize,
    /// How much higher the land is than in truth, above 0. If not given, 1, and in print as much as a tenth of the width
    /// needs, for a true continent would be a smooth plate.
    pub exaggeration: Option<f64>,
    /// Levels of detail in a `.glb`, from 1; each has half as many points a side as the one before.
    pub levels: usize,
    /// Metres that a unit of a `.glb` or `.obj` stands for, above 0.
    pub metres_per_unit: f64,
    /// West-east width of a print, mm, above 0.
    pub width_mm: f64,
    /// Thickness of a print below its lowest point, mm, above 0.
    pub base_mm: f64,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self { size: 512, exaggeration: None, levels: 4, metres_per_unit: 1.0, width_mm: 150.0, base_mm: 3.0 }
    }
}

/// The formats of meshes, by their endings.
pub const MESH_FORMATS: [(&str, MeshFormat); 3] =
    [("glb", MeshFormat::Glb), ("obj", MeshFormat::Obj), ("stl", MeshFormat::Stl)];

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Binary glTF 2.0.
    Glb,
    /// Wavefront OBJ.
    Obj,
    /// Binary STL.
    Stl,
}

/// Writes a mesh file, whole or not at all.
pub fn write_mesh(world: &World, options: &MeshOptions, format: MeshFormat, path: &Path) -> Result<(), ExportError> {
    write_whole(path, |file| {
        let written = match format {
            MeshFormat::Glb => write_glb(world, options, file),
            MeshFormat::Obj => write_obj(world, options, file),
            MeshFormat::Stl => write_stl(world, options, file),
        };
        written.map_err(|error| match error {
            ExportError::Stream(cause) => ExportError::Disk { path: path.to_owned(), cause },
            error => error,
        })
    })
}

/// Points over a map, as far apart on both axes as whole numbers allow.
struct Lattice {
    width: usize,
    height: usize,
    /// West-east and north-south extent, in the file's unit.
    extent: [f64; 2],
    /// Heights in the file's unit, row by row from the north.
    heights: Vec<f32>,
}

/// The heights of a world, if all are numbers.
fn ground(world: &World) -> Result<Field<f32>, ExportError> {
    let height = world.height();
    match height.first_non_finite() {
        Some((x, y)) => Err(ExportError::NotFinite { layer: "height", x, y }),
        None => Ok(height),
    }
}

impl Lattice {
    /// A lattice whose longer side has at most `size` points; `unit` gives a height in the file's unit, and lengths by
    /// `per_m`.
    fn new(ground: &Field<f32>, size: usize, per_m: f64, unit: impl Fn(f32) -> f64) -> Self {
        let [x_m, y_m] = ground.grid.extent_m();
        let longer = ground.grid.width.max(ground.grid.height);
        let steps = (size.clamp(MESH_SIDES[0], MESH_SIDES[1]) - 1).min(longer) as f64;
        let points = |extent_m: f64| (steps * extent_m / x_m.max(y_m)).round().max(1.0) as usize + 1;
        let (width, height) = (points(x_m), points(y_m));
        let heights = resample(ground, width, height, Points::Corners).into_iter().map(|h| unit(h) as f32).collect();
        Self { width, height, extent: [x_m * per_m, y_m * per_m], heights }
    }

    /// East and south of the middle, in the file's unit.
    fn place(&self, x: usize, y: usize) -> [f64; 2] {
        let along = |i: usize, points: usize| i as f64 / (points - 1) as f64 - 0.5;
        [along(x, self.width) * self.extent[0], along(y, self.height) * self.extent[1]]
    }

    fn at(&self, x: usize, y: usize) -> f32 {
        self.heights[y * self.width + x]
    }

    /// Position with the height as y.
    fn point(&self, x: usize, y: usize) -> [f32; 3] {
        let [east, south] = self.place(x, y);
        [east as f32, self.at(x, y), south as f32]
    }

    /// Unit normal of the surface at a point, the height as y; central differences, one-sided on the rim.
    fn normal(&self, x: usize, y: usize) -> [f32; 3] {
        let slope = |low: f32, high: f32, steps: usize, points: usize, extent: f64| {
            (high as f64 - low as f64) * (points - 1) as f64 / (steps as f64 * extent)
        };
        let (w, e) = (x.saturating_sub(1), (x + 1).min(self.width - 1));
        let (n, s) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
        let east = slope(self.at(w, y), self.at(e, y), e - w, self.width, self.extent[0]);
        let south = slope(self.at(x, n), self.at(x, s), s - n, self.height, self.extent[1]);
        let length = (east * east + south * south + 1.0).sqrt();
        [-east, 1.0, -south].map(|v| (v / length) as f32)
    }

    fn points(&self) -> usize {
        self.width * self.height
    }

    fn triangles(&self) -> usize {
        2 * (self.width - 1) * (self.height - 1)
    }

    /// Calls `each` for the two triangles of every cell: indices of points, anticlockwise from above.
    fn each_triangle(&self, mut each: impl FnMut([usize; 3]) -> io::Result<()>) -> io::Result<()> {
        for y in 0..self.height - 1 {
            for x in 0..self.width - 1 {
                let nw = y * self.width + x;
                let (ne, sw) = (nw + 1, nw + self.width);
                each([nw, sw, ne])?;
                each([ne, sw, sw + 1])?;
            }
        }
        Ok(())
    }
}

/// The lattice of a mesh in metres or its unit.
fn to_scale(ground: &Field<f32>, options: &MeshOptions, size: usize) -> Lattice {
    let per_m = 1.0 / options.metres_per_unit;
    let up = per_m * options.exaggeration.unwrap_or(1.0);
    Lattice::new(ground, size, per_m, |height_m| height_m as f64 * up)
}

fn put(out: &mut impl Write, numbers: &[f32]) -> io::Result<()> {
    numbers.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

#[cfg(test)]
mod tests;
