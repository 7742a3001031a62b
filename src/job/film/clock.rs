//! Time in true units, as a film shows it.

const DAYS_PER_YEAR: f64 = 365.25;

/// The time since the recipe began, in units that change visibly from picture to picture, but slowly enough to read.
/// Where pictures are less than a day apart, it is counted from the stage's beginning: day 3, 00:41.
pub fn text(time_yr: f64, in_stage_yr: f64, per_picture_yr: f64) -> String {
    if per_picture_yr <= 0.0 {
        return coarse(time_yr);
    }
    if per_picture_yr >= 1000.0 {
        let digits = if per_picture_yr >= 30_000.0 { 1 } else { 2 };
        return format!("{:.digits$} My", time_yr * 1e-6);
    }
    if per_picture_yr * DAYS_PER_YEAR >= 30.0 {
        return format!("{} yr", grouped(time_yr.floor() as u64));
    }
    let minutes = (in_stage_yr * DAYS_PER_YEAR * 1440.0 + 1e-6).floor().max(0.0) as u64;
    let (day, hour, minute) = (minutes / 1440, minutes / 60 % 24, minutes % 60);
    format!("day {}, {hour:02}:{minute:02}", grouped(day + 1))
}

/// A moment at which the world's clock stands.
fn coarse(time_yr: f64) -> String {
    if time_yr >= 100_000.0 {
        format!("{:.1} My", time_yr * 1e-6)
    } else {
        format!("{} yr", grouped(time_yr.floor() as u64))
    }
}

/// Commas between thousands, from five digits on.
fn grouped(value: u64) -> String {
    let plain = value.to_string();
    let mut out = String::new();
    for (i, digit) in plain.chars().enumerate() {
        if i > 0 && plain.len() > 4 && (plain.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_the_pace() {
        const HOUR_YR: f64 = 1.0 / (24.0 * DAYS_PER_YEAR);
        assert_eq!(text(12.4e6, 12.4e6, 70_000.0), "12.4 My");
        assert_eq!(text(12.412e6, 12.4e6, 5_000.0), "12.41 My");
        assert_eq!(text(23_456.7, 3_456.0, 40.0), "23,456 yr");
        assert_eq!(text(12.4e6, (48.0 + 41.0 / 60.0) * HOUR_YR, 0.1 * HOUR_YR), "day 3, 00:41");
        assert_eq!(text(10e6, 0.0, 0.0), "10.0 My");
        assert_eq!(text(0.0, 0.0, 0.0), "0 yr");
    }
}
