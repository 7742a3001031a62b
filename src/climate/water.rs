//! What becomes of the rain: the height where snow outlasts the summer, and what runs off.

use super::Zone;

/// Nothing on Earth stands higher, m.
const HIGHEST_M: f64 = 9000.0;
/// More than this does not lie through a winter, whatever falls, mm: about the wettest glaciers of the fit below.
const MOST_SNOW_MM: f64 = 2500.0;
/// Least evaporation that air could take up in a year, mm: ice evaporates too.
const LEAST_MM: f64 = 50.0;

/// What air could take up in a year at a mean temperature (Turc 1954), mm.
pub fn thirst_mm_per_yr(temperature_degc: f64) -> f64 {
    let t = temperature_degc;
    (300.0 + 25.0 * t + 0.05 * t * t * t).max(LEAST_MM)
}

/// What a year's rain leaves to rivers (Turc 1954 in the form of Pike 1964): rain less what air and plants take up.
pub fn runoff_mm_per_yr(rain_mm_per_yr: f64, temperature_degc: f64) -> f64 {
    let wetness = rain_mm_per_yr.max(0.0) / thirst_mm_per_yr(temperature_degc);
    rain_mm_per_yr.max(0.0) * (1.0 - 1.0 / (1.0 + wetness * wetness).sqrt())
}

/// Temperature of the warm season at which a year's snow just melts: that at the equilibrium line of glaciers, where
/// `snow = 645 + 296 T + 9 T²` (Ohmura, Kasser and Funk 1992).
pub fn snow_temperature_degc(snow_mm_per_yr: f64) -> f64 {
    let snow = snow_mm_per_yr.clamp(0.0, MOST_SNOW_MM);
    (-296.0 + (296.0 * 296.0 - 36.0 * (645.0 - snow)).sqrt()) / 18.0
}

/// Height over the sea where the warmest month melts a year's snow and no more, m.
pub fn snow_line_m(zone: &Zone, rain_mm_per_yr: f64) -> f64 {
    let above_k = zone.sea_degc + zone.summer_k - snow_temperature_degc(rain_mm_per_yr);
    if above_k <= 0.0 { 0.0 } else { (above_k / zone.lapse_k_per_m.max(1e-6)).min(HIGHEST_M) }
}
