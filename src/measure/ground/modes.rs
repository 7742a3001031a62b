//! The two modes of a planet's heights: continents near the sea's level, ocean floor some kilometres below.
//!
//! A histogram of all heights over the sea in classes of 250 m, smoothed over three, and its highest peaks above and below
//! −1.5 km; a peak counts if the heights between the two are rarer than half the lower one.

use super::super::metric::Missing;
use crate::grid::Field;

const CLASS_M: f64 = 250.0;
const LOWEST_M: f64 = -11_000.0;
const CLASSES: usize = 80;
/// Between continents and ocean floors.
const PARTING_M: f64 = -1500.0;
const DIP: f64 = 0.5;

/// Heights of the whole map.
#[derive(Clone, Debug)]
pub struct Modes {
    /// The continents' commonest height over the sea, m.
    pub continent_m: f64,
    /// The ocean floors'.
    pub ocean_m: f64,
    /// `[middle of a class, m over the sea; share of the map]`.
    pub histogram: Vec<[f64; 2]>,
}

/// Heights over the sea by class.
pub fn histogram(height: &Field<f32>, sea_level_m: f64) -> Vec<[f64; 2]> {
    let mut classes = vec![0usize; CLASSES];
    for &h in &height.data {
        let class = ((h as f64 - sea_level_m - LOWEST_M) / CLASS_M).floor();
        classes[class.clamp(0.0, CLASSES as f64 - 1.0) as usize] += 1;
    }
    let middle = |i: usize| LOWEST_M + (i as f64 + 0.5) * CLASS_M;
    let n = height.data.len().max(1) as f64;
    classes.iter().enumerate().map(|(i, &count)| [middle(i), count as f64 / n]).collect()
}

/// The two modes of a map.
pub fn modes(height: &Field<f32>, sea_level_m: f64) -> Result<Modes, Missing> {
    let histogram = histogram(height, sea_level_m);
    let share = |i: usize| histogram.get(i).map_or(0.0, |p| p[1]);
    let smooth: Vec<f64> = (0..CLASSES).map(|i| (share(i.wrapping_sub(1)) + share(i) + share(i + 1)) / 3.0).collect();
    let parting = ((PARTING_M - LOWEST_M) / CLASS_M) as usize;
    let peak = |range: std::ops::Range<usize>| range.max_by(|&a, &b| smooth[a].total_cmp(&smooth[b]).then(b.cmp(&a)));
    let (Some(ocean), Some(continent)) = (peak(0..parting), peak(parting..CLASSES)) else {
        return Err(Missing::OneMode);
    };
    let between = smooth[ocean..=continent].iter().copied().fold(f64::INFINITY, f64::min);
    if between >= DIP * smooth[ocean].min(smooth[continent]) {
        return Err(Missing::OneMode);
    }
    Ok(Modes { continent_m: histogram[continent][0], ocean_m: histogram[ocean][0], histogram })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn two_humps_are_found_and_one_is_not() {
        let grid = Grid::new(200, 100, 200.0, Edges::Open);
        // Three tenths at 0 to 800 m, the rest at −4.8 to −4 km, a slope between.
        let earth = Field::from_fn(grid, |x, y| match x {
            0..60 => y as f32 * 8.0 + 100.0,
            60..70 => 100.0 - (x - 60) as f32 * 410.0,
            _ => -4800.0 + y as f32 * 8.0 + 100.0,
        });
        let found = modes(&earth, 100.0).unwrap();
        assert!((0.0..800.0).contains(&found.continent_m) && (-4800.0..-4000.0).contains(&found.ocean_m), "{found:?}");
        assert!((found.histogram.iter().map(|p| p[1]).sum::<f64>() - 1.0).abs() < 1e-9);
        for one in [0.0f32, -4000.0] {
            let hump = Field::from_fn(grid, |x, y| one + (x + y) as f32 * 3.0);
            assert_eq!(modes(&hump, 0.0).unwrap_err(), Missing::OneMode);
        }
    }
}
