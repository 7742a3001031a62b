//! Which part of the map the window shows. Cells on one side, points of the screen on the other; no painting.

/// Most points a cell is drawn wide.
const MOST_POINTS_PER_CELL: f64 = 64.0;
/// The map may shrink to this share of the window.
const LEAST_SHARE: f64 = 0.25;

/// A view of a map of `cells` in a window of `window` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    cells: [f64; 2],
    window: [f64; 2],
    /// The cell coordinate in the middle of the window.
    middle: [f64; 2],
    points_per_cell: f64,
    /// Follows the window's size until somebody zooms or moves.
    fitted: bool,
}

impl Camera {
    /// The whole map in a window that is not known yet.
    pub fn new(cells: [usize; 2]) -> Self {
        let cells = cells.map(|n| n.max(1) as f64);
        let mut camera = Self { cells, window: [1.0; 2], middle: [0.0; 2], points_per_cell: 1.0, fitted: true };
        camera.fit();
        camera
    }

    /// The whole map.
    pub fn fit(&mut self) {
        self.fitted = true;
        self.middle = self.cells.map(|n| n / 2.0);
        self.points_per_cell = self.fitting();
    }

    /// The window has this size now.
    pub fn resize(&mut self, window: [f64; 2]) {
        self.window = window.map(|v| v.max(1.0));
        if self.fitted { self.fit() } else { self.settle() }
    }

    /// Zooms by a factor; what is under the point of the window stays there.
    pub fn zoom(&mut self, factor: f64, at: [f64; 2]) {
        if !(factor.is_finite() && factor > 0.0) || factor == 1.0 {
            return;
        }
        let held = self.to_cells(at);
        self.fitted = false;
        self.points_per_cell *= factor;
        self.settle();
        self.middle = [0, 1].map(|i| held[i] - (at[i] - self.window[i] / 2.0) / self.points_per_cell);
        self.settle();
    }

    /// Moves the map by points of the window.
    pub fn drag(&mut self, by: [f64; 2]) {
        if by != [0.0; 2] {
            self.fitted = false;
            self.middle = [0, 1].map(|i| self.middle[i] - by[i] / self.points_per_cell);
            self.settle();
        }
    }

    /// The place on the map, in cells from the north-west corner, under a point of the window.
    pub fn to_cells(self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.middle[i] + (point[i] - self.window[i] / 2.0) / self.points_per_cell)
    }

    /// Where a place on the map lies in the window.
    pub fn to_window(self, cell: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.window[i] / 2.0 + (cell[i] - self.middle[i]) * self.points_per_cell)
    }

    /// The cell under a point of the window, if the map is there.
    pub fn cell(self, point: [f64; 2]) -> Option<[usize; 2]> {
        let at = self.to_cells(point);
        let inside = |i: usize| at[i] >= 0.0 && at[i] < self.cells[i];
        (inside(0) && inside(1)).then(|| at.map(|v| v as usize))
    }

    fn fitting(&self) -> f64 {
        (self.window[0] / self.cells[0]).min(self.window[1] / self.cells[1])
    }

    /// Keeps the zoom within its limits and the middle of the window on the map.
    fn settle(&mut self) {
        let fitting = self.fitting();
        let most = MOST_POINTS_PER_CELL.max(fitting);
        self.points_per_cell = self.points_per_cell.clamp(LEAST_SHARE * fitting, most);
        self.middle = [0, 1].map(|i| self.middle[i].clamp(0.0, self.cells[i]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let mut camera = Camera::new([200, 100]);
        camera.resize([800.0, 600.0]);
        camera
    }

    #[test]
    fn the_whole_map_fits_and_follows_the_window() {
        let mut camera = camera();
        assert_eq!(camera.points_per_cell, 4.0);
        assert_eq!(camera.to_window([0.0, 0.0]), [0.0, 100.0]);
        assert_eq!(camera.cell([799.0, 499.0]), Some([199, 99]));
        assert_eq!(camera.cell([799.0, 501.0]), None);
        camera.resize([400.0, 600.0]);
        assert_eq!(camera.points_per_cell, 2.0);
    }

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let mut camera = camera();
        for (factor, at) in [(3.0, [200.0, 300.0]), (0.5, [500.0, 250.0]), (1.7, [420.0, 310.0])] {
            let held = camera.to_cells(at);
            camera.zoom(factor, at);
            let now = camera.to_window(held);
            assert!((0..2).all(|i| (now[i] - at[i]).abs() < 1e-9), "{factor}: {now:?}");
        }
        let before = camera.to_cells([100.0, 100.0]);
        camera.drag([30.0, -20.0]);
        let now = camera.to_window(before);
        assert!((now[0] - 130.0).abs() < 1e-9 && (now[1] - 80.0).abs() < 1e-9);
        camera.fit();
        assert_eq!(camera, self::camera());
    }

    #[test]
    fn the_map_is_never_lost() {
        let mut camera = camera();
        for _ in 0..100 {
            camera.zoom(10.0, [0.0, 0.0]);
            camera.drag([1e6, 1e6]);
        }
        assert_eq!(camera.points_per_cell, MOST_POINTS_PER_CELL);
        assert!(camera.cell([401.0, 301.0]).is_some());
        for factor in [1e-30, 0.0, f64::NAN, f64::INFINITY, -1.0] {
            camera.zoom(factor, [9.0, 9.0]);
            assert!(camera.points_per_cell >= LEAST_SHARE * 4.0 && camera.middle.iter().all(|v| v.is_finite()));
        }
    }
}
