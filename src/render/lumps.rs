//! Lava as particles: one surface over all of them, or lumps of their own.
//!
//! The surface is made in the picture's own space (van der Laan 2009): spheres are drawn as distances from the eye, those are blurred
//! where they belong together, and what that gives is lit like ground.

use wgpu::{BindGroupLayout, BindingResource, RenderPipeline, Texture, TextureFormat, VertexFormat};

use super::{
    Gpu,
    fire::Spread,
    ground::Lie,
    passes::{DEPTH, Pass, Slot, view},
};
use crate::grid::Grid;

/// A particle of lava.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lump {
    /// From the map's north-west corner to the east and to the south, and up from the world's datum, m.
    pub at_m: [f64; 3],
    /// Its radius, m.
    pub radius_m: f64,
    /// Its temperature, °C.
    pub temperature_degc: f64,
}

/// Distance from the eye, m, and temperature, °C.
const FELT: TextureFormat = TextureFormat::Rg32Float;
/// How much wider than particles the spheres of a surface are, so that they touch.
const WIDER: f32 = 1.55;
/// How often the surface is blurred both ways.
const TIMES: usize = 2;
/// From this temperature a particle shines onto the ground, °C.
const SHINES_DEGC: f64 = 525.0;

/// A particle as the shader reads it: place and radius; temperature and a number of its own.
pub(super) type Corner = [f32; 6];

/// Particles as they lie in the scene.
pub(super) fn corners(lumps: &[Lump], lie: &Lie, surface: bool) -> Vec<Corner> {
    let by = if surface { WIDER } else { 1.0 };
    let corner = |(k, lump): (usize, &Lump)| {
        let [x, y, z] = lump.at_m;
        let place = [x - 0.5 * lie.extent_m[0], 0.5 * lie.extent_m[1] - y, z * lie.exaggeration];
        let [x, y, z] = place.map(|v| v as f32);
        [x, y, z, lump.radius_m as f32 * by, lump.temperature_degc as f32, k as f32]
    };
    lumps.iter().enumerate().map(corner).collect()
}

/// Their light on the ground.
pub(super) fn spread(lumps: &[Lump], map: &Grid) -> Spread {
    let mut spread = Spread::new(map);
    for lump in lumps.iter().filter(|lump| lump.temperature_degc > SHINES_DEGC) {
        let area_m2 = 4.0 * lump.radius_m * lump.radius_m;
        spread.add([lump.at_m[0], lump.at_m[1]], area_m2, lump.temperature_degc);
    }
    spread
}

/// Pipelines.
pub(super) struct Lumps {
    spheres: RenderPipeline,
    smooth: RenderPipeline,
    smooth_layout: BindGroupLayout,
    surface_layout: BindGroupLayout,
    /// Surfaces and lumps for one and for four samples a pixel.
    surfaces: [RenderPipeline; 2],
    balls: [RenderPipeline; 2],
}

/// What the surface of a picture is made in.
pub(super) struct Felt {
    felt: [Texture; 2],
    depth: Texture,
}

impl Felt {
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        Self {
            felt: ["lava, distances", "lava, half blurred"].map(|label| gpu.target(label, size, FELT, 1)),
            depth: gpu.target("depth of lava", size, DEPTH, 1),
        }
    }
}

const ATTRIBUTES: [wgpu::VertexAttribute; 2] = [
    wgpu::VertexAttribute { format: VertexFormat::Float32x4, offset: 0, shader_location: 0 },
    wgpu::VertexAttribute { format: VertexFormat::Float32x2, offset: 16, shader_location: 1 },
];

impl Lumps {
    pub fn new(gpu: &Gpu, [frame, ground]: [&BindGroupLayout; 2]) -> Self {
        let smooth_layout = gpu.layout(&[Slot::Numbers, Slot::Uniform]);
        let surface_layout = gpu.layout(&[Slot::Numbers]);
        let vertices = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &ATTRIBUTES,
        })];
        let spheres = gpu.pipeline(&Pass {
            shaders: ["lump_vertex", "lump"],
            groups: &[frame],
            vertices: &vertices,
            format: FELT,
            depth: Some(true),
            ..Pass::default()
        });
        let smooth = gpu.pipeline(&Pass {
            shaders: ["cover", "lump_smooth"],
            groups: &[frame, &smooth_layout],
            format: FELT,
            ..Pass::default()
        });
        let surfaces = [1, 4].map(|samples| {
            gpu.pipeline(&Pass {
                shaders: ["cover", "lava"],
                groups: &[frame, ground, &surface_layout],
                depth: Some(true),
                samples,
                ..Pass::default()
            })
        });
        let balls = [1, 4].map(|samples| {
            gpu.pipeline(&Pass {
                shaders: ["lump_vertex", "ball"],
                groups: &[frame, ground],
                vertices: &vertices,
                depth: Some(true),
                samples,
                ..Pass::default()
            })
        });
        Self { spheres, smooth, smooth_layout, surface_layout, surfaces, balls }
    }

    /// Makes the surface, before the picture; for [`Lumps::surface`].
    pub fn make(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        felt: &Felt,
        (particles, count, radius_m): (&wgpu::Buffer, u32, f32),
    ) -> wgpu::BindGroup {
        let views = [view(&felt.felt[0]), view(&felt.felt[1])];
        let depth = view(&felt.depth);
        {
            let mut pass = begin(encoder, &views[0], Some(&depth));
            pass.set_pipeline(&self.spheres);
            pass.set_bind_group(0, frame, &[]);
            pass.set_vertex_buffer(0, particles.slice(..));
            pass.draw(0..6, 0..count);
        }
        for turn in 0..2 * TIMES {
            let along = if turn % 2 == 0 { [1.0f32, 0.0] } else { [0.0, 1.0] };
            let told = [along[0], along[1], radius_m, 0.0];
            let uniform = gpu.buffer("blur of lava", &told, wgpu::BufferUsages::UNIFORM);
            let resources = vec![BindingResource::TextureView(&views[turn % 2]), uniform.as_entire_binding()];
            let group = gpu.group(&self.smooth_layout, resources);
            let mut pass = begin(encoder, &views[(turn + 1) % 2], None);
            pass.set_pipeline(&self.smooth);
            pass.set_bind_group(0, frame, &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.group(&self.surface_layout, vec![BindingResource::TextureView(&views[0])])
    }

    /// Draws the surface into the picture; the frame's and the ground's groups are set.
    pub fn surface(&self, pass: &mut wgpu::RenderPass, surface: &wgpu::BindGroup, many: bool) {
        pass.set_pipeline(&self.surfaces[usize::from(many)]);
        pass.set_bind_group(2, surface, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Draws each particle as a lump of its own.
    pub fn balls(&self, pass: &mut wgpu::RenderPass, (particles, count): (&wgpu::Buffer, u32), many: bool) {
        pass.set_pipeline(&self.balls[usize::from(many)]);
        pass.set_vertex_buffer(0, particles.slice(..));
        pass.draw(0..6, 0..count);
    }
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    target: &'a wgpu::TextureView,
    depth: Option<&'a wgpu::TextureView>,
) -> wgpu::RenderPass<'a> {
    let attachment = wgpu::RenderPassColorAttachment {
        view: target,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("lava"),
        color_attachments: &[Some(attachment)],
        depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
