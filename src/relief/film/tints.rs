//! The map's colours by height and light, worked out once: land, and open sea.

use rayon::prelude::*;

use super::super::{
    palette::{Encoder, Rgb},
    tint::{Brush, Place, Scene},
};

/// Heights told apart on land and in the sea: 3 m and 5 m on the scale of the Earth.
const HEIGHTS: usize = 2048;
/// Strengths of light told apart, a step of a byte each.
const TONES: usize = 256;

/// Of the lights on a sea floor, which are faint, one in so many is told apart.
const FLOOR_TONES: usize = 4;

/// Bytes of colours.
pub struct Tints {
    table: Vec<[u8; 3]>,
    /// The sea's colours in linear light, to be mixed with its glow.
    sea: Vec<Rgb>,
    /// Steps a metre, land and sea.
    per_m: [f32; 2],
}

impl Tints {
    /// The colours of a scene over a sea at zero.
    pub fn new(scene: &Scene, brush: &Brush, encoder: &Encoder) -> Self {
        let [top, bottom] = scene.reach_m();
        let metres = [top, bottom].map(|end| end / (HEIGHTS - 1) as f32);
        let linear = |row: usize, tone: f32| {
            let tone = tone / (TONES - 1) as f32 * 2.0 - 1.0;
            let place = match row.checked_sub(HEIGHTS) {
                None => Place { height_m: row as f32 * metres[0], tone, land: 1.0, ground: None },
                Some(row) => Place { height_m: row as f32 * metres[1], tone, land: 0.0, ground: None },
            };
            brush.pixel(scene, place, f32::INFINITY, || 0.0)
        };
        let bytes = |i: usize| encoder.bytes(linear(i / TONES, (i % TONES) as f32));
        let table = (0..2 * HEIGHTS * TONES).into_par_iter().map(bytes).collect();
        // The middle of the lights that one entry stands for.
        let middle = |i: usize| (i * FLOOR_TONES % TONES) as f32 + 0.5 * (FLOOR_TONES - 1) as f32;
        let floor = |i: usize| linear(HEIGHTS + i * FLOOR_TONES / TONES, middle(i));
        let sea = (0..HEIGHTS * TONES / FLOOR_TONES).into_par_iter().map(floor).collect();
        Self { table, sea, per_m: metres.map(f32::recip) }
    }

    /// Where the colours of a row's pixels stand.
    pub fn places(&self, heights: &[f32], sea_m: f32, tone: &[f32], places: &mut [u32]) {
        const TOP: f32 = (HEIGHTS - 1) as f32;
        let [land, sea] = self.per_m;
        for ((place, &height), &tone) in places.iter_mut().zip(heights).zip(tone) {
            let over_m = height - sea_m;
            let (per_m, begin) = if over_m > 0.0 { (land, 0) } else { (sea, HEIGHTS as i32) };
            let row = (over_m * per_m + 0.5).clamp(0.0, TOP) as i32 + begin;
            let tone = ((tone + 1.0) * (0.5 * (TONES - 1) as f32) + 0.5).clamp(0.0, (TONES - 1) as f32) as i32;
            *place = (row * TONES as i32 + tone) as u32;
        }
    }

    /// The colour at a place.
    #[inline]
    pub fn at(&self, place: u32) -> [u8; 3] {
        self.table[place as usize]
    }

    /// The sea's colour at a place of the sea, in linear light.
    #[inline]
    pub fn sea_at(&self, place: u32) -> Rgb {
        self.sea[(place as usize - HEIGHTS * TONES) / FLOOR_TONES]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looked_up_colours_are_those_of_the_map() {
        let (scene, brush, encoder) = (Scene::over([-8000.0, 6000.0], 0.0), Brush::new(1.0), Encoder::new());
        let tints = Tints::new(&scene, &brush, &encoder);
        let heights: Vec<f32> = (0..14_000).map(|m| m as f32 - 7999.7).collect();
        for step in 0..40 {
            let tone = vec![step as f32 / 20.0 - 0.99; heights.len()];
            let mut places = vec![0; heights.len()];
            tints.places(&heights, 100.0, &tone, &mut places);
            for (&height, &place) in heights.iter().zip(&places) {
                let height_m = height - 100.0;
                let place_of =
                    Place { height_m, tone: tone[0], land: if height_m > 0.0 { 1.0 } else { 0.0 }, ground: None };
                let want = encoder.bytes(brush.pixel(&scene, place_of, f32::INFINITY, || 0.0));
                let apart = tints.at(place).iter().zip(want).map(|(a, b)| a.abs_diff(b)).max();
                // Half a step of height where colours change fastest, and half a step of light.
                assert!(apart <= Some(3), "{height_m} m, tone {}: {:?} {want:?}", tone[0], tints.at(place));
                if height_m <= 0.0 {
                    let glowing = encoder.bytes(brush.glowing(tints.sea_at(place), 0.2));
                    let want = encoder.bytes(brush.pixel(&scene, place_of, f32::INFINITY, || 0.2));
                    let apart = glowing.iter().zip(want).map(|(a, b)| a.abs_diff(b)).max();
                    assert!(apart <= Some(3), "{height_m} m, tone {}: {glowing:?} {want:?}", tone[0]);
                }
            }
        }
    }
}
