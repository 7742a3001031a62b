//! What is asked of a scene.

use crate::{
    job::{CameraChoice, SceneRequest, TIMES_H},
    recipe::nearest,
    scene::{Movement, Quality},
};

use super::{CliError, arguments::RawScene, command::wrong};

/// Pixels of a still's sides.
const SIDES_PX: [u32; 2] = [16, 16_384];

/// Checks what was typed; `set` are texts for the scene alone.
pub(crate) fn request(raw: &RawScene, set: &[String], size: Option<&str>) -> Result<SceneRequest, CliError> {
    Ok(SceneRequest {
        file: raw.scene.clone(),
        set: set.to_vec(),
        camera: raw.camera.as_deref().map(camera).transpose()?,
        time_of_day_h: raw.time_of_day.as_deref().map(time_of_day).transpose()?,
        quality: raw.quality.as_deref().map(quality).transpose()?,
        size: size.map(still_size).transpose()?,
    })
}

fn camera(text: &str) -> Result<CameraChoice, CliError> {
    if let Some((_, movement)) = Movement::ALL.iter().find(|(name, _)| *name == text) {
        return Ok(CameraChoice::Movement(*movement));
    }
    if text.ends_with(".toml") || text.contains(['/', '\\']) {
        return Ok(CameraChoice::File(text.into()));
    }
    let names = || Movement::ALL.iter().map(|(name, _)| *name);
    let known = names().collect::<Vec<_>>().join(", ");
    let hint = nearest(text, names()).map(|near| format!(" (did you mean '{near}'?)")).unwrap_or_default();
    wrong(format!("--camera {text}: must be one of {known}, or a file that ends in .toml{hint}"))
}

fn time_of_day(text: &str) -> Result<(f64, Option<f64>), CliError> {
    let hour = |text: &str, most: f64| text.trim().parse::<f64>().ok().filter(|h| (0.0..=most).contains(h));
    let [most, last] = TIMES_H;
    let times = match text.split_once("..") {
        None => hour(text, most).map(|from| (from, None)),
        Some((from, to)) => hour(from, most).zip(hour(to, last)).map(|(from, to)| (from, Some(to))),
    };
    match times {
        Some(times) => Ok(times),
        None => wrong(format!(
            "--time-of-day {text}: write hours from 0 to {most}, such as 16.5, or where a film's day begins and ends, such as \
             5..21 (to {last})"
        )),
    }
}

fn quality(text: &str) -> Result<Quality, CliError> {
    match text {
        "draft" => Ok(Quality::Draft),
        "normal" => Ok(Quality::Normal),
        "full" => Ok(Quality::Full),
        _ => wrong(format!("--quality {text}: must be one of draft, normal, full")),
    }
}

fn still_size(text: &str) -> Result<[u32; 2], CliError> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse::<u32>().ok()?, h.parse::<u32>().ok()?]));
    let [least, most] = SIDES_PX;
    match sides {
        None => wrong(format!("--size {text}: write width and height as WxH, such as 1280x720")),
        Some(sides) if sides.iter().all(|side| (least..=most).contains(side)) => Ok(sides),
        Some(_) => wrong(format!("--size {text}: each side must be from {least} to {most} pixels")),
    }
}

/// How long a film of a finished world is, s.
pub(crate) fn seconds(text: &str) -> Result<f64, CliError> {
    match text.parse::<f64>() {
        Ok(s) if (0.1..=3600.0).contains(&s) => Ok(s),
        _ => wrong(format!("--seconds {text}: must be a number of seconds from 0.1 to 3600")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_become_a_request() {
        let raw = RawScene {
            camera: Some("fly".into()),
            time_of_day: Some("5..21".into()),
            quality: Some("draft".into()),
            scene: None,
        };
        let asked = request(&raw, &[], Some("640x360")).unwrap();
        assert_eq!(asked.camera, Some(CameraChoice::Movement(Movement::Fly)));
        assert_eq!((asked.time_of_day_h, asked.size), (Some((5.0, Some(21.0))), Some([640, 360])));
        assert_eq!(camera("cams/a.toml").unwrap(), CameraChoice::File("cams/a.toml".into()));
        assert_eq!(time_of_day("16.5").unwrap(), (16.5, None));
        for bad in ["", "noon", "-1", "49", "5..", "..21", "5..73", "nan", "5..21..30"] {
            assert!(time_of_day(bad).is_err(), "{bad}");
        }
        for bad in ["", "0", "inf", "nan", "4000", "ten"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
    }
}
