//! A made-up world with everything a map shows: continents, ranges along borders, shelf, abyss, trenches, plates.

use upthrust::{
    grid::{Edges, Field, Grid},
    world::{Layer, Table, World},
};

/// Plates' middles in shares of the map, and whether they are continents.
const SITES: [([f64; 2], bool); 7] = [
    ([0.18, 0.22], true),
    ([0.62, 0.15], false),
    ([0.48, 0.52], true),
    ([0.88, 0.42], true),
    ([0.12, 0.72], false),
    ([0.45, 0.92], true),
    ([0.85, 0.86], false),
];

fn hash(x: i64, y: i64, salt: u64) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ salt;
    h = (h ^ (h >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    h = (h ^ (h >> 32)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
}

/// Value noise, -1 to 1.
fn noise([x, y]: [f64; 2], salt: u64) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (ease(x - i), ease(y - j));
    let (i, j) = (i as i64, j as i64);
    let row = |j: i64| hash(i, j, salt) + (hash(i + 1, j, salt) - hash(i, j, salt)) * u;
    row(j) + (row(j + 1) - row(j)) * v
}

fn fbm([x, y]: [f64; 2], octaves: u64, gain: f64) -> f64 {
    let (mut sum, mut amplitude, mut p) = (0.0, 1.0, [x, y]);
    for octave in 0..octaves {
        sum += amplitude * noise(p, octave * 7919);
        amplitude *= gain;
        p = [(p[0] * 0.8 - p[1] * 0.6) * 2.0 + 3.1, (p[0] * 0.6 + p[1] * 0.8) * 2.0 - 1.7];
    }
    sum
}

fn ridged(p: [f64; 2]) -> f64 {
    let (mut sum, mut amplitude, mut p, mut weight) = (0.0, 0.55, p, 1.0f64);
    for octave in 0..7 {
        let ridge = (1.0 - noise(p, 400 + octave).abs()).powi(2) * weight;
        sum += amplitude * ridge;
        weight = (ridge * 1.6).min(1.0);
        amplitude *= 0.56;
        p = [(p[0] * 0.8 - p[1] * 0.6) * 2.0, (p[0] * 0.6 + p[1] * 0.8) * 2.0];
    }
    sum
}

struct Point {
    height_m: f64,
    plate: usize,
    border: usize,
    near: f64,
}

/// What lies at a point in shares of the map's width.
fn at([x, y]: [f64; 2]) -> Point {
    let warp = |salt: f64| 0.09 * fbm([x * 3.0 + salt, y * 3.0 - salt], 5, 0.5);
    let p = [x + warp(10.0), y + warp(70.0)];
    let distance = |s: [f64; 2]| ((p[0] - s[0]).powi(2) + (p[1] - s[1]).powi(2)).sqrt();
    let mut order: Vec<(f64, usize)> = SITES.iter().enumerate().map(|(i, s)| (distance(s.0), i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ((d1, plate), (d2, other)) = (order[0], order[1]);
    let near = d2 - d1;
    let (own, their) = (SITES[plate].1, SITES[other].1);
    let border = match (own, their) {
        (true, true) => 1,
        (false, false) if (plate + other) % 2 == 0 => 3,
        (false, false) => 4,
        _ => 2,
    };
    // Continents thin out towards oceanic plates and reach a little beyond them.
    let edge = if own == their { 1.0 } else { (near / 0.12).min(1.0) };
    let share = if own { 0.55 + 0.45 * edge } else { 0.5 - 0.5 * edge };
    let mainland = share + 0.32 * fbm([x * 5.0, y * 5.0], 8, 0.55);
    let step = ((mainland - 0.42) / 0.16).clamp(0.0, 1.0);
    let base = -4300.0 + 4250.0 * step * step * (3.0 - 2.0 * step) + (mainland - 0.5).max(0.0) * 900.0;
    let belt = (-(near / 0.055).powi(2)).exp();
    let crest = ridged([x * 15.0, y * 15.0]);
    let lift = match border {
        1 => 5200.0 * belt * (0.35 + crest),
        2 if own => 4300.0 * (-((near - 0.035) / 0.035).powi(2)).exp() * (0.3 + crest),
        2 => -3600.0 * (-((near - 0.01) / 0.02).powi(2)).exp(),
        3 => 1500.0 * (-(near / 0.08)).exp(),
        _ => 0.0,
    };
    let rough =
        fbm([x * 14.0 + 5.0, y * 14.0], 8, 0.55) * if step > 0.5 { 150.0 + 0.22 * lift.max(0.0) } else { 160.0 };
    Point { height_m: base + lift + rough, plate, border: if near < 0.03 { border } else { 0 }, near }
}

/// The world, 1000 km wide.
pub fn world(width: usize, height: usize) -> World {
    let grid = Grid::new(width, height, 1e6, Edges::Open);
    let mut world = World::new(grid, 0.0);
    let point = |x: usize, y: usize| at(grid.center_m(x, y).map(|m| m / 1e6));
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| point(x, y).height_m as f32));
    world.set_layer(Layer::PlateId, Field::from_fn(grid, |x, y| point(x, y).plate as f32));
    world.set_layer(Layer::BoundaryKind, Field::from_fn(grid, |x, y| point(x, y).border as f32));
    world.set_layer(Layer::CrustKind, Field::from_fn(grid, |x, y| f32::from(SITES[point(x, y).plate].1)));
    world.set_layer(Layer::CrustAge, Field::from_fn(grid, |x, y| (point(x, y).near * 600.0).min(200.0) as f32));
    world.set_layer(Layer::Uplift, Field::from_fn(grid, |x, y| (point(x, y).height_m / 4000.0).max(-1.5) as f32));
    let column = |f: fn(usize) -> f64| (0..SITES.len()).map(f).collect::<Vec<f64>>();
    world.set_table(
        Table::new("plates")
            .number("id", "1", column(|i| i as f64))
            .number("x_km", "km", column(|i| SITES[i].0[0] * 1000.0))
            .number("y_km", "km", column(|i| SITES[i].0[1] * 1000.0))
            .number("speed_mm_per_yr", "mm/yr", column(|i| 12.0 + 11.0 * i as f64))
            .number("heading_deg", "deg", column(|i| 77.0 * i as f64))
            .text("crust", SITES.iter().map(|s| if s.1 { "continental" } else { "oceanic" }.to_owned()).collect()),
    );
    world
}
