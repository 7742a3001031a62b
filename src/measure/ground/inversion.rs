//! What happens upside down: rivers carve valleys that drain, and the same ground turned over is full of hollows, while
//! noise is the same either way up. A cheap mark of ground that no river made.
//!
//! Squares of land, routed over their rims as they are and with the sign of heights turned.

use super::super::{
    metric::Missing,
    streams::{Network, slope_area, slope_area_points},
};
use super::squares::{LEAST_SIDE, Square};
use crate::grid::{Edges, Field, Grid};

const MOST_SQUARES: usize = 4;

/// The ground as it is against the ground upside down.
#[derive(Clone, Debug)]
pub struct Inversion {
    /// (hollows upside down − hollows)/(both), each a share of the area that routing has to fill: 0 for noise, near 1
    /// where rivers drain every valley.
    pub fill: Option<f64>,
    /// Concavity as it is less concavity upside down.
    pub theta: Result<f64, Missing>,
}

/// Compares the two over squares of land.
pub fn inversion(height: &Field<f32>, sea_level_m: f64, squares: &[Square]) -> Result<Inversion, Missing> {
    let Some(side) = squares.first().map(|s| s.side) else { return Err(Missing::NoSquare { side: LEAST_SIDE }) };
    let grid = Grid::new(side, side, side as f64 * height.grid.cell_m, Edges::Open);
    let mut sides = [1.0f32, -1.0].map(|sign| (sign, 0usize, Vec::new()));
    for square in squares.iter().take(MOST_SQUARES) {
        let cut = Field::from_fn(grid, |x, y| (height.at(square.x + x, square.y + y) as f64).max(sea_level_m) as f32);
        for (sign, hollow, points) in &mut sides {
            let network = Network::of(&cut.map(|h| *sign * h), f64::MIN);
            *hollow += (0..grid.cells()).filter(|&i| network.is_flooded(i)).count();
            points.extend(slope_area_points(&network));
        }
    }
    let [(_, upright, up), (_, turned, down)] = sides;
    let both = (upright + turned) as f64;
    let fill = (both > 0.0).then(|| (turned as f64 - upright as f64) / both);
    let theta = slope_area(&up).and_then(|up| Ok(up.theta - slope_area(&down)?.theta));
    Ok(Inversion { fill, theta })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::ground::{shapes::fbm, squares};

    #[test]
    fn noise_is_the_same_upside_down_and_a_drained_ground_is_not() {
        let noise = fbm(256, 0.7, 5);
        let all = squares(&noise, -1e9);
        let found = inversion(&noise, -1e9, &all).unwrap();
        assert!(found.fill.unwrap().abs() < 0.25, "{found:?}");
        assert!(found.theta.unwrap().abs() < 0.1);
        // Its filled surface drains everywhere.
        let filled = Network::of(&noise, f64::MIN).surface_m;
        let drained = Field { grid: noise.grid, data: filled.iter().map(|&h| h as f32).collect() };
        let found = inversion(&drained, -1e9, &all).unwrap();
        assert!(found.fill.unwrap() > 0.999, "{found:?}");
        assert!(inversion(&noise, 1e9, &[]).is_err());
    }
}
