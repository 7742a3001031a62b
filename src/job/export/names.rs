//! Which files an export makes, and what they are called.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::export::{
    MATERIALS,
    engine::{Engine, WeightFiles},
    raster::Format,
};

use super::{
    JobError,
    order::{Order, refuse},
    place::Place,
};

/// What a sheet of an export shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// What was asked for.
    Asked,
    /// One material's weights, by its place among them.
    Material(usize),
    /// The weights of all materials, a pixel a quad.
    FourChannels,
}

/// One raster of an export: a file, or a file a tile.
#[derive(Debug)]
pub struct Sheet {
    pub part: Part,
    pub format: &'static Format,
    /// What stands between the name that was asked for and the tile.
    infix: String,
}

/// The sheets of an export, what was asked for first.
pub fn sheets(order: &Order) -> Vec<Sheet> {
    let mut sheets = vec![Sheet { part: Part::Asked, format: order.format, infix: String::new() }];
    let Some(png) = Format::of(Path::new("weights.png")) else { return sheets };
    match order.weights() {
        WeightFiles::None => {}
        WeightFiles::OneEach => sheets.extend(MATERIALS.iter().enumerate().map(|(i, name)| Sheet {
            part: Part::Material(i),
            format: png,
            infix: format!("_{name}"),
        })),
        WeightFiles::FourChannels => {
            sheets.push(Sheet { part: Part::FourChannels, format: png, infix: "_weights".into() });
        }
    }
    sheets
}

/// A tile's file of a sheet.
pub fn path(order: &Order, sheet: &Sheet, (x, y): (usize, usize), place: &Place) -> PathBuf {
    let file = &order.request.file;
    let ending = match sheet.part {
        Part::Asked => file.extension().unwrap_or_default().to_string_lossy().into_owned(),
        _ => sheet.format.endings[0].to_owned(),
    };
    named(order, &sheet.infix, (x, y), place, &ending)
}

/// What Unreal wants to read beside a `.raw` file: its name with the ending `.json`.
pub fn unreal_raw_json(order: &Order, tile: (usize, usize), place: &Place) -> PathBuf {
    named(order, "", tile, place, "json")
}

fn named(order: &Order, infix: &str, (x, y): (usize, usize), place: &Place, ending: &str) -> PathBuf {
    let file = &order.request.file;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let suffix =
        if place.tiles == 1 { String::new() } else { Engine::tile_suffix(order.request.engine, x, y, place.tiles) };
    file.with_file_name(format!("{stem}{infix}{suffix}.{ending}"))
}

/// The description beside a file.
pub fn sidecar(file: &Path) -> PathBuf {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{name}.json"))
}

/// Every file of an export, the sidecar last.
pub fn all(order: &Order, sheets: &[Sheet], place: &Place) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> =
        sheets.iter().flat_map(|sheet| place.tiles().map(|tile| path(order, sheet, tile, place))).collect();
    if order.needs_unreal_raw_json() {
        paths.extend(place.tiles().map(|tile| unreal_raw_json(order, tile, place)));
    }
    paths.push(sidecar(&order.request.file));
    paths
}

/// The names of all but the sidecar, without their folder.
pub fn files(paths: &[PathBuf]) -> Vec<String> {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    paths[..paths.len().saturating_sub(1)].iter().map(name).collect()
}

/// Refuses early what could not be written at the end, and what is there already unless `force`.
pub fn check(paths: &[PathBuf], force: bool) -> Result<(), JobError> {
    for path in paths {
        let shown = path.display();
        match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            Some(folder) if !folder.is_dir() => {
                return refuse(format!("{shown}: there is no folder '{}'", folder.display()));
            }
            _ => {}
        }
        match fs::symlink_metadata(path) {
            Ok(found) if found.is_dir() => return refuse(format!("{shown}: this is a folder")),
            Ok(_) if !force => {
                return refuse(format!("{shown}: exists; choose another name, or replace it with --force"));
            }
            _ => {}
        }
    }
    Ok(())
}
