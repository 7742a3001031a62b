//! Light on the ground.
//!
//! Five lights of different strength, mainly from the north-west, as cartographers hold the lamp (Imhof 1965; several
//! directions after Mark 1992). The normal is that of a blend of the ground and of two smoother copies of it
//! (resolution bumping, Patterson), so that great ranges read as one body and crests still as crests. A term for how
//! high a place stands over its surroundings darkens valleys and lightens ridges, as a soft sky does. Slopes are
//! exaggerated until the land's typical slope is a good one to light, then bent so that plains show their form and the
//! steepest slopes keep detail.

use super::frame::Frame;
use crate::grid::{Field, blur, sum_rows};

/// Compass azimuth and altitude in degrees, and weight.
const LIGHTS: [(f64, f64, f64); 5] =
    [(315.0, 42.0, 0.60), (275.0, 36.0, 0.15), (355.0, 36.0, 0.15), (225.0, 32.0, 0.05), (45.0, 32.0, 0.05)];
/// Root mean square of the exaggerated slope that is aimed at.
const TYPICAL: f64 = 0.80;
/// Slopes beyond this are bent towards it.
const STEEP: f32 = 1.5;
/// Gentle slopes count for more, as in a drawn map, where a plain has its own modelling: slope to the power 3/4, down
/// to this slope.
const LEVEL: f32 = 0.04;
/// Flat worlds stay flat: no more than this.
const MOST: f64 = 90.0;
/// Blur of the three copies, in thousandths of the picture's side, and their share in the slope.
pub const SCALES: [(f64, f64); 3] = [(0.0, 0.70), (2.5, 0.50), (10.0, 0.60)];
/// Least blur of each, pixels: single cells are not terrain.
const LEAST_PX: [f64; 3] = [0.55, 1.4, 3.0];

/// How bright each pixel is: 0 as flat ground, −1 black shadow, 1 full light.
pub fn shade(
    frame: &Frame,
    z: &Field<f32>,
    counts: impl Fn(f32) -> bool + Sync,
    exaggeration: Option<f64>,
) -> Field<f32> {
    let copies = [0, 1, 2].map(|i| blur(z, sigma_px(z, i)));
    let factor = exaggeration.unwrap_or_else(|| typical_exaggeration(&copies[0], counts)) as f32;
    let lamps = Lamps::new();
    // Height over the surroundings, in units of a slope of one across the blur.
    let per_m = factor / (sigma_px(z, 2) * frame.grid.cell_m) as f32;
    Field::from_fn(z.grid, |x, y| {
        let mut g = [0.0f32; 2];
        for (copy, (_, share)) in copies.iter().zip(SCALES) {
            let [gx, gy] = slope(copy, x, y);
            g = [g[0] + gx * share as f32, g[1] + gy * share as f32];
        }
        lamps.tone(g.map(|v| v * factor), (z.at(x, y) - copies[2].at(x, y)) * per_m)
    })
}

/// The lights, ready to shine.
pub struct Lamps {
    lights: [[f32; 3]; LIGHTS.len()],
    flat: f32,
}

impl Lamps {
    /// Directions times weights.
    pub fn new() -> Self {
        let lights = LIGHTS.map(|(azimuth, altitude, weight)| {
            let (a, h) = (f64::to_radians(azimuth), f64::to_radians(altitude));
            [libm::sin(a) * libm::cos(h), -libm::cos(a) * libm::cos(h), libm::sin(h)].map(|v| (v * weight) as f32)
        });
        Self { lights, flat: lights.iter().map(|l| l[2]).sum() }
    }

    /// How bright a place is, by its exaggerated slope and its height over the surroundings.
    #[inline(always)]
    pub fn tone(&self, [gx, gy]: [f32; 2], over: f32) -> f32 {
        let flat = self.flat;
        let bend = bend(gx * gx + gy * gy);
        let (gx, gy) = (gx * bend, gy * bend);
        let norm = 1.0 / (1.0 + gx * gx + gy * gy).sqrt();
        let lit: f32 = self.lights.iter().map(|l| ((l[2] - gx * l[0] - gy * l[1]) * norm).max(0.0)).sum();
        let tone = if lit > flat { (lit - flat) / (1.0 - flat) } else { (lit - flat) / flat };
        let sky = 0.16 * over / (1.0 + over * over).sqrt();
        (tone + sky).clamp(-1.0, 1.0)
    }
}

/// The exaggeration that `shade` would choose.
pub fn exaggeration(z: &Field<f32>, counts: impl Fn(f32) -> bool + Sync) -> f64 {
    typical_exaggeration(&blur(z, sigma_px(z, 0)), counts)
}

/// Blur of one of the copies.
pub fn sigma_px(z: &Field<f32>, copy: usize) -> f64 {
    let side = z.grid.width.max(z.grid.height) as f64;
    (SCALES[copy].0 * side / 1000.0).max(LEAST_PX[copy])
}

/// What a slope is multiplied with before it is lit, by its square.
#[inline(always)]
fn bend(squared: f32) -> f32 {
    let raised = 1.0 / (squared + LEVEL * LEVEL).sqrt().sqrt().sqrt();
    let steep = squared * raised * raised / (STEEP * STEEP);
    raised / (1.0 + steep).sqrt()
}

/// Central differences, half at the rim.
fn slope(z: &Field<f32>, x: usize, y: usize) -> [f32; 2] {
    let g = &z.grid;
    let per = (0.5 / g.cell_m) as f32;
    [(z.at(g.column(x, 1), y) - z.at(g.column(x, -1), y)) * per, (z.at(x, g.row(y, 1)) - z.at(x, g.row(y, -1))) * per]
}

/// The factor that gives the pixels that count a typical slope.
pub fn typical_exaggeration(z: &Field<f32>, counts: impl Fn(f32) -> bool + Sync) -> f64 {
    let counts = &counts;
    let rows = z.grid.height;
    let land = |y: usize| (0..z.grid.width).filter(move |&x| counts(z.at(x, y)));
    let count = sum_rows(rows, |y| land(y).count() as f64);
    let squares =
        sum_rows(rows, |y| land(y).map(|x| slope(z, x, y).map(f64::from)).map(|[gx, gy]| gx * gx + gy * gy).sum());
    let typical = if count > 0.0 { (squares / count).sqrt() } else { 0.0 };
    (TYPICAL / typical.max(TYPICAL / MOST)).max(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    fn cone(cell_m: f64) -> (Frame, Field<f32>) {
        let grid = Grid { width: 128, height: 128, cell_m, edges: Edges::Open };
        let frame = Frame::new(grid, 128, 0);
        let z = Field::from_fn(grid, |x, y| {
            let r = ((x as f64 - 63.5).powi(2) + (y as f64 - 63.5).powi(2)).sqrt();
            ((50.0 - r).max(0.0) * 10.0) as f32
        });
        (frame, z)
    }

    #[test]
    fn light_comes_from_the_north_west_and_flat_ground_is_neutral() {
        let (frame, z) = cone(100.0);
        let tone = shade(&frame, &z, |h| h > 0.0, None);
        assert!(tone.at(45, 45) > 0.3 && tone.at(82, 82) < -0.3, "{} {}", tone.at(45, 45), tone.at(82, 82));
        assert_eq!(tone.at(1, 1), 0.0);
    }

    #[test]
    fn a_hill_and_a_continent_of_the_same_form_look_the_same() {
        let [hill, continent] = [10.0, 1000.0].map(|cell_m| {
            let (frame, z) = cone(cell_m);
            shade(&frame, &z, |h| h > 0.0, None)
        });
        // A slope of 1 and one of 0.01: both within what is exaggerated, so equal but for rounding.
        let apart = hill.data.iter().zip(&continent.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-3, "{apart}");
    }
}
