//! What was asked, checked as far as that goes without the world.

use crate::{
    export::{
        MESH_FORMATS, VECTOR_FORMATS,
        engine::{Engine, WeightFiles, reads_as_tiles},
        raster::{Depth, FORMATS, Format, Layout},
    },
    recipe::nearest,
    world::{Layer, World},
};

use super::{ExportRequest, JobError};

/// Most tiles along a side.
pub const MOST_TILES: usize = 64;

/// What a file shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// A layer of the catalogue.
    Layer(Layer),
    /// Which way the ground faces.
    Normals,
    /// How much of each material lies there.
    Weights,
}

/// A request that holds together.
#[derive(Debug)]
pub struct Order<'a> {
    pub request: &'a ExportRequest,
    pub format: &'static Format,
    pub content: Content,
    pub depth: Depth,
    pub layout: Layout,
}

pub fn refuse<T>(what: impl Into<String>) -> Result<T, JobError> {
    Err(JobError::Refused(what.into()))
}

impl<'a> Order<'a> {
    /// Checks what can be checked before the world is opened.
    pub fn check(request: &'a ExportRequest) -> Result<Self, JobError> {
        let file = request.file.display();
        let Some(format) = Format::of(&request.file) else {
            let meshes = MESH_FORMATS.iter().map(|(ending, _)| ending);
            let vectors = VECTOR_FORMATS.iter().map(|(ending, _)| ending);
            let endings: Vec<String> = FORMATS
                .iter()
                .flat_map(|format| format.endings)
                .chain(meshes)
                .chain(vectors)
                .map(|ending| format!(".{ending}"))
                .collect();
            return refuse(format!("{file}: no format has this ending; there are {}", endings.join(" ")));
        };
        let content = content(&request.layer)?;
        let depth = depth(request, format, content)?;
        let mut layout = Layout { big_endian: request.big_endian, south_first: request.south_first };
        if !format.bare && layout != Layout::default() {
            let flag = if request.big_endian { "--big-endian" } else { "--flip" };
            return refuse(format!(
                "{flag} is for .r16 .raw .r32, which leave it open; {file} has an order of its own"
            ));
        }
        if request.contours_m.is_some() {
            return refuse(format!("{file}: --contours goes with .geojson and .svg"));
        }
        if request.green.is_some() && content != Content::Normals {
            return refuse("--normal-y goes with --layer normals");
        }
        if let Some([from, to]) = request.range {
            if !(from.is_finite() && to.is_finite() && from < to) {
                return refuse(format!("--range {from}..{to}: the first number must be below the second"));
            }
            if depth == Depth::F32 || !matches!(content, Content::Layer(_)) {
                return refuse(format!("--range goes with whole numbers of a layer; {file} needs none"));
            }
        }
        if let Some(tiles) = request.tiles
            && !(2..=MOST_TILES).contains(&tiles)
        {
            return refuse(format!("--tiles {tiles}: must be a whole number from 2 to {MOST_TILES}"));
        }
        if let Some(engine) = request.engine {
            layout.south_first |= engine.demands().south_first && format.bare;
        }
        let order = Self { request, format, content, depth, layout };
        order.check_engine()?;
        Ok(order)
    }

    fn check_engine(&self) -> Result<(), JobError> {
        let (request, Some(engine)) = (self.request, self.request.engine) else { return Ok(()) };
        let demands = engine.demands();
        let (name, file) = (demands.name, request.file.display());
        let stem = request.file.file_stem().unwrap_or_default().to_string_lossy();
        let ending =
            self.format.endings.iter().find(|e| request.file.extension().is_some_and(|x| x.eq_ignore_ascii_case(e)));
        let heights = matches!(self.content, Content::Layer(_));
        if heights && !ending.is_some_and(|ending| demands.endings.contains(ending)) {
            let endings: Vec<String> = demands.endings.iter().map(|ending| format!(".{ending}")).collect();
            return refuse(format!("{file}: --engine {name} takes {}", endings.join(" ")));
        }
        if engine == Engine::Unreal && reads_as_tiles(&stem) {
            return refuse(format!(
                "{file}: Unreal takes such a name for one tile of many; choose one without a number after an x"
            ));
        }
        if self.layout.big_endian && engine != Engine::Unity {
            return refuse(format!("--big-endian: --engine {name} reads the least significant byte first"));
        }
        if request.south_first {
            return refuse(format!("--flip: --engine {name} orders the rows as its importer wants them"));
        }
        if heights && self.depth != Depth::U16 && engine != Engine::Azgaar && self.format.gray.contains(&Depth::U16) {
            return refuse(format!("--bits {}: --engine {name} needs 16, or slopes become stairs", self.depth.bits()));
        }
        if engine == Engine::Azgaar {
            return self.check_azgaar();
        }
        if let Some(size) = request.size
            && !demands.sizes.contains(&size)
        {
            let near = engine.nearest_size(size);
            let sizes: Vec<String> = demands.sizes.iter().map(usize::to_string).collect();
            return refuse(format!("--size {size}: {name} takes {} (nearest: {near})", sizes.join(" ")));
        }
        Ok(())
    }

    fn check_azgaar(&self) -> Result<(), JobError> {
        let request = self.request;
        if self.content != Content::Layer(Layer::Height) {
            return refuse(format!("--layer {}: --engine azgaar takes heights only", request.layer));
        }
        let others = [
            ("--tiles", request.tiles.is_some()),
            ("--range", request.range.is_some()),
            ("--bits", request.bits.is_some()),
        ];
        match others.iter().find(|(_, given)| *given) {
            Some((flag, _)) => {
                refuse(format!("{flag} does not go with --engine azgaar, whose grays have fixed meanings"))
            }
            None => Ok(()),
        }
    }

    /// Checks what needs the world.
    pub fn check_world(&self, world: &World) -> Result<(), JobError> {
        if let Content::Layer(layer) = self.content
            && !world.viewable().contains(&layer)
        {
            let there: Vec<_> = world.viewable().iter().map(|layer| layer.name()).collect();
            let name = layer.name();
            return refuse(format!("--layer {name}: this world has no layer '{name}' (it has: {})", there.join(", ")));
        }
        Ok(())
    }

    /// Whether weights of materials go with the heights, and how.
    pub fn weights(&self) -> WeightFiles {
        match self.request.engine {
            Some(engine) if self.content == Content::Layer(Layer::Height) => engine.demands().weights,
            _ => WeightFiles::None,
        }
    }

    /// Unreal asks for a description of its own beside `.raw` files.
    pub fn needs_unreal_raw_json(&self) -> bool {
        let raw = self.request.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("raw"));
        raw && self.request.engine == Some(Engine::Unreal)
    }
}

fn content(name: &str) -> Result<Content, JobError> {
    match name {
        "normals" => return Ok(Content::Normals),
        "weights" => return Ok(Content::Weights),
        _ => {}
    }
    let names = || Layer::ALL.iter().map(|layer| layer.name()).chain(["normals", "weights"]);
    Layer::from_name(name).map(Content::Layer).ok_or_else(|| {
        let hint = match nearest(name, names()) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!("there are: {}", names().collect::<Vec<_>>().join(", ")),
        };
        JobError::Refused(format!("--layer {name}: no such layer ({hint})"))
    })
}

fn depth(request: &ExportRequest, format: &'static Format, content: Content) -> Result<Depth, JobError> {
    let ending = format.endings[0];
    let depths: &[Depth] = match content {
        Content::Layer(_) if request.engine == Some(Engine::Azgaar) => &[Depth::U8],
        Content::Layer(_) => format.gray,
        Content::Normals => format.colour,
        // Four channels that sum to 255 are a picture in 8 bits and nothing else.
        Content::Weights if ending == "png" => &[Depth::U8],
        Content::Weights => &[],
    };
    let Some(&usual) = depths.first() else {
        let takers = if content == Content::Weights { ".png" } else { ".png .exr" };
        return refuse(format!("{}: {} are written as {takers}", request.file.display(), request.layer));
    };
    let Some(bits) = request.bits else { return Ok(usual) };
    depths.iter().copied().find(|depth| depth.bits() == bits).map_or_else(
        || {
            let known: Vec<String> = depths.iter().map(|depth| depth.bits().to_string()).collect();
            refuse(format!("--bits {bits}: .{ending} is written with {}", known.join(" or ")))
        },
        Ok,
    )
}
