//! Exports of vector maps: the whole map or a window of it, as lines and polygons.

use std::path::Path;

use crate::{
    export::{VECTOR_FORMATS, VectorFormat, VectorOptions, write_vector},
    world::World,
};

use super::{ExportRequest, Exported, JobError, names, open_world, order::refuse, place::check_window};

/// More contours than these make a black map.
const MOST_CONTOURS: f64 = 400.0;

/// The vector format that a file's ending asks for.
pub fn format(file: &Path) -> Option<VectorFormat> {
    let ending = file.extension()?.to_str()?;
    VECTOR_FORMATS.iter().find(|(known, _)| known.eq_ignore_ascii_case(ending)).map(|&(_, format)| format)
}

/// Writes a vector map.
pub fn export(request: &ExportRequest, format: VectorFormat) -> Result<Exported, JobError> {
    request.refuse_flags_but(&["--contours"], "vector maps")?;
    let (world, provenance) = open_world(&request.world)?;
    if let Some(window) = request.window {
        check_window(window, &world)?;
    }
    check_contours(request.contours_m, &world)?;
    let file = request.file.clone();
    names::check(std::slice::from_ref(&file), request.force)?;
    let options = VectorOptions { window: request.window, contours_m: request.contours_m, title: provenance.name };
    write_vector(&world, &options, format, &file)?;
    let mut notes = Vec::new();
    if world.table("rivers").is_none() {
        notes.push("this world has no rivers; a stage 'rivers' at the end of its recipe finds them".to_owned());
    }
    Ok(Exported { files: vec![file], notes })
}

fn check_contours(contours_m: Option<f64>, world: &World) -> Result<(), JobError> {
    let Some(interval_m) = contours_m else { return Ok(()) };
    if !(interval_m.is_finite() && interval_m > 0.0) {
        return refuse(format!("--contours {interval_m}: must be above 0 m"));
    }
    let span_m = world.height().range().map_or(0.0, |(low, high)| (high - low) as f64);
    if span_m / interval_m > MOST_CONTOURS {
        let least = span_m / MOST_CONTOURS;
        return refuse(format!("--contours {interval_m}: makes too many over {span_m:.0} m; at least {least:.1} m"));
    }
    Ok(())
}
