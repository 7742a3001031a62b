//! What land, water, lava and smoke look like. Colours are sRGB, "#rrggbb".

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the land's cover is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundStyle {
    /// By height, slope and the world's own maps: weather, flow, deposits, snow.
    #[default]
    Natural,
    /// By height and slope alone: sand, grass, rock and snow in bands.
    Bands,
    /// By the map's colours of heights and climates.
    Map,
}

/// What covers the land.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GroundParams {
    /// How the cover is chosen: natural, bands or map.
    pub style: GroundStyle,
    /// Height from which snow lies; by the world's climate if not given, else 2800 m over the sea.
    #[schemars(range(min = -12000.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "less snow"))]
    pub snow_line_m: Option<f64>,
    /// Height over the sea up to which beaches reach.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "m", "x-effect" = "wider beaches"))]
    pub sand_m: f64,
    /// Slope at which plants begin to leave bare rock, and at which none is left.
    #[schemars(inner(range(min = 0.0, max = 90.0)), extend("x-unit" = "deg", "x-rising" = true))]
    pub rock_deg: [f64; 2],
    /// Slope at which snow begins to slide, and at which none is left.
    #[schemars(inner(range(min = 0.0, max = 90.0)), extend("x-unit" = "deg", "x-rising" = true))]
    pub snow_deg: [f64; 2],
    /// Strength of the textures' relief.
    #[schemars(range(min = 0.0, max = 4.0), extend("x-unit" = "1", "x-effect" = "rougher ground"))]
    pub relief: f64,
}

impl Default for GroundParams {
    fn default() -> Self {
        Self {
            style: GroundStyle::Natural,
            snow_line_m: None,
            sand_m: 4.0,
            rock_deg: [28.0, 42.0],
            snow_deg: [38.0, 55.0],
            relief: 1.0,
        }
    }
}

/// How water is coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WaterLook {
    /// By what it absorbs and scatters.
    #[default]
    Natural,
    /// A dark to a light colour towards the shore, by a cubic ramp.
    Rim,
    /// Cells of light on dark.
    Cellular,
}

/// Sea, lakes and rivers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WaterParams {
    /// Whether the sea is drawn.
    pub sea: bool,
    /// Whether lakes, rivers and running water are drawn.
    pub inland: bool,
    /// How it is coloured: natural, rim or cellular.
    pub look: WaterLook,
    /// Colour where it is deep.
    #[schemars(extend("x-colour" = true))]
    pub dark: String,
    /// Colour where it is shallow.
    #[schemars(extend("x-colour" = true))]
    pub light: String,
    /// Depth in which light falls to 37 %; a large map's if not given.
    #[schemars(range(min = 0.01, max = 5000.0), extend("x-unit" = "m", "x-effect" = "clearer water"))]
    pub clarity_m: Option<f64>,
    /// Height of the waves: 0 a mirror, 1 a breeze, 4 a storm.
    #[schemars(range(min = 0.0, max = 8.0), extend("x-unit" = "1", "x-effect" = "rougher sea"))]
    pub waves: f64,
    /// Length of the longest waves; by the map's extent if not given.
    #[schemars(range(min = 0.1, max = 100000.0), extend("x-unit" = "m", "x-effect" = "longer waves"))]
    pub wave_m: Option<f64>,
    /// Octaves of noise in the waves and of the cellular look.
    #[schemars(range(min = 1, max = 8), extend("x-unit" = "1", "x-effect" = "finer ripples"))]
    pub octaves: u32,
    /// Width of the rim look's rim and size of the cellular look's cells, 1 as the map's extent suggests.
    #[schemars(range(min = 0.01, max = 100.0), extend("x-unit" = "1", "x-effect" = "a wider rim, larger cells"))]
    pub scale: f64,
    /// Foam along coasts.
    #[schemars(range(min = 0.0, max = 4.0), extend("x-unit" = "1", "x-effect" = "whiter coasts"))]
    pub foam: f64,
    /// Whether the land is mirrored; with full quality.
    pub reflections: bool,
}

impl Default for WaterParams {
    fn default() -> Self {
        Self {
            sea: true,
            inland: true,
            look: WaterLook::Natural,
            dark: "#0b2a4a".into(),
            light: "#3fa7a5".into(),
            clarity_m: None,
            waves: 1.0,
            wave_m: None,
            octaves: 4,
            scale: 1.0,
            foam: 1.0,
            reflections: true,
        }
    }
}

/// Lava, flowing and frozen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LavaLook {
    /// Whether it is drawn.
    pub on: bool,
    /// Whether it glows as a black body does, or by the three colours.
    pub black_body: bool,
    /// Colours at 500, 900 and 1200 degC.
    #[schemars(extend("x-colour" = true))]
    pub colours: [String; 3],
    /// Strength of its glow.
    #[schemars(range(min = 0.0, max = 20.0), extend("x-unit" = "1", "x-effect" = "brighter lava"))]
    pub glow: f64,
    /// How much of flowing lava is dark crust.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "more crust"))]
    pub crust: f64,
    /// Whether particles are drawn as one surface, or as spheres.
    pub spheres: bool,
}

impl Default for LavaLook {
    fn default() -> Self {
        Self {
            on: true,
            black_body: true,
            colours: ["#000000".into(), "#ff0000".into(), "#ffff00".into()],
            glow: 1.0,
            crust: 0.5,
            spheres: false,
        }
    }
}

/// Smoke over vents.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SmokeLook {
    /// Whether it is drawn.
    pub on: bool,
    /// How much it hides.
    #[schemars(range(min = 0.0, max = 4.0), extend("x-unit" = "1", "x-effect" = "denser smoke"))]
    pub density: f64,
}

impl Default for SmokeLook {
    fn default() -> Self {
        Self { on: true, density: 1.0 }
    }
}

/// The glow around what is bright.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BloomParams {
    /// Whether there is any.
    pub on: bool,
    /// Share of the light that is spread.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "more glow"))]
    pub strength: f64,
    /// Brightness from which it glows; 1 is white.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1", "x-effect" = "only brighter things glow"))]
    pub threshold: f64,
}

impl Default for BloomParams {
    fn default() -> Self {
        Self { on: true, strength: 0.08, threshold: 1.0 }
    }
}
