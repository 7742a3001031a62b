//! Land broken by many straight faults: each raises one side of a random line and lowers the other.
//!
//! `h = base + Σ ±δ_i·S(dist_i/w)` with a smooth odd step `S`. Lines are uniform among those that meet the map (direction
//! and offset uniform, misses drawn again), so with sharp steps and equal `δ` the mean square difference of two points is
//! `8·n·δ²·d/P` for a distance `d` and the map's perimeter `P`: a Brownian surface, H = ½. Without random signs the map
//! would tilt. The mean over the map is taken off.
//!
//! A row needs work only where it crosses a fault: steps are stored as differences along the row and summed once.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::length_m;
use crate::{
    grid::{Field, Grid, for_each_row},
    noise::Key,
    process::{Context, ProcessError, Shape},
};

/// Blocks raised and lowered along straight faults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FaultParams {
    /// Height of a high block above the mean: two standard deviations.
    #[schemars(range(min = 0.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "higher blocks, deeper basins"))]
    pub height_m: f64,
    /// Mean height of the land.
    #[schemars(range(min = -12000.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "more land, less sea"))]
    pub base_m: f64,
    /// Number of faults.
    #[schemars(range(min = 1, max = 20000), extend("x-unit" = "1", "x-effect" = "more and lower steps"))]
    pub faults: u32,
    /// Width of a fault's slope; 1 % of the map's longer side if not given.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "km", "x-effect" = "gentler scarps"))]
    pub width_km: Option<f64>,
    /// How much smaller the last fault is than the first: 0 all alike, 1 down to nothing.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "few large faults among many small ones"))]
    pub decline: f64,
}

impl Default for FaultParams {
    fn default() -> Self {
        Self { height_m: 2000.0, base_m: 200.0, faults: 150, width_km: None, decline: 0.8 }
    }
}

/// A line as its unit normal and distance from the map's north-west corner, with the signed step across it.
struct Fault {
    normal: [f64; 2],
    offset_m: f64,
    delta_m: f64,
}

impl Shape for FaultParams {
    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let faults = self.faults(&grid, context.key.named("fault"));
        // A slope narrower than a cell is drawn as wide as one: the cell's mean over a sharp step.
        let half_width_m = 0.5 * length_m(self.width_km, 0.01, &grid).max(grid.cell_m);
        let level_m = self.base_m - mean_step(&faults, &grid);
        let mut heights = Field::filled(grid, 0.0);
        for_each_row(&mut heights.data, grid.width, |y, row| {
            let mut sum = vec![0.0; grid.width];
            sum[0] = level_m;
            let [x0, py] = grid.center_m(0, y);
            for fault in &faults {
                let first = (x0 * fault.normal[0] + py * fault.normal[1] - fault.offset_m) / half_width_m;
                add_step(&mut sum, fault.delta_m, first, grid.cell_m * fault.normal[0] / half_width_m);
            }
            let mut height = 0.0;
            for (h, change) in row.iter_mut().zip(&sum) {
                height += change;
                *h = height as f32;
            }
        });
        Ok(heights)
    }
}

impl FaultParams {
    fn faults(&self, grid: &Grid, key: Key) -> Vec<Fault> {
        let [w, h] = grid.extent_m();
        let n = self.faults as usize;
        let size = |i: usize| 1.0 - self.decline * i as f64 / (n.max(2) - 1) as f64;
        let squares: f64 = (0..n).map(|i| size(i) * size(i)).sum();
        let unit_m = if squares > 0.0 { 0.5 * self.height_m / squares.sqrt() } else { 0.0 };
        let radius = 0.5 * (w * w + h * h).sqrt();
        (0..n)
            .map(|i| {
                let mut stream = key.with(i as u64).stream();
                let (normal, offset) = loop {
                    let (sin, cos) = libm::sincos(stream.between(0.0, std::f64::consts::PI));
                    let offset = stream.between(-radius, radius);
                    if offset.abs() < 0.5 * (w * cos.abs() + h * sin) {
                        break ([cos, sin], offset);
                    }
                };
                let sign = if stream.unit() < 0.5 { -1.0 } else { 1.0 };
                let offset_m = offset + 0.5 * (w * normal[0] + h * normal[1]);
                Fault { normal, offset_m, delta_m: sign * size(i) * unit_m }
            })
            .collect()
    }
}

/// Mean of all steps over the map, from 32 x 32 places whatever the grid: a map that lies mostly to one side of its large
/// faults is not to stand high or low as a whole.
fn mean_step(faults: &[Fault], grid: &Grid) -> f64 {
    const SIDE: usize = 32;
    let [w, h] = grid.extent_m();
    let place = |i: usize| [(i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5];
    let sum: f64 = (0..SIDE * SIDE)
        .map(place)
        .flat_map(|[x, y]| {
            let at = [x / SIDE as f64 * w, y / SIDE as f64 * h];
            let side = move |f: &Fault| at[0] * f.normal[0] + at[1] * f.normal[1] - f.offset_m;
            faults.iter().map(move |f| if side(f) < 0.0 { -f.delta_m } else { f.delta_m })
        })
        .sum();
    sum / (SIDE * SIDE) as f64
}

/// Odd, smooth, −1 to 1 over −1 to 1.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(-1.0, 1.0);
    t * (1.5 - 0.5 * t * t)
}

/// Adds `delta·S(first + slope·x)` to a row kept as differences.
fn add_step(row: &mut [f64], delta: f64, first: f64, slope: f64) {
    let value = |x: usize| smooth_step(first + slope * x as f64);
    row[0] += delta * value(0);
    let (a, b) = ((-1.0 - first) / slope, (1.0 - first) / slope);
    // Where the row runs along the fault the bounds are infinite or not numbers, and the whole row is walked.
    let (low, high) = if slope.abs() > 1e-12 { (a.min(b), a.max(b)) } else { (0.0, row.len() as f64) };
    let from = (low.max(1.0)) as usize;
    let to = ((high.max(0.0)) as usize).saturating_add(2).min(row.len());
    if from < to {
        let mut before = value(from - 1);
        for (x, change) in row.iter_mut().enumerate().take(to).skip(from) {
            let here = value(x);
            *change += delta * (here - before);
            before = here;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_sum_to_the_step() {
        for (first, slope) in
            [(-30.0, 0.7), (12.3, -0.31), (0.2, 0.0), (5.0, 0.1), (-0.5, 1e-6), (-3.0, 9.0), (-700.0, 0.7)]
        {
            let mut row = vec![0.0; 64];
            add_step(&mut row, 5.0, first, slope);
            let mut sum = 0.0;
            for (x, change) in row.iter().enumerate() {
                sum += change;
                let want = 5.0 * smooth_step(first + slope * x as f64);
                assert!((sum - want).abs() < 1e-12, "{first} {slope} {x}: {sum} {want}");
            }
        }
    }
}
