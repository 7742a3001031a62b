//! What game engines and map programs ask of a heightmap: valid sizes, formats, order of rows, and the numbers to type
//! into their importers.
//!
//! Facts come from the programs' own documentation; each file here says which. Nothing here reads a world or writes a
//! file.

mod azgaar;
mod godot;
mod mend;
mod unity;
mod unreal;

pub use azgaar::{gray as azgaar_gray, scale as azgaar_scale};
pub use mend::{Part, zooms};
pub use unreal::reads_as_tiles;

use serde_json::Value;

use super::raster::{Lattice, Levels};

/// Past this distance between vertices a landscape looks coarse under a player's feet, m.
pub const COARSE_M: f64 = 10.0;

/// A program that heightmaps are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// Unreal Engine's landscapes.
    Unreal,
    /// Unity's terrains.
    Unity,
    /// Godot with Terrain3D.
    Godot,
    /// Azgaar's Fantasy Map Generator.
    Azgaar,
}

/// How weights of materials are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightFiles {
    /// Not at all.
    None,
    /// A gray picture a material, of the heightmap's size.
    OneEach,
    /// One picture of four channels, a pixel a quad.
    FourChannels,
}

/// What an engine asks for.
#[derive(Clone, Copy, Debug)]
pub struct Demands {
    /// Name on the command line.
    pub name: &'static str,
    /// Vertices a side that it accepts; any if empty.
    pub sizes: &'static [usize],
    /// Endings of heightmaps that it reads in full depth, the best first.
    pub endings: &'static [&'static str],
    /// Whether it takes the first row of bare numbers for the south.
    pub south_first: bool,
    /// How it takes weights.
    pub weights: WeightFiles,
}

/// The numbers an importer asks for depend on these.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// The samples of one file.
    pub tile: &'a Lattice,
    /// Files along a side.
    pub tiles: usize,
    /// Heights of black and white; for floating point the range of the heights.
    pub levels: Levels,
    /// Height of the sea, m.
    pub sea_level_m: f64,
    /// Whether the file holds metres rather than levels.
    pub metres: bool,
    /// The most significant byte first.
    pub big_endian: bool,
}

impl Engine {
    /// Every engine.
    pub const ALL: [Engine; 4] = [Engine::Unreal, Engine::Unity, Engine::Godot, Engine::Azgaar];

    /// What it asks for.
    pub const fn demands(self) -> Demands {
        match self {
            Engine::Unreal => unreal::DEMANDS,
            Engine::Unity => unity::DEMANDS,
            Engine::Godot => godot::DEMANDS,
            Engine::Azgaar => azgaar::DEMANDS,
        }
    }

    /// The engine of that name.
    pub fn from_name(name: &str) -> Option<Engine> {
        Self::ALL.into_iter().find(|engine| engine.demands().name == name)
    }

    /// The accepted number of vertices a side that is nearest to `wanted`, by ratio.
    pub fn nearest_size(self, wanted: usize) -> usize {
        let away = |size: usize| {
            let (low, high) = (size.min(wanted) as f64, size.max(wanted) as f64);
            high / low.max(1.0)
        };
        let sizes = self.demands().sizes.iter().copied();
        sizes.min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(wanted)
    }

    /// What to type into its importer.
    pub fn settings(self, facts: &Facts) -> Value {
        match self {
            Engine::Unreal => unreal::settings(facts),
            Engine::Unity => unity::settings(facts),
            Engine::Godot => godot::settings(facts),
            Engine::Azgaar => Value::Null,
        }
    }

    /// The end of a tile's name: column `x` from the west and row `y` from the north of `tiles`.
    pub fn tile_suffix(engine: Option<Engine>, x: usize, y: usize, tiles: usize) -> String {
        match engine {
            Some(Engine::Unity) => unity::tile_suffix(x, y, tiles),
            _ => format!("_x{x}_y{y}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_size_is_near_by_ratio() {
        assert_eq!(Engine::Unreal.nearest_size(512), 505);
        assert_eq!(Engine::Unreal.nearest_size(1024), 1009);
        assert_eq!(Engine::Unreal.nearest_size(20_000), 8129);
        assert_eq!(Engine::Unity.nearest_size(16), 33);
        assert_eq!(Engine::Godot.nearest_size(1000), 1024);
        assert_eq!(Engine::Azgaar.nearest_size(777), 777);
    }

    #[test]
    fn names_are_found() {
        for engine in Engine::ALL {
            assert_eq!(Engine::from_name(engine.demands().name), Some(engine));
        }
        assert_eq!(Engine::from_name("source"), None);
    }
}
