//! Colours. Ramps run through a few control points in Oklab (Ottosson 2020), so that equal steps look equal; pixels
//! are mixed in linear light and turned to sRGB at the end.

/// Linear red, green, blue, 0 to 1.
pub type Rgb = [f32; 3];

/// A colour by its sRGB hexadecimal.
pub fn hex(code: u32) -> Rgb {
    [16, 8, 0].map(|shift| to_linear(((code >> shift) & 255) as f64 / 255.0) as f32)
}

/// `a` to `b`.
#[inline(always)]
pub fn mix(a: Rgb, b: Rgb, t: f32) -> Rgb {
    each(|i| a[i] + (b[i] - a[i]) * t)
}

/// A value for red, green, and blue. Unlike `map` of an array it is always inlined, which pixels need.
#[inline(always)]
pub fn each<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

fn to_linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

fn to_srgb(v: f64) -> f64 {
    if v <= 0.0031308 { v * 12.92 } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 }
}

/// Turns linear values to sRGB bytes.
pub struct Encoder {
    table: Vec<u8>,
}

impl Encoder {
    /// Fine enough that the darkest bytes are a dozen entries apart.
    const SIZE: usize = 1 << 14;

    /// The table.
    pub fn new() -> Self {
        let top = (Self::SIZE - 1) as f64;
        Self { table: (0..Self::SIZE).map(|i| (to_srgb(i as f64 / top) * 255.0 + 0.5) as u8).collect() }
    }

    /// One colour.
    #[inline(always)]
    pub fn bytes(&self, rgb: Rgb) -> [u8; 3] {
        each(|c| self.byte(Self::place(rgb[c])))
    }

    /// Where the byte of a linear value stands.
    #[inline(always)]
    pub fn place(value: f32) -> u16 {
        // What is no number is black.
        let value = if value > 0.0 { value.min(1.0) } else { 0.0 };
        nearest(value * (Self::SIZE - 1) as f32) as u16
    }

    /// The byte at a place.
    #[inline(always)]
    pub fn byte(&self, place: u16) -> u8 {
        self.table[usize::from(place)]
    }
}

/// The whole number nearest to one from 0 to 65,535, in a way of which processors take many at once: so far from zero a
/// float has no room for fractions.
#[inline(always)]
pub fn nearest(value: f32) -> u32 {
    const WHOLE: f32 = 8_388_608.0;
    (value + WHOLE).to_bits() - WHOLE.to_bits()
}

fn oklab(rgb: Rgb) -> [f64; 3] {
    let [r, g, b] = rgb.map(|v| v as f64);
    let l = libm::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    let m = libm::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    let s = libm::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    [
        0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
        1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s,
    ]
}

fn from_oklab([lightness, a, b]: [f64; 3]) -> Rgb {
    let l = lightness + 0.3963377774 * a + 0.2158037573 * b;
    let m = lightness - 0.1055613458 * a - 0.0638541728 * b;
    let s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    let [l, m, s] = [l, m, s].map(|v| v * v * v);
    [
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
    ]
    .map(|v| v.clamp(0.0, 1.0) as f32)
}

/// A colour by Oklab lightness, chroma and hue in degrees.
pub fn lch(lightness: f64, chroma: f64, hue_deg: f64) -> Rgb {
    let hue = hue_deg.to_radians();
    from_oklab([lightness, chroma * libm::cos(hue), chroma * libm::sin(hue)])
}

/// Colours over a range of values.
#[derive(Clone, Debug)]
pub struct Ramp {
    low: f32,
    per_value: f32,
    colours: Vec<Rgb>,
}

impl Ramp {
    const SIZE: usize = 1024;

    /// Through `(value, sRGB)` points in rising order; constant beyond the ends.
    pub fn new(stops: &[(f64, u32)]) -> Self {
        let (low, high) = (stops[0].0, stops[stops.len() - 1].0);
        let labs: Vec<(f64, [f64; 3])> = stops.iter().map(|&(v, code)| (v, oklab(hex(code)))).collect();
        let colours = (0..Self::SIZE)
            .map(|i| {
                let v = low + (high - low) * i as f64 / (Self::SIZE - 1) as f64;
                let k = labs.partition_point(|s| s.0 <= v).clamp(1, labs.len() - 1);
                let ((v0, a), (v1, b)) = (labs[k - 1], labs[k]);
                let t = ((v - v0) / (v1 - v0)).clamp(0.0, 1.0);
                from_oklab([0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * t))
            })
            .collect();
        Self { low: low as f32, per_value: ((Self::SIZE - 1) as f64 / (high - low)) as f32, colours }
    }

    /// Colours evenly spread over `[low, high]`.
    pub fn even(codes: &[u32], [low, high]: [f64; 2]) -> Self {
        let last = (codes.len() - 1) as f64;
        let stop = |(i, &code): (usize, &u32)| (low + (high - low) * i as f64 / last, code);
        Self::new(&codes.iter().enumerate().map(stop).collect::<Vec<_>>())
    }

    /// The values at its ends.
    pub fn ends(&self) -> [f32; 2] {
        [self.low, self.low + (Self::SIZE - 1) as f32 / self.per_value]
    }

    /// The colour of a value.
    #[inline(always)]
    pub fn at(&self, value: f32) -> Rgb {
        let at = ((value - self.low) * self.per_value).clamp(0.0, (Self::SIZE - 1) as f32);
        let i = usize::from(at as u16).min(Self::SIZE - 2);
        mix(self.colours[i], self.colours[i + 1], at - i as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_through_linear_light() {
        let encoder = Encoder::new();
        for byte in 0..=255u32 {
            let code = byte << 16 | (255 - byte) << 8 | byte;
            let [r, g, b] = encoder.bytes(hex(code)).map(u32::from);
            assert_eq!(r << 16 | g << 8 | b, code);
        }
    }

    #[test]
    fn oklab_there_and_back() {
        for code in [0x000000, 0xffffff, 0x12fe80, 0xb05020] {
            let back = from_oklab(oklab(hex(code)));
            assert!(back.iter().zip(hex(code)).all(|(a, b)| (a - b).abs() < 1e-5), "{code:x}");
        }
        assert!((oklab(hex(0xffffff))[0] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_ramp_meets_its_points_and_steps_evenly() {
        let ramp = Ramp::new(&[(-10.0, 0x000000), (0.0, 0x404040), (10.0, 0xffffff)]);
        let encoder = Encoder::new();
        assert_eq!(encoder.bytes(ramp.at(-99.0)), [0; 3]);
        assert_eq!(encoder.bytes(ramp.at(99.0)), [255; 3]);
        assert_eq!(encoder.bytes(ramp.at(0.0)), [0x40; 3]);
        let light = |v: f32| oklab(ramp.at(v))[0];
        assert!((light(7.5) - light(5.0) - (light(5.0) - light(2.5))).abs() < 1e-3);
    }
}
