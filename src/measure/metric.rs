//! What a metric is: a number of a landscape, the band it has on Earth, and whether the two can be compared.

use serde::Serialize;

use super::Survey;

/// Why a number cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Missing {
    /// Everything lies below the sea.
    #[error("no land above the sea")]
    NoLand,
    /// There is nothing to measure in level ground.
    #[error("the ground is flat")]
    Flat,
    /// The sample is too small.
    #[error("too few {what}: {found}, at least {needed} needed")]
    TooFew {
        /// What there is too little of.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// There is no square to take a spectrum of.
    #[error("no square of {side} x {side} cells that is nearly all land")]
    NoSquare {
        /// The least side.
        side: usize,
    },
    /// Heights with one hump.
    #[error("heights have one mode, not a continent's and an ocean floor's")]
    OneMode,
}

/// What is found on Earth; an open end is absent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Least usual value.
    pub low: Option<f64>,
    /// Greatest usual value.
    pub high: Option<f64>,
}

impl Band {
    /// From one value to another.
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low: Some(low), high: Some(high) }
    }

    /// From a value upwards.
    pub const fn above(low: f64) -> Self {
        Self { low: Some(low), high: None }
    }

    /// Whether a value lies in it, ends included.
    pub fn holds(&self, value: f64) -> bool {
        self.low.is_none_or(|low| value >= low) && self.high.is_none_or(|high| value <= high)
    }
}

impl std::fmt::Display for Band {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let text = match (self.low, self.high) {
            (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
            (Some(low), None) => format!("over {}", short(low)),
            (None, Some(high)) => format!("up to {}", short(high)),
            (None, None) => String::new(),
        };
        // So that a width given by the caller counts.
        f.pad(&text)
    }
}

/// One row of [`super::METRICS`].
pub struct Metric {
    /// Name in JSON.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Unit; `1` for pure numbers.
    pub unit: &'static str,
    /// What is found on Earth, where that is known.
    pub band: Option<Band>,
    /// Sides of cells, m, at which the band can be compared with; absent where all can.
    pub cells_m: Option<Band>,
    /// How it is computed.
    pub method: &'static str,
    /// Where the band comes from.
    pub source: &'static str,
    pub(super) value: fn(&Survey) -> Result<f64, Missing>,
}

/// How a value stands to its band.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// In the band.
    Inside,
    /// Not in the band.
    Outside,
    /// The cells are too large or too small for the band to mean anything.
    OtherScale,
    /// There is no band.
    NoBand,
    /// There is no value.
    Missing,
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Inside => "inside",
            Verdict::Outside => "outside",
            Verdict::OtherScale => "other scale",
            Verdict::NoBand => "",
            Verdict::Missing => "missing",
        }
    }
}

/// A metric of one world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reading {
    /// The metric's name.
    pub name: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The value; absent where it cannot be had.
    pub value: Option<f64>,
    /// Why it cannot be had.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
    /// What is found on Earth.
    pub band: Option<Band>,
    /// How the two compare.
    pub verdict: Verdict,
    /// Sides of cells, m, at which they can be compared; absent where all can.
    pub cells_m: Option<Band>,
    /// Where the band comes from.
    pub source: &'static str,
}

impl Metric {
    /// The value in a world that was surveyed, and what to make of it.
    pub fn read(&self, survey: &Survey) -> Reading {
        let found = (self.value)(survey);
        // A number that is none never leaves this room.
        let found = found.and_then(|v| if v.is_finite() { Ok(v) } else { Err(Missing::Flat) });
        let comparable = self.cells_m.is_none_or(|cells_m| cells_m.holds(survey.cell_m));
        let verdict = match (&found, self.band) {
            (Err(_), _) => Verdict::Missing,
            (Ok(_), None) => Verdict::NoBand,
            (Ok(_), Some(_)) if !comparable => Verdict::OtherScale,
            (&Ok(v), Some(band)) if band.holds(v) => Verdict::Inside,
            _ => Verdict::Outside,
        };
        let missing = found.as_ref().err().map(|why| why.to_string());
        Reading {
            name: self.name,
            title: self.title,
            unit: self.unit,
            value: found.ok(),
            missing,
            band: self.band,
            verdict,
            cells_m: self.cells_m,
            source: self.source,
        }
    }
}

/// Three significant digits, as plainly as they can be written.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let digits = libm::floor(libm::log10(value.abs())) as i32;
    if !(-4..6).contains(&digits) {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.*}", (2 - digits).clamp(0, 6) as usize);
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_hold_their_ends() {
        let band = Band::new(0.3, 0.6);
        assert!(band.holds(0.3) && band.holds(0.6) && !band.holds(0.61) && !band.holds(0.29));
        assert!(Band::above(0.0).holds(1e9) && !Band::above(0.0).holds(-1e-9));
        assert_eq!((band.to_string(), Band::above(0.0).to_string()), ("0.3 to 0.6".into(), "over 0".into()));
    }

    #[test]
    fn three_digits_are_enough() {
        for (value, text) in [(0.41234, "0.412"), (3.0, "3"), (1234.5, "1234"), (-4500.0, "-4500"), (0.0, "0")] {
            assert_eq!(short(value), text);
        }
        assert_eq!(short(1.5e-7), "1.50e-7");
    }
}
