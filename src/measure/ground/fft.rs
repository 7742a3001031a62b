//! Fourier transform of rows whose length is a power of two: radix 2, in place (Cooley and Tukey 1965).

use rayon::prelude::*;

/// Transforms every row of `side` complex numbers, `[real, imaginary]`; `side` is a power of two. Not scaled.
pub fn fft_rows(data: &mut [[f64; 2]], side: usize) {
    let turn = |i: usize| {
        let angle = -std::f64::consts::TAU * i as f64 / side as f64;
        [libm::cos(angle), libm::sin(angle)]
    };
    let turns: Vec<[f64; 2]> = (0..side / 2).map(turn).collect();
    data.par_chunks_exact_mut(side).for_each(|row| fft(row, &turns));
}

fn fft(row: &mut [[f64; 2]], turns: &[[f64; 2]]) {
    let n = row.len();
    if n < 2 {
        return;
    }
    let shift = usize::BITS - n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> shift;
        if i < j {
            row.swap(i, j);
        }
    }
    let mut half = 1;
    while half < n {
        let stride = n / (2 * half);
        for block in row.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let [c, s] = turns[k * stride];
                let t = [b[0] * c - b[1] * s, b[0] * s + b[1] * c];
                *b = [a[0] - t[0], a[1] - t[1]];
                *a = [a[0] + t[0], a[1] + t[1]];
            }
        }
        half *= 2;
    }
}

/// Swaps rows and columns of a square.
pub fn transpose<T>(data: &mut [T], side: usize) {
    for y in 0..side {
        for x in y + 1..side {
            data.swap(y * side + x, x * side + y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_sum_it_stands_for() {
        let n = 16;
        let data: Vec<[f64; 2]> = (0..n).map(|i| [((i * 7 + 3) % 11) as f64, ((i * 5) % 7) as f64 - 3.0]).collect();
        let mut fast = data.clone();
        fft_rows(&mut fast, n);
        for (k, found) in fast.iter().enumerate() {
            let mut sum = [0.0, 0.0];
            for (i, [re, im]) in data.iter().enumerate() {
                let (s, c) = (-std::f64::consts::TAU * (i * k) as f64 / n as f64).sin_cos();
                sum = [sum[0] + re * c - im * s, sum[1] + re * s + im * c];
            }
            assert!((found[0] - sum[0]).abs() < 1e-11 && (found[1] - sum[1]).abs() < 1e-11, "{k}");
        }
    }
}
