//! How wet ground stays: the topographic wetness index of Beven and Kirkby (1979), ln(a / tan β), with `a` the area that drains
//! through a metre of contour and β the slope. Water parts to all lower neighbours on the way, so that the picture has
//! no stripes in the directions of the raster.

use crate::{
    flow::{Compass, Drainage, FREEMAN, LENGTHS},
    grid::map_cells,
};

/// Slope that ground has at least.
const LEAST_SLOPE: f64 = 1e-3;

/// The index of every cell, ln(m).
pub fn index(way: &Drainage) -> Vec<f64> {
    let (grid, surface) = (way.grid, &way.surface_m);
    let area_m2 = way.accumulate_parted(&vec![grid.cell_area_m2(); way.len()], FREEMAN);
    let compass = Compass::new(grid);
    let mut index = vec![0.0; way.len()];
    map_cells(&mut index, grid.width, |x, y| {
        let i = grid.index(x, y);
        let fall = |(step, j): (u8, usize)| (surface[i] - surface[j]) / (LENGTHS[step as usize] * grid.cell_m);
        let slope = compass.around(i).map(fall).fold(LEAST_SLOPE, f64::max);
        libm::log(area_m2[i] / grid.cell_m / slope)
    });
    index
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
            // What drains through a metre of a circle is half its radius. A ring of cells that touch by sides or corners has
            // π·√2/4 times fewer than metres, 0.105 in the logarithm; a cell's own half adds 0.03 at 15 cells; and the
            // steepest of eight ways is up to 7.6 % gentler than the cone.
            let (mean, want) = (ring.iter().sum::<f64>() / ring.len() as f64, libm::log(0.5 * ring_m / slope));
            assert!((0.0..0.18).contains(&(mean - want)), "{ring_m}: {mean} {want}");
        }
    }
}
