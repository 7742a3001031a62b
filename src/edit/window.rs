//! Bringing layers to a window at a finer scale, and the ground's detail below the old cells.
//!
//! Quantities go by a cubic through the old cells, held within the four around where they have bounds; names and what was
//! routed along cells go by the nearest. To the ground noise is added that continues the old map's own roughness: its
//! exponent and height are measured from second differences at two and four cells. What noise and cubic change in the mean of
//! an old cell is taken out again, so that the window matches its map.

use std::f64::consts::PI;

use crate::{
    grid::{Edges, Field, Grid, Places, cubic, resample_at},
    noise::{Fbm, Key},
    world::{Kind, Layer},
};

/// Rounds in which the means of old cells are brought back; of a wave of two cells along one axis each leaves 3/8, by the
/// mean of the cubic over a cell.
const ROUNDS: usize = 6;
/// Half width of the square over which roughness is averaged, old cells.
const AROUND: usize = 3;
/// Exponents of natural ground; past them the estimates of height have no meaning.
const HURST: [f64; 2] = [0.6, 0.95];
/// Distance of differences, old cells: at one cell maps are smoother than the land they show.
const LAG: isize = 2;
/// What is known along the old cells alone: between them a mean of two would be neither.
const ROUTED: [Layer; 4] = [Layer::Discharge, Layer::RiverWidth, Layer::RiverDepth, Layer::StreamOrder];

/// A part of a map and its new raster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Its north-west corner on the old map, m.
    pub corner_m: [f64; 2],
    /// The new raster.
    pub grid: Grid,
}

impl Window {
    /// Centre of a new cell on the old map, m.
    pub fn at_m(&self, x: usize, y: usize) -> [f64; 2] {
        let [own_x, own_y] = self.grid.center_m(x, y);
        [self.corner_m[0] + own_x, self.corner_m[1] + own_y]
    }

    /// The old cell in which a new cell's centre lies.
    fn old_cell(&self, old: &Grid, x: usize, y: usize) -> (usize, usize) {
        let [x_m, y_m] = self.at_m(x, y);
        let cell = |m: f64, count: usize| ((m / old.cell_m).floor().max(0.0) as usize).min(count - 1);
        (cell(x_m, old.width), cell(y_m, old.height))
    }

    fn smooth(&self, field: &Field<f32>) -> Field<f32> {
        let old = field.grid;
        let step = self.grid.cell_m / old.cell_m;
        let places = |axis: usize, count: usize| Places {
            first: self.corner_m[axis] / old.cell_m + 0.5 * step - 0.5,
            step,
            count,
        };
        let data = resample_at(field, places(0, self.grid.width), places(1, self.grid.height));
        Field { grid: self.grid, data }
    }
}

/// A layer over the window.
pub(super) fn layer(layer: Layer, field: &Field<f32>, window: &Window) -> Field<f32> {
    let old = field.grid;
    if layer.spec().kind != Kind::Continuous || ROUTED.contains(&layer) {
        return Field::from_fn(window.grid, |x, y| {
            let (i, j) = window.old_cell(&old, x, y);
            field.at(i, j)
        });
    }
    let smooth = window.smooth(field);
    Field::from_fn(window.grid, |x, y| {
        let [x_m, y_m] = window.at_m(x, y);
        let side = |m: f64| (m / old.cell_m - 0.5).floor() as isize;
        let near = |i: isize, step: isize, count: usize| match old.edges {
            Edges::Wrap => (i + step).rem_euclid(count as isize) as usize,
            _ => (i + step).clamp(0, count as isize - 1) as usize,
        };
        let [x0, x1] = [0, 1].map(|step| near(side(x_m), step, old.width));
        let [y0, y1] = [0, 1].map(|step| near(side(y_m), step, old.height));
        let around = [field.at(x0, y0), field.at(x1, y0), field.at(x0, y1), field.at(x1, y1)];
        let (low, high) = around.iter().fold((f32::MAX, f32::MIN), |(low, high), &v| (low.min(v), high.max(v)));
        smooth.at(x, y).clamp(low, high)
    })
}

/// The roughness to be added.
pub(super) struct Detail {
    /// In proportion to what is expected.
    pub share: f64,
    /// Root of its random numbers.
    pub key: Key,
    /// The window's north-west corner on the first map of all, m: noise keeps its place when the window moves.
    pub at_first_m: [f64; 2],
}

/// The ground over the window, m.
pub(super) fn height(old: &Field<f32>, window: &Window, detail: &Detail) -> Field<f32> {
    let mut ground = window.smooth(old);
    // An old cell of fewer new ones than two by two has no mean to speak of.
    if old.grid.cell_m < 2.0 * window.grid.cell_m * (1.0 - 1e-9) {
        return ground;
    }
    let part = Part::of(&old.grid, window);
    if detail.share > 0.0 {
        add_detail(&mut ground, old, (window, &part), detail);
    }
    for _ in 0..ROUNDS {
        let missing = missing(&ground, old, window, &part);
        crate::grid::for_each_row(&mut ground.data, window.grid.width, |y, row| {
            for (x, z) in row.iter_mut().enumerate() {
                *z += cubic(&missing, part.place(window.at_m(x, y))) as f32;
            }
        });
    }
    ground
}

/// The old cells that the window touches, as a raster of their own.
struct Part {
    west: usize,
    north: usize,
    grid: Grid,
}

impl Part {
    fn of(old: &Grid, window: &Window) -> Self {
        let (west, north) = window.old_cell(old, 0, 0);
        let (east, south) = window.old_cell(old, window.grid.width - 1, window.grid.height - 1);
        let grid = Grid { width: east - west + 1, height: south - north + 1, cell_m: old.cell_m, edges: Edges::Closed };
        Self { west, north, grid }
    }

    /// A place of the old map in this raster, m.
    fn place(&self, at_m: [f64; 2]) -> [f64; 2] {
        [at_m[0] - self.west as f64 * self.grid.cell_m, at_m[1] - self.north as f64 * self.grid.cell_m]
    }
}

/// What the new cells' mean lacks of each old cell's height; 0 where the window holds less than all of it.
fn missing(ground: &Field<f32>, old: &Field<f32>, window: &Window, part: &Part) -> Field<f32> {
    let mut sums = vec![(0.0f64, 0.0f64); part.grid.cells()];
    for y in 0..window.grid.height {
        for (x, &z) in ground.row(y).iter().enumerate() {
            let (i, j) = window.old_cell(&old.grid, x, y);
            let sum = &mut sums[part.grid.index(i - part.west, j - part.north)];
            *sum = (sum.0 + z as f64, sum.1 + 1.0);
        }
    }
    // Half a row and column of centres may miss on each side of a whole cell.
    let whole = (old.grid.cell_m / window.grid.cell_m - 1.0).max(0.0).powi(2).max(1.0);
    Field::from_fn(part.grid, |x, y| {
        let (sum, count) = sums[part.grid.index(x, y)];
        if count < whole { 0.0 } else { (old.at(x + part.west, y + part.north) as f64 - sum / count) as f32 }
    })
}

fn add_detail(ground: &mut Field<f32>, old: &Field<f32>, (window, part): (&Window, &Part), detail: &Detail) {
    let bends = [LAG, 2 * LAG].map(|step| bends(old, part, step));
    let mean = |field: &Field<f32>| crate::grid::sum_f64(&field.data) / field.data.len() as f64;
    let hurst = hurst(mean(&bends[0]), mean(&bends[1]));
    let scale = detail.share * below_two_cells(hurst).sqrt();
    let rough = averaged(&bends[0]).map(|bend| ((bend as f64).max(0.0).sqrt() * scale) as f32);
    // The lattice of a gradient noise is about two thirds of the wave that is strongest in it.
    let fbm = Fbm::new(old.grid.cell_m, hurst).octaves(detail.key, window.grid.cell_m);
    crate::grid::for_each_row(&mut ground.data, window.grid.width, |y, row| {
        let mut noise = fbm.sampler();
        for (x, z) in row.iter_mut().enumerate() {
            let [own_x, own_y] = window.grid.center_m(x, y);
            let at_first_m = [detail.at_first_m[0] + own_x, detail.at_first_m[1] + own_y];
            let rough_m = crate::grid::linear(&rough, part.place(window.at_m(x, y)));
            *z += (rough_m * noise.value(at_first_m)) as f32;
        }
    });
}

/// Squares of the second differences over `step` cells at each old cell, mean of both axes, m².
fn bends(old: &Field<f32>, part: &Part, step: isize) -> Field<f32> {
    Field::from_fn(part.grid, |x, y| {
        let (x, y) = (x + part.west, y + part.north);
        let z = |i: usize, j: usize| old.at(i, j) as f64;
        let (w, e, n, s) =
            (old.grid.column(x, -step), old.grid.column(x, step), old.grid.row(y, -step), old.grid.row(y, step));
        let (across, along) = (z(w, y) - 2.0 * z(x, y) + z(e, y), z(x, n) - 2.0 * z(x, y) + z(x, s));
        (0.5 * (across * across + along * along)) as f32
    })
}

/// Means over the squares about each cell.
fn averaged(field: &Field<f32>) -> Field<f32> {
    let (w, h) = (field.grid.width, field.grid.height);
    Field::from_fn(field.grid, |x, y| {
        let (mut sum, mut count) = (0.0f64, 0.0f64);
        for j in y.saturating_sub(AROUND)..=(y + AROUND).min(h - 1) {
            for v in &field.row(j)[x.saturating_sub(AROUND)..=(x + AROUND).min(w - 1)] {
                (sum, count) = (sum + *v as f64, count + 1.0);
            }
        }
        (sum / count) as f32
    })
}

/// Hurst exponent from mean squares of second differences over one and two lags, which are as 1 to 4^H.
fn hurst(one_m2: f64, two_m2: f64) -> f64 {
    let [low, high] = HURST;
    if one_m2 <= 0.0 || two_m2 <= 0.0 {
        return high;
    }
    (0.5 * libm::log2(two_m2 / one_m2)).clamp(low, high)
}

/// Variance of fractional Brownian ground in waves shorter than two cells, over its mean square second difference over `LAG`.
///
/// First differences over a length `l` have the variance `D·l^2H`, second ones `(4 - 4^H)` times that. With the spectrum
/// `C·k^-(2H+2)` of the surface that belongs to `D`, waves shorter than two cells keep `D·π^(-2H) / (4·H·I)`,
/// `I = Γ(1-H) / (2^(2H+1)·H·Γ(1+H))`.
fn below_two_cells(hurst: f64) -> f64 {
    let double = 2.0 * hurst;
    let integral = libm::tgamma(1.0 - hurst) / (libm::pow(2.0, double + 1.0) * hurst * libm::tgamma(1.0 + hurst));
    let short = libm::pow(PI, -double) / (2.0 * double * integral);
    short / ((4.0 - libm::pow(4.0, hurst)) * libm::pow(LAG as f64, double))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rough(cells: usize, extent_m: f64, hurst: f64) -> Field<f32> {
        let grid = Grid::new(cells, cells, extent_m, Edges::Open);
        let fbm = Fbm::new(extent_m / 3.0, hurst).octaves(Key::new(7), grid.cell_m);
        Field::from_fn(grid, |x, y| (1000.0 * fbm.value(grid.center_m(x, y))) as f32)
    }

    fn window(cells: usize) -> Window {
        Window { corner_m: [21.3e3, 17.7e3], grid: Grid::new(cells, cells, 30e3, Edges::Open) }
    }

    fn detail(share: f64) -> Detail {
        Detail { share, key: Key::new(3), at_first_m: [21.3e3, 17.7e3] }
    }

    #[test]
    fn means_of_old_cells_stay() {
        let old = rough(100, 100e3, 0.7);
        for cells in [60, 100, 411] {
            let (window, part) = (window(cells), Part::of(&old.grid, &window(cells)));
            let fine = height(&old, &window, &detail(1.0));
            let left = missing(&fine, &old, &window, &part);
            let most = left.data.iter().fold(0.0f32, |most, v| most.max(v.abs()));
            // Of a standard deviation of 1000 m; most is left where an old cell lies only partly within.
            assert!(most < 15.0, "{cells}: {most}");
        }
    }

    #[test]
    fn detail_continues_the_roughness_of_the_map() {
        // The same ground at 1 km and at 125 m: what the finer one has below the coarser one's cells is known.
        let (old, fine) = (rough(100, 100e3, 0.7), rough(800, 100e3, 0.7));
        let grid = Grid::new(400, 400, 50e3, Edges::Open);
        let window = Window { corner_m: [25e3, 25e3], grid };
        let made = height(&old, &window, &detail(1.0));
        let bend = |z: &dyn Fn(usize, usize) -> f32| {
            let mut sum = 0.0;
            for y in 1..399 {
                for x in 1..399 {
                    sum += (z(x - 1, y) - 2.0 * z(x, y) + z(x + 1, y)).powi(2) as f64;
                }
            }
            (sum / (398.0 * 398.0)).sqrt()
        };
        let [own, true_one] = [bend(&|x, y| made.at(x, y)), bend(&|x, y| fine.at(x + 200, y + 200))];
        // The coarse one lacks what fades towards its cells, so less is expected of it than there is: a half to a fifth.
        assert!((0.2..1.0).contains(&(own / true_one)), "{own} {true_one}");
        let smooth = height(&old, &window, &detail(0.0));
        assert!(bend(&|x, y| smooth.at(x, y)) < 0.5 * own);
    }

    #[test]
    fn bounded_layers_keep_their_bounds_and_names_stay_names() {
        let grid = Grid::new(40, 40, 40e3, Edges::Open);
        let step = Field::from_fn(grid, |x, _| f32::from(x % 4 < 2));
        let window = Window { corner_m: [10e3, 10e3], grid: Grid::new(64, 64, 8e3, Edges::Open) };
        let share = layer(Layer::CrustKind, &step, &window);
        assert!(share.data.iter().all(|v| (0.0..=1.0).contains(v)) && share.data.iter().any(|v| v.fract() > 0.0));
        let names = layer(Layer::PlateId, &step, &window);
        assert!(names.data.iter().all(|v| v.fract() == 0.0));
    }

    #[test]
    fn exponents_are_found() {
        for hurst_true in [0.65, 0.8] {
            let old = rough(400, 400e3, hurst_true);
            let part = Part::of(&old.grid, &Window { corner_m: [0.0; 2], grid: old.grid });
            let mean = |step| crate::grid::sum_f64(&bends(&old, &part, step).data) / old.data.len() as f64;
            let found = hurst(mean(6), mean(12));
            // Octaves fade towards the cells; six of them away a tenth of the exponent is left of that.
            assert!((found - hurst_true).abs() < 0.1, "{hurst_true}: {found}");
        }
    }
}
