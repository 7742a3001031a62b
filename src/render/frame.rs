//! What all passes of a picture are told: camera, light, air, looks. Twin of `Frame` in `shaders/lib/frame.wgsl`.

use glam::DVec3;

use super::{
    air::{Air, SUN, SkyTable},
    camera::Camera,
    fire::{HEATS, heats},
    glow::LEVELS,
    ground::Lie,
};
use crate::scene::{GroundStyle, Quality, SceneParams, SunParams, WaterLook};

/// The uniform; fields and their meaning as in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Frame {
    /// See the shader.
    pub view_projection: [[f32; 4]; 4],
    /// See the shader.
    pub from_picture: [[f32; 4]; 4],
    /// See the shader; so for all below.
    pub eye: [f32; 4],
    pub toward: [f32; 4],
    pub light: [f32; 4],
    pub sun: [f32; 4],
    pub moon: [f32; 4],
    pub ambient: [f32; 4],
    pub map: [f32; 4],
    pub haze: [f32; 4],
    pub air: [f32; 4],
    pub picture: [f32; 4],
    pub cover: [f32; 4],
    pub cover2: [f32; 4],
    pub bands: [f32; 4],
    pub water: [f32; 4],
    pub dark: [f32; 4],
    pub shallow: [f32; 4],
    pub bloom: [f32; 4],
    pub rays: [f32; 4],
    pub inland: [f32; 4],
    pub lava: [f32; 4],
    pub heat: [[f32; 4]; HEATS],
}

/// Irradiance of full moonlight in the units of the sun: far more than nature's four millionths, as a long exposure has it.
const MOON: f64 = 0.02;
/// Brightness of a night sky without a moon.
const AIRGLOW: f64 = 0.0014;
/// Exposure that shows a sunlit lawn as the eye does.
const EXPOSURE: f64 = 0.64;

/// Light of the white of a picture of the sky.
const WHITE: f64 = 3.0;

/// What shines, at a moment of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lights {
    /// Toward the sun, wherever it is.
    pub sun: DVec3,
    /// Toward the moon.
    pub moon: DVec3,
    /// 0 night, 1 day: civil twilight between.
    pub day: f64,
}

impl Lights {
    /// The lights at a share of a film, 0 to 1.
    pub fn at(sun: &SunParams, share: f64) -> Self {
        let to = sun.to_time_of_day_h.unwrap_or(sun.time_of_day_h);
        let hour = sun.time_of_day_h + (to - sun.time_of_day_h) * share;
        let by_time = by_time(hour, sun.latitude_deg, sun.declination_deg);
        let azimuth = sun.azimuth_deg.map_or_else(|| libm::atan2(by_time.x, by_time.y), f64::to_radians);
        let altitude = sun.altitude_deg.map_or_else(|| libm::asin(by_time.z.clamp(-1.0, 1.0)), f64::to_radians);
        let sun = toward(azimuth, altitude);
        // A full moon stands where the sun will be in half a day; at least as high as light needs.
        let opposite = toward(azimuth + std::f64::consts::PI + 0.5, (-altitude).clamp(0.45, 1.0));
        let twilight = libm::sin(6.0f64.to_radians());
        Self { sun, moon: opposite, day: crate::noise::smoothstep((sun.z + twilight) / (2.0 * twilight)) }
    }
}

fn toward(azimuth: f64, altitude: f64) -> DVec3 {
    let flat = libm::cos(altitude);
    DVec3::new(libm::sin(azimuth) * flat, libm::cos(azimuth) * flat, libm::sin(altitude))
}

/// Toward the sun by solar time: its circle around the pole.
fn by_time(hour: f64, latitude_deg: f64, declination_deg: f64) -> DVec3 {
    let turn = (hour - 12.0) * std::f64::consts::PI / 12.0;
    let (latitude, declination) = (latitude_deg.to_radians(), declination_deg.to_radians());
    let (sin_l, cos_l) = (libm::sin(latitude), libm::cos(latitude));
    let (sin_d, cos_d) = (libm::sin(declination), libm::cos(declination));
    DVec3::new(
        -cos_d * libm::sin(turn),
        sin_d * cos_l - cos_d * sin_l * libm::cos(turn),
        sin_d * sin_l + cos_d * cos_l * libm::cos(turn),
    )
}

/// The sky over a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// Its table.
    pub table: SkyTable,
    /// Toward what shines brightest, and its light on a face turned to it.
    pub toward: DVec3,
    /// That light.
    pub light: [f32; 3],
}

impl Sky {
    /// The sky of sun and moon.
    pub fn new(air: &Air, lights: &Lights, night: f64, picture: Option<&image::RgbImage>) -> Self {
        let (sun, moon) = (lights.sun.to_array(), lights.moon.to_array());
        let moonlight = MOON * night * (1.0 - lights.day);
        let mut table = match picture {
            Some(picture) => SkyTable::picture(picture, (WHITE * lights.day.max(0.01)) as f32),
            None => SkyTable::new(air, &[(sun, SUN), (moon, moonlight * SUN * 0.6)]),
        };
        let glow = [0.55, 0.75, 1.0].map(|c| (c * AIRGLOW * night * (1.0 - lights.day)) as f32);
        let add = |pixel: &mut [f32; 3], by: f32| (0..3).for_each(|c| pixel[c] += glow[c] * by);
        table.light.iter_mut().for_each(|pixel| add(pixel, 1.0));
        add(&mut table.ambient, std::f32::consts::PI);
        let direct = air.sunlight(sun);
        let moonlit = air.sunlight(moon).map(|v| v * moonlight);
        let by_sun = direct.iter().sum::<f64>() >= moonlit.iter().sum::<f64>();
        let (toward, light) = if by_sun { (lights.sun, direct) } else { (lights.moon, moonlit) };
        Self { table, toward, light: light.map(|v| v as f32) }
    }
}

/// A picture: its size, and its moment in a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Share of the film that is over.
    pub share: f64,
    /// Seconds since it began.
    pub seconds: f64,
    /// How carefully it is drawn.
    pub quality: Quality,
}

/// Linear red, green, blue of "#rrggbb"; black for what is none.
pub(super) fn colour(text: &str) -> [f32; 3] {
    let code = u32::from_str_radix(text.trim_start_matches('#'), 16).unwrap_or(0);
    [16, 8, 0].map(|shift| {
        let v = f64::from((code >> shift) & 255) / 255.0;
        (if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }) as f32
    })
}

fn with([a, b, c]: [f32; 3], d: f64) -> [f32; 4] {
    [a, b, c, d as f32]
}

fn vec(v: DVec3, d: f64) -> [f32; 4] {
    with(v.as_vec3().to_array(), d)
}

impl Frame {
    /// All of it.
    pub fn new(scene: &SceneParams, camera: &Camera, lights: &Lights, sky: &Sky, lie: &Lie, moment: &Moment) -> Self {
        let [width, height] = moment.size.map(f64::from);
        let matrix = camera.view_projection(width / height);
        let pixel = 1.0 / camera.pixels_per_radian(height);
        let sides = lie.extent_m[0].max(lie.extent_m[1]);
        let per_m = 3.0 / (scene.fog.visibility * sides);
        let relief = lie.relief_m() * lie.exaggeration;
        let cosine = |deg: f64| libm::cos(deg.to_radians());
        let shadow = if scene.shadow.on { scene.shadow.strength } else { 0.0 };
        let style = match scene.ground.style {
            GroundStyle::Natural => 0.0,
            GroundStyle::Bands => 1.0,
            GroundStyle::Map => 2.0,
        };
        let quality = match moment.quality {
            Quality::Draft => 0.0,
            Quality::Normal => 1.0,
            Quality::Full => 2.0,
        };
        let look = match scene.water.look {
            WaterLook::Natural => 0.0,
            WaterLook::Rim => 1.0,
            WaterLook::Cellular => 2.0,
        };
        let sea_m = lie.sea_m * lie.exaggeration;
        let snow_m = scene.ground.snow_line_m.unwrap_or(2800.0 + lie.sea_m);
        // The eye gets used to the dark, but not wholly.
        let night_stops = 3.0 * (1.0 - lights.day);
        let rays = scene.fog.on && scene.fog.shafts && moment.quality == Quality::Full;
        let shafts = if rays { scene.fog.shaft_strength } else { 0.0 };
        let exposure = EXPOSURE * libm::exp2(scene.sky.exposure + night_stops);
        let bloom = if scene.bloom.on && moment.quality != Quality::Draft { scene.bloom.strength } else { 0.0 };
        Self {
            view_projection: matrix.as_mat4().to_cols_array_2d(),
            from_picture: matrix.inverse().as_mat4().to_cols_array_2d(),
            eye: vec(camera.eye(), pixel),
            toward: vec(sky.toward, libm::tan(0.5 * scene.sun.disc_deg.to_radians())),
            light: with(sky.light, shadow),
            sun: vec(lights.sun, lights.day),
            moon: vec(lights.moon, scene.sky.night),
            ambient: with(sky.table.ambient, scene.shadow.occlusion),
            map: [lie.extent_m[0], lie.extent_m[1], sea_m, lie.exaggeration].map(|v| v as f32),
            haze: with([0.75, 0.95, 1.35].map(|c| (c * per_m) as f32), scene.fog.height * relief.max(1.0)),
            air: [scene.fog.sun_tint, f64::from(u8::from(scene.fog.on)), lie.floor_m(), lie.cell_m].map(|v| v as f32),
            picture: [width, height, exposure, moment.seconds].map(|v| v as f32),
            cover: [
                scene.ground.sand_m * lie.exaggeration,
                cosine(scene.ground.rock_deg[0]),
                cosine(scene.ground.rock_deg[1]),
                scene.ground.relief,
            ]
            .map(|v| v as f32),
            cover2: [cosine(scene.ground.snow_deg[0]), cosine(scene.ground.snow_deg[1]), style, quality]
                .map(|v| v as f32),
            bands: [
                0.65 * (snow_m - lie.sea_m),
                snow_m - lie.sea_m,
                0.08 * (snow_m - lie.sea_m).abs(),
                0.04 * lie.relief_m(),
            ]
            .map(|v| (v * lie.exaggeration) as f32),
            water: [
                scene.water.clarity_m.unwrap_or(lie.clarity_m()) * lie.exaggeration,
                scene.water.waves,
                scene.water.wave_m.unwrap_or(lie.wave_m()),
                scene.water.foam,
            ]
            .map(|v| v as f32),
            dark: with(colour(&scene.water.dark), look),
            shallow: with(colour(&scene.water.light), f64::from(scene.water.octaves)),
            // Brightness is of the picture: what is white at the exposure.
            rays: [shafts, f64::from(u8::from(scene.sky.glare)) * lights.day, 0.0, 0.0].map(|v| v as f32),
            bloom: [scene.bloom.threshold / exposure, 0.5 * scene.bloom.threshold / exposure, bloom, LEVELS as f64]
                .map(|v| v as f32),
            inland: [
                f64::from(u8::from(scene.water.reflections && moment.quality == Quality::Full)),
                scene.water.scale,
                f64::from(u8::from(scene.water.inland)),
                lie.river_reach_m(),
            ]
            .map(|v| v as f32),
            lava: [scene.lava.crust as f32, f32::from(u8::from(scene.lava.on)), 0.0, 0.0],
            heat: heats(&scene.lava, lights.day),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_goes_its_way() {
        let at = |hour: f64| by_time(hour, 40.0, 0.0);
        assert!(at(6.0).z.abs() < 1e-12 && at(6.0).x > 0.99);
        assert!((at(12.0).z - libm::sin(50f64.to_radians())).abs() < 1e-12 && at(12.0).y < 0.0);
        assert!(at(18.0).x < -0.99 && at(0.0).z < 0.0);
        // Period a day.
        assert!((by_time(5.3, 52.0, 20.0) - by_time(29.3, 52.0, 20.0)).length() < 1e-12);
    }

    #[test]
    fn day_and_night_meet_without_a_step() {
        let sun = SunParams { time_of_day_h: 0.0, to_time_of_day_h: Some(24.0), ..SunParams::default() };
        let day = |share: f64| Lights::at(&sun, share).day;
        assert_eq!((day(0.0), day(0.5)), (0.0, 1.0));
        assert!((0..2400).all(|k| (day(f64::from(k) / 2400.0) - day(f64::from(k + 1) / 2400.0)).abs() < 0.03));
    }

    #[test]
    fn colours_are_linear() {
        assert_eq!(colour("#ffffff"), [1.0; 3]);
        assert!((colour("#808080")[0] - 0.2158605).abs() < 1e-6);
    }
}
