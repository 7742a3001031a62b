//! `export`: a world that is on disk becomes files for other programs, all of them or none.
//!
//! The order of things: [`order`] checks what was asked without opening the world, [`place`] finds where the samples lie,
//! [`names`] says which files there will be, [`draw`] makes the rasters, and [`sidecar`] says in JSON what the files
//! cannot say themselves. Meshes, vector maps and points go other ways, [`mesh`], [`vector`] and [`points`].

mod draw;
mod mesh;
mod names;
mod order;
mod place;
mod points;
mod sidecar;
mod vector;

use std::path::PathBuf;

use crate::{
    export::{
        self, Green,
        engine::{COARSE_M, Engine, Part, zooms},
        raster::Window,
    },
    world::Layer,
};

use super::{JobError, open_world};

use draw::Drawing;
use order::Order;

/// What is to be exported.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportRequest {
    /// The world's folder, or the store in it.
    pub world: PathBuf,
    /// The file; its ending gives the format.
    pub file: PathBuf,
    /// A layer's name, `normals` or `weights`.
    pub layer: String,
    /// The program it is for.
    pub engine: Option<Engine>,
    /// The part of the map; all of it if absent.
    pub window: Option<Window>,
    /// Samples along the longer side, or along a tile; what suits the world if absent.
    pub size: Option<usize>,
    /// What black and white stand for; the least and greatest value if absent.
    pub range: Option<[f64; 2]>,
    /// Tiles along a side.
    pub tiles: Option<usize>,
    /// Bits of a sample; the format's usual ones if absent.
    pub bits: Option<u32>,
    /// Bare numbers with the most significant byte first.
    pub big_endian: bool,
    /// Bare numbers with the southern row first.
    pub south_first: bool,
    /// Where green points in a normal map; as the engine likes it if absent.
    pub green: Option<Green>,
    /// Metres between the contours of a vector map; a round number that suits the land if absent.
    pub contours_m: Option<f64>,
    /// The moment of a recording of particles or of smoke, or where a series of them begins, s.
    pub at_s: Option<f64>,
    /// Time between the files of a series, s; one file if absent.
    pub every_s: Option<f64>,
    /// Replace files that are there.
    pub force: bool,
}

impl ExportRequest {
    /// Refuses what was asked for besides world, file, window and `allowed`, since it does not go with such files.
    fn refuse_flags_but(&self, allowed: &[&str], files: &str) -> Result<(), JobError> {
        let given = [
            ("--layer", self.layer != Layer::Height.name()),
            ("--engine", self.engine.is_some()),
            ("--size", self.size.is_some()),
            ("--range", self.range.is_some()),
            ("--tiles", self.tiles.is_some()),
            ("--bits", self.bits.is_some()),
            ("--big-endian", self.big_endian),
            ("--flip", self.south_first),
            ("--normal-y", self.green.is_some()),
            ("--contours", self.contours_m.is_some()),
        ];
        match given.iter().find(|(flag, given)| *given && !allowed.contains(flag)) {
            Some((flag, _)) => order::refuse(format!("{}: {flag} does not go with {files}", self.file.display())),
            None => Ok(()),
        }
    }
}

/// What was exported.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The files, the sidecar last.
    pub files: Vec<PathBuf>,
    /// What the user should know about them.
    pub notes: Vec<String>,
}

/// Writes the files; nothing is left of an export that fails.
pub fn export(request: &ExportRequest) -> Result<Exported, JobError> {
    if let Some(format) = points::asked(request)? {
        return points::export(request, format);
    }
    if let Some(format) = mesh::format(&request.file) {
        return mesh::export(request, format);
    }
    if let Some(format) = vector::format(&request.file) {
        return vector::export(request, format);
    }
    let order = Order::check(request)?;
    let (world, provenance) = open_world(&request.world)?;
    order.check_world(&world)?;
    let place = place::find(&order, &world)?;
    let sheets = names::sheets(&order);
    let paths = names::all(&order, &sheets, &place);
    names::check(&paths, request.force)?;

    let mut staged = export::Staged::default();
    let drawing = Drawing::of(&order, &world, &place)?;
    for sheet in &sheets {
        let raster = drawing.raster(sheet);
        for tile in place.tiles() {
            let [x, y, width, height] = place.samples(sheet, tile, &raster);
            let part = if place.tiles == 1 { None } else { Some(raster.part(x, y, width, height)) };
            let path = names::path(&order, sheet, tile, &place);
            let part = part.as_ref().unwrap_or(&raster);
            staged.write(&path, |out| sheet.format.fill(part, order.layout, &path, out))?;
        }
    }
    if order.needs_unreal_raw_json() {
        for tile in place.tiles() {
            let path = names::unreal_raw_json(&order, tile, &place);
            write_text(&mut staged, &path, &sidecar::unreal_raw(&place))?;
        }
    }
    let said = sidecar::Sidecar::new(&order, &place, &drawing, &world, &provenance);
    let said = said.listing(names::files(&paths));
    write_text(&mut staged, &names::sidecar(&request.file), &said.text())?;
    let files = staged.finish()?;
    Ok(Exported { files, notes: notes(&order, &place, &drawing, &world) })
}

fn write_text(staged: &mut export::Staged, path: &std::path::Path, text: &str) -> Result<(), JobError> {
    use std::io::Write;
    let disk = |cause| export::ExportError::Disk { path: path.to_owned(), cause };
    Ok(staged.write(path, |out| out.write_all(text.as_bytes()).map_err(disk))?)
}

fn notes(order: &Order, place: &place::Place, drawing: &Drawing, world: &crate::world::World) -> Vec<String> {
    let mut notes = Vec::new();
    let spacing_m = place.lattice.spacing_m;
    let playable = order.request.engine.is_some_and(|engine| engine != Engine::Azgaar);
    let cell_m = world.grid.cell_m;
    if playable && spacing_m > COARSE_M {
        notes.push(format!(
            "{} between vertices is coarse for a player on foot (1 to 10 m are usual); cut a part with --window X_KM,Y_KM,SIZE_KM",
            metres(spacing_m)
        ));
    }
    if playable && cell_m > COARSE_M {
        let lattice = &place.lattice;
        let side_m = lattice.spacing_m * lattice.width.max(2).saturating_sub(1) as f64;
        let part = Part { middle_m: lattice.corner_m.map(|m| m + 0.5 * side_m), side_m };
        notes.push(format!(
            "the world's cells are {}; to have land as fine as a player sees it, add to the end of the recipe:{}",
            metres(cell_m),
            zooms(world.grid.extent_m(), lattice.width, part)
        ));
    }
    if spacing_m < cell_m * 0.67 {
        notes.push(format!(
            "samples are {} apart, the world's cells {}: a smooth surface lies between, without new detail",
            metres(spacing_m),
            metres(cell_m)
        ));
    }
    if drawing.outside > 0.0 {
        notes.push(format!(
            "{:.2} % of the samples lie outside --range and became black or white",
            drawing.outside * 100.0
        ));
    }
    notes
}

/// A length as people write it.
fn metres(m: f64) -> String {
    if m >= 100.0 { format!("{m:.0} m") } else { format!("{m:.2} m") }
}

#[cfg(test)]
mod tests;
