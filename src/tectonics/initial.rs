//! The world before the plates move: which plate owns which cell, continents and their shelves, old worn belts.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    crust,
    grid::{Field, nearest_feature},
    noise::{Fbm, Key, smoothstep},
    rmp::{self, Brush},
};

use super::{
    domain::Domain,
    params::{PlateCrust, PlatesParams},
    partition::{self, Polygon},
    plate::Rock,
};

/// Mean thickness of continental crust far from the sea, m: it stands half a kilometre above it.
const INTERIOR_M: f64 = 33_500.0;
/// Thickness at the shelf's edge, m: some 250 m below the sea.
const SHELF_EDGE_M: f64 = 28_500.0;
/// Widths of the shelf over which a continent rises to its interior.
const RISE: f64 = 4.0;
/// Standard deviation of that thickness, m: plains and uplands.
const CONTINENT_VARIES_M: f64 = 1_500.0;
/// Ages of ocean floor, My.
const OCEAN_AGE_MYR: [f64; 2] = [15.0, 120.0];
/// Thickness that an old belt added at its crest, m: worn to about a kilometre.
const OLD_BELT_M: f64 = 6_500.0;
/// Mosaics drawn for one old belt: many, so that no step of a single draw is left.
const OLD_BELT_DRAWS: u64 = 27;

/// Plate index of every tectonic cell for convex plates in engine units.
pub fn owners_of(domain: &Domain, outlines: &[Polygon]) -> Vec<u8> {
    let n = domain.cells;
    (0..n * n)
        .into_par_iter()
        .map(|i| owner_at(outlines, domain.to_engine(domain.cell_center_m(i % n, i / n))))
        .collect()
}

/// The convex plate at a point in engine units; the one with the nearest middle where there is none.
pub fn owner_at(outlines: &[Polygon], at: DVec2) -> u8 {
    let inside = |outline: &Polygon| partition::edges(outline).all(|(a, b)| (b - a).perp_dot(at - a) >= 0.0);
    let distance = |plate: &usize| partition::centroid(&outlines[*plate]).distance(at);
    let nearest = || (0..outlines.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    outlines.iter().position(inside).or_else(nearest).unwrap_or(0) as u8
}

/// The continents before the plates move, over the tectonic raster.
pub struct Continents {
    /// Continental share, 0 to 1: the slope from shelf to ocean floor.
    pub kind: Field<f32>,
    /// Distance inwards from the shelf's edge, m; negative in the ocean.
    pub inward_m: Field<f32>,
}

/// Continents as seeded, or as painted (light is land).
pub fn continents(domain: &Domain, params: &PlatesParams, painted: Option<&Field<f32>>, key: Key) -> Continents {
    let grid = domain.grid();
    let land: Field<bool> = match painted {
        Some(light) => light.map(|v| v > 0.5),
        None => seeded_land(domain, params, key),
    };
    let to_land = nearest_feature(grid, |i| land.data[i]).distance_m;
    let to_sea = nearest_feature(grid, |i| !land.data[i]).distance_m;
    let far = 1e9f32;
    let inward_m = Field::from_fn(grid, |x, y| {
        let i = grid.index(x, y);
        if land.data[i] { to_sea.data[i].min(far) } else { -to_land.data[i].min(far) }
    });
    let slope = params.shelf_km * 1e3;
    let kind = inward_m.map(|d| smoothstep(1.0 + d as f64 / slope) as f32);
    Continents { kind, inward_m }
}

/// Continents as the highest share of a fractal sum over the map.
fn seeded_land(domain: &Domain, params: &PlatesParams, key: Key) -> Field<bool> {
    let sum = Fbm::new(params.continent_km * 1e3, 0.75).octaves(key.named("continents"), 2.0 * domain.cell_m());
    let value = Field::from_fn(domain.grid(), |x, y| sum.value(domain.cell_center_m(x, y).into()) as f32);
    let n = domain.cells;
    let mut on_map: Vec<f32> =
        (0..n * n).filter(|&i| domain.on_map(domain.cell_center_m(i % n, i / n))).map(|i| value.data[i]).collect();
    on_map.sort_by(f32::total_cmp);
    let at = ((1.0 - params.continental_share) * on_map.len() as f64) as usize;
    let bound = on_map.get(at).copied().unwrap_or(f32::INFINITY);
    value.map(|v| v >= bound)
}

/// Rock of every tectonic cell before anything has moved.
pub fn rocks(domain: &Domain, params: &PlatesParams, continents: &Continents, key: Key) -> Vec<Rock> {
    let kind = &continents.kind;
    let cell = 2.0 * domain.cell_m();
    let wide = params.continent_km * 1e3;
    let uplands = Fbm::new(0.6 * wide, 0.7).octaves(key.named("uplands"), cell);
    let ages = Fbm { octaves: Some(3.0), ..Fbm::new(wide, 1.0) }.octaves(key.named("ages"), cell);
    let belts = old_belts(domain, params, key);
    (0..kind.data.len())
        .into_par_iter()
        .map(|i| {
            let at = domain.cell_center_m(i % domain.cells, i / domain.cells).into();
            let land = kind.data[i] as f64;
            // A shelf rises steeply at first, then ever more gently to the interior.
            let inland = (continents.inward_m.data[i] as f64 / (RISE * params.shelf_km * 1e3)).clamp(0.0, 1.0);
            let rise = SHELF_EDGE_M + (INTERIOR_M - SHELF_EDGE_M) * inland * (2.0 - inland);
            let varied = CONTINENT_VARIES_M * uplands.value(at) * (0.4 + 0.6 * inland);
            let continent = rise + varied + belts.data[i] as f64;
            let crust_m = crust::OCEAN_THICKNESS_M + (continent - crust::OCEAN_THICKNESS_M) * land;
            let [young, old] = OCEAN_AGE_MYR;
            let age = young + (old - young) * smoothstep(0.5 + 0.3 * ages.value(at));
            // Continents are as old as their belts look: a few hundred My and more.
            let age = age + land * 400.0;
            Rock { crust_m: crust_m as f32, kind: land as f32, born_myr: -age as f32, ..Rock::default() }
        })
        .collect()
}

/// Thickness that old belts left, m: a few long curved lines, raised in many draws.
fn old_belts(domain: &Domain, params: &PlatesParams, key: Key) -> Field<f32> {
    let belts: Vec<Field<f32>> = (0..params.old_belts as u64)
        .into_par_iter()
        .map(|belt| old_belt(domain, params, key.named("old belt").with(belt)))
        .collect();
    // Added up in their order, so that threads do not matter.
    Field::from_fn(domain.grid(), |x, y| belts.iter().map(|belt| belt.at(x, y)).sum())
}

fn old_belt(domain: &Domain, params: &PlatesParams, key: Key) -> Field<f32> {
    let mut raised = Field::filled(domain.grid(), 0.0f32);
    let mut brush = Brush::new();
    let mut stream = key.stream();
    let path = wandering_line(domain, &mut stream);
    let height_m = OLD_BELT_M * stream.between(0.4, 1.0);
    let half_width_m = params.belt_km * 1e3 * stream.between(0.7, 1.3);
    let step_m = height_m / OLD_BELT_DRAWS as f64;
    for draw in 0..OLD_BELT_DRAWS {
        // Two thirds of the draws are half as wide: a crest on a swell.
        let half = if draw % 3 == 0 { half_width_m } else { half_width_m / 2.0 };
        for cell in rmp::cells_along(&path, rmp::density_for_half_width(half), key.with(draw)) {
            let outline: Vec<[f64; 2]> = cell.outline.iter().map(|&v| domain.to_cells(v.into()).into()).collect();
            let height_m = step_m * cell.weight / rmp::MEAN_WEIGHT;
            brush.cover(&outline, domain.cells, domain.cells, |x, y, coverage| {
                raised.data[y * domain.cells + x] += (height_m * coverage as f64) as f32;
            });
        }
    }
    raised
}

fn wandering_line(domain: &Domain, stream: &mut crate::noise::Stream) -> Vec<[f64; 2]> {
    let mut at = domain.corner_m + DVec2::new(stream.unit(), stream.unit()) * domain.side_m;
    let mut heading = stream.between(0.0, std::f64::consts::TAU);
    let step = domain.side_m * stream.between(0.06, 0.1);
    let turn = stream.between(-0.3, 0.3);
    (0..6)
        .map(|_| {
            let here = at;
            heading += turn + stream.between(-0.2, 0.2);
            at += step * DVec2::new(libm::cos(heading), libm::sin(heading));
            here.into()
        })
        .collect()
}

/// The crust that a plate entry asks for, applied to the plate's continental shares.
pub fn override_crust(continents: &mut Continents, owners: &[u8], plate: u8, crust: PlateCrust) {
    let (share, inward_m) = match crust {
        PlateCrust::Mixed => return,
        PlateCrust::Continental => (1.0, 300e3),
        PlateCrust::Oceanic => (0.0, -300e3),
    };
    for i in (0..owners.len()).filter(|&i| owners[i] == plate) {
        continents.kind.data[i] = share;
        let d = &mut continents.inward_m.data[i];
        *d = if inward_m > 0.0 { d.max(inward_m) } else { d.min(inward_m) };
    }
}
