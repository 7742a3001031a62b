//! `[scene]`: how a world is to be seen. Camera, light, air, water, ground and glow as plain numbers with a schema.
//!
//! This room knows no adapter and draws nothing: recipes, the command line and the application fill these structs,
//! `render` reads them.

mod camera;
mod light;
mod look;

pub use camera::{CameraParams, KeyParams, Movement};
pub use light::{FogParams, ShadowParams, SkyParams, SunParams};
pub use look::{BloomParams, GroundParams, GroundStyle, LavaLook, SmokeLook, WaterLook, WaterParams};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How carefully a picture is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// While something moves: coarse ground, plain colours, no glow.
    Draft,
    /// For films.
    #[default]
    Normal,
    /// For stills: smooth edges, reflections of the land, shafts of light.
    Full,
}

/// What lies around the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Surround {
    /// Sea where most of the rim is sea, else a block.
    #[default]
    Auto,
    /// Nothing: the map is cut out as a block.
    Block,
    /// Open sea.
    Sea,
}

/// All of `[scene]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SceneParams {
    /// How carefully pictures are drawn: draft, normal or full; stills take full and films normal if it is not given.
    pub quality: Option<Quality>,
    /// How much higher than it is the land looks; chosen by its relief and extent if not given, 1 for less than 40 km.
    #[schemars(range(min = 0.1, max = 100.0), extend("x-unit" = "1", "x-effect" = "steeper, more dramatic land"))]
    pub exaggeration: Option<f64>,
    /// What lies around the map: the sea where its rim is sea (auto), nothing (block), or the sea.
    pub surround: Surround,
    /// Where it is seen from, and how that moves through a film.
    pub camera: CameraParams,
    /// Where the light comes from.
    pub sun: SunParams,
    /// The sky, by day and by night, and how bright the picture is.
    pub sky: SkyParams,
    /// Haze and mist.
    pub fog: FogParams,
    /// What throws shadows.
    pub shadow: ShadowParams,
    /// What covers the land.
    pub ground: GroundParams,
    /// Sea, lakes and rivers.
    pub water: WaterParams,
    /// Lava, flowing and frozen.
    pub lava: LavaLook,
    /// Smoke over vents.
    pub smoke: SmokeLook,
    /// The glow around what is bright.
    pub bloom: BloomParams,
}
