//! The sheet that marks are drawn on: polygons, lines, pictures. Coordinates are pixels from the upper left corner.

use image::RgbImage;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform,
};

use super::{
    palette::{Encoder, Rgb},
    rivers::Waters,
    smoke::Smoke,
};
use crate::grid::{Grid, for_each_row};

/// More pixels than any picture has.
pub const MOST_PIXELS: usize = 1 << 28;

/// An sRGB colour of marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink(pub u8, pub u8, pub u8, pub u8);

impl Ink {
    /// An opaque colour by its hexadecimal.
    pub const fn hex(code: u32) -> Self {
        Ink((code >> 16) as u8, (code >> 8) as u8, code as u8, 255)
    }

    /// The same, letting through what lies under it.
    pub const fn alpha(self, alpha: u8) -> Self {
        Ink(self.0, self.1, self.2, alpha)
    }

    /// A colour of linear light.
    pub fn linear(rgb: Rgb, encoder: &Encoder) -> Self {
        let [r, g, b] = encoder.bytes(rgb);
        Ink(r, g, b, 255)
    }
}

/// An opaque sheet of pixels.
pub struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// A sheet of one colour; at least one pixel.
    pub fn blank(width: usize, height: usize, ink: Ink) -> Self {
        let mut pixmap = Pixmap::new(width.max(1) as u32, height.max(1) as u32).expect("sizes are checked before");
        pixmap.fill(Color::from_rgba8(ink.0, ink.1, ink.2, 255));
        Self { pixmap }
    }

    /// A map's pixels.
    pub fn from_linear(grid: Grid, pixels: &[Rgb]) -> Self {
        let mut canvas = Self::blank(grid.width, grid.height, Ink(0, 0, 0, 255));
        let encoder = Encoder::new();
        for_each_row(canvas.pixmap.data_mut(), grid.width * 4, |y, row| {
            for (out, &rgb) in row.chunks_exact_mut(4).zip(&pixels[y * grid.width..]) {
                out[..3].copy_from_slice(&encoder.bytes(rgb));
            }
        });
        canvas
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.pixmap.width() as usize
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.pixmap.height() as usize
    }

    /// Fills a polygon.
    pub fn polygon(&mut self, points: &[[f32; 2]], ink: Ink) {
        if let Some(path) = path(points, true) {
            self.pixmap.fill_path(&path, &paint(ink), FillRule::Winding, Transform::identity(), None);
        }
    }

    /// Fills an upright rectangle.
    pub fn rect(&mut self, [x, y]: [f32; 2], [w, h]: [f32; 2], ink: Ink) {
        self.polygon(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h]], ink);
    }

    /// Draws the outline of an upright rectangle.
    pub fn frame(&mut self, [x, y]: [f32; 2], [w, h]: [f32; 2], width: f32, ink: Ink) {
        self.line(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]], width, ink);
    }

    /// Draws a line through points; closed where the last is the first.
    pub fn line(&mut self, points: &[[f32; 2]], width: f32, ink: Ink) {
        let closed = points.len() > 2 && points.first() == points.last();
        let points = if closed { &points[..points.len() - 1] } else { points };
        if let Some(path) = path(points, closed) {
            let (line_cap, line_join) =
                if closed { (LineCap::Butt, LineJoin::Miter) } else { (LineCap::Butt, LineJoin::Round) };
            let stroke = Stroke { width, line_cap, line_join, ..Stroke::default() };
            self.pixmap.stroke_path(&path, &paint(ink), &stroke, Transform::identity(), None);
        }
    }

    /// Puts another sheet on this one, cut off at the rim.
    pub fn put(&mut self, other: &Canvas, x: usize, y: usize) {
        let wide = other.width().min(self.width().saturating_sub(x));
        let tall = other.height().min(self.height().saturating_sub(y));
        let (to, from) = (self.width(), other.width());
        for row in 0..tall {
            let source = &other.pixmap.pixels()[row * from..][..wide];
            self.pixmap.pixels_mut()[(y + row) * to + x..][..wide].copy_from_slice(source);
        }
    }

    /// Lays rivers and lakes over the sheet.
    pub fn lay(&mut self, waters: &Waters) {
        let width = self.width();
        for_each_row(self.pixmap.data_mut(), width * 4, |y, row| waters.lay::<4>(y, 1.0, row));
    }

    /// Lays smoke over the sheet.
    pub fn cover(&mut self, smoke: &Smoke) {
        let width = self.width();
        for_each_row(self.pixmap.data_mut(), width * 4, |y, row| smoke.lay::<4>(y, row));
    }

    /// Lays a colour over one pixel by a coverage; nothing beyond the rim.
    pub fn blend(&mut self, x: i64, y: i64, ink: Ink, coverage: f32) {
        let (width, height) = (self.width() as i64, self.height() as i64);
        if x < 0 || y < 0 || x >= width || y >= height {
            return;
        }
        let share = coverage.clamp(0.0, 1.0) * ink.3 as f32 / 255.0;
        let pixel = &mut self.pixmap.pixels_mut()[(y * width + x) as usize];
        let over = |old: u8, new: u8| (old as f32 + (new as f32 - old as f32) * share + 0.5) as u8;
        let (r, g, b) = (over(pixel.red(), ink.0), over(pixel.green(), ink.1), over(pixel.blue(), ink.2));
        // Opaque, so that premultiplied and plain are the same.
        *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
    }

    /// The finished picture.
    pub fn into_image(self) -> RgbImage {
        let (width, height) = (self.pixmap.width(), self.pixmap.height());
        let bytes = self.pixmap.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        RgbImage::from_raw(width, height, bytes).expect("three bytes a pixel")
    }

    /// A finished picture to draw on.
    pub fn from_image(image: &RgbImage) -> Self {
        let mut canvas = Self::blank(image.width() as usize, image.height() as usize, Ink(0, 0, 0, 255));
        for (out, pixel) in canvas.pixmap.data_mut().chunks_exact_mut(4).zip(image.pixels()) {
            out[..3].copy_from_slice(&pixel.0);
        }
        canvas
    }
}

fn path(points: &[[f32; 2]], close: bool) -> Option<Path> {
    let (first, rest) = points.split_first()?;
    let mut builder = PathBuilder::new();
    builder.move_to(first[0], first[1]);
    rest.iter().for_each(|p| builder.line_to(p[0], p[1]));
    if close {
        builder.close();
    }
    builder.finish()
}

fn paint(ink: Ink) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(ink.0, ink.1, ink.2, ink.3);
    paint.anti_alias = true;
    paint
}
