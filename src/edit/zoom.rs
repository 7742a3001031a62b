//! The stage `zoom`: cuts a window out of the world and goes on with it at a finer scale.
//!
//! The world becomes its window: another grid, all layers brought to it, tables moved along. What the rest of the map did
//! for the window comes with it as layers (uplift, rain, crust) and as the table `inflows`. Rock outside leaves the books.
//! Where the window lies in the first map stands in the table `windows`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    inflow::{self, Routed},
    tables,
    window::{self, Window},
};
use crate::{
    grid::{Edges, Field, Grid, sum_f64},
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, Matter, Table, World},
};

/// The table of all windows the world was cut to.
const WINDOWS: &str = "windows";
/// Least cells of the old map along a window's side: below, there is nothing to be refined.
const LEAST_OLD_CELLS: f64 = 4.0;
/// Least cells of the new map along its shorter side; no map is smaller.
const LEAST_CELLS: usize = 16;
/// Finest cells, m.
const FINEST_M: f64 = 0.01;
/// Rounding of windows that end on the map's rim, as a share of the map.
const SLACK: f64 = 1e-9;

/// A part of the map at a finer scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ZoomParams {
    /// The window: [west edge, north edge, size], or [west edge, north edge, width, height]; found by `around` if not given.
    #[schemars(length(min = 3, max = 4), inner(range(min = 0.0, max = 100000.0)), extend("x-unit" = "km", "x-effect" = "another part of the map"))]
    pub window_km: Option<Vec<f64>>,
    /// What the window is laid about where `window_km` is not given.
    #[schemars(extend("x-effect" = "middle: of the map; summit: the highest point; river: the largest river, half way to its mouth"))]
    pub around: Around,
    /// Side of the window where `window_km` is not given; a quarter of the map's shorter side if not given either.
    #[schemars(range(min = 0.001, max = 100000.0), extend("x-unit" = "km", "x-effect" = "a larger window with larger cells"))]
    pub size_km: Option<f64>,
    /// Cells along the window's longer side; as many as the map's longer side had if not given.
    #[schemars(range(min = 16, max = 16384), extend("x-unit" = "cells", "x-effect" = "smaller cells"))]
    pub size: Option<u32>,
    /// Roughness added below the old cells, in proportion to what the map's own roughness promises there.
    #[schemars(range(min = 0.0, max = 4.0), extend("x-unit" = "1", "x-effect" = "rougher ground between the old cells; 0 leaves it smooth"))]
    pub detail: f64,
}

/// What a window is laid about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Around {
    /// The middle of the map.
    #[default]
    Middle,
    /// The highest point.
    Summit,
    /// The largest river, half way along its course.
    River,
}

impl Default for ZoomParams {
    fn default() -> Self {
        Self { window_km: None, around: Around::Middle, size_km: None, size: None, detail: 1.0 }
    }
}

impl ZoomParams {
    /// The stage as a process.
    pub fn process(self, placement: Placement) -> Result<Box<dyn Process>, ProcessError> {
        if placement.mask.is_some() {
            return Err(ProcessError::Unfit("a zoom takes no 'mask': the window is all there will be".into()));
        }
        Ok(Box::new(Zoom { params: self }))
    }

    /// Width and height of the window, m.
    fn sides_m(&self, grid: &Grid) -> [f64; 2] {
        match self.window_km.as_deref() {
            Some([_, _, size]) => [size * 1e3; 2],
            Some([_, _, width, height]) => [width * 1e3, height * 1e3],
            _ => {
                let [width, height] = grid.extent_m();
                [self.size_km.map_or(0.25 * width.min(height), |km| km * 1e3); 2]
            }
        }
    }

    /// Cells of the window, and their side.
    fn raster(&self, grid: &Grid) -> Grid {
        let sides_m = self.sides_m(grid);
        let longer = self.size.map_or(grid.width.max(grid.height), |size| size as usize);
        let cell_m = sides_m[0].max(sides_m[1]) / longer as f64;
        let cells = |m: f64| ((m / cell_m).round() as usize).max(1);
        let extent_m = grid.extent_m();
        let whole = (0..2).all(|axis| sides_m[axis] >= extent_m[axis] * (1.0 - SLACK));
        let edges = if whole { grid.edges } else { Edges::Open };
        Grid { width: cells(sides_m[0]), height: cells(sides_m[1]), cell_m, edges }
    }

    /// Whether there is such a window on a map.
    fn check(&self, grid: &Grid) -> Result<(), ProcessError> {
        let unfit = |what: String| Err(ProcessError::Unfit(what));
        let (extent_m, sides_m) = (grid.extent_m(), self.sides_m(grid));
        let [wide, tall] = extent_m.map(|m| plain(m * 1e-3));
        let corner = self.window_km.as_ref().map_or([0.0; 2], |window| [window[0] * 1e3, window[1] * 1e3]);
        if (0..2).any(|axis| corner[axis] + sides_m[axis] > extent_m[axis] * (1.0 + SLACK)) {
            let [x, y, w, h] = [corner[0], corner[1], sides_m[0], sides_m[1]].map(|m| plain(m * 1e-3));
            return unfit(format!(
                "the window ({w} x {h} km from {x}, {y}) reaches off the map, which is {wide} x {tall} km; \
                 move it or make it smaller (window_km, size_km)"
            ));
        }
        let shorter_m = sides_m[0].min(sides_m[1]);
        // Sides that are whole cells but for rounding.
        if shorter_m < LEAST_OLD_CELLS * grid.cell_m * (1.0 - SLACK) {
            return unfit(format!(
                "the window is {} km wide, but the map's cells are {} km: at least {LEAST_OLD_CELLS} of them are needed; \
                 make the window larger, or the map finer with size in [world]",
                plain(shorter_m * 1e-3),
                plain(grid.cell_m * 1e-3)
            ));
        }
        let raster = self.raster(grid);
        if raster.cell_m > grid.cell_m * (1.0 + SLACK) {
            return unfit(format!(
                "cells of {} m would be coarser than the map's, which are {} m; raise size",
                plain(raster.cell_m),
                plain(grid.cell_m)
            ));
        }
        if raster.width.min(raster.height) < LEAST_CELLS {
            return unfit(format!(
                "the window would have {} x {} cells; at least {LEAST_CELLS} a side are needed",
                raster.width, raster.height
            ));
        }
        if raster.cell_m < FINEST_M {
            return unfit(format!("cells of {} m are finer than any map's ({FINEST_M} m)", plain(raster.cell_m)));
        }
        Ok(())
    }

    /// The window on this world.
    fn window(&self, world: &World, routed: &Routed) -> Window {
        let (grid, sides_m) = (&world.grid, self.sides_m(&world.grid));
        let extent_m = grid.extent_m();
        let corner_m = match self.window_km.as_deref() {
            Some(window) => [window[0] * 1e3, window[1] * 1e3],
            None => {
                let middle_m = match self.around {
                    Around::Middle => extent_m.map(|m| 0.5 * m),
                    Around::Summit => routed.summit_m(),
                    Around::River => routed.mid_river_m(),
                };
                // As near as the rim allows.
                [0, 1].map(|axis| {
                    (middle_m[axis] - 0.5 * sides_m[axis]).clamp(0.0, (extent_m[axis] - sides_m[axis]).max(0.0))
                })
            }
        };
        Window { corner_m, grid: self.raster(grid) }
    }
}

/// A length as people write it: at most three digits behind the point.
fn plain(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

struct Zoom {
    params: ZoomParams,
}

impl Process for Zoom {
    fn reads(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        self.params.check(grid)
    }

    fn grid_after(&self, grid: &Grid) -> Grid {
        self.params.raster(grid)
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        self.params.check(&world.grid)?;
        let height = world.height();
        let routed = Routed::of(world, &height);
        context.check()?;
        let window = self.params.window(world, &routed);
        let origin_m = origin_m(world);
        let at_first_m = [origin_m[0] + window.corner_m[0], origin_m[1] + window.corner_m[1]];
        let detail = window::Detail { share: self.params.detail, key: context.key.named("detail"), at_first_m };
        let new_height = window::height(&height, &window, &detail);
        context.check()?;
        let inflows = inflow::over_rim(world, &routed, &window, &new_height);
        // From here on nothing can stop it half way.
        let books = Books { before_m3: world.rock_m3(), inside_m3: window.inside_m3(&height) };
        let parent_cell_m = world.grid.cell_m;
        world.regrid(window.grid, |layer, field| window::layer(layer, field, &window));
        lay_ground(world, &new_height);
        tables::carry(world, &window);
        world.set_inflows(&inflows);
        note_window(world, at_first_m, parent_cell_m);
        books.close(world, context);
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

/// Bedrock that brings the column to this height.
fn lay_ground(world: &mut World, height: &Field<f32>) {
    let mut bedrock = height.clone();
    for part in [Layer::Lava, Layer::Sediment].into_iter().filter_map(|layer| world.layer(layer)) {
        crate::grid::for_each_row(&mut bedrock.data, part.grid.width, |y, row| {
            row.iter_mut().zip(part.row(y)).for_each(|(rock, v)| *rock -= v);
        });
    }
    world.set_layer(Layer::Bedrock, bedrock);
}

/// What leaves with the rest of the map, and what finer sampling changes.
struct Books {
    before_m3: f64,
    inside_m3: f64,
}

impl Books {
    fn close(&self, world: &mut World, context: &Context) {
        let mut book = |m3: f64| match m3 >= 0.0 {
            true => world.ledger.book_in(context.stage, Matter::Rock, m3),
            false => world.ledger.book_out(context.stage, Matter::Rock, -m3),
        };
        book(self.inside_m3 - self.before_m3);
        let now_m3 = world.rock_m3();
        let mut book = |m3: f64| match m3 >= 0.0 {
            true => world.ledger.book_in(context.stage, Matter::Rock, m3),
            false => world.ledger.book_out(context.stage, Matter::Rock, -m3),
        };
        book(now_m3 - self.inside_m3);
    }
}

/// Where the map's north-west corner lies in the first map, m.
fn origin_m(world: &World) -> [f64; 2] {
    let last = |column: &str| world.table(WINDOWS).and_then(|t| t.numbers(column)).and_then(|v| v.last().copied());
    ["first_x_km", "first_y_km"].map(|column| last(column).unwrap_or(0.0) * 1e3)
}

/// Adds a row to the table of windows.
fn note_window(world: &mut World, at_first_m: [f64; 2], parent_cell_m: f64) {
    let [width_m, height_m] = world.grid.extent_m();
    let row = [
        ("first_x_km", "km", at_first_m[0] * 1e-3),
        ("first_y_km", "km", at_first_m[1] * 1e-3),
        ("width_km", "km", width_m * 1e-3),
        ("height_km", "km", height_m * 1e-3),
        ("parent_cell_m", "m", parent_cell_m),
        ("cell_m", "m", world.grid.cell_m),
        ("time_yr", "yr", world.time_yr),
    ];
    let old = world.remove_table(WINDOWS);
    let mut table = Table::new(WINDOWS);
    for (name, unit, value) in row {
        let mut values = old.as_ref().and_then(|t| t.numbers(name)).map_or_else(Vec::new, <[f64]>::to_vec);
        values.push(value);
        table = table.number(name, unit, values);
    }
    world.set_table(table);
}

impl Window {
    /// Rock of the old map within the window, m³: cells on its rim by their share.
    fn inside_m3(&self, height: &Field<f32>) -> f64 {
        let grid = height.grid;
        let share = |index: usize, axis: usize| {
            let (low, high) = (index as f64 * grid.cell_m, (index + 1) as f64 * grid.cell_m);
            let begin = self.corner_m[axis];
            let end = begin + self.grid.extent_m()[axis];
            (high.min(end) - low.max(begin)).max(0.0) / grid.cell_m
        };
        let columns: Vec<f32> = (0..grid.width).map(|x| share(x, 0) as f32).collect();
        let rows = (0..grid.height).filter(|&y| share(y, 1) > 0.0);
        let row = |y: usize| {
            let cut: Vec<f32> = height.row(y).iter().zip(&columns).map(|(z, share)| z * share).collect();
            share(y, 1) * sum_f64(&cut)
        };
        rows.map(row).sum::<f64>() * grid.cell_area_m2()
    }
}

#[cfg(test)]
mod tests;
