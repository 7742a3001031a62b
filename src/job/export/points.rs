//! Exports as points: particles of a recording, smoke of a world, at a moment or as a series of files.

use std::path::{Path, PathBuf};

use crate::{
    bake::Player,
    export::{self, POINT_FORMATS, PointFormat, Points},
    world::{Layer, Plume, World},
};

use super::{super::is_recording, ExportRequest, Exported, JobError, names, open_world, order::refuse};

/// What `--layer` calls the smoke of a world.
const SMOKE: &str = "plumes";
/// Most files of a series: as many as its numbers have digits for.
const MOST_FILES: f64 = 99_999.0;
/// Digits of a number where the name does not say.
const DIGITS: usize = 5;
/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;
/// Times are counted in floating point.
const SLACK: f64 = 1e-6;

/// The point format that a file's ending asks for.
pub fn format(file: &Path) -> Option<PointFormat> {
    let ending = file.extension()?.to_str()?;
    POINT_FORMATS.iter().find(|(known, _)| known.eq_ignore_ascii_case(ending)).map(|&(_, format)| format)
}

/// Whether points are asked for, or asked of what has none.
pub fn asked(request: &ExportRequest) -> Result<Option<PointFormat>, JobError> {
    let (format, recording, smoke) = (format(&request.file), is_recording(&request.world), request.layer == SMOKE);
    let timed = request.at_s.is_some() || request.every_s.is_some();
    let (world, file) = (request.world.display(), request.file.display());
    match (format, recording) {
        (Some(_), true) if !timed => {
            refuse(format!("{file}: name the moment with --at SECONDS, or write a series with --every SECONDS"))
        }
        (Some(_), false) if !smoke => refuse(format!(
            "{file}: such files hold particles, and {world} is no recording of them; bake one with grow --bake, or ask \
             for smoke with --layer {SMOKE}"
        )),
        (Some(_), _) => Ok(format),
        (None, true) => refuse(format!("{file}: a recording of particles becomes .ply or .csv")),
        (None, false) if smoke => refuse(format!("{file}: smoke becomes .ply or .csv")),
        (None, false) if timed => {
            let flag = if request.at_s.is_some() { "--at" } else { "--every" };
            refuse(format!("{flag} is about the time of a recording of particles, or of smoke, which this is not"))
        }
        (None, false) => Ok(None),
    }
}

/// What points come from.
enum Source {
    Particles(Player),
    Smoke { world: World, plumes: Vec<Plume>, from_yr: f64 },
}

impl Source {
    fn open(request: &ExportRequest) -> Result<Self, JobError> {
        if is_recording(&request.world) {
            return Ok(Self::Particles(Player::open(&request.world)?));
        }
        let (world, _) = open_world(&request.world)?;
        let plumes = world.plumes();
        let from_yr = plumes.iter().map(|plume| plume.begin_yr).fold(f64::INFINITY, f64::min);
        if plumes.is_empty() {
            return refuse(format!("{}: no vent of this world ever smoked", request.world.display()));
        }
        Ok(Self::Smoke { world, plumes, from_yr })
    }

    /// Its last moment, s: of a recording since its stage began, of smoke since the first did.
    fn last_s(&self) -> f64 {
        match self {
            Self::Particles(player) => player.header().last_s(),
            Self::Smoke { world, from_yr, .. } => ((world.time_yr - from_yr) * YEAR_S).max(0.0),
        }
    }

    fn at(&mut self, time_s: f64) -> Result<Points, JobError> {
        match self {
            Self::Particles(player) => {
                let particles = player.at(time_s)?;
                let header = player.header();
                Ok(Points::particles(&particles, header.radius_m, header.extent_m, time_s))
            }
            Self::Smoke { world, plumes, from_yr } => {
                let time_yr = *from_yr + time_s / YEAR_S;
                let puffs: Vec<_> = (plumes.iter().enumerate())
                    .flat_map(|(k, plume)| plume.puffs(time_yr).into_iter().map(move |puff| (k, puff)))
                    .collect();
                Ok(Points::puffs(&puffs, world.grid.extent_m(), time_s))
            }
        }
    }

    /// What to say of a moment at which there is nothing.
    fn nothing(&self, time_s: f64) -> String {
        match self {
            Self::Particles(_) => format!("no particle flows at {time_s} s"),
            Self::Smoke { plumes, from_yr, .. } => {
                let end_yr = plumes.iter().map(|plume| plume.end_yr).fold(f64::NEG_INFINITY, f64::max);
                let end_s = (end_yr - from_yr) * YEAR_S;
                format!(
                    "no smoke is in the air at {time_s:.1} s; it leaves the vents from 0 to {end_s:.1} s: name a \
                     moment with --at"
                )
            }
        }
    }
}

/// Writes the points of a moment, or a file for each of many.
pub fn export(request: &ExportRequest, format: PointFormat) -> Result<Exported, JobError> {
    request.refuse_flags_but(&["--layer"], "points")?;
    let file = request.file.display();
    if request.window.is_some() {
        return refuse(format!("{file}: --window does not go with points"));
    }
    if is_recording(&request.world) && request.layer != Layer::Height.name() {
        return refuse(format!("{file}: --layer does not go with a recording of particles"));
    }
    let mut source = Source::open(request)?;
    let moments = moments(request, &source)?;
    let paths = paths(request, moments.len());
    names::check(&paths, request.force)?;
    let mut staged = export::Staged::default();
    let mut notes = Vec::new();
    for (path, &time_s) in paths.iter().zip(&moments) {
        let points = source.at(time_s)?;
        if points.is_empty() && moments.len() == 1 {
            notes.push(source.nothing(time_s));
        }
        staged.write(path, |out| points.fill(format, path, out))?;
    }
    Ok(Exported { files: staged.finish()?, notes })
}

/// The moments that are asked for, s.
fn moments(request: &ExportRequest, source: &Source) -> Result<Vec<f64>, JobError> {
    let (last_s, smoke) = (source.last_s(), matches!(source, Source::Smoke { .. }));
    if let (true, Some(at_s)) = (smoke, request.at_s)
        && at_s > last_s + SLACK
    {
        let world = request.world.display();
        return refuse(format!("--at {at_s}: smoke of {world} lasts from 0 to {last_s:.1} s, when the world ends"));
    }
    let Some(every_s) = request.every_s else { return Ok(vec![request.at_s.unwrap_or(last_s)]) };
    let from_s = request.at_s.unwrap_or(0.0);
    let files = ((last_s - from_s) / every_s + SLACK).floor() + 1.0;
    if files > MOST_FILES {
        let least_s = (last_s - from_s) / (MOST_FILES - 1.0);
        return refuse(format!(
            "--every {every_s}: that would be {files:.0} files, {MOST_FILES:.0} at most; take {least_s:.1e} s or more"
        ));
    }
    // A series that begins behind the end has one moment, which the recording refuses.
    let files = files.max(1.0) as usize;
    let within = |at_s: f64| if from_s <= last_s { at_s.min(last_s) } else { at_s };
    Ok((0..files).map(|k| within(from_s + k as f64 * every_s)).collect())
}

/// The files: the one that is named, or for a series the name with a number, from 1. It takes the place of the last `#`s of
/// the name, as many digits as there are; without any it stands before the ending.
fn paths(request: &ExportRequest, files: usize) -> Vec<PathBuf> {
    if request.every_s.is_none() {
        return vec![request.file.clone()];
    }
    let name = request.file.file_name().unwrap_or_default().to_string_lossy();
    let (before, digits, behind) = match name.rfind('#') {
        Some(last) => {
            let first = name[..last].trim_end_matches('#').len();
            (name[..first].to_owned(), last + 1 - first, name[last + 1..].to_owned())
        }
        None => {
            let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
            let [stem, ending] = [request.file.file_stem(), request.file.extension()].map(part);
            (format!("{stem}_"), DIGITS, format!(".{ending}"))
        }
    };
    (1..=files).map(|k| request.file.with_file_name(format!("{before}{k:0digits$}{behind}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_numbered_where_the_name_says_so() {
        let names = |file: &str, every_s: Option<f64>, files: usize| -> Vec<String> {
            let request = ExportRequest { file: file.into(), every_s, ..ExportRequest::default() };
            paths(&request, files).iter().map(|path| path.display().to_string()).collect()
        };
        assert_eq!(names("a/p#.ply", None, 1), ["a/p#.ply"]);
        assert_eq!(names("a/p.ply", Some(1.0), 2), ["a/p_00001.ply", "a/p_00002.ply"]);
        assert_eq!(names("a/###.csv", Some(1.0), 1), ["a/001.csv"]);
        assert_eq!(names("a#b##c.ply", Some(1.0), 1), ["a#b01c.ply"]);
        // More than the digits hold: the name grows, and none is written twice.
        assert_eq!(names("#.ply", Some(1.0), 10)[8..], ["9.ply", "10.ply"]);
    }
}
