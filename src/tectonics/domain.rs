//! The square the plates live in, wider than the map, and its three scales: metres, tectonic cells, engine units.

use glam::DVec2;

use crate::grid::{Edges, Grid};

/// Side of the square in engine units. rapier is tuned for bodies of about this size.
pub const SIDE_UNITS: f64 = 40.0;

/// The square of plates. Positions are in map metres: the map's north-west corner is the origin, y to the south.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Side of the square, m.
    pub side_m: f64,
    /// North-west corner of the square, m (negative: outside the map).
    pub corner_m: DVec2,
    /// Tectonic cells a side.
    pub cells: usize,
    /// Extent of the map, m.
    pub map_m: DVec2,
}

impl Domain {
    /// A square `margin` times as wide as the longer side of the map, centred on it, of `cells` x `cells`.
    pub fn around(map: &Grid, margin: f64, cells: usize) -> Self {
        let map_m = DVec2::from(map.extent_m());
        let side_m = map_m.max_element() * margin;
        Self { side_m, corner_m: (map_m - DVec2::splat(side_m)) / 2.0, cells, map_m }
    }

    /// Side of a tectonic cell, m.
    pub fn cell_m(&self) -> f64 {
        self.side_m / self.cells as f64
    }

    /// Centre of the square, m.
    pub fn center_m(&self) -> DVec2 {
        self.corner_m + DVec2::splat(self.side_m / 2.0)
    }

    /// Metres in one engine unit.
    pub fn unit_m(&self) -> f64 {
        self.side_m / SIDE_UNITS
    }

    /// Map metres to engine coordinates (origin at the square's centre).
    pub fn to_engine(self, at_m: DVec2) -> DVec2 {
        (at_m - self.center_m()) / self.unit_m()
    }

    /// Engine coordinates to map metres.
    pub fn to_map(self, at: DVec2) -> DVec2 {
        at * self.unit_m() + self.center_m()
    }

    /// Map metres to tectonic cell units.
    pub fn to_cells(self, at_m: DVec2) -> DVec2 {
        (at_m - self.corner_m) / self.cell_m()
    }

    /// Map metres to metres from the square's corner, as its grid counts them.
    pub fn in_square(&self, at_m: DVec2) -> [f64; 2] {
        (at_m - self.corner_m).into()
    }

    /// Centre of a tectonic cell in map metres.
    pub fn cell_center_m(&self, x: usize, y: usize) -> DVec2 {
        self.corner_m + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * self.cell_m()
    }

    /// The raster of tectonic cells as a grid of its own (origin at the square's corner).
    pub fn grid(&self) -> Grid {
        Grid::new(self.cells, self.cells, self.side_m, Edges::Closed)
    }

    /// The corners of the square, engine units, in the order rapier wants.
    pub fn square_engine(&self) -> Vec<DVec2> {
        let h = SIDE_UNITS / 2.0;
        vec![DVec2::new(-h, -h), DVec2::new(h, -h), DVec2::new(h, h), DVec2::new(-h, h)]
    }

    /// Whether a point in map metres lies on the map.
    pub fn on_map(&self, at_m: DVec2) -> bool {
        at_m.x >= 0.0 && at_m.y >= 0.0 && at_m.x <= self.map_m.x && at_m.y <= self.map_m.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_agree() {
        let map = Grid::new(200, 100, 1_000e3, Edges::Open);
        let domain = Domain::around(&map, 1.5, 600);
        assert_eq!(domain.side_m, 1_500e3);
        assert_eq!(domain.corner_m, DVec2::new(-250e3, -500e3));
        let p = DVec2::new(123e3, 45e3);
        assert!((domain.to_map(domain.to_engine(p)) - p).length() < 1e-6);
        let (x, y) = (37, 410);
        assert!((domain.to_cells(domain.cell_center_m(x, y)) - DVec2::new(37.5, 410.5)).length() < 1e-9);
        assert!(domain.on_map(p) && !domain.on_map(domain.corner_m));
    }
}
