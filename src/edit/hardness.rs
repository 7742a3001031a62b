//! The stage `hardness`: bands of hard rock in soft rock.
//!
//! Strata seen from above: straight bands of one direction, or bent into folds. Hardness is 0 to 1 and scales the rates of
//! erosion by one minus it. It takes no time and moves nothing.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    grid::{Field, Grid},
    noise::{Fbm, smoothstep},
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, World},
};

/// Bands of hard rock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HardnessParams {
    /// Hardness within the bands; 0.8 wears at a fifth of the rate of 0.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "bands that stand out more"))]
    pub hard: f64,
    /// Hardness between them.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "slower erosion everywhere"))]
    pub soft: f64,
    /// Hard bands, side by side about the middle.
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1", "x-effect" = "more ridges"))]
    pub bands: u32,
    /// Width of a band; a tenth of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km", "x-effect" = "broader bands"))]
    pub width_km: Option<f64>,
    /// From the middle of a band to that of the next; twice the width if not given.
    #[schemars(range(min = 0.001, max = 20000.0), extend("x-unit" = "km", "x-effect" = "bands further apart"))]
    pub spacing_km: Option<f64>,
    /// Middle of the bands, east and south of the map's north-west corner; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves the bands east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Direction in which the bands run: 0 is north-south, 90 east-west.
    #[schemars(range(min = -180.0, max = 180.0), extend("x-unit" = "deg", "x-effect" = "turns the bands clockwise"))]
    pub strike_deg: f64,
    /// Width over which hard passes into soft, as a share of a band's width.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1", "x-effect" = "softer borders"))]
    pub edge: f64,
    /// How far the bands are folded aside, a standard deviation; 0 leaves them straight.
    #[schemars(range(min = 0.0, max = 10000.0), extend("x-unit" = "km", "x-effect" = "bands that wind more"))]
    pub fold_km: f64,
    /// Length of the folds; half of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 20000.0), extend("x-unit" = "km", "x-effect" = "longer folds"))]
    pub fold_length_km: Option<f64>,
}

impl Default for HardnessParams {
    fn default() -> Self {
        Self {
            hard: 0.8,
            soft: 0.0,
            bands: 1,
            width_km: None,
            spacing_km: None,
            at_km: None,
            strike_deg: 0.0,
            edge: 0.2,
            fold_km: 0.0,
            fold_length_km: None,
        }
    }
}

impl HardnessParams {
    /// The stage as a process.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Hardness { params: self, placement })
    }

    fn over(&self, grid: Grid, context: &Context) -> Field<f32> {
        let extent_m = grid.extent_m();
        let longer_m = extent_m[0].max(extent_m[1]);
        let width_m = self.width_km.map_or(0.1 * longer_m, |km| km * 1e3);
        let spacing_m = self.spacing_km.map_or(2.0 * width_m, |km| km * 1e3);
        let middle_m = self.at_km.map_or(extent_m.map(|m| 0.5 * m), |at| at.map(|km| km * 1e3));
        let (sin, cos) = libm::sincos(self.strike_deg.to_radians());
        let fold_length_m = self.fold_length_km.map_or(0.5 * longer_m, |km| km * 1e3);
        // Folds are as smooth as bent strata; noise in metres, so that another size has the same.
        let folds = Fbm::new(fold_length_m, 1.0).octaves(context.key.named("folds"), grid.cell_m);
        let last = (self.bands.max(1) - 1) as f64;
        Field::from_fn(grid, |x, y| {
            let at_m = grid.center_m(x, y);
            let [dx, dy] = [at_m[0] - middle_m[0], at_m[1] - middle_m[1]];
            let fold_m = if self.fold_km > 0.0 { self.fold_km * 1e3 * folds.value(at_m) } else { 0.0 };
            // North-south bands are counted from the west; a strike turns them clockwise.
            let across_m = cos * dx + sin * dy + fold_m;
            let nth = (across_m / spacing_m + 0.5 * last).round().clamp(0.0, last);
            let off_m = (across_m - (nth - 0.5 * last) * spacing_m).abs();
            let inner = 0.5 * width_m - off_m;
            let share =
                if self.edge > 0.0 { smoothstep(inner / (self.edge * width_m) + 0.5) } else { f64::from(inner >= 0.0) };
            (self.soft + (self.hard - self.soft) * share) as f32
        })
    }
}

struct Hardness {
    params: HardnessParams,
    placement: Placement,
}

impl Process for Hardness {
    fn writes(&self) -> &'static [Layer] {
        &[Layer::Hardness]
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let mask = self.placement.mask.as_ref().map(|mask| mask.evaluate(world)).transpose()?;
        let bands = self.params.over(world.grid, context);
        context.check()?;
        let width = world.grid.width;
        let hardness = world.layer_mut(Layer::Hardness);
        crate::grid::for_each_row(&mut hardness.data, width, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                let share = mask.as_ref().map_or(1.0, |mask| mask.at(x, y));
                *value += (bands.at(x, y) - *value) * share;
            }
        });
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::grid::Edges;

    #[test]
    fn bands_lie_where_they_are_asked_for() {
        let stay = AtomicBool::new(false);
        let context = Context::new(1, "hardness#1", &stay);
        let grid = Grid::new(100, 100, 100e3, Edges::Open);
        let two = HardnessParams { bands: 2, spacing_km: Some(40.0), edge: 0.0, soft: 0.1, ..Default::default() };
        let field = two.over(grid, &context);
        // Two bands of 10 km about 30 and 70 km.
        let hard: Vec<usize> = (0..100).filter(|&x| field.at(x, 3) > 0.5).collect();
        assert_eq!(hard, (25..35).chain(65..75).collect::<Vec<_>>());
        let turned = HardnessParams { strike_deg: 90.0, ..two.clone() }.over(grid, &context);
        assert!((0..100).all(|y| turned.at(3, y) == field.at(y, 3)));
        let folded = HardnessParams { fold_km: 5.0, ..two }.over(grid, &context);
        let rows: Vec<usize> = (0..100).map(|y| (0..100).position(|x| folded.at(x, y) > 0.5).unwrap()).collect();
        assert!(rows.iter().max() > rows.iter().min(), "{rows:?}");
    }
}
