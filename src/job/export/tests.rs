//! What an export writes, read back: whole worlds on disk, files in a folder.

use std::{fs, path::PathBuf};

use serde_json::Value;

use super::*;
use crate::{
    grid::{Edges, Field, Grid},
    world::{
        Layer, World,
        store::{self, Provenance},
    },
};

/// A stored world of hills and basins, half of them under the sea, with plates.
struct Place {
    folder: tempfile::TempDir,
    world: World,
}

impl Place {
    fn of(width: usize, height: usize) -> Self {
        let grid = Grid::new(width, height, width as f64 * 1000.0, Edges::Open);
        let mut world = World::new(grid, 50.0);
        // Far more different heights than 16 bits can tell apart.
        let height = |x: usize, y: usize| {
            let (x, y) = (x as f64, y as f64);
            (libm::sin(x * 0.083 + y * 0.011) * 2500.0 + libm::cos(y * 0.071 - x * 0.0031) * 1500.0) as f32
        };
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, height));
        world.set_layer(Layer::PlateId, Field::from_fn(grid, |x, _| (x / 16) as f32));
        let folder = tempfile::tempdir().unwrap();
        let from = Provenance { name: "hills".into(), seed: 7, ..Provenance::default() };
        store::write(&world, &from, &folder.path().join("w")).unwrap();
        Self { folder, world }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn request(&self, name: &str) -> ExportRequest {
        ExportRequest {
            world: self.path("w"),
            file: self.path(name),
            layer: "height".into(),
            ..ExportRequest::default()
        }
    }

    fn engine(&self, name: &str, engine: Engine) -> ExportRequest {
        ExportRequest { engine: Some(engine), ..self.request(name) }
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| name != "w");
        names.sort();
        names
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }

    fn gray16(&self, name: &str) -> image::ImageBuffer<image::Luma<u16>, Vec<u16>> {
        let image::DynamicImage::ImageLuma16(picture) = image::open(self.path(name)).unwrap() else { panic!("{name}") };
        picture
    }

    fn raw16(&self, name: &str, side: usize) -> Vec<Vec<u16>> {
        let bytes = fs::read(self.path(name)).unwrap();
        assert_eq!(bytes.len(), side * side * 2, "{name}");
        let row = |row: &[u8]| row.chunks(2).map(|two| u16::from_le_bytes([two[0], two[1]])).collect();
        bytes.chunks(side * 2).map(row).collect()
    }
}

#[test]
fn a_heightmap_is_the_world_within_half_a_step() {
    let place = Place::of(640, 600);
    let done = export(&place.request("h.png")).unwrap();
    assert_eq!(done, Exported { files: vec![place.path("h.png"), place.path("h.png.json")], notes: vec![] });
    let picture = place.gray16("h.png");
    let said = place.json("h.png.json");
    let number = |key: &str| said[key].as_f64().unwrap();
    let step_m = (number("white_m") - number("black_m")) / 65535.0;
    let height = place.world.height();
    for (x, y, pixel) in picture.enumerate_pixels() {
        let read_m = number("black_m") + pixel.0[0] as f64 * step_m;
        assert!((read_m - height.at(x as usize, y as usize) as f64).abs() <= step_m * 0.5001);
    }
    let mut levels = picture.into_raw();
    levels.sort_unstable();
    levels.dedup();
    assert!(levels.len() > 60_000, "{} levels", levels.len());
    let sea_m = number("black_m") + number("sea_level_value") * step_m;
    assert!((sea_m - 50.0).abs() < 1e-9);
    assert_eq!((number("metres_per_sample"), number("seed")), (1000.0, 7.0));
    assert_eq!((&said["recipe"], &said["samples"]), (&"hills".into(), &"cell centres".into()));
}

#[test]
fn a_window_is_the_same_part_of_the_map() {
    let place = Place::of(96, 64);
    let window = Some(Window { x_m: 20_000.0, y_m: 30_000.0, size_m: 16_000.0 });
    export(&ExportRequest { window, ..place.request("w.r32") }).unwrap();
    let bytes = fs::read(place.path("w.r32")).unwrap();
    let values: Vec<f32> = bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
    let height = place.world.height();
    let want: Vec<f32> = (30..46).flat_map(|y| height.row(y)[20..36].to_vec()).collect();
    assert_eq!(values, want);
    assert_eq!(place.json("w.r32.json")["corner_m"], serde_json::json!([20_000.0, 30_000.0]));
}

#[test]
fn identities_are_written_as_they_are() {
    let place = Place::of(64, 64);
    export(&ExportRequest { layer: "plate_id".into(), size: Some(32), ..place.request("p.png") }).unwrap();
    let picture = place.gray16("p.png");
    assert!(picture.enumerate_pixels().all(|(x, _, pixel)| u32::from(pixel.0[0]) == x * 2 / 16));
}

#[test]
fn tiles_share_their_edges_bit_for_bit() {
    let place = Place::of(128, 128);
    export(&ExportRequest { tiles: Some(3), ..place.engine("t.png", Engine::Unreal) }).unwrap();
    let side = place.json("t.png.json")["size"][0].as_u64().unwrap() as u32;
    assert_eq!(side, 127);
    for pattern in ["t_x{x}_y{y}.png", "t_grass_x{x}_y{y}.png"] {
        let name = |x: u32, y: u32| pattern.replace("{x}", &x.to_string()).replace("{y}", &y.to_string());
        let tile = |x, y| image::open(place.path(&name(x, y))).unwrap().into_luma16();
        for (a, b) in [(0, 1), (1, 2)] {
            for other in 0..3 {
                let (west, east) = (tile(a, other), tile(b, other));
                assert!((0..side).all(|y| west.get_pixel(side - 1, y) == east.get_pixel(0, y)), "{pattern}");
                let (north, south) = (tile(other, a), tile(other, b));
                assert!((0..side).all(|x| north.get_pixel(x, side - 1) == south.get_pixel(x, 0)), "{pattern}");
            }
        }
    }
    // Nine heightmaps, nine of each of four materials, the sidecar.
    assert_eq!(place.names().len(), 9 * 5 + 1);
}

#[test]
fn unreal_gets_weights_of_the_same_size_and_a_description_of_raw() {
    let place = Place::of(256, 256);
    let done = export(&place.engine("land.raw", Engine::Unreal)).unwrap();
    assert_eq!(done.files.len(), 7);
    assert!(done.notes.iter().any(|note| note.contains("coarse")), "{:?}", done.notes);
    assert_eq!(place.json("land.json"), serde_json::json!({ "width": 253, "height": 253, "bpp": 16 }));
    assert_eq!(place.raw16("land.raw", 253).len(), 253);
    let materials: Vec<_> = crate::export::MATERIALS
        .iter()
        .map(|name| image::open(place.path(&format!("land_{name}.png"))).unwrap().into_luma8())
        .collect();
    for (x, y, _) in materials[0].enumerate_pixels() {
        let sum: u32 = materials.iter().map(|picture| u32::from(picture.get_pixel(x, y).0[0])).sum();
        assert_eq!(sum, 255);
    }
    assert_eq!(materials[0].dimensions(), (253, 253));
}

#[test]
fn unity_gets_rows_from_the_south_and_four_channels() {
    let place = Place::of(64, 64);
    export(&place.engine("u.raw", Engine::Unity)).unwrap();
    export(&ExportRequest { tiles: Some(1), ..place.request("no.r16") }).unwrap_err();
    let rows = place.raw16("u.raw", 65);
    let said = place.json("u.raw.json");
    assert_eq!(said["first_row"], "south");
    let step_m = said["import"]["terrain_height_m"].as_f64().unwrap() / 65535.0;
    let black_m = said["black_m"].as_f64().unwrap();
    // The southern row first: its vertices lie on the map's south edge.
    let south =
        crate::export::raster::Lattice::over(&place.world.grid, None, 65, crate::export::raster::Sampling::Vertices)
            .read(&place.world.height());
    for (x, &value) in rows[0].iter().enumerate() {
        assert!((black_m + f64::from(value) * step_m - south.at(x, 64) as f64).abs() <= step_m * 0.5001);
    }
    let weights = image::open(place.path("u_weights.png")).unwrap();
    assert_eq!((weights.width(), weights.color()), (64, image::ColorType::Rgba8));
    assert!(weights.into_rgba8().pixels().all(|p| p.0.iter().map(|&v| u32::from(v)).sum::<u32>() == 255));
}

#[test]
fn unity_counts_tiles_from_the_south() {
    let place = Place::of(64, 64);
    export(&ExportRequest { tiles: Some(2), size: Some(33), ..place.engine("u.raw", Engine::Unity) }).unwrap();
    let (south, north) = (place.raw16("u_0_0.raw", 33), place.raw16("u_0_1.raw", 33));
    assert_eq!(south[32], north[0]);
    assert_ne!(south[0], north[32]);
}

#[test]
fn godot_gets_metres_or_their_range() {
    let place = Place::of(100, 100);
    export(&place.engine("g.exr", Engine::Godot)).unwrap();
    export(&place.engine("g.r16", Engine::Godot)).unwrap();
    let said = place.json("g.r16.json");
    assert_eq!(said["import"]["r16_size"], serde_json::json!([128, 128]));
    assert_eq!(said["import"]["r16_range"], serde_json::json!([said["black_m"], said["white_m"]]));
    assert_eq!(place.json("g.exr.json")["import"]["height_offset_m"], -50.0);
}

#[test]
fn a_range_is_kept_and_what_lies_outside_is_told() {
    let place = Place::of(64, 64);
    let range = Some([0.0, 1000.0]);
    let done = export(&ExportRequest { range, ..place.request("r.png") }).unwrap();
    assert!(done.notes[0].contains("outside --range"), "{:?}", done.notes);
    let said = place.json("r.png.json");
    assert_eq!((said["black_m"].as_f64(), said["white_m"].as_f64()), (Some(0.0), Some(1000.0)));
    let picture = place.gray16("r.png");
    let height = place.world.height();
    for (x, y, pixel) in picture.enumerate_pixels() {
        let want = (height.at(x as usize, y as usize) as f64).clamp(0.0, 1000.0) * 65.535;
        assert!((f64::from(pixel.0[0]) - want).abs() <= 0.5001);
    }
}

#[test]
fn what_is_refused_leaves_nothing() {
    let place = Place::of(64, 32);
    let refused = |request: ExportRequest, part: &str| {
        let error = export(&request).unwrap_err();
        assert!(error.refused() && error.to_string().contains(part), "{error}");
        assert!(!error.to_string().contains('\n'));
        assert_eq!(place.names(), [""; 0]);
    };
    let base = |name: &str| place.request(name);
    refused(base("a.gif"), "no format has this ending");
    refused(base("a"), "no format has this ending");
    refused(base("no/a.png"), "there is no folder");
    refused(ExportRequest { layer: "hieght".into(), ..base("a.png") }, "did you mean 'height'?");
    refused(ExportRequest { layer: "water".into(), ..base("a.png") }, "this world has no layer 'water'");
    refused(ExportRequest { layer: "weights".into(), ..base("a.exr") }, "weights are written as .png");
    refused(ExportRequest { layer: "normals".into(), ..base("a.asc") }, "normals are written as .png .exr");
    refused(ExportRequest { bits: Some(32), ..base("a.png") }, ".png is written with 16 or 8");
    refused(ExportRequest { range: Some([5.0, 5.0]), ..base("a.png") }, "must be below");
    refused(ExportRequest { range: Some([0.0, 5.0]), ..base("a.exr") }, "--range goes with whole numbers");
    refused(ExportRequest { big_endian: true, ..base("a.png") }, "--big-endian is for");
    refused(ExportRequest { tiles: Some(2), ..base("a.png") }, "cut one with --window 0,0,32");
    refused(ExportRequest { tiles: Some(100), ..base("a.png") }, "from 2 to 64");
    refused(place.engine("a.png", Engine::Unreal), "cut one with --window 0,0,32");
    refused(place.engine("a.png", Engine::Godot), "takes .exr .r16 .raw");
    refused(place.engine("a4x4.png", Engine::Unreal), "one tile of many");
    refused(ExportRequest { size: Some(2048), ..place.engine("a.png", Engine::Unreal) }, "(nearest: 2017)");
    refused(ExportRequest { bits: Some(8), ..place.engine("a.png", Engine::Unreal) }, "needs 16");
    refused(ExportRequest { range: Some([0.0, 5.0]), ..place.engine("a.png", Engine::Azgaar) }, "does not go with");
    let window = |x_m, y_m, size_m| ExportRequest { window: Some(Window { x_m, y_m, size_m }), ..base("a.png") };
    refused(window(40_000.0, 0.0, 30_000.0), "reaches beyond the map");
    refused(window(0.0, 0.0, -1.0), "must be above 0");
    refused(window(0.0, 0.0, 500.0), "smaller than one cell");
    let many = ExportRequest { size: Some(4033), tiles: Some(8), window: Some(square()), ..base("a.png") };
    refused(many, "too many");
    refused(ExportRequest { world: place.path("none"), ..base("a.png") }, "there is no such world");
}

fn square() -> Window {
    Window { x_m: 0.0, y_m: 0.0, size_m: 32_000.0 }
}

#[test]
fn files_are_replaced_only_when_asked() {
    let place = Place::of(32, 32);
    fs::write(place.path("a.png.json"), "mine").unwrap();
    let error = export(&place.request("a.png")).unwrap_err();
    assert!(error.refused() && error.to_string().contains("a.png.json: exists"), "{error}");
    assert_eq!(place.names(), ["a.png.json"]);
    export(&ExportRequest { force: true, ..place.request("a.png") }).unwrap();
    assert_eq!(place.json("a.png.json")["layer"], "height");
    fs::create_dir(place.path("d.png")).unwrap();
    let error = export(&ExportRequest { force: true, ..place.request("d.png") }).unwrap_err();
    assert!(error.to_string().contains("this is a folder"), "{error}");
}

#[test]
fn the_map_programs_gray_is_8_bits() {
    let place = Place::of(64, 32);
    export(&place.engine("f.png", Engine::Azgaar)).unwrap();
    let picture = image::open(place.path("f.png")).unwrap();
    assert_eq!((picture.width(), picture.height(), picture.color()), (64, 32, image::ColorType::L8));
    // L* 13 is gray 34: the sea lies below, the land from L* 20, gray 48, on.
    let height = place.world.height();
    for (x, y, pixel) in picture.into_luma8().enumerate_pixels() {
        let land = height.at(x as usize, y as usize) > 50.0;
        assert!(if land { pixel.0[0] >= 48 } else { pixel.0[0] <= 34 }, "{x} {y} {}", pixel.0[0]);
    }
}

#[test]
fn meshes_of_the_map_and_of_a_part() {
    let place = Place::of(64, 32);
    export(&place.request("m.stl")).unwrap();
    // Binary STL: 84 bytes and 50 a triangle.
    let triangles = |name: &str| (fs::read(place.path(name)).unwrap().len() - 84) / 50;
    let window = Some(square());
    export(&ExportRequest { window, size: Some(9), ..place.request("part.stl") }).unwrap();
    assert!(triangles("m.stl") > 2 * 64 * 32 && triangles("part.stl") < 2 * 2 * 8 * 8 + 200);
    let refused = [
        ExportRequest { tiles: Some(2), ..place.request("a.glb") },
        ExportRequest { layer: "slope".into(), ..place.request("a.obj") },
        ExportRequest { size: Some(10_000), ..place.request("a.stl") },
    ];
    for request in refused {
        assert!(export(&request).unwrap_err().refused());
    }
    assert_eq!(place.names(), ["m.stl", "part.stl"]);
}

#[test]
fn maps_of_lines_are_whole_or_windows_and_take_contours_alone() {
    let place = Place::of(128, 64);
    let window = Some(Window { x_m: 10_000.0, y_m: 20_000.0, size_m: 30_000.0 });
    let said = export(&place.request("m.svg")).unwrap();
    assert!(said.notes[0].contains("rivers"));
    export(&ExportRequest { window, contours_m: Some(250.0), ..place.request("part.geojson") }).unwrap();
    let part = place.json("part.geojson");
    assert_eq!(part["upthrust"]["contours_m"], 250.0);
    assert_eq!(part["upthrust"]["extent_km"], serde_json::json!([30.0, 30.0]));
    let layers: std::collections::BTreeSet<&str> =
        part["features"].as_array().unwrap().iter().filter_map(|f| f["properties"]["layer"].as_str()).collect();
    assert!(["border", "contour", "land", "peak"].iter().all(|layer| layers.contains(layer)), "{layers:?}");
    let off = Some(Window { x_m: 100_000.0, y_m: 0.0, size_m: 30_000.0 });
    let refused = [
        ExportRequest { tiles: Some(2), ..place.request("a.svg") },
        ExportRequest { size: Some(100), ..place.request("a.geojson") },
        ExportRequest { contours_m: Some(1.0), ..place.request("a.svg") },
        ExportRequest { contours_m: Some(-1.0), ..place.request("a.svg") },
        ExportRequest { contours_m: Some(100.0), ..place.request("a.png") },
        ExportRequest { contours_m: Some(100.0), ..place.request("a.glb") },
        ExportRequest { window: off, ..place.request("a.svg") },
        place.request("m.svg"),
    ];
    for request in refused {
        assert!(export(&request).unwrap_err().refused(), "{request:?}");
    }
    assert_eq!(place.names(), ["m.svg", "part.geojson"]);
}
