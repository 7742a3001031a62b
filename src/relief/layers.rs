//! One layer by its palette, over a faint shading that shows where one is.

use rayon::prelude::*;

use super::{
    Options, View,
    coast::Coast,
    frame::Frame,
    furniture::{Legend, Ticks},
    palette::{Rgb, hex, mix},
    shade::shade,
    swatches::{Colours, Scale, Steps, named},
    tint::{Scene, lit},
};
use crate::{
    grid::Field,
    world::{Kind, Layer, Palette, Spec},
};

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
        Kind::Id => identities(frame, field, layer),
        Kind::Class(names) => classes(frame, field, layer, names),
    };
    (over_ground(frame, colours, heights, scene, options), legend)
}

fn title(spec: &Spec) -> String {
    if spec.unit == "1" { spec.title.to_owned() } else { format!("{}, {}", spec.title, spec.unit) }
}

fn continuous(frame: &Frame, field: &Field<f32>, spec: &Spec) -> (Vec<Rgb>, Legend) {
    let scale = Scale::over(spec, span(field, spec));
    let values = frame.continuous(field);
    (values.data.iter().map(|&v| scale.at(v)).collect(), scale_legend(spec, &scale))
}

fn scale_legend(spec: &Spec, scale: &Scale) -> Legend {
    let ticks = match scale.steps() {
        Steps::Even => Ticks::over(scale.ends()),
        Steps::Roots => Ticks::roots(scale.ends()),
        Steps::Powers => Ticks::powers(scale.ends()),
    };
    Legend::bar(title(spec), |t| scale.between(t), ticks)
}

/// The catalogue's range, so that pictures compare; another one where the values leave it or fill less than a fifth.
/// A few odd cells (one in two hundred on either side) don't count.
fn span(field: &Field<f32>, spec: &Spec) -> [f64; 2] {
    // A colour stands for the same heat on every map.
    if spec.palette == Palette::Heat {
        return spec.range;
    }
    let mut sorted = field.data.clone();
    sorted.par_sort_unstable_by(f32::total_cmp);
    let last = sorted.len().saturating_sub(1);
    // What goes by powers of ten is about its few greatest values.
    let odd = if spec.palette == Palette::Flow { 0 } else { last / 200 };
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

fn identities(frame: &Frame, field: &Field<f32>, layer: Layer) -> (Vec<Rgb>, Legend) {
    let values = frame.nearest(field);
    let mut ids: Vec<i64> = values.data.iter().map(|&v| v as i64).collect();
    ids.sort_unstable();
    ids.dedup();
    let swatches = if ids.len() > MOST_SWATCHES { Vec::new() } else { ids };
    let swatches = swatches.into_iter().map(|id| (named(layer, id as f32), id.to_string())).collect();
    (values.data.iter().map(|&v| named(layer, v)).collect(), Legend::swatches(title(&layer.spec()), swatches))
}

fn classes(frame: &Frame, field: &Field<f32>, layer: Layer, names: &[&str]) -> (Vec<Rgb>, Legend) {
    let values = frame.nearest(field);
    (values.data.iter().map(|&v| named(layer, v)).collect(), class_legend(layer, names))
}

fn class_legend(layer: Layer, names: &[&str]) -> Legend {
    let swatches = names.iter().enumerate().map(|(i, &name)| (named(layer, i as f32), name.to_owned())).collect();
    Legend::swatches(title(&layer.spec()), swatches)
}

/// What the colours of a film mean.
pub fn fixed_legend(view: &View, scene: &Scene, climate: bool) -> Legend {
    let View::Layer(layer) = view else {
        return if climate { Legend::climates(scene) } else { Legend::heights(scene) };
    };
    let spec = layer.spec();
    match (Colours::fixed(*layer), spec.kind) {
        (None, _) => Legend::heights(scene).titled(title(&spec)),
        (Some(Colours::Scale(scale)), _) => scale_legend(&spec, &scale),
        (Some(_), Kind::Class(names)) => class_legend(*layer, names),
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
    let tone = shade(heights, |h| h > sea || scene.range_m[1] <= scene.sea_m, options.exaggeration);
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
    use crate::grid::{Edges, Grid};

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
