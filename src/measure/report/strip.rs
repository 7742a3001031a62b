//! A small picture of where values lie against their band, for a row of a table.

use std::fmt::Write as _;

use crate::measure::Band;

const WIDTH: f64 = 170.0;
const HEIGHT: f64 = 16.0;

/// The band as a bar in the middle third, each value as a dot; values far off stand at the ends.
pub fn strip(band: Option<Band>, values: &[f64], faint: bool) -> String {
    let Some(place) = band.and_then(scale) else { return String::new() };
    let mut svg = format!("<svg class=\"strip\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" aria-hidden=\"true\">");
    let (from, to) = match band {
        Some(Band { low: Some(low), high: Some(high) }) => (place(low), place(high)),
        Some(Band { low: Some(low), high: None }) => (place(low), WIDTH),
        Some(Band { low: None, high: Some(high) }) => (0.0, place(high)),
        _ => (0.0, WIDTH),
    };
    let middle = HEIGHT / 2.0;
    let wide = to - from;
    let _ = write!(svg, "<path class=\"rule\" d=\"M0 {middle}H{WIDTH}\"/>");
    let _ = write!(svg, "<rect class=\"earth\" x=\"{from:.1}\" y=\"2\" width=\"{wide:.1}\" height=\"12\" rx=\"2\"/>");
    let class = if faint { "faint" } else { "dot" };
    for x in values.iter().map(|&v| place(v)).filter(|x| x.is_finite()) {
        let x = x.clamp(4.0, WIDTH - 4.0);
        let _ = write!(svg, "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{middle}\" r=\"3.5\"/>");
    }
    svg.push_str("</svg>");
    svg
}

/// Where a value stands.
fn scale(band: Band) -> Option<impl Fn(f64) -> f64> {
    let (low, width) = match (band.low, band.high) {
        (Some(low), Some(high)) if high > low => (low, high - low),
        (Some(low), None) => (low, low.abs().max(1.0)),
        (None, Some(high)) => (high - high.abs().max(1.0), high.abs().max(1.0)),
        _ => return None,
    };
    Some(move |v: f64| WIDTH * (1.0 + (v - low) / width) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_stand_where_they_should() {
        let svg = strip(Some(Band::new(1.0, 2.0)), &[1.5, 90.0], false);
        assert!(svg.contains("cx=\"85.0\"") && svg.contains("cx=\"166.0\""), "{svg}");
        assert!(strip(Some(Band::above(0.0)), &[0.5], true).contains("class=\"faint\""));
        assert_eq!(strip(None, &[1.0], false), "");
    }
}
