//! The pipelines of the picture itself: a set for each quality, with and without what only some worlds have. A processor that
//! draws runs both ways of every branch, so that what is not there is left out of the shader.

use wgpu::{BindGroupLayout, RenderPipeline, VertexFormat};

use super::{Gpu, passes::Pass, terrain::Patch};

/// Samples a pixel for draft, normal and full quality: edges are smooth in the latter two.
const SAMPLES: [u32; 3] = [1, 4, 4];

/// What a set is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kind {
    /// 0 draft, 1 normal, 2 full.
    pub quality: usize,
    /// Whether there is lava.
    pub fire: bool,
    /// Whether there are rivers.
    pub rivers: bool,
}

impl Kind {
    /// Samples a pixel.
    pub fn samples(self) -> u32 {
        SAMPLES[self.quality]
    }
}

/// The pipelines of the picture itself.
pub(super) struct Set {
    pub ground: RenderPipeline,
    pub side: RenderPipeline,
    pub backdrop: RenderPipeline,
    pub sea: RenderPipeline,
    pub sea_side: RenderPipeline,
    pub lake: RenderPipeline,
}

impl Set {
    pub fn new(gpu: &Gpu, kind: Kind, [frame, ground, covers]: [&BindGroupLayout; 3]) -> Self {
        let samples = kind.samples();
        let switch = |on: bool| f64::from(u8::from(on));
        let constants =
            &[("QUALITY", kind.quality as f64), ("FIRE", switch(kind.fire)), ("RIVERS", switch(kind.rivers))];
        let attribute = |location, offset, format| wgpu::VertexAttribute { format, offset, shader_location: location };
        let on_patches = [attribute(0, 0, VertexFormat::Float32x4), attribute(1, 16, VertexFormat::Float32x4)];
        let patches = || wgpu::VertexBufferLayout {
            array_stride: size_of::<Patch>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &on_patches,
        };
        let on_walls = [attribute(0, 0, VertexFormat::Float32x4)];
        let walls = || wgpu::VertexBufferLayout {
            array_stride: 16,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &on_walls,
        };
        let corners = [attribute(0, 0, VertexFormat::Float32x2), attribute(1, 8, VertexFormat::Float32)];
        let corners = wgpu::VertexBufferLayout {
            array_stride: 12,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &corners,
        };
        let water = |shaders, vertices: wgpu::VertexBufferLayout, strip| {
            gpu.pipeline(&Pass {
                shaders,
                groups: &[frame, ground],
                vertices: &[Some(vertices)],
                strip,
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                depth: Some(true),
                samples,
                constants,
                ..Pass::default()
            })
        };
        Self {
            ground: gpu.pipeline(&Pass {
                shaders: ["ground_vertex", "ground"],
                groups: &[frame, ground, covers],
                vertices: &[Some(patches())],
                depth: Some(true),
                samples,
                constants,
                ..Pass::default()
            }),
            side: gpu.pipeline(&Pass {
                shaders: ["side_vertex", "side"],
                groups: &[frame, ground],
                vertices: &[Some(walls())],
                strip: true,
                depth: Some(true),
                samples,
                constants,
                ..Pass::default()
            }),
            backdrop: gpu.pipeline(&Pass {
                shaders: ["cover", "backdrop"],
                groups: &[frame],
                depth: Some(false),
                samples,
                constants,
                ..Pass::default()
            }),
            sea: water(["sea_vertex", "sea"], corners, false),
            sea_side: water(["sea_side_vertex", "sea_side"], walls(), true),
            lake: water(["lake_vertex", "lake"], patches(), false),
        }
    }
}
