//! Where there is work: in every row the span of cells that hold lava, and those around it. Loops go over these alone, rows
//! in parallel; sums go row by row in their order, so that neither threads nor spans change a bit.

use rayon::prelude::*;

/// Cells below which waking another thread takes longer than the loop.
const FEW: usize = 4096;

/// Spans of a raster whose east meets its west and whose south meets its north.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    pub(super) width: usize,
    pub(super) height: usize,
    /// First wet cell of a row and the one after its last, as far as lava has been; none where they are the same.
    wet: Vec<[usize; 2]>,
    /// The same with the cells around: what is worked on.
    spans: Vec<[usize; 2]>,
    cells: usize,
}

impl Rows {
    /// The spans of what is wet.
    pub(super) fn new(width: usize, height: usize, wet: impl Iterator<Item = usize>) -> Self {
        let mut rows = Self { width, height, wet: vec![[0; 2]; height], spans: vec![[0; 2]; height], cells: 0 };
        for i in wet {
            rows.wet[i / width] = union(rows.wet[i / width], [i % width, i % width + 1]);
        }
        rows.spread();
        rows
    }

    /// Takes in cells that have become wet at the edge of the spans.
    pub(super) fn grow(&mut self, wet: impl Fn(usize) -> bool) {
        for y in 0..self.height {
            let [from, to] = self.spans[y];
            let cell = |x: &usize| wet(y * self.width + x);
            if let (Some(first), Some(last)) = ((from..to).find(cell), (from..to).rev().find(cell)) {
                self.wet[y] = union(self.wet[y], [first, last + 1]);
            }
        }
        self.spread();
    }

    /// Spans about what is wet.
    fn spread(&mut self) {
        let (w, h) = (self.width, self.height);
        for y in 0..h {
            let [a, b, c] = [y + h - 1, y, y + 1].map(|row| self.wet[row % h]);
            let [from, to] = union(union(a, b), c);
            self.spans[y] = match (from, to) {
                (from, to) if from >= to => [0; 2],
                // Over the seam: the whole row.
                (from, to) if from == 0 || to == w => [0, w],
                (from, to) => [from - 1, to + 1],
            };
        }
        self.cells = self.spans.iter().map(|[from, to]| to - from).sum();
    }

    /// The span of a row.
    pub(super) fn span(&self, y: usize) -> std::ops::Range<usize> {
        self.spans[y][0]..self.spans[y][1]
    }

    /// The cells around one: west, east, north, south.
    #[inline(always)]
    pub(super) fn around(&self, x: usize, y: usize) -> [usize; 4] {
        let (w, h) = (self.width, self.height);
        let row = y * w;
        let west = if x == 0 { w - 1 } else { x - 1 };
        let east = if x + 1 == w { 0 } else { x + 1 };
        let north = if y == 0 { h - 1 } else { y - 1 };
        let south = if y + 1 == h { 0 } else { y + 1 };
        [row + west, row + east, north * w + x, south * w + x]
    }

    /// Runs `f(x, y, value)` over the cells of the spans.
    pub(super) fn each<T: Send>(&self, data: &mut [T], f: impl Fn(usize, usize, &mut T) + Sync + Send) {
        self.sum(data, |x, y, value| {
            f(x, y, value);
            0.0
        });
    }

    /// The same over two rasters at once.
    pub(super) fn each_two<T: Send, U: Send>(
        &self,
        (one, two): (&mut [T], &mut [U]),
        f: impl Fn(usize, usize, &mut T, &mut U) -> f64 + Sync + Send,
    ) -> f64 {
        let of = |(y, (one, two)): (usize, (&mut [T], &mut [U]))| -> f64 {
            let span = self.span(y);
            let start = span.start;
            let cells = one[span.clone()].iter_mut().zip(&mut two[span]);
            cells.enumerate().map(|(k, (one, two))| f(start + k, y, one, two)).sum()
        };
        if self.cells <= FEW {
            let rows = one.chunks_exact_mut(self.width).zip(two.chunks_exact_mut(self.width));
            return rows.enumerate().map(of).sum();
        }
        let rows = one.par_chunks_exact_mut(self.width).zip(two.par_chunks_exact_mut(self.width));
        rows.enumerate().map(of).collect::<Vec<f64>>().iter().sum()
    }

    /// The sum of `f(x, y, value)` over the cells of the spans.
    pub(super) fn sum<T: Send>(&self, data: &mut [T], f: impl Fn(usize, usize, &mut T) -> f64 + Sync + Send) -> f64 {
        let of = |(y, row): (usize, &mut [T])| -> f64 {
            let span = self.span(y);
            let start = span.start;
            row[span].iter_mut().enumerate().map(|(k, value)| f(start + k, y, value)).sum()
        };
        if self.cells <= FEW {
            return data.chunks_exact_mut(self.width).enumerate().map(of).sum();
        }
        data.par_chunks_exact_mut(self.width).enumerate().map(of).collect::<Vec<f64>>().iter().sum()
    }

    /// The sum of `f(x, y)` over the cells of the spans.
    pub(super) fn total(&self, f: impl Fn(usize, usize) -> f64 + Sync + Send) -> f64 {
        let of = |y: usize| self.span(y).map(|x| f(x, y)).sum::<f64>();
        if self.cells <= FEW { (0..self.height).map(of).sum() } else { crate::grid::sum_rows(self.height, of) }
    }

    /// The greatest `f(x, y)` over the cells of the spans, and 0.
    pub(super) fn max(&self, f: impl Fn(usize, usize) -> f64 + Sync + Send) -> f64 {
        let of = |y: usize| self.span(y).map(|x| f(x, y)).fold(0.0, f64::max);
        if self.cells <= FEW {
            (0..self.height).map(of).fold(0.0, f64::max)
        } else {
            (0..self.height).into_par_iter().map(of).reduce(|| 0.0, f64::max)
        }
    }
}

fn union(a: [usize; 2], b: [usize; 2]) -> [usize; 2] {
    match (a[0] < a[1], b[0] < b[1]) {
        (true, true) => [a[0].min(b[0]), a[1].max(b[1])],
        (true, false) => a,
        (false, _) => b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_hold_what_is_wet_and_a_cell_around() {
        let mut rows = Rows::new(9, 7, [3 * 9 + 4].into_iter());
        assert_eq!([1, 2, 3, 4, 5].map(|y| rows.span(y)), [0..0, 3..6, 3..6, 3..6, 0..0]);
        rows.grow(|i| i == 30 || i == 31);
        assert_eq!([2, 3, 4, 5].map(|y| rows.span(y)), [2..6, 2..6, 2..6, 0..0]);
        // Over the seam in both directions.
        let rows = Rows::new(9, 7, [0].into_iter());
        assert_eq!([6, 0, 1, 2].map(|y| rows.span(y)), [0..9, 0..9, 0..9, 0..0]);
        assert_eq!(rows.around(0, 0), [8, 1, 54, 9]);
    }
}
