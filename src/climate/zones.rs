//! What latitude alone decides: warmth at the sea, the winds, and how readily air rains out.
//!
//! The three cells of each hemisphere (rising air at 0° and 60°, sinking at 30° and 90°) are waves of six times the
//! latitude: easterly trades to 30°, westerlies to 60°, polar easterlies beyond, calm between them.

use crate::grid::{Edges, Grid};

use super::ClimateParams;

/// Length of a degree of latitude, m.
const DEGREE_M: f64 = 111e3;
/// Mean temperature of the year at sea level on the equator, and how much colder the poles are, degC. Zonal means of
/// the Earth follow the square of the latitude's sine to 2 K or 3 K (North 1975).
const EQUATOR_DEGC: f64 = 28.0;
const POLE_COLDER_K: f64 = 37.0;
/// How much warmer than the year the warmest month is, on the equator, and how much more at the poles, K.
const SUMMER_K: f64 = 1.0;
const SUMMER_POLE_K: f64 = 13.0;
/// Moist adiabats are less steep: an eighth where the sea is as warm as in the tropics, nothing where it is cool.
const MOIST_SHARE: f64 = 0.125;
const MOIST_DEGC: [f64; 2] = [15.0, 27.0];
/// How much the cells' rising and sinking adds to or takes from rain.
const BELTS: f64 = 0.5;
/// The meridional part of the wind, against the zonal one.
const TILT: f64 = 0.5;

/// What one latitude brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Latitude, north positive.
    pub latitude_deg: f64,
    /// Mean temperature of the year at sea level.
    pub sea_degc: f64,
    /// How much warmer the warmest month is.
    pub summer_k: f64,
    /// How fast it gets colder with height.
    pub lapse_k_per_m: f64,
    /// How readily it rains on level ground, 1 on the mean.
    pub belt: f64,
    /// Wind to the east and to the south, 1 at its strongest.
    pub wind: [f64; 2],
}

impl Zone {
    /// At a latitude.
    pub fn at(latitude_deg: f64, params: &ClimateParams) -> Self {
        let sine = libm::sin(latitude_deg.to_radians()).abs();
        let wave = 6.0 * latitude_deg.abs().to_radians();
        let sea_degc = EQUATOR_DEGC - POLE_COLDER_K * sine * sine + params.warmer_k;
        let moist = ((sea_degc - MOIST_DEGC[0]) / (MOIST_DEGC[1] - MOIST_DEGC[0])).clamp(0.0, 1.0);
        let wind = match params.wind_from_deg {
            Some(from_deg) => [-libm::sin(from_deg.to_radians()), libm::cos(from_deg.to_radians())],
            None => {
                let strength = -libm::sin(wave) / (1.0 + TILT * TILT).sqrt();
                // Westerlies blow towards the pole, easterlies towards the equator.
                [strength, -TILT * strength * if latitude_deg < 0.0 { -1.0 } else { 1.0 }]
            }
        };
        Self {
            latitude_deg,
            sea_degc,
            summer_k: SUMMER_K + SUMMER_POLE_K * sine,
            lapse_k_per_m: 1e-3 * params.lapse_k_per_km * (1.0 - MOIST_SHARE * moist),
            belt: 1.0 + BELTS * libm::cos(wave),
            wind,
        }
    }

    /// One for each row of a grid, from the north.
    pub fn rows(grid: &Grid, params: &ClimateParams) -> Vec<Self> {
        let own = grid.extent_m()[1] / DEGREE_M;
        let span = if grid.edges == Edges::Wrap { 0.0 } else { params.latitude_span_deg.unwrap_or(own) };
        let latitude = |y: usize| params.latitude_deg + span * (0.5 - (y as f64 + 0.5) / grid.height as f64);
        (0..grid.height).map(|y| Self::at(latitude(y).clamp(-90.0, 90.0), params)).collect()
    }

    /// Mean temperature of the year at a height over the sea.
    pub fn temperature_degc(&self, over_sea_m: f64) -> f64 {
        self.sea_degc - self.lapse_k_per_m * over_sea_m.max(0.0)
    }
}
