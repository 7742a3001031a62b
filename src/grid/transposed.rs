//! Columns as rows.

use rayon::prelude::*;

/// The columns of a raster of `w` by `h` cells as rows.
pub fn transposed<T: Copy + Default + Send + Sync>(data: &[T], w: usize, h: usize) -> Vec<T> {
    // Several columns at a time, so that every line of memory is read once.
    const COLUMNS: usize = 16;
    let mut out = vec![T::default(); data.len()];
    out.par_chunks_mut((COLUMNS * h).max(1)).enumerate().for_each(|(block, columns)| {
        let wide = columns.len() / h;
        for y in 0..h {
            for (i, &v) in data[y * w + block * COLUMNS..][..wide].iter().enumerate() {
                columns[i * h + y] = v;
            }
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::transposed;

    #[test]
    fn a_column_becomes_a_row_and_twice_is_nothing() {
        let (w, h) = (37, 20);
        let data: Vec<u32> = (0..w as u32 * h as u32).collect();
        let turned = transposed(&data, w, h);
        assert!((0..w).all(|x| (0..h).all(|y| turned[x * h + y] == data[y * w + x])));
        assert_eq!(transposed(&turned, h, w), data);
    }
}
