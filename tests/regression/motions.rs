//! Plates that a user painted: each is found where it was painted, and begins to move as it was told.

use std::{collections::BTreeMap, path::Path};

use upthrust::{
    recipe::find_preset,
    world::{Layer, World},
};

use super::grown;

fn plate_at(world: &World, at_km: [f64; 2]) -> f32 {
    let [x, y] = at_km.map(|km| (km * 1e3 / world.grid.cell_m) as usize);
    world.layer(Layer::PlateId).unwrap().at(x, y)
}

#[test]
fn painted_plates_are_found_and_move_as_told() {
    let preset = find_preset("my-continents").unwrap();
    // So early that nothing has moved by a cell.
    let (plan, world) = grown(preset, "160", &["plates.duration_myr=0.02"]);
    let picture = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/my-plates.png");
    let picture = image::open(picture).unwrap().into_rgb8();
    let ids = world.layer(Layer::PlateId).unwrap();

    // Which plate each colour became, and how many of its cells.
    let mut found: BTreeMap<[u8; 3], BTreeMap<u32, usize>> = BTreeMap::new();
    for y in 0..world.grid.height {
        for x in 0..world.grid.width {
            let pixel = |at: usize, cells: usize, size: u32| ((at as f64 + 0.5) / cells as f64 * size as f64) as u32;
            let colour = picture
                .get_pixel(pixel(x, world.grid.width, picture.width()), pixel(y, world.grid.height, picture.height()));
            *found.entry(colour.0).or_default().entry(ids.at(x, y) as u32).or_default() += 1;
        }
    }
    let mut plates: Vec<u32> = Vec::new();
    for (colour, cells) in found.iter().filter(|(_, cells)| cells.values().sum::<usize>() > 256) {
        let (&plate, &most) = cells.iter().max_by_key(|(_, count)| **count).unwrap();
        let share = most as f64 / cells.values().sum::<usize>() as f64;
        // Borders are read to a tectonic cell, which is wider than a pixel.
        assert!(share > 0.95, "{colour:?}: {share} of it on plate {plate}");
        assert!(!plates.contains(&plate), "two colours on plate {plate}");
        plates.push(plate);
    }
    let colours = picture.pixels().map(|p| p.0).collect::<std::collections::BTreeSet<_>>();
    assert!(plates.len() > 2 && plates.len() <= colours.len());

    let table = world.table("plates").unwrap();
    let entries = plan.stages[0].params["plate"].as_array().unwrap();
    assert!(!entries.is_empty());
    for entry in entries {
        let number = |key: &str| entry[key].as_f64().unwrap();
        let at_km = [0, 1].map(|k| entry["at_km"][k].as_f64().unwrap());
        let row = plate_at(&world, at_km) as usize;
        let column = |name: &str| table.numbers(name).unwrap()[row];
        let turned = (column("first_heading_deg") - number("heading_deg")).rem_euclid(360.0);
        assert!(turned.min(360.0 - turned) < 0.1, "{entry}: first heading {}", column("first_heading_deg"));
        let speed = number("speed_mm_per_yr");
        assert!((column("first_speed_mm_per_yr") / speed - 1.0).abs() < 1e-3, "{entry}");
        assert!((column("speed_mm_per_yr") / speed - 1.0).abs() < 0.05, "{entry}: soon after");
    }
}
