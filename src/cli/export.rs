//! `upthrust export`: what was typed becomes a request, and the files it made are named.

use crate::{
    export::{Green, engine::Engine, raster::Window},
    job::{self, ExportRequest},
    recipe::nearest,
};

use super::{
    CliError,
    arguments::RawExport,
    output::{Output, say},
};

fn wrong<T>(what: impl Into<String>) -> Result<T, CliError> {
    Err(CliError::Request(what.into()))
}

/// Checks what was typed.
pub(crate) fn validate(raw: RawExport) -> Result<ExportRequest, CliError> {
    Ok(ExportRequest {
        engine: raw.engine.as_deref().map(engine).transpose()?,
        window: raw.window.as_deref().map(window).transpose()?,
        size: raw.size.as_deref().map(size).transpose()?,
        range: raw.range.as_deref().map(range).transpose()?,
        tiles: raw.tiles.as_deref().map(tiles).transpose()?,
        bits: raw.bits.as_deref().map(bits).transpose()?,
        south_first: raw.flip.as_deref().map(flip).transpose()?.unwrap_or(false),
        green: raw.normal_y.as_deref().map(green).transpose()?,
        contours_m: raw.contours.as_deref().map(contours).transpose()?,
        at_s: raw.at.as_deref().map(moment).transpose()?,
        every_s: raw.every.as_deref().map(every).transpose()?,
        world: raw.world,
        file: raw.file,
        layer: raw.layer,
        big_endian: raw.big_endian,
        force: raw.force,
    })
}

/// Exports a world.
pub(crate) fn run(request: &ExportRequest, output: &mut Output) -> Result<(), CliError> {
    let exported = job::export(request)?;
    for note in &exported.notes {
        say(&format!("note: {note}"));
    }
    exported.files.iter().try_for_each(|file| output.line(&file.display().to_string()))
}

fn engine(text: &str) -> Result<Engine, CliError> {
    Engine::from_name(text).map_or_else(
        || {
            let names = || Engine::ALL.iter().map(|engine| engine.demands().name);
            let hint = match nearest(text, names()) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("there are: {}", names().collect::<Vec<_>>().join(", ")),
            };
            wrong(format!("--engine {text}: no such engine ({hint})"))
        },
        Ok,
    )
}

fn window(text: &str) -> Result<Window, CliError> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [x_km, y_km, size_km] if text.split(',').count() == 3 && numbers.iter().all(|v| v.is_finite()) => {
            Ok(Window { x_m: x_km * 1000.0, y_m: y_km * 1000.0, size_m: size_km * 1000.0 })
        }
        _ => wrong(format!("--window {text}: write west edge, north edge and size in km, such as 120,80,8")),
    }
}

fn range(text: &str) -> Result<[f64; 2], CliError> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let ends = text.split_once("..").and_then(|(from, to)| Some([number(from)?, number(to)?]));
    match ends {
        Some([from, to]) if from < to => Ok([from, to]),
        Some(_) => wrong(format!("--range {text}: the first number must be below the second")),
        None => wrong(format!("--range {text}: write two numbers as MIN..MAX, such as -500..3000")),
    }
}

/// Most samples that can be asked for; the world decides whether fewer are too many.
const MOST_SIZE: usize = 16_385;

fn size(text: &str) -> Result<usize, CliError> {
    match text.parse() {
        Ok(n) if (2..=MOST_SIZE).contains(&n) => Ok(n),
        _ => wrong(format!("--size {text}: must be a whole number from 2 to {MOST_SIZE}")),
    }
}

fn tiles(text: &str) -> Result<usize, CliError> {
    text.parse().or_else(|_| wrong(format!("--tiles {text}: must be a whole number, the tiles along a side")))
}

fn bits(text: &str) -> Result<u32, CliError> {
    match text.parse() {
        Ok(n @ (8 | 16 | 32)) => Ok(n),
        _ => wrong(format!("--bits {text}: must be 8, 16 or 32")),
    }
}

fn contours(text: &str) -> Result<f64, CliError> {
    match text.parse::<f64>() {
        Ok(m) if m.is_finite() && m > 0.0 => Ok(m),
        _ => wrong(format!("--contours {text}: must be a number of metres above 0, such as 100")),
    }
}

fn moment(text: &str) -> Result<f64, CliError> {
    match text.parse::<f64>() {
        Ok(s) if s.is_finite() && s >= 0.0 => Ok(s),
        _ => wrong(format!("--at {text}: must be a number of seconds from 0")),
    }
}

fn every(text: &str) -> Result<f64, CliError> {
    match text.parse::<f64>() {
        Ok(s) if s.is_finite() && s > 0.0 => Ok(s),
        _ => wrong(format!("--every {text}: must be a number of seconds above 0, such as 0.04")),
    }
}

fn flip(text: &str) -> Result<bool, CliError> {
    if text == "y" { Ok(true) } else { wrong(format!("--flip {text}: rows can be flipped with 'y', nothing else")) }
}

fn green(text: &str) -> Result<Green, CliError> {
    match text {
        "up" => Ok(Green::Up),
        "down" => Ok(Green::Down),
        _ => wrong(format!("--normal-y {text}: must be up (OpenGL) or down (DirectX)")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_and_ranges() {
        assert_eq!(window("1, 2,0.5").unwrap(), Window { x_m: 1000.0, y_m: 2000.0, size_m: 500.0 });
        assert_eq!(range("-500..3000.5").unwrap(), [-500.0, 3000.5]);
        for bad in ["", "1,2", "1,2,3,4", "1,x,3,4", "1,2,nan", "a,b,c"] {
            assert!(window(bad).is_err(), "{bad}");
        }
        for bad in ["", "5", "5..5", "5..1", "a..b", "..", "0..inf"] {
            assert!(range(bad).is_err(), "{bad}");
        }
        for bad in ["0", "1", "-4", "16386", "x"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
