//! Shafts of light through haze: a march at half the size, then a blur that keeps edges.

use super::{
    Gpu,
    passes::{LIGHT, Pass, Slot, Whole, view},
};
use wgpu::{BindGroup, BindGroupLayout, BindingResource, RenderPipeline, Texture, TextureFormat};

/// Standard deviation of the blur, texels.
const SIGMA: f32 = 2.5;

pub(super) struct Shafts {
    depth_layouts: [BindGroupLayout; 2],
    distance: [RenderPipeline; 2],
    march_layout: BindGroupLayout,
    march: RenderPipeline,
    soften_layout: BindGroupLayout,
    soften: RenderPipeline,
}

/// What they are drawn into, for a picture of one size.
pub(super) struct Halves {
    distance: Texture,
    light: [Texture; 2],
}

impl Halves {
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let half = size.map(|n| n.div_ceil(2));
        let light = ["shafts", "shafts, half blurred"].map(|label| gpu.target(label, half, LIGHT, 1));
        Self { distance: gpu.target("distance", size, TextureFormat::R32Float, 1), light }
    }

    /// How far away each pixel is, m.
    pub fn distance(&self) -> &Texture {
        &self.distance
    }

    /// The light that is added to the picture.
    pub fn light(&self) -> &Texture {
        &self.light[0]
    }
}

impl Shafts {
    pub fn new(gpu: &Gpu, frame: &BindGroupLayout, ground: &BindGroupLayout) -> Self {
        let depth_layouts = [Slot::Depth, Slot::DepthMany].map(|slot| gpu.layout(&[slot]));
        let march_layout = gpu.layout(&[Slot::Numbers]);
        let soften_layout = gpu.layout(&[Slot::Numbers, Slot::Numbers, Slot::Uniform]);
        let pass = |shader, groups: &[&BindGroupLayout], format| {
            gpu.pipeline(&Pass { shaders: ["cover", shader], groups, format, ..Pass::default() })
        };
        Self {
            distance: [
                pass("distance", &[frame, &depth_layouts[0]], TextureFormat::R32Float),
                pass("distance_many", &[frame, &depth_layouts[1]], TextureFormat::R32Float),
            ],
            march: pass("shafts", &[frame, ground, &march_layout], LIGHT),
            soften: pass("soften", &[&soften_layout], LIGHT),
            depth_layouts,
            march_layout,
            soften_layout,
        }
    }

    pub fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        [frame, ground]: [&BindGroup; 2],
        depth: &Texture,
        halves: &Halves,
    ) {
        let many = usize::from(depth.sample_count() > 1);
        let depth = view(depth);
        let depth = gpu.group(&self.depth_layouts[many], vec![BindingResource::TextureView(&depth)]);
        let mut whole = Whole { encoder };
        whole.draw(&self.distance[many], &[frame, &depth], &halves.distance, false);
        let distance = view(&halves.distance);
        let far = gpu.group(&self.march_layout, vec![BindingResource::TextureView(&distance)]);
        whole.draw(&self.march, &[frame, ground, &far], &halves.light[0], false);
        for (from, step) in [(0, [1.0, 0.0]), (1, [0.0, 1.0])] {
            let source = view(&halves.light[from]);
            let told = gpu.buffer("along", &[step[0], step[1], SIGMA, 0.0f32], wgpu::BufferUsages::UNIFORM);
            let views = [&source, &distance].map(BindingResource::TextureView);
            let group = gpu.group(&self.soften_layout, views.into_iter().chain([told.as_entire_binding()]).collect());
            whole.draw(&self.soften, &[&group], &halves.light[1 - from], false);
        }
    }
}
