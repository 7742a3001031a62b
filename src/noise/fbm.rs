//! Fractal sums of lattice noise.
//!
//! `f(x) = Σ λ^(−iH)·noise(λ^i·R^i·x/L + o_i)`, with its exact gradient, scaled to unit standard deviation. Profiles have
//! a spectrum `∝ k^(−(2H+1))`, surfaces `∝ k^(−(2H+2))`.
//!
//! Octaves finer than the caller's cells are left out, the last one fading in. The scale is that of the whole endless
//! series (or of the octaves asked for), never of those that a grid resolves, so that another size refines the land and
//! doesn't change it.

use super::{
    Key,
    lattice::{Basis, Seed, Square},
};

/// More octaves than any grid resolves.
const MOST_OCTAVES: usize = 32;

/// Parameters of a fractal sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fbm {
    /// Lattice size of the first octave, m.
    pub wavelength_m: f64,
    /// Hurst exponent, above 0 to 1 (and a little more): how fast octaves lose height. 1 is smooth, 0.2 rough.
    pub hurst: f64,
    /// Ratio of the wavelengths of successive octaves, above 1.
    pub lacunarity: f64,
    /// Octaves at most; the last may be a fraction. Without it as many as the cells resolve.
    pub octaves: Option<f64>,
    /// Turn from one octave to the next, rad.
    pub rotation_rad: f64,
    /// The noise that is summed.
    pub basis: Basis,
}

impl Default for Fbm {
    fn default() -> Self {
        Self {
            wavelength_m: 1.0,
            hurst: 0.8,
            // Irrational-like, so that lattices of different octaves never line up.
            lacunarity: 2.07,
            octaves: None,
            rotation_rad: 0.5,
            basis: Basis::Gradient,
        }
    }
}

impl Fbm {
    /// The default sum with this wavelength and Hurst exponent.
    pub fn new(wavelength_m: f64, hurst: f64) -> Self {
        Self { wavelength_m, hurst, ..Self::default() }
    }

    /// The sum under a key, as far as cells of `cell_m` resolve it. With `cell_m` 0, as many octaves as were asked for,
    /// or 32.
    pub fn octaves(&self, key: Key, cell_m: f64) -> Octaves {
        let mut stream = key.named("octaves").stream();
        let turn = std::f64::consts::TAU * stream.unit();
        let wanted = self.octaves.unwrap_or(MOST_OCTAVES as f64).clamp(0.0, MOST_OCTAVES as f64);
        let gain = libm::pow(self.lacunarity, -self.hurst);
        let mut octaves = Vec::new();
        for i in 0..wanted.ceil() as usize {
            let wavelength_m = self.wavelength_m / libm::pow(self.lacunarity, i as f64);
            // In full from two cells times λ on, not at all below two cells.
            let resolved =
                if cell_m > 0.0 { libm::log(wavelength_m / (2.0 * cell_m)) / libm::log(self.lacunarity) } else { 1.0 };
            let share = (wanted - i as f64).min(resolved).clamp(0.0, 1.0);
            if share == 0.0 {
                break;
            }
            let (sin, cos) = libm::sincos(turn + i as f64 * self.rotation_rad);
            octaves.push(Octave {
                seed: Seed::new(key.with(i as u64)),
                turn: [cos / wavelength_m, sin / wavelength_m],
                offset: [1024.0 * stream.unit(), 1024.0 * stream.unit()],
                weight: libm::pow(gain, i as f64),
                share,
            });
        }
        let nominal = |power: i32| match self.octaves {
            None if gain < 1.0 => 1.0 / (1.0 - gain.powi(power)),
            _ => (0..wanted.ceil() as usize)
                .map(|i| libm::pow(gain, (power as usize * i) as f64) * (wanted - i as f64).min(1.0).powi(power))
                .sum(),
        };
        let scale = 1.0 / (nominal(2).sqrt() * self.basis.deviation());
        Octaves { octaves, basis: self.basis, scale, total: nominal(1) }
    }
}

/// A fractal sum made ready for a key and a cell size.
#[derive(Clone, Debug)]
pub struct Octaves {
    octaves: Vec<Octave>,
    basis: Basis,
    /// Brings the weighted sum to unit standard deviation.
    scale: f64,
    /// Sum of the weights of the whole series.
    total: f64,
}

/// One octave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Octave {
    seed: Seed,
    /// Cosine and sine of its turn, per metre.
    turn: [f64; 2],
    offset: [f64; 2],
    /// λ^(−iH).
    pub(super) weight: f64,
    /// How much of it is there, 0 to 1; below 1 for the last.
    pub(super) share: f64,
}

impl Octave {
    #[inline(always)]
    fn place(&self, at_m: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * at_m[0] - s * at_m[1] + self.offset[0], s * at_m[0] + c * at_m[1] + self.offset[1]]
    }

    /// The octave's noise, −1 to 1, without weight or share.
    #[inline(always)]
    fn noise(&self, basis: Basis, at_m: [f64; 2]) -> f64 {
        basis.at(self.seed, self.place(at_m)).0
    }

    #[inline(always)]
    fn noise_and_slope(&self, basis: Basis, at_m: [f64; 2]) -> (f64, [f64; 2]) {
        self.turned(basis.at(self.seed, self.place(at_m)))
    }

    /// Turns a slope back onto the map.
    #[inline(always)]
    fn turned(&self, (n, [gx, gy]): (f64, [f64; 2])) -> (f64, [f64; 2]) {
        let [c, s] = self.turn;
        (n, [c * gx + s * gy, c * gy - s * gx])
    }
}

impl Octaves {
    /// The sum at a point in metres: mean 0, standard deviation 1 (less what the cells can't resolve).
    #[inline]
    pub fn value(&self, at_m: [f64; 2]) -> f64 {
        // One loop per basis, so that the choice is not made in it.
        match self.basis {
            Basis::Value => self.sum(Basis::Value, at_m),
            Basis::Gradient => self.sum(Basis::Gradient, at_m),
            Basis::Simplex => self.sum(Basis::Simplex, at_m),
        }
    }

    #[inline(always)]
    fn sum(&self, basis: Basis, at_m: [f64; 2]) -> f64 {
        self.octaves.iter().map(|o| o.weight * o.share * o.noise(basis, at_m)).sum::<f64>() * self.scale
    }

    /// A reader for many places one after the other.
    pub fn sampler(&self) -> Sampler<'_> {
        Sampler { sum: self, squares: self.octaves.iter().map(|o| Square::any(o.seed)).collect() }
    }

    /// The sum and its gradient per metre.
    pub fn gradient(&self, at_m: [f64; 2]) -> (f64, [f64; 2]) {
        self.sum_with_slope(self.octaves.iter().map(|octave| (octave, octave.noise_and_slope(self.basis, at_m))))
    }

    #[inline(always)]
    fn sum_with_slope<'a>(&self, parts: impl Iterator<Item = (&'a Octave, (f64, [f64; 2]))>) -> (f64, [f64; 2]) {
        let (mut value, mut slope) = (0.0, [0.0, 0.0]);
        for (octave, (n, g)) in parts {
            let weight = octave.weight * octave.share;
            value += weight * n;
            slope[0] += weight * g[0];
            slope[1] += weight * g[1];
        }
        (value * self.scale, [slope[0] * self.scale, slope[1] * self.scale])
    }

    /// Number of octaves, the fading one included.
    pub fn len(&self) -> usize {
        self.octaves.len()
    }

    /// Whether the cells resolve nothing of it.
    pub fn is_empty(&self) -> bool {
        self.octaves.is_empty()
    }
}

/// Reads a fractal sum at many places. Where a place lies in the same lattice squares as the one before, the hashes are
/// spared: about twice as fast along a row of cells. The values are those of [`Octaves`], bit for bit.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    sum: &'a Octaves,
    squares: Vec<Square>,
}

impl Sampler<'_> {
    /// [`Octaves::value`].
    #[inline]
    pub fn value(&mut self, at_m: [f64; 2]) -> f64 {
        if self.sum.basis != Basis::Gradient {
            return self.sum.value(at_m);
        }
        self.octaves(at_m).map(|(octave, noise)| octave.weight * octave.share * noise).sum::<f64>() * self.sum.scale
    }

    /// [`Octaves::gradient`].
    #[inline]
    pub fn gradient(&mut self, at_m: [f64; 2]) -> (f64, [f64; 2]) {
        if self.sum.basis != Basis::Gradient {
            return self.sum.gradient(at_m);
        }
        let parts = self.sum.octaves.iter().zip(&mut self.squares);
        self.sum.sum_with_slope(
            parts.map(|(octave, square)| (octave, octave.turned(square.read(octave.seed, octave.place(at_m))))),
        )
    }

    /// Sum of the weights of the whole series.
    pub(super) fn total(&self) -> f64 {
        self.sum.total
    }

    /// The octaves, their noises, −1 to 1, and the slopes of these per metre, without weight or share.
    pub(super) fn octaves_and_slopes(&mut self, at_m: [f64; 2]) -> impl Iterator<Item = (&Octave, (f64, [f64; 2]))> {
        let basis = self.sum.basis;
        self.sum.octaves.iter().zip(&mut self.squares).map(move |(octave, square)| {
            let noise = match basis {
                Basis::Gradient => octave.turned(square.read(octave.seed, octave.place(at_m))),
                other => octave.noise_and_slope(other, at_m),
            };
            (octave, noise)
        })
    }

    /// The octaves and their noises, −1 to 1, without weight or share.
    #[inline(always)]
    pub(super) fn octaves(&mut self, at_m: [f64; 2]) -> impl Iterator<Item = (&Octave, f64)> {
        let basis = self.sum.basis;
        self.sum.octaves.iter().zip(&mut self.squares).map(move |(octave, square)| {
            let noise = match basis {
                Basis::Gradient => square.read(octave.seed, octave.place(at_m)).0,
                other => octave.noise(other, at_m),
            };
            (octave, noise)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_per_metre_is_exact() {
        let mut stream = Key::new(1).stream();
        for basis in [Basis::Value, Basis::Gradient, Basis::Simplex] {
            let fbm = Fbm { octaves: Some(7.5), basis, ..Fbm::new(2000.0, 0.7) };
            let sum = fbm.octaves(Key::new(3), 0.0);
            assert_eq!(sum.len(), 8);
            let step = 1e-4 * 2000.0 / libm::pow(fbm.lacunarity, 7.0);
            for _ in 0..500 {
                let at = [stream.between(-1e5, 1e5), stream.between(-1e5, 1e5)];
                let (value, slope) = sum.gradient(at);
                assert!((value - sum.value(at)).abs() < 1e-12);
                let length = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
                for axis in 0..2 {
                    let shift = |by: f64| {
                        let mut p = at;
                        p[axis] += by;
                        sum.value(p)
                    };
                    let measured = (shift(step) - shift(-step)) / (2.0 * step);
                    assert!((measured - slope[axis]).abs() < 1e-4 * length.max(1e-3), "{basis:?} {at:?}");
                }
            }
        }
    }

    #[test]
    fn a_sampler_gives_the_same_bits() {
        let mut stream = Key::new(1).stream();
        for basis in [Basis::Value, Basis::Gradient, Basis::Simplex] {
            let sum = Fbm { basis, ..Fbm::new(2000.0, 0.7) }.octaves(Key::new(3), 20.0);
            let mut sampler = sum.sampler();
            for i in 0..3000 {
                let start = stream.between(-1e4, 1e4);
                let at = [if i % 3 == 0 { start } else { i as f64 * 11.0 }, 77.0];
                assert_eq!(sampler.value(at).to_bits(), sum.value(at).to_bits());
                assert_eq!(sampler.gradient(at), sum.gradient(at));
            }
        }
    }

    #[test]
    fn finer_cells_only_add() {
        let fbm = Fbm::new(100e3, 0.5);
        let (coarse, fine) = (fbm.octaves(Key::new(2), 2000.0), fbm.octaves(Key::new(2), 500.0));
        assert!(coarse.len() < fine.len());
        for (c, f) in coarse.octaves.iter().zip(&fine.octaves) {
            assert_eq!((c.weight, c.turn, c.offset), (f.weight, f.turn, f.offset));
        }
        assert_eq!(coarse.scale, fine.scale);
        // 100 km / 2.07^4 = 5.4 km: log(5.4/4)/log 2.07 = 0.42 of it is there.
        let last = coarse.octaves.last().unwrap();
        assert_eq!(coarse.len(), 5);
        assert!((last.share - 0.425).abs() < 0.005, "{}", last.share);
        assert!(fbm.octaves(Key::new(2), 60e3).is_empty());
    }

    #[test]
    fn unit_standard_deviation_for_any_hurst() {
        for hurst in [0.2, 0.5, 1.0] {
            let mut squares = 0.0;
            let n = 40_000;
            for i in 0..n {
                // A new key each time: the samples are independent.
                let sum = Fbm::new(1.0, hurst).octaves(Key::new(i), 0.0);
                squares += sum.value([0.3, 0.8]).powi(2);
            }
            // Standard error of a variance √(2/n) = 0.7 %; five of them. 32 octaves leave out 5e-5 at the least.
            assert!((squares / n as f64 - 1.0).abs() < 0.036, "{hurst}: {}", squares / n as f64);
        }
    }
}
