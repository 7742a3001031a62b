//! Reports: a world, or many, beside Earth, as a page that opens anywhere.
//!
//! [`html`] is one file with its plots inside; [`markdown`] names plots that lie beside it. Both are texts made here; who asked
//! for them writes them.

mod axis;
mod figures;
mod html;
mod markdown;
mod plot;
mod strip;

pub use html::html;
pub use markdown::{markdown, metrics_table, spreads_table};

use super::{METRICS, Reading, Spread, Survey, spread};

/// A world that is reported.
#[derive(Clone, Debug)]
pub struct Subject {
    /// What it is called.
    pub name: String,
    /// Its landscape.
    pub survey: Survey,
}

/// What metrics cannot tell, which a reader has to know.
const CAVEATS: [&str; 4] = [
    "Concavity and χ of ground that a stream-power law made follow from the law's own exponents: they verify the solver and \
     are no evidence of realism. Hack's exponent, the hypsometric integral, spectra, the slope histogram and area exceedance \
     are.",
    "Horton's ratios discriminate weakly: random networks have them too.",
    "All metrics go with the size of the cells (Guth 2011). Where the band does not hold at a world's cells, the value is \
     given and not judged.",
    "A band is what is usual on Earth, not a law of nature: real ranges lie outside of some of them.",
];

/// A row of a report's table.
struct Row {
    title: &'static str,
    value: String,
    range: String,
    band: String,
    standing: String,
    class: &'static str,
    strip: String,
}

/// The table of a report: readings of one world, spreads of many.
fn rows(subjects: &[Subject]) -> Vec<Row> {
    let readings: Vec<Vec<Reading>> = subjects.iter().map(|s| s.survey.readings()).collect();
    match &readings[..] {
        [one] => one.iter().map(one_row).collect(),
        many => spread::spreads(many).iter().map(many_row).collect(),
    }
}

fn one_row(reading: &Reading) -> Row {
    use super::Verdict::*;
    let values: Vec<f64> = reading.value.into_iter().collect();
    let class = match reading.verdict {
        Inside => "inside",
        Outside => "outside",
        OtherScale | NoBand | Missing => "aside",
    };
    let judged = matches!(reading.verdict, Inside | Outside);
    Row {
        title: reading.title,
        value: reading.value.map_or("–".to_owned(), |v| spread::with_unit(v, reading.unit)),
        range: String::new(),
        band: reading.band.map_or("–".to_owned(), |band| band.to_string()),
        standing: spread::remark(reading),
        class,
        strip: strip::strip(reading.band.filter(|_| judged), &values, false),
    }
}

fn many_row(s: &Spread) -> Row {
    let class = match s.inside {
        Some(share) if share >= 0.5 => "inside",
        Some(_) => "outside",
        None => "aside",
    };
    let number = super::short;
    Row {
        title: s.title,
        value: s.median.map_or("–".to_owned(), |v| spread::with_unit(v, s.unit)),
        range: s.low.zip(s.high).map_or("–".to_owned(), |(low, high)| format!("{} to {}", number(low), number(high))),
        band: s.band.map_or("–".to_owned(), |band| band.to_string()),
        standing: spread::standing(s),
        class,
        strip: strip::strip(s.band.filter(|_| s.inside.is_some()), &s.values, true),
    }
}

/// What the worlds are, in one line each.
fn facts(subject: &Subject) -> String {
    let s = &subject.survey;
    let [width, height] = s.size;
    let (cell, land) = (super::short(s.cell_m), s.land_share * 100.0);
    let channel = super::short(s.channel_km2);
    format!("{width} × {height} cells of {cell} m, {land:.0} % land; channels begin at {channel} km²")
}

/// The headline.
fn headline(subjects: &[Subject]) -> String {
    match subjects {
        [one] => spread::tally(&one.survey.readings()),
        many => format!("{} worlds: medians, the middle nine tenths, and the share inside Earth's band", many.len()),
    }
}

/// The title.
fn title(subjects: &[Subject]) -> String {
    match subjects {
        [one] => format!("{} beside Earth", one.name),
        many => format!("{} worlds beside Earth", many.len()),
    }
}
