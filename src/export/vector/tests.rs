//! Vector maps of small worlds whose lines are known.

use super::*;
use crate::{
    grid::{Edges, Field},
    world::{Layer, Table},
};

/// A round island of 30 km with a pond, a river down to the south, on a map of 100 km.
fn island() -> World {
    let grid = Grid::new(100, 100, 100_000.0, Edges::Open);
    let mut world = World::new(grid, 0.0);
    let r = |x: usize, y: usize| ((x as f32 - 49.5).powi(2) + (y as f32 - 49.5).powi(2)).sqrt();
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| 100.0 * (30.0 - r(x, y))));
    let y: Vec<f64> = (0..=30).map(|k| 50.0 + k as f64).collect();
    let q = y.iter().map(|y| y - 49.0).collect::<Vec<_>>();
    let rows = y.len();
    world.set_table(
        Table::new("rivers")
            .number("river", "1", vec![1.0; rows])
            .number("x_km", "km", vec![50.0; rows])
            .number("y_km", "km", y)
            .number("width_m", "m", q.iter().map(|q| 10.0 * q).collect())
            .number("discharge_m3_s", "m3/s", q)
            .number("order", "1", vec![1.0; rows])
            .text("into", vec!["sea".to_owned(); rows])
            .number("into_id", "1", vec![0.0; rows]),
    );
    world
}

fn map(window: Option<Window>) -> Map {
    let options = VectorOptions { window, contours_m: Some(500.0), title: "Isle & <friends>".into() };
    Map::of(&island(), &options).unwrap()
}

#[test]
fn land_contours_and_rivers_are_where_they_are() {
    let map = map(None);
    let area = shapes::area(&map.land[0].outer);
    assert_eq!(map.land.len(), 1);
    assert!((area / (std::f64::consts::PI * 9e8) - 1.0).abs() < 2e-3, "{area}");
    let levels: Vec<f64> = map.contours.iter().map(|(m, _)| *m).collect();
    assert!(levels.contains(&2500.0) && levels.contains(&0.0) && levels.windows(2).all(|w| w[0] <= w[1]));
    let river: f64 = map.rivers.iter().map(|reach| shapes::length(&reach.line)).sum();
    assert!((river - 30_000.0).abs() < 1e-6 && map.rivers.len() > 5);
    assert!(map.rivers.windows(2).all(|w| w[0].line.last() == w[1].line.first()));
    assert_eq!(map.peaks.len(), 1);
}

#[test]
fn a_window_cuts_everything_and_closes_polygons() {
    let map = map(Some(Window { x_m: 50_000.0, y_m: 50_000.0, size_m: 25_000.0 }));
    let quarter = map.land.iter().map(|p| shapes::area(&p.outer)).sum::<f64>();
    // The island's quarter of 30 km without what lies beyond 25 km: π/4·30² − 2·∫ √(30² − x²) from 25 to 30 = 594.3 km².
    assert!((quarter / 594.3e6 - 1.0).abs() < 5e-3, "{quarter}");
    let inside = |p: &[f64; 2]| p.iter().all(|&v| (50_000.0..=75_000.0).contains(&v));
    let lines = map.rivers.iter().map(|reach| &reach.line).chain(map.contours.iter().map(|(_, line)| line));
    assert!(lines.flatten().all(inside));
    let river: f64 = map.rivers.iter().map(|reach| shapes::length(&reach.line)).sum();
    assert!((river - 25_000.0).abs() < 1e-6, "{river}");
}

#[test]
fn the_files_are_sound() {
    let map = map(None);
    let json: serde_json::Value = serde_json::from_str(&geojson::text(&map)).unwrap();
    let features = json["features"].as_array().unwrap();
    let land = features.iter().find(|f| f["properties"]["layer"] == "land").unwrap();
    let ring: Vec<[f64; 2]> = serde_json::from_value(land["geometry"]["coordinates"][0].clone()).unwrap();
    assert_eq!(ring.first(), ring.last());
    // Counterclockwise with north up, and 30 km around 0, 0.
    let area: f64 = ring.windows(2).map(|w| 0.5 * (w[0][0] * w[1][1] - w[1][0] * w[0][1])).sum();
    let want = std::f64::consts::PI * (30.0f64 / 111.319_490_793).powi(2);
    assert!((area / want - 1.0).abs() < 2e-3, "{area} {want}");
    let svg = svg::text(&map);
    assert!(
        svg.contains("<title>Isle &amp; &lt;friends&gt;</title>")
            && svg.matches("<g").count() == svg.matches("</g>").count()
    );
    for layer in ["tints", "contours", "rivers", "lakes", "coast", "plates", "borders", "motions", "peaks", "volcanoes"]
    {
        assert!(svg.contains(&format!("<g id=\"{layer}\" inkscape:groupmode=\"layer\"")), "{layer}");
    }
}

#[test]
fn a_world_of_nothing_is_an_empty_map() {
    let mut world = World::new(Grid::new(4, 3, 400.0, Edges::Open), 0.0);
    let map = Map::of(&world, &VectorOptions::default()).unwrap();
    assert!(map.contours.is_empty() && map.rivers.is_empty());
    geojson::text(&map);
    world.layer_mut(Layer::Bedrock).data.fill(-5.0);
    let sea = Map::of(&world, &VectorOptions::default()).unwrap();
    assert!(sea.land.is_empty() && svg::text(&sea).contains("</svg>"));
    world.layer_mut(Layer::Bedrock).data[5] = f32::NAN;
    assert!(Map::of(&world, &VectorOptions::default()).is_err());
}
