//! Land, flat tints, contours and high places.

use super::{
    Spot, View,
    shapes::{self, Line, Polygon},
};
use crate::{
    export::raster::{Lattice, Sampling, Window},
    grid::{Field, contour_lines, contour_rings},
    relief,
    world::World,
};

/// Contours that land should have.
const WANTED: f64 = 12.0;
/// Thinner than this a line is not drawn anyway, cells.
const THIN: f64 = 0.2;
/// Contours around less are left out, cells.
const LEAST_CELLS: f64 = 6.0;

/// The heights within the view.
pub struct Ground {
    height: Field<f32>,
    shift: [f64; 2],
    range_m: [f64; 2],
    cell_m: f64,
}

impl Ground {
    /// The heights of a world within the view.
    pub fn of(world: &World, height: &Field<f32>, view: &View) -> Self {
        let height = if view.whole() {
            height.clone()
        } else {
            let size_m = view.extent_m[0].max(view.extent_m[1]);
            let window = Window { x_m: view.corner_m[0], y_m: view.corner_m[1], size_m };
            let cells = ((size_m / world.grid.cell_m).round() as usize).max(2);
            Lattice::over(&world.grid, Some(window), cells, Sampling::Cells).read(height)
        };
        let range_m = height.range().map_or([0.0; 2], |(low, high)| [low as f64, high as f64]);
        Self { shift: view.corner_m, range_m, cell_m: height.grid.cell_m, height }
    }

    /// A round number of metres that gives the land, or where there is none the sea, as many contours as it should have.
    pub fn interval_m(&self, sea_m: f64) -> f64 {
        let [low, high] = self.range_m;
        let foot = if high > sea_m { low.max(sea_m) } else { low };
        let raw = (1.4 * (high - foot) / WANTED).max(1e-3);
        let ten = libm::pow(10.0, libm::floor(libm::log10(raw)));
        [5.0, 2.0, 1.0].into_iter().map(|step| step * ten).find(|&step| step <= raw).unwrap_or(ten)
    }

    fn moved(&self, line: Line) -> Line {
        line.into_iter().map(|[x, y]| [x + self.shift[0], y + self.shift[1]]).collect()
    }

    /// The areas above a height.
    pub fn above(&self, height_m: f64) -> Vec<Polygon> {
        // As for the world itself, ground at the level of the sea is land.
        let level = (height_m as f32).next_down();
        let rings = contour_rings(&self.height, level);
        shapes::polygons(rings.into_iter().map(|ring| self.moved(ring.points)).collect(), 0.0)
    }

    /// The same, thinned for colours.
    fn band(&self, height_m: f64) -> Vec<Polygon> {
        let thinned = |mut ring: Line| {
            ring.extend(ring.first().copied());
            let mut ring = shapes::thin(&ring, THIN * self.cell_m);
            ring.pop();
            self.moved(ring)
        };
        let rings = contour_rings(&self.height, height_m as f32).into_iter().map(|ring| thinned(ring.points));
        shapes::polygons(rings.filter(|ring| ring.len() > 2).collect(), LEAST_CELLS * self.cell_m * self.cell_m)
    }

    /// Multiples of the interval within the heights.
    fn levels(&self, interval_m: f64) -> impl Iterator<Item = f64> {
        let [low, high] = self.range_m;
        let first = libm::floor(low / interval_m) as i64 + 1;
        (first..).map(move |k| k as f64 * interval_m).take_while(move |&level| level < high)
    }

    /// Flat colours above each level; the land begins with the coast, which is not drawn here.
    pub fn tints(&self, world: &World, interval_m: f64) -> Vec<([u8; 3], Vec<Polygon>)> {
        let tint = relief::tints(world);
        let sea_m = world.sea_level_m;
        let [low, high] = self.range_m;
        let mut levels: Vec<f64> = self.levels(interval_m).filter(|&m| (m - sea_m).abs() > 0.1 * interval_m).collect();
        if low < sea_m && high > sea_m {
            levels.push(sea_m);
        }
        levels.sort_by(f64::total_cmp);
        let colour = |m: f64| relief::srgb(tint(m as f32));
        let next = |k: usize| levels.get(k + 1).copied().unwrap_or(high);
        levels
            .iter()
            .enumerate()
            .map(|(k, &m)| (colour(0.5 * (m + next(k))), if m == sea_m { self.above(m) } else { self.band(m) }))
            .collect()
    }

    /// The colour below the lowest tint.
    pub fn sea_tint(&self, world: &World) -> [u8; 3] {
        relief::srgb(relief::tints(world)(self.range_m[0] as f32))
    }

    /// Contours with their heights, from the lowest.
    pub fn contours(&self, interval_m: f64) -> Vec<(f64, Line)> {
        let least = LEAST_CELLS * self.cell_m * self.cell_m;
        let lines = |level: f64| {
            let drawn = contour_lines(&self.height, level as f32)
                .into_iter()
                .filter(move |line| !line.closed || line.area_m2().abs() > least);
            drawn.map(move |line| (level, shapes::thin(&shapes::line_of(line), THIN * self.cell_m)))
        };
        self.levels(interval_m).flat_map(lines).map(|(level, line)| (level, self.moved(line))).collect()
    }

    /// Summits: on land, none higher within a twelfth of the map around, the highest first.
    pub fn peaks(&self, sea_m: f64) -> Vec<Spot> {
        const MOST: usize = 24;
        let grid = self.height.grid;
        let height = |i: usize| self.height.data[i];
        let least = sea_m + 0.25 * (self.range_m[1] - sea_m);
        let higher = |i: usize, j: usize| height(j) > height(i) || height(j) == height(i) && j < i;
        let summit = |i: usize| {
            let (x, y) = grid.cell_of(i);
            let rows = y.saturating_sub(1)..=(y + 1).min(grid.height - 1);
            let columns = x.saturating_sub(1)..=(x + 1).min(grid.width - 1);
            rows.into_iter().all(|j| columns.clone().all(|k| !higher(i, grid.index(k, j))))
        };
        let mut summits: Vec<usize> =
            (0..grid.cells()).filter(|&i| height(i) as f64 > least.max(sea_m) && summit(i)).collect();
        summits.sort_by(|&a, &b| height(b).total_cmp(&height(a)).then(a.cmp(&b)));
        let reach_m = grid.extent_m()[0].max(grid.extent_m()[1]) / 12.0;
        let mut kept: Vec<Spot> = Vec::new();
        for i in summits {
            let (x, y) = grid.cell_of(i);
            let [cx, cy] = grid.center_m(x, y);
            let at_m = [cx + self.shift[0], cy + self.shift[1]];
            let far = |other: &Spot| libm::hypot(other.at_m[0] - at_m[0], other.at_m[1] - at_m[1]) > reach_m;
            if kept.len() < MOST && kept.iter().all(far) {
                kept.push(Spot { at_m, height_m: height(i) as f64 });
            }
        }
        kept
    }

    /// Vents, where the world has any.
    pub fn volcanoes(&self, world: &World) -> Vec<Spot> {
        let grid = self.height.grid;
        let [w, h] = grid.extent_m();
        world
            .vents()
            .into_iter()
            .map(|vent| vent.at_m)
            .filter_map(|at_m| {
                let local = [at_m[0] - self.shift[0], at_m[1] - self.shift[1]];
                let on = local[0] >= 0.0 && local[1] >= 0.0 && local[0] <= w && local[1] <= h;
                on.then(|| Spot { at_m, height_m: crate::grid::linear(&self.height, local) })
            })
            .collect()
    }
}
