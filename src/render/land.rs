//! A world on the adapter: its rasters as textures, the walls of its block, its patches, and the shade of the sun it was last lit by.

use glam::DVec3;
use half::f16;

use super::{
    Gpu, RenderError,
    fire::{self, Spread},
    ground::{Lie, Rasters, copies},
    lumps::{self, Lump},
    overview::Overview,
    passes::{Slot, view},
    rivers::Rivers,
    shade::{coarse, sweep},
    smoke::Plumes,
    terrain::Quadtree,
    water::Inland,
};
use crate::{
    grid::{Field, Grid},
    scene::SceneParams,
    world::World,
};
use wgpu::TextureFormat;

/// What the ground's shaders read, in the order of `shaders/lib/ground.wgsl`.
pub(super) const GROUND: [Slot; 9] = [
    Slot::Numbers,
    Slot::Filtered,
    Slot::Filtered,
    Slot::Filtered,
    Slot::Filtered,
    Slot::Filtered,
    Slot::Numbers,
    Slot::Filtered,
    Slot::Filtered,
];
/// Cells a side on which shade is worked out, at most.
const MOST_SHADE: usize = 2048;

/// A world on the adapter.
pub struct Land {
    pub(super) lie: Lie,
    pub(super) tree: Quadtree,
    pub(super) group: wgpu::BindGroup,
    /// Corners of the block's walls, two a cell of the rim.
    pub(super) walls: wgpu::Buffer,
    pub(super) wall_corners: u32,
    pub(super) inland: Option<Inland>,
    /// Whether there are rivers to be drawn.
    pub(super) rivers: bool,
    /// Whether the map has lava, molten or frozen.
    lava: bool,
    /// What covers the ground, and whether that is a map's colours.
    pub(super) cover: wgpu::Texture,
    pub(super) draped: bool,
    height: Field<f32>,
    shade_on: Field<f32>,
    shade: wgpu::Texture,
    lit_from: Option<DVec3>,
    map: Grid,
    pub(super) plumes: Plumes,
    /// Light of the map's own lava, and the texture of what shines now.
    own_fire: Vec<[f32; 2]>,
    fire: wgpu::Texture,
    /// Particles that are drawn instead of the map's molten lava; whether their light is still to be brought.
    lumps: Option<Vec<Lump>>,
    unlit: bool,
}

impl Land {
    pub(super) fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        world: &World,
        scene: &SceneParams,
    ) -> Result<Self, RenderError> {
        gpu.check_size(&world.grid)?;
        let rasters = Rasters::new(world, scene)?;
        let size = [world.grid.width, world.grid.height];
        let heights = gpu.raster("heights", TextureFormat::R32Float, &copies(size, rasters.height.data.clone()));
        let slopes: Vec<_> = copies(size, rasters.slope)
            .into_iter()
            .map(|(size, data)| (size, data.iter().map(|v| v.map(f16::from_f32)).collect::<Vec<_>>()))
            .collect();
        let slopes = gpu.raster("slopes", TextureFormat::Rg16Float, &slopes);
        let cover = gpu.raster("cover", TextureFormat::Rgba8UnormSrgb, &copies(size, rasters.cover));
        let state = gpu.raster("state", TextureFormat::Rgba8Unorm, &copies(size, rasters.state));
        let shade_on = coarse(&rasters.height, MOST_SHADE);
        let shade_size = [shade_on.grid.width, shade_on.grid.height];
        let shade =
            gpu.raster("shade", TextureFormat::Rg16Float, &[(shade_size, vec![[f16::ZERO; 2]; shade_on.data.len()])]);
        let lava = if scene.lava.on { fire::lava(world) } else { None };
        let has_lava = lava.is_some();
        let mut spread = Spread::new(&world.grid);
        lava.iter().for_each(|lava| spread.add_all(&world.grid, lava));
        let (spread_size, spread) = (spread.size(), spread.spread());
        let fire = gpu.raster("light of lava", TextureFormat::Rg16Float, &fire::halves(spread_size, spread.clone()));
        let glow = lava.map_or_else(|| vec![([1, 1], vec![[f16::ZERO; 4]])], |lava| fire::halves(size, lava));
        let glow = gpu.raster("lava", TextureFormat::Rgba16Float, &glow);
        let mut inland = scene.water.inland.then(|| Inland::of(world, &rasters.height)).flatten();
        let levels = match &mut inland {
            Some(inland) => copies(size, std::mem::take(&mut inland.cells)),
            None => vec![([1, 1], vec![[0.0; 2]])],
        };
        let water = gpu.raster("water", TextureFormat::Rg32Float, &levels);
        let most = gpu.device.limits().max_texture_dimension_2d as usize;
        let rivers = scene.water.inland.then(|| Rivers::of(world, &rasters.lie, most)).flatten();
        let has_rivers = rivers.is_some();
        let levels = rivers.map_or_else(|| vec![([1, 1], vec![[0; 2]])], |rivers| copies(rivers.size, rivers.texels));
        let rivers = gpu.raster("rivers", TextureFormat::Rg8Unorm, &levels);
        let views = [&heights, &slopes, &cover, &state, &shade, &glow, &water, &rivers, &fire].map(view);
        let group = gpu.group(layout, views.iter().map(wgpu::BindingResource::TextureView).collect());
        let corners = walls(&rasters.height, &rasters.lie);
        Ok(Self {
            lie: rasters.lie,
            tree: Quadtree::new(&rasters.height, rasters.lie),
            group,
            walls: gpu.buffer("walls", &corners, wgpu::BufferUsages::VERTEX),
            wall_corners: corners.len() as u32,
            inland,
            rivers: has_rivers,
            lava: has_lava,
            cover,
            draped: false,
            height: rasters.height,
            shade_on,
            shade,
            lit_from: None,
            map: world.grid,
            plumes: Plumes::of(world),
            own_fire: spread,
            fire,
            lumps: None,
            unlit: false,
        })
    }

    /// Works the shade out anew where the light has moved.
    pub(super) fn light_from(&mut self, gpu: &Gpu, toward: DVec3) {
        if self.lit_from.is_some_and(|from| from.dot(toward) > 1.0 - 1e-9) {
            return;
        }
        let shade = sweep(&self.shade_on, self.lie.exaggeration, toward.to_array());
        // Far more than any relief, and small enough for half floats.
        let data: Vec<[f16; 2]> =
            shade.iter().map(|s| [s[0].clamp(-6e4, 6e4), s[1].min(6e4)].map(f16::from_f32)).collect();
        gpu.write(&self.shade, (0, 0), [self.shade_on.grid.width, self.shade_on.grid.height], &data);
        self.lit_from = Some(toward);
    }

    /// Draws these particles of lava from now on instead of what the map has of molten lava; or that again.
    pub fn set_lumps(&mut self, lumps: Option<Vec<Lump>>) {
        self.unlit |= lumps.is_some() || self.lumps.is_some();
        self.lumps = lumps;
    }

    /// Whether there is lava to be drawn.
    pub(super) fn burns(&self) -> bool {
        self.lava || self.lumps().is_some_and(|lumps| !lumps.is_empty())
    }

    /// The particles.
    pub(super) fn lumps(&self) -> Option<&[Lump]> {
        self.lumps.as_deref()
    }

    /// Works the light of lava out anew where it has changed.
    pub(super) fn shine(&mut self, gpu: &Gpu) {
        if !std::mem::take(&mut self.unlit) {
            return;
        }
        let spread = Spread::new(&self.map);
        let size = spread.size();
        let light = match &self.lumps {
            Some(lumps) => lumps::spread(lumps, &self.map).spread(),
            None => self.own_fire.clone(),
        };
        for (level, (size, data)) in fire::halves(size, light).iter().enumerate() {
            gpu.write(&self.fire, (level as u32, 0), *size, data);
        }
    }

    /// The ground in pieces about so wide, m, for cameras.
    pub(super) fn overview(&self, wide_m: f64) -> Overview {
        Overview::new(&self.height, &self.lie, wide_m)
    }

    /// How the map lies in the scene.
    pub fn lie(&self) -> &Lie {
        &self.lie
    }

    /// Height as drawn at a place of the scene, m; the sea's where that is higher, its rim's beyond the map.
    pub fn surface(&self, east: f64, north: f64) -> f64 {
        let [w, h] = self.lie.extent_m;
        let at = [(east + 0.5 * w).clamp(0.0, w), (0.5 * h - north).clamp(0.0, h)];
        crate::grid::linear(&self.height, at).max(self.lie.sea_m) * self.lie.exaggeration
    }
}

/// The block's walls as a strip around the rim: at each cell the top, then the bottom.
fn walls(height: &Field<f32>, lie: &Lie) -> Vec<[f32; 4]> {
    let (w, h) = (height.grid.width, height.grid.height);
    let rim = (0..w)
        .map(|x| (x, 0))
        .chain((1..h).map(|y| (w - 1, y)))
        .chain((0..w.saturating_sub(1)).rev().map(|x| (x, h - 1)))
        .chain((0..h.saturating_sub(1)).rev().map(|y| (0, y)));
    rim.flat_map(|(x, y)| {
        let east = ((x as f64 + 0.5) / w as f64 - 0.5) * lie.extent_m[0];
        let north = (0.5 - (y as f64 + 0.5) / h as f64) * lie.extent_m[1];
        [1.0, 0.0].map(|top| [east as f32, north as f32, height.at(x, y), top])
    })
    .collect()
}
