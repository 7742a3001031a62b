//! Power spectra of the land, `k^(−β)`: along transects, and over the plane as the mean of all modes of one wave number.
//!
//! Squares of land with the sea as a level surface, a plane (a line along transects) taken out, Hann window. Welch's
//! average over squares, rows and columns. The fit runs from a fourth of the side to four cells, though not below 200 m,
//! where hillslopes end the scaling; in twelve classes of wave number a decade.

use rayon::prelude::*;

use super::super::{fit::Line, metric::Missing};
use super::{
    fft::{fft_rows, transpose},
    squares::{LEAST_SIDE, Square},
};
use crate::grid::Field;

/// Shortest wave of the fit, cells; below, the grid speaks.
const SHORTEST_CELLS: f64 = 4.0;
/// Shortest wave of the fit, m: the length of hillslopes (Perron et al. 2008).
const SHORTEST_M: f64 = 200.0;
/// Longest wave of the fit, in sides of a square; beyond, the window speaks.
const LONGEST_SIDE: f64 = 0.25;
const BINS_PER_DECADE: f64 = 12.0;
const LEAST_BINS: usize = 4;

/// One spectrum.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Exponent β.
    pub beta: f64,
    /// The law, in decimal logarithms of cycles per km and of power.
    pub line: Line,
    /// `[cycles per km; power]`: m²·km along transects, m²·km² per mode of the plane.
    pub points: Vec<[f64; 2]>,
    /// Wave numbers between which the law was fitted, cycles per km.
    pub fitted: [f64; 2],
}

/// The spectra of a ground.
#[derive(Clone, Debug)]
pub struct Spectra {
    /// Along rows and columns.
    pub transect: Spectrum,
    /// Of the plane.
    pub radial: Spectrum,
    /// Squares averaged over, and their side in cells.
    pub squares: (usize, usize),
}

/// The spectra over squares of land.
pub fn spectra(height: &Field<f32>, sea_level_m: f64, squares: &[Square]) -> Result<Spectra, Missing> {
    let Some(side) = squares.first().map(|s| s.side) else { return Err(Missing::NoSquare { side: LEAST_SIDE }) };
    let cell_km = height.grid.cell_m * 1e-3;
    let window = hann(side);
    // The window's mean square, which power is divided by.
    let share = window.iter().map(|w| w * w).sum::<f64>() / side as f64;
    let (mut along, mut over) = (vec![0.0; side / 2 + 1], vec![0.0; side / 2 + 1]);
    for square in squares {
        let mut ground = cut(height, sea_level_m, *square);
        add(&mut along, &transects(&ground, side, &window));
        transpose(&mut ground, side);
        add(&mut along, &transects(&ground, side, &window));
        add(&mut over, &radial(&ground, side, &window));
    }
    let n = squares.len() as f64;
    let along_scale = cell_km / (side as f64 * share * 2.0 * n);
    let over_scale = (cell_km / (side as f64 * share)).powi(2) / n;
    let fit = |power: &[f64], scale: f64| fitted(power, scale, side, height.grid.cell_m);
    Ok(Spectra { transect: fit(&along, along_scale)?, radial: fit(&over, over_scale)?, squares: (squares.len(), side) })
}

fn hann(side: usize) -> Vec<f64> {
    (0..side).map(|i| 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * (i as f64 + 0.5) / side as f64)).collect()
}

fn add(sum: &mut [f64], more: &[f64]) {
    sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
}

fn cut(height: &Field<f32>, sea_level_m: f64, square: Square) -> Vec<f64> {
    let rows = (square.y..square.y + square.side).map(|y| &height.row(y)[square.x..square.x + square.side]);
    rows.flat_map(|row| row.iter().map(|&h| (h as f64).max(sea_level_m))).collect()
}

/// Mean power by wave number of the rows.
fn transects(ground: &[f64], side: usize, window: &[f64]) -> Vec<f64> {
    let mut data: Vec<[f64; 2]> = ground
        .par_chunks_exact(side)
        .flat_map_iter(|row| {
            let (mean, slope) = trend(row);
            let middle = (side as f64 - 1.0) / 2.0;
            row.iter().enumerate().map(move |(x, h)| [(h - mean - slope * (x as f64 - middle)) * window[x], 0.0])
        })
        .collect();
    fft_rows(&mut data, side);
    let power = |k: usize| data.iter().skip(k).step_by(side).map(|[re, im]| re * re + im * im).sum::<f64>();
    (0..=side / 2).map(|k| power(k) / side as f64).collect()
}

/// Mean and slope per cell of a row.
fn trend(row: &[f64]) -> (f64, f64) {
    let n = row.len() as f64;
    let mean = row.iter().sum::<f64>() / n;
    let middle = (n - 1.0) / 2.0;
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, h) in row.iter().enumerate() {
        let dx = x as f64 - middle;
        (xx, xy) = (xx + dx * dx, xy + dx * (h - mean));
    }
    (mean, xy / xx)
}

/// Mean power of the modes of each whole wave number.
fn radial(ground: &[f64], side: usize, window: &[f64]) -> Vec<f64> {
    let columns: Vec<f64> = (0..side).map(|x| ground.iter().skip(x).step_by(side).sum::<f64>() / side as f64).collect();
    let rows: Vec<f64> = ground.chunks_exact(side).map(|row| row.iter().sum::<f64>() / side as f64).collect();
    // On a grid a plane's two slopes are those of the columns' and of the rows' means.
    let ((mean, east), (_, south)) = (trend(&columns), trend(&rows));
    let middle = (side as f64 - 1.0) / 2.0;
    let mut data: Vec<[f64; 2]> = (0..side * side)
        .map(|i| {
            let (x, y) = (i % side, i / side);
            let plane = mean + east * (x as f64 - middle) + south * (y as f64 - middle);
            [(ground[i] - plane) * window[x] * window[y], 0.0]
        })
        .collect();
    fft_rows(&mut data, side);
    transpose(&mut data, side);
    fft_rows(&mut data, side);
    let (mut power, mut count) = (vec![0.0; side / 2 + 1], vec![0usize; side / 2 + 1]);
    let wave = |i: usize| i.min(side - i) as f64;
    for (i, [re, im]) in data.iter().enumerate() {
        let k = (wave(i % side).powi(2) + wave(i / side).powi(2)).sqrt().round() as usize;
        if k <= side / 2 {
            power[k] += re * re + im * im;
            count[k] += 1;
        }
    }
    power.iter().zip(&count).map(|(p, &n)| p / n.max(1) as f64).collect()
}

fn fitted(power: &[f64], scale: f64, side: usize, cell_m: f64) -> Result<Spectrum, Missing> {
    let length_km = side as f64 * cell_m * 1e-3;
    let all = (1..power.len()).map(|k| [k as f64 / length_km, power[k] * scale]);
    let points: Vec<[f64; 2]> = all.filter(|p| p[1] > 0.0).collect();
    if points.is_empty() {
        return Err(Missing::Flat);
    }
    let shortest_km = (SHORTEST_CELLS * cell_m).max(SHORTEST_M) * 1e-3;
    let range = [1.0 / (LONGEST_SIDE * length_km), 1.0 / shortest_km];
    let inside = |p: &&[f64; 2]| p[0] >= range[0] * (1.0 - 1e-9) && p[0] <= range[1] * (1.0 + 1e-9);
    let class = |k: f64| (libm::log10(k / range[0]) * BINS_PER_DECADE + 1e-9).floor() as i64;
    let within: Vec<[f64; 2]> = points.iter().filter(inside).copied().collect();
    // Means of the logarithms, each class of wave numbers one voice.
    let bins: Vec<[f64; 2]> = within
        .chunk_by(|a, b| class(a[0]) == class(b[0]))
        .map(|bin| [0, 1].map(|axis| bin.iter().map(|p| libm::log10(p[axis])).sum::<f64>() / bin.len() as f64))
        .collect();
    let few = Missing::TooFew { what: "classes of wave number", found: bins.len(), needed: LEAST_BINS };
    if bins.len() < LEAST_BINS {
        return Err(few);
    }
    let line = Line::through(&bins).ok_or(few)?;
    Ok(Spectrum { beta: -line.slope, line, points, fitted: range })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::ground::{shapes::fbm, squares};

    /// Spectra of an inner square, so that the ground does not close on itself within the window.
    fn of(hurst: f64, seed: u64) -> Spectra {
        let field = fbm(512, hurst, seed);
        let inner = [Square { x: 100, y: 60, side: 256 }, Square { x: 10, y: 200, side: 256 }];
        spectra(&field, -1e9, &inner).unwrap()
    }

    #[test]
    fn brownian_ground_has_its_exponents() {
        for hurst in [0.5, 0.8] {
            let found: Vec<Spectra> = (1..=4).map(|seed| of(hurst, seed)).collect();
            let mean = |f: fn(&Spectra) -> f64| found.iter().map(f).sum::<f64>() / 4.0;
            let (radial, transect) = (mean(|s| s.radial.beta), mean(|s| s.transect.beta));
            assert!((radial - (2.0 * hurst + 2.0)).abs() < 0.1, "H {hurst}: radial {radial}");
            // Rows near the grain and near the window's side bend the sum over the plane's modes.
            assert!((transect - (2.0 * hurst + 1.0)).abs() < 0.1, "H {hurst}: transect {transect}");
        }
    }

    #[test]
    fn power_adds_up_to_the_variance() {
        let field = fbm(256, 0.8, 7);
        let square = Square { x: 0, y: 0, side: 256 };
        let found = spectra(&field, -1e9, &[square]).unwrap();
        // One-sided along transects: twice the sum over the positive wave numbers; a window on one ground: a third.
        let step = 1.0 / 256.0;
        let mut variance = 0.0;
        let ground = cut(&field, -1e9, square);
        for row in ground.chunks_exact(256) {
            let (mean, slope) = trend(row);
            variance +=
                row.iter().enumerate().map(|(x, h)| (h - mean - slope * (x as f64 - 127.5)).powi(2)).sum::<f64>()
                    / 65536.0;
        }
        let power = 2.0 * found.transect.points.iter().map(|p| p[1] * step).sum::<f64>();
        assert!((power / variance - 1.0).abs() < 0.35, "{power} {variance}");
    }

    #[test]
    fn level_ground_and_too_little_of_it() {
        let mut field = fbm(64, 0.5, 1);
        assert_eq!(spectra(&field, 1e9, &[]).unwrap_err(), Missing::NoSquare { side: 64 });
        field.data.fill(3.0);
        let squares = squares(&field, 0.0);
        assert_eq!(spectra(&field, 0.0, &squares).unwrap_err(), Missing::Flat);
    }
}
