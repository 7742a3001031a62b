//! A map's colours over the land instead of what covers it.

use image::RgbImage;

use super::{Gpu, Land, RenderError, Renderer, ground::copies};

/// What the ground's shader knows it by, after the styles of `[scene.ground]`.
pub(super) const DRAPED: f32 = 3.0;

impl Renderer {
    /// Lays a picture of the whole map over the land, north up; only the sun changes its colours.
    pub fn drape(&self, land: &mut Land, colours: &RgbImage) -> Result<(), RenderError> {
        let gpu: &Gpu = self.gpu();
        let [width, height] = [land.cover.width(), land.cover.height()];
        let (from_w, from_h) = colours.dimensions();
        if from_w == 0 || from_h == 0 {
            return Ok(());
        }
        let place =
            |at: u32, most: u32, from: u32| (u64::from(2 * at + 1) * u64::from(from) / u64::from(2 * most)) as u32;
        let pixel = |i: u32| {
            let [r, g, b] = colours.get_pixel(place(i % width, width, from_w), place(i / width, height, from_h)).0;
            [r, g, b, 0]
        };
        let whole: Vec<[u8; 4]> = (0..width * height).map(pixel).collect();
        gpu.checked(|| {
            for (level, (size, data)) in copies([width as usize, height as usize], whole).iter().enumerate() {
                gpu.write(&land.cover, (level as u32, 0), *size, data);
            }
            Ok(())
        })?;
        land.draped = true;
        Ok(())
    }
}
