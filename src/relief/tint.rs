//! Hypsometric tints: colour by height, with a break at sea level.
//!
//! Where a world has real relief, a colour stands for the same metres on every map: green lowland, buff, brown, grey
//! rock, white only where snow would lie; the shelf pale, the abyss blue, trenches dark. A small world spreads the same
//! colours over its own heights, without the snow.

use super::{
    Options,
    coast::Coast,
    cover::Cover,
    frame::Frame,
    palette::{Ramp, Rgb, each, hex, mix},
    shade::shade,
};
use crate::grid::Field;

/// Metres over the sea.
const LAND: [(f64, u32); 11] = [
    (0.0, 0x66976a),
    (120.0, 0x80a870),
    (350.0, 0xa3ba72),
    (700.0, 0xcfc980),
    (1200.0, 0xdabf79),
    (1900.0, 0xc69c5e),
    (2700.0, 0xab7d4d),
    (3500.0, 0x967660),
    (4200.0, 0xa59d97),
    (5000.0, 0xd6d5d6),
    (5800.0, 0xffffff),
];
/// Metres over the sea, from the deepest.
const SEA: [(f64, u32); 9] = [
    (-10000.0, 0x10203f),
    (-7500.0, 0x1c3763),
    (-6000.0, 0x2a5184),
    (-4500.0, 0x3a6fa0),
    (-3000.0, 0x5490b8),
    (-1500.0, 0x79b0cc),
    (-250.0, 0xa3d0df),
    (-60.0, 0xb9e0e4),
    (0.0, 0xc8e9e6),
];
/// Relief from which colours stand for absolute metres.
const ABSOLUTE_M: f64 = 1500.0;
/// A small world's highest land gets the colour of this height.
const SMALL_TOP_M: f64 = 4000.0;
/// A small world's deepest sea gets the colour of this height.
const SMALL_BOTTOM_M: f64 = -4500.0;

/// What a world's heights are coloured by.
pub struct Scene {
    /// Sea level, m.
    pub sea_m: f64,
    /// Lowest and highest ground, m.
    pub range_m: [f64; 2],
    land: Ramp,
    sea: Ramp,
}

impl Scene {
    /// The tints for a world of these heights.
    pub fn new(height: &Field<f32>, sea_m: f64) -> Self {
        let (low, high) = height.range().map_or((0.0, 0.0), |(a, b)| (a as f64, b as f64));
        Self::over([low, high], sea_m)
    }

    /// The tints for heights between these two.
    pub fn over([low, high]: [f64; 2], sea_m: f64) -> Self {
        let (bottom, top) = (low.max(sea_m), high.max(sea_m));
        let absolute = high - low > ABSOLUTE_M;
        // Land far above the sea starts at its own foot.
        let anchor = if absolute || bottom - sea_m < 0.5 * (top - bottom) { sea_m } else { bottom };
        let up = if absolute { 1.0 } else { (top - anchor).max(1.0) / SMALL_TOP_M };
        let down = if absolute { 1.0 } else { (low - sea_m).min(-1.0) / SMALL_BOTTOM_M };
        let scaled = |stops: &[(f64, u32)], from: f64, by: f64| {
            Ramp::new(&stops.iter().map(|&(m, code)| (from + m * by, code)).collect::<Vec<_>>())
        };
        Self { sea_m, range_m: [low, high], land: scaled(&LAND, anchor, up), sea: scaled(&SEA, sea_m, down) }
    }

    /// Highest and lowest height that colours tell apart, m.
    pub fn reach_m(&self) -> [f32; 2] {
        [self.land.ends()[1], self.sea.ends()[0]]
    }

    /// The colour of dry land at a height.
    #[inline]
    pub fn land(&self, height_m: f32) -> Rgb {
        self.land.at(height_m)
    }

    /// The colour of sea over a floor at a height.
    #[inline]
    pub fn sea(&self, height_m: f32) -> Rgb {
        self.sea.at(height_m)
    }

    /// The flat colour of a height.
    pub fn at(&self, height_m: f32) -> Rgb {
        if height_m as f64 > self.sea_m { self.land(height_m) } else { self.sea(height_m) }
    }
}

/// The shaded, coloured map, in linear light.
pub fn relief(
    frame: &Frame,
    heights: &Field<f32>,
    scene: &Scene,
    cover: Option<&Cover>,
    options: &Options,
) -> Vec<Rgb> {
    let sea = scene.sea_m as f32;
    let has_land = scene.range_m[1] > scene.sea_m;
    let tone = shade(heights, |h| h > sea || !has_land, options.exaggeration);
    let coast = Coast::new(heights, sea);
    let (unit, brush) = (frame.unit(), Brush::new(frame.unit()));
    let mut pixels = vec![[0.0; 3]; frame.grid.cells()];
    crate::grid::map_cells(&mut pixels, frame.grid.width, |x, y| {
        let halo = || Brush::halo(coast.offshore_px.at(x, y), unit);
        let (height_m, land) = (heights.at(x, y), coast.land.at(x, y));
        let ground = cover.filter(|_| land > 0.0);
        let ground = ground.map(|cover| cover.at(heights, x, y, || scene.land(height_m.max(sea))));
        let place = Place { height_m, tone: tone.at(x, y), land, ground };
        brush.pixel(scene, place, coast.line_px.at(x, y), halo)
    });
    pixels
}

/// What the map shows at a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Height, m.
    pub height_m: f32,
    /// How bright it is, -1 to 1.
    pub tone: f32,
    /// Share of it that is land.
    pub land: f32,
    /// The land's flat colour, where it is not that of its height.
    pub ground: Option<Rgb>,
}

/// Colours a map's pixels.
pub struct Brush {
    ink: Rgb,
    glow: Rgb,
    half_line_px: f32,
}

impl Brush {
    /// For marks of a size.
    pub fn new(unit: f32) -> Self {
        Self { ink: hex(0x24455a), glow: hex(0xbfe2e8), half_line_px: 0.5 + 0.45 * unit }
    }

    /// How strongly the sea glows at a distance from land.
    pub fn halo(offshore_px: f32, unit: f32) -> f32 {
        0.40 * libm::expf(-offshore_px / (4.5 * unit))
    }

    /// The sea's colour with its glow.
    #[inline(always)]
    pub fn glowing(&self, sea: Rgb, halo: f32) -> Rgb {
        mix(sea, self.glow, halo)
    }

    /// Whether the coast's line touches a pixel.
    #[inline]
    pub fn on_line(&self, line_px: f32) -> bool {
        line_px < self.half_line_px
    }

    /// A pixel in linear light.
    #[inline(always)]
    pub fn pixel(&self, scene: &Scene, place: Place, line_px: f32, halo: impl Fn() -> f32) -> Rgb {
        let Place { height_m, tone, land, ground } = place;
        let sea = scene.sea_m as f32;
        let dry = || lit(ground.unwrap_or_else(|| scene.land(height_m.max(sea))), tone);
        let ground = if land >= 1.0 {
            dry()
        } else {
            let wet = self.glowing(lit_floor(scene.sea(height_m.min(sea)), tone * 0.5), halo());
            if land > 0.0 { mix(wet, dry(), land) } else { wet }
        };
        mix(ground, self.ink, 0.62 * (self.half_line_px - line_px).clamp(0.0, 1.0))
    }
}

/// A colour under light: shadows cool, light warm, as on painted maps.
#[inline(always)]
pub fn lit(colour: Rgb, tone: f32) -> Rgb {
    each(|c| lit_part(c, colour[c], tone))
}

/// One of a colour's parts, red, green or blue, under light.
#[inline(always)]
pub fn lit_part(c: usize, part: f32, tone: f32) -> f32 {
    const SHADOW: Rgb = [0.10, 0.12, 0.22];
    const WARM: Rgb = [1.0, 0.97, 0.88];
    if tone < 0.0 {
        part * (1.0 + tone * (1.0 - SHADOW[c]))
    } else {
        // More light on the same colour first, so that it keeps its strength; a little glare on top.
        let bright = part * (1.0 + 0.75 * tone * WARM[c]);
        bright + (WARM[c] - bright).max(0.0) * tone * 0.20
    }
}

/// A sea floor under light: all of it through water.
#[inline(always)]
fn lit_floor(colour: Rgb, tone: f32) -> Rgb {
    const DEEP: Rgb = [0.25, 0.30, 0.42];
    let gain = |c: usize| if tone < 0.0 { 1.0 + tone * (1.0 - DEEP[c]) } else { 1.0 + 0.8 * tone };
    each(|c| (colour[c] * gain(c)).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    fn scene(low: f32, high: f32, sea_m: f64) -> Scene {
        let mut field = Field::filled(Grid::new(2, 1, 2.0, Edges::Open), low);
        field.data[1] = high;
        Scene::new(&field, sea_m)
    }

    #[test]
    fn large_worlds_share_their_colours_and_small_ones_use_all() {
        let (alps, andes) = (scene(-200.0, 4800.0, 0.0), scene(-8000.0, 6500.0, 0.0));
        assert_eq!(alps.at(1000.0), andes.at(1000.0));
        let hill = scene(-20.0, 120.0, 0.0);
        let close = |a: Rgb, b: Rgb| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(close(hill.at(120.0), andes.at(4000.0)) && close(hill.at(-20.0), andes.at(-4500.0)));
        assert!(close(scene(1000.0, 1200.0, 0.0).at(1000.0), andes.at(0.1)));
        assert!(close(scene(90.0, 200.0, 100.0).at(99.0), andes.at(-450.0)));
    }

    #[test]
    fn sea_is_bluer_than_land_everywhere() {
        let scene = scene(-9000.0, 7000.0, 0.0);
        for m in 1..9000 {
            let [r, _, b] = scene.at(-m as f32);
            assert!(b > r * 1.2, "{m}");
        }
        for m in 1..5000 {
            let [r, g, b] = scene.at(m as f32);
            assert!(b < r.max(g) * 1.02, "{m}");
        }
    }
}
