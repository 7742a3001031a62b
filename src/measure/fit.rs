//! Straight lines through points, and the log-binned medians that power laws are read from.

use serde::Serialize;

/// A line by least squares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Rise per unit of x.
    pub slope: f64,
    /// Value at x = 0.
    pub intercept: f64,
    /// Share of the variance that the line explains, 0 to 1.
    pub r2: f64,
}

impl Line {
    /// The line through points; `None` of fewer than two different x.
    pub fn through(points: &[[f64; 2]]) -> Option<Line> {
        let n = points.len() as f64;
        let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / n;
        let (mx, my) = (mean(0), mean(1));
        let (mut sxx, mut sxy, mut syy) = (0.0, 0.0, 0.0);
        for &[x, y] in points {
            let (dx, dy) = (x - mx, y - my);
            (sxx, sxy, syy) = (sxx + dx * dx, sxy + dx * dy, syy + dy * dy);
        }
        if points.len() < 2 || sxx <= 0.0 {
            return None;
        }
        let slope = sxy / sxx;
        let r2 = if syy > 0.0 { sxy * sxy / (sxx * syy) } else { 1.0 };
        Some(Line { slope, intercept: my - slope * mx, r2 })
    }

    /// The line through the decimal logarithms of points: a power law, whose exponent is the slope.
    pub fn through_logs(points: &[[f64; 2]]) -> Option<Line> {
        Line::through(&points.iter().map(|p| p.map(libm::log10)).collect::<Vec<_>>())
    }
}

/// Medians of y in bins of x that are equally wide on a logarithmic scale, `per_decade` to a decade: `[x, y]` with the
/// geometric mean of the bin's x. Bins of fewer than `least` points are left out; so are points that are not above 0.
pub fn log_bins(points: impl IntoIterator<Item = [f64; 2]>, per_decade: f64, least: usize) -> Vec<[f64; 2]> {
    let positive = points.into_iter().filter(|p| p[0] > 0.0 && p[1] > 0.0);
    let mut sorted: Vec<(i32, [f64; 2])> =
        positive.map(|p| p.map(libm::log10)).map(|p| ((p[0] * per_decade).floor() as i32, p)).collect();
    sorted.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1[1].total_cmp(&b.1[1])).then(a.1[0].total_cmp(&b.1[0])));
    let bins = sorted.chunk_by(|a, b| a.0 == b.0).filter(|bin| bin.len() >= least.max(1));
    bins.map(|bin| {
        let x = bin.iter().map(|(_, p)| p[0]).sum::<f64>() / bin.len() as f64;
        let y = 0.5 * (bin[(bin.len() - 1) / 2].1[1] + bin[bin.len() / 2].1[1]);
        [libm::exp10(x), libm::exp10(y)]
    })
    .collect()
}

/// The middle value; `None` of none.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The value below which a share of the values lies, linear between neighbours; `None` of none.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let at = share * sorted.len().checked_sub(1)? as f64;
    let (i, t) = (at as usize, at.fract());
    let next = sorted[(i + 1).min(sorted.len() - 1)];
    Some(sorted[i] + (next - sorted[i]) * t)
}

/// At most `most` of the points, spread evenly: what a plot can show.
pub fn thinned(points: &[[f64; 2]], most: usize) -> Vec<[f64; 2]> {
    let step = points.len().div_ceil(most.max(1)).max(1);
    points.iter().copied().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_read_back() {
        let points: Vec<[f64; 2]> = (1..2000).map(|i| [i as f64, 3.0 * (i as f64).powf(-0.45)]).collect();
        let line = Line::through_logs(&log_bins(points.iter().copied(), 5.0, 3)).unwrap();
        // The median stands in the middle of a bin, the mean of the logs near it: a fifth of a decade apart at most.
        assert!((line.slope + 0.45).abs() < 0.01 && line.r2 > 0.999, "{line:?}");
        let exact = Line::through_logs(&points).unwrap();
        assert!((exact.slope + 0.45).abs() < 1e-12 && (exact.intercept - 3f64.log10()).abs() < 1e-12);
        assert_eq!(Line::through(&[[1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(Line::through(&[]), None);
    }

    #[test]
    fn ranks_of_a_few() {
        assert_eq!(quantile(&[4.0, 0.0, 2.0], 0.25), Some(1.0));
        assert_eq!((median(&[3.0]), median(&[])), (Some(3.0), None));
        assert_eq!(thinned(&[[0.0, 0.0]; 10], 4).len(), 4);
    }
}
