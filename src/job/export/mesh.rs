//! Exports of meshes: the whole map or a window of it, as triangles.

use std::path::Path;

use crate::{
    export::{
        MESH_FORMATS, MESH_SIDES, MeshFormat, MeshOptions,
        raster::{Lattice, Sampling},
        write_mesh,
    },
    world::{Layer, World},
};

use super::{ExportRequest, Exported, JobError, names, open_world, order::refuse, place::check_window};

/// The mesh format that a file's ending asks for.
pub fn format(file: &Path) -> Option<MeshFormat> {
    let ending = file.extension()?.to_str()?;
    MESH_FORMATS.iter().find(|(known, _)| known.eq_ignore_ascii_case(ending)).map(|&(_, format)| format)
}

/// Writes a mesh.
pub fn export(request: &ExportRequest, format: MeshFormat) -> Result<Exported, JobError> {
    check(request)?;
    let (world, _) = open_world(&request.world)?;
    let world = match request.window {
        Some(window) => {
            check_window(window, &world)?;
            let cells = ((window.size_m / world.grid.cell_m).round() as usize).max(1);
            cut(&world, &Lattice::over(&world.grid, Some(window), cells, Sampling::Cells))
        }
        None => world,
    };
    let file = request.file.clone();
    names::check(std::slice::from_ref(&file), request.force)?;
    let options = MeshOptions::default();
    let options = MeshOptions { size: request.size.unwrap_or(options.size), ..options };
    write_mesh(&world, &options, format, &file)?;
    Ok(Exported { files: vec![file], notes: Vec::new() })
}

fn check(request: &ExportRequest) -> Result<(), JobError> {
    request.refuse_flags_but(&["--size"], "meshes")?;
    let [fewest, most] = MESH_SIDES;
    match request.size {
        Some(size) if !(fewest..=most).contains(&size) => {
            refuse(format!("--size {size}: a mesh has {fewest} to {most} points a side"))
        }
        _ => Ok(()),
    }
}

/// A part of the ground as a world of its own.
fn cut(world: &World, lattice: &Lattice) -> World {
    let height = lattice.read(&world.height());
    let mut part = World::new(height.grid, world.sea_level_m);
    part.set_layer(Layer::Bedrock, height);
    part
}
