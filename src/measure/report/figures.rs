//! The figures of a report: each a plot of one world, or of many over one another.

use super::{
    Subject,
    axis::Axis,
    plot::{Mark, Plot},
};
use crate::measure::{Band, Line, METRICS, OrderRow, Spectrum, Survey};

/// A plot with its words.
pub struct Figure {
    /// Name of its file, without ending.
    pub name: &'static str,
    /// What it is called.
    pub title: &'static str,
    /// What one sees in it.
    pub caption: String,
    /// The plot.
    pub plot: Plot,
}

/// Every figure that the worlds have something for.
pub fn figures(subjects: &[Subject]) -> Vec<Figure> {
    let surveys: Vec<&Survey> = subjects.iter().map(|s| &s.survey).collect();
    let all = [
        hypsometry(&surveys),
        slope_area(&surveys),
        chi(&surveys),
        hack(&surveys),
        numbers(&surveys),
        lengths(&surveys),
        areas(&surveys),
        exceedance(&surveys),
        transects(&surveys),
        plane(&surveys),
        variogram(&surveys),
        slopes(&surveys),
        heights(&surveys),
    ];
    all.into_iter().flatten().collect()
}

fn band(name: &str) -> Option<Band> {
    METRICS.iter().find(|m| m.name == name).and_then(|m| m.band)
}

/// A curve of one world, or one of many.
fn curve(surveys: &[&Survey], points: Vec<[f64; 2]>) -> Mark {
    if surveys.len() == 1 { Mark::Curve(points) } else { Mark::Many(points) }
}

/// Power laws of the band, through the middle of a world's own points: a bow tie.
fn laws(band: Option<Band>, sign: f64, points: &[[f64; 2]]) -> Option<Mark> {
    let (low, high) = band.and_then(|band| band.low.zip(band.high))?;
    let n = points.len() as f64;
    let middle = |axis: usize| libm::exp10(points.iter().map(|p| libm::log10(p[axis])).sum::<f64>() / n);
    let [x, y] = [middle(0), middle(1)];
    let least = points.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min) / 3.0;
    let most = points.iter().map(|p| p[0]).fold(0.0, f64::max) * 3.0;
    let at = |to: f64, exponent: f64| [to, y * libm::pow(to / x, sign * exponent)];
    let tie = vec![at(least, low), [x, y], at(most, low), at(most, high), [x, y], at(least, high)];
    tie.iter().flatten().all(|v| v.is_finite()).then_some(Mark::Earth(tie))
}

/// A fitted power law over a range of x.
fn law(line: &Line, from: f64, to: f64) -> Mark {
    Mark::Fit([from, to].map(|x| [x, libm::exp10(line.intercept + line.slope * libm::log10(x))]).to_vec())
}

fn ends(points: &[[f64; 2]]) -> [f64; 2] {
    points.iter().fold([f64::INFINITY, 0.0], |[low, high], p| [low.min(p[0]), high.max(p[0])])
}

/// What stands in a plot of power laws: the medians of all worlds, the cloud and the law of a single one.
struct Law<'a> {
    medians: Vec<[f64; 2]>,
    sample: Vec<[f64; 2]>,
    line: &'a Line,
    fitted: [f64; 2],
}

fn law_marks(metric: &str, sign: f64, laws_found: &[Law]) -> Vec<Mark> {
    let pivot: Vec<[f64; 2]> = laws_found
        .iter()
        .flat_map(|l| l.medians.iter().copied().filter(|p| p[0] >= l.fitted[0] && p[0] <= l.fitted[1] && p[1] > 0.0))
        .collect();
    let mut marks: Vec<Mark> = laws(band(metric), sign, &pivot).into_iter().collect();
    match laws_found {
        [one] => {
            marks.push(Mark::Dots(one.sample.clone()));
            marks.push(law(one.line, one.fitted[0], one.fitted[1]));
            // Many points are a curve.
            let medians = one.medians.clone();
            marks.push(if medians.len() > 20 { Mark::Curve(medians) } else { Mark::Points(medians) });
        }
        many => marks.extend(many.iter().map(|l| Mark::Many(l.medians.clone()))),
    }
    marks
}

fn in_band(metric: &str) -> String {
    band(metric).map_or(String::new(), |band| format!(" Shaded: {band}, as on Earth."))
}

fn hypsometry(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<_> = surveys.iter().filter_map(|s| s.basins.as_ref().ok()).collect();
    found.first()?;
    // Of all curves h = (1 − a)^q, with an integral of 1/(q + 1), those of the band.
    let family = |integral: f64, a: f64| [a, libm::pow(1.0 - a, 1.0 / integral - 1.0)];
    let shares = || (0..=40).map(|i| i as f64 / 40.0);
    let mut marks = Vec::new();
    if let Some((low, high)) = band("hypsometric_integral").and_then(|b| b.low.zip(b.high)) {
        let there = shares().map(|a| family(low, a));
        marks.push(Mark::Earth(there.chain(shares().rev().map(|a| family(high, a))).collect()));
    }
    marks.extend(found.iter().map(|basins| curve(surveys, basins.curve.clone())));
    Some(Figure {
        name: "hypsometry",
        title: "Hypsometric curve",
        caption: format!(
            "Share of a basin's area that stands over a share of its relief, mean of the largest basins.{}",
            in_band("hypsometric_integral").replace(": ", ": integrals ")
        ),
        plot: Plot {
            x: Axis::linear("share of the area").spanning(0.0, 1.0),
            y: Axis::linear("share of the relief").spanning(0.0, 1.0),
            marks,
        },
    })
}

fn slope_area(surveys: &[&Survey]) -> Option<Figure> {
    let km2 = |points: &[[f64; 2]]| points.iter().map(|p| [p[0] * 1e-6, p[1]]).collect::<Vec<_>>();
    let lines: Vec<_> = surveys.iter().filter_map(|s| s.slope_area.as_ref().ok()).collect();
    // The same law with its areas in km².
    let in_km2: Vec<Line> =
        lines.iter().map(|f| Line { intercept: f.line.intercept + 6.0 * f.line.slope, ..f.line }).collect();
    let found: Vec<Law> = lines
        .iter()
        .zip(&in_km2)
        .map(|(f, line)| {
            let medians = km2(&f.medians);
            Law { fitted: ends(&medians), medians, sample: km2(&f.sample), line }
        })
        .collect();
    found.first()?;
    Some(Figure {
        name: "slope-area",
        title: "Slope against area",
        caption: format!("Channel cells, and their medians by area. Concavity is the fall.{}", in_band("concavity")),
        plot: Plot {
            x: Axis::log("catchment, km²"),
            y: Axis::log("slope, m/m"),
            marks: law_marks("concavity", -1.0, &found),
        },
    })
}

fn chi(surveys: &[&Survey]) -> Option<Figure> {
    let [survey] = surveys else { return None };
    let chi = survey.chi.as_ref().ok()?;
    let to = ends(&chi.sample)[1];
    let fit = [0.0, to].map(|x| [x, chi.line.intercept + chi.line.slope * x]).to_vec();
    Some(Figure {
        name: "chi",
        title: "χ plot",
        caption: format!(
            "Channels of the largest basin: height over χ is one straight line where uplift and rivers balance. R² {:.2} here.",
            chi.line.r2
        ),
        plot: Plot {
            x: Axis::linear("χ with θ = 0.45 and A₀ = 1 m², m"),
            y: Axis::linear("height over the mouth, m"),
            marks: vec![Mark::Dots(chi.sample.clone()), Mark::Fit(fit)],
        },
    })
}

fn hack(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<Law> = surveys
        .iter()
        .filter_map(|s| s.hack.as_ref().ok())
        .map(|h| Law { medians: h.medians.clone(), sample: h.sample.clone(), line: &h.line, fitted: h.fitted_km2 })
        .collect();
    found.first()?;
    Some(Figure {
        name: "hack",
        title: "Hack's law",
        caption: format!("Longest stream of the basin above each channel cell.{}", in_band("hack_exponent")),
        plot: Plot {
            x: Axis::log("area of the basin, km²"),
            y: Axis::log("longest stream, km"),
            marks: law_marks("hack_exponent", 1.0, &found),
        },
    })
}

fn numbers(surveys: &[&Survey]) -> Option<Figure> {
    let words = ("horton-numbers", "Streams by order", "streams");
    by_order(surveys, words, "bifurcation_ratio", -1.0, |o| o.streams as f64)
}

fn lengths(surveys: &[&Survey]) -> Option<Figure> {
    let words = ("horton-lengths", "Length by order", "mean length, km");
    by_order(surveys, words, "length_ratio", 1.0, |o| o.length_km)
}

fn areas(surveys: &[&Survey]) -> Option<Figure> {
    let words = ("horton-areas", "Catchment by order", "mean catchment, km²");
    by_order(surveys, words, "area_ratio", 1.0, |o| o.area_km2)
}

fn by_order(
    surveys: &[&Survey],
    (name, title, label): (&'static str, &'static str, &'static str),
    metric: &str,
    sign: f64,
    of: fn(&OrderRow) -> f64,
) -> Option<Figure> {
    let found: Vec<Vec<[f64; 2]>> = surveys
        .iter()
        .filter_map(|s| s.horton.as_ref().ok())
        .map(|h| h.orders.iter().map(|o| [o.order as f64, of(o)]).filter(|p| p[1] > 0.0).collect())
        .collect();
    let first = found.first()?.first()?[1];
    let most = found.iter().map(Vec::len).max()? as f64;
    let mut marks = Vec::new();
    if let Some((low, high)) = band(metric).and_then(|b| b.low.zip(b.high)) {
        let at = |ratio: f64| [most + 1.0, first * libm::pow(ratio, sign * most)];
        marks.push(Mark::Earth(vec![[1.0, first], at(low), at(high)]));
    }
    if let [one] = &found[..] {
        marks.push(Mark::Points(one.clone()));
    }
    marks.extend(found.iter().map(|points| curve(surveys, points.clone())));
    let shaded = in_band(metric).replace(": ", ": ratios ");
    Some(Figure {
        name,
        title,
        caption: format!("By Strahler's order.{shaded}"),
        plot: Plot { x: Axis::linear("order").spanning(0.5, most + 0.5), y: Axis::log(label), marks },
    })
}

fn exceedance(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<Law> = surveys
        .iter()
        .filter_map(|s| s.exceedance.as_ref().ok())
        .map(|e| Law { medians: e.curve.clone(), sample: Vec::new(), line: &e.line, fitted: e.fitted_km2 })
        .collect();
    found.first()?;
    Some(Figure {
        name: "exceedance",
        title: "Area exceedance",
        caption: format!("Share of the largest basin that drains more than an area.{}", in_band("area_exceedance")),
        plot: Plot {
            x: Axis::log("area drained, km²"),
            y: Axis::log("share of the basin"),
            marks: law_marks("area_exceedance", -1.0, &found),
        },
    })
}

fn transects(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<&Spectrum> = surveys.iter().filter_map(|s| Some(&s.spectra.as_ref().ok()?.transect)).collect();
    let caption = "Power along rows and columns of squares of land.";
    spectrum(&found, ("spectrum-transects", "Spectrum of transects", caption), "power, m²·km", "transect_spectrum")
}

fn plane(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<&Spectrum> = surveys.iter().filter_map(|s| Some(&s.spectra.as_ref().ok()?.radial)).collect();
    let caption = "Mean power of the plane's modes.";
    spectrum(&found, ("spectrum-plane", "Spectrum of the plane", caption), "power, m²·km²", "radial_spectrum")
}

fn spectrum(
    found: &[&Spectrum],
    (name, title, caption): (&'static str, &'static str, &str),
    label: &'static str,
    metric: &str,
) -> Option<Figure> {
    found.first()?;
    let mut marks: Vec<Mark> = Vec::new();
    let within = |s: &&Spectrum| {
        let [from, to] = s.fitted;
        s.points.iter().copied().filter(|p| p[0] >= from && p[0] <= to).collect::<Vec<_>>()
    };
    // Waves lie ever closer; a law through the ends weighs all decades alike.
    let pivot: Vec<[f64; 2]> = found
        .iter()
        .flat_map(|s| s.fitted.map(|k| [k, libm::exp10(s.line.intercept + s.line.slope * libm::log10(k))]))
        .collect();
    marks.extend(laws(band(metric), -1.0, &pivot));
    match found {
        [one] => {
            marks.push(Mark::Curve(one.points.clone()));
            marks.push(law(&one.line, one.fitted[0], one.fitted[1]));
        }
        many => marks.extend(many.iter().map(|s| Mark::Many(within(s)))),
    }
    Some(Figure {
        name,
        title,
        caption: format!("{caption}{}", in_band(metric).replace(": ", ": k^−β, β ")),
        plot: Plot { x: Axis::log("waves in a km"), y: Axis::log(label), marks },
    })
}

fn variogram(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<Law> = surveys
        .iter()
        .filter_map(|s| s.variogram.as_ref().ok())
        .map(|v| Law { medians: v.points.clone(), sample: Vec::new(), line: &v.line, fitted: ends(&v.points) })
        .collect();
    found.first()?;
    let mut marks = law_marks("", 1.0, &found);
    let exponents = band("fractal_dimension").and_then(|b| b.low.zip(b.high));
    let exponents = exponents.map(|(low, high)| Band::new(2.0 * (3.0 - high), 2.0 * (3.0 - low)));
    let pivot: Vec<[f64; 2]> = found.iter().flat_map(|l| l.medians.clone()).collect();
    marks.extend(laws(exponents, 1.0, &pivot));
    Some(Figure {
        name: "variogram",
        title: "Variogram",
        caption: format!(
            "How heights differ with distance; the rougher, the flatter.{}",
            in_band("fractal_dimension").replace(": ", ": dimension ")
        ),
        plot: Plot { x: Axis::log("distance, km"), y: Axis::log("semivariance, m²"), marks },
    })
}

fn slopes(surveys: &[&Survey]) -> Option<Figure> {
    let found: Vec<_> = surveys.iter().filter_map(|s| s.slopes.as_ref().ok()).collect();
    let bins = found.first()?.histogram.len();
    let width = 90.0 / bins as f64;
    let mut marks = Vec::new();
    let most = found.iter().flat_map(|s| s.histogram.iter().copied()).fold(0.0, f64::max);
    let last = found.iter().filter_map(|s| s.histogram.iter().rposition(|&h| h > 0.0)).max().unwrap_or(0);
    let steepest = ((last + 1) as f64 * width).max(45.0);
    let comparable = METRICS
        .iter()
        .any(|m| m.name == "mean_slope" && m.cells_m.is_none_or(|cells| surveys.iter().all(|s| cells.holds(s.cell_m))));
    if let Some((low, high)) = band("mean_slope").and_then(|b| b.low.zip(b.high)).filter(|_| comparable) {
        marks.push(Mark::Earth(vec![[low, 0.0], [low, 2.0], [high, 2.0], [high, 0.0]]));
    }
    if let [one] = &found[..] {
        let bars = one.histogram.iter().enumerate();
        marks.push(Mark::Bars(bars.map(|(i, &h)| [i as f64 * width, (i + 1) as f64 * width, h]).collect()));
    } else {
        let middle = |i: usize| (i as f64 + 0.5) * width;
        marks.extend(
            found.iter().map(|s| Mark::Many(s.histogram.iter().enumerate().map(|(i, &h)| [middle(i), h]).collect())),
        );
    }
    let shaded = if comparable { " Shaded: means of active ranges." } else { " Cells this large even slopes out." };
    Some(Figure {
        name: "slopes",
        title: "Slopes of the land",
        caption: format!("Share of the land by slope.{shaded}"),
        plot: Plot {
            x: Axis::linear("slope, degrees").spanning(0.0, steepest),
            y: Axis::linear("share of the land").spanning(0.0, (1.06 * most).max(0.05)),
            marks,
        },
    })
}

fn heights(surveys: &[&Survey]) -> Option<Figure> {
    let km = |points: &[[f64; 2]]| points.iter().map(|p| [p[0] * 1e-3, p[1]]).collect::<Vec<_>>();
    let there = |p: &&[f64; 2]| p[1] > 0.0;
    let used: Vec<f64> = surveys.iter().flat_map(|s| s.heights.iter().filter(there).map(|p| p[0] * 1e-3)).collect();
    let low = used.iter().copied().fold(f64::INFINITY, f64::min) - 0.5;
    let high = used.iter().copied().fold(f64::NEG_INFINITY, f64::max) + 0.5;
    let most = surveys.iter().flat_map(|s| s.heights.iter().map(|p| p[1])).fold(0.0, f64::max);
    if used.is_empty() {
        return None;
    }
    let marks = match surveys {
        [one] => vec![Mark::Bars(km(&one.heights).iter().map(|p| [p[0] - 0.125, p[0] + 0.125, p[1]]).collect())],
        many => many.iter().map(|s| Mark::Many(km(&s.heights))).collect(),
    };
    Some(Figure {
        name: "heights",
        title: "Heights of the map",
        caption:
            "Share of the map by height. Earth has two humps: continents at 0.1 to 0.8 km, ocean floors at −4 to −5 km."
                .to_owned(),
        plot: Plot {
            x: Axis::linear("height over the sea, km").spanning(low, high),
            y: Axis::linear("share of the map").spanning(0.0, 1.06 * most),
            marks,
        },
    })
}
