//! How a pass is put together: layouts and pipelines without their many words.

use wgpu::{
    BindGroup, BindGroupEntry, BindGroupLayout, BindGroupLayoutEntry, BindingResource, BindingType, RenderPipeline,
    ShaderStages, TextureFormat, TextureSampleType, TextureViewDimension, VertexBufferLayout,
};

use super::Gpu;

/// Colours in linear light, brighter than white where they are.
pub(super) const LIGHT: TextureFormat = TextureFormat::Rgba16Float;
/// Reversed: 0 is infinitely far.
pub(super) const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// What a shader reads at a binding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Slot {
    /// A uniform buffer.
    Uniform,
    /// A texture that is filtered.
    Filtered,
    /// Numbers as they are.
    Numbers,
    /// A filtered array of textures.
    Layers,
    /// A sampler that filters.
    Sampler,
    /// Depth, of one or several samples a pixel.
    Depth,
    /// See there.
    DepthMany,
}

impl Slot {
    fn binding(self) -> BindingType {
        let texture = |filterable, view_dimension| BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        match self {
            Slot::Uniform => BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            Slot::Filtered => texture(true, TextureViewDimension::D2),
            Slot::Numbers => texture(false, TextureViewDimension::D2),
            Slot::Layers => texture(true, TextureViewDimension::D2Array),
            Slot::Depth | Slot::DepthMany => BindingType::Texture {
                sample_type: TextureSampleType::Depth,
                view_dimension: TextureViewDimension::D2,
                multisampled: self == Slot::DepthMany,
            },
            Slot::Sampler => BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        }
    }
}

/// A pipeline's particulars.
pub(super) struct Pass<'a> {
    /// Its vertex and fragment shaders.
    pub shaders: [&'a str; 2],
    pub groups: &'a [&'a BindGroupLayout],
    pub vertices: &'a [Option<VertexBufferLayout<'a>>],
    pub strip: bool,
    pub format: TextureFormat,
    pub blend: Option<wgpu::BlendState>,
    /// Whether it is hidden by what is nearer, and whether it hides what is farther.
    pub depth: Option<bool>,
    pub samples: u32,
    /// Constants of the fragment shader.
    pub constants: &'a [(&'a str, f64)],
}

impl Default for Pass<'_> {
    fn default() -> Self {
        Self {
            shaders: ["cover", "cover"],
            groups: &[],
            vertices: &[],
            strip: false,
            format: LIGHT,
            blend: None,
            depth: None,
            samples: 1,
            constants: &[],
        }
    }
}

impl Gpu {
    pub(super) fn layout(&self, slots: &[Slot]) -> BindGroupLayout {
        let entries: Vec<_> = slots
            .iter()
            .enumerate()
            .map(|(binding, slot)| BindGroupLayoutEntry {
                binding: binding as u32,
                visibility: ShaderStages::VERTEX_FRAGMENT,
                ty: slot.binding(),
                count: None,
            })
            .collect();
        self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    }

    pub(super) fn group(&self, layout: &BindGroupLayout, resources: Vec<BindingResource>) -> BindGroup {
        let entries: Vec<_> = resources
            .into_iter()
            .enumerate()
            .map(|(binding, resource)| BindGroupEntry { binding: binding as u32, resource })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// A sampler that filters; where a texture repeats, from one of its smaller copies, else between two.
    pub(super) fn sampler(&self, u: wgpu::AddressMode, v: wgpu::AddressMode) -> wgpu::Sampler {
        let mipmap_filter = match v {
            // The ground's textures are mixed of two sizes already.
            wgpu::AddressMode::Repeat => wgpu::MipmapFilterMode::Nearest,
            _ => wgpu::MipmapFilterMode::Linear,
        };
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: u,
            address_mode_v: v,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter,
            ..Default::default()
        })
    }

    pub(super) fn pipeline(&self, pass: &Pass) -> RenderPipeline {
        let [vertex, fragment] = pass.shaders.map(|name| self.shader(name));
        let groups: Vec<_> = pass.groups.iter().map(|group| Some(*group)).collect();
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(pass.shaders[1]),
            bind_group_layouts: &groups,
            ..Default::default()
        });
        let target =
            wgpu::ColorTargetState { format: pass.format, blend: pass.blend, write_mask: wgpu::ColorWrites::ALL };
        let topology =
            if pass.strip { wgpu::PrimitiveTopology::TriangleStrip } else { wgpu::PrimitiveTopology::TriangleList };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(pass.shaders[1]),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &vertex,
                entry_point: Some("main"),
                compilation_options: Default::default(),
                buffers: pass.vertices,
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: pass.depth.map(|writes| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(writes),
                depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: pass.samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &fragment,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: pass.constants,
                    ..Default::default()
                },
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A texture as a binding.
pub(super) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

/// Draws passes that go once over a whole texture.
pub(super) struct Whole<'a> {
    pub encoder: &'a mut wgpu::CommandEncoder,
}

impl Whole<'_> {
    /// One of them; over what is there, or over black.
    pub fn draw(&mut self, pipeline: &RenderPipeline, groups: &[&BindGroup], to: &wgpu::Texture, over: bool) {
        let target = view(to);
        let load = if over { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        let attachment = wgpu::RenderPassColorAttachment {
            view: &target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        };
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments: &[Some(attachment)],
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        for (place, group) in groups.iter().enumerate() {
            pass.set_bind_group(place as u32, *group, &[]);
        }
        pass.draw(0..3, 0..1);
    }
}
