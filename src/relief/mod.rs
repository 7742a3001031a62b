//! Pictures of a world on the CPU: the shaded relief map one would hang on a wall, and any layer by its palette, with
//! legend, scale bar, plate borders and motions.
//!
//! A picture is made in passes over its pixels, rows in parallel: heights are brought to the picture's raster
//! (`frame`), lit (`shade`), coloured by height (`tint`, `palette`) and climate (`cover`), the coast is drawn (`coast`),
//! rivers and lakes (`rivers`) and plates (`overlay`) are laid over it, and what stands around the map is added
//! (`furniture`, `text`). Same world, same bits, for any number of threads. A film draws the same map at its own size and
//! one scale of colours, quicker ([`film`]).
//!
//! This room reads worlds and never changes them; it knows no process and no GPU.

mod coast;
mod cover;
mod drape;
pub mod film;
mod frame;
mod furniture;
mod lava;
mod layers;
mod marks;
mod overlay;
mod palette;
mod rivers;
mod shade;
mod sheet;
mod smoke;
mod swatches;
mod text;
mod tint;

pub use cover::LAYERS as CLIMATE;
pub use drape::{Drape, Margins};
pub use lava::LAYERS as LAVA;
pub use sheet::contact_sheet;

use image::RgbImage;

use crate::world::{Layer, World};
use frame::Frame;

/// What the map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// Land and sea, shaded and coloured by height.
    #[default]
    Relief,
    /// One layer by its palette.
    Layer(Layer),
}

/// How the map is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Plate borders and motions over the map, where the world has plates.
    pub overlay: bool,
    /// Margin, legend, scale bar and title around the map. Without it the picture is the map alone.
    pub furniture: bool,
    /// A larger world is averaged in blocks until its longer side fits, pixels.
    pub max_px: usize,
    /// A smaller world is drawn that many whole times larger that its longer side reaches this, pixels.
    pub min_px: usize,
    /// Smoke over the relief, where a vent erupts now.
    pub smoke: bool,
    /// The line above the map.
    pub title: Option<String>,
    /// Vertical exaggeration of the light; chosen from the land's own slopes where absent. A film fixes it.
    pub exaggeration: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            overlay: false,
            furniture: true,
            max_px: 2048,
            min_px: 512,
            smoke: false,
            title: None,
            exaggeration: None,
        }
    }
}

impl Options {
    /// The map alone, at most `max_px` on its longer side and never enlarged: for previews, sheets and films.
    pub fn bare(max_px: usize) -> Self {
        Self { furniture: false, max_px, min_px: 0, ..Self::default() }
    }
}

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReliefError {
    /// No process made the layer.
    #[error("this world has no layer '{layer}' (it has {present})")]
    Absent {
        /// The layer asked for.
        layer: &'static str,
        /// Those that can be drawn.
        present: String,
    },
    /// A value is not a number.
    #[error("layer '{layer}' is not finite at cell ({x}, {y})")]
    NotFinite {
        /// The layer.
        layer: &'static str,
        /// Column of the cell.
        x: usize,
        /// Row of the cell.
        y: usize,
    },
    /// The picture has more pixels than a file can hold.
    #[error("a picture of {0} x {1} pixels is too large")]
    TooLarge(usize, usize),
}

/// A map without what stands around it.
struct Painting {
    canvas: marks::Canvas,
    frame: Frame,
    legend: furniture::Legend,
    symbols: Vec<furniture::Symbol>,
}

/// Draws the world.
pub fn map(world: &World, view: &View, options: &Options) -> Result<RgbImage, ReliefError> {
    let Painting { mut canvas, frame, legend, symbols } = painted(world, view, options)?;
    if options.furniture {
        canvas = furniture::surround(canvas, &frame, &legend, &symbols, options.title.as_deref());
    }
    Ok(canvas.into_image())
}

fn painted(world: &World, view: &View, options: &Options) -> Result<Painting, ReliefError> {
    let frame = Frame::new(world.grid, options.max_px, options.min_px);
    let (width, height) = (frame.grid.width, frame.grid.height);
    if width.max(height) > 32_000 || width.saturating_mul(height) > marks::MOST_PIXELS {
        return Err(ReliefError::TooLarge(width, height));
    }
    let ground = finite(Layer::Height, world.height())?;
    let heights = frame.continuous(&ground);
    let scene = tint::Scene::new(&ground, world.sea_level_m);
    let (pixels, legend) = match view {
        View::Relief => {
            let cover = cover::Cover::of(world, |field| frame.continuous(field));
            let legend = match &cover {
                Some(cover) if cover.has_climate() => furniture::Legend::climates(&scene),
                _ => furniture::Legend::heights(&scene),
            };
            (tint::relief(&frame, &heights, &scene, cover.as_ref(), options), legend)
        }
        View::Layer(layer) => {
            let field = world.view(*layer).ok_or_else(|| absent(world, *layer))?;
            let field = finite(*layer, field)?;
            layers::draw(&frame, *layer, &field, &heights, &scene, options)
        }
    };
    let mut canvas = marks::Canvas::from_linear(frame.grid, &pixels);
    if *view == View::Relief
        && let Some(waters) = rivers::Waters::of(world, &frame.grid)
    {
        canvas.lay(&waters);
    }
    if options.smoke
        && *view == View::Relief
        && let Some(smoke) = smoke::Smoke::of(world, &frame.grid)
    {
        canvas.cover(&smoke);
    }
    let mut symbols = Vec::new();
    if options.overlay {
        symbols = overlay::draw(&mut canvas, &frame, world);
    }
    Ok(Painting { canvas, frame, legend, symbols })
}

/// The flat colours of heights on maps of this world: linear red, green and blue, 0 to 1.
pub fn tints(world: &World) -> impl Fn(f32) -> [f32; 3] {
    let scene = tint::Scene::new(&world.height(), world.sea_level_m);
    move |height_m| scene.at(height_m)
}

/// A colour of linear light as sRGB bytes.
pub fn srgb(linear: [f32; 3]) -> [u8; 3] {
    palette::Encoder::new().bytes(linear)
}

/// The vertical exaggeration that a map of this world would choose; a film puts that of one frame into all.
pub fn exaggeration(world: &World, options: &Options) -> f64 {
    let frame = Frame::new(world.grid, options.max_px, options.min_px);
    let sea = world.sea_level_m as f32;
    let heights = frame.continuous(&world.height());
    let has_land = heights.data.iter().any(|&h| h > sea);
    shade::exaggeration(&heights, |h| h > sea || !has_land)
}

fn finite(layer: Layer, field: crate::grid::Field<f32>) -> Result<crate::grid::Field<f32>, ReliefError> {
    match field.first_non_finite() {
        Some((x, y)) => Err(ReliefError::NotFinite { layer: layer.name(), x, y }),
        None => Ok(field),
    }
}

fn absent(world: &World, layer: Layer) -> ReliefError {
    let present: Vec<&str> = world.viewable().into_iter().map(Layer::name).collect();
    ReliefError::Absent { layer: layer.name(), present: present.join(", ") }
}
