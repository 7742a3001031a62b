//! The picture's raster: the world's own, averaged in whole blocks, or a whole number of pixels to a cell.

use crate::grid::{Field, Grid, cubic};

/// How the world's cells become pixels.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The pixels, as a grid over the same ground.
    pub grid: Grid,
    from: Grid,
    /// Cells a pixel, on a side.
    shrink: usize,
    /// Pixels a cell, on a side.
    grow: usize,
}

impl Frame {
    /// The frame for a world: its longer side between `min_px` and `max_px`, if whole numbers allow it.
    pub fn new(from: Grid, max_px: usize, min_px: usize) -> Self {
        let side = from.width.max(from.height).max(1);
        let max_px = max_px.max(1);
        let shrink = side.div_ceil(max_px);
        let grow = if shrink > 1 { 1 } else { min_px.div_ceil(side).min(max_px / side).max(1) };
        let scale = |cells: usize| cells.div_ceil(shrink) * grow;
        let cell_m = from.cell_m * shrink as f64 / grow as f64;
        let grid = Grid { width: scale(from.width), height: scale(from.height), cell_m, edges: from.edges };
        Self { grid, from, shrink, grow }
    }

    /// Size of marks and text, relative to a picture of 1024 pixels.
    pub fn unit(&self) -> f32 {
        unit_of(&self.grid)
    }

    /// The size of a cell, in words.
    pub fn cell_text(&self) -> String {
        let m = self.from.cell_m;
        let (value, unit) = if m >= 1000.0 { (m / 1000.0, "km") } else { (m, "m") };
        let digits = if value >= 100.0 || value == libm::floor(value) { 0 } else { 2 };
        let [w, h] = [self.from.width, self.from.height];
        format!("{w} × {h} cells of {value:.digits$} {unit}")
    }

    /// A quantity at the pixels: block means, or a smooth surface through the cells.
    pub fn continuous(&self, field: &Field<f32>) -> Field<f32> {
        if self.grow > 1 {
            return Field::from_fn(self.grid, |x, y| cubic(field, self.grid.center_m(x, y)) as f32);
        }
        if self.shrink == 1 {
            return field.clone();
        }
        Field::from_fn(self.grid, |x, y| {
            let columns = x * self.shrink..((x + 1) * self.shrink).min(self.from.width);
            let rows = y * self.shrink..((y + 1) * self.shrink).min(self.from.height);
            let count = (columns.len() * rows.len()) as f64;
            let sum: f64 = rows.map(|y| field.row(y)[columns.clone()].iter().map(|&v| v as f64).sum::<f64>()).sum();
            (sum / count) as f32
        })
    }

    /// An identity at the pixels: that of the cell in the middle.
    pub fn nearest(&self, field: &Field<f32>) -> Field<f32> {
        let pick = |i: usize, cells: usize| {
            if self.grow > 1 { i / self.grow } else { (i * self.shrink + self.shrink / 2).min(cells - 1) }
        };
        Field::from_fn(self.grid, |x, y| field.at(pick(x, self.from.width), pick(y, self.from.height)))
    }
}

/// Size of marks and text on a picture of these pixels, relative to one of 1024.
pub fn unit_of(pixels: &Grid) -> f32 {
    (pixels.width.max(pixels.height) as f32 / 1024.0).clamp(0.7, 4.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn frame(width: usize, height: usize, max_px: usize, min_px: usize) -> Frame {
        Frame::new(Grid::new(width, height, width as f64 * 10.0, Edges::Open), max_px, min_px)
    }

    #[test]
    fn sizes() {
        let size = |f: Frame| (f.grid.width, f.grid.height, f.grid.cell_m);
        assert_eq!(size(frame(1024, 512, 2048, 512)), (1024, 512, 10.0));
        assert_eq!(size(frame(1000, 500, 300, 0)), (250, 125, 40.0));
        assert_eq!(size(frame(96, 48, 2048, 512)), (576, 288, 10.0 / 6.0));
        assert_eq!(size(frame(96, 96, 128, 512)), (96, 96, 10.0));
        assert_eq!(size(frame(1, 1, 64, 0)), (1, 1, 10.0));
    }

    #[test]
    fn means_are_kept() {
        let f = frame(10, 6, 5, 0);
        let field = Field::from_fn(f.from, |x, y| (x + 10 * y) as f32);
        assert_eq!(f.continuous(&field).at(1, 2), (42 + 43 + 52 + 53) as f32 / 4.0);
        assert_eq!(f.nearest(&field).at(0, 0), 11.0);
    }
}
