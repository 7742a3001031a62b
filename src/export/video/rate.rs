//! Frames a second as a fraction, for 29.97 is 30000/1001.

use std::fmt;

/// Frames a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// Frames ...
    pub frames: u32,
    /// ... in so many seconds.
    pub seconds: u32,
}

/// The broadcast rates that decimals stand for.
const BROADCAST: [(&str, u32); 5] =
    [("23.976", 24_000), ("23.98", 24_000), ("29.97", 30_000), ("59.94", 60_000), ("119.88", 120_000)];

impl Rate {
    /// A whole number of frames a second.
    pub const fn whole(frames: u32) -> Self {
        Self { frames, seconds: 1 }
    }

    /// `30`, `12.5`, `29.97` or `30000/1001`; from 1 to 240.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let rate = match (BROADCAST.iter().find(|(name, _)| *name == text), text.split_once('/')) {
            (Some(&(_, frames)), _) => Self { frames, seconds: 1001 },
            (None, Some((frames, seconds))) => Self { frames: frames.parse().ok()?, seconds: seconds.parse().ok()? },
            (None, None) => Self::decimal(text)?,
        };
        (rate.seconds > 0 && (1.0..=240.0).contains(&rate.per_second())).then(|| rate.reduced())
    }

    /// Up to three decimals.
    fn decimal(text: &str) -> Option<Self> {
        let (whole, rest) = text.split_once('.').unwrap_or((text, ""));
        if rest.len() > 3
            || !text.starts_with(|c: char| c.is_ascii_digit())
            || !rest.chars().all(|c| c.is_ascii_digit())
        {
            return None;
        }
        let thousandths: u32 = format!("{rest:0<3}").parse().ok()?;
        let frames = whole.parse::<u32>().ok()?.checked_mul(1000)?.checked_add(thousandths)?;
        Some(Self { frames, seconds: 1000 })
    }

    fn reduced(self) -> Self {
        let (mut a, mut b) = (self.frames, self.seconds);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        Self { frames: self.frames / a, seconds: self.seconds / a }
    }

    /// As a number.
    pub fn per_second(self) -> f64 {
        self.frames as f64 / self.seconds as f64
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = BROADCAST.iter().find(|(_, frames)| *frames == self.frames && self.seconds == 1001);
        match name {
            Some((name, _)) => f.write_str(name),
            None => write!(f, "{}", (self.per_second() * 1000.0).round() / 1000.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_exact_fractions() {
        let of = |text: &str| Rate::parse(text).map(|rate| (rate.frames, rate.seconds, rate.to_string()));
        let is = |frames, seconds, text: &str| Some((frames, seconds, text.to_owned()));
        assert_eq!(of("30"), is(30, 1, "30"));
        assert_eq!(of("12.5"), is(25, 2, "12.5"));
        assert_eq!(of("29.97"), is(30_000, 1001, "29.97"));
        assert_eq!(of("24000/1001"), is(24_000, 1001, "23.976"));
        assert_eq!(of("240"), is(240, 1, "240"));
        for bad in ["", "0", "-3", "1e9", "241", "x", "30/0", "0.5", "3.1415", ".5", "+5"] {
            assert!(of(bad).is_none(), "{bad}");
        }
    }
}
