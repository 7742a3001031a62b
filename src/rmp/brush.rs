//! Outlines to raster cells: the share of each cell that an outline covers. Outlines are simple polygons, convex or not.
//!
//! tiny-skia's scan converter takes sixteen samples a cell, so a cell's share is good to about a sixteenth. Outlines are
//! in raster cells, `0..width` to the east and `0..height` to the south.

use rayon::prelude::*;
use tiny_skia::{FillRule, Mask, Path, PathBuilder, Transform};

use crate::grid::Field;

/// Largest piece converted at once: bounds the mask's memory and keeps the scan converter's 16-bit coordinates in range.
const TILE: usize = 1024;

/// Rows that one task of [`raise`] fills. Fixed, so that the result does not depend on the number of threads.
const BAND: usize = 128;

/// Scan-converts outlines; keeps its mask between calls and touches only the outline's bounding box.
#[derive(Debug, Default)]
pub struct Brush {
    mask: Option<Mask>,
}

impl Brush {
    /// A brush without a mask yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Calls `put(x, y, share)` for every cell of a `width` x `height` raster that the outline covers, shares in (0, 1].
    /// Parts outside the raster are left out; an outline that is not finite covers nothing.
    pub fn cover(&mut self, outline: &[[f64; 2]], width: usize, height: usize, mut put: impl FnMut(usize, usize, f32)) {
        let Some(window) = Window::around(outline, [0, 0, width, height]) else { return };
        for top in (window.top..window.bottom).step_by(TILE) {
            for left in (window.left..window.right).step_by(TILE) {
                let tile = [left, top, (left + TILE).min(window.right), (top + TILE).min(window.bottom)];
                self.cover_tile(outline, tile, &mut put);
            }
        }
    }

    /// `cover` for the part of a raster given as `[left, top, right, bottom]`, at most a tile a side.
    fn cover_tile(&mut self, outline: &[[f64; 2]], part: [usize; 4], put: &mut impl FnMut(usize, usize, f32)) {
        let piece = clip(outline, part);
        let Some(window) = Window::around(&piece, part) else { return };
        let Some(path) = path_of(&piece, [window.left as f64, window.top as f64]) else { return };
        let (wide, high) = (window.right - window.left, window.bottom - window.top);
        let Some(mask) = self.mask(wide, high) else { return };
        mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
        let stride = mask.width() as usize;
        for (y, line) in mask.data_mut().chunks_exact_mut(stride).take(high).enumerate() {
            for (x, share) in line[..wide].iter_mut().enumerate() {
                if *share > 0 {
                    put(window.left + x, window.top + y, *share as f32 / 255.0);
                    *share = 0;
                }
            }
        }
    }

    /// A clean mask at least this large.
    fn mask(&mut self, wide: usize, high: usize) -> Option<&mut Mask> {
        let (w, h) = self.mask.as_ref().map_or((0, 0), |m| (m.width() as usize, m.height() as usize));
        if w < wide || h < high {
            let (w, h) = (w.max(wide).next_power_of_two(), h.max(high).next_power_of_two());
            self.mask = Mask::new(w as u32, h as u32);
        }
        self.mask.as_mut()
    }
}

/// An outline in raster cells, and how much the cells that it covers rise.
#[derive(Clone, Debug, PartialEq)]
pub struct Raised {
    /// Corners in order, in raster cells.
    pub outline: Vec<[f64; 2]>,
    /// By how much a cell that is covered whole rises.
    pub amount: f32,
}

/// Adds every outline's amount to the cells that it covers, bands of rows in parallel; in each cell the amounts are added
/// in the order given.
pub fn raise(field: &mut Field<f32>, raised: &[Raised]) {
    let (width, height) = (field.grid.width, field.grid.height);
    if width == 0 {
        return;
    }
    let whole = [0, 0, width, height];
    let windows: Vec<_> = raised.iter().map(|r| Window::around(&r.outline, whole)).collect();
    field.data.par_chunks_mut(width * BAND).enumerate().for_each_init(Brush::new, |brush, (band, rows)| {
        let (top, bottom) = (band * BAND, band * BAND + rows.len() / width);
        for (raised, window) in raised.iter().zip(&windows) {
            let Some(window) = window.as_ref().filter(|w| w.top < bottom && w.bottom > top) else { continue };
            for left in (window.left..window.right).step_by(TILE) {
                let part = [left, top, (left + TILE).min(window.right), bottom];
                brush.cover_tile(&raised.outline, part, &mut |x, y, share| {
                    rows[(y - top) * width + x] += share * raised.amount;
                });
            }
        }
    });
}

/// The raster cells that an outline's bounding box touches.
struct Window {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

impl Window {
    /// Cut to `[left, top, right, bottom]`; nothing where that is empty or a corner is not finite.
    fn around(outline: &[[f64; 2]], limit: [usize; 4]) -> Option<Self> {
        if outline.len() < 3 || !outline.iter().all(|p| p[0].is_finite() && p[1].is_finite()) {
            return None;
        }
        let span = |axis: usize| {
            let low = outline.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min).floor();
            let high = outline.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max).ceil();
            // A float saturates when cast: outlines far outside end at the limits.
            ((low as usize).max(limit[axis]), (high.max(0.0) as usize).min(limit[axis + 2]))
        };
        let ((left, right), (top, bottom)) = (span(0), span(1));
        (left < right && top < bottom).then_some(Self { left, top, right, bottom })
    }
}

/// The part of an outline inside `[left, top, right, bottom]` (Sutherland and Hodgman 1974). A hollow one may keep edges
/// along the border that enclose nothing.
fn clip(outline: &[[f64; 2]], part: [usize; 4]) -> Vec<[f64; 2]> {
    let mut piece = outline.to_vec();
    let mut next = Vec::with_capacity(piece.len() + 4);
    for (side, &bound) in part.iter().enumerate() {
        let (axis, sign) = (side % 2, if side < 2 { 1.0 } else { -1.0 });
        let inner = |p: &[f64; 2]| sign * (p[axis] - bound as f64);
        if piece.iter().all(|p| inner(p) >= 0.0) {
            continue;
        }
        next.clear();
        for (i, a) in piece.iter().enumerate() {
            let b = &piece[(i + 1) % piece.len()];
            let (da, db) = (inner(a), inner(b));
            if da >= 0.0 {
                next.push(*a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                let t = da / (da - db);
                next.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
        }
        std::mem::swap(&mut piece, &mut next);
    }
    piece
}

fn path_of(outline: &[[f64; 2]], origin: [f64; 2]) -> Option<Path> {
    let mut path = PathBuilder::with_capacity(outline.len() + 2, outline.len());
    for (i, p) in outline.iter().enumerate() {
        let (x, y) = ((p[0] - origin[0]) as f32, (p[1] - origin[1]) as f32);
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path.close();
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    fn covered(outline: &[[f64; 2]], width: usize, height: usize) -> Field<f32> {
        let mut field = Field::filled(Grid::new(width, height, width as f64, Edges::Open), 0.0);
        Brush::new().cover(outline, width, height, |x, y, share| field.data[y * width + x] += share);
        field
    }

    #[test]
    fn covered_area_is_the_outline_s() {
        let triangle = [[3.3, 2.7], [60.2, 11.1], [20.9, 47.4]];
        let area = 0.5 * ((60.2 - 3.3) * (47.4 - 2.7) - (20.9 - 3.3) * (11.1 - 2.7));
        let sum: f64 = covered(&triangle, 64, 64).data.iter().map(|&v| v as f64).sum();
        // Some 140 rim cells, each wrong by at most a sixteenth and mostly cancelling.
        assert!((sum / area - 1.0).abs() < 0.005, "{sum} {area}");
        assert_eq!(covered(&triangle, 64, 64).at(25, 20), 1.0);
    }

    #[test]
    fn an_outline_larger_than_the_raster_covers_it() {
        let huge = [[-1e9, -1e9], [1e9, -1e9], [1e9, 1e9], [-1e9, 1e9]];
        assert!(covered(&huge, 2100, 3).data.iter().all(|&v| v == 1.0));
        assert!(covered(&[[-9.0, 1.0], [-5.0, 1.0], [-5.0, 4.0]], 8, 8).data.iter().all(|&v| v == 0.0));
        assert!(covered(&[[f64::NAN, 1.0], [5.0, 1.0], [5.0, 4.0]], 8, 8).data.iter().all(|&v| v == 0.0));
    }

    #[test]
    fn raising_in_bands_equals_covering_whole_and_any_threads() {
        let grid = Grid::new(150, 170, 150.0, Edges::Open);
        let raised: Vec<Raised> = (0..30)
            .map(|i| {
                let (x, y) = ((i * 37 % 150) as f64, (i * 53 % 170) as f64);
                let outline = vec![[x - 20.3, y], [x, y - 31.7], [x + 45.1, y + 3.0], [x + 6.0, y + 60.9]];
                Raised { outline, amount: 1.0 + i as f32 }
            })
            .collect();
        let fields = [1, 2, 8].map(|threads| {
            let mut field = Field::filled(grid, 0.0);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| raise(&mut field, &raised));
            field
        });
        assert!(fields.iter().all(|f| f.data == fields[0].data));
        let mut whole: Field<f32> = Field::filled(grid, 0.0);
        for r in &raised {
            Brush::new().cover(&r.outline, 150, 170, |x, y, s| whole.data[y * 150 + x] += s * r.amount);
        }
        let total = |f: &Field<f32>| f.data.iter().map(|&v| v as f64).sum::<f64>();
        assert!((total(&whole) / total(&fields[0]) - 1.0).abs() < 2e-3);
    }
}
