//! Many pictures on one labelled sheet.

use image::RgbImage;

use super::{
    marks::{Canvas, Ink, MOST_PIXELS},
    text::{self, Align},
};

const PAPER: Ink = Ink::hex(0xfaf8f2);
const INK: Ink = Ink::hex(0x2d3438);
const GAP: usize = 14;
const LABEL: usize = 24;

/// The pictures in rows of `columns`, each with its label under it. Pictures beyond what one sheet holds are left out.
pub fn contact_sheet(items: &[(String, RgbImage)], columns: usize) -> RgbImage {
    let columns = columns.clamp(1, items.len().max(1));
    let most = |size: fn(&RgbImage) -> u32| items.iter().map(|(_, image)| size(image)).max().unwrap_or(1) as usize;
    let (wide, tall) = (most(RgbImage::width), most(RgbImage::height));
    let width = GAP + columns * (wide + GAP);
    let row_px = tall + LABEL + GAP;
    let rows = items.len().div_ceil(columns).clamp(1, (MOST_PIXELS / width / row_px).max(1));
    let mut sheet = Canvas::blank(width, GAP + rows * row_px, PAPER);
    let size = (wide as f32 / 10.0).clamp(9.0, 15.0);
    for (i, (label, image)) in items.iter().enumerate().take(rows * columns) {
        let (left, top) = (GAP + i % columns * (wide + GAP), GAP + i / columns * row_px);
        let (w, h) = (image.width() as usize, image.height() as usize);
        let (x, y) = (left + (wide - w) / 2, top + (tall - h) / 2);
        sheet.put(&Canvas::from_image(image), x, y);
        sheet.frame([x as f32 - 0.5, y as f32 - 0.5], [w as f32 + 1.0, h as f32 + 1.0], 1.0, INK);
        let label = text::fitted(label, size, wide as f32);
        let at = [left as f32 + wide as f32 / 2.0, (y + h) as f32 + size + 3.0];
        text::write(&mut sheet, &label, at, size, Align::Middle, INK);
    }
    sheet.into_image()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_where_they_belong() {
        let tile = |v: u8| (format!("seed {v}"), RgbImage::from_pixel(40, 30, image::Rgb([v, 0, 0])));
        let sheet = contact_sheet(&[tile(10), tile(20), tile(30)], 2);
        assert_eq!(sheet.dimensions(), ((14 + 2 * 54) as u32, (14 + 2 * 68) as u32));
        assert_eq!(sheet.get_pixel(14 + 20, 14 + 15).0, [10, 0, 0]);
        assert_eq!(sheet.get_pixel(14 + 54 + 20, 14 + 15).0, [20, 0, 0]);
        assert_eq!(sheet.get_pixel(14 + 20, 14 + 68 + 15).0, [30, 0, 0]);
        assert_eq!(contact_sheet(&[], 6).width(), 29);
    }
}
