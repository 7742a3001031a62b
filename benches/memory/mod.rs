//! What memory gives on this machine, to hold the solvers' figures against.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use rayon::prelude::*;

/// McCalpin's triad, `a = b + s·c`, on arrays that no cache holds: what memory gives, to hold the others against.
pub fn triad(c: &mut Criterion) {
    const N: usize = 1 << 25;
    let mut group = c.benchmark_group("memory");
    group.sample_size(10);
    group.throughput(Throughput::Bytes(3 * 4 * N as u64));
    let (mut a, b, x) = (vec![0.0f32; N], vec![1.0f32; N], vec![2.0f32; N]);
    group.bench_function("STREAM triad", |bench| {
        bench.iter(|| {
            let parts = a.par_chunks_mut(1 << 16).zip(b.par_chunks(1 << 16)).zip(x.par_chunks(1 << 16));
            parts.for_each(|((a, b), x)| {
                for ((a, b), x) in a.iter_mut().zip(b).zip(x) {
                    *a = b + 3.0 * x;
                }
            });
        })
    });
    black_box(&a);
    group.finish();
}
