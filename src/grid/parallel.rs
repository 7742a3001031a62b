//! Row-parallel loops and reductions whose result does not depend on the number of threads: a row is never split, and
//! row results are combined in order.

use rayon::prelude::*;

use super::Grid;

/// Cells below which waking another thread takes longer than the loop.
const FEW: usize = 2048;

/// Runs `f(y, row)` over the rows of a row-major buffer, in parallel.
pub fn for_each_row<T: Send>(data: &mut [T], width: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    if width == 0 {
        return;
    }
    if data.len() <= FEW {
        data.chunks_exact_mut(width).enumerate().for_each(|(y, row)| f(y, row));
    } else {
        data.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| f(y, row));
    }
}

/// The greatest `f(y)` over a raster's rows, and 0.
pub fn max_rows(grid: &Grid, f: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    if grid.cells() <= FEW {
        (0..grid.height).map(f).fold(0.0, f64::max)
    } else {
        (0..grid.height).into_par_iter().map(f).reduce(|| 0.0, f64::max)
    }
}

/// Overwrites every value of a row-major buffer with `f(x, y)`, rows in parallel.
pub fn map_cells<T: Send>(data: &mut [T], width: usize, f: impl Fn(usize, usize) -> T + Sync + Send) {
    for_each_row(data, width, |y, row| {
        for (x, value) in row.iter_mut().enumerate() {
            *value = f(x, y);
        }
    });
}

/// Sums `f(y)` over `rows` rows: rows in parallel, added in their order.
pub fn sum_rows(rows: usize, f: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    (0..rows).into_par_iter().map(f).collect::<Vec<_>>().iter().sum()
}

/// Sum in f64, in a fixed order.
pub fn sum_f64(data: &[f32]) -> f64 {
    const RUN: usize = 4096;
    data.par_chunks(RUN).map(|run| run.iter().map(|&v| v as f64).sum::<f64>()).collect::<Vec<_>>().iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_threads() {
        let data: Vec<f32> = (0..100_003).map(|i| ((i * 7919) % 10_007) as f32 * 1e-3 - 4.0).collect();
        let sums: Vec<u64> = [1, 2, 8]
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| sum_f64(&data)).to_bits()
            })
            .to_vec();
        assert!(sums.iter().all(|&bits| bits == sums[0]));
    }
}
