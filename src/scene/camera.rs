//! The camera and its path.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the camera moves through a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Movement {
    /// Around its target.
    #[default]
    Orbit,
    /// Over the land, from one side of the map to the other.
    Fly,
    /// Still, from above, north up.
    Top,
    /// Not at all, or by its keys where there are any.
    Still,
}

/// Where the world is seen from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CameraParams {
    /// How it moves through a film.
    pub movement: Movement,
    /// The point it looks at, from the map's west and north rim; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km"))]
    pub target_km: Option<[f64; 2]>,
    /// The side it looks from: 0 north, 90 east, 180 south.
    #[schemars(range(min = -3600.0, max = 3600.0), extend("x-unit" = "deg", "x-effect" = "moves the camera clockwise around its target"))]
    pub from_deg: f64,
    /// How far it looks down: 0 along the ground, 90 straight down.
    #[schemars(range(min = -30.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "looks more from above"))]
    pub down_deg: f64,
    /// Distance to its target, in longer sides of the map.
    #[schemars(range(min = 0.0001, max = 20.0), extend("x-unit" = "sides", "x-effect" = "farther away"))]
    pub distance: f64,
    /// Angle of view from the picture's lower to its upper edge.
    #[schemars(range(min = 2.0, max = 120.0), extend("x-unit" = "deg", "x-effect" = "a wider lens"))]
    pub view_deg: f64,
    /// Angle that it turns through a film, clockwise.
    #[schemars(range(min = -3600.0, max = 3600.0), extend("x-unit" = "deg", "x-effect" = "turns faster"))]
    pub turn_deg: f64,
    /// Places through which it moves in a film, in the order of their time; smooth between them.
    pub keys: Vec<KeyParams>,
}

impl Default for CameraParams {
    fn default() -> Self {
        Self {
            movement: Movement::Orbit,
            target_km: None,
            from_deg: 200.0,
            down_deg: 28.0,
            distance: 1.25,
            view_deg: 35.0,
            turn_deg: 40.0,
            keys: Vec::new(),
        }
    }
}

/// A place of the camera at one moment of a film. What is not given is as in the key before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct KeyParams {
    /// When: 0 at the beginning of the film, 1 at its end.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub at: f64,
    /// The point it looks at, from the map's west and north rim.
    #[schemars(extend("x-unit" = "km"))]
    pub target_km: Option<[f64; 2]>,
    /// The side it looks from: 0 north, 90 east.
    #[schemars(range(min = -3600.0, max = 3600.0), extend("x-unit" = "deg"))]
    pub from_deg: Option<f64>,
    /// How far it looks down.
    #[schemars(range(min = -30.0, max = 90.0), extend("x-unit" = "deg"))]
    pub down_deg: Option<f64>,
    /// Distance to its target, in longer sides of the map.
    #[schemars(range(min = 0.0001, max = 20.0), extend("x-unit" = "sides"))]
    pub distance: Option<f64>,
    /// Angle of view.
    #[schemars(range(min = 2.0, max = 120.0), extend("x-unit" = "deg"))]
    pub view_deg: Option<f64>,
}
