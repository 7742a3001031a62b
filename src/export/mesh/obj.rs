//! Wavefront OBJ: positions, normals and triangles as text.

use std::io::Write;

use super::{MeshOptions, ground, to_scale};
use crate::{export::ExportError, world::World};

/// Writes the ground as an `.obj`.
pub fn write_obj(world: &World, options: &MeshOptions, out: &mut impl Write) -> Result<(), ExportError> {
    let ground = ground(world)?;
    let lattice = to_scale(&ground, options, options.size);
    writeln!(out, "# Upthrust {}; x east, y up, z south", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "o terrain")?;
    for y in 0..lattice.height {
        for x in 0..lattice.width {
            let [east, up, south] = lattice.point(x, y);
            writeln!(out, "v {east} {up} {south}")?;
        }
    }
    for y in 0..lattice.height {
        for x in 0..lattice.width {
            let [east, up, south] = lattice.normal(x, y);
            writeln!(out, "vn {east:.5} {up:.5} {south:.5}")?;
        }
    }
    // Points count from 1, and each has its own normal.
    lattice.each_triangle(|corners| {
        let [a, b, c] = corners.map(|i| i + 1);
        writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")
    })?;
    Ok(())
}
