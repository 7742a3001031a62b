//! Bare numbers: `.r16` and `.raw` hold 16-bit values, `.r32` floating point, row by row. Size, byte order, order of
//! rows and range stand in no such file, so the sidecar says them.

use std::io::Write;

use super::{Layout, Out, Raster, Samples};

pub(super) fn encode(raster: &Raster, layout: Layout, out: &mut Out) -> Result<(), String> {
    let width = raster.lattice.width * raster.channels;
    let rows = raster.lattice.height;
    let mut bytes = Vec::with_capacity(width * 4);
    for i in 0..rows {
        let y = if layout.south_first { rows - 1 - i } else { i };
        bytes.clear();
        match &raster.samples {
            Samples::U8(all) => bytes.extend_from_slice(&all[y * width..][..width]),
            Samples::U16(all) => bytes.extend(
                all[y * width..][..width]
                    .iter()
                    .flat_map(|v| if layout.big_endian { v.to_be_bytes() } else { v.to_le_bytes() }),
            ),
            Samples::F32(all) => bytes.extend(
                all[y * width..][..width]
                    .iter()
                    .flat_map(|v| if layout.big_endian { v.to_be_bytes() } else { v.to_le_bytes() }),
            ),
        }
        out.write_all(&bytes).map_err(|e| e.to_string())?;
    }
    Ok(())
}
