//! Plates drawn as a picture, and plates singled out by a point.

use std::sync::atomic::AtomicBool;

use crate::{
    process::{Context, Placement},
    tectonics::{PlateCrust, PlateEntry, PlatesParams, paint, partition, warp::Warp},
    world::{Layer, World},
};

use super::*;

/// A picture of a red square on blue, the left upper quarter red, with a thin green line.
fn picture(folder: &std::path::Path) -> String {
    let image = image::RgbImage::from_fn(200, 200, |x, y| match (x, y) {
        (0..100, 0..100) => image::Rgb([255, 0, 0]),
        (_, 150) => image::Rgb([0, 250, 250]),
        _ => image::Rgb([0, 0, 255]),
    });
    let path = folder.join("plates.png");
    image.save(&path).unwrap();
    path.display().to_string()
}

#[test]
fn colours_become_plates_and_hulls_hold_them() {
    let folder = tempfile::tempdir().unwrap();
    let domain = Domain::around(&Grid::new(64, 64, 1_000e3, Edges::Open), 1.5, 300);
    let warp = Warp::new(domain.map_m, 0.0, Key::new(0));
    let (owners, count) = paint::plates(&domain, &warp, &picture(folder.path())).unwrap();
    // The line covers half a percent: a plate of its own, and the last one.
    assert_eq!(count, 3);
    let at = |x_km: f64, y_km: f64| {
        let cell = domain.to_cells(DVec2::new(x_km, y_km) * 1e3);
        owners[cell.y as usize * domain.cells + cell.x as usize]
    };
    assert_eq!((at(800.0, 200.0), at(200.0, 200.0), at(500.0, 752.4)), (0, 1, 2));
    // Beyond the map its rim goes on.
    assert_eq!((at(1_200.0, 200.0), at(-200.0, -200.0)), (0, 1));

    let hulls = paint::hulls(&domain, &owners, count);
    for (plate, hull) in hulls.iter().enumerate() {
        assert!(partition::area(hull) > 0.0, "clockwise");
        let own = (0..owners.len()).filter(|&i| owners[i] as usize == plate);
        for i in own {
            let at = domain.to_engine(domain.cell_center_m(i % domain.cells, i / domain.cells));
            assert!(partition::edges(hull).all(|(a, b)| (b - a).perp_dot(at - a) >= 0.0), "{plate} misses {at}");
        }
    }
    // The red plate is a rectangle: its hull is itself, half the square's width plus what the margin adds.
    let side = (250.0 + 500.0) / domain.unit_m() * 1e3;
    assert!((partition::area(&hulls[1]) / (side * side) - 1.0).abs() < 0.01);
}

/// Runs the first step of painted plates with these entries.
fn first_step(entries: &[[f64; 2]]) -> Result<World, String> {
    let folder = tempfile::tempdir().unwrap();
    let entry = |&at_km: &[f64; 2]| PlateEntry { at_km, crust: PlateCrust::Continental, ..PlateEntry::default() };
    let params = PlatesParams {
        map: Some(picture(folder.path())),
        cells: 96,
        bend: 0.02,
        plate: entries.iter().map(entry).collect(),
        ..PlatesParams::default()
    };
    let stay = AtomicBool::new(false);
    let context = Context::new(1, "plates", &stay);
    let mut world = World::new(Grid::new(32, 32, 1_000e3, Edges::Open), 0.0);
    let mut process = params.process(Placement::default(), Some(1_000), false);
    process.fit(&world.grid).map_err(|e| e.to_string())?;
    process.step(&mut world, &context).map_err(|e| e.to_string())?;
    process.publish(&mut world, &context).map_err(|e| e.to_string())?;
    Ok(world)
}

#[test]
fn entries_off_the_map_or_twice_on_a_plate_are_refused() {
    let error = first_step(&[[800.0, 200.0], [1_200.0, 200.0]]).unwrap_err();
    assert_eq!(error, "plate 2: at_km = [1200, 200] lies outside the map (0 to 1000, 0 to 1000)");
    let error = first_step(&[[800.0, 200.0], [200.0, 200.0], [800.0, 600.0]]).unwrap_err();
    assert_eq!(error, "plate 3: at_km = [800, 600] lies on a plate that an earlier entry has");
}

#[test]
fn an_entry_changes_the_crust_of_its_plate() {
    let world = first_step(&[[200.0, 200.0]]).unwrap();
    let (ids, kinds) = (world.layer(Layer::PlateId).unwrap(), world.layer(Layer::CrustKind).unwrap());
    let red = ids.at(6, 6);
    for (id, kind) in ids.data.iter().zip(&kinds.data).filter(|(id, _)| **id == red) {
        assert!(*kind > 0.49, "{id}: {kind}");
    }
}
