//! Volcanoes that stand somewhere: their heights over the map, and the exact gradient of these.
//!
//! A volcano's noise multiplies its shape by `exp(f·N)`, so that it follows the height and never turns it round: `N` is the
//! sum of fBm at two frequencies and turbulence, each of unit standard deviation over its amplitude, and `f` fades from 1 at
//! `r_v` to 0 at `τ·r_v`. Towards a crater's middle it falls to a tenth: the noise goes with the height above the foot, of
//! which a crater is but a small part, and would bury it. Wear then works on the height. Several join as `(Σ zᵢ⁴)^¼`: alone, each keeps its height, where
//! two meet there is no crease, and a crater on another's flank stays one.

use super::{age::Wear, profile::Cone};
use crate::noise::{Fbm, Key, Octaves, Sampler, smoothstep};

/// Mean and standard deviation of the absolute value of gradient noise, measured at 128,000 places, to 0.001.
const FOLDED: [f64; 2] = [0.249, 0.176];
/// Strength of the noise of twice the frequency over that of the first.
const SECOND: f64 = 0.5;

/// Share of the noise that a crater's middle has.
const FLOOR: f64 = 0.1;

/// How rough a volcano is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Standard deviation of the fBm, as a share of the height.
    pub noise: f64,
    /// Standard deviation of the turbulence, likewise.
    pub turbulence: f64,
    /// Waves over a radius.
    pub frequency: f64,
    /// Hurst exponent of both: 1 is smooth, 0.2 rough.
    pub hurst: f64,
}

impl Roughness {
    /// Mean and standard deviation of the turbulence. Octaves weigh `g^i` with `g = λ^(−H)`, and their sum is divided by that
    /// of the weights: the mean is that of one, the deviation `√((1 − g)/(1 + g))` of it.
    pub(super) fn turbulence(&self) -> [f64; 2] {
        let gain = libm::pow(Fbm::default().lacunarity, -self.hurst);
        let [mean, deviation] = FOLDED;
        [mean, deviation * ((1.0 - gain) / (1.0 + gain)).sqrt()]
    }
}

/// A volcano and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Edifice {
    /// Its axis, from the map's north-west corner, m.
    pub at_m: [f64; 2],
    /// Its shape when it was active.
    pub cone: Cone,
    /// Its roughness.
    pub rough: Roughness,
    /// The root of its noise.
    pub key: Key,
    /// Years since it was active.
    pub age_yr: f64,
    /// What time has done to it.
    pub wear: Option<Wear>,
}

/// Volcanoes made ready to be read.
#[derive(Clone, Debug)]
pub struct Edifices {
    all: Vec<Ready>,
}

#[derive(Clone, Debug)]
struct Ready {
    edifice: Edifice,
    /// fBm at two frequencies, and what turbulence is made of.
    noises: [Octaves; 3],
    /// Mean and standard deviation of the turbulence.
    turbulence: [f64; 2],
}

impl Edifices {
    /// Volcanoes as far as cells of `cell_m` resolve their noise.
    pub fn new(all: Vec<Edifice>, cell_m: f64) -> Self {
        let ready = |edifice: Edifice| {
            let wave_m = edifice.cone.radius_m / edifice.rough.frequency;
            let noise = |name: &str, wave_m: f64| {
                Fbm::new(wave_m, edifice.rough.hurst).octaves(edifice.key.named(name), cell_m)
            };
            let noises = [noise("first", wave_m), noise("second", 0.5 * wave_m), noise("turbulence", wave_m)];
            let turbulence = edifice.rough.turbulence();
            Ready { edifice, noises, turbulence }
        };
        Self { all: all.into_iter().map(ready).collect() }
    }

    /// A reader for many places one after the other.
    pub fn reader(&self) -> Reader<'_> {
        Reader { all: self.all.iter().map(|ready| (ready, ready.noises.each_ref().map(Octaves::sampler))).collect() }
    }
}

/// Reads the surface of volcanoes.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    all: Vec<(&'a Ready, [Sampler<'a>; 3])>,
}

impl Reader<'_> {
    /// Height above the foot at a place, m.
    pub fn height(&mut self, at_m: [f64; 2]) -> f64 {
        if let [(ready, noises)] = self.all.as_mut_slice() {
            return ready.height(noises, at_m);
        }
        let sum: f64 = self.all.iter_mut().map(|(ready, noises)| fourth(ready.height(noises, at_m))).sum();
        sum.sqrt().sqrt()
    }

    /// Height above the foot and its gradient. Turbulence has creases, where it takes one side's.
    pub fn gradient(&mut self, at_m: [f64; 2]) -> (f64, [f64; 2]) {
        let (mut sum, mut slope) = (0.0, [0.0; 2]);
        for (ready, noises) in &mut self.all {
            let (z, g) = ready.gradient(noises, at_m);
            sum += fourth(z);
            let by = z * z * z;
            slope = [slope[0] + by * g[0], slope[1] + by * g[1]];
        }
        let z = sum.sqrt().sqrt();
        let by = if z > 0.0 { 1.0 / (z * z * z) } else { 0.0 };
        (z, slope.map(|s| s * by))
    }
}

fn fourth(z: f64) -> f64 {
    z * z * (z * z)
}

impl Ready {
    fn height(&self, noises: &mut [Sampler; 3], at_m: [f64; 2]) -> f64 {
        let r_m = libm::hypot(at_m[0] - self.edifice.at_m[0], at_m[1] - self.edifice.at_m[1]);
        let (shape, _) = self.edifice.cone.at(r_m);
        let faded = self.faded(r_m).0;
        let rough = if faded > 0.0 && shape > 0.0 { libm::exp(faded * self.noise(noises, at_m)) } else { 1.0 };
        let z = shape * rough;
        self.edifice.wear.map_or(z, |wear| wear.on(z).0)
    }

    fn gradient(&self, noises: &mut [Sampler; 3], at_m: [f64; 2]) -> (f64, [f64; 2]) {
        let out = [at_m[0] - self.edifice.at_m[0], at_m[1] - self.edifice.at_m[1]];
        let r_m = libm::hypot(out[0], out[1]);
        let radial = if r_m > 0.0 { out.map(|d| d / r_m) } else { [0.0; 2] };
        let (shape, fall) = self.edifice.cone.at(r_m);
        let (faded, fades) = self.faded(r_m);
        let (noise, slope) = self.noise_and_slope(noises, at_m);
        let rough = libm::exp(faded * noise);
        let z = shape * rough;
        let (worn, by) = self.edifice.wear.map_or((z, 1.0), |wear| wear.on(z));
        let along = |axis: usize| {
            by * rough * (fall * radial[axis] + shape * (fades * radial[axis] * noise + faded * slope[axis]))
        };
        (worn, [along(0), along(1)])
    }

    /// How much of the noise is there, and its derivative.
    fn faded(&self, r_m: f64) -> (f64, f64) {
        let rim = self.edifice.cone.crater_radius_m;
        if r_m < rim {
            // Level at both ends, so that heights stay smooth at the rim and in the middle.
            let t = r_m / rim;
            return (FLOOR + (1.0 - FLOOR) * smoothstep(t), (1.0 - FLOOR) * 6.0 * t * (1.0 - t) / rim);
        }
        let (from, width) = (self.edifice.cone.radius_m, self.edifice.cone.reach_m() - self.edifice.cone.radius_m);
        if width <= 0.0 {
            return (f64::from(r_m < from), 0.0);
        }
        let t = ((r_m - from) / width).clamp(0.0, 1.0);
        (1.0 - smoothstep(t), -6.0 * t * (1.0 - t) / width)
    }

    fn noise(&self, [first, second, turbulence]: &mut [Sampler; 3], at_m: [f64; 2]) -> f64 {
        let [mean, deviation] = self.turbulence;
        let mut sum = 0.0;
        if self.edifice.rough.noise > 0.0 {
            sum += self.edifice.rough.noise * (first.value(at_m) + SECOND * second.value(at_m));
        }
        if self.edifice.rough.turbulence > 0.0 {
            sum += self.edifice.rough.turbulence / deviation * (turbulence.turbulence(at_m) - mean);
        }
        sum
    }

    fn noise_and_slope(&self, noises: &mut [Sampler; 3], at_m: [f64; 2]) -> (f64, [f64; 2]) {
        let value = self.noise(noises, at_m);
        let [first, second, turbulence] = noises;
        let (a, b, c) = (first.gradient(at_m).1, second.gradient(at_m).1, turbulence.turbulence_gradient(at_m).1);
        let slope = |i: usize| {
            self.edifice.rough.noise * (a[i] + SECOND * b[i])
                + self.edifice.rough.turbulence / self.turbulence[1] * c[i]
        };
        (value, [slope(0), slope(1)])
    }
}
