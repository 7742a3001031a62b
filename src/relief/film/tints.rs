//! The map's colours by height and light, worked out once: land, and sea out of the coast's glow.

use multiversion::multiversion;
use rayon::prelude::*;

use super::super::{
    palette::{Encoder, nearest},
    tint::{Brush, Place, Scene},
};

/// Heights told apart on land and in the sea: 3 m and 5 m on the scale of the Earth.
const HEIGHTS: usize = 2048;
/// Strengths of light told apart on land, a step of a byte each, and in the sea, whose floor is lit faintly. The sea's
/// table stays in a processor's own cache.
const TONES: [usize; 2] = [256, 128];
/// Where the sea's colours begin.
const SEA: usize = HEIGHTS * TONES[0];

/// Bytes of colours.
pub struct Tints {
    table: Vec<[u8; 3]>,
    /// Steps a metre, land and sea.
    per_m: [f32; 2],
}

impl Tints {
    /// The colours of a scene over a sea at zero.
    pub fn new(scene: &Scene, brush: &Brush, encoder: &Encoder) -> Self {
        let metres = scene.reach_m().map(|end| end / (HEIGHTS - 1) as f32);
        let bytes = |i: usize| {
            let (part, i) = if i < SEA { (0, i) } else { (1, i - SEA) };
            let (row, tone) = (i / TONES[part], i % TONES[part]);
            let tone = tone as f32 / (TONES[part] - 1) as f32 * 2.0 - 1.0;
            let place = Place { height_m: row as f32 * metres[part], tone, land: 1.0 - part as f32, ground: None };
            encoder.bytes(brush.pixel(scene, place, f32::INFINITY, || 0.0))
        };
        let table = (0..SEA + HEIGHTS * TONES[1]).into_par_iter().map(bytes).collect();
        Self { table, per_m: metres.map(f32::recip) }
    }

    /// Where the colours of a row's pixels stand.
    pub fn places(&self, heights: &[f32], sea_m: f32, tones: &[f32], places: &mut [u32]) {
        find_places(self.per_m, heights, sea_m, tones, places);
    }

    /// The colour at a place.
    #[inline]
    pub fn at(&self, place: u32) -> [u8; 3] {
        self.table[place as usize]
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn find_places(per_m: [f32; 2], heights: &[f32], sea_m: f32, tones: &[f32], places: &mut [u32]) {
    const TOP: f32 = (HEIGHTS - 1) as f32;
    const BRIGHTEST: [f32; 2] = [(TONES[0] - 1) as f32, (TONES[1] - 1) as f32];
    for ((place, &height), &tone) in places.iter_mut().zip(heights).zip(tones) {
        let over_m = height - sea_m;
        let bright = (0.5 * tone + 0.5).clamp(0.0, 1.0);
        let land = nearest((over_m * per_m[0]).clamp(0.0, TOP)) * TONES[0] as u32 + nearest(bright * BRIGHTEST[0]);
        let sea = nearest((over_m * per_m[1]).clamp(0.0, TOP)) * TONES[1] as u32 + nearest(bright * BRIGHTEST[1]);
        *place = if over_m > 0.0 { land } else { sea + SEA as u32 };
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
            }
        }
    }
}
