//! Sums of noise that are not the same everywhere: turbulence, billows, ridges, and Musgrave's multifractals (Musgrave
//! 1993; Ebert et al. 2003), in which what the coarse octaves made decides how much of the fine ones is seen.
//!
//! Signals are the noise itself, −1 to 1; octave `i` weighs `w_i = λ^(−iH)`. Values of the multifractals depend on the
//! data: measure their range, don't assume it.

use super::fbm::Sampler;

impl Sampler<'_> {
    /// `Σ w_i·|n_i| / Σ w_i`, 0 to 1: sharp valleys.
    pub fn turbulence(&mut self, at_m: [f64; 2]) -> f64 {
        self.fold(at_m, |n| n.abs())
    }

    /// The turbulence and its gradient per metre; on a crease that of one side.
    pub fn turbulence_gradient(&mut self, at_m: [f64; 2]) -> (f64, [f64; 2]) {
        let (mut value, mut slope) = (0.0, [0.0; 2]);
        for (octave, (n, g)) in self.octaves_and_slopes(at_m) {
            let weight = octave.weight * octave.share;
            value += weight * n.abs();
            let side = weight.copysign(n);
            slope = [slope[0] + side * g[0], slope[1] + side * g[1]];
        }
        let total = self.total();
        (value / total, slope.map(|s| s / total))
    }

    /// `Σ w_i·(2|n_i| − 1) / Σ w_i`, −1 to 1: round hills between sharp valleys.
    pub fn billow(&mut self, at_m: [f64; 2]) -> f64 {
        self.fold(at_m, |n| 2.0 * n.abs() - 1.0)
    }

    /// `Σ w_i·(1 − |n_i|)² / Σ w_i`, 0 to 1: sharp ridges everywhere.
    pub fn ridged(&mut self, at_m: [f64; 2]) -> f64 {
        self.fold(at_m, |n| (1.0 - n.abs()) * (1.0 - n.abs()))
    }

    fn fold(&mut self, at_m: [f64; 2], shape: impl Fn(f64) -> f64) -> f64 {
        let sum: f64 = self.octaves(at_m).map(|(octave, n)| octave.weight * octave.share * shape(n)).sum();
        sum / self.total()
    }

    /// Hybrid multifractal: valleys smooth, heights rough. Each octave is multiplied by the product of those before it.
    pub fn hybrid(&mut self, at_m: [f64; 2], offset: f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 1.0f64);
        for (octave, noise) in self.octaves(at_m) {
            weight = weight.min(1.0);
            let signal = (noise + offset) * octave.weight;
            sum += weight * signal * octave.share;
            weight *= signal;
        }
        sum
    }

    /// Ridged multifractal: sharp ridges with spurs, and smooth ground between. `gain` says how fast detail comes with
    /// height.
    pub fn ridged_multifractal(&mut self, at_m: [f64; 2], offset: f64, gain: f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 1.0);
        for (octave, noise) in self.octaves(at_m) {
            let crest = offset - noise.abs();
            let signal = crest * crest * weight;
            sum += signal * octave.weight * octave.share;
            weight = (signal * gain).clamp(0.0, 1.0);
        }
        sum
    }

    /// Heterogeneous terrain: each octave is multiplied by the height so far.
    pub fn hetero(&mut self, at_m: [f64; 2], offset: f64) -> f64 {
        let mut octaves = self.octaves(at_m);
        let Some((first, noise)) = octaves.next() else { return 0.0 };
        let start = (offset + noise) * first.share;
        octaves.fold(start, |sum, (octave, noise)| sum + (noise + offset) * octave.weight * octave.share * sum)
    }
}

#[cfg(test)]
mod tests {
    use crate::noise::{Fbm, Key};

    #[test]
    fn the_gradient_of_turbulence_is_exact_off_its_creases() {
        let fbm = Fbm { octaves: Some(4.0), ..Fbm::new(100.0, 0.8) };
        let sum = fbm.octaves(Key::new(4), 0.0);
        let mut sum = sum.sampler();
        let mut stream = Key::new(6).stream();
        let mut creases = 0;
        for _ in 0..2000 {
            let at = [stream.between(-900.0, 900.0), stream.between(-900.0, 900.0)];
            let (value, slope) = sum.turbulence_gradient(at);
            assert!((value - sum.turbulence(at)).abs() < 1e-12);
            let step = 1e-4;
            let [east, west] = [step, -step].map(|by| sum.turbulence([at[0] + by, at[1]]));
            let [south, north] = [step, -step].map(|by| sum.turbulence([at[0], at[1] + by]));
            let measured = [(east - west) / (2.0 * step), (south - north) / (2.0 * step)];
            creases += usize::from((0..2).any(|i| (measured[i] - slope[i]).abs() > 1e-6));
        }
        // A crease every few metres, and a step of 0.2 mm across it: at most one place in ten thousand.
        assert!(creases <= 2, "{creases}");
    }

    #[test]
    fn ranges_hold() {
        let sum = Fbm { octaves: Some(6.0), ..Fbm::new(1.0, 0.8) }.octaves(Key::new(4), 0.0);
        let mut sum = sum.sampler();
        let mut stream = Key::new(5).stream();
        for _ in 0..20_000 {
            let at = [stream.between(-90.0, 90.0), stream.between(-90.0, 90.0)];
            assert!((0.0..=1.0).contains(&sum.turbulence(at)));
            assert!((0.0..=1.0).contains(&sum.ridged(at)));
            assert!((sum.billow(at) - (2.0 * sum.turbulence(at) - 1.0)).abs() < 1e-12);
            // With gain 2 and offset 1 every signal lies in 0 to 1, so the sum is below that of the weights.
            let total = sum.total();
            assert!((0.0..=total).contains(&sum.ridged_multifractal(at, 1.0, 2.0)));
            assert!(sum.hybrid(at, 0.7).is_finite() && sum.hetero(at, 0.7).is_finite());
        }
    }
}
