//! What stands around a map: margin and frame, title, scale bar, legend.

use super::{
    cover::{ARID, HUMID, Tints},
    frame::Frame,
    layers::round_up,
    marks::{Canvas, Ink},
    palette::{Encoder, Rgb},
    text::{self, Align},
    tint::Scene,
};

const PAPER: Ink = Ink::hex(0xfaf8f2);
const INK: Ink = Ink::hex(0x2d3438);
const FAINT: Ink = Ink::hex(0x6d7478);

/// Marks along a legend's bar: place, 0 to 1, and text.
#[derive(Clone)]
pub struct Ticks(Vec<(f32, String)>);

impl Ticks {
    /// Round numbers over a range.
    pub fn over([low, high]: [f64; 2]) -> Self {
        Self(nice(low, high, 5).into_iter().map(|v| (((v - low) / (high - low)) as f32, number(v))).collect())
    }

    /// Round numbers over a range of their square roots, from zero.
    pub fn roots([_, high]: [f64; 2]) -> Self {
        let steps = (-1..=6).flat_map(|power| [1.0, 2.0, 5.0].map(|m| m * libm::pow(10.0, f64::from(power))));
        let (least, most) = (high * high / 60.0, high * high * (1.0 + 1e-9));
        let marked = steps.filter(|v| (least..=most).contains(v)).map(|v| ((v.sqrt() / high) as f32, number(v)));
        Self(std::iter::once((0.0, number(0.0))).chain(marked).collect())
    }

    /// Powers of ten over a range of their logarithms.
    pub fn powers([low, high]: [f64; 2]) -> Self {
        let powers = libm::ceil(low - 1e-9) as i32..=libm::floor(high + 1e-9) as i32;
        let place = |power: i32| ((f64::from(power) - low) / (high - low)) as f32;
        Self(powers.map(|power| (place(power), number(libm::pow(10.0, f64::from(power))))).collect())
    }
}

#[derive(Clone)]
enum Body {
    /// The lower half of the bar may have other colours.
    Bar {
        colours: Vec<Rgb>,
        lower: Option<Vec<Rgb>>,
        ticks: Ticks,
        sea: Option<f32>,
    },
    Swatches(Vec<(Rgb, String)>),
}

/// What the colours mean.
#[derive(Clone)]
pub struct Legend {
    title: String,
    body: Body,
}

/// A line of the overlay's legend.
pub struct Symbol {
    /// What it means.
    pub name: String,
    /// How it is drawn, from a point on, over a length.
    pub draw: fn(&mut Canvas, [f32; 2], f32, f32),
}

impl Legend {
    const SAMPLES: usize = 512;

    /// A bar of colours from 0 to 1.
    pub fn bar(title: String, colour: impl Fn(f64) -> Rgb, ticks: Ticks) -> Self {
        Self { title, body: Body::Bar { colours: Self::sampled(colour), lower: None, ticks, sea: None } }
    }

    fn sampled(colour: impl Fn(f64) -> Rgb) -> Vec<Rgb> {
        (0..Self::SAMPLES).map(|i| colour((i as f64 + 0.5) / Self::SAMPLES as f64)).collect()
    }

    /// Named colours.
    pub fn swatches(title: String, swatches: Vec<(Rgb, String)>) -> Self {
        Self { title, body: Body::Swatches(swatches) }
    }

    /// The tints, the sea's depths on the left and the land's heights on the right, each to its own scale.
    pub fn heights(scene: &Scene) -> Self {
        Self::split(scene, |height_m| scene.land(height_m), None::<fn(f32) -> Rgb>)
    }

    /// The same where climate colours the land: humid above, dry below.
    pub fn climates(scene: &Scene) -> Self {
        let (tints, sea_m) = (Tints::new(), scene.sea_m as f32);
        let humid = |height_m: f32| tints.at(HUMID, height_m, sea_m);
        let dry = |height_m: f32| tints.at(ARID, height_m, sea_m);
        Self::split(scene, humid, Some(dry))
    }

    fn split(scene: &Scene, land: impl Fn(f32) -> Rgb, lower: Option<impl Fn(f32) -> Rgb>) -> Self {
        let [low, high] = scene.range_m;
        let sea = scene.sea_m;
        let split = match (low < sea, high > sea) {
            (true, true) => 0.42,
            (true, false) => 1.0,
            _ => 0.0,
        };
        // A map of one height still has a bar.
        let (bottom, top) = if split == 0.0 { (low, high.max(low + 1.0)) } else { (sea, high) };
        let colour = |t: f64, land: &dyn Fn(f32) -> Rgb| {
            if t < split {
                scene.sea((low + (sea - low) * t / split) as f32)
            } else {
                land((bottom + (top - bottom) * (t - split) / (1.0 - split)) as f32)
            }
        };
        let mut ticks = Vec::new();
        if split > 0.0 {
            let deep = nice(low, sea, 3).into_iter().filter(|&v| v < sea - 0.08 * (sea - low));
            ticks.extend(deep.map(|v| (((v - low) / (sea - low) * split) as f32, number(v))));
            ticks.push((split as f32, number(sea)));
        }
        if split < 1.0 {
            let foot = if split > 0.0 { bottom + 0.08 * (top - bottom) } else { bottom };
            let dry = nice(bottom, top, 4).into_iter().filter(|&v| v >= foot);
            ticks.extend(dry.map(|v| ((split + (v - bottom) / (top - bottom) * (1.0 - split)) as f32, number(v))));
        }
        let mut legend = Self::bar("Height, m".to_owned(), |t| colour(t, &land), Ticks(ticks));
        if let Body::Bar { sea, lower: below, .. } = &mut legend.body {
            *sea = (split > 0.0 && split < 1.0).then_some(split as f32);
            *below = lower.map(|land| Self::sampled(|t| colour(t, &land)));
        }
        legend
    }

    /// The same under another title.
    pub fn titled(mut self, title: String) -> Self {
        self.title = title;
        self
    }

    /// The height that it takes in a box of this width, pixels.
    pub fn tall(&self, width: f32, u: f32) -> f32 {
        match &self.body {
            Body::Bar { .. } => 56.0 * u,
            Body::Swatches(swatches) => {
                let wide = swatches.iter().map(|(_, name)| 30.0 * u + text::width(name, 12.0 * u));
                let (lines, _) = wide.fold((1, 0.0), |(lines, at), wide| {
                    if at + wide > width + 12.0 * u && at > 0.0 { (lines + 1, wide) } else { (lines, at + wide) }
                });
                (20.0 + 17.0 * lines as f32) * u
            }
        }
    }

    /// Draws into a box.
    pub fn draw(&self, canvas: &mut Canvas, [x, y]: [f32; 2], width: f32, u: f32) {
        let size = 13.0 * u;
        text::write(canvas, &self.title, [x, y + 11.0 * u], size, Align::Left, INK);
        match &self.body {
            Body::Bar { colours, lower, ticks, sea } => {
                if lower.is_some() {
                    let words = "humid above, dry below";
                    let at = [x + width - text::width(words, 11.5 * u), y + 11.0 * u];
                    text::write(canvas, words, at, 11.5 * u, Align::Left, FAINT);
                }
                let lower = lower.as_deref().unwrap_or(colours);
                draw_bar(canvas, [x, y + 20.0 * u], width, u, ([colours, lower], ticks, *sea));
            }
            Body::Swatches(swatches) => draw_swatches(canvas, [x, y + 20.0 * u], width, u, swatches),
        }
    }
}

fn draw_bar(canvas: &mut Canvas, [x, y]: [f32; 2], width: f32, u: f32, bar: ([&[Rgb]; 2], &Ticks, Option<f32>)) {
    let (colours, ticks, sea) = bar;
    let encoder = Encoder::new();
    let tall = 14.0 * u;
    let columns = width.round() as usize;
    let half = (0.5 * tall).round();
    for (colours, from, to) in [(colours[0], 0.0, half), (colours[1], half, tall.round())] {
        for column in 0..columns {
            let colour = colours[(column * colours.len() / columns).min(colours.len() - 1)];
            let at = [x.round() + column as f32, y.round() + from];
            canvas.rect(at, [1.0, to - from], Ink::linear(colour, &encoder));
        }
    }
    canvas.frame([x.round() - 0.5, y.round() - 0.5], [columns as f32 + 1.0, tall.round() + 1.0], 1.0, INK);
    let size = 12.0 * u;
    let mut free_from = f32::NEG_INFINITY;
    for (place, label) in &ticks.0 {
        let at = x + width * place;
        let half = text::width(label, size) / 2.0;
        let at_text = at.clamp(x + half - 6.0 * u, x + width - half + 6.0 * u);
        if at_text - half < free_from {
            continue;
        }
        free_from = at_text + half + 5.0 * u;
        canvas.line(&[[at, y + tall], [at, y + tall + 4.0 * u]], u.max(1.0), INK);
        text::write(canvas, label, [at_text, y + tall + 16.0 * u], size, Align::Middle, INK);
    }
    if let Some(place) = sea {
        let at = x + width * place;
        canvas.line(&[[at, y - 5.0 * u], [at, y + tall]], 1.6 * u, INK);
        text::write(canvas, "sea level", [at, y - 9.0 * u], 11.5 * u, Align::Middle, FAINT);
    }
}

fn draw_swatches(canvas: &mut Canvas, [x, y]: [f32; 2], width: f32, u: f32, swatches: &[(Rgb, String)]) {
    let encoder = Encoder::new();
    let size = 12.0 * u;
    let (mut at, mut line) = (x, y);
    for (colour, name) in swatches {
        let wide = 18.0 * u + text::width(name, size) + 12.0 * u;
        if at + wide > x + width + 12.0 * u && at > x {
            (at, line) = (x, line + 17.0 * u);
        }
        canvas.rect([at, line], [14.0 * u, 11.0 * u], Ink::linear(*colour, &encoder));
        canvas.frame([at, line], [14.0 * u, 11.0 * u], 0.7 * u, FAINT);
        text::write(canvas, name, [at + 18.0 * u, line + 10.0 * u], size, Align::Left, INK);
        at += wide;
    }
}

/// The map on a sheet with everything around it.
pub fn surround(map: Canvas, frame: &Frame, legend: &Legend, symbols: &[Symbol], title: Option<&str>) -> Canvas {
    let u = frame.unit();
    let (map_w, map_h) = (map.width() as f32, map.height() as f32);
    let margin = (26.0 * u).round();
    let top = if title.is_some() { (58.0 * u).round() } else { margin };
    let inner = map_w.max((460.0 * u).round());
    let legend_h = 84.0 * u;
    let bottom = legend_h + if symbols.is_empty() { 0.0 } else { 26.0 * u };
    let (width, height) = (inner + 2.0 * margin, top + map_h + bottom.round());
    let mut canvas = Canvas::blank(width as usize, height as usize, PAPER);
    let left = ((width - map_w) / 2.0).floor();
    canvas.put(&map, left as usize, top as usize);
    let line = (1.2 * u).round().max(1.0);
    canvas.frame([left - line / 2.0, top - line / 2.0], [map_w + line, map_h + line], line, INK);
    if let Some(title) = title {
        let title = text::fitted(title, 25.0 * u, inner);
        text::write(&mut canvas, &title, [margin, top - 19.0 * u], 25.0 * u, Align::Left, INK);
    }
    let below = top + map_h + 18.0 * u;
    scale_bar(&mut canvas, [margin, below], inner, map_w, frame, u);
    let wide = (inner * 0.54).round();
    legend.draw(&mut canvas, [margin + inner - wide, below], wide, u);
    let mut at = margin;
    for symbol in symbols {
        let y = below + legend_h - 14.0 * u;
        (symbol.draw)(&mut canvas, [at, y], 26.0 * u, u);
        text::write(&mut canvas, &symbol.name, [at + 32.0 * u, y + 4.0 * u], 12.0 * u, Align::Left, INK);
        at += 46.0 * u + text::width(&symbol.name, 12.0 * u);
    }
    canvas
}

/// A bar of a round length, about a quarter of the map.
fn scale_bar(canvas: &mut Canvas, [x, y]: [f32; 2], inner: f32, map_w: f32, frame: &Frame, u: f32) {
    let px_m = frame.grid.cell_m;
    let room_m = (inner.min(map_w.max(120.0 * u)) * 0.27) as f64 * px_m;
    let length_m = round_down(room_m);
    let px = (length_m / px_m) as f32;
    let (unit, per) = if length_m >= 2000.0 { ("km", 1000.0) } else { ("m", 1.0) };
    let (top, tall) = ((y + 20.0 * u).round(), (6.0 * u).round().max(3.0));
    let parts = 4;
    for part in 0..parts {
        let from = x + px * part as f32 / parts as f32;
        let ink = if part % 2 == 0 { INK } else { PAPER };
        canvas.rect([from, top], [px / parts as f32, tall], ink);
    }
    canvas.frame([x, top], [px, tall], u.max(1.0), INK);
    let size = 12.0 * u;
    let roomy = px > 3.0 * text::width(&number(length_m / per), size);
    for part in [0, 2, 4].into_iter().filter(|&part| roomy || part != 2) {
        let value = length_m * part as f64 / parts as f64 / per;
        let at = x + px * part as f32 / parts as f32;
        let (align, at) = if part == 0 { (Align::Left, x - u) } else { (Align::Middle, at) };
        text::write(canvas, &number(value), [at, top + tall + 16.0 * u], size, align, INK);
    }
    let end = x + px + text::width(&number(length_m / per), size) / 2.0 + 5.0 * u;
    text::write(canvas, unit, [end, top + tall + 16.0 * u], size, Align::Left, INK);
    let cell = frame.cell_text();
    text::write(canvas, &cell, [x, y + 11.0 * u], size, Align::Left, FAINT);
}

/// The next lower of 1, 2, 5, 10, ...
fn round_down(value: f64) -> f64 {
    let up = round_up(value);
    if up <= value * (1.0 + 1e-9) {
        return up;
    }
    // One step down the same ladder.
    [0.5, 0.4].map(|f| round_up(up * f * (1.0 - 1e-6))).into_iter().find(|&v| v <= value).unwrap_or(up / 2.5)
}

/// About `count` round numbers in a range.
fn nice(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = round_up((high - low) / count as f64);
    if step <= 0.0 {
        return vec![low];
    }
    let first = libm::ceil(low / step - 1e-9) as i64;
    let last = libm::floor(high / step + 1e-9) as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// A number as on a map: a true minus sign, commas between thousands, no more digits than it has.
fn number(value: f64) -> String {
    let size = value.abs();
    let digits = if size >= 10.0 || size == libm::floor(size) {
        0
    } else if size >= 1.0 {
        1
    } else {
        2
    };
    let plain = format!("{size:.digits$}");
    let (whole, rest) = plain.split_at(plain.find('.').unwrap_or(plain.len()));
    let mut grouped = String::new();
    for (i, c) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) && whole.len() > 4 {
            grouped.push(',');
        }
        grouped.push(c);
    }
    let rest = if digits == 2 { rest.strip_suffix('0').unwrap_or(rest) } else { rest };
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{grouped}{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_on_a_map() {
        let texts = [0.0, -4000.0, 12_000.0, 0.5, 0.25, 2.5, 750.0].map(number);
        assert_eq!(texts, ["0", "−4000", "12,000", "0.5", "0.25", "2.5", "750"]);
    }

    #[test]
    fn scale_bars_are_round_and_fit() {
        for (room, want) in [(270.0, 200.0), (100.0, 100.0), (99.0, 50.0), (49.0, 20.0), (21.0, 20.0), (5.5, 5.0)] {
            assert!((round_down(room) - want).abs() < 1e-9, "{room}: {}", round_down(room));
        }
        assert_eq!(nice(-8000.0, 0.0, 3), [-5000.0, 0.0]);
        assert_eq!(nice(0.0, 1.0, 5), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
    }
}
