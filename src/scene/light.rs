//! Sun, sky, air and shadow.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the light comes from. The sun's place follows from the time of day and the latitude, or is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SunParams {
    /// Solar time: 12 when the sun stands highest.
    #[schemars(range(min = 0.0, max = 48.0), extend("x-unit" = "h", "x-effect" = "later in the day"))]
    pub time_of_day_h: f64,
    /// Time of day at the end of a film, to which it moves; it stands still if not given.
    #[schemars(range(min = 0.0, max = 72.0), extend("x-unit" = "h", "x-effect" = "a faster day"))]
    pub to_time_of_day_h: Option<f64>,
    /// Latitude of the map for the sun's path.
    #[schemars(range(min = -90.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "farther north"))]
    pub latitude_deg: f64,
    /// Tilt of the sun to the equator: 23.4 at midsummer of the north, -23.4 at midwinter.
    #[schemars(range(min = -23.5, max = 23.5), extend("x-unit" = "deg", "x-effect" = "longer days in the north"))]
    pub declination_deg: f64,
    /// Where the sun stands, 0 north, 90 east, instead of by the time of day.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the light clockwise"))]
    pub azimuth_deg: Option<f64>,
    /// How high it stands, instead of by the time of day.
    #[schemars(range(min = -90.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "shorter shadows"))]
    pub altitude_deg: Option<f64>,
    /// Angle across the sun's disc: how soft shadows are.
    #[schemars(range(min = 0.1, max = 20.0), extend("x-unit" = "deg", "x-effect" = "softer shadows"))]
    pub disc_deg: f64,
}

impl Default for SunParams {
    fn default() -> Self {
        Self {
            time_of_day_h: 16.0,
            to_time_of_day_h: None,
            latitude_deg: 40.0,
            declination_deg: 10.0,
            azimuth_deg: None,
            altitude_deg: None,
            disc_deg: 1.2,
        }
    }
}

/// The sky.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SkyParams {
    /// How bright the picture is, in stops: each doubles it.
    #[schemars(range(min = -8.0, max = 8.0), extend("x-unit" = "stops", "x-effect" = "brighter"))]
    pub exposure: f64,
    /// Dust and vapour in the air, 1 on a clear day.
    #[schemars(range(min = 0.0, max = 20.0), extend("x-unit" = "1", "x-effect" = "a whiter sky, redder evenings"))]
    pub dust: f64,
    /// Strength of moonlight, stars and the moon.
    #[schemars(range(min = 0.0, max = 20.0), extend("x-unit" = "1", "x-effect" = "brighter nights"))]
    pub night: f64,
    /// A picture of the whole sky, twice as wide as high, north in its middle, instead of the computed one.
    #[schemars(extend("x-path" = true))]
    pub picture: Option<String>,
    /// Whether the sun dazzles, with faint rings of the lens.
    pub glare: bool,
}

impl Default for SkyParams {
    fn default() -> Self {
        Self { exposure: 0.0, dust: 1.0, night: 1.0, picture: None, glare: true }
    }
}

/// Haze and mist.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FogParams {
    /// Whether there is any.
    pub on: bool,
    /// Distance at which 5 % of contrast is left, in longer sides of the map.
    #[schemars(range(min = 0.05, max = 1000.0), extend("x-unit" = "sides", "x-effect" = "clearer air"))]
    pub visibility: f64,
    /// Height in which haze thins to 37 %, in heights of the land.
    #[schemars(range(min = 0.01, max = 100.0), extend("x-unit" = "1", "x-effect" = "haze reaches higher"))]
    pub height: f64,
    /// How much the haze is tinted by the sun behind it.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "warmer haze towards the sun"))]
    pub sun_tint: f64,
    /// Rays of light where the land shades the haze; with full quality.
    pub shafts: bool,
    /// Strength of these rays.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1", "x-effect" = "brighter rays"))]
    pub shaft_strength: f64,
}

impl Default for FogParams {
    fn default() -> Self {
        Self { on: true, visibility: 9.0, height: 0.8, sun_tint: 0.6, shafts: true, shaft_strength: 1.0 }
    }
}

/// What throws shadows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ShadowParams {
    /// Whether the land throws any: soft ones, sharper near what throws them.
    pub on: bool,
    /// Strength: 0 none, 1 all that the sun gives.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "darker shadows"))]
    pub strength: f64,
    /// How much darker valleys are than the open sky makes them: 0 not at all, 1 as computed.
    #[schemars(range(min = 0.0, max = 2.0), extend("x-unit" = "1", "x-effect" = "darker valleys"))]
    pub occlusion: f64,
}

impl Default for ShadowParams {
    fn default() -> Self {
        Self { on: true, strength: 1.0, occlusion: 1.0 }
    }
}
