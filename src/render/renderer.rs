//! One renderer for files, films and windows: it owns pipelines and textures, takes a world's rasters once and draws
//! any number of pictures of them.

use std::collections::BTreeMap;

use image::RgbImage;
use wgpu::{AddressMode, BindGroup, BindGroupLayout, BindingResource, RenderPipeline, Texture, TextureFormat};

use super::{
    Gpu, RenderError,
    air::Air,
    camera::Camera,
    drape::DRAPED,
    frame::{Frame, Lights, Moment, Sky},
    glow::{Copies, Glow},
    land::{GROUND, Land},
    lumps::{self, Felt, Lumps},
    passes::{DEPTH, LIGHT, Pass, Slot, Whole, view},
    sea::Sea,
    set::{Kind, Set},
    shafts::{Halves, Shafts},
    smoke::{self, Smoke},
    terrain::{self, Patch, Seen},
    textures::textures,
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
    cover_layout: BindGroupLayout,
    frame_layout: BindGroupLayout,
    tone_layout: BindGroupLayout,
    covers: BindGroup,
    samplers: [wgpu::Sampler; 3],
    /// The picture's pipelines, made when they are first needed.
    sets: BTreeMap<Kind, Set>,
    tone: RenderPipeline,
    glow: Glow,
    lumps: Lumps,
    smoke: Smoke,
    shafts: Shafts,
    indices: wgpu::Buffer,
    index_count: u32,
    sea: Sea,
    air: Option<(f64, Air)>,
    sky: Option<SkyTexture>,
    targets: Option<Targets>,
}

struct SkyTexture {
    lights: Lights,
    told: [f64; 2],
    picture: Option<String>,
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
    felt: Option<Felt>,
    halves: Halves,
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
            felt: None,
            halves: Halves::new(gpu, size),
        }
    }
}

impl Renderer {
    /// Makes all pipelines.
    pub fn new(gpu: Gpu) -> Result<Self, RenderError> {
        gpu.checked(|| Ok(()))?;
        let frame_layout = gpu.layout(&[Slot::Uniform, Slot::Filtered, Slot::Sampler, Slot::Sampler, Slot::Sampler]);
        let ground_layout = gpu.layout(&GROUND);
        let cover_layout = gpu.layout(&[Slot::Layers]);
        let tone_layout = gpu.layout(&[Slot::Numbers, Slot::Filtered, Slot::Numbers, Slot::Numbers]);
        let tone = gpu.pipeline(&Pass {
            shaders: ["cover", "tone"],
            groups: &[&frame_layout, &tone_layout],
            format: PICTURE,
            ..Pass::default()
        });
        let textures = textures(&gpu).create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let covers = gpu.group(&cover_layout, vec![BindingResource::TextureView(&textures)]);
        let indices = terrain::indices();
        let (clamp, repeat) = (AddressMode::ClampToEdge, AddressMode::Repeat);
        Ok(Self {
            samplers: [gpu.sampler(clamp, clamp), gpu.sampler(repeat, repeat), gpu.sampler(repeat, clamp)],
            sets: BTreeMap::new(),
            tone,
            glow: Glow::new(&gpu),
            lumps: Lumps::new(&gpu, [&frame_layout, &ground_layout]),
            smoke: Smoke::new(&gpu, [&frame_layout, &ground_layout]),
            shafts: Shafts::new(&gpu, &frame_layout, &ground_layout),
            indices: gpu.buffer("lattice", &indices, wgpu::BufferUsages::INDEX),
            index_count: indices.len() as u32,
            sea: Sea::new(&gpu),
            covers,
            ground_layout,
            cover_layout,
            frame_layout,
            tone_layout,
            air: None,
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
    pub fn draw(
        &mut self,
        land: &mut Land,
        scene: &SceneParams,
        camera: &Camera,
        moment: &Moment,
    ) -> Result<&Texture, RenderError> {
        let [width, height] = moment.size;
        let most = self.gpu.device.limits().max_texture_dimension_2d.min(MOST_PX);
        if width == 0 || height == 0 || width.max(height) > most {
            return Err(RenderError::PictureSize { width, height, most });
        }
        let kind = Kind { quality: moment.quality as usize, fire: land.burns(), rivers: land.rivers };
        let samples = kind.samples();
        if self.targets.as_ref().is_none_or(|t| t.size != moment.size || t.samples != samples) {
            self.targets = None;
            self.targets = Some(self.gpu.checked(|| Ok(Targets::new(&self.gpu, moment.size, samples)))?);
        }
        let felt = scene.lava.on && !scene.lava.spheres && land.lumps().is_some_and(|lumps| !lumps.is_empty());
        if let Some(targets) = &mut self.targets {
            targets.felt = match targets.felt.take() {
                None if felt => Some(self.gpu.checked(|| Ok(Felt::new(&self.gpu, moment.size)))?),
                there => there.filter(|_| felt),
            };
        }
        self.look_up(scene, moment)?;
        if !self.sets.contains_key(&kind) {
            let layouts = [&self.frame_layout, &self.ground_layout, &self.cover_layout];
            let set = self.gpu.checked(|| Ok(Set::new(&self.gpu, kind, layouts)))?;
            self.sets.insert(kind, set);
        }
        let every = if moment.quality == Quality::Draft { 2 } else { 1 };
        let look = smoke::Look { density: scene.smoke.density, every };
        let puffs = match &self.sky {
            Some(sky) if scene.smoke.on => {
                land.plumes.corners(moment.seconds, look, &land.lie, camera.eye(), sky.sky.toward)
            }
            _ => Vec::new(),
        };
        if !puffs.is_empty() {
            self.smoke.prepare(&self.gpu);
        }
        let (Some(sky), Some(targets), Some(set)) = (&self.sky, &self.targets, self.sets.get(&kind)) else {
            return Err(self.gpu.failed("its targets are gone"));
        };
        self.gpu.checked(|| {
            land.light_from(&self.gpu, sky.sky.toward);
            land.shine(&self.gpu);
            let mut frame = Frame::new(scene, camera, &sky.lights, &sky.sky, &land.lie, moment);
            frame.lava[2] = f32::from(u8::from(land.lumps().is_some()));
            if land.draped {
                frame.cover2[2] = DRAPED;
            }
            self.encode(land, scene, camera, moment, &frame, (sky, targets, set, &puffs));
            Ok(())
        })?;
        Ok(&targets.picture)
    }

    /// The picture as a file has it.
    pub fn picture(
        &mut self,
        land: &mut Land,
        scene: &SceneParams,
        camera: &Camera,
        moment: &Moment,
    ) -> Result<RgbImage, RenderError> {
        let texture = self.draw(land, scene, camera, moment)?.clone();
        let pixels = self.gpu.read_pixels(&texture)?;
        let rgb = pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        RgbImage::from_raw(moment.size[0], moment.size[1], rgb)
            .ok_or_else(|| self.gpu.failed("half a picture came back"))
    }

    /// The sky of the moment, made anew where it has changed.
    fn look_up(&mut self, scene: &SceneParams, moment: &Moment) -> Result<(), RenderError> {
        let lights = Lights::at(&scene.sun, moment.share);
        let told = [scene.sky.dust, scene.sky.night];
        let picture = &scene.sky.picture;
        if self.sky.as_ref().is_some_and(|sky| sky.lights == lights && sky.told == told && sky.picture == *picture) {
            return Ok(());
        }
        if self.air.as_ref().is_none_or(|(dust, _)| *dust != told[0]) {
            self.air = Some((told[0], Air::new(told[0])));
        }
        let Some((_, air)) = &self.air else { return Ok(()) };
        let image = picture.as_ref().map(|file| open_sky(file)).transpose()?;
        let sky = Sky::new(air, &lights, told[1], image.as_ref());
        let pixels: Vec<[half::f16; 4]> =
            sky.table.light.iter().map(|p| [p[0], p[1], p[2], 1.0].map(half::f16::from_f32)).collect();
        let texture = self.gpu.raster("sky", LIGHT, &[(sky.table.size, pixels)]);
        self.sky = Some(SkyTexture { lights, told, picture: picture.clone(), sky, texture });
        Ok(())
    }

    fn encode(
        &self,
        land: &Land,
        scene: &SceneParams,
        camera: &Camera,
        moment: &Moment,
        frame: &Frame,
        (sky, targets, set, puffs): (&SkyTexture, &Targets, &Set, &[smoke::Corner]),
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
                Quality::Draft => 16.0,
                Quality::Normal => 9.0,
                Quality::Full => 8.0,
            },
        };
        let patches = land.tree.select(&seen);
        let patch_buffer = gpu.buffer("patches", &patches, wgpu::BufferUsages::VERTEX);
        let wet: Vec<Patch> = patches
            .iter()
            .filter(|patch| land.inland.as_ref().is_some_and(|inland| inland.touches(patch)))
            .copied()
            .collect();
        let wet_count = wet.len() as u32;
        let wet_buffer = (wet_count > 0).then(|| gpu.buffer("wet patches", &wet, wgpu::BufferUsages::VERTEX));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let around = match scene.surround {
            Surround::Auto => land.lie.rim_at_sea,
            Surround::Sea => true,
            Surround::Block => false,
        };
        let many = targets.samples > 1;
        let smoke =
            (!puffs.is_empty()).then(|| (gpu.buffer("smoke", puffs, wgpu::BufferUsages::VERTEX), puffs.len() as u32));
        let lumps = land.lumps().filter(|_| scene.lava.on).unwrap_or_default();
        let corners = lumps::corners(lumps, &land.lie, !scene.lava.spheres);
        let shown = self.lumps.make(gpu, &mut encoder, &frame_group, targets.felt.as_ref(), &corners, &seen.matrix);
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
            if let Some(shown) = &shown {
                self.lumps.draw(&mut pass, shown, many);
            }
            if scene.water.sea && land.lie.range_m[0] < land.lie.sea_m {
                pass.set_pipeline(&set.sea);
                self.sea.draw(&mut pass, around);
                if !around {
                    pass.set_pipeline(&set.sea_side);
                    pass.set_vertex_buffer(0, land.walls.slice(..));
                    pass.draw(0..land.wall_corners, 0..1);
                }
            }
            if let Some(wet) = &wet_buffer {
                pass.set_pipeline(&set.lake);
                pass.set_vertex_buffer(0, wet.slice(..));
                pass.draw_indexed(0..self.index_count, 0, 0..wet_count);
            }
            if let Some((buffer, count)) = &smoke {
                self.smoke.draw(&mut pass, (buffer, *count), many);
            }
        }
        if frame.bloom[2] > 0.0 {
            self.glow.run(gpu, &mut encoder, &targets.light, &targets.copies, [frame.bloom[0], frame.bloom[1]]);
        }
        if frame.rays[0] > 0.0 {
            self.shafts.run(gpu, &mut encoder, [&frame_group, &land.group], &targets.depth, &targets.halves);
        }
        let views = [&targets.light, targets.copies.sum(), targets.halves.light(), targets.halves.distance()].map(view);
        let tone_group = gpu.group(&self.tone_layout, views.iter().map(BindingResource::TextureView).collect());
        Whole { encoder: &mut encoder }.draw(&self.tone, &[&frame_group, &tone_group], &targets.picture, false);
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

/// A picture of the sky.
fn open_sky(file: &str) -> Result<RgbImage, RenderError> {
    let picture = crate::world::open_picture(std::path::Path::new(file));
    Ok(picture.map_err(|e| RenderError::Picture(e.to_string()))?.to_rgb8())
}
