//! The passes over a picture's pixels.

use multiversion::multiversion;
use rayon::prelude::*;

use super::{
    super::{
        coast,
        layers::SHADING,
        palette::{Encoder, Rgb, each, hex, mix},
        smoke::Smoke,
        tint::{Place, lit, lit_part},
    },
    Animation, Shot,
};
use crate::grid::{Grid, for_each_row};

/// Values between two shots, row by row.
struct Between<'a> {
    from: &'a [f32],
    to: &'a [f32],
    share: f32,
}

impl Between<'_> {
    fn row(&self, y: usize, out: &mut [f32]) {
        let width = out.len();
        let (from, to) = (&self.from[y * width..][..width], &self.to[y * width..][..width]);
        if self.share >= 1.0 {
            return out.copy_from_slice(to);
        }
        for ((out, a), b) in out.iter_mut().zip(from).zip(to) {
            *out = a + (b - a) * self.share;
        }
    }
}

/// The land's flat colours between two shots, of which at least one has weather.
struct Ground<'a> {
    from: Option<&'a [Vec<f32>; 3]>,
    to: Option<&'a [Vec<f32>; 3]>,
    share: f32,
}

impl Ground<'_> {
    /// The colours of a row; `plain` gives that of a pixel by its height alone.
    fn row(&self, y: usize, plain: impl Fn(usize) -> Rgb, out: &mut [Vec<f32>; 3]) {
        if let (Some(from), Some(to)) = (self.from, self.to) {
            for ((out, from), to) in out.iter_mut().zip(from).zip(to) {
                Between { from, to, share: self.share }.row(y, out);
            }
            return;
        }
        let width = out[0].len();
        for x in 0..width {
            let own = |colours: Option<&[Vec<f32>; 3]>| {
                colours.map_or_else(|| plain(x), |colours| each(|c| colours[c][y * width + x]))
            };
            let colour = mix(own(self.from), own(self.to), self.share.min(1.0));
            out.iter_mut().zip(colour).for_each(|(out, part)| out[x] = part);
        }
    }
}

/// Room for a row's values.
struct Room {
    tone: Vec<f32>,
    values: Vec<f32>,
    tints: Vec<u32>,
    /// The land's flat colours, and where the bytes of the lit ones stand.
    flat: [Vec<f32>; 3],
    places: [Vec<u16>; 3],
}

impl Animation {
    /// Draws the map into the picture's upper left corner.
    pub(super) fn paint(&mut self, [from, to]: [&Shot; 2], share: f32, picture: &mut [u8]) {
        let map = self.map;
        let heights = Between { from: &from.height.data, to: &to.height.data, share };
        for_each_row(&mut self.heights.data, map.width, |y, row| heights.row(y, row));
        let proportion = |a: f32, b: f32| if share >= 1.0 { b } else { a + (b - a) * share };
        let sea_m = proportion(from.sea_m, to.sea_m);
        self.shore.find(&self.heights, sea_m);
        let tones = Between { from: &from.tone, to: &to.tone, share };
        // Names change half way; what has an order goes in proportion.
        let nearest = if share < 0.5 { from } else { to };
        let values = match (&from.values, &to.values, &nearest.values) {
            (Some(a), Some(b), Some(near)) => {
                let named = self.colours.as_ref().is_some_and(|colours| colours.named());
                Some(if named {
                    Between { from: near, to: near, share: 1.0 }
                } else {
                    Between { from: a, to: b, share }
                })
            }
            _ => None,
        };
        let ground = Ground { from: from.ground.as_ref(), to: to.ground.as_ref(), share };
        let ground = Some(ground).filter(|ground| ground.from.is_some() || ground.to.is_some());
        // Rivers that come or go fade; those of both are the nearer's.
        let waters = match (&from.waters, &to.waters) {
            (Some(_), Some(_)) => nearest.waters.as_ref().map(|waters| (waters, 1.0)),
            (Some(waters), None) => Some((waters, 1.0 - share)),
            (None, waters) => waters.as_ref().map(|waters| (waters, share)),
        };
        let smoke = if self.smoke { smoke([from, to], share, &map) } else { None };
        let this = &*self;
        let room = || {
            let row = || vec![0.0; map.width];
            Room {
                tone: row(),
                values: row(),
                tints: vec![0; map.width],
                flat: [row(), row(), row()],
                places: [0; 3].map(|_| vec![0; map.width]),
            }
        };
        let rows = picture.par_chunks_exact_mut(this.size[0] * 3).take(map.height).enumerate();
        rows.for_each_init(room, |room, (y, out)| {
            let out = &mut out[..map.width * 3];
            tones.row(y, &mut room.tone);
            match &values {
                Some(values) => this.layer_row(values, sea_m, y, room, out),
                None => this.relief_row(sea_m, ground.as_ref(), y, room, out),
            }
            if let Some((waters, share)) = waters {
                waters.lay::<3>(y, share, out);
            }
            if let Some(smoke) = &smoke {
                smoke.lay::<3>(y, out);
            }
        });
    }

    /// A row of the relief: most pixels are looked up by height and light, or by weather a row at a time; those on the
    /// coast and in its glow are mixed.
    fn relief_row(&self, sea_m: f32, ground: Option<&Ground>, y: usize, room: &mut Room, out: &mut [u8]) {
        let Room { tone, tints, flat, places, .. } = room;
        let heights = self.heights.row(y);
        self.tints.places(heights, sea_m, tone, tints);
        if let Some(ground) = ground {
            ground.row(y, |x| self.scene.land((heights[x] - sea_m).max(0.0)), flat);
            for (c, (places, flat)) in places.iter_mut().zip(flat.iter()).enumerate() {
                lit_places(c, flat, tone, places);
            }
        }
        let begin = y * self.map.width;
        for (x, pixel) in out.chunks_exact_mut(3).enumerate() {
            // The scene is over a sea at zero.
            let (height_m, line_px) = (heights[x] - sea_m, self.shore.line_px[begin + x]);
            if line_px > 1.0 && !self.brush.on_line(line_px) {
                let known = match (height_m > 0.0, ground) {
                    (true, Some(_)) => Some(each(|c| self.encoder.byte(places[c][x]))),
                    _ => self.shore.plain(begin + x).then(|| self.tints.at(tints[x])),
                };
                if let Some(colour) = known {
                    pixel.copy_from_slice(&colour);
                    continue;
                }
            }
            let own = ground.filter(|_| height_m > 0.0 || line_px <= 1.0).map(|_| each(|c| flat[c][x]));
            let land = coast::land_share(height_m > 0.0, line_px);
            let place = Place { height_m, tone: tone[x], land, ground: own };
            let colour = self.brush.pixel(&self.scene, place, line_px, || self.shore.glow(begin + x));
            pixel.copy_from_slice(&self.encoder.bytes(colour));
        }
    }

    fn layer_row(&self, values: &Between, sea_m: f32, y: usize, room: &mut Room, out: &mut [u8]) {
        let own = &mut room.values;
        values.row(y, own);
        let (ink, half) = (hex(0x202830), 0.5 + 0.35 * self.unit);
        let begin = y * self.map.width;
        let colour = |value: f32| -> Rgb {
            match &self.colours {
                Some(colours) => colours.at(value),
                None => self.scene.at(value - sea_m),
            }
        };
        for (x, (pixel, &height_m)) in out.chunks_exact_mut(3).zip(self.heights.row(y)).enumerate() {
            let depth = if height_m > sea_m { SHADING } else { SHADING * 0.5 };
            let line = (half - self.shore.line_px[begin + x]).clamp(0.0, 1.0);
            let lit = mix(lit(colour(own[x]), room.tone[x] * depth), ink, 0.55 * line);
            pixel.copy_from_slice(&self.encoder.bytes(lit));
        }
    }
}

/// The smoke between two shots. Where no time passes between them, plumes that are new come up with the picture.
fn smoke([from, to]: [&Shot; 2], share: f32, map: &Grid) -> Option<Smoke> {
    let time_yr = from.time_yr + (to.time_yr - from.time_yr) * f64::from(share);
    let fresh = if to.time_yr > from.time_yr { 1.0 } else { f64::from(share.min(1.0)) };
    let strength = |plume| if from.plumes.contains(plume) { 1.0 } else { fresh };
    Smoke::at(to.plumes.iter().map(|plume| (plume, strength(plume))), time_yr, map)
}

/// Where the bytes of one part of a row's colours stand, red, green or blue, under light.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw", "x86_64+avx2"))]
fn lit_places(c: usize, flat: &[f32], tones: &[f32], places: &mut [u16]) {
    for ((place, &part), &tone) in places.iter_mut().zip(flat).zip(tones) {
        *place = Encoder::place(lit_part(c, part, tone));
    }
}
