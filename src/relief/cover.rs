//! Land coloured by climate: where a world has weather, its lowlands are green where it rains and ochre where it does
//! not, dark in the taiga, grey-brown in the tundra, and white above the snow line.
//!
//! Cross-blended hypsometric tints (Patterson and Kelso, Natural Earth): a ramp of heights for each climate, joined by
//! how wet and how warm it is. Wetness is De Martonne's index (1926), rain over temperature + 10. High land is pale and
//! brown in every climate, so that ranges read as ranges.

use super::{
    lava::Lava,
    palette::{Ramp, Rgb, hex, mix},
};
use crate::{
    grid::Field,
    world::{Layer, World},
};

/// Metres over the sea at which the ramps have their colours.
const HEIGHTS_M: [f64; 6] = [0.0, 400.0, 1000.0, 2000.0, 3200.0, 4500.0];
const DRY: [u32; 6] = [0xddd0ad, 0xdac8a0, 0xcfb68f, 0xbda280, 0xaa8f77, 0xa19284];
const TUNDRA: [u32; 6] = [0xaeac93, 0xaba78f, 0xa5a08c, 0x9f998c, 0x9d9892, 0x9f9c99];
const TAIGA: [u32; 6] = [0x6a8c70, 0x769474, 0x8b9d79, 0xa0a084, 0xa29a8c, 0x9e9a96];
const TEMPERATE: [u32; 6] = [0x86aa77, 0x9ab57d, 0xb6bd86, 0xc2b388, 0xae997b, 0xa09286];
const TROPICAL: [u32; 6] = [0x679c66, 0x79a569, 0x99b175, 0xb4ae7d, 0xa99573, 0x9d8f82];
/// Snow in plain light; the sunny side of it is white.
const SNOW: u32 = 0xe8edf3;
/// De Martonne's index of deserts' and of woods' beginnings.
const WETNESS: [f32; 2] = [8.0, 38.0];
/// Mean temperature between tundra and taiga, taiga and temperate, temperate and tropical land, and half the width of
/// the transition, degC.
const BORDERS_DEGC: [f32; 3] = [-5.0, 4.0, 20.0];
const HALF_K: f32 = 4.0;
/// Where snow begins and where it is whole, m over the snow line: a soft edge.
const SNOW_M: [f32; 2] = [-200.0, 900.0];
/// Slopes (tangents) off which snow begins to slide, and on which none lies: 33 and 45 degrees.
const SLIDES: [f32; 2] = [0.65, 1.0];

/// What a place is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climate {
    /// Rain of a year, mm.
    pub rain_mm: f32,
    /// Mean temperature, degC.
    pub temperature_degc: f32,
    /// Height of the snow line, m.
    pub snow_line_m: f32,
    /// Share of the snow that the ground holds, by its steepness.
    pub held: f32,
}

/// The climates that stand for all in a legend: humid and dry.
pub const HUMID: Climate = Climate { rain_mm: 1100.0, temperature_degc: 10.0, snow_line_m: f32::INFINITY, held: 1.0 };
/// See [`HUMID`].
pub const ARID: Climate = Climate { rain_mm: 60.0, ..HUMID };

/// The ramps.
pub struct Tints {
    dry: Ramp,
    /// From cold to warm.
    wet: [Ramp; 4],
    snow: Rgb,
}

impl Tints {
    /// Ready to colour.
    pub fn new() -> Self {
        let ramp = |codes: [u32; 6]| {
            let stops: Vec<(f64, u32)> = HEIGHTS_M.into_iter().zip(codes).collect();
            Ramp::new(&stops)
        };
        Self { dry: ramp(DRY), wet: [TUNDRA, TAIGA, TEMPERATE, TROPICAL].map(ramp), snow: hex(SNOW) }
    }

    /// The flat colour of land at a height, with the sea at `sea_m`.
    pub fn at(&self, climate: Climate, height_m: f32, sea_m: f32) -> Rgb {
        let over_m = (height_m - sea_m).max(0.0);
        let t = climate.temperature_degc;
        let warmer = BORDERS_DEGC.map(|border| smooth(border - HALF_K, border + HALF_K, t));
        // What has no share in the colour is not looked up.
        let wet = || {
            let whole = warmer.iter().rposition(|&share| share >= 1.0).map_or(0, |border| border + 1);
            let mut wet = self.wet[whole].at(over_m);
            for (ramp, &share) in self.wet[whole + 1..].iter().zip(&warmer[whole..]) {
                if share > 0.0 {
                    wet = mix(wet, ramp.at(over_m), share);
                }
            }
            wet
        };
        // A cold desert is rather grey than ochre.
        let dry = || {
            let own = self.dry.at(over_m);
            if warmer[0] >= 1.0 { own } else { mix(mix(own, self.wet[0].at(over_m), 0.7), own, warmer[0]) }
        };
        let wetness = smooth(WETNESS[0], WETNESS[1], climate.rain_mm / (t.max(-6.0) + 10.0));
        let ground = match wetness {
            ..=0.0 => dry(),
            1.0.. => wet(),
            share => mix(dry(), wet(), share),
        };
        mix(ground, self.snow, climate.held * smooth(SNOW_M[0], SNOW_M[1], height_m - climate.snow_line_m))
    }
}

fn smooth(from: f32, to: f32, v: f32) -> f32 {
    let t = ((v - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The layers by which land is coloured where a world has them all.
pub const LAYERS: [Layer; 3] = [Layer::Rain, Layer::Temperature, Layer::SnowLine];

/// What covers the land at a picture's pixels: a climate's colours, lava.
pub struct Cover {
    climate: Option<[Field<f32>; 3]>,
    lava: Option<Lava>,
    tints: Tints,
    sea_m: f32,
}

impl Cover {
    /// That of a world with weather or lava, at a picture's raster.
    pub fn of(world: &World, bring: impl Fn(&Field<f32>) -> Field<f32>) -> Option<Self> {
        let climate = match LAYERS.map(|layer| world.layer(layer)) {
            [Some(rain), Some(temperature), Some(snow)] => Some([rain, temperature, snow].map(&bring)),
            _ => None,
        };
        let lava = Lava::of(world, bring);
        let any = climate.is_some() || lava.is_some();
        any.then(|| Self { climate, lava, tints: Tints::new(), sea_m: world.sea_level_m as f32 })
    }

    /// Whether the land is coloured by its climate.
    pub fn has_climate(&self) -> bool {
        self.climate.is_some()
    }

    /// The flat colour of a pixel's land; `plain` gives that of its height alone.
    pub fn at(&self, heights: &Field<f32>, x: usize, y: usize, plain: impl FnOnce() -> Rgb) -> Rgb {
        let (index, height_m) = (heights.grid.index(x, y), heights.at(x, y));
        let land = match &self.climate {
            None => plain(),
            Some(layers) => {
                let [rain_mm, temperature_degc, snow_line_m] = [0, 1, 2].map(|layer: usize| layers[layer].data[index]);
                let held = if height_m - snow_line_m > SNOW_M[0] { held(heights.gradient(x, y)) } else { 1.0 };
                self.tints.at(Climate { rain_mm, temperature_degc, snow_line_m, held }, height_m, self.sea_m)
            }
        };
        self.lava.as_ref().map_or(land, |lava| lava.over(index, land))
    }
}

/// Share of the snow that ground of a gradient holds.
fn held([east, south]: [f64; 2]) -> f32 {
    1.0 - smooth(SLIDES[0], SLIDES[1], libm::hypot(east, south) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(rain_mm: f32, temperature_degc: f32, height_m: f32) -> Rgb {
        Tints::new().at(Climate { rain_mm, temperature_degc, snow_line_m: 3000.0, held: 1.0 }, height_m, 0.0)
    }

    #[test]
    fn wet_land_is_green_dry_land_is_not_and_snow_is_white() {
        for t in [0.0, 10.0, 25.0] {
            let ([r, g, b], dry) = (at(1500.0, t, 100.0), at(60.0, t, 100.0));
            assert!(g > r && g > b, "{t}");
            assert!(dry[0] > dry[1] && dry[1] > dry[2], "{t}");
        }
        assert!(at(800.0, -12.0, 4200.0).into_iter().all(|c| c > 0.75));
        assert!(at(800.0, -8.0, 2700.0).into_iter().all(|c| c < 0.6));
    }

    #[test]
    fn snow_slides_off_cliffs() {
        assert_eq!([held([0.6, 0.0]), held([0.9, -0.8])], [1.0, 0.0]);
        let seen = |held| {
            Tints::new().at(Climate { rain_mm: 800.0, temperature_degc: -12.0, snow_line_m: 3000.0, held }, 4200.0, 0.0)
        };
        assert!(seen(0.0)[1] < 0.5 && seen(1.0)[1] > 0.75);
    }

    #[test]
    fn no_border_shows() {
        let apart = |a: Rgb, b: Rgb| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        for step in 0..4000 {
            let (rain, t, h) = (step as f32 * 0.5, step as f32 * 0.015 - 30.0, step as f32);
            assert!(apart(at(rain, 8.0, 50.0), at(rain + 0.5, 8.0, 50.0)) < 0.01);
            assert!(apart(at(700.0, t, 50.0), at(700.0, t + 0.015, 50.0)) < 0.01);
            assert!(apart(at(700.0, 8.0, h), at(700.0, 8.0, h + 1.0)) < 0.01);
        }
    }
}
