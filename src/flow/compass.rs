//! Moves over a raster by direction: a cell's way to its receiver is one byte.

use crate::grid::{Edges, Grid};

/// The eight steps to a neighbour, in the order that decides ties: north-west first, row by row.
pub const STEPS: [(isize, isize); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

/// Length of each of [`STEPS`], in cells.
pub const LENGTHS: [f64; 8] = {
    const D: f64 = std::f64::consts::SQRT_2;
    [D, 1.0, D, 1.0, 1.0, D, 1.0, D]
};

/// The way back.
pub const fn opposite(way: u8) -> u8 {
    7 - way
}

/// Moves over one raster.
#[derive(Clone, Copy, Debug)]
pub struct Compass {
    /// The raster.
    pub grid: Grid,
    offset: [isize; 8],
}

impl Compass {
    /// Moves over `grid`.
    pub fn new(grid: Grid) -> Self {
        Self { grid, offset: STEPS.map(|(dx, dy)| dy * grid.width as isize + dx) }
    }

    /// The cell one step on, which has to be on the map.
    #[inline]
    pub fn to(&self, i: usize, way: u8) -> usize {
        if self.grid.edges == Edges::Wrap {
            let ((x, y), (dx, dy)) = (self.grid.cell_of(i), STEPS[way as usize]);
            return self.grid.index(self.grid.column(x, dx), self.grid.row(y, dy));
        }
        i.wrapping_add_signed(self.offset[way as usize & 7])
    }

    /// Calls `f` with every neighbour on the map and the way to it; for loops that wait for nothing else.
    #[inline]
    pub fn each(&self, i: usize, mut f: impl FnMut(u8, usize)) {
        let (x, y) = self.grid.cell_of(i);
        if x > 0 && y > 0 && x + 1 < self.grid.width && y + 1 < self.grid.height {
            for way in 0..8u8 {
                f(way, i.wrapping_add_signed(self.offset[way as usize]));
            }
        } else {
            self.around(i).for_each(|(way, j)| f(way, j));
        }
    }

    /// The neighbours on the map, each with the way to it.
    pub fn around(&self, i: usize) -> impl Iterator<Item = (u8, usize)> + use<> {
        let (x, y) = self.grid.cell_of(i);
        let (compass, grid) = (*self, self.grid);
        let inside = x > 0 && y > 0 && x + 1 < grid.width && y + 1 < grid.height;
        (0..8u8).filter_map(move |way| {
            if inside {
                return Some((way, i.wrapping_add_signed(compass.offset[way as usize])));
            }
            let (dx, dy) = STEPS[way as usize];
            let (nx, ny) = match grid.edges {
                Edges::Wrap => (grid.column(x, dx), grid.row(y, dy)),
                _ => (
                    x.checked_add_signed(dx).filter(|&x| x < grid.width)?,
                    y.checked_add_signed(dy).filter(|&y| y < grid.height)?,
                ),
            };
            Some((way, grid.index(nx, ny))).filter(|&(_, j)| j != i)
        })
    }
}
