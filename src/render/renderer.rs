//! One renderer for files, films and windows: it owns pipelines and textures, takes a world's rasters once and draws
//! any number of pictures of them.

use image::RgbImage;
use wgpu::{AddressMode, BindGroup, BindGroupLayout, BindingResource, RenderPipeline, Texture, TextureFormat, VertexFormat};

use super::{
    Gpu, RenderError,
    camera::Camera,
    drape::DRAPED,
    frame::{Frame, Lights, Moment, Sky},
    glow::{Copies, Glow},
    land::{GROUND, Land},
    passes::{DEPTH, LIGHT, Pass, Slot, view},
    sea::Sea,
    terrain::{self, Patch, Seen},
    textures::Textures,
};
use crate::{
    scene::{Quality, SceneParams, Surround},
    world::World,
};

/// Format of pictures: sRGB, eight bits.
const PICTURE: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Most pixels of a side of a picture, besides the adapter's own limit.
const MOST_PX: u32 = 16_384;

/// Draws.
pub struct Renderer {
    gpu: Gpu,
    ground_layout: BindGroupLayout,
    frame_layout: BindGroupLayout,
    tone_layout: BindGroupLayout,
    covers: BindGroup,
    samplers: [wgpu::Sampler; 3],
    /// Pipelines for one and for four samples a pixel.
    sets: [Set; 2],
    tone: RenderPipeline,
    glow: Glow,
    indices: wgpu::Buffer,
    index_count: u32,
    sea: Sea,
    sky: Option<SkyTexture>,
    targets: Option<Targets>,
}

/// The pipelines of the picture itself.
struct Set {
    ground: RenderPipeline,
    side: RenderPipeline,
    backdrop: RenderPipeline,
    sea: RenderPipeline,
}

struct SkyTexture {
    lights: Lights,
    told: [f64; 2],
    sky: Sky,
    texture: Texture,
}

/// What passes draw into, for one size.
struct Targets {
    size: [u32; 2],
    samples: u32,
    many: Option<Texture>,
    light: Texture,
    depth: Texture,
    picture: Texture,
    copies: Copies,
}

impl Targets {
    fn new(gpu: &Gpu, size: [u32; 2], samples: u32) -> Self {
        Self {
            size,
            samples,
            many: (samples > 1).then(|| gpu.target("samples", size, LIGHT, samples)),
            light: gpu.target("light", size, LIGHT, 1),
            depth: gpu.target("depth", size, DEPTH, samples),
            picture: gpu.target("picture", size, PICTURE, 1),
            copies: Copies::new(gpu, size),
        }
    }
}

impl Renderer {
    /// Makes all pipelines.
    pub fn new(gpu: Gpu) -> Result<Self, RenderError> {
        gpu.checked(|| Ok(()))?;
        let frame_layout = gpu.layout(&[Slot::Uniform, Slot::Filtered, Slot::Sampler, Slot::Sampler, Slot::Sampler]);
        let ground_layout = gpu.layout(&GROUND);
        let cover_layout = gpu.layout(&[Slot::Layers, Slot::Layers]);
        let tone_layout = gpu.layout(&[Slot::Numbers, Slot::Filtered]);
        let sets = [1, 4].map(|samples| Set::new(&gpu, samples, [&frame_layout, &ground_layout, &cover_layout]));
        let tone = gpu.pipeline(&Pass {
            shaders: ["cover", "tone"],
            groups: &[&frame_layout, &tone_layout],
            format: PICTURE,
            ..Pass::default()
        });
        let textures = Textures::new(&gpu);
        let layers = |texture: &Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            })
        };
        let (colours, slopes) = (layers(&textures.colours), layers(&textures.slopes));
        let covers =
            gpu.group(&cover_layout, vec![BindingResource::TextureView(&colours), BindingResource::TextureView(&slopes)]);
        let indices = terrain::indices();
        let (clamp, repeat) = (AddressMode::ClampToEdge, AddressMode::Repeat);
        Ok(Self {
            samplers: [gpu.sampler(clamp, clamp), gpu.sampler(repeat, repeat), gpu.sampler(repeat, clamp)],
            sets,
            tone,
            glow: Glow::new(&gpu),
            indices: gpu.buffer("lattice", &indices, wgpu::BufferUsages::INDEX),
            index_count: indices.len() as u32,
            sea: Sea::new(&gpu),
            covers,
            ground_layout,
            frame_layout,
            tone_layout,
            sky: None,
            targets: None,
            gpu,
        })
    }

    /// The adapter.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Brings a world to the adapter.
    pub fn land(&self, world: &World, scene: &SceneParams) -> Result<Land, RenderError> {
        self.gpu.checked(|| Land::new(&self.gpu, &self.ground_layout, world, scene))
    }

    /// The picture, in the adapter's memory; valid until the next one.
    pub fn draw(&mut self, land: &mut Land, scene: &SceneParams, camera: &Camera, moment: &Moment) -> Result<&Texture, RenderError> {
        let [width, height] = moment.size;
        let most = self.gpu.device.limits().max_texture_dimension_2d.min(MOST_PX);
        if width == 0 || height == 0 || width.max(height) > most {
            return Err(RenderError::PictureSize { width, height, most });
        }
        let samples = if moment.quality == Quality::Draft { 1 } else { 4 };
        if self.targets.as_ref().is_none_or(|t| t.size != moment.size || t.samples != samples) {
            self.targets = None;
            self.targets = Some(self.gpu.checked(|| Ok(Targets::new(&self.gpu, moment.size, samples)))?);
        }
        self.look_up(scene, moment);
        let (Some(sky), Some(targets)) = (&self.sky, &self.targets) else {
            return Err(self.gpu.failed("its targets are gone"));
        };
        self.gpu.checked(|| {
            land.light_from(&self.gpu, sky.sky.toward);
            let mut frame = Frame::new(scene, camera, &sky.lights, &sky.sky, &land.lie, moment);
            if land.draped {
                frame.cover2[2] = DRAPED;
            }
            self.encode(land, scene, camera, moment, &frame, (sky, targets));
            Ok(())
        })?;
        Ok(&targets.picture)
    }

    /// The picture as a file has it.
    pub fn picture(&mut self, land: &mut Land, scene: &SceneParams, camera: &Camera, moment: &Moment) -> Result<RgbImage, RenderError> {
        let texture = self.draw(land, scene, camera, moment)?.clone();
        let pixels = self.gpu.read_pixels(&texture)?;
        let rgb = pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        RgbImage::from_raw(moment.size[0], moment.size[1], rgb).ok_or_else(|| self.gpu.failed("half a picture came back"))
    }

    /// The sky of the moment, made anew where it has changed.
    fn look_up(&mut self, scene: &SceneParams, moment: &Moment) {
        let lights = Lights::at(&scene.sun, moment.share);
        let told = [scene.sky.dust, scene.sky.night];
        if self.sky.as_ref().is_some_and(|sky| sky.lights == lights && sky.told == told) {
            return;
        }
        let sky = Sky::new(&lights, told[0], told[1]);
        let pixels: Vec<[half::f16; 4]> =
            sky.table.light.iter().map(|p| [p[0], p[1], p[2], 1.0].map(half::f16::from_f32)).collect();
        let texture = self.gpu.raster("sky", LIGHT, &[(super::air::SKY_SIZE, pixels)]);
        self.sky = Some(SkyTexture { lights, told, sky, texture });
    }

    fn encode(
        &self,
        land: &Land,
        scene: &SceneParams,
        camera: &Camera,
        moment: &Moment,
        frame: &Frame,
        (sky, targets): (&SkyTexture, &Targets),
    ) {
        let gpu = &self.gpu;
        let uniform = gpu.buffer("frame", std::slice::from_ref(frame), wgpu::BufferUsages::UNIFORM);
        let sky_view = view(&sky.texture);
        let mut resources = vec![uniform.as_entire_binding(), BindingResource::TextureView(&sky_view)];
        resources.extend(self.samplers.iter().map(BindingResource::Sampler));
        let frame_group = gpu.group(&self.frame_layout, resources);
        let [width, height] = moment.size.map(f64::from);
        let seen = Seen {
            matrix: camera.view_projection(width / height),
            eye: camera.eye(),
            pixels: camera.pixels_per_radian(height),
            most_px: match moment.quality {
                Quality::Draft => 9.0,
                Quality::Normal => 4.0,
                Quality::Full => 2.5,
            },
        };
        let patches = land.tree.select(&seen);
        let patch_buffer = gpu.buffer("patches", &patches, wgpu::BufferUsages::VERTEX);
        let set = &self.sets[usize::from(targets.samples > 1)];
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let around = match scene.surround {
            Surround::Auto => land.lie.rim_at_sea,
            Surround::Sea => true,
            Surround::Block => false,
        };
        {
            let mut pass = self.begin(&mut encoder, targets);
            pass.set_bind_group(0, &frame_group, &[]);
            pass.set_bind_group(1, &land.group, &[]);
            pass.set_bind_group(2, &self.covers, &[]);
            pass.set_pipeline(&set.ground);
            pass.set_vertex_buffer(0, patch_buffer.slice(..));
            pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed(0..self.index_count, 0, 0..patches.len() as u32);
            if !around {
                pass.set_pipeline(&set.side);
                pass.set_vertex_buffer(0, land.walls.slice(..));
                pass.draw(0..land.wall_corners, 0..1);
            }
            pass.set_pipeline(&set.backdrop);
            pass.draw(0..3, 0..1);
            if scene.water.sea && land.lie.range_m[0] < land.lie.sea_m {
                pass.set_pipeline(&set.sea);
                self.sea.draw(&mut pass, around);
            }
        }
        if frame.bloom[2] > 0.0 {
            self.glow.run(gpu, &mut encoder, &targets.light, &targets.copies, [frame.bloom[0], frame.bloom[1]]);
        }
        let (light, glow) = (view(&targets.light), view(targets.copies.sum()));
        let tone_group =
            gpu.group(&self.tone_layout, vec![BindingResource::TextureView(&light), BindingResource::TextureView(&glow)]);
        let picture = view(&targets.picture);
        {
            let attachment = wgpu::RenderPassColorAttachment {
                view: &picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("tone"),
                color_attachments: &[Some(attachment)],
                ..Default::default()
            });
            pass.set_pipeline(&self.tone);
            pass.set_bind_group(0, &frame_group, &[]);
            pass.set_bind_group(1, &tone_group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue.submit([encoder.finish()]);
    }

    fn begin<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, targets: &Targets) -> wgpu::RenderPass<'a> {
        let (light, depth) = (view(&targets.light), view(&targets.depth));
        let many = targets.many.as_ref().map(view);
        let attachment = wgpu::RenderPassColorAttachment {
            view: many.as_ref().unwrap_or(&light),
            depth_slice: None,
            resolve_target: many.as_ref().map(|_| &light),
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(attachment)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }
}

impl Set {
    fn new(gpu: &Gpu, samples: u32, [frame, ground, covers]: [&BindGroupLayout; 3]) -> Self {
        let attribute = |location, offset, format| wgpu::VertexAttribute { format, offset, shader_location: location };
        let patches = [attribute(0, 0, VertexFormat::Float32x4), attribute(1, 16, VertexFormat::Float32x4)];
        let patches = wgpu::VertexBufferLayout {
            array_stride: size_of::<Patch>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &patches,
        };
        let walls = [attribute(0, 0, VertexFormat::Float32x4)];
        let walls = wgpu::VertexBufferLayout {
            array_stride: 16,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &walls,
        };
        let corners = [attribute(0, 0, VertexFormat::Float32x2), attribute(1, 8, VertexFormat::Float32)];
        let corners = wgpu::VertexBufferLayout {
            array_stride: 12,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &corners,
        };
        let opaque = |shaders, groups: &[&BindGroupLayout], vertices: &[Option<wgpu::VertexBufferLayout>], strip| {
            gpu.pipeline(&Pass { shaders, groups, vertices, strip, depth: Some(true), samples, ..Pass::default() })
        };
        let over = Some(wgpu::BlendState::ALPHA_BLENDING);
        Self {
            ground: opaque(["ground_vertex", "ground"], &[frame, ground, covers], &[Some(patches)], false),
            side: opaque(["side_vertex", "side"], &[frame, ground], &[Some(walls)], true),
            backdrop: gpu.pipeline(&Pass {
                shaders: ["cover", "backdrop"],
                groups: &[frame],
                depth: Some(false),
                samples,
                ..Pass::default()
            }),
            sea: gpu.pipeline(&Pass {
                shaders: ["sea_vertex", "sea"],
                groups: &[frame, ground],
                vertices: &[Some(corners)],
                blend: over,
                depth: Some(true),
                samples,
                ..Pass::default()
            }),
        }
    }
}
