//! Fractal sums against their spectrum, and multifractals against what sets them apart.

use upthrust::noise::{Basis, Fbm, Key};

/// Power at the wave numbers 1 to n/2 of a line that is tapered to its ends (Hann), by direct transform.
fn spectrum(line: &[f64]) -> Vec<f64> {
    let n = line.len();
    let tau = std::f64::consts::TAU;
    let table: Vec<(f64, f64)> = (0..n).map(|i| (tau * i as f64 / n as f64).sin_cos()).collect();
    let tapered: Vec<f64> = line.iter().enumerate().map(|(i, v)| v * (1.0 - table[i].1)).collect();
    (1..=n / 2)
        .map(|k| {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, v) in tapered.iter().enumerate() {
                let (sin, cos) = table[i * k % n];
                re += v * cos;
                im += v * sin;
            }
            re * re + im * im
        })
        .collect()
}

/// Least-squares slope of y over x.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let top: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    top / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}

#[test]
fn profiles_have_the_hurst_spectrum() {
    for basis in [Basis::Gradient, Basis::Simplex] {
        for hurst in [0.2, 0.5, 0.9] {
            let (n, lines) = (1024usize, 60u64);
            let mut power = vec![0.0; n / 2];
            for line in 0..lines {
                let sum = Fbm { basis, ..Fbm::new(256.0, hurst) }.octaves(Key::new(1).with(line), 0.125);
                let heights: Vec<f64> = (0..n).map(|i| sum.value([i as f64, 0.37 * i as f64])).collect();
                for (p, s) in power.iter_mut().zip(spectrum(&heights)) {
                    *p += s;
                }
            }
            // From four waves in the longest wavelength's place to a sixth of the sampling: six octaves' worth would
            // ripple with the octaves, so bins of equal ratio are averaged.
            let mut points = Vec::new();
            let mut low = 16.0f64;
            while low * 1.5 < n as f64 / 6.0 {
                let bin = low as usize..(low * 1.5) as usize;
                let mean = bin.clone().map(|k| power[k - 1]).sum::<f64>() / bin.len() as f64;
                points.push(((low * 1.25).ln(), mean.ln()));
                low *= 1.5;
            }
            let measured = slope(&points);
            let want = -(2.0 * hurst + 1.0);
            assert!((measured - want).abs() < 0.15, "{basis:?}, H = {hurst}: slope {measured}, not {want}");
        }
    }
}

/// Spread of what the octaves from the third on add, in the lowest and the highest tenth of the land.
fn roughness_low_and_high(value: impl Fn(&Fbm, [f64; 2]) -> f64) -> (f64, f64) {
    let whole = Fbm { octaves: Some(8.0), ..Fbm::new(1.0, 0.25) };
    let coarse = Fbm { octaves: Some(3.0), ..whole };
    let mut places: Vec<(f64, f64)> = Vec::new();
    let mut stream = Key::new(7).stream();
    for _ in 0..40_000 {
        let at = [stream.between(0.0, 60.0), stream.between(0.0, 60.0)];
        let base = value(&coarse, at);
        places.push((base, value(&whole, at) - base));
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let spread = |part: &[(f64, f64)]| {
        let mean = part.iter().map(|p| p.1).sum::<f64>() / part.len() as f64;
        (part.iter().map(|p| (p.1 - mean).powi(2)).sum::<f64>() / part.len() as f64).sqrt()
    };
    (spread(&places[..4000]), spread(&places[36_000..]))
}

#[test]
fn hybrid_is_smooth_in_valleys_and_fbm_is_not() {
    let key = Key::new(3);
    let (low, high) = roughness_low_and_high(|fbm, at| fbm.octaves(key, 0.0).sampler().hybrid(at, 0.7));
    assert!(high > 3.0 * low, "hybrid: {low} below, {high} above");
    // Undo the scale, which follows the number of octaves asked for, so that the difference is the fine octaves alone.
    let scale = |octaves: f64| {
        let gain = 2.07f64.powf(-0.25);
        (0..octaves as i32).map(|i| gain.powi(2 * i)).sum::<f64>().sqrt()
    };
    let (low, high) = roughness_low_and_high(|fbm, at| fbm.octaves(key, 0.0).value(at) * scale(fbm.octaves.unwrap()));
    // 4000 samples a side: standard error 1.1 % each.
    assert!((high / low - 1.0).abs() < 0.1, "fbm: {low} below, {high} above");
}
