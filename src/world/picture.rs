//! Opening pictures: files, and the samples that come with the program (`sample:NAME`).

use std::path::Path;

use image::DynamicImage;

/// Pictures that come with the program.
const SAMPLES: &[(&str, &[u8])] = &[
    ("my-heights.png", include_bytes!("../../presets/my-heights.png")),
    ("my-continents.png", include_bytes!("../../presets/my-continents.png")),
    ("my-plates.png", include_bytes!("../../presets/my-plates.png")),
];

/// Why a picture cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// No such sample.
    #[error("there is no sample '{0}'; samples are {1}")]
    NoSample(String, String),
    /// The file cannot be opened or is no picture.
    #[error("{0}: {1}")]
    Unreadable(String, String),
}

/// The bytes of the sample that `sample:NAME` names.
pub fn sample(name: &str) -> Result<&'static [u8], PictureError> {
    let found = SAMPLES.iter().find(|(sample, _)| *sample == name).ok_or_else(|| {
        let names: Vec<&str> = SAMPLES.iter().map(|(sample, _)| *sample).collect();
        PictureError::NoSample(name.to_owned(), names.join(", "))
    })?;
    Ok(found.1)
}

/// Opens a picture file, or a sample named `sample:NAME`.
pub fn open_picture(path: &Path) -> Result<DynamicImage, PictureError> {
    let unreadable = |e: image::ImageError| {
        let reason = e.to_string().replace('\n', " ");
        PictureError::Unreadable(path.display().to_string(), reason)
    };
    match path.to_str().and_then(|p| p.strip_prefix("sample:")) {
        Some(name) => image::load_from_memory(sample(name)?).map_err(unreadable),
        None => image::open(path).map_err(unreadable),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_open_and_strangers_are_named() {
        for (name, _) in SAMPLES {
            assert!(open_picture(Path::new(&format!("sample:{name}"))).is_ok());
        }
        let error = open_picture(Path::new("sample:nowhere.png")).unwrap_err();
        assert!(error.to_string().contains("my-continents.png"));
    }
}
