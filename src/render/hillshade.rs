//! Ground under one sun: Lambert's cosine law on the normal of central differences, one-sided at the rim. Reads one cell
//! to each side. The shader is `shaders/hillshade.wgsl`.

use wgpu::TextureUsages;

use super::{Gpu, RenderError};
use crate::{
    grid::{Edges, Field},
    world::World,
};

/// A sun, and how much steeper than it is the ground shall look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where it stands, clockwise from north, degrees.
    pub azimuth_deg: f64,
    /// How high it stands, degrees.
    pub altitude_deg: f64,
    /// Heights are multiplied by this before they are lit.
    pub exaggeration: f64,
}

impl Default for Sun {
    /// In the north-west, where maps have it.
    fn default() -> Self {
        Self { azimuth_deg: 315.0, altitude_deg: 42.0, exaggeration: 1.0 }
    }
}

impl Sun {
    /// Unit vector to the sun: east, south, up.
    fn toward(&self) -> [f64; 3] {
        let (azimuth, altitude) = (self.azimuth_deg.to_radians(), self.altitude_deg.to_radians());
        let flat = libm::cos(altitude);
        [libm::sin(azimuth) * flat, -libm::cos(azimuth) * flat, libm::sin(altitude)]
    }
}

/// What the shader is told; the layout is the uniform's.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniform {
    toward: [f32; 3],
    per_cell: f32,
    wraps: u32,
    padding: [u32; 3],
}

/// Light on the ground, 0 to 1, a value a cell.
pub fn hillshade(gpu: &Gpu, world: &World, sun: &Sun) -> Result<Field<f32>, RenderError> {
    gpu.check_size(&world.grid)?;
    let uniform = Uniform {
        toward: sun.toward().map(|v| v as f32),
        per_cell: (sun.exaggeration / world.grid.cell_m) as f32,
        wraps: u32::from(world.grid.edges == Edges::Wrap),
        padding: [0; 3],
    };
    gpu.checked(|| {
        let height = world.height();
        let ground = gpu.texture(&height.grid, "height", TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
        gpu.upload(&height, &ground);
        let light = gpu.texture(&height.grid, "light", TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC);
        draw(gpu, &ground, &uniform, &light);
        gpu.download(&light, height.grid)
    })
}

fn draw(gpu: &Gpu, ground: &wgpu::Texture, uniform: &Uniform, light: &wgpu::Texture) {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("sun"),
        size: size_of::<Uniform>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(uniform));
    let (pipeline, group) = pipeline(gpu);
    let ground = ground.create_view(&Default::default());
    let entries = [
        wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&ground) },
        wgpu::BindGroupEntry { binding: 1, resource: buffer.as_entire_binding() },
    ];
    let bound =
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &group, entries: &entries });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let view = light.create_view(&Default::default());
    let target = wgpu::RenderPassColorAttachment {
        view: &view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
    };
    let descriptor = wgpu::RenderPassDescriptor {
        label: Some("hillshade"),
        color_attachments: &[Some(target)],
        ..Default::default()
    };
    let mut pass = encoder.begin_render_pass(&descriptor);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bound, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
}

fn pipeline(gpu: &Gpu) -> (wgpu::RenderPipeline, wgpu::BindGroupLayout) {
    let [cover, shader] = ["cover", "hillshade"].map(|name| gpu.shader(name));
    let entry =
        |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None };
    // Numbers as they are: many adapters cannot filter 32-bit floats.
    let numbers = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let group = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("hillshade"),
        entries: &[entry(0, numbers), entry(1, uniform)],
    });
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("hillshade"),
        bind_group_layouts: &[Some(&group)],
        ..Default::default()
    });
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("hillshade"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &cover,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::TextureFormat::R32Float.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    (pipeline, group)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::{grid::Grid, world::Layer};

    /// The same in f64 on the CPU.
    fn expected(world: &World, sun: &Sun) -> Field<f32> {
        let height = world.height();
        let toward = sun.toward();
        Field::from_fn(world.grid, |x, y| {
            let [gx, gy] = height.gradient(x, y).map(|g| g * sun.exaggeration);
            let along = -gx * toward[0] - gy * toward[1] + toward[2];
            (along / (gx * gx + gy * gy + 1.0).sqrt()).max(0.0) as f32
        })
    }

    fn hills(grid: Grid) -> World {
        let mut world = World::new(grid, 0.0);
        let height = Field::from_fn(grid, |x, y| {
            (900.0 * libm::sin(x as f64 * 0.37) * libm::cos(y as f64 * 0.21) + 40.0 * x as f64) as f32
        });
        world.set_layer(Layer::Bedrock, height);
        world
    }

    /// An adapter, or nothing and a line about it where one may be missing.
    pub(in crate::render) fn adapter() -> Option<Gpu> {
        match Gpu::open() {
            Ok(gpu) => {
                println!("on {}", gpu.name());
                Some(gpu)
            }
            Err(error) if std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_some() => panic!("{error}"),
            Err(error) => {
                eprintln!("skipped: {error}");
                None
            }
        }
    }

    #[test]
    fn the_adapter_lights_the_ground_as_the_processor_does() {
        let Some(gpu) = adapter() else { return };
        for (width, height, edges) in [(96, 40, Edges::Open), (33, 65, Edges::Wrap), (1, 3, Edges::Closed)] {
            let world = hills(Grid::new(width, height, width as f64 * 250.0, edges));
            for sun in [Sun::default(), Sun { azimuth_deg: 100.0, altitude_deg: 10.0, exaggeration: 3.0 }] {
                let (got, want) = (hillshade(&gpu, &world, &sun).unwrap(), expected(&world, &sun));
                let apart = got.data.iter().zip(&want.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                // Slopes up to 6 from differences of heights near 1e3 m, each rounded to 24 bits.
                assert!(apart < 1e-5, "{width} x {height} {edges:?} {sun:?}: {apart}");
            }
        }
    }

    #[test]
    fn a_world_larger_than_a_texture_is_refused_in_words() {
        let Some(gpu) = adapter() else { return };
        let most = gpu.device.limits().max_texture_dimension_2d as usize;
        let world = World::new(Grid::new(most + 1, 1, 1e6, Edges::Open), 0.0);
        let error = hillshade(&gpu, &world, &Sun::default()).unwrap_err();
        assert!(matches!(&error, RenderError::TooLarge { .. }), "{error}");
    }
}
