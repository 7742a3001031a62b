//! How wet ground stays: the topographic wetness index of Beven and Kirkby (1979), ln(a / tan β), with `a` the area that drains
//! through a metre of contour and β the slope. Water parts to all lower neighbours on the way, so that the picture has
//! no stripes in the directions of the raster.

use crate::{
    flow::{Compass, Drainage, FREEMAN, LENGTHS},
    grid::map_cells,
};

/// Slope that ground has at least.
const LEAST_SLOPE: f64 = 1e-3;

/// Ways (of [`crate::flow::STEPS`]) to a side and to a corner next to it: the eight triangles about a cell.
const FACETS: [(usize, usize); 8] = [(1, 0), (1, 2), (3, 0), (3, 5), (4, 2), (4, 7), (6, 5), (6, 7)];

/// The index of every cell, ln(m).
pub fn index(way: &Drainage) -> Vec<f64> {
    let (grid, surface) = (way.grid, &way.surface_m);
    let area_m2 = way.accumulate_parted(&vec![grid.cell_area_m2(); way.len()], FREEMAN);
    let compass = Compass::new(grid);
    let mut index = vec![0.0; way.len()];
    map_cells(&mut index, grid.width, |x, y| {
        let i = grid.index(x, y);
        // Beyond the rim ground goes on level.
        let mut drop = [0.0; 8];
        compass.each(i, |way, j| drop[way as usize] = (surface[i] - surface[j]) / grid.cell_m);
        let slope = steepest(drop);
        let per_metre = if slope > 0.0 { advance(drop, slope) / grid.cell_m } else { 1.0 / grid.cell_m };
        libm::log(area_m2[i] * per_metre / slope.max(LEAST_SLOPE))
    });
    index
}

/// How far down the slope water comes in one step to the neighbours it parts to, on the mean, in cells. Where it comes far it
/// stands in fewer cells: so much of a cell's water crosses a contour as long as a cell.
fn advance(drop: [f64; 8], slope: f64) -> f64 {
    let falling = drop.into_iter().zip(LENGTHS).filter(|&(drop, _)| drop > 0.0);
    let parted = falling.map(|(drop, length)| (libm::pow(drop / length, FREEMAN), drop));
    let (whole, fallen) =
        parted.fold((0.0, 0.0), |(whole, fallen), (share, drop)| (whole + share, fallen + share * drop));
    if whole > 0.0 { fallen / (whole * slope) } else { 1.0 }
}

/// The steepest fall over the eight triangles about a cell (Tarboton 1997), from the drops to its neighbours in cells.
fn steepest(drop: [f64; 8]) -> f64 {
    let fall = FACETS.map(|(side, corner)| {
        let (along, across) = (drop[side], drop[corner] - drop[side]);
        match across {
            ..=0.0 => along,
            _ if across >= along => drop[corner] * std::f64::consts::FRAC_1_SQRT_2,
            _ => libm::hypot(along, across),
        }
    });
    fall.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    #[test]
    fn a_cone_is_as_wet_as_its_radius_says() {
        let grid = Grid::new(101, 101, 1010.0, Edges::Open);
        let from_middle_m = |i: usize| {
            let (x, y) = grid.cell_of(i);
            10.0 * libm::hypot(x as f64 - 50.0, y as f64 - 50.0)
        };
        let slope = 0.2;
        let height: Vec<f64> = (0..grid.cells()).map(|i| 100.0 - slope * from_middle_m(i)).collect();
        let outlet: Vec<bool> = (0..grid.cells()).map(|i| from_middle_m(i) >= 480.0).collect();
        let index = index(&Drainage::of(grid, &height, &outlet));
        for ring_m in [150.0, 300.0, 450.0] {
            let ring: Vec<f64> =
                (0..index.len()).filter(|&i| (from_middle_m(i) - ring_m).abs() < 10.0).map(|i| index[i]).collect();
            // What drains through a metre of a circle is half its radius. A cell has its own water too: it is what drains half a
            // cell further out.
            let (mean, out_m) = (ring.iter().sum::<f64>() / ring.len() as f64, ring_m + 5.0);
            let want = libm::log(0.5 * out_m * out_m / ring_m / slope);
            assert!((mean - want).abs() < 0.015, "{ring_m}: {mean} {want}");
        }
    }

    #[test]
    fn planes_fall_as_steeply_as_they_do() {
        for degrees in (0..360).step_by(5) {
            let (sin, cos) = (degrees as f64).to_radians().sin_cos();
            let drop = crate::flow::STEPS.map(|(dx, dy)| 0.3 * (dx as f64 * cos + dy as f64 * sin));
            let slope = steepest(drop);
            assert!((slope - 0.3).abs() < 1e-12, "{degrees}: {slope}");
            // One cell along the raster; aslant, further to the corner and less far to the sides.
            let advance = advance(drop, slope);
            assert!(
                (0.93..1.01).contains(&advance) && (degrees % 90 != 0 || (advance - 1.0).abs() < 1e-12),
                "{advance}"
            );
        }
        assert_eq!(steepest([-1.0; 8]), 0.0);
    }
}
