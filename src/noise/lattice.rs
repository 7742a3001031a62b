//! Noise on a lattice in two dimensions: value and gradient noise (Perlin 2002) on squares, simplex noise (Perlin 2001)
//! on triangles. One lattice cell is one unit of length; all give their exact derivatives and lie within −1 to 1.

use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Key;

/// A kind of lattice noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Basis {
    /// Random values joined by quintic curves: blocky, strong at the lattice's own wavelength.
    Value,
    /// Random slopes joined by quintic curves: the usual one.
    #[default]
    Gradient,
    /// Random slopes on triangles: the least lattice to be seen.
    Simplex,
}

impl Basis {
    /// Standard deviation over the plane.
    pub const fn deviation(self) -> f64 {
        match self {
            // √((2J)²/3) with J = ∫(1−s)² = 181/462 for the quintic s.
            Basis::Value => 0.452_382_678,
            // √(8·I·J) with I = ∫(1−s)²·f².
            Basis::Gradient => 0.305_061_143,
            // 81·√(3/2) · √(π/2 · B(2, 9)/2¹⁰ · √3): the mean square of one corner's bump, times corners a unit area.
            Basis::Simplex => 0.539_013_531,
        }
    }

    /// The noise of a seed at a point in lattice units, and its derivatives.
    #[inline(always)]
    pub(super) fn at(self, seed: Seed, at: [f64; 2]) -> (f64, [f64; 2]) {
        match self {
            Basis::Value => seed.value(at),
            Basis::Gradient => seed.gradient(at),
            Basis::Simplex => seed.simplex(at),
        }
    }
}

/// Value noise at a point in lattice units, and its derivatives.
pub fn value(key: Key, at: [f64; 2]) -> (f64, [f64; 2]) {
    Seed::new(key).value(at)
}

/// Gradient noise at a point in lattice units, and its derivatives.
pub fn gradient(key: Key, at: [f64; 2]) -> (f64, [f64; 2]) {
    Seed::new(key).gradient(at)
}

/// Simplex noise at a point in lattice units, and its derivatives.
pub fn simplex(key: Key, at: [f64; 2]) -> (f64, [f64; 2]) {
    Seed::new(key).simplex(at)
}

/// The largest value of gradient noise with unit slopes is √½.
const GRADIENT_SCALE: f64 = std::f64::consts::SQRT_2;

/// 81·√(3/2): simplex noise with unit slopes is then at most 1, midway between two corners.
const SIMPLEX_SCALE: f64 = 99.204_334;

/// Directions of the random slopes.
static SLOPES: LazyLock<[[f64; 2]; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let (sin, cos) = libm::sincos((i as f64 + 0.5) * std::f64::consts::TAU / 256.0);
        [cos, sin]
    })
});

/// A key made ready for cheap 32-bit lattice hashes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    bits: u32,
    slopes: &'static [[f64; 2]; 256],
}

/// 32-bit finaliser with full avalanche (the constants are Wellons' "lowbias32").
#[inline(always)]
fn mix(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// The lattice line at or before `x`, and how far `x` is past it, 0 to 1. Adding 1.5·2⁵² rounds to an integer that can be
/// read off the bits; a call to the library's `floor` and a saturating cast would cost more than the rest of the noise. On
/// a lattice line the line before may be named, at distance 1: the noise is the same.
#[inline(always)]
fn split(x: f64) -> (i32, f64) {
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let shifted = (x - 0.5) + ROUND;
    (shifted.to_bits() as i32, x - (shifted - ROUND))
}

/// The quintic fade and its derivative.
#[inline(always)]
fn fade(f: f64) -> (f64, f64) {
    (f * f * f * (f * (f * 6.0 - 15.0) + 10.0), 30.0 * f * f * (f - 1.0) * (f - 1.0))
}

impl Seed {
    pub(super) fn new(key: Key) -> Self {
        Self { bits: (key.stream().bits() >> 32) as u32, slopes: &SLOPES }
    }

    /// The hash of a row; `point` joins a column to it.
    #[inline(always)]
    fn row(self, iy: i32) -> u32 {
        mix((iy as u32).wrapping_mul(0x9E37_79B9) ^ self.bits)
    }

    #[inline(always)]
    fn point(row: u32, ix: i32) -> u32 {
        mix((ix as u32).wrapping_mul(0x85EB_CA77).wrapping_add(row))
    }

    #[inline(always)]
    fn slope(self, row: u32, ix: i32) -> [f64; 2] {
        self.slopes[(Self::point(row, ix) >> 24) as usize]
    }

    #[inline(always)]
    fn value(self, at: [f64; 2]) -> (f64, [f64; 2]) {
        let ((ix, fx), (iy, fy)) = (split(at[0]), split(at[1]));
        let ((u, du), (v, dv)) = (fade(fx), fade(fy));
        let (top, bottom) = (self.row(iy), self.row(iy.wrapping_add(1)));
        let level = |row, ix| Self::point(row, ix) as i32 as f64 * (1.0 / 2_147_483_648.0);
        let (a, b) = (level(top, ix), level(top, ix.wrapping_add(1)));
        let (c, d) = (level(bottom, ix), level(bottom, ix.wrapping_add(1)));
        let (k1, k2, k3) = (b - a, c - a, a - b - c + d);
        (a + k1 * u + k2 * v + k3 * u * v, [du * (k1 + k3 * v), dv * (k2 + k3 * u)])
    }

    #[inline(always)]
    fn gradient(self, at: [f64; 2]) -> (f64, [f64; 2]) {
        let ((ix, fx), (iy, fy)) = (split(at[0]), split(at[1]));
        self.square(ix, iy).gradient(fx, fy)
    }

    /// The random slopes around a lattice square.
    #[inline(always)]
    fn square(self, ix: i32, iy: i32) -> Square {
        let (top, bottom) = (self.row(iy), self.row(iy.wrapping_add(1)));
        let east = ix.wrapping_add(1);
        let slopes = [self.slope(top, ix), self.slope(top, east), self.slope(bottom, ix), self.slope(bottom, east)];
        Square { at: (ix, iy), slopes }
    }

    #[inline(always)]
    fn simplex(self, at: [f64; 2]) -> (f64, [f64; 2]) {
        /// (√3 − 1)/2 and (3 − √3)/6.
        const SKEW: f64 = 0.366_025_403_784_438_65;
        const UNSKEW: f64 = 0.211_324_865_405_187_13;
        let skew = (at[0] + at[1]) * SKEW;
        let ((ix, fx), (iy, fy)) = (split(at[0] + skew), split(at[1] + skew));
        let back = (fx + fy) * UNSKEW;
        let r0 = [fx - back, fy - back];
        let east = i32::from(r0[0] > r0[1]);
        let south = 1 - east;
        let r1 = [r0[0] - east as f64 + UNSKEW, r0[1] - south as f64 + UNSKEW];
        let r2 = [r0[0] - 1.0 + 2.0 * UNSKEW, r0[1] - 1.0 + 2.0 * UNSKEW];
        let (top, bottom) = (self.row(iy), self.row(iy.wrapping_add(1)));
        let corners = [
            (r0, self.slope(top, ix)),
            (r1, self.slope(if south == 1 { bottom } else { top }, ix.wrapping_add(east))),
            (r2, self.slope(bottom, ix.wrapping_add(1))),
        ];
        let (mut n, mut slope) = (0.0, [0.0, 0.0]);
        for (r, g) in corners {
            let t = (0.5 - r[0] * r[0] - r[1] * r[1]).max(0.0);
            let along = g[0] * r[0] + g[1] * r[1];
            let (t2, t3) = (t * t, t * t * t);
            n += t2 * t2 * along;
            slope[0] += t2 * t2 * g[0] - 8.0 * t3 * r[0] * along;
            slope[1] += t2 * t2 * g[1] - 8.0 * t3 * r[1] * along;
        }
        (n * SIMPLEX_SCALE, [slope[0] * SIMPLEX_SCALE, slope[1] * SIMPLEX_SCALE])
    }
}

/// A lattice square of gradient noise. Kept between neighbouring samples it saves the hashes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    at: (i32, i32),
    slopes: [[f64; 2]; 4],
}

impl Square {
    pub(super) fn any(seed: Seed) -> Self {
        seed.square(0, 0)
    }

    /// Gradient noise at a point and its derivatives, from this square or the one that it then becomes.
    #[inline(always)]
    pub(super) fn read(&mut self, seed: Seed, at: [f64; 2]) -> (f64, [f64; 2]) {
        let ((ix, fx), (iy, fy)) = (split(at[0]), split(at[1]));
        if self.at != (ix, iy) {
            *self = seed.square(ix, iy);
        }
        self.gradient(fx, fy)
    }

    #[inline(always)]
    fn gradient(&self, fx: f64, fy: f64) -> (f64, [f64; 2]) {
        let ((u, du), (v, dv)) = (fade(fx), fade(fy));
        let [ga, gb, gc, gd] = self.slopes;
        let a = ga[0] * fx + ga[1] * fy;
        let b = gb[0] * (fx - 1.0) + gb[1] * fy;
        let c = gc[0] * fx + gc[1] * (fy - 1.0);
        let d = gd[0] * (fx - 1.0) + gd[1] * (fy - 1.0);
        let (k1, k2, k3) = (b - a, c - a, a - b - c + d);
        let n = a + k1 * u + k2 * v + k3 * u * v;
        let mixed =
            |i: usize| ga[i] + u * (gb[i] - ga[i]) + v * (gc[i] - ga[i]) + u * v * (ga[i] - gb[i] - gc[i] + gd[i]);
        let slope = [mixed(0) + du * (k1 + v * k3), mixed(1) + dv * (k2 + u * k3)];
        (n * GRADIENT_SCALE, [slope[0] * GRADIENT_SCALE, slope[1] * GRADIENT_SCALE])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Basis; 3] = [Basis::Value, Basis::Gradient, Basis::Simplex];

    #[test]
    fn derivatives_are_exact() {
        let mut stream = Key::new(5).stream();
        for basis in ALL {
            for i in 0..2000 {
                let seed = Seed::new(Key::new(2).with(i));
                let at = [stream.between(-50.0, 50.0), stream.between(-50.0, 50.0)];
                let (_, slope) = basis.at(seed, at);
                let step = 1e-5;
                for axis in 0..2 {
                    let shift = |by: f64| {
                        let mut p = at;
                        p[axis] += by;
                        basis.at(seed, p).0
                    };
                    let measured = (shift(step) - shift(-step)) / (2.0 * step);
                    // Third derivatives reach some hundreds: step²/6 of that.
                    assert!((measured - slope[axis]).abs() < 2e-7, "{basis:?} {at:?}: {measured} {}", slope[axis]);
                }
            }
        }
    }

    #[test]
    fn range_mean_and_deviation() {
        let mut stream = Key::new(6).stream();
        for basis in ALL {
            let (mut sum, mut square, mut largest, n) = (0.0, 0.0, 0.0f64, 400_000);
            for i in 0..n {
                let at = [stream.between(-1e4, 1e4), stream.between(-1e4, 1e4)];
                let v = basis.at(Seed::new(Key::new(9).with(i % 7)), at).0;
                sum += v;
                square += v * v;
                largest = largest.max(v.abs());
            }
            let (mean, deviation) = (sum / n as f64, (square / n as f64).sqrt());
            assert!(largest <= 1.0 + 1e-6);
            // Standard errors: deviation/√n and about deviation/√(2n); five of each.
            assert!(mean.abs() < 5.0 * deviation / (n as f64).sqrt(), "{basis:?} {mean}");
            assert!(
                (deviation / basis.deviation() - 1.0).abs() < 5.0 / (2.0 * n as f64).sqrt(),
                "{basis:?} {deviation}"
            );
        }
    }

    #[test]
    fn continuous_across_cells() {
        let key = Key::new(4);
        for noise in [value, gradient, simplex] {
            for i in 0..500 {
                let (x, y) = ((i % 20) as f64 - 10.0, i as f64 * 0.137 - 30.0);
                let (low, high) = (noise(key, [x - 1e-9, y]), noise(key, [x + 1e-9, y]));
                assert!((low.0 - high.0).abs() < 1e-7);
                assert!((low.1[0] - high.1[0]).abs() < 1e-6 && (low.1[1] - high.1[1]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn hashes_are_uniform_and_rows_unrelated() {
        let seed = Seed::new(Key::new(12));
        let (n, mut counts, mut product) = (400i32, [0u32; 256], [0.0f64; 3]);
        let unit = |ix: i32, iy: i32| Seed::point(seed.row(iy), ix) as f64 / 4_294_967_296.0 - 0.5;
        for y in -n / 2..n / 2 {
            for x in -n / 2..n / 2 {
                counts[(Seed::point(seed.row(y), x) >> 24) as usize] += 1;
                product[0] += unit(x, y) * unit(x + 1, y);
                product[1] += unit(x, y) * unit(x, y + 1);
                product[2] += if x < y { unit(x, y) * unit(y, x) } else { 0.0 };
            }
        }
        let points = (n * n) as f64;
        let chi2: f64 = counts.iter().map(|&c| (c as f64 - points / 256.0).powi(2) / (points / 256.0)).sum();
        // 255 degrees of freedom: standard deviation 22.6; five of them.
        assert!((chi2 - 255.0).abs() < 113.0, "{chi2}");
        // Each correlation has a standard error of at most 1/n.
        assert!(product.iter().all(|p| (p / points * 12.0).abs() < 5.0 / n as f64), "{product:?}");
    }
}
