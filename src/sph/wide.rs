//! The same loop, compiled for the widest registers that the processor has.
//!
//! Nothing is fused or reordered: every width does the same arithmetic on the same lanes and gives the same bits.

/// Lanes that inner loops work in, whatever the processor.
pub const LANES: usize = 8;

/// A loop to be compiled for several widths. `run` has to be `#[inline(always)]`.
pub trait Work {
    /// What it gives.
    type Out;
    /// Does it, reading scattered records as `R` does.
    fn run<R: Reader>(self) -> Self::Out;
}

/// How scattered records are read: one by one, or turned around in registers. The bits are the same.
pub trait Reader {
    /// The four values of `records[at]`, each in lanes.
    ///
    /// # Safety
    ///
    /// Every index is below the length of `records`.
    unsafe fn read(records: &[[f32; 4]], at: &[u32; LANES]) -> [[f32; LANES]; 4];
}

/// One by one.
struct Plain;

impl Reader for Plain {
    #[inline(always)]
    unsafe fn read(records: &[[f32; 4]], at: &[u32; LANES]) -> [[f32; LANES]; 4] {
        let mut lanes = [[0.0; LANES]; 4];
        for l in 0..LANES {
            // SAFETY: the caller's promise.
            let record = unsafe { records.get_unchecked(at[l] as usize) };
            for k in 0..4 {
                lanes[k][l] = record[k];
            }
        }
        lanes
    }
}

/// Eight loads and eight shuffles: twice as fast here as the processor's own instruction for scattered values.
#[cfg(target_arch = "x86_64")]
struct Turned;

#[cfg(target_arch = "x86_64")]
impl Reader for Turned {
    #[inline(always)]
    unsafe fn read(records: &[[f32; 4]], at: &[u32; LANES]) -> [[f32; LANES]; 4] {
        use std::arch::x86_64::{
            _mm_loadu_ps, _mm256_set_m128, _mm256_shuffle_ps, _mm256_storeu_ps, _mm256_unpackhi_ps, _mm256_unpacklo_ps,
        };
        let mut lanes = [[0.0; LANES]; 4];
        // SAFETY: the caller's promise; only functions compiled for AVX2 use this reader.
        unsafe {
            // Record k beside record k + 4: two blocks of four by four, turned side by side. Written out: what a closure
            // calls is not compiled for AVX2.
            let r = records.as_ptr();
            let a =
                _mm256_set_m128(_mm_loadu_ps(r.add(at[4] as usize).cast()), _mm_loadu_ps(r.add(at[0] as usize).cast()));
            let b =
                _mm256_set_m128(_mm_loadu_ps(r.add(at[5] as usize).cast()), _mm_loadu_ps(r.add(at[1] as usize).cast()));
            let c =
                _mm256_set_m128(_mm_loadu_ps(r.add(at[6] as usize).cast()), _mm_loadu_ps(r.add(at[2] as usize).cast()));
            let d =
                _mm256_set_m128(_mm_loadu_ps(r.add(at[7] as usize).cast()), _mm_loadu_ps(r.add(at[3] as usize).cast()));
            let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            _mm256_storeu_ps(lanes[0].as_mut_ptr(), _mm256_shuffle_ps::<0x44>(ab, cd));
            _mm256_storeu_ps(lanes[1].as_mut_ptr(), _mm256_shuffle_ps::<0xEE>(ab, cd));
            let (ab, cd) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            _mm256_storeu_ps(lanes[2].as_mut_ptr(), _mm256_shuffle_ps::<0x44>(ab, cd));
            _mm256_storeu_ps(lanes[3].as_mut_ptr(), _mm256_shuffle_ps::<0xEE>(ab, cd));
        }
        lanes
    }
}

/// Runs `work` with the widest registers there are.
#[inline]
pub fn widest<W: Work>(work: W) -> W::Out {
    #[cfg(test)]
    if tests::NARROW.load(std::sync::atomic::Ordering::Relaxed) {
        return work.run::<Plain>();
    }
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { in_avx512(work) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { in_avx2(work) };
        }
    }
    work.run::<Plain>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2")]
fn in_avx512<W: Work>(work: W) -> W::Out {
    work.run::<Turned>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn in_avx2<W: Work>(work: W) -> W::Out {
    work.run::<Turned>()
}

#[cfg(test)]
pub(super) mod tests {
    /// Whether everything runs as on a processor without wide registers.
    pub(in crate::sph) static NARROW: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
}
