//! What `grow` is asked to film.

use crate::{
    export::video::{Rate, split_arguments},
    job::film::{FilmRequest, FramesRequest},
};

use super::{CliError, arguments::RawGrow, command::wrong};

/// The film, if one is asked for.
pub(crate) fn film(raw: &RawGrow) -> Result<Option<FilmRequest>, CliError> {
    let Some(file) = &raw.video else {
        let about = [
            ("--fps", raw.fps.is_some()),
            ("--video-size", raw.video_size.is_some()),
            ("--view", raw.view.is_some()),
            ("--clock", raw.clock),
            ("--ffmpeg-args", raw.ffmpeg_args.is_some()),
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
    let ffmpeg_args = raw.ffmpeg_args.as_deref().unwrap_or_default();
    let Some(ffmpeg_args) = split_arguments(ffmpeg_args) else {
        return wrong(format!("--ffmpeg-args {ffmpeg_args}: a quote is not closed"));
    };
    Ok(Some(FilmRequest {
        file: file.clone(),
        rate: raw.fps.as_deref().map(rate).transpose()?,
        size: raw.video_size.as_deref().map(size).transpose()?,
        view: raw.view.clone().unwrap_or_else(|| "relief".to_owned()),
        clock: raw.clock,
        ffmpeg_args,
    }))
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
            fps: Some("29.97".into()),
            video_size: Some("640x360".into()),
            ffmpeg_args: Some("-crf 30".into()),
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
