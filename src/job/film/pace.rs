//! How a film shares its time among stages.

use crate::recipe::{FilmTime, Plan, Stage};

/// Length of a film whose stages say nothing of it, s.
const USUAL_S: f64 = 5.0;
/// A stage that takes time in the world gets so many times the share of one that takes none.
const WEIGHT_OF_TIME: f64 = 4.0;

/// A stage in a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// What is written under it.
    pub caption: String,
    pace: Pace,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Pace {
    /// So many pictures, spread over the stage's steps.
    Pictures(f64),
    /// A picture for so many years, of so many that the stage is to last.
    YearsPerPicture(f64, f64),
}

impl Clip {
    /// Where a moment stands, in pictures.
    pub fn place(&self, done: f64, passed_yr: f64) -> f64 {
        match self.pace {
            Pace::Pictures(count) => done.clamp(0.0, 1.0) * count,
            Pace::YearsPerPicture(years, _) => passed_yr / years,
        }
    }

    /// How many pictures it is to have.
    pub fn pictures(&self) -> f64 {
        match self.pace {
            Pace::Pictures(count) => count,
            Pace::YearsPerPicture(years, of) => of / years,
        }
    }
}

/// The clips of the stages that run, up to the one of place `until`.
pub fn clips(plan: &Plan, until: Option<usize>, per_second: f64) -> Vec<Clip> {
    let running: Vec<&Stage> =
        plan.running().filter(|(i, _)| until.is_none_or(|end| *i <= end)).map(|(_, stage)| stage).collect();
    let weight = |stage: &Stage| if stage.takes_time() { WEIGHT_OF_TIME } else { 1.0 };
    let all: f64 = running.iter().filter(|stage| stage.film.is_none()).map(|stage| weight(stage)).sum();
    let clip = |stage: &&Stage| {
        let pace = match stage.film {
            Some(FilmTime::Seconds(s)) => Pace::Pictures((s * per_second).round()),
            Some(FilmTime::YearsPerSecond(years)) => Pace::YearsPerPicture(years / per_second, stage.duration_yr()),
            None => Pace::Pictures((USUAL_S * per_second * weight(stage) / all).round().max(1.0)),
        };
        Clip { caption: stage.kind.title.to_owned(), pace }
    };
    running.iter().map(clip).collect()
}

/// The clip of a world that stands still.
pub fn standing(pictures: f64) -> Vec<Clip> {
    vec![Clip { caption: String::new(), pace: Pace::Pictures(pictures) }]
}

/// The clips of so many stages of which nothing is known.
pub fn equal(stages: usize, per_second: f64) -> Vec<Clip> {
    let pictures = (USUAL_S * per_second / stages.max(1) as f64).round().max(1.0);
    vec![Clip { caption: String::new(), pace: Pace::Pictures(pictures) }; stages]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::{Overrides, Source};

    fn clips_of(text: &str, per_second: f64) -> Vec<Clip> {
        let source = Source { name: "t".into(), file: "t.toml".into(), folder: "".into(), text: text.into() };
        clips(&Plan::new(&source, &Overrides::default()).unwrap(), None, per_second)
    }

    #[test]
    fn stages_share_the_usual_length_and_say_their_own() {
        let pictures =
            |text: &str| -> Vec<f64> { clips_of(text, 30.0).iter().map(|clip| clip.place(1.0, 0.0)).collect() };
        let (plates, base, warp) = (
            "[[stage]]\nkind = \"plates\"\n",
            "[[stage]]\nkind = \"fbm\"\nblend = \"add\"\n",
            "[[stage]]\nkind = \"warp\"\n",
        );
        assert_eq!(pictures(plates), [150.0]);
        assert_eq!(pictures(&[plates, base].concat()), [120.0, 30.0]);
        assert_eq!(pictures(&[base, warp].concat()), [75.0, 75.0]);
        assert_eq!(pictures(&[base, "film_seconds = 2.0\n", warp].concat()), [60.0, 150.0]);
        assert_eq!(pictures(&[base, "film_seconds = 0\n", warp, "film_seconds = 0\n"].concat()), [0.0, 0.0]);
        let timed = clips_of(&[plates, "film_yr_per_s = 3e6\n"].concat(), 30.0);
        assert_eq!(timed[0].place(0.5, 2e6), 20.0);
        let myr = clips_of(&[plates, "duration_myr = 60\nfilm_yr_per_s = 3e6\n"].concat(), 30.0)[0].pictures();
        assert!((myr - 600.0).abs() < 1e-9, "{myr}");
        let timed = clips_of(&[plates, "film_s_per_s = 86400\n"].concat(), 24.0);
        assert!((timed[0].place(0.5, 1.0 / 365.25) - 24.0).abs() < 1e-9);
        assert_eq!((timed[0].caption.as_str(), timed.len()), ("Plates", 1));
    }
}
