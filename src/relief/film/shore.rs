//! The coast of a picture: the same line and the same glow as `coast` finds, only where there are any. The line is looked
//! for no farther than it is wide.

use multiversion::multiversion;
use rayon::prelude::*;

use super::super::{coast::distance, frame::unit_of, tint::Brush};
use crate::grid::{Field, Grid, for_each_row};

/// The glow ends where it adds less than a third of a step of a byte.
const REACH: f32 = 36.0;

/// Unit of a picture from which on a line reaches into the pixel after the next: half its width, by `Brush`, is
/// 0.5 + 0.45 units, and a twentieth of a pixel is nothing.
const BROAD: f32 = 1.25;

/// Where land ends, at each pixel.
pub struct Shore {
    /// Whether a pixel is land.
    land: Vec<u8>,
    /// Distance to the coast where it is near, else infinite, pixels.
    pub line_px: Vec<f32>,
    /// Squared distance from the nearest land, pixels; at most that of the reach.
    pub offshore2: Vec<u16>,
    /// Rows to the nearest land in each column, up to one more than the reach.
    rows: Vec<u8>,
    reach: usize,
    /// Glow by squared distance.
    glow: Vec<f32>,
    /// Whether lines are broad enough to be looked for two pixels away.
    broad: bool,
}

impl Shore {
    /// Room for pictures of a size.
    pub fn new(map: Grid) -> Self {
        let unit = unit_of(&map);
        let reach = (REACH * unit).ceil().min(120.0) as usize;
        let far = (reach + 1) * (reach + 1);
        let mut glow: Vec<f32> = (0..=far).map(|d2| Brush::halo((d2 as f32).sqrt(), unit)).collect();
        glow[far] = 0.0;
        let cells = map.cells();
        Self {
            land: vec![0; cells],
            line_px: vec![0.0; cells],
            offshore2: vec![0; cells],
            rows: vec![0; cells],
            reach,
            glow,
            broad: unit > BROAD,
        }
    }

    /// Whether a pixel is land, or sea out of the glow.
    #[inline]
    pub fn plain(&self, index: usize) -> bool {
        let offshore2 = self.offshore2[index];
        offshore2 == 0 || self.glow[offshore2 as usize] == 0.0
    }

    /// How strongly the sea glows at a pixel.
    #[inline]
    pub fn glow(&self, index: usize) -> f32 {
        self.glow[self.offshore2[index] as usize]
    }

    /// Finds the coast of `z` at `sea`.
    pub fn find(&mut self, z: &Field<f32>, sea: f32) {
        let width = z.grid.width;
        for_each_row(&mut self.land, width, |y, row| {
            row.iter_mut().zip(z.row(y)).for_each(|(land, &h)| *land = u8::from(h > sea));
        });
        let land = &self.land;
        let look = if self.broad { line::<2> } else { line::<1> };
        let rows = self.line_px.par_chunks_exact_mut(width).enumerate();
        rows.for_each_init(Counts::default, |room, (y, row)| look(z, sea, land, y, room, row));
        self.sweep(width);
        let (rows, reach) = (&self.rows, self.reach);
        let room = || vec![0u16; width + 2 * reach];
        self.offshore2.par_chunks_exact_mut(width).enumerate().for_each_init(room, |padded, (y, row)| {
            across(&rows[y * width..][..width], reach, padded, row);
        });
    }

    /// Distances along the columns, down and up.
    fn sweep(&mut self, width: usize) {
        let far = self.reach as u8 + 1;
        self.rows.iter_mut().zip(&self.land).for_each(|(rows, &land)| *rows = if land > 0 { 0 } else { far });
        let next =
            |rows: &mut [u8], from: &[u8]| rows.iter_mut().zip(from).for_each(|(to, from)| *to = (*to).min(from + 1));
        for y in 1..self.rows.len() / width {
            let (above, below) = self.rows.split_at_mut(y * width);
            next(&mut below[..width], &above[(y - 1) * width..]);
        }
        for y in (1..self.rows.len() / width).rev() {
            let (above, below) = self.rows.split_at_mut(y * width);
            next(&mut above[(y - 1) * width..], &below[..width]);
        }
    }
}

/// Distances to the contour along a row. Most pixels see land or sea alone, which counting tells quickly.
fn line<const REACH: usize>(z: &Field<f32>, sea: f32, land: &[u8], y: usize, room: &mut Counts, row: &mut [f32]) {
    let (w, h) = (z.grid.width, z.grid.height);
    let (top, bottom) = (y.saturating_sub(REACH), (y + REACH).min(h - 1));
    room.count::<REACH>(&land[top * w..(bottom + 1) * w], w);
    let tall = (bottom - top + 1) as u8;
    for (x, (out, &sum)) in row.iter_mut().zip(&room.around).enumerate() {
        let wide = (x + REACH).min(w - 1) + 1 - x.saturating_sub(REACH);
        let plain = sum == 0 || sum == tall * wide as u8;
        *out = if plain { f32::INFINITY } else { distance::<REACH>(z, sea, x, y) };
    }
}

/// How many pixels of land there are around those of a row.
#[derive(Default)]
struct Counts {
    /// In each column, with room for the reach on either side.
    columns: Vec<u8>,
    around: Vec<u8>,
}

impl Counts {
    /// Counts in some rows.
    fn count<const REACH: usize>(&mut self, land: &[u8], width: usize) {
        self.columns.clear();
        self.columns.resize(width + 2 * REACH, 0);
        for row in land.chunks_exact(width) {
            self.columns[REACH..].iter_mut().zip(row).for_each(|(count, land)| *count += land);
        }
        self.around.clear();
        self.around.resize(width, 0);
        for step in 0..=2 * REACH {
            self.around.iter_mut().zip(&self.columns[step..]).for_each(|(sum, count)| *sum += count);
        }
    }
}

/// Squared distances along a row from those along the columns.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw", "x86_64+avx2"))]
fn across(rows: &[u8], reach: usize, padded: &mut [u16], out: &mut [u16]) {
    let far = (reach as u16 + 1) * (reach as u16 + 1);
    padded.fill(far);
    padded[reach..reach + rows.len()].iter_mut().zip(rows).for_each(|(to, &d)| *to = u16::from(d) * u16::from(d));
    const BLOCK: usize = 64;
    for (block, out) in out.chunks_mut(BLOCK).enumerate() {
        let from = block * BLOCK;
        let own = &padded[from + reach..][..out.len()];
        let near = &padded[from..][..out.len() + 2 * reach];
        if own.iter().all(|&d| d == 0) || near.iter().all(|&d| d == far) {
            out.copy_from_slice(own);
            continue;
        }
        out.fill(far);
        for step in 0..=2 * reach {
            let aside = step.abs_diff(reach) as u16;
            let aside = aside * aside;
            for (to, &d) in out.iter_mut().zip(&near[step..]) {
                *to = (*to).min(d + aside);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{grid::Edges, relief::coast::Coast};

    #[test]
    fn it_finds_what_the_map_finds() {
        let grid = Grid::new(300, 170, 300.0, Edges::Open);
        let z = Field::from_fn(grid, |x, y| {
            let hump = |cx: f32, cy: f32, r: f32| r - ((x as f32 - cx).powi(2) + (y as f32 - cy).powi(2)).sqrt();
            hump(40.0, 60.0, 25.3).max(hump(70.0, 160.0, 40.0)).max(hump(150.0, 20.0, 3.0))
        });
        let coast = Coast::new(&z, 0.0);
        let mut shore = Shore::new(grid);
        shore.find(&z, 0.0);
        let brush = Brush::new(unit_of(&grid));
        for (near, far) in shore.line_px.iter().zip(&coast.line_px.data) {
            assert!(near == far || !brush.on_line(*far) && !brush.on_line(*near), "{near} {far}");
        }
        for i in 0..grid.cells() {
            let want = Brush::halo(coast.offshore_px.data[i], unit_of(&grid));
            // 0.4·exp(−36/4.5).
            assert!((shore.glow(i) - want).abs() < 1.4e-4, "{i}: {} {want}", shore.glow(i));
        }
    }
}
