//! Metrics of many worlds: how they spread, and how many lie in the band. And both, of one world and of many, as text.

use std::fmt::Write as _;

use serde::Serialize;

use super::{
    METRICS, Reading, Verdict,
    fit::quantile,
    metric::{Band, short},
};

/// A metric over several worlds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The metric's name.
    pub name: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What is found on Earth.
    pub band: Option<Band>,
    /// Worlds asked.
    pub worlds: usize,
    /// The values there are, one a world, in the worlds' order.
    pub values: Vec<f64>,
    /// The middle one.
    pub median: Option<f64>,
    /// Twentieth part from below.
    pub low: Option<f64>,
    /// Twentieth part from above.
    pub high: Option<f64>,
    /// Share of the worlds with comparable cells that lie in the band; a missing value lies outside.
    pub inside: Option<f64>,
    /// Why the first value that is missing cannot be had.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// How the readings of several worlds spread, in the order of [`METRICS`].
pub fn spreads(worlds: &[Vec<Reading>]) -> Vec<Spread> {
    METRICS
        .iter()
        .map(|metric| {
            let readings: Vec<&Reading> = worlds.iter().flatten().filter(|r| r.name == metric.name).collect();
            let values: Vec<f64> = readings.iter().filter_map(|r| r.value).collect();
            let count = |verdict: Verdict| readings.iter().filter(|r| r.verdict == verdict).count();
            let (inside, outside, none) = (count(Verdict::Inside), count(Verdict::Outside), count(Verdict::Missing));
            let comparable = metric.band.is_some() && inside + outside > 0;
            Spread {
                name: metric.name,
                title: metric.title,
                unit: metric.unit,
                band: metric.band,
                worlds: readings.len(),
                median: quantile(&values, 0.5),
                low: quantile(&values, 0.05),
                high: quantile(&values, 0.95),
                inside: comparable.then(|| inside as f64 / (inside + outside + none) as f64),
                missing: readings.iter().find_map(|r| r.missing.clone()),
                values,
            }
        })
        .collect()
}

/// How many of the metrics that can be compared lie in Earth's band.
pub fn tally(readings: &[Reading]) -> String {
    let count = |verdict: Verdict| readings.iter().filter(|r| r.verdict == verdict).count();
    let inside = count(Verdict::Inside);
    match inside + count(Verdict::Outside) {
        0 => "no metric of this world can be compared with Earth".to_owned(),
        all => format!("{inside} of the {all} metrics that can be compared lie in Earth's band"),
    }
}

/// A value with its unit.
pub fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "1" => short(value),
        "deg" => format!("{}°", short(value)),
        "km/km2" => format!("{} km/km²", short(value)),
        "1/km2" => format!("{} /km²", short(value)),
        unit => format!("{} {unit}", short(value)),
    }
}

/// What is said beside a reading.
pub fn remark(reading: &Reading) -> String {
    match (&reading.missing, reading.verdict, reading.cells_m) {
        (Some(why), _, _) => why.clone(),
        (None, Verdict::OtherScale, Some(cells)) => format!("not comparable: the band is for cells of {cells} m"),
        (None, verdict, _) => verdict.words().to_owned(),
    }
}

/// The readings of one world as a table.
pub fn readings_text(readings: &[Reading]) -> String {
    let mut text = format!("\n{:<24} {:>13}  {:<15} {}\n", "landscape", "value", "on Earth", tally(readings));
    for reading in readings {
        let value = reading.value.map_or("-".to_owned(), |v| with_unit(v, reading.unit));
        let band = reading.band.map_or(String::new(), |band| band.to_string());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}",
            format!("{:<24} {value:>13}  {band:<15} {}", reading.title, remark(reading)).trim_end()
        );
    }
    text
}

/// The spreads of many worlds as a table.
pub fn spreads_text(spreads: &[Spread]) -> String {
    let worlds = spreads.first().map_or(0, |s| s.worlds);
    let title = format!("{worlds} worlds");
    let mut text = format!("{title:<24} {:>13}  {:<20} {:<15} inside\n", "median", "5 to 95 %", "on Earth");
    for s in spreads {
        let value = s.median.map_or("-".to_owned(), |v| with_unit(v, s.unit));
        let range = s.low.zip(s.high).map_or(String::new(), |(low, high)| format!("{} to {}", short(low), short(high)));
        let band = s.band.map_or(String::new(), |band| band.to_string());
        let row = format!("{:<24} {value:>13}  {range:<20} {band:<15} {}", s.title, standing(s));
        let _ = writeln!(text, "{}", row.trim_end());
    }
    text
}

/// How a spread stands to its band, in words.
pub fn standing(s: &Spread) -> String {
    match (s.inside, s.band, &s.missing) {
        (Some(share), _, _) => format!("{:.0} %", share * 100.0),
        (None, _, Some(why)) if s.values.is_empty() => why.clone(),
        (None, Some(_), _) => "not comparable at this cell size".to_owned(),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(value: Option<f64>, verdict: Verdict) -> Reading {
        let m = &METRICS[0];
        let missing = value.is_none().then(|| "too few".to_owned());
        let (name, title, unit) = (m.name, m.title, m.unit);
        Reading { name, title, unit, value, missing, band: m.band, verdict, cells_m: m.cells_m, source: m.source }
    }

    #[test]
    fn a_missing_value_is_not_inside() {
        let worlds = [
            vec![reading(Some(0.4), Verdict::Inside)],
            vec![reading(Some(0.8), Verdict::Outside)],
            vec![reading(None, Verdict::Missing)],
            vec![reading(Some(0.5), Verdict::Inside)],
        ];
        let found = &spreads(&worlds)[0];
        assert_eq!((found.worlds, found.median, found.inside), (4, Some(0.5), Some(0.5)));
        assert!(spreads_text(&spreads(&worlds)).contains("50 %"));
        let other = spreads(&[vec![reading(Some(0.4), Verdict::OtherScale)]]);
        assert_eq!(other[0].inside, None);
        assert!(tally(&worlds[0]).starts_with("1 of the 1 metrics"));
    }
}
