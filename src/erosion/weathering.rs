//! Weathering: how fast rock turns to loose ground where a climate is known, as a multiple of what it does at 10 °C and under
//! a metre of rain a year.
//!
//! Two ways add up. Water dissolves: in proportion to rain, and faster where it is warm, by Arrhenius' law with the activation
//! energy that White and Blum (1995) found for silicates in 68 catchments of granite. Frost cracks: most where the mean of
//! the year lies some degrees below freezing and water is there to freeze (Hales and Roering 2007), up to twice the rate
//! of reference on alpine walls. What soil and screes are made of comes from both, so creep and slides wait for them.

use rayon::prelude::*;

use crate::world::{Layer, World};

/// Activation energy of weathering over the gas constant, K.
const ACTIVATION_K: f64 = 60e3 / 8.314;
/// Where the rate is 1: temperature, degC, and rain, mm/yr.
const REFERENCE: (f64, f64) = (10.0, 1000.0);
/// Absolute zero, degC.
const ZERO_DEGC: f64 = -273.15;
/// Mean temperature at which frost cracks most, and how far from it the effect is down to 1/e, degC.
const FROST_DEGC: (f64, f64) = (-4.0, 5.0);
/// Rain that gives frost all the water it can use, mm/yr.
const FROST_RAIN_MM: f64 = 500.0;
/// Frost at its best, in rates of reference.
const FROST: f64 = 2.0;
/// Least and greatest rate.
const BOUNDS: [f64; 2] = [0.05, 5.0];

/// The rate of weathering in a climate, as a multiple of that at 10 °C and 1000 mm/yr.
pub fn weathering(temperature_degc: f64, rain_mm_per_yr: f64) -> f64 {
    let inverse = |degc: f64| 1.0 / (degc - ZERO_DEGC).max(1.0);
    let warmth = libm::exp(ACTIVATION_K * (inverse(REFERENCE.0) - inverse(temperature_degc)));
    let dissolved = rain_mm_per_yr / REFERENCE.1 * warmth;
    let off = (temperature_degc - FROST_DEGC.0) / FROST_DEGC.1;
    let cracked = FROST * libm::exp(-off * off) * (rain_mm_per_yr / FROST_RAIN_MM).min(1.0);
    (dissolved + cracked).clamp(BOUNDS[0], BOUNDS[1])
}

/// How fast the cells of a map weather.
pub(super) struct Pace {
    /// The greatest rate on the map, as a multiple of that of reference.
    pub(super) most: f64,
    /// Share of it that each cell has.
    pub(super) share: Vec<f32>,
}

/// The pace of a world; none where no climate is known.
pub(super) fn pace(world: &World) -> Option<Pace> {
    let (temperature, rain) = (world.layer(Layer::Temperature)?, world.layer(Layer::Rain)?);
    let cells = temperature.data.par_iter().zip(&rain.data);
    let rate: Vec<f64> = cells.map(|(&t, &mm)| weathering(f64::from(t), f64::from(mm).max(0.0))).collect();
    let most = rate.iter().fold(BOUNDS[0], |most, &rate| most.max(rate));
    Some(Pace { most, share: rate.into_iter().map(|rate| (rate / most) as f32).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn climates_weather_as_they_should() {
        let near = |rate: f64, want: f64| (rate / want - 1.0).abs() < 1e-3;
        // The frost of 10 °C is a sixteenth of a thousandth.
        assert!(near(weathering(10.0, 1000.0), 1.0 + 2.0 * (-7.84f64).exp()));
        // 60 kJ/mol: 3.6 times as fast 15 K warmer, half the rain half as fast.
        assert!(near(weathering(25.0, 1000.0), 3.605));
        assert!(near(weathering(25.0, 500.0), 0.5 * 3.605));
        // Alpine walls weather faster than temperate hills, cold deserts and dry ones hardly at all.
        assert!(weathering(-4.0, 1500.0) > 2.0);
        assert_eq!((weathering(-40.0, 100.0), weathering(20.0, 0.0), weathering(60.0, 1e4)), (0.05, 0.05, 5.0));
    }
}
