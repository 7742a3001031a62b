//! When how much lava comes out.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Seconds of an hour.
pub(super) const HOUR_S: f64 = 3600.0;

/// A part of the schedule: a rate from a moment on, in particles or in volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// When it begins, after the stage does.
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "s"))]
    pub start_time: f64,
    /// How long it lasts; to the end of the stage if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "s"))]
    pub duration: Option<f64>,
    /// Particles a second; how much that is depends on their size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "1/s"))]
    pub particles_per_second: Option<f64>,
    /// Volume a second, whatever the particles' size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e18), extend("x-unit" = "m3/s"))]
    pub m3_per_s: Option<f64>,
}

impl Key {
    /// So many particles a second.
    pub fn particles(start_time: f64, duration: f64, rate: f64) -> Self {
        Self { start_time, duration: Some(duration), particles_per_second: Some(rate), m3_per_s: None }
    }

    /// So many cubic metres a second.
    pub fn volume(start_time: f64, duration: f64, rate: f64) -> Self {
        Self { start_time, duration: Some(duration), particles_per_second: None, m3_per_s: Some(rate) }
    }
}

/// A part of the schedule: a rate from a moment on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SheetKey {
    /// When it begins, after the stage does.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "h"))]
    pub start_h: f64,
    /// How long it lasts; to the end of the stage if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "h"))]
    pub duration_h: Option<f64>,
    /// Lava that comes out of all vents together.
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "m3/s"))]
    pub m3_per_s: f64,
}

/// A rate and when it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    from_s: f64,
    to_s: f64,
    particles_per_s: f64,
    m3_per_s: f64,
}

/// The whole schedule. Keys may stand in any order, and where several hold their rates add up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schedule {
    spans: Vec<Span>,
}

impl Key {
    fn span(&self) -> Result<Span, String> {
        let numbers = [Some(self.start_time), self.duration, self.particles_per_second, self.m3_per_s];
        if numbers.iter().flatten().any(|n| !n.is_finite() || *n < 0.0) {
            return Err("start_time, duration and rate must be numbers of at least 0".into());
        }
        let (particles_per_s, m3_per_s) = match (self.particles_per_second, self.m3_per_s) {
            (Some(particles), None) => (particles, 0.0),
            (None, Some(volume)) => (0.0, volume),
            (None, None) => return Err("it needs a rate: particles_per_second or m3_per_s".into()),
            (Some(_), Some(_)) => return Err("it has two rates; give particles_per_second or m3_per_s".into()),
        };
        let to_s = self.start_time + self.duration.unwrap_or(f64::INFINITY);
        Ok(Span { from_s: self.start_time, to_s, particles_per_s, m3_per_s })
    }
}

impl SheetKey {
    fn span(&self) -> Result<Span, String> {
        let numbers = [Some(self.start_h), self.duration_h, Some(self.m3_per_s)];
        if numbers.iter().flatten().any(|n| !n.is_finite() || *n < 0.0) {
            return Err("start_h, duration_h and m3_per_s must be numbers of at least 0".into());
        }
        let to_s = (self.start_h + self.duration_h.unwrap_or(f64::INFINITY)) * HOUR_S;
        Ok(Span { from_s: self.start_h * HOUR_S, to_s, particles_per_s: 0.0, m3_per_s: self.m3_per_s })
    }
}

impl Schedule {
    /// Checks keys; an error names the one that is wrong, counted from 1.
    pub fn new(keys: &[Key]) -> Result<Self, String> {
        Self::of(keys.iter().map(Key::span))
    }

    /// The same for the keys of a sheet.
    pub fn of_sheet(keys: &[SheetKey]) -> Result<Self, String> {
        Self::of(keys.iter().map(SheetKey::span))
    }

    fn of(spans: impl Iterator<Item = Result<Span, String>>) -> Result<Self, String> {
        let named = |(i, span): (usize, Result<Span, String>)| {
            span.map_err(|what| format!("key {} of the schedule: {what}", i + 1))
        };
        Ok(Self { spans: spans.enumerate().map(named).collect::<Result<_, _>>()? })
    }

    /// From the text of a JSON file: a list of keys.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let keys: Vec<Key> = serde_json::from_str(text)
            .map_err(|e| format!("is no list of {{ start_time, duration, particles_per_second }}: {e}"))?;
        Self::new(&keys)
    }

    /// Particles that come out between two moments, each of `volume_m3`.
    pub fn particles(&self, from_s: f64, to_s: f64, volume_m3: f64) -> f64 {
        let of = |span: &Span| {
            let long_s = span.to_s.min(to_s) - span.from_s.max(from_s);
            let rate = span.particles_per_s + span.m3_per_s / volume_m3;
            if long_s > 0.0 { rate * long_s } else { 0.0 }
        };
        self.spans.iter().map(of).sum()
    }

    /// Volume that comes out in a second at a moment, m³/s, of what is not counted in particles.
    pub fn rate_m3_per_s(&self, at_s: f64) -> f64 {
        let holds = |span: &&Span| span.from_s <= at_s && at_s < span.to_s;
        self.spans.iter().filter(holds).map(|span| span.m3_per_s).sum()
    }

    /// Spans until a moment as their lengths and rates, s and m³/s.
    pub(super) fn until(&self, end_s: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.spans.iter().map(move |span| ((span.to_s.min(end_s) - span.from_s).max(0.0), span.m3_per_s))
    }

    /// The times up to a moment in which anything comes out without a pause, from and to, s.
    pub fn spans(&self, until_s: f64) -> Vec<[f64; 2]> {
        let (mut spans, mut now) = (Vec::<[f64; 2]>::new(), 0.0);
        while now < until_s {
            let next = self.next_change(now).map_or(until_s, |next| next.min(until_s));
            if self.particles(now, next, 1.0) > 0.0 {
                match spans.last_mut() {
                    Some(last) if last[1] == now => last[1] = next,
                    _ => spans.push([now, next]),
                }
            }
            now = next;
        }
        spans
    }

    /// The next moment after `now_s` at which a rate begins or ends; `None` if that never happens.
    pub fn next_change(&self, now_s: f64) -> Option<f64> {
        let ends = self.spans.iter().flat_map(|span| [span.from_s, span.to_s]);
        ends.filter(|&at| at > now_s && at.is_finite()).reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_out_is_the_integral_of_the_rate() {
        let document = r#"[
            { "start_time": 0, "duration": 2, "particles_per_second": 3000 },
            { "start_time": 2, "duration": 10, "particles_per_second": 200 },
            { "start_time": 15, "duration": 1, "particles_per_second": 3000 }
        ]"#;
        let schedule = Schedule::from_json(document).unwrap();
        assert_eq!(schedule.particles(0.0, 90.0, 1.0), 11_000.0);
        assert_eq!(schedule.particles(1.5, 2.5, 1.0), 1600.0);
        assert_eq!(schedule.particles(12.0, 15.0, 1.0), 0.0);
        let step = |k: i32| schedule.particles(0.07 * k as f64, 0.07 * (k + 1) as f64, 1.0);
        assert!(((0..300).map(step).sum::<f64>() - 11_000.0).abs() < 1e-6);
        assert_eq!([0.0, 3.0, 20.0].map(|now| schedule.next_change(now)), [Some(2.0), Some(12.0), None]);
    }

    #[test]
    fn spans_are_where_anything_comes_out() {
        let keys = [Key::particles(2.0, 3.0, 1.0), Key::particles(5.0, 1.0, 4.0), Key::particles(9.0, 5.0, 1.0)];
        let schedule = Schedule::new(&[&keys[..], &[Key::particles(6.0, 2.0, 0.0)]].concat()).unwrap();
        assert_eq!(schedule.spans(12.0), [[2.0, 6.0], [9.0, 12.0]]);
        assert_eq!(schedule.spans(2.0), [[0.0; 2]; 0]);
        assert_eq!(Schedule::default().spans(5.0), [[0.0; 2]; 0]);
    }

    #[test]
    fn keys_may_overlap_stand_in_any_order_and_have_no_end() {
        let endless = Key { duration: None, ..Key::volume(5.0, 0.0, 2.0) };
        let schedule =
            Schedule::new(&[endless, Key::particles(4.0, 4.0, 10.0), Key::particles(0.0, 5.0, 1.0)]).unwrap();
        // 4 to 5: two keys; 5 to 8: two; 8 to 10: one. Half a cubic metre each.
        assert_eq!(schedule.particles(4.0, 10.0, 0.5), 1.0 + 40.0 + 20.0);
    }

    #[test]
    fn a_sheets_keys_are_the_same_in_hours() {
        let key = |start_h, duration_h, m3_per_s| SheetKey { start_h, duration_h, m3_per_s };
        let schedule = Schedule::of_sheet(&[key(1.0, Some(2.0), 5.0), key(2.0, None, 7.0)]).unwrap();
        assert_eq!([0.5, 1.0, 2.5, 3.0].map(|h| schedule.rate_m3_per_s(h * HOUR_S)), [0.0, 5.0, 12.0, 7.0]);
        assert_eq!(schedule.next_change(HOUR_S), Some(2.0 * HOUR_S));
        assert_eq!(schedule.until(4.0 * HOUR_S).collect::<Vec<_>>(), [(2.0 * HOUR_S, 5.0), (2.0 * HOUR_S, 7.0)]);
        assert!(Schedule::of_sheet(&[key(0.0, Some(-1.0), 1.0)]).unwrap_err().contains("key 1"));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let refused = |json: &str| Schedule::from_json(json).unwrap_err();
        assert!(refused(r#"[{"start_time": 0, "duration": -2, "particles_per_second": 1}]"#).contains("key 1"));
        assert!(refused(r#"[{"start_time": 0, "duration": 2}]"#).contains("needs a rate"));
        assert!(refused(r#"[{"start_time": 0, "particles_per_second": 1, "m3_per_s": 1}]"#).contains("two rates"));
        assert!(refused("{}").contains("is no list"));
        assert!(Schedule::new(&[Key::particles(f64::NAN, 1.0, 1.0)]).is_err());
    }
}
