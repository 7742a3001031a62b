//! How wet ground stays: the topographic wetness index of Beven and Kirkby (1979), ln(a / tan β), with `a` the area that drains
//! through a metre of contour and β the slope. Water parts to all lower neighbours on the way, so that the picture has
//! no stripes in the directions of the raster.

use crate::{
    flow::{Compass, Drainage, FREEMAN},
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
        let (slope, contour) = steepest(drop);
        libm::log(area_m2[i] / (contour * grid.cell_m) / slope.max(LEAST_SLOPE))
    });
    index
}

/// The steepest fall over the eight triangles about a cell (Tarboton 1997), from the drops to its neighbours in cells; and how
/// many cells of contour its water crosses: contours are made of cells that touch by sides or corners, so where
/// they run aslant there are fewer cells than metres.
fn steepest(drop: [f64; 8]) -> (f64, f64) {
    let fall = FACETS.map(|(side, corner)| {
        let (along, across) = (drop[side], drop[corner] - drop[side]);
        if across <= 0.0 {
            return (along, 1.0);
        }
        if across >= along {
            return (drop[corner] * std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::SQRT_2);
        }
        let slope = libm::hypot(along, across);
        (slope, slope / along)
    });
    fall.into_iter().fold((0.0, 1.0), |most, one| if one.0 > most.0 { one } else { most })
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
            // What drains through a metre of a circle is half its radius; a cell has its own water too, half a cell more.
            let (mean, want) = (ring.iter().sum::<f64>() / ring.len() as f64, libm::log(0.5 * (ring_m + 5.0) / slope));
            assert!((mean - want).abs() < 0.02, "{ring_m}: {mean} {want}");
        }
    }

    #[test]
    fn planes_fall_as_steeply_as_they_do() {
        for degrees in (0..360).step_by(5) {
            let (sin, cos) = (degrees as f64).to_radians().sin_cos();
            let drop = crate::flow::STEPS.map(|(dx, dy)| 0.3 * (dx as f64 * cos + dy as f64 * sin));
            let (slope, contour) = steepest(drop);
            assert!((slope - 0.3).abs() < 1e-12, "{degrees}: {slope}");
            assert!((contour * cos.abs().max(sin.abs()) - 1.0).abs() < 1e-12, "{degrees}: {contour}");
        }
        assert_eq!(steepest([-1.0; 8]).0, 0.0);
    }
}
