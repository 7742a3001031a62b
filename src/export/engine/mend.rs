//! What to add to a recipe so that its world is fine enough for an engine: stages that zoom into the part wanted, and let water
//! work on the detail that each adds.

/// Distance between vertices that a player's feet don't mind, m.
const FINE_M: f64 = 5.0;
/// How many times smaller the window of one zoom may be: streams between two zooms shape what lies between.
const MOST_AT_ONCE: f64 = 20.0;
/// Years that streams get for each metre of a window's side, and at least: detail is noise until water has worked on it.
const YEARS_PER_M: f64 = 2.0;
const LEAST_YEARS: f64 = 10e3;
/// Steps that they take.
const STEPS: f64 = 20.0;

/// A square part of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Middle, m.
    pub middle_m: [f64; 2],
    /// Side, m.
    pub side_m: f64,
}

/// Stages, in TOML, that go from a map of this extent to a part of it which `vertices` a side cover finely.
/// `wanted` is the part if it is fine enough by itself.
pub fn zooms(extent_m: [f64; 2], vertices: usize, wanted: Part) -> String {
    let fine_m = (vertices.max(2) - 1) as f64 * FINE_M;
    let shorter_m = extent_m[0].min(extent_m[1]);
    let longer_m = extent_m[0].max(extent_m[1]);
    let last_m = wanted.side_m.min(fine_m).min(shorter_m);
    let steps = (libm::log(longer_m / last_m) / libm::log(MOST_AT_ONCE) - 1e-9).ceil().max(1.0) as i32;
    let mut text = String::new();
    let (mut corner_m, mut now_m) = ([0.0, 0.0], extent_m);
    for step in 1..=steps {
        let share = step as f64 / steps as f64;
        let side_m = (longer_m * libm::pow(last_m / longer_m, share)).min(now_m[0].min(now_m[1]));
        let place = |axis: usize| {
            let from_m = wanted.middle_m[axis] - corner_m[axis] - 0.5 * side_m;
            from_m.clamp(0.0, now_m[axis] - side_m)
        };
        // Down to whole metres, so that nothing is rounded off the map.
        let [x_m, y_m, whole_m] = [place(0), place(1), side_m].map(|m| (m + 1e-6).floor());
        let [x_km, y_km, side_km] = [x_m, y_m, whole_m].map(km);
        text += &format!("\n  [[stage]]\n  kind = \"zoom\"\n  window_km = [{x_km}, {y_km}, {side_km}]");
        text += &streams(whole_m);
        corner_m = [corner_m[0] + x_m, corner_m[1] + y_m];
        now_m = [whole_m; 2];
    }
    text + "\n  [[stage]]\n  kind = \"rivers\""
}

/// The stage that lets streams carve a window.
fn streams(side_m: f64) -> String {
    let kyr = (1e-3 * (YEARS_PER_M * side_m).max(LEAST_YEARS)).round();
    format!(
        "\n  [[stage]]\n  kind = \"stream_power\"\n  duration_myr = {}\n  step_kyr = {}\n  talus_all_round = true\n  rim = \"held\"",
        kyr * 1e-3,
        kyr / STEPS
    )
}

/// Whole metres as kilometres.
fn km(m: f64) -> String {
    let text = format!("{:.3}", m * 1e-3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_nested_and_end_fine() {
        let whole = Part { middle_m: [500e3, 500e3], side_m: 1000e3 };
        let text = zooms([1000e3, 1000e3], 1009, whole);
        let sides: Vec<&str> = text.lines().filter(|line| line.contains("window_km")).collect();
        assert_eq!(
            sides,
            ["  window_km = [464.503, 464.503, 70.992]", "  window_km = [32.977, 32.977, 5.04]"],
            "{text}"
        );
        // A part near the corner stays on the map.
        let corner = Part { middle_m: [100.0, 100.0], side_m: 2e3 };
        let text = zooms([100e3, 100e3], 1009, corner);
        assert!(text.contains("[0, 0, ") && text.contains(", 2]\n"), "{text}");
        // What a zoom adds is carved, and in the end there are rivers.
        let kinds: Vec<&str> = text.lines().filter(|line| line.contains("kind")).map(str::trim).collect();
        let [zoom, streams] = ["kind = \"zoom\"", "kind = \"stream_power\""];
        assert_eq!(kinds, [zoom, streams, zoom, streams, "kind = \"rivers\""], "{text}");
    }
}
