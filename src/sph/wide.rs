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

    /// Puts those of `values` whose `size` is below `limit`, and that are not `but`, at the beginning of `to`, in order, and
    /// says how many they are; what comes behind them in `to` is of no use.
    ///
    /// # Safety
    ///
    /// The processor has what the reader is made for.
    unsafe fn pick(values: &[u32; LANES], sizes: &[f32; LANES], limit: f32, but: u32, to: &mut [u32; LANES]) -> usize;
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

    #[inline(always)]
    unsafe fn pick(values: &[u32; LANES], sizes: &[f32; LANES], limit: f32, but: u32, to: &mut [u32; LANES]) -> usize {
        let mut found = 0;
        // Written always, kept where it counts: no branch to guess.
        for l in 0..LANES {
            to[found % LANES] = values[l];
            found += usize::from((sizes[l] < limit) & (values[l] != but));
        }
        found
    }
}

/// For every set of lanes, as bits, the lanes in it, in order.
#[cfg(target_arch = "x86_64")]
static PICKED: [[u8; LANES]; 1 << LANES] = {
    let mut picked = [[0; LANES]; 1 << LANES];
    let mut set = 0;
    while set < picked.len() {
        let (mut lane, mut found) = (0, 0);
        while lane < LANES {
            if set >> lane & 1 == 1 {
                picked[set][found] = lane as u8;
                found += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    picked
};

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

    #[inline(always)]
    unsafe fn pick(values: &[u32; LANES], sizes: &[f32; LANES], limit: f32, but: u32, to: &mut [u32; LANES]) -> usize {
        use std::arch::x86_64::{
            _CMP_LT_OQ, _mm_loadl_epi64, _mm256_andnot_ps, _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32,
            _mm256_cvtepu8_epi32, _mm256_loadu_ps, _mm256_loadu_si256, _mm256_movemask_ps, _mm256_permutevar8x32_epi32,
            _mm256_set1_epi32, _mm256_set1_ps, _mm256_storeu_si256,
        };
        // SAFETY: every load and store is of eight lanes that are there; only functions compiled for AVX2 use this reader.
        unsafe {
            let (from, sizes) = (_mm256_loadu_si256(values.as_ptr().cast()), _mm256_loadu_ps(sizes.as_ptr()));
            let small = _mm256_cmp_ps::<_CMP_LT_OQ>(sizes, _mm256_set1_ps(limit));
            let same = _mm256_castsi256_ps(_mm256_cmpeq_epi32(from, _mm256_set1_epi32(but as i32)));
            let set = _mm256_movemask_ps(_mm256_andnot_ps(same, small)) as usize;
            let lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(PICKED[set & 0xFF].as_ptr().cast()));
            _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_permutevar8x32_epi32(from, lanes));
            set.count_ones() as usize
        }
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
        let half = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt");
        if half && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { in_avx512(work) };
        }
        if half {
            // SAFETY: as above.
            return unsafe { in_avx2(work) };
        }
    }
    work.run::<Plain>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,popcnt")]
fn in_avx512<W: Work>(work: W) -> W::Out {
    work.run::<Turned>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn in_avx2<W: Work>(work: W) -> W::Out {
    work.run::<Turned>()
}

#[cfg(test)]
pub(super) mod tests {
    /// Whether everything runs as on a processor without wide registers.
    pub(in crate::sph) static NARROW: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
}
