//! One layer by its palette, over a faint shading that shows where one is.

use rayon::prelude::*;

use super::{
    Options, View,
    coast::Coast,
    frame::Frame,
    furniture::{Legend, Ticks},
    palette::{Ramp, Rgb, hex, lch, mix},
    shade::shade,
    tint::{Scene, lit},
};
use crate::{
    grid::Field,
    world::{Kind, Layer, Palette, Spec},
};

/// Colours of what plate boundaries do, in the catalogue's order; the overlay draws with them too.
pub const BOUNDARIES: [u32; 5] = [0xe6e2d8, 0xc8283c, 0x7b2d8e, 0xe8871e, 0x2f8f4e];

const SEQUENTIAL: [u32; 6] = [0x2a1a50, 0x33508c, 0x2c7f90, 0x3fa878, 0x9acd58, 0xf8e962];
const DIVERGING: [u32; 7] = [0x233f8f, 0x4f83c4, 0xa9c9e6, 0xf5f3ee, 0xf0b795, 0xd2604f, 0x8c1b33];
const AGE: [u32; 7] = [0x9c1430, 0xdf5a3c, 0xf6ad55, 0xf3e6a0, 0x93ccac, 0x4191b8, 0x3a4796];
const SLOPE: [u32; 6] = [0xf4f2ec, 0xdbd5c8, 0xe5bd80, 0xdb7a4c, 0xa9272c, 0x590e26];
/// How strongly a layer's colours are shaded.
pub const SHADING: f32 = 0.28;
/// More identities than these get no legend of their own.
const MOST_SWATCHES: usize = 24;

/// The layer's pixels in linear light, and its legend.
pub fn draw(
    frame: &Frame,
    layer: Layer,
    field: &Field<f32>,
    heights: &Field<f32>,
    scene: &Scene,
    options: &Options,
) -> (Vec<Rgb>, Legend) {
    let spec = layer.spec();
    let (colours, legend) = match spec.kind {
        Kind::Continuous if spec.palette == Palette::Elevation => {
            let scene = Scene::new(field, scene.sea_m);
            let values = frame.continuous(field);
            (values.data.iter().map(|&v| scene.at(v)).collect(), Legend::heights(&scene).titled(title(&spec)))
        }
        Kind::Continuous => continuous(frame, field, &spec),
        Kind::Id => identities(frame, field, &spec),
        Kind::Class(names) => classes(frame, field, &spec, names),
    };
    (over_ground(frame, colours, heights, scene, options), legend)
}

fn title(spec: &Spec) -> String {
    if spec.unit == "1" { spec.title.to_owned() } else { format!("{}, {}", spec.title, spec.unit) }
}

fn continuous(frame: &Frame, field: &Field<f32>, spec: &Spec) -> (Vec<Rgb>, Legend) {
    let range = span(field, spec);
    let ramp = Ramp::even(codes(spec.palette), range);
    let values = frame.continuous(field);
    let legend = ramp_legend(spec, &ramp, range);
    (values.data.iter().map(|&v| ramp.at(v)).collect(), legend)
}

fn codes(palette: Palette) -> &'static [u32] {
    match palette {
        Palette::Diverging => &DIVERGING,
        Palette::Age => &AGE,
        Palette::Slope => &SLOPE,
        _ => &SEQUENTIAL,
    }
}

fn ramp_legend(spec: &Spec, ramp: &Ramp, range: [f64; 2]) -> Legend {
    Legend::bar(title(spec), |t| ramp.at((range[0] + (range[1] - range[0]) * t) as f32), Ticks::over(range))
}

/// The catalogue's range, so that pictures compare; another one where the values leave it or fill less than a fifth.
/// A few odd cells (one in two hundred on either side) don't count.
fn span(field: &Field<f32>, spec: &Spec) -> [f64; 2] {
    let mut sorted = field.data.clone();
    sorted.par_sort_unstable_by(f32::total_cmp);
    let last = sorted.len().saturating_sub(1);
    let odd = last / 200;
    let (low, high) = (sorted[odd] as f64, sorted[last - odd] as f64);
    let [from, to] = spec.range;
    let diverging = spec.palette == Palette::Diverging;
    let reach = if diverging { low.abs().max(high.abs()) / to } else { (high - from) / (to - from) };
    let inside = low >= from - 0.25 * (to - from) && reach <= 1.25;
    if inside && reach >= 0.2 || high <= low {
        return spec.range;
    }
    let top = if diverging { round_up(low.abs().max(high.abs())) } else { round_up(high.max(0.0)) };
    let bottom = if diverging { -top } else { -round_up((-low).max(0.0)) };
    if top > bottom { [bottom, top] } else { spec.range }
}

/// The next of 1, 2, 5, 10, ...
pub fn round_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let ten = libm::pow(10.0, libm::floor(libm::log10(value)));
    [1.0, 2.0, 5.0].map(|m| m * ten).into_iter().find(|&nice| nice >= value * (1.0 - 1e-9)).unwrap_or(10.0 * ten)
}

/// A colour for an identity, far from those of its neighbours in number: hues by the golden angle.
fn identity(id: f32) -> Rgb {
    let i = id as f64;
    let third = i.rem_euclid(3.0);
    lch(0.66 + 0.07 * third, 0.10 + 0.012 * third, 30.0 + i * 137.507_764)
}

fn identities(frame: &Frame, field: &Field<f32>, spec: &Spec) -> (Vec<Rgb>, Legend) {
    let values = frame.nearest(field);
    let mut ids: Vec<i64> = values.data.iter().map(|&v| v as i64).collect();
    ids.sort_unstable();
    ids.dedup();
    let swatches = if ids.len() > MOST_SWATCHES { Vec::new() } else { ids };
    let swatches = swatches.into_iter().map(|id| (identity(id as f32), id.to_string())).collect();
    let colour = |&v: &f32| identity(v);
    (values.data.iter().map(colour).collect(), Legend::swatches(title(spec), swatches))
}

fn classes(frame: &Frame, field: &Field<f32>, spec: &Spec, names: &[&str]) -> (Vec<Rgb>, Legend) {
    let values = frame.nearest(field);
    (values.data.iter().map(|&v| class(v as usize)).collect(), class_legend(spec, names))
}

fn class(i: usize) -> Rgb {
    BOUNDARIES.get(i).map_or_else(|| identity(i as f32), |&code| hex(code))
}

fn class_legend(spec: &Spec, names: &[&str]) -> Legend {
    let swatches = names.iter().enumerate().map(|(i, &name)| (class(i), name.to_owned())).collect();
    Legend::swatches(title(spec), swatches)
}

/// A layer's colours on a scale that does not depend on any world, for films.
pub enum Colours {
    /// A quantity, over the catalogue's range.
    Ramp(Ramp),
    /// Identities.
    Ids,
    /// Named classes.
    Classes,
}

impl Colours {
    /// Those of a layer; `None` where heights' own colours serve.
    pub fn fixed(layer: Layer) -> Option<Self> {
        let spec = layer.spec();
        match spec.kind {
            Kind::Continuous if spec.palette == Palette::Elevation => None,
            Kind::Continuous => Some(Colours::Ramp(Ramp::even(codes(spec.palette), spec.range))),
            Kind::Id => Some(Colours::Ids),
            Kind::Class(_) => Some(Colours::Classes),
        }
    }

    /// Whether values are names, which have no between.
    pub fn named(&self) -> bool {
        !matches!(self, Colours::Ramp(_))
    }

    /// The colour of a value.
    pub fn at(&self, value: f32) -> Rgb {
        match self {
            Colours::Ramp(ramp) => ramp.at(value),
            Colours::Ids => identity(value),
            Colours::Classes => class(value as usize),
        }
    }
}

/// What the colours of a film mean.
pub fn fixed_legend(view: &View, scene: &Scene) -> Legend {
    let View::Layer(layer) = view else { return Legend::heights(scene) };
    let spec = layer.spec();
    match (Colours::fixed(*layer), spec.kind) {
        (None, _) => Legend::heights(scene).titled(title(&spec)),
        (Some(Colours::Ramp(ramp)), _) => ramp_legend(&spec, &ramp, spec.range),
        (Some(_), Kind::Class(names)) => class_legend(&spec, names),
        // Which identities there will be, nobody knows.
        _ => Legend::swatches(title(&spec), Vec::new()),
    }
}

fn over_ground(
    frame: &Frame,
    mut pixels: Vec<Rgb>,
    heights: &Field<f32>,
    scene: &Scene,
    options: &Options,
) -> Vec<Rgb> {
    let sea = scene.sea_m as f32;
    let tone = shade(frame, heights, |h| h > sea || scene.range_m[1] <= scene.sea_m, options.exaggeration);
    let coast = Coast::new(heights, sea);
    let ink = hex(0x202830);
    let half = 0.35 * frame.unit();
    crate::grid::for_each_row(&mut pixels, frame.grid.width, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let depth = if heights.at(x, y) > sea { SHADING } else { SHADING * 0.5 };
            let line = (0.5 + half - coast.line_px.at(x, y)).clamp(0.0, 1.0);
            *pixel = mix(lit(*pixel, tone.at(x, y) * depth), ink, 0.55 * line);
        }
    });
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Grid},
        relief::palette::Encoder,
    };

    #[test]
    fn neighbouring_identities_differ() {
        let encoder = Encoder::new();
        let colours: Vec<[u8; 3]> = (0..40).map(|id| encoder.bytes(identity(id as f32))).collect();
        let apart = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(a, b)| a.abs_diff(b) as u32).sum::<u32>();
        for i in 0..40 {
            for j in i + 1..(i + 6).min(40) {
                assert!(apart(colours[i], colours[j]) > 40, "{i} {j}");
            }
        }
    }

    #[test]
    fn ranges_fit_the_values() {
        let field = |low: f32, high: f32| {
            let mut field = Field::filled(Grid::new(2, 1, 2.0, Edges::Open), low);
            field.data[1] = high;
            field
        };
        let of = |layer: Layer, low, high| span(&field(low, high), &layer.spec());
        assert_eq!(of(Layer::CrustAge, 0.0, 150.0), [0.0, 200.0]);
        assert_eq!(of(Layer::CrustAge, 0.0, 8.0), [0.0, 10.0]);
        assert_eq!(of(Layer::CrustAge, 0.0, 900.0), [0.0, 1000.0]);
        assert_eq!(of(Layer::Uplift, -0.03, 0.11), [-0.2, 0.2]);
        assert_eq!(of(Layer::Uplift, -0.3, 1.1), [-2.0, 2.0]);
        assert_eq!(of(Layer::Hardness, 0.0, 0.0), [0.0, 1.0]);
        let mut cliff = Field::filled(Grid::new(40, 20, 40.0, Edges::Open), 20.0);
        cliff.data[7] = 89.0;
        assert_eq!(span(&cliff, &Layer::Slope.spec()), [0.0, 45.0], "one cell does not change the colours of all");
        assert_eq!((round_up(0.3), round_up(5.0), round_up(7.0)), (0.5, 5.0, 10.0));
    }
}
