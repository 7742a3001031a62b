//! Near misses: which known word was probably meant.

/// The known word closest to `word`, if it is close enough to be a slip.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A slip in every third letter, at least one, is still a slip.
    let limit = (word.chars().count() / 3).clamp(1, 4);
    let best = known.into_iter().map(|k| (distance(word, k), k)).min()?;
    (best.0 <= limit).then_some(best.1)
}

/// Optimal string alignment: insertions, deletions, substitutions and swaps of neighbours, case ignored.
fn distance(a: &str, b: &str) -> usize {
    // Longer than any key we know: not worth a table of that size.
    const LONGEST: usize = 64;
    let fold = |s: &str| s.chars().take(LONGEST).map(|c| c.to_ascii_lowercase()).collect::<Vec<_>>();
    let (a, b) = (fold(a), fold(b));
    let mut rows = vec![vec![0usize; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let mut least = change.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    least = least.min(rows[i - 2][j - 2] + 1);
                }
                least
            };
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        let known = ["talus_angle_deg", "duration_h", "seed"];
        assert_eq!(nearest("talus_angel_deg", known), Some("talus_angle_deg"));
        assert_eq!(nearest("sed", known), Some("seed"));
        assert_eq!(nearest("Duration_H", known), Some("duration_h"));
        assert_eq!(nearest("wind", known), None);
        assert_eq!(nearest("", known), None);
    }

    #[test]
    fn distances() {
        assert_eq!(distance("angel", "angle"), 1);
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
    }
}
