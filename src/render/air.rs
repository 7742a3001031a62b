//! The clear sky: light that air (Rayleigh), dust (Mie) and ozone scatter or swallow: the first turn exactly (after
//! Nishita 1993), all further ones together as equal from all sides (after Hillaire 2020). Worked out on the processor into a small table of the whole sky, so that every
//! adapter shows the same sky, and a picture's ambient light is its integral.
//!
//! Lengths in metres, directions with z up, light in units in which the sun above the air gives [`SUN`].

use std::f64::consts::PI;

use rayon::prelude::*;

/// Irradiance of the sun above the air, in units of which the tone curve makes white.
pub const SUN: f64 = 20.0;
/// Radius of the Earth, and of what counts as air around it, m.
const EARTH_M: f64 = 6_371e3;
const AIR_M: f64 = 6_471e3;
/// Scattering at sea level for red, green, blue, 1/m, and the height in which air thins to 1/e, m.
const RAYLEIGH: [f64; 3] = [5.5e-6, 13.0e-6, 22.4e-6];
const RAYLEIGH_M: f64 = 8000.0;
/// The same for dust on a clear day; it swallows a tenth of what it scatters besides.
const MIE: f64 = 4.5e-6;
const MIE_M: f64 = 1200.0;
const SWALLOWED: f64 = 1.1;
/// How much dust scatters forward (Cornette and Shanks' g).
const FORWARD: f64 = 0.76;
/// What ozone swallows in its layer, 1/m, where that is, and half its thickness, m (Bruneton 2017).
const OZONE: [f64; 3] = [0.65e-6, 1.88e-6, 0.085e-6];
const OZONE_AT_M: f64 = 25e3;
const OZONE_HALF_M: f64 = 15e3;
/// Samples along a ray, and from each towards the sun.
const STEPS: usize = 20;
const SUN_STEPS: usize = 40;
/// The eye stands so high, m: for the sky, the map's own heights make no difference.
const EYE_M: f64 = 300.0;
/// What the Earth sends back of the light that reaches it.
const EARTH_ALBEDO: f64 = 0.25;
/// Heights and sun's heights of the two tables, and directions over which the second is a mean.
const OUT_SIZE: [usize; 2] = [32, 96];
const AGAIN_SIZE: [usize; 2] = [12, 32];
const AGAIN_DIRECTIONS: usize = 96;

type Rgb = [f64; 3];

/// Share of light that air scatters by a cosine: integrates to one over the sphere.
pub fn rayleigh_phase(cosine: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cosine * cosine)
}

/// The same for dust.
pub fn mie_phase(cosine: f64) -> f64 {
    let g = FORWARD;
    let bent = 1.0 + g * g - 2.0 * g * cosine;
    3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + cosine * cosine) / ((2.0 + g * g) * bent * bent.sqrt())
}

/// What lies along a way: metres of sea-level air, dust, and full ozone.
type Depth = [f64; 3];

fn densities(height_m: f64) -> Depth {
    let h = height_m.max(0.0);
    [libm::exp(-h / RAYLEIGH_M), libm::exp(-h / MIE_M), (1.0 - (h - OZONE_AT_M).abs() / OZONE_HALF_M).max(0.0)]
}

/// Distances at which a ray from a height enters and leaves a sphere around the Earth's middle, by the cosine of its angle
/// with the vertical.
fn sphere(height_m: f64, up: f64, radius: f64) -> Option<[f64; 2]> {
    let from = EARTH_M + height_m;
    let half = from * up;
    let rest = half * half - from * from + radius * radius;
    (rest >= 0.0).then(|| [-half - rest.sqrt(), -half + rest.sqrt()])
}

/// Where a ray ends: at the Earth (true) or at the end of the air.
fn end(height_m: f64, up: f64) -> (f64, bool) {
    match sphere(height_m, up, EARTH_M) {
        Some([near, _]) if near > 0.0 => (near, true),
        _ => (sphere(height_m, up, AIR_M).map_or(0.0, |[_, far]| far), false),
    }
}

/// Height, and the cosine of the vertical with a direction there, after a way.
fn after(height_m: f64, up: f64, distance: f64) -> f64 {
    let from = EARTH_M + height_m;
    (from * from + distance * distance + 2.0 * from * distance * up).max(0.0).sqrt() - EARTH_M
}

/// A table of colours over two shares, 0 to 1, read between its entries.
#[derive(Clone, Debug, PartialEq)]
struct Grid2 {
    size: [usize; 2],
    values: Vec<Rgb>,
}

impl Grid2 {
    fn new(size: [usize; 2], f: impl Fn(f64, f64) -> Rgb + Sync) -> Self {
        let share = |i: usize, n: usize| i as f64 / (n - 1) as f64;
        let value = |i: usize| f(share(i % size[0], size[0]), share(i / size[0], size[1]));
        Self { size, values: (0..size[0] * size[1]).into_par_iter().map(value).collect() }
    }

    fn at(&self, u: f64, v: f64) -> Rgb {
        let place = |share: f64, n: usize| {
            let at = share.clamp(0.0, 1.0) * (n - 1) as f64;
            let low = (at as usize).min(n - 2);
            (low, at - low as f64)
        };
        let ((x, s), (y, t)) = (place(u, self.size[0]), place(v, self.size[1]));
        let value = |dx: usize, dy: usize| self.values[(y + dy) * self.size[0] + x + dx];
        let [a, b, c, d] = [value(0, 0), value(1, 0), value(0, 1), value(1, 1)];
        [0, 1, 2].map(|k: usize| (a[k] * (1.0 - s) + b[k] * s) * (1.0 - t) + (c[k] * (1.0 - s) + d[k] * s) * t)
    }
}

/// Air of a clarity.
#[derive(Clone, Debug, PartialEq)]
pub struct Air {
    /// Dust, 1 on a clear day.
    dust: f64,
    /// Share of light that gets out of the air, by height and by direction over the horizon.
    out: Grid2,
    /// Light that reaches a place after more than one turn, for a sun of one: by height and by the sun's.
    again: Grid2,
}

/// Cosine of the vertical with the horizon seen from a height.
fn horizon(height_m: f64) -> f64 {
    let share = EARTH_M / (EARTH_M + height_m.max(0.0));
    -(1.0 - share * share).max(0.0).sqrt()
}

fn height_share(height_m: f64) -> f64 {
    (height_m / (AIR_M - EARTH_M)).clamp(0.0, 1.0).sqrt()
}

impl Air {
    /// Works the tables out.
    pub fn new(dust: f64) -> Self {
        let height = |share: f64| share * share * (AIR_M - EARTH_M);
        let out = Grid2::new(OUT_SIZE, |u, v| {
            let (h, low) = (height(u), horizon(height(u)));
            transmitted(dust, depth_out(h, low + v * v * (1.0 - low)))
        });
        let once = Self { dust, out, again: Grid2 { size: [2, 2], values: vec![[0.0; 3]; 4] } };
        let again = Grid2::new(AGAIN_SIZE, |u, v| once.turned_again(height(u), 2.0 * v - 1.0));
        Self { again, ..once }
    }

    /// Share of the sun's light that reaches a height, by the cosine of the sun with the vertical there.
    fn reaches(&self, height_m: f64, up: f64) -> Rgb {
        let low = horizon(height_m);
        if up <= low { [0.0; 3] } else { self.out.at(height_share(height_m), ((up - low) / (1.0 - low)).sqrt()) }
    }

    fn scattered(&self, there: Depth) -> [Rgb; 2] {
        [RAYLEIGH.map(|v| v * there[0]), [MIE * self.dust * there[1]; 3]]
    }

    /// Sunlight that reaches the ground, by the sun's height; fades as its disc sets.
    pub fn sunlight(&self, sun: [f64; 3]) -> Rgb {
        let risen = ((sun[2] + 0.012) / 0.024).clamp(0.0, 1.0);
        // The sun's middle may be just under the horizon.
        let through = self.reaches(EYE_M, sun[2].max(0.002));
        through.map(|share| share * SUN * risen * risen * (3.0 - 2.0 * risen))
    }

    /// Light of the sky from a direction, of a sun of irradiance `strength`.
    pub fn sky(&self, view: [f64; 3], sun: [f64; 3], strength: f64) -> Rgb {
        let cosine = view[0] * sun[0] + view[1] * sun[1] + view[2] * sun[2];
        let phases = [rayleigh_phase(cosine), mie_phase(cosine)];
        let (far, _) = end(EYE_M, view[2]);
        let light = self.march(EYE_M, view[2], far, |distance, height_m| {
            // The vertical leans as the ray goes around the Earth.
            let from = EARTH_M + EYE_M;
            let sun_up = (from * sun[2] + distance * cosine) / (EARTH_M + height_m);
            let direct = self.reaches(height_m, sun_up);
            let again = self.again.at(height_share(height_m), 0.5 + 0.5 * sun_up);
            (direct.map(|v| phases.map(|phase| v * phase)), again)
        });
        light.0.map(|v| v * strength)
    }

    /// Adds up what is scattered along a ray of what `light` says arrives there: directly, for air and for dust, and from all
    /// sides. Gives that, and the share of light from the ray's end.
    fn march(&self, height_m: f64, up: f64, far: f64, light: impl Fn(f64, f64) -> ([[f64; 2]; 3], Rgb)) -> (Rgb, Rgb) {
        let mut sum = [0.0; 3];
        let mut behind: Depth = [0.0; 3];
        let mut at = 0.0;
        for k in 0..STEPS {
            // Longer steps farther away, where less changes.
            let to = far * ((k + 1) as f64 / STEPS as f64).powi(2);
            let step = to - at;
            let distance = at + 0.5 * step;
            at = to;
            let height_m = after(height_m, up, distance);
            let there = densities(height_m);
            let half: Depth = [0, 1, 2].map(|i: usize| behind[i] + 0.5 * there[i] * step);
            (0..3).for_each(|i| behind[i] += there[i] * step);
            let through = transmitted(self.dust, half);
            let [air, dust] = self.scattered(there);
            let (direct, again) = light(distance, height_m);
            for c in 0..3 {
                let turned = air[c] * direct[c][0] + dust[c] * direct[c][1] + (air[c] + dust[c]) * again[c];
                sum[c] += through[c] * turned * step;
            }
        }
        (sum, transmitted(self.dust, behind))
    }

    /// Light of all further turns, taken as equal from all sides: what the second turn brings, and of that in turn the share
    /// that is turned again, and so on (Hillaire 2020).
    fn turned_again(&self, height_m: f64, sun_up: f64) -> Rgb {
        let (mut second, mut share) = ([0.0; 3], [0.0; 3]);
        for k in 0..AGAIN_DIRECTIONS {
            // A spiral that covers the sphere evenly.
            let up = 1.0 - 2.0 * (k as f64 + 0.5) / AGAIN_DIRECTIONS as f64;
            let turn = k as f64 * 2.399_963_229_728_653;
            let side = (1.0 - up * up).sqrt() * libm::cos(turn);
            let cosine = side * (1.0 - sun_up * sun_up).max(0.0).sqrt() + up * sun_up;
            let (far, ground) = end(height_m, up);
            let even = 0.25 / PI;
            let from = EARTH_M + height_m;
            let sun_at = |distance: f64, there_m: f64| (from * sun_up + distance * cosine) / (EARTH_M + there_m);
            let (mut light, through) = self.march(height_m, up, far, |distance, there_m| {
                (self.reaches(there_m, sun_at(distance, there_m)).map(|v| [v * even; 2]), [0.0; 3])
            });
            let (again, _) = self.march(height_m, up, far, |_, _| ([[0.0; 2]; 3], [1.0; 3]));
            if ground {
                let facing = sun_at(far, 0.0).max(0.0);
                let lit = self.reaches(0.0, facing);
                (0..3).for_each(|c| light[c] += through[c] * lit[c] * facing * EARTH_ALBEDO / PI);
            }
            for c in 0..3 {
                second[c] += light[c] / AGAIN_DIRECTIONS as f64;
                share[c] += again[c] / AGAIN_DIRECTIONS as f64;
            }
        }
        [0, 1, 2].map(|c: usize| second[c] / (1.0 - share[c].min(0.95)))
    }
}

fn transmitted(dust: f64, depth: Depth) -> Rgb {
    [0, 1, 2]
        .map(|c: usize| libm::exp(-RAYLEIGH[c] * depth[0] - MIE * dust * SWALLOWED * depth[1] - OZONE[c] * depth[2]))
}

/// What lies between a height and the end of the air; the Earth is not in the way.
fn depth_out(height_m: f64, up: f64) -> Depth {
    let far = sphere(height_m, up, AIR_M).map_or(0.0, |[_, far]| far);
    let mut depth = [0.0; 3];
    let mut at = 0.0;
    for k in 0..SUN_STEPS {
        let to = far * ((k + 1) as f64 / SUN_STEPS as f64).powi(2);
        let there = densities(after(height_m, up, 0.5 * (at + to)));
        (0..3).for_each(|i| depth[i] += there[i] * (to - at));
        at = to;
    }
    depth
}

/// The whole sky as a table: columns are directions of the compass, rows heights over the horizon, denser near it.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyTable {
    /// Columns, from north clockwise, and rows, from straight down to straight up.
    pub size: [usize; 2],
    /// Red, green, blue, row by row.
    pub light: Vec<[f32; 3]>,
    /// Light on level ground from the whole sky.
    pub ambient: [f32; 3],
}

/// Columns and rows of the computed sky, and of one from a picture.
const SKY_SIZE: [usize; 2] = [256, 128];
const PICTURE_SIZE: [usize; 2] = [2048, 1024];

/// The direction of a row's and a column's middle.
fn direction(size: [usize; 2], column: usize, row: usize) -> [f64; 3] {
    let turn = (column as f64 + 0.5) / size[0] as f64 * std::f64::consts::TAU;
    let place = (row as f64 + 0.5) / size[1] as f64 * 2.0 - 1.0;
    let over = place * place.abs() * std::f64::consts::FRAC_PI_2;
    let flat = libm::cos(over);
    [libm::sin(turn) * flat, libm::cos(turn) * flat, libm::sin(over)]
}

impl SkyTable {
    /// The sky of one or several lights: direction and irradiance.
    pub fn new(air: &Air, lights: &[([f64; 3], f64)]) -> Self {
        let [columns, rows] = SKY_SIZE;
        let pixel = |i: usize| {
            let view = direction(SKY_SIZE, i % columns, i / columns);
            let mut sum = [0.0f64; 3];
            for &(sun, strength) in lights.iter().filter(|light| light.1 > 0.0) {
                let light = air.sky(view, sun, strength);
                (0..3).for_each(|c| sum[c] += light[c]);
            }
            sum.map(|v| v as f32)
        };
        let light: Vec<[f32; 3]> = (0..columns * rows).into_par_iter().map(pixel).collect();
        Self::of(SKY_SIZE, light)
    }

    /// The sky of a picture of all directions, twice as wide as high, north in its middle; `white` is the light of its white.
    pub fn picture(image: &image::RgbImage, white: f32) -> Self {
        let [columns, rows] = PICTURE_SIZE;
        let (width, height) = image.dimensions();
        let pixel = |i: usize| {
            let view = direction(PICTURE_SIZE, i % columns, i / columns);
            let across = libm::atan2(view[0], view[1]) / std::f64::consts::TAU + 0.5;
            let down = libm::acos(view[2].clamp(-1.0, 1.0)) / PI;
            let at = |share: f64, n: u32| ((share * f64::from(n)) as u32).min(n - 1);
            image.get_pixel(at(across, width), at(down, height)).0.map(|v| {
                let v = f64::from(v) / 255.0;
                white * (if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }) as f32
            })
        };
        Self::of(PICTURE_SIZE, (0..columns * rows).into_par_iter().map(pixel).collect())
    }

    fn of(size: [usize; 2], light: Vec<[f32; 3]>) -> Self {
        let ambient = hemisphere(size, &light);
        Self { size, light, ambient }
    }
}

/// Light on level ground.
fn hemisphere([columns, rows]: [usize; 2], light: &[[f32; 3]]) -> [f32; 3] {
    let mut sum = [0.0f64; 3];
    for row in rows / 2..rows {
        let edge = |r: usize| {
            let place = r as f64 / rows as f64 * 2.0 - 1.0;
            libm::sin(place * place.abs() * std::f64::consts::FRAC_PI_2)
        };
        // The solid angle of a ring times its cosine is half the difference of squared heights.
        let weight = std::f64::consts::PI * (edge(row + 1).powi(2) - edge(row).powi(2)) / columns as f64;
        for pixel in &light[row * columns..][..columns] {
            (0..3).for_each(|c| sum[c] += weight * f64::from(pixel[c]));
        }
    }
    sum.map(|v| v as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_the_sky_stands_as_it_is_drawn() {
        // Red in the north, green in the east, blue above, black below.
        let image = image::RgbImage::from_fn(64, 32, |x, y| {
            image::Rgb(match (x, y) {
                (_, 0..8) => [0, 0, 255],
                (_, 17..) => [0; 3],
                (24..40, _) => [255, 0, 0],
                (40..56, _) => [0, 255, 0],
                _ => [0; 3],
            })
        });
        let sky = SkyTable::picture(&image, 2.0);
        let at = |turn_deg: f64, over: usize| {
            let column = (turn_deg / 360.0 * PICTURE_SIZE[0] as f64) as usize;
            sky.light[(PICTURE_SIZE[1] / 2 + over) * PICTURE_SIZE[0] + column]
        };
        assert_eq!([at(0.0, 4), at(90.0, 4), at(200.0, 4)], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]]);
        assert_eq!(at(123.0, 500), [0.0, 0.0, 2.0]);
        assert!(sky.ambient[2] > sky.ambient[0]);
    }

    fn toward(altitude_deg: f64) -> [f64; 3] {
        let a = altitude_deg.to_radians();
        [0.0, libm::cos(a), libm::sin(a)]
    }

    fn clear() -> Air {
        Air::new(1.0)
    }

    #[test]
    fn phases_integrate_to_one() {
        for phase in [rayleigh_phase, mie_phase] {
            let n = 200_000;
            let step = 2.0 / n as f64;
            let sum: f64 = (0..n).map(|i| phase((i as f64 + 0.5) * step - 1.0) * step * 2.0 * PI).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        }
    }

    #[test]
    fn the_horizon_at_noon_is_whiter_than_the_zenith_and_the_evening_sun_is_red() {
        let clear = clear();
        let noon = toward(70.0);
        let white = |[r, _, b]: Rgb| r / b;
        let (low, high) = (clear.sky([1.0, 0.0, 0.03], noon, SUN), clear.sky([0.0, 0.0, 1.0], noon, SUN));
        assert!(white(low) > 1.5 * white(high), "{low:?} {high:?}");
        let evening = clear.sunlight(toward(1.0));
        assert!(evening[0] > 2.0 * evening[2]);
        assert!(clear.sunlight(toward(60.0)).iter().all(|&v| v > 0.6 * SUN && v < SUN));
        assert_eq!(clear.sunlight(toward(-3.0)), [0.0; 3]);
    }

    #[test]
    fn a_sky_of_one_brightness_gives_pi_times_that() {
        let light = vec![[1.0; 3]; SKY_SIZE[0] * SKY_SIZE[1]];
        assert!(hemisphere(SKY_SIZE, &light).iter().all(|&v| (f64::from(v) - PI).abs() < 1e-5));
    }

    #[test]
    fn the_air_gives_no_more_than_it_takes() {
        let clear = clear();
        // What the sky gives level ground and what reaches it directly is less than what the sun gives.
        for altitude in [5.0, 30.0, 80.0] {
            let sun = toward(altitude);
            let sky = SkyTable::new(&clear, &[(sun, SUN)]);
            let direct = clear.sunlight(sun);
            for (around, direct) in sky.ambient.into_iter().zip(direct) {
                let all = f64::from(around) + direct * sun[2];
                assert!(all < SUN * sun[2] && all > 0.4 * SUN * sun[2], "{altitude}: {all}");
            }
        }
    }

    #[test]
    fn the_day_ends_without_a_step() {
        let clear = clear();
        let sky = |altitude: f64| {
            let sun = toward(altitude);
            let (a, b) = (clear.sky([0.6, 0.0, 0.8], sun, SUN), clear.sunlight(sun));
            [a[0], a[2], b[0]]
        };
        for k in -100..100 {
            let (here, next) = (sky(f64::from(k) * 0.1), sky(f64::from(k + 1) * 0.1));
            assert!(here.iter().zip(next).all(|(a, b)| (a - b).abs() < 0.05 * SUN), "{k}: {here:?} {next:?}");
        }
    }
}
