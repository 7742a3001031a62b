//! A side of the map, cut into cells and into fewer, wider ones.

/// Cells along a side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub(super) fine: usize,
    pub(super) coarse: usize,
    /// Whether the last cell is beside the first.
    pub(super) wraps: bool,
}

impl Axis {
    /// The narrow cells under a wide one, each with its share of it.
    pub(super) fn under(&self, k: usize) -> Vec<(usize, f64)> {
        let (from, to) = (k * self.fine, (k + 1) * self.fine);
        let part = |i: usize| to.min((i + 1) * self.coarse) - from.max(i * self.coarse);
        (from / self.coarse..to.div_ceil(self.coarse)).map(|i| (i, part(i) as f64 / self.fine as f64)).collect()
    }

    /// Hands heights of wide cells on to the narrow ones: the mean, over each of these, of the line through the middles of
    /// the wide ones. The mean of all of them stays what it is.
    pub(super) fn spread(&self, wide: impl Fn(usize) -> f64, mut give: impl FnMut(usize, f64)) {
        let per_cell = self.fine as f64 / self.coarse as f64;
        let (mut k, mut below) = (0, 0.0);
        let mut from = self.integral(&wide, (0, 0.0), 0.0);
        for i in 0..self.fine {
            let at = (i + 1) * self.coarse;
            // The last end belongs to the last cell.
            while k + 1 < self.coarse && at >= (k + 1) * self.fine {
                below += wide(k);
                k += 1;
            }
            let to = self.integral(&wide, (k, (at - k * self.fine) as f64 / self.fine as f64), below);
            give(i, (to - from) * per_cell);
            from = to;
        }
    }

    /// The integral of the line up to a place within wide cell `k`; `below` is that of the cells before. It differs from a
    /// staircase's by half the square of the way to the cell's middle, times the line's slope there.
    fn integral(&self, wide: &impl Fn(usize) -> f64, (k, within): (usize, f64), below: f64) -> f64 {
        let here = wide(k);
        let last = self.coarse - 1;
        let beyond = |other: usize| if self.wraps { wide(other) } else { here };
        let off = within - 0.5;
        let west = || if k > 0 { wide(k - 1) } else { beyond(last) };
        let east = || if k < last { wide(k + 1) } else { beyond(0) };
        let slope = if off < 0.0 { here - west() } else { east() - here };
        below + here * within + 0.5 * off * off * slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_handed_on_is_all_there_and_lies_where_it_was() {
        for (fine, wraps) in (8..70).flat_map(|fine| [(fine, false), (fine, true)]) {
            let axis = Axis { fine, coarse: fine.div_ceil(2), wraps };
            let held = |k: usize| ((k * 7919) % 211) as f64 - 105.0;
            let mut got = vec![0.0; fine];
            axis.spread(held, |i, v| got[i] = v);
            let mean = |sum: f64, cells: usize| sum / cells as f64;
            let want = mean((0..axis.coarse).map(held).sum(), axis.coarse);
            assert!((mean(got.iter().sum(), fine) - want).abs() < 1e-12, "{fine}");
            // A plane stays one, but at its ends.
            let width = fine as f64 / axis.coarse as f64;
            axis.spread(|k| (k as f64 + 0.5) * width, |i, v| got[i] = v);
            assert!((2..fine - 2).all(|i| wraps && i + 4 > fine || (got[i] - i as f64 - 0.5).abs() < 1e-9), "{fine}");
            for k in 0..axis.coarse {
                assert!((axis.under(k).iter().map(|(_, share)| share).sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }
}
