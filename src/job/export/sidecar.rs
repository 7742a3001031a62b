//! The JSON beside exported files: what whole numbers stand for, how far samples are apart, where the sea is, where the
//! world came from, and what to type into an importer.

use serde::Serialize;
use serde_json::Value;

use crate::{
    export::{
        Green, MATERIALS, WeightRules,
        engine::{Engine, Facts, azgaar_scale},
        raster::{Levels, Sampling},
    },
    world::{Layer, World, store::Provenance},
};

use super::{
    draw::Drawing,
    order::{Content, Order},
    place::Place,
};

/// Everything the sidecar says.
#[derive(Debug, Serialize)]
pub struct Sidecar {
    upthrust: &'static str,
    recipe: String,
    seed: u64,
    files: Vec<String>,
    layer: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    bits: u32,
    /// Samples of one file, width and height.
    size: [usize; 2],
    samples: Sampling,
    metres_per_sample: f64,
    /// North-west corner and extent of all files together, m from the map's north-west corner.
    corner_m: [f64; 2],
    extent_m: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    tiles_a_side: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    black: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    white: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    black_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    white_m: Option<f64>,
    sea_level_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    sea_level_value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    byte_order: Option<&'static str>,
    first_row: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    normal_green: Option<Green>,
    #[serde(skip_serializing_if = "Option::is_none")]
    weights: Option<Weights>,
    #[serde(skip_serializing_if = "Option::is_none")]
    import: Option<Value>,
}

#[derive(Debug, Serialize)]
struct Weights {
    channels: [&'static str; 4],
    rules: WeightRules,
}

impl Sidecar {
    /// Gathers it.
    pub fn new(order: &Order, place: &Place, drawing: &Drawing, world: &World, from: &Provenance) -> Self {
        let tile = place.tile();
        let most = order.depth.most();
        let layer = if let Content::Layer(layer) = order.content { Some(layer) } else { None };
        // Floating point needs no legend, and a map program's grays are no straight line.
        let levels: Option<Levels> = drawing.levels.filter(|_| most.is_some());
        let heights = levels.filter(|_| layer.is_some_and(in_metres_of_height));
        Self {
            upthrust: env!("CARGO_PKG_VERSION"),
            recipe: from.name.clone(),
            seed: from.seed,
            files: Vec::new(),
            layer: order.request.layer.clone(),
            unit: layer.map(|layer| layer.spec().unit),
            bits: order.depth.bits(),
            size: [tile.width, tile.height],
            samples: tile.sampling,
            metres_per_sample: tile.spacing_m,
            corner_m: place.lattice.corner_m,
            extent_m: place.lattice.extent_m(),
            tiles_a_side: Some(place.tiles).filter(|&tiles| tiles > 1),
            black: levels.map(|levels| levels.black),
            white: levels.map(|levels| levels.white),
            black_m: heights.map(|levels| levels.black),
            white_m: heights.map(|levels| levels.white),
            sea_level_m: world.sea_level_m,
            sea_level_value: heights.and_then(|levels| Some(levels.place(world.sea_level_m, most?))),
            byte_order: Some(if order.layout.big_endian { "big endian" } else { "little endian" })
                .filter(|_| order.format.bare),
            first_row: if order.layout.south_first { "south" } else { "north" },
            normal_green: drawing.green,
            weights: drawing.rules.map(|rules| Weights { channels: MATERIALS, rules }),
            import: import(order, place, drawing, world),
        }
    }

    /// Names the files it describes.
    pub fn listing(mut self, files: Vec<String>) -> Self {
        self.files = files;
        self
    }

    /// The file's text.
    pub fn text(&self) -> String {
        // Plain strings and finite numbers: there is nothing in it that JSON cannot say.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

/// Layers whose values are heights above the datum, as the sea level is.
fn in_metres_of_height(layer: Layer) -> bool {
    matches!(layer, Layer::Height | Layer::Bedrock)
}

fn import(order: &Order, place: &Place, drawing: &Drawing, world: &World) -> Option<Value> {
    let engine = order.request.engine?;
    if order.content != Content::Layer(Layer::Height) {
        return None;
    }
    if engine == Engine::Azgaar {
        return Some(azgaar_scale(drawing.peak_m));
    }
    let facts = Facts {
        tile: &place.tile(),
        tiles: place.tiles,
        levels: drawing.levels?,
        sea_level_m: world.sea_level_m,
        metres: order.depth.most().is_none(),
        big_endian: order.layout.big_endian,
    };
    Some(engine.settings(&facts))
}

/// What Unreal reads beside a `.raw` file.
pub fn unreal_raw(place: &Place) -> String {
    let tile = place.tile();
    let said = serde_json::json!({ "width": tile.width, "height": tile.height, "bpp": 16 });
    format!("{said:#}\n")
}
