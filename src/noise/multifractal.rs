//! Sums of noise that are not the same everywhere: turbulence, billows, ridges, and Musgrave's multifractals (Musgrave
//! 1993; Ebert et al. 2003), in which what the coarse octaves made decides how much of the fine ones is seen.
//!
//! Signals are the noise itself, −1 to 1; octave `i` weighs `w_i = λ^(−iH)`. Values of the multifractals depend on the
//! data: measure their range, don't assume it.

use super::fbm::Octaves;

impl Octaves {
    /// `Σ w_i·|n_i| / Σ w_i`, 0 to 1: sharp valleys.
    pub fn turbulence(&self, at_m: [f64; 2]) -> f64 {
        self.fold(at_m, |n| n.abs())
    }

    /// `Σ w_i·(2|n_i| − 1) / Σ w_i`, −1 to 1: round hills between sharp valleys.
    pub fn billow(&self, at_m: [f64; 2]) -> f64 {
        self.fold(at_m, |n| 2.0 * n.abs() - 1.0)
    }

    /// `Σ w_i·(1 − |n_i|)² / Σ w_i`, 0 to 1: sharp ridges everywhere.
    pub fn ridged(&self, at_m: [f64; 2]) -> f64 {
        self.fold(at_m, |n| (1.0 - n.abs()) * (1.0 - n.abs()))
    }

    fn fold(&self, at_m: [f64; 2], shape: impl Fn(f64) -> f64) -> f64 {
        let sum: f64 = self.octaves.iter().map(|o| o.weight * o.share * shape(o.noise(self.basis, at_m))).sum();
        sum / self.total
    }

    /// Hybrid multifractal: valleys smooth, heights rough. Each octave is multiplied by the product of those before it.
    pub fn hybrid(&self, at_m: [f64; 2], offset: f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 1.0f64);
        for octave in &self.octaves {
            weight = weight.min(1.0);
            let signal = (octave.noise(self.basis, at_m) + offset) * octave.weight;
            sum += weight * signal * octave.share;
            weight *= signal;
        }
        sum
    }

    /// Ridged multifractal: sharp ridges with spurs, and smooth ground between. `gain` says how fast detail comes with
    /// height.
    pub fn ridged_multifractal(&self, at_m: [f64; 2], offset: f64, gain: f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 1.0);
        for octave in &self.octaves {
            let crest = offset - octave.noise(self.basis, at_m).abs();
            let signal = crest * crest * weight;
            sum += signal * octave.weight * octave.share;
            weight = (signal * gain).clamp(0.0, 1.0);
        }
        sum
    }

    /// Heterogeneous terrain: each octave is multiplied by the height so far.
    pub fn hetero(&self, at_m: [f64; 2], offset: f64) -> f64 {
        let mut octaves = self.octaves.iter();
        let Some(first) = octaves.next() else { return 0.0 };
        let start = (offset + first.noise(self.basis, at_m)) * first.share;
        octaves.fold(start, |sum, octave| {
            sum + (octave.noise(self.basis, at_m) + offset) * octave.weight * octave.share * sum
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::noise::{Fbm, Key};

    #[test]
    fn ranges_hold() {
        let sum = Fbm { octaves: Some(6.0), ..Fbm::new(1.0, 0.8) }.octaves(Key::new(4), 0.0);
        let mut stream = Key::new(5).stream();
        for _ in 0..20_000 {
            let at = [stream.between(-90.0, 90.0), stream.between(-90.0, 90.0)];
            assert!((0.0..=1.0).contains(&sum.turbulence(at)));
            assert!((0.0..=1.0).contains(&sum.ridged(at)));
            assert!((sum.billow(at) - (2.0 * sum.turbulence(at) - 1.0)).abs() < 1e-12);
            // With gain 2 and offset 1 every signal lies in 0 to 1, so the sum is below that of the weights.
            assert!((0.0..=sum.total).contains(&sum.ridged_multifractal(at, 1.0, 2.0)));
            assert!(sum.hybrid(at, 0.7).is_finite() && sum.hetero(at, 0.7).is_finite());
        }
    }
}
