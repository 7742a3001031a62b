//! The rain of several winds, brought to the map, and what follows from it at every cell.
//!
//! Air is smooth: its raster has [`CELLS`] cells on the map's longer side whatever the map's own number, and what comes
//! out is interpolated. Temperature, snow line and biomes follow the map's own heights.

use rayon::prelude::*;

use crate::grid::{Field, Grid, Points, blur, resample, sum_rows};

use super::{
    Biome, Budget, ClimateParams, Zone,
    air::{Air, Below, Habits},
    water,
};

/// Cells of the air's raster on the map's longer side.
pub const CELLS: usize = 256;
/// A year, s.
const YEAR_S: f64 = 365.25 * 86_400.0;
/// Directions through the year, in shares of the spread, with weights that add to 24.
const WINDS: [(f64, f64); 7] =
    [(-1.0, 1.0), (-2.0 / 3.0, 3.0), (-1.0 / 3.0, 5.0), (0.0, 6.0), (1.0 / 3.0, 5.0), (2.0 / 3.0, 3.0), (1.0, 1.0)];

/// The weather of a mean year over a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Weather {
    /// Rain and snow, mm/yr.
    pub rain_mm_per_yr: Field<f32>,
    /// What runs off, mm/yr.
    pub runoff_mm_per_yr: Field<f32>,
    /// Mean temperature at the ground, degC.
    pub temperature_degc: Field<f32>,
    /// Height above which snow outlasts the summer, m.
    pub snow_line_m: Field<f32>,
    /// What grows, see [`Biome`].
    pub biome: Field<f32>,
    /// Water of the whole map, the mean over the winds.
    pub budget: Budget,
}

impl Weather {
    /// Over ground of these heights; `share` is the share of the rain that falls at a cell, all of it if not given.
    pub fn over(height: &Field<f32>, sea_level_m: f64, params: &ClimateParams, share: Option<&Field<f32>>) -> Self {
        let below = below(height, sea_level_m, params);
        let (air_rain, budget) = rain(&below, params);
        let grid = height.grid;
        let mut data = resample(&air_rain, grid.width, grid.height, Points::Centres);
        // The interpolation may swing a little below nothing beside a steep shadow.
        data.iter_mut().for_each(|rain| *rain = rain.max(0.0));
        if let Some(share) = share {
            data.iter_mut().zip(&share.data).for_each(|(rain, share)| *rain *= share.clamp(0.0, 1.0));
        }
        Self::from_rain(Field { grid, data }, height, sea_level_m, params, budget)
    }

    fn from_rain(
        rain_mm_per_yr: Field<f32>,
        height: &Field<f32>,
        sea_level_m: f64,
        params: &ClimateParams,
        budget: Budget,
    ) -> Self {
        let grid = height.grid;
        let zones = Zone::rows(&grid, params);
        let over_sea_m = |x: usize, y: usize| height.at(x, y) as f64 - sea_level_m;
        let rain = |x: usize, y: usize| rain_mm_per_yr.at(x, y) as f64;
        let temperature_degc = Field::from_fn(grid, |x, y| zones[y].temperature_degc(over_sea_m(x, y)) as f32);
        let runoff_mm_per_yr =
            Field::from_fn(grid, |x, y| water::runoff_mm_per_yr(rain(x, y), temperature_degc.at(x, y) as f64) as f32);
        let snow_line_m = Field::from_fn(grid, |x, y| (sea_level_m + water::snow_line_m(&zones[y], rain(x, y))) as f32);
        let biome = Field::from_fn(grid, |x, y| {
            let biome = if over_sea_m(x, y) < 0.0 {
                Biome::Sea
            } else if height.at(x, y) >= snow_line_m.at(x, y) {
                Biome::Ice
            } else {
                Biome::of(temperature_degc.at(x, y) as f64, rain(x, y))
            };
            f32::from(biome as u8)
        });
        Self { rain_mm_per_yr, runoff_mm_per_yr, temperature_degc, snow_line_m, biome, budget }
    }
}

/// The ground as air sees it.
fn below(height: &Field<f32>, sea_level_m: f64, params: &ClimateParams) -> Below {
    let from = height.grid;
    let longer = from.width.max(from.height) as f64;
    let cells = |side: usize| ((side as f64 * CELLS as f64 / longer).round() as usize).max(4);
    let cell_m = from.cell_m * longer / CELLS as f64;
    let grid = Grid { width: cells(from.width), height: cells(from.height), cell_m, edges: from.edges };
    let brought = |field: Field<f32>| {
        let data = resample(&field, grid.width, grid.height, Points::Centres);
        Field { grid, data }
    };
    let land = brought(height.map(|h| (h as f64 - sea_level_m).max(0.0) as f32)).map(|h| h.max(0.0));
    let sea = brought(height.map(|h| f32::from((h as f64) < sea_level_m))).map(|s| s.clamp(0.0, 1.0));
    // At least so much that no single cell shows.
    let sigma = (params.air_km * 1e3 / cell_m).max(0.7);
    Below::new(blur(&land, sigma), sea, Zone::rows(&grid, params))
}

/// Rain on the air's raster, mm/yr, the mean over the winds of a year.
fn rain(below: &Below, params: &ClimateParams) -> (Field<f32>, Budget) {
    let habits = Habits {
        wind_m_per_s: params.wind_m_per_s,
        rim_humidity: params.rim_humidity,
        lift_share: params.lift_share,
        delay_s: params.drift_km * 1e3 / params.wind_m_per_s,
        shadow_m: params.shadow_km * 1e3,
    };
    let winds: &[(f64, f64)] = if params.wind_spread_deg > 0.0 { &WINDS } else { &WINDS[3..4] };
    let solved: Vec<(Vec<f64>, Budget)> = winds
        .par_iter()
        .map(|&(turn, _)| {
            let air = Air::over(below, habits, turn * params.wind_spread_deg);
            (air.rain().collect(), air.budget())
        })
        .collect();
    let all: f64 = winds.iter().map(|(_, weight)| weight).sum();
    let grid = below.height_m.grid;
    let mut sums = vec![0.0f64; grid.cells()];
    let mut budget = Budget::default();
    for ((rain, own), (_, weight)) in solved.iter().zip(winds) {
        let share = weight / all;
        sums.iter_mut().zip(rain).for_each(|(sum, rain)| *sum += share * YEAR_S * rain);
        budget.from_sea += share * own.from_sea;
        budget.from_rim += share * own.from_rim;
        budget.to_ground += share * own.to_ground;
        budget.to_rim += share * own.to_rim;
    }
    if let Some(wanted) = params.rain_mm_per_yr {
        let land = |i: usize| 1.0 - below.sea.data[i] as f64;
        let row = |y: usize| y * grid.width..(y + 1) * grid.width;
        let fell = sum_rows(grid.height, |y| row(y).map(|i| land(i) * sums[i]).sum());
        let area = sum_rows(grid.height, |y| row(y).map(land).sum());
        if fell > 0.0 {
            let factor = wanted * area / fell;
            sums.iter_mut().for_each(|sum| *sum *= factor);
        } else {
            // Air without any water still owes what was asked for.
            sums.fill(wanted);
        }
    }
    let field = Field { grid, data: sums.into_iter().map(|mm| mm as f32).collect() };
    (field, budget)
}
