//! The rasters of an export.

use std::borrow::Cow;

use crate::{
    export::{
        self, ExportError, Green, MATERIALS, WeightRules,
        engine::{Engine, WeightFiles, azgaar_gray},
        raster::{Depth, Lattice, Levels, Raster, Samples},
    },
    grid::Field,
    world::{Kind, Layer, World},
};

use super::{
    JobError,
    names::{Part, Sheet},
    order::{Content, Order},
    place::Place,
};

/// What was read from the world, ready to be encoded.
pub struct Drawing {
    /// What was asked for.
    asked: Raster,
    /// What whole numbers stand for; for floating point the range of the values.
    pub levels: Option<Levels>,
    /// Share of the samples outside `--range`.
    pub outside: f64,
    /// Where green points, in a normal map.
    pub green: Option<Green>,
    /// The rules that weights follow, where there are any.
    pub rules: Option<WeightRules>,
    /// Height of the highest sample above the sea, m; 0 for other layers.
    pub peak_m: f64,
    /// Weights at the vertices or at the quads, as the engine takes them.
    weights: Option<Raster>,
}

impl Drawing {
    /// Reads the world.
    pub fn of(order: &Order, world: &World, place: &Place) -> Result<Self, JobError> {
        let lattice = place.lattice;
        let weighing = order.weights() != WeightFiles::None || order.content == Content::Weights;
        let weigher = if weighing { Some(Weigher::of(world)?) } else { None };
        let mut drawing = Self {
            asked: Raster { lattice, channels: 1, samples: Samples::U8(Vec::new()), levels: None },
            levels: None,
            outside: 0.0,
            green: None,
            rules: weigher.as_ref().map(|weigher| weigher.rules),
            peak_m: 0.0,
            weights: None,
        };
        match (order.content, &weigher) {
            (Content::Layer(layer), _) => drawing.layer(order, world, layer)?,
            (Content::Normals, _) => drawing.normals(order, world)?,
            (Content::Weights, Some(weigher)) => drawing.asked = weigher.raster(lattice, world.sea_level_m),
            (Content::Weights, None) => {}
        }
        drawing.weights = match (order.weights(), weigher) {
            (WeightFiles::OneEach, Some(weigher)) => Some(weigher.raster(lattice, world.sea_level_m)),
            (WeightFiles::FourChannels, Some(weigher)) => Some(weigher.raster(place.quads(), world.sea_level_m)),
            _ => None,
        };
        Ok(drawing)
    }

    fn layer(&mut self, order: &Order, world: &World, layer: Layer) -> Result<(), JobError> {
        let field = finite(world, layer)?;
        let spec = layer.spec();
        let lattice = self.asked.lattice;
        let counted = spec.kind != Kind::Continuous;
        let values = if counted { lattice.pick(&field) } else { lattice.read(&field) };
        let span = Levels::of(&values);
        if layer == Layer::Height {
            self.peak_m = span.map_or(0.0, |levels| levels.white - world.sea_level_m);
        }
        if order.request.engine == Some(Engine::Azgaar) {
            let gray = azgaar_gray(self.peak_m);
            self.asked.samples = Samples::U8(values.map(|h| gray(h as f64 - world.sea_level_m)).data);
            return Ok(());
        }
        let Some(most) = order.depth.most() else {
            self.levels = span;
            self.asked.samples = Samples::F32(values.data);
            return Ok(());
        };
        let levels = match order.request.range {
            Some([black, white]) => Some(Levels { black, white }),
            None if counted => Levels::numbers(&values, most),
            None => span,
        };
        self.levels = levels;
        let Some(levels) = levels else { return Ok(()) };
        self.outside = levels.outside(&values);
        self.asked.levels = Some(levels);
        self.asked.samples = match order.depth {
            Depth::U8 => Samples::U8(levels.to_u8(&values)),
            _ => Samples::U16(levels.to_u16(&values)),
        };
        Ok(())
    }

    fn normals(&mut self, order: &Order, world: &World) -> Result<(), JobError> {
        let engines = if order.request.engine == Some(Engine::Unreal) { Green::Down } else { Green::Up };
        let green = order.request.green.unwrap_or(engines);
        self.green = Some(green);
        let height = self.asked.lattice.read(&finite(world, Layer::Height)?);
        let normals = export::normals(&height, green);
        let encoded = |most: f64| normals.iter().map(move |&v| export::encoded_normal(v, most));
        self.asked.channels = 3;
        self.asked.samples = match order.depth {
            Depth::U8 => Samples::U8(encoded(255.0).map(|v| v as u8).collect()),
            Depth::U16 => Samples::U16(encoded(65535.0).map(|v| v as u16).collect()),
            Depth::F32 => Samples::F32(normals),
        };
        Ok(())
    }

    /// The raster of a sheet.
    pub fn raster(&self, sheet: &Sheet) -> Cow<'_, Raster> {
        match (sheet.part, &self.weights) {
            (Part::Material(i), Some(weights)) => Cow::Owned(channel(weights, i)),
            (Part::FourChannels, Some(weights)) => Cow::Borrowed(weights),
            _ => Cow::Borrowed(&self.asked),
        }
    }
}

fn channel(raster: &Raster, i: usize) -> Raster {
    let Samples::U8(all) = &raster.samples else { return raster.clone() };
    let one = all.iter().skip(i).step_by(raster.channels).copied().collect();
    Raster { lattice: raster.lattice, channels: 1, samples: Samples::U8(one), levels: None }
}

fn finite(world: &World, layer: Layer) -> Result<Field<f32>, JobError> {
    let field = world.view(layer).unwrap_or_else(|| Field::filled(world.grid, 0.0));
    match field.first_non_finite() {
        Some((x, y)) => Err(ExportError::NotFinite { layer: layer.name(), x, y }.into()),
        None => Ok(field),
    }
}

/// Weighs materials: the rules come from the whole world, so that parts and tiles of it agree.
struct Weigher {
    rules: WeightRules,
    height: Field<f32>,
    slope: Field<f32>,
}

impl Weigher {
    fn of(world: &World) -> Result<Self, JobError> {
        let (height, slope) = (finite(world, Layer::Height)?, finite(world, Layer::Slope)?);
        Ok(Self { rules: WeightRules::of(&height, &slope, world.sea_level_m), height, slope })
    }

    fn raster(&self, lattice: Lattice, sea_level_m: f64) -> Raster {
        let (height, slope) = (lattice.read(&self.height), lattice.read(&self.slope));
        let samples = Samples::U8(self.rules.weights(&height, &slope, sea_level_m));
        Raster { lattice, channels: MATERIALS.len(), samples, levels: None }
    }
}
