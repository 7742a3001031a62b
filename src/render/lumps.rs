//! Lava as particles: one surface over all of them, or lumps of their own.
//!
//! The surface is made in the picture's own space (van der Laan 2009): spheres are drawn as distances from the eye, those are blurred
//! where they belong together, and what that gives is lit like ground.

use wgpu::{BindGroupLayout, BindingResource, RenderPipeline, Texture, TextureFormat, VertexFormat};

use glam::{DMat4, DVec2, DVec4};

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

/// Particles that are to be seen: on the adapter, with their surface if that is asked for, the part of the picture that it takes, and
/// the picture's size.
pub(super) struct Shown {
    particles: wgpu::Buffer,
    count: u32,
    surface: Option<(wgpu::BindGroup, [u32; 4], [u32; 2])>,
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
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
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

    /// Brings the particles and makes their surface where there is something to make it in; before the picture. `None` if none is to be
    /// seen.
    pub fn make(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        felt: Option<&Felt>,
        corners: &[Corner],
        matrix: &DMat4,
    ) -> Option<Shown> {
        let size = felt.map_or([u32::MAX; 2], |felt| [felt.depth.width(), felt.depth.height()]);
        let part = outline(corners, matrix, size)?;
        let (particles, count) = (gpu.buffer("lava", corners, wgpu::BufferUsages::VERTEX), corners.len() as u32);
        let Some(felt) = felt else { return Some(Shown { particles, count, surface: None }) };
        let radius_m = corners.iter().map(|c| c[3]).sum::<f32>() / count as f32;
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
            pass.set_scissor_rect(part[0], part[1], part[2], part[3]);
            pass.set_pipeline(&self.smooth);
            pass.set_bind_group(0, frame, &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        let surface = gpu.group(&self.surface_layout, vec![BindingResource::TextureView(&views[0])]);
        Some(Shown { particles, count, surface: Some((surface, part, size)) })
    }

    /// Draws them into the picture; the frame's and the ground's groups are set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, shown: &Shown, many: bool) {
        if let Some((surface, part, size)) = &shown.surface {
            pass.set_scissor_rect(part[0], part[1], part[2], part[3]);
            pass.set_pipeline(&self.surfaces[usize::from(many)]);
            pass.set_bind_group(2, surface, &[]);
            pass.draw(0..3, 0..1);
            pass.set_scissor_rect(0, 0, size[0], size[1]);
        } else {
            pass.set_pipeline(&self.balls[usize::from(many)]);
            pass.set_vertex_buffer(0, shown.particles.slice(..));
            pass.draw(0..6, 0..shown.count);
        }
    }
}

/// The part of a picture in which particles are seen: left, top, width, height, px; `None` where none is.
fn outline(corners: &[Corner], matrix: &DMat4, size: [u32; 2]) -> Option<[u32; 4]> {
    let [width, height] = size.map(f64::from);
    let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
    for &[x, y, z, radius, ..] in corners {
        let seen = *matrix * DVec4::new(x.into(), y.into(), z.into(), 1.0);
        // A sphere of that radius is no wider than this, with some to spare at the picture's corners.
        let wide =
            2.0 * f64::from(radius) * DVec2::new(matrix.row(0).truncate().length(), matrix.row(1).truncate().length());
        if seen.w < -f64::from(radius) {
            continue;
        }
        if seen.w < 4.0 * f64::from(radius) {
            return Some([0, 0, size[0], size[1]]);
        }
        let (at, wide) = (DVec2::new(seen.x, seen.y) / seen.w, wide / seen.w);
        low = low.min(at - wide);
        high = high.max(at + wide);
    }
    let pixel = |v: DVec2| DVec2::new((v.x * 0.5 + 0.5) * width, (v.y * 0.5 + 0.5) * height);
    let (low, high) = (pixel(low).max(DVec2::ZERO), pixel(high).min(DVec2::new(width, height)));
    let (left, right) = (low.x.floor(), high.x.ceil());
    let (top, bottom) = (height - high.y.ceil(), height - low.y.floor());
    (left < right && top < bottom).then(|| [left, top, right - left, bottom - top].map(|v| v as u32))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Camera;
    use glam::DVec3;

    fn matrix() -> DMat4 {
        let target = DVec3::ZERO;
        Camera { target, from_deg: 180.0, down_deg: 20.0, distance_m: 100.0, view_deg: 40.0 }.view_projection(2.0)
    }

    #[test]
    fn the_outline_holds_every_sphere() {
        let corner = |x: f32, y: f32, z: f32| [x, y, z, 2.0, 1000.0, 0.0];
        let all = [corner(-10.0, 0.0, 0.0), corner(20.0, 5.0, 3.0), corner(0.0, -30.0, -4.0)];
        let [left, top, width, height] = outline(&all, &matrix(), [400, 200]).unwrap();
        assert!(width < 400 && height < 200);
        for [x, y, z, r, ..] in all {
            for k in 0..100 {
                let (a, b) = (f64::from(k) * 0.7, (f64::from(k) / 50.0 - 1.0).asin());
                let off = DVec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin()) * f64::from(r);
                let seen = matrix().project_point3(DVec3::new(x.into(), y.into(), z.into()) + off);
                let at = [(seen.x * 0.5 + 0.5) * 400.0, (0.5 - seen.y * 0.5) * 200.0];
                let inside = |v: f64, low: u32, long: u32| v >= f64::from(low) && v <= f64::from(low + long);
                assert!(inside(at[0], left, width) && inside(at[1], top, height), "{at:?}");
            }
        }
        // Behind the eye, beside the picture, around the eye.
        assert_eq!(outline(&[corner(0.0, -300.0, 0.0)], &matrix(), [400, 200]), None);
        assert_eq!(outline(&[corner(900.0, 0.0, 0.0)], &matrix(), [400, 200]), None);
        assert_eq!(outline(&[corner(0.0, -92.0, 34.0)], &matrix(), [400, 200]), Some([0, 0, 400, 200]));
        assert_eq!(outline(&[], &matrix(), [400, 200]), None);
    }
}
