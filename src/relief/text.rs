//! Words on a picture, in the font that ships with the interface.

use ab_glyph::{Font, FontRef, ScaleFont};

use super::marks::{Canvas, Ink};

/// Where the point of a text lies on its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// At its start.
    Left,
    /// In its middle.
    Middle,
}

fn font() -> FontRef<'static> {
    FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).expect("the font is part of the program")
}

/// Width of a text, pixels.
pub fn width(text: &str, size_px: f32) -> f32 {
    let font = font();
    let font = font.as_scaled(size_px);
    let mut previous = None;
    text.chars()
        .map(|c| {
            let id = font.glyph_id(c);
            let kern = previous.replace(id).map_or(0.0, |p| font.kern(p, id));
            kern + font.h_advance(id)
        })
        .sum()
}

/// The text cut short with an ellipsis where it would be wider than `most_px`.
pub fn fitted(text: &str, size_px: f32, most_px: f32) -> String {
    if width(text, size_px) <= most_px {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    while kept.pop().is_some() {
        let shorter: String = kept.iter().collect::<String>().trim_end().to_owned() + "…";
        if width(&shorter, size_px) <= most_px {
            return shorter;
        }
    }
    String::new()
}

/// Writes `text` with its baseline at `[x, y]`.
pub fn write(canvas: &mut Canvas, text: &str, [x, y]: [f32; 2], size_px: f32, align: Align, ink: Ink) {
    let font = font();
    let font = font.as_scaled(size_px);
    let shift = match align {
        Align::Left => 0.0,
        Align::Middle => 0.5,
    };
    // Whole pixels keep stems crisp.
    let (mut at, y) = ((x - width(text, size_px) * shift).round(), y.round());
    let mut previous = None;
    for c in text.chars() {
        let id = font.glyph_id(c);
        at += previous.replace(id).map_or(0.0, |p| font.kern(p, id));
        let glyph = id.with_scale_and_position(size_px, ab_glyph::point(at, y));
        at += font.h_advance(id);
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let corner = outline.px_bounds().min;
        outline.draw(|gx, gy, coverage| {
            // The light face is thin at small sizes: a little more ink.
            let coverage = (coverage * 1.25).min(1.0);
            canvas.blend(corner.x as i64 + gx as i64, corner.y as i64 + gy as i64, ink, coverage);
        });
    }
}

/// Writes with a halo around the letters, so that it reads on any ground.
pub fn write_haloed(
    canvas: &mut Canvas,
    text: &str,
    [x, y]: [f32; 2],
    size_px: f32,
    align: Align,
    ink: Ink,
    halo: Ink,
) {
    let r = (size_px / 11.0).max(1.0).round();
    for (dx, dy) in
        [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
    {
        write(canvas, text, [x + dx * r, y + dy * r], size_px, align, halo);
    }
    write(canvas, text, [x, y], size_px, align, ink);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longer_words_are_wider_and_are_cut_to_fit() {
        assert!(width("Continental collision", 12.0) > width("Rift", 12.0));
        assert_eq!(fitted("Rift", 12.0, 500.0), "Rift");
        let cut = fitted("Continental collision", 12.0, 60.0);
        assert!(cut.ends_with('…') && width(&cut, 12.0) <= 60.0 && cut.len() > 5, "{cut}");
    }

    #[test]
    fn ink_lands_where_it_should() {
        let mut canvas = Canvas::blank(60, 20, Ink::hex(0xffffff));
        write(&mut canvas, "HH", [30.0, 16.0], 14.0, Align::Middle, Ink::hex(0));
        let image = canvas.into_image();
        let dark = |x0, x1| (x0..x1).any(|x| (5..17).any(|y| image.get_pixel(x, y).0[0] < 90));
        assert!(dark(20, 30) && dark(30, 40) && !dark(0, 15) && !dark(45, 60));
    }
}
