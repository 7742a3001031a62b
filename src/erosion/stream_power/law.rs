//! One cell's answer to the stream power law, implicit in its own height (Braun and Willett 2013).

/// Height after a step of a cell that uplift has brought to `raised`, above a receiver that ends at `below`:
/// `z = raised - ratio·(z - below)^n`, with `ratio = K·Q^m·t / length^n`.
///
/// Solved as `u + f·u^n = 1` for the share `u` of the drop that stays, in the one of `u` and `u^n` in which the left side
/// is convex: Newton's iterates then fall to the root from above, and cannot miss it.
pub(super) fn settle(raised: f64, below: f64, ratio: f64, n: f64) -> f64 {
    let drop = raised - below;
    if drop <= 0.0 || ratio <= 0.0 {
        return raised;
    }
    let f = if n == 1.0 { ratio } else { ratio * libm::pow(drop, n - 1.0) };
    below + drop * share_left(f, n)
}

/// The root of `u + f·u^n = 1` in 0 to 1.
fn share_left(f: f64, n: f64) -> f64 {
    if !f.is_finite() {
        return 0.0;
    }
    if n == 1.0 {
        1.0 / (1.0 + f)
    } else if n == 2.0 {
        2.0 / (1.0 + (1.0 + 4.0 * f).sqrt())
    } else if n > 1.0 {
        // Both terms are at most 1, which bounds the root twice.
        let from = if f > 1.0 { libm::pow(f, -1.0 / n) } else { 1.0 };
        convex_root(1.0, f, n, from)
    } else {
        let from = if f > 1.0 { 1.0 / f } else { 1.0 };
        libm::pow(convex_root(f, 1.0, 1.0 / n, from), 1.0 / n)
    }
}

/// The root of `a·x + b·x^p = 1`, `p >= 1`, from a bound above it.
fn convex_root(a: f64, b: f64, p: f64, from: f64) -> f64 {
    let mut x = from;
    // Newton doubles the digits each time; 40 serve the worst start.
    for _ in 0..40 {
        let steep = b * libm::pow(x, p - 1.0);
        let next = x - (a * x + steep * x - 1.0) / (a + p * steep);
        if next >= x * (1.0 - 1e-14) {
            break;
        }
        x = next.max(0.0);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_equation_is_met_for_every_exponent_and_step() {
        for n in [0.3, 0.5, 0.9, 1.0, 1.1, 1.5, 2.0, 3.7, 4.0] {
            for power in -12..=12 {
                let f = libm::pow(10.0, power as f64);
                let u = share_left(f, n);
                assert!((0.0..=1.0).contains(&u), "{n} {f}: {u}");
                let left = u + f * libm::pow(u, n);
                // Rounding of u near 1 is amplified by f·n; of a small u, by its digits alone.
                assert!((left - 1.0).abs() < 1e-11, "n {n}, f {f:e}: u {u:e} gives {left}");
            }
        }
        assert_eq!(settle(5.0, 7.0, 1.0, 1.0), 5.0);
        assert_eq!(settle(9.0, 7.0, 0.0, 0.3), 9.0);
        assert!((settle(9.0, 7.0, 1e300, 4.0) - 7.0).abs() < 1e-60f64.max(1e-12));
    }
}
