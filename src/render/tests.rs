//! What the shaders mean, on the adapter: parts of the library in passes of their own, and whole pictures.

use glam::DVec3;
use wgpu::{BindingResource, TextureFormat};

use super::{
    air::Air,
    frame::{Frame, Lights, Moment, Sky},
    ground::Lie,
    passes::{LIGHT, Slot, Whole, view},
    shader::expanded,
    *,
};
use crate::{
    grid::{Edges, Field, Grid},
    scene::{Quality, SceneParams},
    world::{Layer, World},
};

/// An adapter, or nothing and a line about it where one may be missing.
fn adapter() -> Option<Gpu> {
    match Gpu::open() {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("UPTHRUST_TESTS_NEED_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

const LIE: Lie = Lie {
    extent_m: [10_000.0; 2],
    cell_m: 10.0,
    sea_m: 0.0,
    range_m: [-100.0, 2000.0],
    exaggeration: 1.0,
    rim_at_sea: false,
};

const CAMERA: Camera =
    Camera { target: DVec3::ZERO, from_deg: 180.0, down_deg: 30.0, distance_m: 9000.0, view_deg: 40.0 };

fn moment(size: [u32; 2], quality: Quality) -> Moment {
    Moment { size, share: 0.0, seconds: 0.0, quality }
}

/// What a fragment of this text, with its imports, gives for each pixel; it may read the frame and the sky of a scene.
fn probe(gpu: &Gpu, scene: &SceneParams, text: &'static str, size: [u32; 2]) -> Vec<[f32; 4]> {
    let layout = gpu.layout(&[Slot::Uniform, Slot::Filtered, Slot::Sampler, Slot::Sampler, Slot::Sampler]);
    let [cover, fragment] = [gpu.shader("cover"), gpu.compile("probe", expanded(text))];
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        ..Default::default()
    });
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        vertex: wgpu::VertexState {
            module: &cover,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &fragment,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(TextureFormat::Rgba32Float.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let lights = Lights::at(&scene.sun, 0.0);
    let sky = Sky::new(&Air::new(1.0), &lights, 1.0, None);
    let frame = Frame::new(scene, &CAMERA, &lights, &sky, &LIE, &moment(size, Quality::Full));
    let uniform = gpu.buffer("frame", &[frame], wgpu::BufferUsages::UNIFORM);
    let pixels: Vec<[half::f16; 4]> =
        sky.table.light.iter().map(|p| [p[0], p[1], p[2], 1.0].map(half::f16::from_f32)).collect();
    let sky = view(&gpu.raster("sky", LIGHT, &[(sky.table.size, pixels)]));
    let clamp = gpu.sampler(wgpu::AddressMode::ClampToEdge, wgpu::AddressMode::ClampToEdge);
    let mut resources = vec![uniform.as_entire_binding(), BindingResource::TextureView(&sky)];
    resources.extend([0; 3].map(|_| BindingResource::Sampler(&clamp)));
    let group = gpu.group(&layout, resources);
    let target = gpu.target("probe", size, TextureFormat::Rgba32Float, 1);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    Whole { encoder: &mut encoder }.draw(&pipeline, &[&group], &target, false);
    gpu.queue.submit([encoder.finish()]);
    let bytes = gpu.read_pixels(&target).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Heights across, cosines of the slope down: the four shares add up to one, and none jumps.
#[test]
fn covers_add_up_to_one_and_meet_without_a_step() {
    let Some(gpu) = adapter() else { return };
    const TEXT: &str = "#import lens\n#import splat\n@fragment fn main(in: Whole) -> @location(0) vec4<f32> {\
        let over = in.position.x * 2.0 - 40.0; let snow = smooth_between(2550.0, 3250.0, over);\
        return shares(over, in.position.y / 512.0, snow, 0.3, 0.2); }";
    let mut scene = SceneParams::default();
    for style in [crate::scene::GroundStyle::Natural, crate::scene::GroundStyle::Bands] {
        scene.ground.style = style;
        // So wide that a step of two metres is small in it.
        scene.ground.sand_m = 60.0;
        let size = [2048, 512];
        let shares = probe(&gpu, &scene, TEXT, size);
        let at = |x: usize, y: usize| shares[y * size[0] as usize + x];
        for y in 0..511 {
            for x in 0..2047 {
                let here = at(x, y);
                assert!((here.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{style:?} {x} {y}: {here:?}");
                for next in [at(x + 1, y), at(x, y + 1)] {
                    let apart = here.iter().zip(next).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                    assert!(apart < 0.05, "{style:?} {x} {y}: {here:?} {next:?}");
                }
            }
        }
    }
}

/// In even air what is left of a colour falls by Beer's law, and haze takes the place of what is gone.
#[test]
fn haze_follows_beers_law() {
    let Some(gpu) = adapter() else { return };
    const TEXT: &str = "#import lens\n#import haze\n@fragment fn main(in: Whole) -> @location(0) vec4<f32> {\
        let at = frame.eye.xyz + vec3<f32>(0.6, 0.8, 0.0) * (in.position.x * 100.0);\
        return vec4<f32>(hazed(vec3<f32>(7.0), at) - hazed(vec3<f32>(0.0), at), hazed(vec3<f32>(0.0), at).g); }";
    let mut scene = SceneParams::default();
    // So high that the air is even.
    scene.fog.height = 100.0;
    scene.fog.visibility = 2.0;
    let got = probe(&gpu, &scene, TEXT, [256, 1]);
    let eye = CAMERA.eye().z;
    for (x, seen) in got.iter().enumerate() {
        let distance = (x as f64 + 0.5) * 100.0;
        for (c, by) in [0.75, 0.95, 1.35].into_iter().enumerate() {
            let depth = by * 3.0 / (2.0 * 10_000.0) * distance * libm::exp(-eye / (100.0 * 2000.0));
            let want = 7.0 * libm::exp(-depth);
            assert!((f64::from(seen[c]) - want).abs() < 1e-3 * 7.0, "{distance} {c}: {} {want}", seen[c]);
        }
    }
    let thick: Vec<f32> = got.iter().map(|seen| seen[3]).collect();
    assert!(thick.windows(2).all(|two| two[1] >= two[0]) && thick[255] > 3.0 * thick[20]);
}

/// A world with a ridge from north to south over a plain.
fn ridge() -> World {
    let grid = Grid::new(128, 128, 12_800.0, Edges::Open);
    let mut world = World::new(grid, -500.0);
    let height = Field::from_fn(grid, |x, _| (900.0 - 45.0 * (x as f64 - 63.5).abs()).max(0.0) as f32);
    world.set_layer(Layer::Bedrock, height);
    world
}

fn brightness(picture: &image::RgbImage, x: std::ops::Range<u32>, y: std::ops::Range<u32>) -> f64 {
    let n = f64::from((x.end - x.start) * (y.end - y.start));
    let pixels = x.flat_map(|x| y.clone().map(move |y| (x, y)));
    pixels.map(|(x, y)| picture.get_pixel(x, y).0.iter().map(|&v| f64::from(v)).sum::<f64>()).sum::<f64>() / n
}

#[test]
fn the_side_in_shade_is_darker_and_night_is_darker_than_day() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    let world = ridge();
    let top = Camera { down_deg: 89.0, distance_m: 16_000.0, ..CAMERA };
    for quality in [Quality::Draft, Quality::Normal, Quality::Full] {
        let mut draw = |azimuth: Option<f64>, altitude: f64| {
            let mut scene = SceneParams::default();
            (scene.sun.azimuth_deg, scene.sun.altitude_deg) = (azimuth, Some(altitude));
            let mut land = renderer.land(&world, &scene).unwrap();
            renderer.picture(&mut land, &scene, &top, &moment([128, 128], quality)).unwrap()
        };
        let sides =
            |picture: &image::RgbImage| [brightness(picture, 50..60, 40..90), brightness(picture, 68..78, 40..90)];
        let [west, east] = sides(&draw(Some(270.0), 25.0));
        assert!(west > 1.5 * east, "{quality:?}: {west} {east}");
        let [west, east] = sides(&draw(Some(90.0), 25.0));
        assert!(east > 1.5 * west, "{quality:?}: {west} {east}");
        let (day, night) = (draw(Some(90.0), 50.0), draw(Some(90.0), -40.0));
        // As light, of which a picture's bytes are about the root.
        let whole = |picture: &image::RgbImage| libm::pow(brightness(picture, 0..128, 0..128) / 765.0, 2.2);
        assert!(whole(&day) > 3.0 * whole(&night), "{quality:?}: {} {}", whole(&day), whole(&night));
        assert!(whole(&night) > 1e-3, "a night by moonlight is not black");
    }
}

#[test]
fn pictures_are_the_same_twice() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    let (world, scene) = (ridge(), SceneParams::default());
    let mut land = renderer.land(&world, &scene).unwrap();
    let mut draw = || renderer.picture(&mut land, &scene, &CAMERA, &moment([96, 54], Quality::Full)).unwrap();
    assert_eq!(draw(), draw());
}

#[test]
fn what_cannot_be_drawn_is_refused_in_words() {
    let Some(gpu) = adapter() else { return };
    let mut renderer = Renderer::new(gpu).unwrap();
    let (world, scene) = (ridge(), SceneParams::default());
    let mut land = renderer.land(&world, &scene).unwrap();
    for size in [[0, 100], [100, 0], [1_000_000, 2]] {
        let error = renderer.picture(&mut land, &scene, &CAMERA, &moment(size, Quality::Draft)).unwrap_err();
        assert!(matches!(&error, RenderError::PictureSize { .. }), "{error}");
    }
    let mut broken = ridge();
    broken.layer_mut(Layer::Bedrock).data[300] = f32::NAN;
    let error = renderer.land(&broken, &scene).map(|_| ()).unwrap_err();
    assert_eq!(error.to_string(), "layer 'bedrock' is not finite at cell (44, 2)");
    // Inside the ground there is something to see all the same.
    let inside = Camera { target: DVec3::new(0.0, 0.0, -5000.0), down_deg: -40.0, ..CAMERA };
    renderer.picture(&mut land, &scene, &inside, &moment([32, 32], Quality::Normal)).unwrap();
    let mut missing = scene.clone();
    missing.sky.picture = Some("no/such/sky.png".into());
    let error = renderer.picture(&mut land, &missing, &CAMERA, &moment([32, 32], Quality::Draft)).unwrap_err();
    assert!(error.to_string().contains("no/such/sky.png"), "{error}");
}
