//! Smoke over vents: the puffs of a world's plumes, each a picture that faces the eye, the farthest first.

use glam::DVec3;
use rayon::prelude::*;
use wgpu::{BindGroup, BindGroupLayout, BindingResource, RenderPipeline, VertexFormat};

use super::{
    Gpu,
    ground::Lie,
    passes::{Pass, Slot},
    puff,
};
use crate::world::{Plume, World};

/// Seconds in a year.
const YEAR_S: f64 = 365.25 * 86_400.0;
/// How often a puff's pictures change, in shares of its time to slow down.
const PICTURES: f64 = 3.0;
/// Optical depth of a fresh puff's middle.
const THICK: f64 = 1.6;
/// Corners of the six triangles of an octagon.
const CORNERS: u32 = 18;
/// Most puffs that are asked whether they stand in another's light.
const ASKED: usize = 600;

/// A puff as the shader reads it: place and radius; how thick it is, share of its life that is over, turn, picture; optical depth
/// of the smoke towards the light and up.
pub(super) type Corner = [f32; 10];

/// The plumes of a world and its clock.
pub(super) struct Plumes {
    all: Vec<Plume>,
    time_yr: f64,
}

/// How smoke is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// How much it hides.
    pub density: f64,
    /// One of so many puffs is drawn, as thick as all of them.
    pub every: u64,
}

/// A puff in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ball {
    number: u64,
    at: DVec3,
    radius_m: f64,
    thick: f64,
    spent: f64,
    turn: f64,
    picture: f64,
}

impl Plumes {
    /// Those of a world: who erupts now goes on with it while the world stands still.
    pub fn of(world: &World) -> Self {
        let mut all = world.plumes();
        for plume in all.iter_mut().filter(|plume| plume.erupts(world.time_yr)) {
            plume.end_yr = f64::INFINITY;
        }
        Self { all, time_yr: world.time_yr }
    }

    fn balls(&self, seconds: f64, density: f64, lie: &Lie) -> Vec<Ball> {
        let time_yr = self.time_yr + seconds / YEAR_S;
        // Land that is drawn steeper has wider smoke over it.
        let wider = lie.exaggeration.sqrt();
        let mut out = Vec::new();
        for plume in &self.all {
            let vent = plume.at_m[2];
            out.extend(plume.puffs(time_yr).into_iter().map(|puff| {
                let [x, y, z] = puff.at_m;
                let at = DVec3::new(
                    x - 0.5 * lie.extent_m[0],
                    0.5 * lie.extent_m[1] - y,
                    vent * lie.exaggeration + (z - vent) * wider,
                );
                Ball {
                    number: puff.number,
                    at,
                    radius_m: puff.radius_m * wider,
                    thick: THICK * density * puff.opacity,
                    spent: puff.spent,
                    turn: puff.turn_rad,
                    picture: puff.number as f64 * 2.618 + PICTURES * puff.age_s / plume.slows_s,
                }
            }));
        }
        out.retain(|ball| ball.thick > 1e-3);
        out
    }

    /// The puffs of a moment, the farthest from the eye first, with what stands between them and the light.
    pub fn corners(&self, seconds: f64, look: Look, lie: &Lie, eye: DVec3, light: DVec3) -> Vec<Corner> {
        let mut balls = self.balls(seconds, look.density * look.every as f64, lie);
        balls.retain(|ball| ball.number % look.every == 0);
        balls.sort_by(|a, b| (b.at - eye).length_squared().total_cmp(&(a.at - eye).length_squared()));
        let every = balls.len().div_ceil(ASKED).max(1);
        let asked: Vec<Ball> = balls.iter().step_by(every).copied().collect();
        let corner = |ball: &Ball| {
            let [sun, up] = [light, DVec3::Z].map(|way| every as f64 * depth(ball, &asked, way));
            let Ball { number: _, at, radius_m, thick, spent, turn, picture } = *ball;
            let picture = picture.rem_euclid(puff::LAYERS as f64);
            [at.x, at.y, at.z, radius_m, thick, spent, turn, picture, sun, up].map(|v| v as f32)
        };
        balls.par_iter().map(corner).collect()
    }
}

/// Optical depth of the smoke on the way from a puff's middle: each other one is a soft ball.
fn depth(of: &Ball, all: &[Ball], way: DVec3) -> f64 {
    let one = |other: &Ball| {
        let off = other.at - of.at;
        let along = off.dot(way);
        let r2 = other.radius_m * other.radius_m;
        let beside = (off.length_squared() - along * along).max(0.0) / r2;
        if beside > 2.5 || along <= 0.0 {
            return 0.0;
        }
        // Those that hardly lie in front hide little.
        let before = (along / (0.7 * other.radius_m)).min(1.0);
        other.thick * libm::exp(-2.0 * beside) * before
    };
    all.iter().map(one).sum()
}

/// The pass.
pub(super) struct Smoke {
    layout: BindGroupLayout,
    pipelines: [RenderPipeline; 2],
    /// What a puff looks like; made when the first one is to be seen.
    look: Option<BindGroup>,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 3] = [
    wgpu::VertexAttribute { format: VertexFormat::Float32x4, offset: 0, shader_location: 0 },
    wgpu::VertexAttribute { format: VertexFormat::Float32x4, offset: 16, shader_location: 1 },
    wgpu::VertexAttribute { format: VertexFormat::Float32x2, offset: 32, shader_location: 2 },
];

impl Smoke {
    pub fn new(gpu: &Gpu, [frame, ground]: [&BindGroupLayout; 2]) -> Self {
        let layout = gpu.layout(&[Slot::Layers]);
        let vertices = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &ATTRIBUTES,
        })];
        let pipelines = [1, 4].map(|samples| {
            gpu.pipeline(&Pass {
                shaders: ["smoke_vertex", "smoke"],
                groups: &[frame, ground, &layout],
                vertices: &vertices,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                depth: Some(false),
                samples,
                constants: &[("QUALITY", if samples == 1 { 0.0 } else { 2.0 })],
                ..Pass::default()
            })
        });
        Self { layout, pipelines, look: None }
    }

    /// Makes the look of puffs, once.
    pub fn prepare(&mut self, gpu: &Gpu) {
        if self.look.is_none() {
            let texture = puff::texture(gpu);
            let layers = texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            });
            self.look = Some(gpu.group(&self.layout, vec![BindingResource::TextureView(&layers)]));
        }
    }

    /// Draws puffs; the frame's and the ground's groups are set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, (puffs, count): (&wgpu::Buffer, u32), many: bool) {
        let Some(look) = &self.look else { return };
        pass.set_pipeline(&self.pipelines[usize::from(many)]);
        pass.set_bind_group(2, look, &[]);
        pass.set_vertex_buffer(0, puffs.slice(..));
        pass.draw(0..CORNERS, 0..count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Grid};

    fn world() -> World {
        let mut world = World::new(Grid::new(4, 4, 400.0, Edges::Open), 0.0);
        world.add_plumes(&[Plume {
            at_m: [200.0, 200.0, 50.0],
            along_m: [0.0; 2],
            radius_m: 8.0,
            begin_yr: 0.0,
            end_yr: 60.0 / YEAR_S,
            puffs_per_s: 3.0,
            rise_m_per_s: 8.0,
            slows_s: 15.0,
            swell: 0.2,
            wind_m_per_s: [6.0, 0.0],
            wind_at_m: 100.0,
            lasts_s: 40.0,
            seed: 3.0,
        }]);
        world.time_yr = 50.0 / YEAR_S;
        world
    }

    fn look(density: f64) -> Look {
        Look { density, every: 1 }
    }

    const LIE: Lie = Lie {
        extent_m: [400.0; 2],
        cell_m: 100.0,
        sea_m: 0.0,
        range_m: [0.0, 50.0],
        exaggeration: 1.0,
        rim_at_sea: false,
    };

    #[test]
    fn the_farthest_puff_comes_first_and_moments_are_told_alone() {
        let plumes = Plumes::of(&world());
        let eye = DVec3::new(300.0, -500.0, 80.0);
        let puffs = plumes.corners(0.0, look(1.0), &LIE, eye, DVec3::X);
        let away = |c: &Corner| DVec3::new(c[0].into(), c[1].into(), c[2].into()).distance(eye);
        assert!(puffs.len() > 60 && puffs.windows(2).all(|p| away(&p[0]) >= away(&p[1]) - 1e-3));
        assert_eq!(puffs, plumes.corners(0.0, look(1.0), &LIE, eye, DVec3::X));
        let half = plumes.corners(0.0, Look { density: 1.0, every: 2 }, &LIE, eye, DVec3::X);
        assert!(half.len().abs_diff(puffs.len() / 2) <= 4);
        assert!(plumes.corners(0.0, look(0.0), &LIE, eye, DVec3::X).is_empty());
        // It goes on while the world stands still, and ends where it has ended.
        assert!(plumes.corners(100.0, look(1.0), &LIE, eye, DVec3::X).len() > 60);
        let mut over = world();
        over.time_yr = 200.0 / YEAR_S;
        assert!(Plumes::of(&over).corners(0.0, look(1.0), &LIE, eye, DVec3::X).is_empty());
    }

    #[test]
    fn the_side_away_from_the_light_lies_in_the_shade() {
        let plumes = Plumes::of(&world());
        let puffs = plumes.corners(0.0, look(1.0), &LIE, DVec3::new(0.0, -900.0, 80.0), DVec3::X);
        let middle = puffs.iter().map(|p| p[0]).sum::<f32>() / puffs.len() as f32;
        let mean = |lee: bool| {
            let side: Vec<f32> = puffs.iter().filter(|p| (p[0] < middle) == lee).map(|p| p[8]).collect();
            side.iter().sum::<f32>() / side.len() as f32
        };
        assert!(mean(true) > 1.5 * mean(false), "{} {}", mean(true), mean(false));
        let highest = puffs.iter().max_by(|a, b| a[2].total_cmp(&b[2])).unwrap();
        assert!(highest[9] < 0.2 * puffs.iter().map(|p| p[9]).fold(0.0, f32::max));
    }
}
