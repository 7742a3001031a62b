//! ESRI ASCII grid: a header of six lines at most, then a line a row from the north. Numbers are the shortest that read
//! back to the same 32-bit value.

use std::io::Write;

use super::{Layout, Out, Raster, Samples, Sampling};

pub(super) fn encode(raster: &Raster, _: Layout, out: &mut Out) -> Result<(), String> {
    let Samples::F32(values) = &raster.samples else { return Err("an ASCII grid holds the quantity itself".into()) };
    write(raster, values, out).map_err(|e| e.to_string())
}

fn write(raster: &Raster, values: &[f32], out: &mut Out) -> std::io::Result<()> {
    let lattice = &raster.lattice;
    // The south-west corner, or the south-west sample where samples are points; northings count from the map's south.
    let anchor = if lattice.sampling == Sampling::Cells { "corner" } else { "center" };
    let south_m = lattice.map_height_m - lattice.corner_m[1] - lattice.extent_m()[1];
    // A sum of roundings is no height above the map's edge.
    let south_m = if south_m.abs() < 1e-9 * lattice.map_height_m { 0.0 } else { south_m };
    writeln!(out, "ncols {}\nnrows {}", lattice.width, lattice.height)?;
    writeln!(out, "xll{anchor} {}\nyll{anchor} {}", lattice.corner_m[0], south_m)?;
    writeln!(out, "cellsize {}", lattice.spacing_m)?;
    for row in values.chunks_exact(lattice.width.max(1)) {
        let mut gap = "";
        for value in row {
            write!(out, "{gap}{value}")?;
            gap = " ";
        }
        writeln!(out)?;
    }
    Ok(())
}
