//! Exports of a recording: its particles at a moment, as points.

use std::path::Path;

use crate::{
    bake::Player,
    export::{POINT_FORMATS, PointFormat, Points, write_points},
};

use super::{super::is_recording, ExportRequest, Exported, JobError, names, order::refuse};

/// The point format that a file's ending asks for.
pub fn format(file: &Path) -> Option<PointFormat> {
    let ending = file.extension()?.to_str()?;
    POINT_FORMATS.iter().find(|(known, _)| known.eq_ignore_ascii_case(ending)).map(|&(_, format)| format)
}

/// Whether points are asked for, or asked of a recording; an error where one is and the other is not.
pub fn asked(request: &ExportRequest) -> Result<Option<PointFormat>, JobError> {
    let (format, recording) = (format(&request.file), is_recording(&request.world));
    let (world, file) = (request.world.display(), request.file.display());
    match (format, recording, request.at_s) {
        (Some(_), true, None) => refuse(format!("{file}: name the moment with --at SECONDS")),
        (Some(_), true, Some(_)) => Ok(format),
        (None, true, _) => refuse(format!("{file}: a recording of particles becomes .ply or .csv")),
        (Some(_), false, _) => refuse(format!(
            "{file}: such files hold particles, and {world} is no recording of them; bake one with grow --bake"
        )),
        (None, false, Some(_)) => refuse("--at names a moment of a recording of particles, which this is not"),
        (None, false, None) => Ok(None),
    }
}

/// Writes the particles of a moment.
pub fn export(request: &ExportRequest, format: PointFormat) -> Result<Exported, JobError> {
    request.refuse_flags_but(&[], "points")?;
    if request.window.is_some() {
        return refuse(format!("{}: --window does not go with points", request.file.display()));
    }
    let mut player = Player::open(&request.world)?;
    let time_s = request.at_s.unwrap_or_default();
    let particles = player.at(time_s)?;
    names::check(std::slice::from_ref(&request.file), request.force)?;
    let header = player.header();
    let points = Points { particles: &particles, radius_m: header.radius_m, extent_m: header.extent_m, time_s };
    write_points(&points, format, &request.file)?;
    let none = particles.is_empty().then(|| format!("no particle flows at {time_s} s"));
    Ok(Exported { files: vec![request.file.clone()], notes: none.into_iter().collect() })
}
