//! Exports as points: particles of a recording, smoke of a world, at a moment or as a series of files.

use std::path::Path;

use crate::{
    bake::Player,
    export::{
        POINT_FORMATS, PointFormat, Points,
        video::{NumberedFolder, Pattern},
        write_whole,
    },
    world::{Layer, Plume, World},
};

use super::{super::is_recording, ExportRequest, Exported, JobError, names, open_world, order::refuse};

/// What `--layer` calls the smoke of a world.
const SMOKE: &str = "plumes";
/// Most files of a series: a slip of the finger fills no disk.
const MOST_FILES: f64 = 1e5;
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
    Particles(Box<Player>),
    Smoke { world: World, plumes: Vec<Plume>, from_yr: f64 },
}

impl Source {
    fn open(request: &ExportRequest) -> Result<Self, JobError> {
        if is_recording(&request.world) {
            return Ok(Self::Particles(Box::new(Player::open(&request.world)?)));
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
            // Years are good to a microsecond or so.
            Self::Smoke { world, from_yr, .. } => ((world.time_yr - from_yr) * YEAR_S * 1e3).round().max(0.0) / 1e3,
        }
    }

    /// Refuses a moment behind the last.
    fn check(&self, request: &ExportRequest, time_s: f64) -> Result<(), JobError> {
        let last_s = self.last_s();
        if time_s <= last_s + SLACK {
            return Ok(());
        }
        let (world, what) = match self {
            Self::Particles(_) => (request.world.display(), "it lasts"),
            Self::Smoke { .. } => (request.world.display(), "smoke lasts until the world ends,"),
        };
        refuse(format!("{world}: there is no moment {time_s} s: {what} from 0 to {last_s} s"))
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
    if let Some(every_s) = request.every_s {
        return series(request, format, &mut source, every_s);
    }
    let time_s = request.at_s.unwrap_or(source.last_s());
    source.check(request, time_s)?;
    let points = source.at(time_s)?;
    names::check(std::slice::from_ref(&request.file), request.force)?;
    write_whole(&request.file, |out| points.fill(format, &request.file, out))?;
    let none = points.is_empty().then(|| source.nothing(time_s));
    Ok(Exported { files: vec![request.file.clone()], notes: none.into_iter().collect() })
}

/// Fills a new folder with numbered files, from 1, as films do.
fn series(
    request: &ExportRequest,
    format: PointFormat,
    source: &mut Source,
    every_s: f64,
) -> Result<Exported, JobError> {
    let file = request.file.display();
    let ending = request.file.extension().unwrap_or_default().to_string_lossy();
    let name = request.file.file_name().unwrap_or_default().to_string_lossy();
    let folder = request.file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let (Some(pattern), Some(folder)) = (Pattern::parse(&name), folder) else {
        return refuse(format!("{file}: name a new folder and number the files in it, as in points/%05d.{ending}"));
    };
    let moments = moments(request, source, every_s)?;
    let filled = NumberedFolder::begin(folder)?;
    for (number, &time_s) in (1..).zip(&moments) {
        let (name, points) = (pattern.name(number), source.at(time_s)?);
        write_whole(&filled.path().join(&name), |out| points.fill(format, &folder.join(&name), out))?;
    }
    let folder = filled.finish()?;
    let (files, [from_s, to_s]) = (moments.len(), [moments[0], moments[moments.len() - 1]]);
    Ok(Exported { files: vec![folder], notes: vec![format!("{files} files, from {from_s} to {to_s} s")] })
}

/// The moments of a series, s: at least one.
fn moments(request: &ExportRequest, source: &Source, every_s: f64) -> Result<Vec<f64>, JobError> {
    let (from_s, last_s) = (request.at_s.unwrap_or(0.0), source.last_s());
    source.check(request, from_s)?;
    let files = ((last_s - from_s) / every_s + SLACK).floor().max(0.0) + 1.0;
    if files > MOST_FILES {
        let least_s = (last_s - from_s) / (MOST_FILES - 1.0);
        return refuse(format!(
            "--every {every_s}: that would be {files:.0} files, {MOST_FILES:.0} at most; take {least_s:.1e} s or more"
        ));
    }
    Ok((0..files as u32).map(|k| (from_s + f64::from(k) * every_s).min(last_s)).collect())
}
