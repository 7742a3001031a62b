//! Parameters of the stage `rivers`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rivers and lakes on the ground as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RiversParams {
    /// Runoff where no stage has made a layer `runoff` or `rain`.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "mm/yr", "x-effect" = "larger rivers"))]
    pub rain_mm_per_yr: f64,
    /// A hollow of less area is no lake: it is drained or filled. Where absent, 1/10000 of the map, and at least four cells.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "km2", "x-effect" = "fewer lakes"))]
    pub smallest_lake_km2: Option<f64>,
    /// A hollow that is nowhere deeper is no lake.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "m", "x-effect" = "fewer lakes"))]
    pub shallowest_lake_m: f64,
    /// Discharge from which water is a river; where absent, the runoff of 1/4000 of the map.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "m3/s", "x-effect" = "fewer and longer rivers"))]
    pub least_discharge_m3_s: Option<f64>,
    /// Bank-full discharge, which shapes the bed, over the year's mean.
    #[schemars(range(min = 0.1, max = 100.0), extend("x-unit" = "1", "x-effect" = "wider and deeper beds"))]
    pub bankfull_ratio: f64,
    /// Bed cut into the ground, as a share of the river's depth; 0 leaves the ground alone, hollows apart.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1", "x-effect" = "deeper beds in the heightmap"))]
    pub carve: f64,
    /// Net loss of a lake to the air: what evaporates from it less what falls on it. Above 0, lakes of dry basins stay below
    /// their brim and have no outlet.
    #[schemars(range(min = 0.0, max = 5000.0), extend("x-unit" = "mm/yr", "x-effect" = "smaller lakes, more of them closed"))]
    pub lake_loss_mm_per_yr: f64,
}

impl Default for RiversParams {
    fn default() -> Self {
        Self {
            rain_mm_per_yr: 600.0,
            smallest_lake_km2: None,
            shallowest_lake_m: 3.0,
            least_discharge_m3_s: None,
            bankfull_ratio: 3.0,
            carve: 1.0,
            lake_loss_mm_per_yr: 0.0,
        }
    }
}
