//! What `grow` is asked to film, and `upthrust film`.

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use crate::{
    export::video::{Rate, split_arguments},
    job::{
        self,
        film::{FilmRequest, FramesRequest},
    },
    recipe::nearest,
    world::Layer,
};

use super::{
    CliError,
    arguments::{RawGrow, RawLook},
    command::{Voice, wrong},
    output::Output,
    progress::Progress,
    scene,
};

/// The film, if one is asked for.
pub(crate) fn film(raw: &RawGrow) -> Result<Option<FilmRequest>, CliError> {
    let Some(file) = &raw.video else {
        let look = &raw.look;
        let about = [
            ("--fps", look.fps.is_some()),
            ("--video-size", look.video_size.is_some()),
            ("--view", look.view.is_some()),
            ("--camera", look.scene.camera.is_some()),
            ("--time-of-day", look.scene.time_of_day.is_some()),
            ("--quality", look.scene.quality.is_some()),
            ("--scene", look.scene.scene.is_some()),
            ("--clock", look.clock),
            ("--ffmpeg-args", look.ffmpeg_args.is_some()),
        ];
        return match about.iter().find(|(_, given)| *given) {
            Some((flag, _)) => wrong(format!("{flag} is about a film; ask for one with --video")),
            None => Ok(None),
        };
    };
    if let Some(file) = file.as_ref().filter(|file| file.extension().is_none()) {
        let shown = file.display();
        return wrong(format!(
            "--video {shown}: a film's name needs an ending, such as film.mp4 (if '{shown}' is the recipe, write it \
             before --video)"
        ));
    }
    // A run that goes on, or begins anew, makes its film anew.
    request(file.clone(), &raw.look, raw.force || raw.resume).map(Some)
}

/// A film of this name and look.
pub(crate) fn request(file: Option<PathBuf>, look: &RawLook, replace: bool) -> Result<FilmRequest, CliError> {
    let ffmpeg_args = look.ffmpeg_args.as_deref().unwrap_or_default();
    let Some(ffmpeg_args) = split_arguments(ffmpeg_args) else {
        return wrong(format!("--ffmpeg-args {ffmpeg_args}: a quote is not closed"));
    };
    Ok(FilmRequest {
        file,
        rate: look.fps.as_deref().map(rate).transpose()?,
        size: look.video_size.as_deref().map(size).transpose()?,
        view: look.view.clone().unwrap_or_else(|| "relief".to_owned()),
        scene: scene::request(&look.scene, &[], None)?,
        seconds: None,
        clock: look.clock,
        smoke: !look.no_smoke,
        ffmpeg_args,
        replace,
    })
}

/// The layers of a kept timeline, besides the height.
pub(crate) fn layers(text: &str) -> Result<Vec<Layer>, CliError> {
    let stored = || Layer::ALL.iter().filter(|layer| !layer.derived());
    if text == "all" {
        return Ok(stored().copied().collect());
    }
    let names = || stored().map(|layer| layer.name()).chain(["height", "all"]);
    let layer = |name: &str| match Layer::from_name(name) {
        Some(layer) if layer == Layer::Height || !layer.derived() => Ok(layer),
        _ => {
            let hint = match nearest(name, names()) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("there are: {}", names().collect::<Vec<_>>().join(", ")),
            };
            wrong(format!("--keep-timeline={text}: no layer '{name}' can be kept ({hint})"))
        }
    };
    text.split(',').map(str::trim).map(layer).collect()
}

/// Replays a kept timeline.
pub(crate) fn replay(
    world: &Path,
    film: &FilmRequest,
    cancel: &AtomicBool,
    output: &mut Output,
) -> Result<(), CliError> {
    let mut progress = Progress::new(Voice::Normal);
    let made = job::film::replay(world, film, cancel, &mut |event| progress.hear(&event));
    progress.end();
    output.line(&made?.display().to_string())
}

/// The heightmaps, if they are asked for.
pub(crate) fn frames(raw: &RawGrow) -> Result<Option<FramesRequest>, CliError> {
    let every = match raw.every.as_deref().map(|text| (text, text.parse::<u64>())) {
        None => 1,
        Some(_) if raw.frames.is_none() => return wrong("--every is about heightmaps; ask for them with --frames DIR"),
        Some((_, Ok(every @ 1..))) => every,
        Some((text, _)) => return wrong(format!("--every {text}: must be a whole number of steps from 1")),
    };
    Ok(raw.frames.clone().map(|folder| FramesRequest { folder, every }))
}

fn rate(text: &str) -> Result<Rate, CliError> {
    match Rate::parse(text) {
        Some(rate) => Ok(rate),
        None => wrong(format!("--fps {text}: must be a number from 1 to 240, such as 30, 29.97 or 24000/1001")),
    }
}

fn size(text: &str) -> Result<[usize; 2], CliError> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match sides {
        Some(sides) => Ok(sides),
        None => wrong(format!("--video-size {text}: write width and height as WxH, such as 1280x720")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_become_a_request() {
        let none = RawGrow::default();
        assert!(film(&none).unwrap().is_none() && frames(&none).unwrap().is_none());
        let raw = RawGrow {
            video: Some(Some("a.mp4".into())),
            look: RawLook {
                fps: Some("29.97".into()),
                video_size: Some("640x360".into()),
                ffmpeg_args: Some("-crf 30".into()),
                ..RawLook::default()
            },
            ..RawGrow::default()
        };
        let asked = film(&raw).unwrap().unwrap();
        assert_eq!((asked.size, asked.view.as_str()), (Some([640, 360]), "relief"));
        assert_eq!(asked.ffmpeg_args, ["-crf", "30"]);
        assert_eq!(asked.rate, Rate::parse("30000/1001"));
        let bare = RawGrow { video: Some(None), ..RawGrow::default() };
        assert_eq!(film(&bare).unwrap().unwrap().file, None);
    }
}
