//! The colours of layers: ramps by palette, classes by name, identities by number.

use super::palette::{Ramp, Rgb, hex, lch};
use crate::world::{Kind, Layer, Palette, Spec};

/// Colours of what plate boundaries do, in the catalogue's order; the overlay draws with them too.
pub const BOUNDARIES: [u32; 5] = [0xe6e2d8, 0xc8283c, 0x7b2d8e, 0xe8871e, 0x2f8f4e];
/// Biomes, in the catalogue's order.
const BIOMES: [u32; 12] = [
    0xc6dce6, 0xf6f9fb, 0xb7b4a0, 0x5f826c, 0x86ab6b, 0x3f8270, 0xd6d190, 0xbfaa70, 0xecdcb0, 0xcdb85c, 0x93ab4e,
    0x3a7d4c,
];
/// Stream orders, from no stream.
const ORDERS: [u32; 10] =
    [0xf1efe8, 0xcfdde4, 0xa9c8dd, 0x7dadd0, 0x518fc0, 0x3271ac, 0x225693, 0x1a3f78, 0x142c5c, 0x0e1c40];
/// No basin: the sea.
const NO_BASIN: u32 = 0xdde7ea;

const SEQUENTIAL: [u32; 6] = [0x2a1a50, 0x33508c, 0x2c7f90, 0x3fa878, 0x9acd58, 0xf8e962];
const DIVERGING: [u32; 7] = [0x233f8f, 0x4f83c4, 0xa9c9e6, 0xf5f3ee, 0xf0b795, 0xd2604f, 0x8c1b33];
const AGE: [u32; 7] = [0x9c1430, 0xdf5a3c, 0xf6ad55, 0xf3e6a0, 0x93ccac, 0x4191b8, 0x3a4796];
const SLOPE: [u32; 6] = [0xf4f2ec, 0xdbd5c8, 0xe5bd80, 0xdb7a4c, 0xa9272c, 0x590e26];
const RAIN: [u32; 7] = [0xe3c58e, 0xefe3b4, 0xc4d9a0, 0x86c1a0, 0x489fae, 0x2d6fa6, 0x2b3f85];
const WATER: [u32; 6] = [0xf1efe8, 0xc6dbe6, 0x8bb8d8, 0x4a88be, 0x245a9a, 0x112f66];
/// A hundred degrees a step: cold ground is grey; from 500 to 900 to 1200 straight lines in linear light.
const HEAT: [u32; 13] = [
    0xb4b0a8, 0x8d8a84, 0x63615d, 0x403f3c, 0x1e1d1c, 0x000000, 0x890000, 0xbc0000, 0xe10000, 0xff0000, 0xff9c00,
    0xffd500, 0xffff00,
];
/// Powers of ten that a logarithmic scale spans.
const DECADES: f64 = 5.0;

fn codes(palette: Palette) -> &'static [u32] {
    match palette {
        Palette::Diverging => &DIVERGING,
        Palette::Age => &AGE,
        Palette::Slope => &SLOPE,
        Palette::Rain => &RAIN,
        Palette::Water | Palette::Flow => &WATER,
        Palette::Heat => &HEAT,
        _ => &SEQUENTIAL,
    }
}

/// How colours go by values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// In proportion.
    Even,
    /// By square roots, so that a little rain is told from less.
    Roots,
    /// By powers of ten.
    Powers,
}

/// The colours of a quantity.
pub struct Scale {
    ramp: Ramp,
    /// The values at its ends, or their roots or logarithms.
    ends: [f64; 2],
    steps: Steps,
}

impl Scale {
    /// Over values of a layer; one by powers of ten ends at the greatest.
    pub fn over(spec: &Spec, [low, high]: [f64; 2]) -> Self {
        let top = libm::log10(high.max(1e-9));
        let (steps, ends) = match spec.palette {
            Palette::Flow => (Steps::Powers, [top - DECADES, top]),
            Palette::Rain => (Steps::Roots, [0.0, high.max(1e-9).sqrt()]),
            _ => (Steps::Even, [low, high]),
        };
        Self { ramp: Ramp::even(codes(spec.palette), ends), ends, steps }
    }

    /// How it goes by values.
    pub fn steps(&self) -> Steps {
        self.steps
    }

    /// The values at its ends, or their roots or logarithms.
    pub fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// The colour at a share of the way between the ends.
    pub fn between(&self, share: f64) -> Rgb {
        self.ramp.at((self.ends[0] + (self.ends[1] - self.ends[0]) * share) as f32)
    }

    /// The colour of a value.
    #[inline]
    pub fn at(&self, value: f32) -> Rgb {
        self.ramp.at(match self.steps {
            Steps::Even => value,
            Steps::Roots => value.max(0.0).sqrt(),
            Steps::Powers => libm::log10f(value.max(1e-12)),
        })
    }
}

/// The colour of an identity or a class of a layer.
pub fn named(layer: Layer, value: f32) -> Rgb {
    let of = |codes: &[u32]| {
        let i = (value as usize).min(codes.len() - 1);
        hex(codes[i])
    };
    match layer {
        Layer::BoundaryKind => of(&BOUNDARIES),
        Layer::Biome => of(&BIOMES),
        Layer::StreamOrder => of(&ORDERS),
        Layer::Basin if value == 0.0 => hex(NO_BASIN),
        _ => identity(value),
    }
}

/// A colour for an identity, far from those of its neighbours in number: hues by the golden angle.
pub fn identity(id: f32) -> Rgb {
    let i = id as f64;
    let third = i.rem_euclid(3.0);
    lch(0.66 + 0.07 * third, 0.10 + 0.012 * third, 30.0 + i * 137.507_764)
}

/// A layer's colours on a scale that does not depend on any world, for films.
pub enum Colours {
    /// A quantity, over the catalogue's range.
    Scale(Scale),
    /// Identities or named classes.
    Named(Layer),
}

impl Colours {
    /// Those of a layer; `None` where heights' own colours serve.
    pub fn fixed(layer: Layer) -> Option<Self> {
        let spec = layer.spec();
        match spec.kind {
            Kind::Continuous if spec.palette == Palette::Elevation => None,
            Kind::Continuous => Some(Colours::Scale(Scale::over(&spec, spec.range))),
            Kind::Id | Kind::Class(_) => Some(Colours::Named(layer)),
        }
    }

    /// Whether values are names, which have no between.
    pub fn named(&self) -> bool {
        matches!(self, Colours::Named(_))
    }

    /// The colour of a value.
    pub fn at(&self, value: f32) -> Rgb {
        match self {
            Colours::Scale(scale) => scale.at(value),
            Colours::Named(layer) => named(*layer, value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relief::palette::Encoder;

    #[test]
    fn neighbouring_identities_differ() {
        let encoder = Encoder::new();
        let colours: Vec<[u8; 3]> = (0..40).map(|id| encoder.bytes(identity(id as f32))).collect();
        let apart = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(a, b)| a.abs_diff(b) as u32).sum::<u32>();
        for i in 0..40 {
            for j in i + 1..(i + 6).min(40) {
                assert!(apart(colours[i], colours[j]) > 40, "{i} {j}");
            }
        }
    }

    #[test]
    fn every_class_has_a_colour_of_its_own() {
        for &layer in Layer::ALL {
            let Kind::Class(names) = layer.spec().kind else { continue };
            let mut colours: Vec<[u32; 3]> =
                (0..names.len()).map(|i| named(layer, i as f32).map(f32::to_bits)).collect();
            colours.sort_unstable();
            colours.dedup();
            assert_eq!(colours.len(), names.len(), "{}", layer.name());
        }
    }

    #[test]
    fn a_scale_of_powers_steps_evenly_by_tens() {
        let spec = Layer::Discharge.spec();
        let scale = Scale::over(&spec, [0.0, 1000.0]);
        assert_eq!(scale.steps(), Steps::Powers);
        assert_eq!(scale.at(1000.0), scale.between(1.0));
        let apart = scale.at(1.0).iter().zip(scale.between(0.4)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-4, "{apart}");
        assert_eq!(scale.at(0.0), scale.between(0.0));
    }
}
