//! What grows and lies on the land, as seen from the air: colours of vegetation and bare soil by weather, or by height
//! where a world has none; snow above its line; loose ground where sediment was laid down.

use super::{fire::Frozen, ground::Lie};
use crate::{
    grid::Field,
    scene::{GroundStyle, SceneParams},
    world::{Layer, World},
};

type Rgb = [f32; 3];

/// Linear reflectances of land seen from above (orders of magnitude after satellite albedos of the visible bands).
const DESERT: Rgb = [0.40, 0.30, 0.19];
const COLD_DESERT: Rgb = [0.27, 0.245, 0.205];
const STEPPE: Rgb = [0.205, 0.185, 0.095];
const MEADOW: Rgb = [0.105, 0.130, 0.045];
const FOREST: Rgb = [0.045, 0.070, 0.026];
const TAIGA: Rgb = [0.036, 0.053, 0.030];
const TUNDRA: Rgb = [0.135, 0.130, 0.085];
const JUNGLE: Rgb = [0.026, 0.062, 0.016];
const BASALT: Rgb = [0.045, 0.042, 0.040];
/// Mean temperature at the sea, its fall with height, and rain of a world without weather.
const TEMPERATE_DEGC: f32 = 12.0;
const LAPSE_K_PER_M: f32 = 0.0065;
const RAIN_MM: f32 = 850.0;
/// Snow line of a world without weather, m over the sea.
const SNOW_LINE_M: f32 = 2800.0;
/// From where snow begins to where it lies whole, m.
const SNOW_M: [f32; 2] = [-250.0, 450.0];
/// Thickness of sediment from which ground is loose, m.
const LOOSE_M: [f32; 2] = [0.4, 6.0];

fn smooth(from: f32, to: f32, v: f32) -> f32 {
    let t = ((v - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A linear share as an sRGB byte.
fn encoded(v: f32) -> u8 {
    super::ground::byte(if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 })
}

fn mix(a: Rgb, b: Rgb, t: f32) -> Rgb {
    [0, 1, 2].map(|c: usize| a[c] + (b[c] - a[c]) * t)
}

/// The colour of land by mean temperature and rain of a year, and how much grows there.
pub fn grown(temperature_degc: f32, rain_mm: f32) -> (Rgb, f32) {
    let t = temperature_degc;
    // De Martonne's index of dryness (1926).
    let wet = rain_mm / (t.max(-6.0) + 10.0);
    let dry = mix(COLD_DESERT, DESERT, smooth(2.0, 16.0, t));
    let open = mix(STEPPE, MEADOW, smooth(14.0, 30.0, wet));
    let wood = mix(mix(TAIGA, FOREST, smooth(2.0, 8.0, t)), JUNGLE, smooth(17.0, 23.0, t));
    let green = mix(open, wood, smooth(22.0, 42.0, wet));
    let warm = mix(TUNDRA, green, smooth(-4.0, 2.5, t));
    let share = smooth(5.0, 18.0, wet) * smooth(-9.0, -1.0, t);
    (mix(dry, warm, share), share)
}

/// The layers that decide.
pub struct Covers<'a> {
    climate: Option<[&'a Field<f32>; 3]>,
    sediment: Option<&'a Field<f32>>,
    lava: Option<Frozen<'a>>,
    wetness: Option<&'a Field<f32>>,
    snow_line_m: Option<f32>,
    sea_m: f32,
    /// The map's own colours, where they are asked for.
    tints: Option<Box<dyn Fn(f32) -> Rgb + Sync + 'a>>,
}

impl<'a> Covers<'a> {
    /// Those of a world.
    pub fn of(world: &'a World, lie: &Lie, scene: &SceneParams) -> Self {
        let climate = match [Layer::Rain, Layer::Temperature, Layer::SnowLine].map(|layer| world.layer(layer)) {
            [Some(rain), Some(temperature), Some(snow)] => Some([rain, temperature, snow]),
            _ => None,
        };
        let tints: Option<Box<dyn Fn(f32) -> Rgb + Sync>> = match scene.ground.style {
            GroundStyle::Map => Some(Box::new(crate::relief::tints(world))),
            _ => None,
        };
        Self {
            climate,
            sediment: world.layer(Layer::Sediment),
            lava: Frozen::of(world),
            wetness: world.layer(Layer::Wetness),
            snow_line_m: scene.ground.snow_line_m.map(|m| m as f32),
            sea_m: lie.sea_m as f32,
            tints,
        }
    }

    /// sRGB and growth of a cell, and its shares of snow and of loose ground.
    pub fn at(&self, index: usize, height_m: f32) -> ([u8; 4], [f32; 2]) {
        let over_m = (height_m - self.sea_m).max(0.0);
        let [rain, temperature, snow_line] = match &self.climate {
            Some(layers) => [0, 1, 2].map(|k: usize| layers[k].data[index]),
            None => [RAIN_MM, TEMPERATE_DEGC - LAPSE_K_PER_M * over_m, SNOW_LINE_M + self.sea_m],
        };
        let snow_line = self.snow_line_m.unwrap_or(snow_line);
        let snow = smooth(SNOW_M[0], SNOW_M[1], height_m - snow_line);
        let loose = self.sediment.map_or(0.0, |s| smooth(LOOSE_M[0], LOOSE_M[1], s.data[index]));
        let (mut colour, mut growth) = grown(temperature, rain);
        if let Some(wetness) = self.wetness {
            // Valley floors are greener than their slopes.
            let wet = smooth(7.0, 12.0, wetness.data[index]) * 0.35;
            colour = mix(colour, grown(temperature, rain * 2.2).0, wet);
        }
        let lava = self.lava.as_ref().map_or(0.0, |lava| lava.bare(index));
        colour = mix(colour, BASALT, 0.9 * lava);
        growth *= 1.0 - lava;
        if let Some(tints) = &self.tints {
            colour = tints(height_m);
        }
        let [r, g, b] = colour.map(encoded);
        ([r, g, b, super::ground::byte(growth)], [snow, loose])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wet_land_is_green_and_dry_land_is_ochre() {
        let ([r, g, b], much) = grown(10.0, 1200.0);
        assert!(g > r && g > b && much > 0.9);
        let ([r, g, b], little) = grown(25.0, 50.0);
        assert!(r > g && g > b && little < 0.1);
    }

    #[test]
    fn no_border_shows() {
        let apart = |a: Rgb, b: Rgb| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        for k in 0..4000 {
            let (t, rain) = (k as f32 * 0.015 - 25.0, k as f32);
            assert!(apart(grown(t, 700.0).0, grown(t + 0.015, 700.0).0) < 0.004);
            assert!(apart(grown(9.0, rain).0, grown(9.0, rain + 1.0).0) < 0.004);
        }
    }
}
