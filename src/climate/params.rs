//! What a recipe can say of the `climate` stage.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Wind, rain, temperature, snow line, and what grows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ClimateParams {
    /// Latitude of the middle of the map; south is negative.
    #[schemars(range(min = -90.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "from the tropics towards a pole: colder, other winds"))]
    pub latitude_deg: f64,
    /// Latitude from the map's south to its north; its own extent at 111 km a degree if not given. A map that wraps has one latitude.
    #[schemars(range(min = 0.0, max = 180.0), extend("x-unit" = "deg", "x-effect" = "more climates on one map, as on a small world"))]
    pub latitude_span_deg: Option<f64>,
    /// Where the wind comes from: 0 north, 90 east; trades, westerlies and polar easterlies by latitude if not given.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the wind clockwise"))]
    pub wind_from_deg: Option<f64>,
    /// How fast moisture travels, the mean of all weathers; about a third of the wind of a day.
    #[schemars(range(min = 0.1, max = 50.0), extend("x-unit" = "m/s", "x-effect" = "carries rain farther inland, more rain on slopes"))]
    pub wind_m_per_s: f64,
    /// How far the wind turns to either side through the year.
    #[schemars(range(min = 0.0, max = 90.0), extend("x-unit" = "deg", "x-effect" = "softer rain shadows"))]
    pub wind_spread_deg: f64,
    /// How much warmer than the Earth of today.
    #[schemars(range(min = -40.0, max = 40.0), extend("x-unit" = "K", "x-effect" = "higher snow, more moisture"))]
    pub warmer_k: f64,
    /// How fast it gets colder with height; warm moist air cools up to an eighth more slowly.
    #[schemars(range(min = 0.0, max = 12.0), extend("x-unit" = "K/km", "x-effect" = "colder mountains, lower snow"))]
    pub lapse_k_per_km: f64,
    /// Mean rain over the land; what the air brings if not given.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "mm/yr", "x-effect" = "more rain everywhere in proportion"))]
    pub rain_mm_per_yr: Option<f64>,
    /// Humidity of the air that comes in over the map's rim: 0 dry, 1 all that it can hold.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "as if a sea lay beyond the rim"))]
    pub rim_humidity: f64,
    /// Smallest feature of the ground that lifts air (a standard deviation of its blur).
    #[schemars(range(min = 1.0, max = 100.0), extend("x-unit" = "km", "x-effect" = "broader bands of rain"))]
    pub air_km: f64,
    /// How far rain drifts downwind while it forms and falls.
    #[schemars(range(min = 1.0, max = 100.0), extend("x-unit" = "km", "x-effect" = "moves rain from slopes to crests and beyond"))]
    pub drift_km: f64,
    /// Share of the water that rising air must lose which falls; the rest of the year it is too dry.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "wetter windward slopes, drier air behind them"))]
    pub lift_share: f64,
    /// How far behind a range air that came down stays dry.
    #[schemars(range(min = 1.0, max = 5000.0), extend("x-unit" = "km", "x-effect" = "longer rain shadows"))]
    pub shadow_km: f64,
    /// Steps in turn with the plates stage before it: the weather follows the land as it rises.
    #[schemars(extend("x-effect" = "rivers cut deeper where ranges catch the rain"))]
    pub coupled: bool,
}

impl Default for ClimateParams {
    fn default() -> Self {
        Self {
            latitude_deg: 45.0,
            latitude_span_deg: None,
            wind_from_deg: None,
            wind_m_per_s: 3.0,
            wind_spread_deg: 30.0,
            warmer_k: 0.0,
            lapse_k_per_km: 6.5,
            rain_mm_per_yr: None,
            rim_humidity: 0.75,
            air_km: 12.0,
            drift_km: 15.0,
            lift_share: 0.2,
            shadow_km: 250.0,
            coupled: false,
        }
    }
}
