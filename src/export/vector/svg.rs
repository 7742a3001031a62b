//! A layered map in SVG: groups named for Inkscape, from the sea floor up to the letters.

use std::fmt::Write;

use super::{
    Map, Spot,
    plates::Motion,
    shapes::{Line, Polygon},
};

/// Units along the longer side.
const SIDE: f64 = 1000.0;
const MARGIN: f64 = 24.0;
const FOOT: f64 = 46.0;
const LAKE: &str = "#8fc4d8";
const RIVER: &str = "#35769e";
const COAST: &str = "#24455a";
const INK: &str = "#2d3438";
/// What borders do, and their colours, as on the relief map.
const BORDERS: [(&str, &str, &str); 5] = [
    ("collision", "#c8283c", ""),
    ("subduction", "#7b2d8e", ""),
    ("spreading", "#e8871e", " stroke-dasharray=\"7 2.5\""),
    ("transform", "#2f8f4e", " stroke-dasharray=\"3 2.5\""),
    ("none", "#4a4f55", " stroke-dasharray=\"1 2.5\""),
];

struct Sheet<'a> {
    map: &'a Map,
    /// Units of a metre.
    scale: f64,
    out: String,
}

/// The file.
pub fn text(map: &Map) -> String {
    let scale = SIDE / map.extent_m[0].max(map.extent_m[1]);
    let mut sheet = Sheet { map, scale, out: String::new() };
    sheet.all();
    sheet.out
}

impl Sheet<'_> {
    fn put(&mut self, text: &str) {
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn all(&mut self) {
        let [w, h] = self.map.extent_m.map(|m| m * self.scale);
        let (wide, high) = (w + 2.0 * MARGIN, h + MARGIN + FOOT + MARGIN);
        let title = escaped(&self.map.title);
        self.put("<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
        self.put(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" \
             xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"{wide:.0}\" height=\"{high:.0}\" \
             viewBox=\"0 0 {wide:.1} {high:.1}\" font-family=\"sans-serif\">"
        ));
        self.put(&format!("<title>{title}</title>"));
        self.put(&format!(
            "<defs><clipPath id=\"neatline\"><rect width=\"{w:.1}\" height=\"{h:.1}\"/></clipPath></defs>"
        ));
        self.put("<rect width=\"100%\" height=\"100%\" fill=\"#faf8f2\"/>");
        self.put(&format!("<g transform=\"translate({MARGIN} {MARGIN})\"><g clip-path=\"url(#neatline)\">"));
        self.ground([w, h]);
        self.waters();
        self.tectonics();
        self.spots();
        self.put("</g>");
        self.frame([w, h], &title);
        self.put("</g>\n</svg>");
    }

    fn layer(&mut self, id: &str, label: &str, style: &str, fill: impl FnOnce(&mut Self)) {
        self.put(&format!("<g id=\"{id}\" inkscape:groupmode=\"layer\" inkscape:label=\"{label}\"{style}>"));
        fill(self);
        self.put("</g>");
    }

    fn ground(&mut self, [w, h]: [f64; 2]) {
        let map = self.map;
        self.layer("tints", "Height tints", " stroke=\"none\" fill-rule=\"evenodd\"", |sheet| {
            sheet.put(&format!("<rect width=\"{w:.1}\" height=\"{h:.1}\" fill=\"{}\"/>", hex(map.sea_tint)));
            for (tint, polygons) in &map.tints {
                let path = sheet.polygons(polygons);
                sheet.put(&format!("<path fill=\"{}\" d=\"{path}\"/>", hex(*tint)));
            }
        });
        let style =
            " fill=\"none\" stroke=\"#6b5234\" stroke-opacity=\"0.45\" stroke-width=\"0.35\" stroke-linejoin=\"round\"";
        self.layer("contours", &format!("Contours every {} m", map.interval_m), style, |sheet| {
            for same in map.contours.chunk_by(|a, b| a.0 == b.0) {
                let height_m = same[0].0;
                let path: String = same.iter().map(|(_, line)| sheet.line(line)).collect();
                // Every fifth is stronger.
                let times = libm::round(height_m / map.interval_m);
                let strong = if times % 5.0 == 0.0 { " stroke-width=\"0.7\"" } else { "" };
                sheet.put(&format!("<path data-height-m=\"{height_m}\"{strong} d=\"{path}\"/>"));
            }
        });
    }

    fn waters(&mut self) {
        let map = self.map;
        let least = map.rivers.iter().map(|reach| reach.discharge_m3_s).fold(f64::INFINITY, f64::min);
        let style = format!(" fill=\"none\" stroke=\"{RIVER}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"");
        self.layer("rivers", "Rivers", &style, |sheet| {
            for reach in &map.rivers {
                let width = (0.75 * libm::pow(reach.discharge_m3_s / least, 0.26)).clamp(0.3, 4.5);
                let path = sheet.line(&reach.line);
                sheet.put(&format!(
                    "<path data-river=\"{}\" data-discharge-m3-s=\"{:.1}\" stroke-width=\"{width:.2}\" d=\"{path}\"/>",
                    reach.river, reach.discharge_m3_s
                ));
            }
        });
        let style = format!(" fill=\"{LAKE}\" fill-rule=\"evenodd\" stroke=\"{COAST}\" stroke-width=\"0.5\"");
        self.layer("lakes", "Lakes", &style, |sheet| {
            for lake in &map.lakes {
                let path = sheet.polygons(&lake.shape);
                sheet.put(&format!(
                    "<path data-lake=\"{}\" data-level-m=\"{:.1}\" d=\"{path}\"/>",
                    lake.id, lake.level_m
                ));
            }
        });
        let style = format!(" fill=\"none\" stroke=\"{COAST}\" stroke-width=\"0.8\" stroke-linejoin=\"round\"");
        self.layer("coast", "Coast", &style, |sheet| {
            let path = sheet.polygons(&map.land);
            sheet.put(&format!("<path d=\"{path}\"/>"));
        });
    }

    fn tectonics(&mut self) {
        let map = self.map;
        let style =
            format!(" fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.6\" stroke-dasharray=\"4 3\" display=\"none\"");
        self.layer("plates", "Plates (rigid outlines)", &style, |sheet| {
            for (plate, polygon) in &map.plates {
                let path = sheet.polygons(std::slice::from_ref(polygon));
                sheet.put(&format!("<path data-plate=\"{plate}\" d=\"{path}\"/>"));
            }
        });
        let style = " fill=\"none\" stroke-width=\"1.8\" stroke-opacity=\"0.85\" stroke-linejoin=\"round\"";
        self.layer("borders", "Plate borders", style, |sheet| {
            for (kind, colour, dash) in BORDERS {
                let path: String =
                    map.borders.iter().filter(|(own, _)| *own == kind).map(|(_, line)| sheet.line(line)).collect();
                if !path.is_empty() {
                    sheet.layer(&format!("border-{kind}"), kind, &format!(" stroke=\"{colour}\"{dash}"), |sheet| {
                        sheet.put(&format!("<path d=\"{path}\"/>"));
                    });
                }
            }
        });
        let fastest = map.motions.iter().map(|motion| motion.speed_mm_per_yr).fold(1e-9, f64::max);
        let style = format!(" fill=\"{INK}\" font-size=\"11\" text-anchor=\"middle\"");
        self.layer("motions", "Plate motions, mm/yr", &style, |sheet| {
            for motion in &map.motions {
                sheet.arrow(motion, fastest);
            }
        });
    }

    fn arrow(&mut self, motion: &Motion, fastest: f64) {
        let [x, y] = self.place(motion.at_m);
        let length = 16.0 + 40.0 * motion.speed_mm_per_yr / fastest;
        let turn = motion.heading_deg;
        if motion.speed_mm_per_yr > 0.0 {
            let (tail, neck, tip) = (0.5 * length, -0.5 * length + 9.0, -0.5 * length);
            let shape = format!("M-1 {tail:.1}V{neck:.1}H-4L0 {tip:.1}L4 {neck:.1}H1V{tail:.1}Z");
            self.put(&format!(
                "<g data-plate=\"{}\" transform=\"translate({x:.1} {y:.1}) rotate({turn:.1})\"><path stroke=\"#ffffff\" \
                 stroke-width=\"2.4\" stroke-linejoin=\"round\" d=\"{shape}\"/><path d=\"{shape}\"/></g>",
                motion.plate
            ));
        }
        let below = y + 0.5 * length * libm::cos(turn.to_radians()).abs() + 13.0;
        self.words([x, below], &format!("{:.0}", motion.speed_mm_per_yr));
    }

    /// Words on a pale halo, which lies under them as words of its own: not every program orders paint.
    fn words(&mut self, [x, y]: [f64; 2], words: &str) {
        self.put(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" stroke=\"#ffffff\" stroke-opacity=\"0.8\" stroke-width=\"2.4\" \
             stroke-linejoin=\"round\">{words}</text><text x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>"
        ));
    }

    fn spots(&mut self) {
        let map = self.map;
        let style = format!(" fill=\"{INK}\" font-size=\"9\"");
        let write = |sheet: &mut Self, spots: &[Spot], shape: &str| {
            for spot in spots {
                let [x, y] = sheet.place(spot.at_m);
                sheet.put(&format!("<path transform=\"translate({x:.1} {y:.1})\" d=\"{shape}\"/>"));
                sheet.words([x + 5.0, y + 3.0], &format!("{:.0}", spot.height_m));
            }
        };
        self.layer("peaks", "Peaks, m", &style, |sheet| write(sheet, &map.peaks, "M0 -3.2L3 2L-3 2Z"));
        let style = " fill=\"#b03020\" font-size=\"9\"";
        self.layer("volcanoes", "Volcanoes, m", style, |sheet| {
            write(sheet, &map.volcanoes, "M-1.2 -3L1.2 -3L4 3L-4 3Z");
        });
    }

    fn frame(&mut self, [w, h]: [f64; 2], title: &str) {
        let map = self.map;
        let scale = self.scale;
        self.layer("frame", "Frame", &format!(" fill=\"{INK}\" stroke=\"none\""), |sheet| {
            sheet.put(&format!(
                "<rect width=\"{w:.1}\" height=\"{h:.1}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1\"/>"
            ));
            sheet.put(&format!("<text x=\"0\" y=\"{:.1}\" font-size=\"19\">{title}</text>", h + 27.0));
            let note = format!("contours every {} m", map.interval_m);
            sheet.put(&format!("<text x=\"0\" y=\"{:.1}\" font-size=\"11\">{note}</text>", h + 45.0));
            // A bar of a round length, about a fifth of the map.
            let raw_m = 0.2 * w / scale;
            let ten = libm::pow(10.0, libm::floor(libm::log10(raw_m)));
            let bar_m = [5.0, 2.0, 1.0].into_iter().map(|k| k * ten).find(|&m| m <= raw_m).unwrap_or(ten);
            let (length, label) = (bar_m * scale, metres(bar_m));
            let (x, y) = (w - length, h + 30.0);
            sheet.put(&format!(
                "<path d=\"M{x:.1} {:.1}v5H{w:.1}v-5\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.2\"/>",
                y - 5.0
            ));
            let middle = x + 0.5 * length;
            sheet.put(&format!(
                "<text x=\"{middle:.1}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"middle\">{label}</text>",
                y + 14.0
            ));
        });
    }

    fn place(&self, at_m: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|c| (at_m[c] - self.map.corner_m[c]) * self.scale)
    }

    fn points(&self, line: &[[f64; 2]], out: &mut String) {
        for (k, &at) in line.iter().enumerate() {
            let [x, y] = self.place(at);
            // Writing to a string cannot fail.
            let _ = write!(out, "{}{x:.2} {y:.2}", if k == 0 { 'M' } else { 'L' });
        }
    }

    fn line(&self, line: &Line) -> String {
        let mut out = String::new();
        let closed = line.len() > 3 && line.first() == line.last();
        self.points(if closed { &line[..line.len() - 1] } else { line }, &mut out);
        if closed {
            out.push('Z');
        }
        out
    }

    fn polygons(&self, polygons: &[Polygon]) -> String {
        let mut out = String::new();
        for ring in polygons.iter().flat_map(|polygon| std::iter::once(&polygon.outer).chain(&polygon.holes)) {
            self.points(ring, &mut out);
            out.push('Z');
        }
        out
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn metres(m: f64) -> String {
    if m >= 1000.0 { format!("{} km", m / 1000.0) } else { format!("{m} m") }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
