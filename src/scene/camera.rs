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
    /// Over the land, through its target, from one side of the map to the other.
    Fly,
    /// Not at all, straight above, north up.
    Top,
    /// Not at all.
    Still,
}

impl Movement {
    /// All of them, with their names.
    pub const ALL: [(&str, Movement); 4] =
        [("orbit", Movement::Orbit), ("fly", Movement::Fly), ("top", Movement::Top), ("still", Movement::Still)];
}

/// Where the world is seen from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CameraParams {
    /// How it moves through a film; where there are keys, it moves by them.
    pub movement: Movement,
    /// The point it looks at, from the map's west and north rim; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km"))]
    pub target_km: Option<[f64; 2]>,
    /// The side it looks from: 0 north, 90 east, 180 south; 200 if not given, and 180 from the top.
    #[schemars(range(min = -3600.0, max = 3600.0), extend("x-unit" = "deg", "x-effect" = "moves the camera clockwise around its target"))]
    pub from_deg: Option<f64>,
    /// How far it looks down: 0 along the ground, 90 straight down; 28 if not given, 14 in flight, 90 from the top.
    #[schemars(range(min = -30.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "looks more from above"))]
    pub down_deg: Option<f64>,
    /// Distance to its target, in longer sides of the map; 1.25 if not given, 0.3 in flight; from the top, that which shows the whole map.
    #[schemars(range(min = 0.0001, max = 20.0), extend("x-unit" = "sides", "x-effect" = "farther away"))]
    pub distance: Option<f64>,
    /// Angle of view from the picture's lower to its upper edge; 35 if not given, 45 in flight, 15 from the top.
    #[schemars(range(min = 2.0, max = 120.0), extend("x-unit" = "deg", "x-effect" = "a wider lens"))]
    pub view_deg: Option<f64>,
    /// Angle that it turns through a film in orbit, clockwise; it starts and ends gently, but for whole turns.
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
            from_deg: None,
            down_deg: None,
            distance: None,
            view_deg: None,
            turn_deg: 40.0,
            keys: Vec::new(),
        }
    }
}

/// A place of the camera at one moment of a film. What is not given is as in the key before, in the first one as for the camera.
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
