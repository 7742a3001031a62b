//! A plot as SVG: axes, what was measured, and the band of Earth behind it.
//!
//! Colours come from the style sheet, so that the same picture serves light and dark pages and paper.

use std::fmt::Write as _;

use super::axis::{Axis, Scale};

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 44.0;

/// Colours and fonts of a plot, for light and dark.
pub const STYLE: &str = "\
:root{--paper:#fff;--ink:#1d2329;--soft:#66707a;--rule:#e3e6e9;--earth:#cfe3d3;--earth-ink:#3f7a52;--world:#b5502a;--dust:#8794a0}
@media screen and (prefers-color-scheme:dark){:root{--paper:#15191d;--ink:#e7e9eb;--soft:#9aa4ad;--rule:#2b3137;\
--earth:#28432f;--earth-ink:#86c598;--world:#f2925f;--dust:#7d8a96}}
svg.plot{font:12px system-ui,-apple-system,'Segoe UI',sans-serif;background:var(--paper)}
svg.plot text{fill:var(--soft)}svg.plot .name{fill:var(--ink)}
svg.plot .rule{stroke:var(--rule);stroke-width:1}svg.plot .frame{fill:none;stroke:var(--soft);stroke-width:1}
svg.plot .earth{fill:var(--earth)}svg.plot .dots{fill:var(--dust);opacity:.5}
svg.plot .points{fill:var(--world);stroke:var(--paper);stroke-width:1}
svg.plot .bars{fill:var(--world);opacity:.75}
svg.plot .curve{fill:none;stroke:var(--world);stroke-width:1.8;stroke-linejoin:round}
svg.plot .many{fill:none;stroke:var(--world);stroke-width:1.2;opacity:.45;stroke-linejoin:round}
svg.plot .fit{fill:none;stroke:var(--ink);stroke-width:1.4;stroke-dasharray:5 4}
";

/// Something drawn in a plot, in the units of its axes.
#[derive(Clone, Debug)]
pub enum Mark {
    /// Earth's band: an area behind everything; it does not widen the axes.
    Earth(Vec<[f64; 2]>),
    /// A cloud of single values.
    Dots(Vec<[f64; 2]>),
    /// Values that stand for many.
    Points(Vec<[f64; 2]>),
    /// A curve of the world.
    Curve(Vec<[f64; 2]>),
    /// A curve of one of many worlds.
    Many(Vec<[f64; 2]>),
    /// A fitted law.
    Fit(Vec<[f64; 2]>),
    /// Bars: from, to, and height over 0.
    Bars(Vec<[f64; 3]>),
}

/// A plot.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Along the bottom.
    pub x: Axis,
    /// Along the left.
    pub y: Axis,
    /// What is drawn, from the back.
    pub marks: Vec<Mark>,
}

impl Plot {
    /// The plot as an SVG element; `name` is its own on the page, `title` is for those who cannot see it.
    pub fn svg(&self, name: &str, title: &str) -> String {
        let x = Scale::of(&self.x, self.values(0), [LEFT, WIDTH - RIGHT]);
        let y = Scale::of(&self.y, self.values(1), [HEIGHT - BOTTOM, TOP]);
        let mut svg = format!(
            "<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\">\n\
             <title>{}</title>\n<clipPath id=\"{name}\"><rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\"/>\
             </clipPath>\n<g clip-path=\"url(#{name})\">\n",
            escaped(title),
            WIDTH - LEFT - RIGHT,
            HEIGHT - TOP - BOTTOM,
        );
        let is_earth = |mark: &&Mark| matches!(mark, Mark::Earth(_));
        self.marks.iter().filter(is_earth).for_each(|mark| draw(&mut svg, mark, &x, &y));
        rules(&mut svg, &x, &y);
        self.marks.iter().filter(|mark| !is_earth(mark)).for_each(|mark| draw(&mut svg, mark, &x, &y));
        svg.push_str("</g>\n");
        self.frame(&mut svg, &x, &y);
        svg.push_str("</svg>\n");
        svg
    }

    /// The plot as a file of its own.
    pub fn svg_file(&self, name: &str, title: &str) -> String {
        self.svg(name, title).replacen("<title>", &format!("<style>{STYLE}</style>\n<title>"), 1)
    }

    /// All values along an axis that the plot has to show.
    fn values(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        self.marks.iter().flat_map(move |mark| {
            let values: Vec<f64> = match mark {
                Mark::Earth(_) | Mark::Fit(_) => Vec::new(),
                Mark::Dots(p) | Mark::Points(p) | Mark::Curve(p) | Mark::Many(p) => p.iter().map(|p| p[axis]).collect(),
                Mark::Bars(bars) if axis == 0 => bars.iter().flat_map(|b| [b[0], b[1]]).collect(),
                Mark::Bars(bars) => bars.iter().map(|b| b[2]).collect(),
            };
            values
        })
    }

    fn frame(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        let _ = writeln!(svg, "<path class=\"frame\" d=\"M{LEFT} {TOP}V{bottom}H{right}\"/>");
        for tick in x.ticks() {
            if let (Some(at), Some(text)) = (x.at(tick.at), tick.text) {
                let below = bottom + 16.0;
                let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{below}\" text-anchor=\"middle\">{text}</text>");
            }
        }
        for tick in y.ticks() {
            if let (Some(at), Some(text)) = (y.at(tick.at), tick.text) {
                let (left, at) = (LEFT - 6.0, at + 4.0);
                let _ = writeln!(svg, "<text x=\"{left}\" y=\"{at:.1}\" text-anchor=\"end\">{text}</text>");
            }
        }
        let (middle, low) = ((LEFT + right) / 2.0, HEIGHT - 8.0);
        let name = escaped(self.x.label);
        let _ = writeln!(svg, "<text class=\"name\" x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">{name}</text>");
        let (middle, name) = ((TOP + bottom) / 2.0, escaped(self.y.label));
        let turned = format!("transform=\"translate(14 {middle}) rotate(-90)\"");
        let _ = writeln!(svg, "<text class=\"name\" {turned} text-anchor=\"middle\">{name}</text>");
    }
}

fn rules(svg: &mut String, x: &Scale, y: &Scale) {
    let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
    for at in x.ticks().iter().filter(|t| t.text.is_some()).filter_map(|t| x.at(t.at)) {
        let _ = writeln!(svg, "<path class=\"rule\" d=\"M{at:.1} {TOP}V{bottom}\"/>");
    }
    for at in y.ticks().iter().filter(|t| t.text.is_some()).filter_map(|t| y.at(t.at)) {
        let _ = writeln!(svg, "<path class=\"rule\" d=\"M{LEFT} {at:.1}H{right}\"/>");
    }
}

fn draw(svg: &mut String, mark: &Mark, x: &Scale, y: &Scale) {
    let place = |p: &[f64; 2]| Some((x.at(p[0])?, y.at(p[1])?));
    let path = |points: &[[f64; 2]]| {
        let places = points.iter().filter_map(place).map(|(x, y)| format!("{x:.1} {y:.1}"));
        format!("M{}", places.collect::<Vec<_>>().join("L"))
    };
    let _ = match mark {
        Mark::Earth(p) | Mark::Dots(p) | Mark::Points(p) | Mark::Curve(p) | Mark::Many(p) | Mark::Fit(p)
            if p.iter().filter_map(place).next().is_none() =>
        {
            Ok(())
        }
        Mark::Earth(p) => writeln!(svg, "<path class=\"earth\" d=\"{}Z\"/>", path(p)),
        Mark::Dots(p) => writeln!(svg, "<path class=\"dots\" d=\"{}\"/>", dots(p.iter().filter_map(place), 1.3)),
        Mark::Points(p) => writeln!(svg, "<path class=\"points\" d=\"{}\"/>", dots(p.iter().filter_map(place), 4.0)),
        Mark::Curve(p) => writeln!(svg, "<path class=\"curve\" d=\"{}\"/>", path(p)),
        Mark::Many(p) => writeln!(svg, "<path class=\"many\" d=\"{}\"/>", path(p)),
        Mark::Fit(p) => writeln!(svg, "<path class=\"fit\" d=\"{}\"/>", path(p)),
        Mark::Bars(bars) => {
            let base = y.at(0.0).unwrap_or(HEIGHT - BOTTOM);
            let bar = |b: &[f64; 3]| {
                let (from, to, top) = (x.at(b[0])?, x.at(b[1])?, y.at(b[2])?);
                Some(format!("M{:.1} {base:.1}V{top:.1}H{:.1}V{base:.1}Z", from + 0.5, to - 0.5))
            };
            writeln!(svg, "<path class=\"bars\" d=\"{}\"/>", bars.iter().filter_map(bar).collect::<String>())
        }
    };
}

/// Round dots as one path: far smaller than an element each.
fn dots(places: impl Iterator<Item = (f64, f64)>, radius: f64) -> String {
    let arc = |sign: f64| format!("a{radius} {radius} 0 1 0 {} 0", sign * 2.0 * radius);
    places.map(|(x, y)| format!("M{:.1} {y:.1}{}{}Z", x - radius, arc(1.0), arc(-1.0))).collect()
}

/// Text that is safe within XML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_holds_its_marks_and_no_number_is_none() {
        let points = vec![[1.0, 2.0], [10.0, 4.0], [0.0, -1.0], [f64::NAN, 1.0]];
        let plot = Plot {
            x: Axis::log("area & <more>"),
            y: Axis::log("length"),
            marks: vec![
                Mark::Points(points.clone()),
                Mark::Dots(Vec::new()),
                Mark::Earth(vec![[1.0, 1.0], [10.0, 9.0], [10.0, 1.0]]),
                Mark::Bars(vec![[1.0, 2.0, 3.0]]),
                Mark::Fit(points),
            ],
        };
        let svg = plot.svg("a", "A \"plot\"");
        assert!(svg.contains("area &amp; &lt;more&gt;") && svg.contains("A &quot;plot&quot;"), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        let at = |class: &str| svg.find(&format!("class=\"{class}\"")).unwrap();
        assert!(at("earth") < at("rule") && at("rule") < at("points"));
        assert!(!svg.contains("class=\"dots\""));
        assert!(plot.svg_file("a", "b").contains("<style>:root"));
    }
}
