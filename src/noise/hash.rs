//! Counter-based random numbers: what is drawn depends on the key and the index alone, never on what was drawn before.

/// Names one random stream: a seed mixed with words that say what the numbers are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u64);

/// SplitMix64's step constant, 2^64 divided by the golden ratio (Steele, Lea, Flood 2014).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// SplitMix64's finaliser: every input bit flips each output bit with probability about one half.
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

impl Key {
    /// The root key of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(mix(seed.wrapping_add(GOLDEN)))
    }

    /// A key for one more number: an index, a step, a plate.
    pub const fn with(self, word: u64) -> Self {
        Self(mix(self.0 ^ mix(word.wrapping_add(GOLDEN)).rotate_left(23)))
    }

    /// A key for a purpose named in words.
    pub fn named(self, purpose: &str) -> Self {
        // FNV-1a; `with` does the mixing.
        let name =
            purpose.bytes().fold(0xCBF2_9CE4_8422_2325_u64, |h, b| (h ^ b as u64).wrapping_mul(0x0100_0000_01B3));
        self.with(name)
    }

    /// The hash of a lattice point under this key.
    #[inline]
    pub const fn lattice(self, ix: i32, iy: i32) -> u64 {
        let point = (ix as u32 as u64) << 32 | iy as u32 as u64;
        mix(self.0 ^ mix(point.wrapping_mul(GOLDEN)))
    }

    /// The stream of numbers under this key.
    pub const fn stream(self) -> Stream {
        Stream { key: self.0, index: 0 }
    }
}

/// A sequence of random numbers: the n-th depends on the key and n only.
#[derive(Clone, Debug)]
pub struct Stream {
    key: u64,
    index: u64,
}

impl Stream {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.index += 1;
        mix(self.key.wrapping_add(self.index.wrapping_mul(GOLDEN)))
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform integer in 0..n (n > 0); the bias of the multiply-shift is below n / 2^64.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.bits() as u128 * n as u128) >> 64) as usize
    }

    /// Standard normal (Box-Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.unit(), self.unit());
        (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_bytes_are_uniform_and_not_symmetric() {
        let key = Key::new(7).named("test");
        let (mut counts, mut product, n) = ([0u32; 256], 0.0, 400i32);
        for y in 0..n {
            for x in 0..n {
                counts[(key.lattice(x, y) >> 56) as usize] += 1;
                let unit = |h: u64| (h >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                if x != y {
                    product += unit(key.lattice(x, y)) * unit(key.lattice(y, x));
                }
            }
        }
        let mean = (n * n) as f64 / 256.0;
        let chi2: f64 = counts.iter().map(|&c| (c as f64 - mean).powi(2) / mean).sum();
        // 255 degrees of freedom: mean 255, standard deviation 22.6; five of them either way.
        assert!((255.0 - chi2).abs() < 113.0, "{chi2}");
        // The correlation's standard error is 12 / (n·√2) of the variance 1/12.
        let correlation = product / (n * n) as f64 * 12.0;
        assert!(correlation.abs() < 5.0 * 1.42 / n as f64, "{correlation}");
    }

    #[test]
    fn streams_are_standard() {
        let mut stream = Key::new(1).with(3).stream();
        let n = 200_000;
        let (mut sum, mut square) = (0.0, 0.0);
        for _ in 0..n {
            let v = stream.normal();
            sum += v;
            square += v * v;
        }
        assert!((sum / n as f64).abs() < 0.012);
        assert!((square / n as f64 - 1.0).abs() < 0.016);
        assert!((0..1000).all(|_| stream.below(3) < 3));
    }

    #[test]
    fn keys_differ_by_word_order_and_name() {
        let root = Key::new(0);
        assert_ne!(root.with(1).with(2), root.with(2).with(1));
        assert_ne!(root.named("rain"), root.named("wind"));
        assert_ne!(Key::new(0), Key::new(1));
    }
}
