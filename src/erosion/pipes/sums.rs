//! Sums and maxima of rows, with the same bits whatever the processor.

use super::flow::hi;

/// Lanes that sums and maxima run in, whatever the processor's own width.
const LANES: usize = 16;

/// The sum of a row, in a fixed order.
#[inline(always)]
pub fn total(row: &[f32]) -> f64 {
    let mut sums = [0.0f64; LANES];
    let (whole, tail) = row.as_chunks::<LANES>();
    for chunk in whole {
        for i in 0..LANES {
            sums[i] += chunk[i] as f64;
        }
    }
    let mut sum = 0.0;
    for i in 0..LANES {
        sum += sums[i];
    }
    for &v in tail {
        sum += v as f64;
    }
    sum
}

/// The greatest of a row, and 0.
#[inline(always)]
pub fn greatest(row: &[f32]) -> f32 {
    // Two apart: each waits for the one before it.
    let (mut most, mut other) = ([0.0f32; LANES], [0.0f32; LANES]);
    let (whole, tail) = row.as_chunks::<{ 2 * LANES }>();
    for chunk in whole {
        for i in 0..LANES {
            most[i] = hi(chunk[i], most[i]);
            other[i] = hi(chunk[LANES + i], other[i]);
        }
    }
    let mut all = 0.0;
    for i in 0..LANES {
        all = hi(hi(most[i], other[i]), all);
    }
    for &v in tail {
        all = hi(v, all);
    }
    all
}
