//! Light on the ground.
//!
//! Five lights of different strength, mainly from the north-west, as cartographers hold the lamp (Imhof 1965; several
//! directions after Mark 1992). The normal is that of a blend of the ground and of two smoother copies of it
//! (resolution bumping, Patterson), so that great ranges read as one body and crests still as crests. A term for how
//! high a place stands over its surroundings darkens valleys and lightens ridges, as a soft sky does. Slopes are
//! exaggerated until the land's typical slope is a good one to light, then bent so that plains show their form and the
//! steepest slopes keep detail.

use multiversion::multiversion;
use rayon::prelude::*;

use crate::grid::{Field, blur, for_each_row, sum_rows};

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
const SCALES: [(f64, f64); 3] = [(0.0, 0.70), (2.5, 0.50), (10.0, 0.60)];
/// Least blur of each, pixels: single cells are not terrain.
const LEAST_PX: [f64; 3] = [0.55, 1.4, 3.0];

/// How bright each pixel is: 0 as flat ground, −1 black shadow, 1 full light.
pub fn shade(z: &Field<f32>, counts: impl Fn(f32) -> bool + Sync, exaggeration: Option<f64>) -> Field<f32> {
    let width = z.grid.width;
    let mut form = blur(z, sigma_px(z, 0));
    let factor = exaggeration.unwrap_or_else(|| typical_exaggeration(&form, counts)) as f32;
    // What slopes are taken of: the copies by their shares, one after the other, so that only one of them takes room.
    let [share, smoother, smoothest] = SCALES.map(|(_, share)| share as f32);
    for_each_row(&mut form.data, width, |_, row| row.iter_mut().for_each(|form| *form *= share));
    let mut add = |copy: &Field<f32>, share: f32| {
        for_each_row(&mut form.data, width, |y, row| {
            row.iter_mut().zip(copy.row(y)).for_each(|(form, v)| *form += v * share);
        });
    };
    add(&blur(z, sigma_px(z, 1)), smoother);
    let around = blur(z, sigma_px(z, 2));
    add(&around, smoothest);
    let lamps = Lamps::new();
    // Height over the surroundings, in units of a slope of one across the blur.
    let over_per_m = factor / (sigma_px(z, 2) * z.grid.cell_m) as f32;
    let slope_per_m = (0.5 / z.grid.cell_m) as f32 * factor;
    let mut tones = around;
    let room = || [vec![0.0; width], vec![0.0; width]];
    tones.data.par_chunks_exact_mut(width).enumerate().for_each_init(room, |[across, down], (y, tones)| {
        for (tone, z) in tones.iter_mut().zip(z.row(y)) {
            *tone = (z - *tone) * over_per_m;
        }
        slopes(&form, y, slope_per_m, across, down);
        shine(&lamps, across, down, tones);
    });
    tones
}

/// Slopes of a row, times a factor: central differences, half at the rim.
fn slopes(form: &Field<f32>, y: usize, per_m: f32, across: &mut [f32], down: &mut [f32]) {
    let grid = &form.grid;
    let (here, last) = (form.row(y), grid.width - 1);
    if last > 1 {
        for ((slope, west), east) in across[1..last].iter_mut().zip(here).zip(&here[2..]) {
            *slope = (east - west) * per_m;
        }
    }
    for x in [0, last] {
        across[x] = (here[grid.column(x, 1)] - here[grid.column(x, -1)]) * per_m;
    }
    let (north, south) = (form.row(grid.row(y, -1)), form.row(grid.row(y, 1)));
    for ((slope, north), south) in down.iter_mut().zip(north).zip(south) {
        *slope = (south - north) * per_m;
    }
}

/// The lights, ready to shine.
struct Lamps {
    lights: [[f32; 3]; LIGHTS.len()],
    flat: f32,
}

impl Lamps {
    /// Directions times weights.
    fn new() -> Self {
        let lights = LIGHTS.map(|(azimuth, altitude, weight)| {
            let (a, h) = (f64::to_radians(azimuth), f64::to_radians(altitude));
            [libm::sin(a) * libm::cos(h), -libm::cos(a) * libm::cos(h), libm::sin(h)].map(|v| (v * weight) as f32)
        });
        Self { lights, flat: lights.iter().map(|l| l[2]).sum() }
    }

    /// How bright a place is, by its exaggerated slope and its height over the surroundings.
    #[inline(always)]
    fn tone(&self, [gx, gy]: [f32; 2], over: f32) -> f32 {
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
fn sigma_px(z: &Field<f32>, copy: usize) -> f64 {
    let side = z.grid.width.max(z.grid.height) as f64;
    (SCALES[copy].0 * side / 1000.0).max(LEAST_PX[copy])
}

/// How bright the places of a row are, by their exaggerated slopes; `tones` bring their heights over the surroundings.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn shine(lamps: &Lamps, across: &[f32], down: &[f32], tones: &mut [f32]) {
    for ((tone, &gx), &gy) in tones.iter_mut().zip(across).zip(down) {
        *tone = lamps.tone([gx, gy], *tone);
    }
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
fn typical_exaggeration(z: &Field<f32>, counts: impl Fn(f32) -> bool + Sync) -> f64 {
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

    fn cone(cell_m: f64) -> Field<f32> {
        let grid = Grid { width: 128, height: 128, cell_m, edges: Edges::Open };
        Field::from_fn(grid, |x, y| {
            let r = ((x as f64 - 63.5).powi(2) + (y as f64 - 63.5).powi(2)).sqrt();
            ((50.0 - r).max(0.0) * 10.0) as f32
        })
    }

    #[test]
    fn light_comes_from_the_north_west_and_flat_ground_is_neutral() {
        let tone = shade(&cone(100.0), |h| h > 0.0, None);
        assert!(tone.at(45, 45) > 0.3 && tone.at(82, 82) < -0.3, "{} {}", tone.at(45, 45), tone.at(82, 82));
        assert_eq!(tone.at(1, 1), 0.0);
    }

    #[test]
    fn a_hill_and_a_continent_of_the_same_form_look_the_same() {
        let [hill, continent] = [10.0, 1000.0].map(|cell_m| shade(&cone(cell_m), |h| h > 0.0, None));
        // A slope of 1 and one of 0.01: both within what is exaggerated, so equal but for rounding.
        let apart = hill.data.iter().zip(&continent.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-3, "{apart}");
    }
}
