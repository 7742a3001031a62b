//! Meshes taken apart again.

use std::collections::HashMap;

use super::*;
use crate::{
    grid::{Edges, Grid},
    world::Layer,
};

fn world(width: usize, height: usize, heights: impl Fn(f64, f64) -> f64 + Sync) -> World {
    let grid = Grid::new(width, height, width as f64 * 100.0, Edges::Open);
    let mut world = World::new(grid, 0.0);
    let at = |x: usize, y: usize| {
        let [x, y] = grid.center_m(x, y);
        heights(x, y) as f32
    };
    world.set_layer(Layer::Bedrock, Field::from_fn(grid, at));
    world
}

fn hills(x: f64, y: f64) -> f64 {
    300.0 * (x / 900.0).sin() * (y / 700.0).cos()
}

fn float(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// The triangles of a binary STL, points by their bits.
fn triangles(stl: &[u8]) -> Vec<[[f32; 3]; 3]> {
    assert_eq!(stl.len(), 84 + 50 * word(stl, 80));
    let point = |at: usize| [0, 4, 8].map(|d| float(stl, at + d));
    (0..word(stl, 80)).map(|t| [12, 24, 36].map(|d| point(84 + 50 * t + d))).collect()
}

#[test]
fn a_print_is_closed_and_has_the_volume_of_the_land() {
    let options = MeshOptions { size: 41, exaggeration: Some(2.0), ..Default::default() };
    let mut stl = Vec::new();
    write_stl(&world(60, 40, hills), &options, &mut stl).unwrap();
    let triangles = triangles(&stl);
    let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    let mut volume = 0.0f64;
    for t in &triangles {
        let bits = t.map(|p| p.map(f32::to_bits));
        for k in 0..3 {
            *edges.entry([bits[k], bits[(k + 1) % 3]]).or_default() += 1;
        }
        let [a, b, c] = t.map(|p| p.map(|v| v as f64));
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        volume += (0..3).map(|i| a[i] * cross[i]).sum::<f64>() / 6.0;
    }
    for ([from, to], count) in &edges {
        assert_eq!((*count, edges.get(&[*to, *from])), (1, Some(&1)), "an edge is not shared by two triangles");
    }
    // 6 km are 150 mm: the mean of the hills over their lowest point, twice too high, and the base.
    let ground = world(60, 40, hills).height();
    let mean = crate::grid::sum_f64(&ground.data) / ground.data.len() as f64;
    let low = ground.range().unwrap().0 as f64;
    let want = 150.0 * 100.0 * (3.0 + (mean - low) * 2.0 * 150.0 / 6000.0);
    assert!((volume / want - 1.0).abs() < 0.02, "{volume} {want}");
    let points = triangles.iter().flatten();
    let [west, east] = points.fold([f32::MAX, f32::MIN], |[a, b], p| [a.min(p[0]), b.max(p[0])]);
    assert_eq!([west, east], [-75.0, 75.0]);
}

#[test]
fn flat_land_is_printed_as_a_plate() {
    let mut stl = Vec::new();
    write_stl(&world(16, 16, |_, _| -40.0), &MeshOptions::default(), &mut stl).unwrap();
    let heights: Vec<f32> = triangles(&stl).iter().flatten().map(|p| p[2]).collect();
    assert!(heights.iter().all(|z| *z == 0.0 || (*z - 3.0).abs() < 1e-5));
}

#[test]
fn a_glb_says_what_is_in_it() {
    let options = MeshOptions { size: 33, ..Default::default() };
    let mut glb = Vec::new();
    write_glb(&world(64, 48, hills), &options, &mut glb).unwrap();
    assert_eq!((&glb[..4], word(&glb, 4), word(&glb, 8)), (&b"glTF"[..], 2, glb.len()));
    let text = &glb[20..20 + word(&glb, 12)];
    let binary = 20 + text.len() + 8;
    let json: serde_json::Value = serde_json::from_slice(text).unwrap();
    let levels = json["meshes"].as_array().unwrap();
    let sizes = [(33, 25), (17, 13), (9, 7)];
    assert_eq!(levels.len(), sizes.len());
    for (number, (w, h)) in sizes.iter().enumerate() {
        assert_eq!(json["nodes"][number]["name"], format!("terrain_LOD{number}"));
        let part = &levels[number]["primitives"][0];
        let accessor = |which: &serde_json::Value| json["accessors"][which.as_u64().unwrap() as usize].clone();
        let position = accessor(&part["attributes"]["POSITION"]);
        assert_eq!(position["count"], w * h);
        assert_eq!(position["max"][0], 3200.0);
        let indices = accessor(&part["indices"]);
        assert_eq!(indices["count"], 6 * (w - 1) * (h - 1));
        let view = &json["bufferViews"][indices["bufferView"].as_u64().unwrap() as usize];
        let start = binary + view["byteOffset"].as_u64().unwrap() as usize;
        let most = (0..indices["count"].as_u64().unwrap() as usize).map(|i| word(&glb, start + 4 * i)).max();
        assert_eq!(most, Some(w * h - 1));
    }
    let last = json["bufferViews"].as_array().unwrap().last().unwrap();
    let end = last["byteOffset"].as_u64().unwrap() + last["byteLength"].as_u64().unwrap();
    assert_eq!(binary + end as usize, glb.len());
}

#[test]
fn normals_stand_on_a_plane_and_triangles_face_up() {
    let slope = world(32, 32, |x, y| 0.5 * x - 0.25 * y);
    let lattice = to_scale(&ground(&slope).unwrap(), &MeshOptions::default(), 17);
    let length = (0.25f64 + 0.0625 + 1.0).sqrt();
    for (i, want) in [-0.5, 1.0, 0.25].iter().enumerate() {
        assert!((lattice.normal(8, 8)[i] as f64 - want / length).abs() < 1e-5);
    }
    let point = |i: usize| lattice.point(i % lattice.width, i / lattice.width).map(|v| v as f64);
    lattice
        .each_triangle(|[a, b, c]| {
            let [a, b, c] = [a, b, c].map(point);
            let up = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
            assert!(up > 0.0);
            Ok(())
        })
        .unwrap();
}

#[test]
fn an_obj_has_a_line_for_everything() {
    let mut text = Vec::new();
    write_obj(&world(20, 10, hills), &MeshOptions::default(), &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let count = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    // No more points than the map has corners.
    assert_eq!((count("v "), count("vn "), count("f ")), (21 * 11, 21 * 11, 2 * 20 * 10));
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let world = world(16, 16, hills);
    let options = MeshOptions::default();
    for (name, format) in [("a.glb", MeshFormat::Glb), ("a.obj", MeshFormat::Obj), ("a.stl", MeshFormat::Stl)] {
        write_mesh(&world, &options, format, &folder.path().join(name)).unwrap();
    }
    let mut broken = world.clone();
    broken.layer_mut(Layer::Bedrock).data[18] = f32::NAN;
    let error = write_mesh(&broken, &options, MeshFormat::Glb, &folder.path().join("b.glb")).unwrap_err();
    assert!(error.to_string().contains("(2, 1)"), "{error}");
    assert!(write_mesh(&world, &options, MeshFormat::Obj, &folder.path().join("no/b.obj")).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}
