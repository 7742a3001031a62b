//! What an ash fall can be told.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The ash of an eruption, fallen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct AshParams {
    /// Volume of the ash as it lies, with what falls outside the map.
    #[schemars(range(min = 0.0, max = 1e5), extend("x-unit" = "km3", "x-effect" = "thicker ash"))]
    pub volume_km3: f64,
    /// Height of the eruption column over the vent.
    #[schemars(range(min = 0.1, max = 60.0), extend("x-unit" = "km", "x-effect" = "ash falls further off, thinner near the vent"))]
    pub column_km: f64,
    /// Where it stands, east and south of the map's north-west corner, also outside the map; without, at the youngest of the
    /// table `vents`, or the summit.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves it east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Where the wind comes from: 0 north, 90 east.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "deg", "x-effect" = "turns the fan clockwise"))]
    pub wind_from_deg: f64,
    /// Speed of the wind, the mean of the air that ash falls through.
    #[schemars(range(min = 0.0, max = 150.0), extend("x-unit" = "m/s", "x-effect" = "a longer fan"))]
    pub wind_m_per_s: f64,
    /// Median size of the grains.
    #[schemars(range(min = 0.001, max = 100.0), extend("x-unit" = "mm", "x-effect" = "falls nearer to the vent"))]
    pub median_mm: f64,
    /// Spread of the sizes: standard deviation of their logarithm, in doublings (phi).
    #[schemars(range(min = 0.0, max = 5.0), extend("x-unit" = "phi", "x-effect" = "thick near the vent and far-reaching"))]
    pub spread_phi: f64,
    /// Density of grains.
    #[schemars(range(min = 100.0, max = 5000.0), extend("x-unit" = "kg/m3", "x-effect" = "falls nearer to the vent"))]
    pub grain_kg_per_m3: f64,
    /// How much the column lets go near its top rather than all along it: Suzuki's A.
    #[schemars(range(min = 0.0, max = 50.0), extend("x-unit" = "1", "x-effect" = "falls further off"))]
    pub top_heavy: f64,
    /// Eddy diffusivity of the air.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "m2/s", "x-effect" = "a wider fan"))]
    pub diffusivity_m2_per_s: f64,
    /// Radius of the column, as a share of the height in it.
    #[schemars(range(min = 0.01, max = 1.0), extend("x-unit" = "1", "x-effect" = "a wider, thinner deposit about the vent"))]
    pub width: f64,
}

impl Default for AshParams {
    fn default() -> Self {
        Self {
            volume_km3: 0.1,
            column_km: 12.0,
            at_km: None,
            wind_from_deg: 270.0,
            wind_m_per_s: 10.0,
            median_mm: 0.5,
            spread_phi: 1.5,
            grain_kg_per_m3: 1000.0,
            top_heavy: 4.0,
            diffusivity_m2_per_s: 1000.0,
            width: 0.15,
        }
    }
}
