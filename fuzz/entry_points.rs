//! What is fed with hostile bytes: by the fuzz targets without end, by `tests/hostile` a few hundred times.
//!
//! An entry point panics where a promise is broken: an error of more than one line, a height that is no number.

use std::path::{Path, PathBuf};

use upthrust::{
    edit::{Endian, ImportParams, SourceFormat},
    grid::{Edges, Field, Grid},
    recipe::{Overrides, Plan, Source},
    world::{
        Column, Layer, Table, Values, World,
        store::{self, Provenance},
    },
};

fn one_line(error: &dyn std::fmt::Display) {
    let line = error.to_string();
    assert!(!line.is_empty() && !line.contains('\n'), "{line:?}");
}

/// A recipe's text.
pub fn recipe(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let source = Source { name: "fuzz".into(), file: "fuzz.toml".into(), folder: PathBuf::new(), text };
    match Plan::new(&source, &Overrides::default()) {
        Ok(plan) => assert!(plan.world.grid().cells() > 0),
        Err(error) => one_line(&error),
    }
}

/// The names under which bytes are imported.
pub const NAMES: [&str; 7] = ["f.png", "f.tif", "f.exr", "f.r16", "f.r32", "f.asc", "f.hgt"];

/// A heightmap: the first byte picks the name, the rest is the file.
pub fn import(bytes: &[u8]) {
    let Some((&pick, file)) = bytes.split_first() else { return };
    let name = NAMES[pick as usize % NAMES.len()];
    let endian = if pick >= 128 { Endian::Big } else { Endian::Little };
    let params = ImportParams { endian, format: SourceFormat::Auto, ..Default::default() };
    match params.read_bytes(name, file.to_vec()) {
        Ok(map) => {
            assert_eq!(map.heights.len(), map.width * map.height);
            assert!(map.heights.iter().all(|v| v.is_finite()));
        }
        Err(error) => one_line(&error),
    }
}

/// A small sound store and its files.
pub struct Shelf {
    store: PathBuf,
    /// Path and content of each file, sorted.
    pub files: Vec<(PathBuf, Vec<u8>)>,
}

impl Shelf {
    /// Writes a store into a folder.
    pub fn new(folder: &Path) -> Self {
        let grid = Grid::new(40, 24, 4000.0, Edges::Open);
        let mut world = World::new(grid, 0.0);
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, |x, y| (x * y) as f32 * 1.5 - 80.0));
        world.set_layer(Layer::PlateId, Field::from_fn(grid, |x, _| (x / 20) as f32));
        let mut table = Table::new("peaks");
        let column = |name: &str, unit: &str, values| Column { name: name.into(), unit: unit.into(), values };
        table.columns.push(column("height_m", "m", Values::Number(vec![812.0, 640.5])));
        table.columns.push(column("name", "", Values::Text(vec!["a".into(), "b".into()])));
        world.set_table(table);
        let store = folder.join("world.zarr");
        store::write(&world, &Provenance::default(), &store).expect("a sound world can be written");
        let mut files = Vec::new();
        walk(&store, &mut files);
        files.sort();
        Self { store, files }
    }

    /// Puts bytes in the place of one file (the first byte picks it), reads the store, and mends it again.
    pub fn read_with(&self, bytes: &[u8]) {
        let Some((&pick, content)) = bytes.split_first() else { return };
        let (path, sound) = &self.files[pick as usize % self.files.len()];
        std::fs::write(path, content).expect("the folder can be written to");
        let read = store::read(&self.store);
        std::fs::write(path, sound).expect("the folder can be written to");
        match read {
            Ok((world, _)) => assert!(world.first_non_finite().is_none()),
            Err(error) => one_line(&error),
        }
    }
}

fn walk(folder: &Path, into: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in std::fs::read_dir(folder).expect("the store is a folder") {
        let path = entry.expect("the store can be listed").path();
        if path.is_dir() {
            walk(&path, into);
        } else {
            let content = std::fs::read(&path).expect("the store can be read");
            into.push((path, content));
        }
    }
}
