//! Validated commands: what holds one of these need not ask again.

use std::{ops::RangeInclusive, path::PathBuf, time::Duration};

use crate::{
    bake::RATES_PER_S,
    job::{
        BAKE_PER_S, Existing, ExportRequest, Picture, SHEET_MOST,
        film::{FilmRequest, FramesRequest},
    },
    recipe::{Overrides, Source, find_stage, nearest, stage_kinds},
    timeline,
    world::Layer,
};

use super::{
    CliError,
    arguments::{RawApp, RawCommand, RawGrow, RawInspect, RawParams},
    export, film, scene,
};

/// The recipe of a bare `grow`.
pub(crate) const DEFAULT_RECIPE: &str = "collision";

/// A command that can be done.
#[derive(Debug)]
pub(crate) enum Command {
    Grow(Box<Grow>),
    Presets(Option<String>),
    Params(Params),
    Inspect(RawInspect),
    Export(Box<ExportRequest>),
    Render(Box<Picture>),
    Film { world: PathBuf, film: Box<FilmRequest> },
    App(RawApp),
}

/// What `grow` is to do.
#[derive(Debug)]
pub(crate) struct Grow {
    pub source: Source,
    pub overrides: Overrides,
    pub threads: Option<usize>,
    pub voice: Voice,
    pub aim: Aim,
}

/// A world's folder or a sheet.
#[derive(Debug)]
pub(crate) enum Aim {
    Folder(Box<Folder>),
    Sheet { seeds: RangeInclusive<u64>, file: PathBuf },
}

/// A world's folder, and what is made while it grows.
#[derive(Debug)]
pub(crate) struct Folder {
    pub out: Option<PathBuf>,
    pub existing: Existing,
    pub checkpoint_every: Duration,
    pub until: Option<String>,
    pub film: Option<FilmRequest>,
    pub frames: Option<FramesRequest>,
    pub bake_per_s: Option<f64>,
    pub keep: Option<Vec<Layer>>,
}

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Voice {
    Normal,
    Quiet,
    Json,
}

/// What `params` is to print.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Params {
    All,
    World,
    Scene,
    Stage(&'static str),
    Schema,
    Markdown,
}

pub(super) fn wrong<T>(what: impl Into<String>) -> Result<T, CliError> {
    Err(CliError::Request(what.into()))
}

impl Command {
    /// Checks what was typed.
    pub fn validate(raw: RawCommand) -> Result<Self, CliError> {
        Ok(match raw {
            RawCommand::Grow(raw) => Command::Grow(Box::new(grow(*raw)?)),
            RawCommand::Presets { name } => Command::Presets(name),
            RawCommand::Params(raw) => Command::Params(params(raw)?),
            RawCommand::Inspect(raw) => Command::Inspect(raw),
            RawCommand::Export(raw) => Command::Export(Box::new(export::validate(*raw)?)),
            RawCommand::Render(raw) => {
                let scene = scene::request(&raw.scene, &raw.set, raw.size.as_deref())?;
                let (world, file) = (raw.world, raw.file);
                let picture = Picture { world, file, view: raw.view, overlay: raw.overlay, smoke: raw.smoke, scene };
                Command::Render(Box::new(picture))
            }
            RawCommand::Film(raw) => {
                let mut film = film::request(Some(raw.file), &raw.look, raw.force)?;
                film.scene.set = raw.set;
                film.seconds = raw.seconds.as_deref().map(scene::seconds).transpose()?;
                Command::Film { world: raw.world, film: Box::new(film) }
            }
            RawCommand::App(raw) => Command::App(raw),
        })
    }
}

fn grow(raw: RawGrow) -> Result<Grow, CliError> {
    let threads = raw.threads.as_deref().map(threads).transpose()?;
    let seed = raw.seed.as_deref().map(seed).transpose()?;
    let voice = match (raw.json, raw.quiet) {
        (true, _) => Voice::Json,
        (false, true) => Voice::Quiet,
        _ => Voice::Normal,
    };
    let aim = match (&raw.seeds, &raw.sheet) {
        (None, None) => {
            let existing = match (raw.force, raw.resume) {
                (true, true) => return wrong("--force starts anew and --resume goes on: give one of them"),
                (true, false) => Existing::Replace,
                (false, true) => Existing::Resume,
                (false, false) => Existing::Refuse,
            };
            let checkpoint_every = raw.checkpoint_every.as_deref().map_or(Ok(timeline::EVERY), seconds)?;
            let (film, frames) = (film::film(&raw)?, film::frames(&raw)?);
            let keep = raw.keep_timeline.as_deref().map(film::layers).transpose()?;
            let bake_per_s = bake(&raw)?;
            let (out, until) = (raw.out, raw.until);
            let folder = Folder { out, existing, checkpoint_every, until, film, frames, bake_per_s, keep };
            Aim::Folder(Box::new(folder))
        }
        (Some(_), None) => return wrong("--seeds draws a contact sheet; name it with --sheet FILE.png"),
        (None, Some(_)) => return wrong("--sheet draws several seeds; name them with --seeds A..B"),
        (Some(seeds), Some(file)) => {
            let other = [
                ("--out", raw.out.is_some()),
                ("--seed", seed.is_some()),
                ("--until", raw.until.is_some()),
                ("--json", raw.json),
                ("--force", raw.force),
                ("--resume", raw.resume),
                ("--checkpoint-every", raw.checkpoint_every.is_some()),
                ("--video", raw.video.is_some()),
                ("--frames", raw.frames.is_some()),
                ("--bake", raw.bake || raw.bake_rate.is_some()),
                ("--keep-timeline", raw.keep_timeline.is_some()),
            ];
            if let Some((flag, _)) = other.iter().find(|(_, given)| *given) {
                return wrong(format!("{flag} does not go with --sheet, which grows no folder"));
            }
            Aim::Sheet { seeds: seed_range(seeds)?, file: file.clone() }
        }
    };
    let source = Source::find(&raw.recipe)?;
    Ok(Grow { source, overrides: Overrides { set: raw.set, seed, size: raw.size }, threads, voice, aim })
}

/// More threads than this only cost memory.
const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<usize, CliError> {
    match text.parse() {
        Ok(n) if (1..=MOST_THREADS).contains(&n) => Ok(n),
        _ => wrong(format!("--threads {text}: must be a whole number from 1 to {MOST_THREADS}")),
    }
}

fn seconds(text: &str) -> Result<Duration, CliError> {
    match text.parse::<f64>() {
        Ok(s) if (0.0..=86_400.0).contains(&s) => Ok(Duration::from_secs_f64(s)),
        _ => wrong(format!("--checkpoint-every {text}: must be a number of seconds from 0 to 86400")),
    }
}

/// Frames to a second that particles are recorded with, if they are.
fn bake(raw: &RawGrow) -> Result<Option<f64>, CliError> {
    let [slow, fast] = RATES_PER_S;
    match raw.bake_rate.as_deref().map(|text| (text, text.parse::<f64>())) {
        None => Ok(raw.bake.then_some(BAKE_PER_S)),
        Some(_) if !raw.bake => wrong("--bake-rate is about the recording of particles; ask for it with --bake"),
        Some((_, Ok(rate))) if (slow..=fast).contains(&rate) => Ok(Some(rate)),
        Some((text, _)) => {
            wrong(format!("--bake-rate {text}: must be a number of frames a second from {slow} to {fast}"))
        }
    }
}

/// The greatest seed that a recipe can state: TOML's greatest whole number.
const MOST_SEED: u64 = i64::MAX as u64;

fn seed(text: &str) -> Result<u64, CliError> {
    if text == "random" {
        return Ok(random_seed());
    }
    match text.parse() {
        Ok(n) if n <= MOST_SEED => Ok(n),
        _ => wrong(format!("--seed {text}: must be a whole number from 0 to {MOST_SEED}, or random")),
    }
}

/// A seed that is new every time and short enough to say aloud.
fn random_seed() -> u64 {
    use std::hash::{BuildHasher, Hasher};
    // The standard library's hasher is keyed by the system's randomness; the clock differs between two calls.
    let mut hasher = std::collections::hash_map::RandomState::new().build_hasher();
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    hasher.write_u128(now.as_nanos());
    hasher.finish() % 1_000_000
}

fn seed_range(text: &str) -> Result<RangeInclusive<u64>, CliError> {
    let bad = || CliError::Request(format!("--seeds {text}: write two seeds as A..B, such as 1..24"));
    let (from, to) = text.split_once("..").ok_or_else(bad)?;
    let to = to.strip_prefix('=').unwrap_or(to);
    let number = |text: &str| text.trim().parse::<u64>().ok().filter(|&n| n <= MOST_SEED).ok_or_else(bad);
    let (from, to) = (number(from)?, number(to)?);
    if to < from {
        return wrong(format!("--seeds {text}: the second seed must not be below the first"));
    }
    if to - from >= SHEET_MOST {
        return wrong(format!("--seeds {text}: at most {SHEET_MOST} seeds fit on a sheet"));
    }
    Ok(from..=to)
}

fn params(raw: RawParams) -> Result<Params, CliError> {
    if raw.schema {
        return Ok(Params::Schema);
    }
    if raw.markdown {
        return Ok(Params::Markdown);
    }
    let Some(name) = raw.stage else { return Ok(Params::All) };
    if name == "world" {
        return Ok(Params::World);
    }
    if name == "scene" {
        return Ok(Params::Scene);
    }
    if let Some(stage) = find_stage(&name) {
        return Ok(Params::Stage(stage.kind));
    }
    let kinds = || stage_kinds().iter().map(|stage| stage.kind).chain(["world", "scene"]);
    let hint = match nearest(&name, kinds()) {
        Some(near) => format!("did you mean '{near}'?"),
        None => format!("there are: {}", kinds().collect::<Vec<_>>().join(", ")),
    };
    wrong(format!("no stage kind '{name}' ({hint})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_and_threads() {
        assert_eq!(seed("0").unwrap(), 0);
        assert!(seed("random").unwrap() < 1_000_000);
        assert_eq!(seed_range("1..24").unwrap(), 1..=24);
        assert_eq!(threads("8").unwrap(), 8);
        for bad in ["-1", "1.5", "x", "", "9223372036854775808"] {
            assert!(seed(bad).is_err() && threads(bad).is_err(), "{bad}");
        }
        for bad in ["3", "3..1", "..", "a..b", "1..2..3", "0..400", "-1..4"] {
            assert!(seed_range(bad).is_err(), "{bad}");
        }
        assert!(threads("0").is_err());
    }
}
