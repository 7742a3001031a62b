//! Scales of a plot: where a value lies, and which values are marked.

/// An axis, before its range is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: &'static str,
    /// Whether it is logarithmic.
    pub log: bool,
    /// The range, if it is not that of the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis.
    pub const fn linear(label: &'static str) -> Self {
        Self { label, log: false, range: None }
    }

    /// A logarithmic axis.
    pub const fn log(label: &'static str) -> Self {
        Self { label, log: true, range: None }
    }

    /// With a range of its own.
    pub const fn spanning(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }
}

/// An axis laid along a stretch of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    log: bool,
    /// In logarithms on a logarithmic axis.
    range: [f64; 2],
    pixels: [f64; 2],
}

/// A mark on an axis; minor ones have no text.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where, in the axis's unit.
    pub at: f64,
    /// What is written there.
    pub text: Option<String>,
}

impl Scale {
    /// A scale that holds all finite values, with a little air, unless the axis has a range.
    pub fn of(axis: &Axis, values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let log = axis.log;
        let place = |v: f64| if log { libm::log10(v) } else { v };
        let range = match axis.range {
            Some(range) => range.map(place),
            None => {
                let finite = values.map(place).filter(|v| v.is_finite());
                let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
                match (low < high, low.is_finite()) {
                    (true, _) => [low - 0.04 * (high - low), high + 0.04 * (high - low)],
                    (false, true) => [low - 0.5, low + 0.5],
                    _ => [0.0, 1.0],
                }
            }
        };
        Self { log, range, pixels }
    }

    /// Where a value lies, pixels; `None` for what has no place on the axis.
    pub fn at(&self, value: f64) -> Option<f64> {
        let v = if self.log { libm::log10(value) } else { value };
        let [low, high] = self.range;
        let [from, to] = self.pixels;
        Some(from + (v - low) / (high - low) * (to - from)).filter(|p| p.is_finite())
    }

    /// Marks along the axis.
    pub fn ticks(&self) -> Vec<Tick> {
        let [low, high] = self.range;
        if self.log { log_ticks(low, high) } else { linear_ticks(low, high) }
    }
}

/// Four to eight round numbers.
fn linear_ticks(low: f64, high: f64) -> Vec<Tick> {
    let rough = (high - low) / 6.0;
    let power = libm::exp10(libm::floor(libm::log10(rough)));
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    let digits = (-libm::floor(libm::log10(step))).max(0.0) as usize;
    let (from, to) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    let text = |v: f64| format!("{:.*}", digits, v + 0.0);
    (from..=to).map(|i| i as f64 * step).map(|at| Tick { at, text: Some(text(at)) }).collect()
}

/// Powers of ten, with two and five between them where there is room.
fn log_ticks(low: f64, high: f64) -> Vec<Tick> {
    let skip = ((high - low) / 7.0).ceil().max(1.0) as i32;
    let (from, to) = (low.floor() as i32, high.ceil() as i32);
    let mut ticks = Vec::new();
    for decade in from..=to {
        for m in 1..10 {
            let at = m as f64 * libm::exp10(decade as f64);
            let l = libm::log10(at);
            if l < low - 1e-9 || l > high + 1e-9 {
                continue;
            }
            let named = if high - low < 2.2 { [1, 2, 5].contains(&m) } else { m == 1 && decade % skip == 0 };
            if named || skip == 1 {
                ticks.push(Tick { at, text: named.then(|| power_text(m, decade)) });
            }
        }
    }
    ticks
}

fn power_text(m: i32, decade: i32) -> String {
    if (-2..=3).contains(&decade) {
        let digits = (-decade).max(0) as usize;
        return format!("{:.*}", digits, m as f64 * libm::exp10(decade as f64));
    }
    let raised: String = decade.to_string().chars().map(superscript).collect();
    if m == 1 { format!("10{raised}") } else { format!("{m}·10{raised}") }
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: &Scale) -> Vec<String> {
        scale.ticks().into_iter().filter_map(|t| t.text).collect()
    }

    #[test]
    fn round_numbers_are_marked() {
        let unit = Scale::of(&Axis::linear("").spanning(0.0, 1.0), [].into_iter(), [0.0, 100.0]);
        assert_eq!(texts(&unit), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(unit.at(0.25), Some(25.0));
        let log = Scale::of(&Axis::log(""), [1e-4, 100.0].into_iter(), [0.0, 100.0]);
        assert_eq!(texts(&log), ["10⁻⁴", "10⁻³", "0.01", "0.1", "1", "10", "100"]);
        assert_eq!(log.at(0.0), None);
        let few = Scale::of(&Axis::log(""), [3.0, 20.0].into_iter(), [0.0, 100.0]);
        assert_eq!(texts(&few), ["5", "10", "20"]);
        let one = Scale::of(&Axis::linear(""), [5.0].into_iter(), [0.0, 10.0]);
        assert_eq!(one.at(5.0), Some(5.0));
        assert!(Scale::of(&Axis::log(""), [].into_iter(), [0.0, 10.0]).at(2.0).is_some());
    }
}
