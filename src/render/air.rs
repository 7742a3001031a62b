//! The clear sky: light that air (Rayleigh), dust (Mie) and ozone scatter once or swallow, after Nishita (1993) as
//! O'Neil and others compute it. Worked out on the processor into a small table of the whole sky, so that every
//! adapter shows the same sky, and a picture's ambient light is its integral.
//!
//! Lengths in metres, directions with z up, light in units in which the sun above the air gives [`SUN`].

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
const STEPS: usize = 24;
const SUN_STEPS: usize = 8;
/// The eye stands so high, m: for the sky, the map's own heights make no difference.
const EYE_M: f64 = 300.0;

type Rgb = [f64; 3];

/// Share of light that air scatters by a cosine: integrates to one over the sphere.
pub fn rayleigh_phase(cosine: f64) -> f64 {
    3.0 / (16.0 * std::f64::consts::PI) * (1.0 + cosine * cosine)
}

/// The same for dust.
pub fn mie_phase(cosine: f64) -> f64 {
    let g = FORWARD;
    let bent = 1.0 + g * g - 2.0 * g * cosine;
    3.0 / (8.0 * std::f64::consts::PI) * (1.0 - g * g) * (1.0 + cosine * cosine) / ((2.0 + g * g) * bent * bent.sqrt())
}

/// Air of a clarity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Dust, 1 on a clear day.
    pub dust: f64,
}

/// What lies along a way: metres of sea-level air, dust, and full ozone.
type Depth = [f64; 3];

fn densities(height_m: f64) -> Depth {
    let h = height_m.max(0.0);
    [
        libm::exp(-h / RAYLEIGH_M),
        libm::exp(-h / MIE_M),
        (1.0 - (h - OZONE_AT_M).abs() / OZONE_HALF_M).max(0.0),
    ]
}

/// Distances at which a ray from `from` enters and leaves a sphere around the Earth's middle.
fn sphere(from: [f64; 3], toward: [f64; 3], radius: f64) -> Option<[f64; 2]> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let half = dot(from, toward);
    let rest = half * half - dot(from, from) + radius * radius;
    (rest >= 0.0).then(|| [-half - rest.sqrt(), -half + rest.sqrt()])
}

fn along(from: [f64; 3], toward: [f64; 3], distance: f64) -> [f64; 3] {
    [0, 1, 2].map(|i: usize| from[i] + toward[i] * distance)
}

fn height(at: [f64; 3]) -> f64 {
    (at[0] * at[0] + at[1] * at[1] + at[2] * at[2]).sqrt() - EARTH_M
}

impl Air {
    fn transmitted(&self, depth: Depth) -> Rgb {
        [0, 1, 2].map(|c: usize| {
            libm::exp(-RAYLEIGH[c] * depth[0] - MIE * self.dust * SWALLOWED * depth[1] - OZONE[c] * depth[2])
        })
    }

    /// What lies between a point and the end of the air; `None` where the Earth is in the way.
    fn depth_out(from: [f64; 3], toward: [f64; 3]) -> Option<Depth> {
        if let Some([near, _]) = sphere(from, toward, EARTH_M)
            && near > 0.0
        {
            return None;
        }
        let [_, far] = sphere(from, toward, AIR_M)?;
        let step = far / SUN_STEPS as f64;
        let mut depth = [0.0; 3];
        for k in 0..SUN_STEPS {
            let there = densities(height(along(from, toward, (k as f64 + 0.5) * step)));
            (0..3).for_each(|i| depth[i] += there[i] * step);
        }
        Some(depth)
    }

    /// Sunlight that reaches the ground, by the sun's direction; fades as its disc sets.
    pub fn sunlight(&self, sun: [f64; 3]) -> Rgb {
        let risen = ((sun[2] + 0.012) / 0.024).clamp(0.0, 1.0);
        // The sun's middle may be just under the horizon.
        let lifted = [sun[0], sun[1], sun[2].max(0.002)];
        let depth = Self::depth_out([0.0, 0.0, EARTH_M + EYE_M], lifted);
        let through = depth.map_or([0.0; 3], |depth| self.transmitted(depth));
        through.map(|share| share * SUN * risen * risen * (3.0 - 2.0 * risen))
    }

    /// Light of the sky from a direction, of a sun of irradiance `strength`.
    pub fn sky(&self, view: [f64; 3], sun: [f64; 3], strength: f64) -> Rgb {
        let eye = [0.0, 0.0, EARTH_M + EYE_M];
        let Some([_, mut end]) = sphere(eye, view, AIR_M) else { return [0.0; 3] };
        if let Some([near, _]) = sphere(eye, view, EARTH_M)
            && near > 0.0
        {
            end = near;
        }
        let cosine = view[0] * sun[0] + view[1] * sun[1] + view[2] * sun[2];
        let phases = [rayleigh_phase(cosine), mie_phase(cosine)];
        let mut behind: Depth = [0.0; 3];
        let mut light = [0.0; 3];
        let mut at = 0.0;
        for k in 0..STEPS {
            // Longer steps farther away, where less changes.
            let to = end * ((k + 1) as f64 / STEPS as f64).powi(2);
            let step = to - at;
            let here = along(eye, view, at + 0.5 * step);
            at = to;
            let there = densities(height(here));
            let half: Depth = [0, 1, 2].map(|i: usize| behind[i] + 0.5 * there[i] * step);
            (0..3).for_each(|i| behind[i] += there[i] * step);
            let Some(outside) = Self::depth_out(here, sun) else { continue };
            let through = self.transmitted([0, 1, 2].map(|i: usize| half[i] + outside[i]));
            for c in 0..3 {
                let scattered =
                    RAYLEIGH[c] * phases[0] * there[0] + MIE * self.dust * phases[1] * there[1];
                light[c] += through[c] * scattered * step;
            }
        }
        light.map(|v| v * strength)
    }
}

/// The whole sky as a table: columns are directions of the compass, rows heights over the horizon, denser near it.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyTable {
    /// Red, green, blue, row by row from straight down to straight up.
    pub light: Vec<[f32; 3]>,
    /// Light on level ground from the whole sky.
    pub ambient: [f32; 3],
    /// Light of the sky around the horizon, a mean.
    pub horizon: [f32; 3],
}

/// Columns and rows of a [`SkyTable`].
pub const SKY_SIZE: [usize; 2] = [128, 128];

/// The direction of a row's and a column's middle.
fn direction(column: usize, row: usize) -> [f64; 3] {
    let turn = (column as f64 + 0.5) / SKY_SIZE[0] as f64 * std::f64::consts::TAU;
    let place = (row as f64 + 0.5) / SKY_SIZE[1] as f64 * 2.0 - 1.0;
    let over = place * place.abs() * std::f64::consts::FRAC_PI_2;
    let flat = libm::cos(over);
    [libm::sin(turn) * flat, libm::cos(turn) * flat, libm::sin(over)]
}

impl SkyTable {
    /// The sky of one or several lights: direction and irradiance.
    pub fn new(air: Air, lights: &[([f64; 3], f64)]) -> Self {
        let [columns, rows] = SKY_SIZE;
        let pixel = |i: usize| {
            let view = direction(i % columns, i / columns);
            let mut sum = [0.0f64; 3];
            for &(sun, strength) in lights.iter().filter(|light| light.1 > 0.0) {
                let light = air.sky(view, sun, strength);
                (0..3).for_each(|c| sum[c] += light[c]);
            }
            sum.map(|v| v as f32)
        };
        let light: Vec<[f32; 3]> = (0..columns * rows).into_par_iter().map(pixel).collect();
        let ambient = hemisphere(&light);
        let row = &light[columns * (rows / 2 + rows / 16)..][..columns];
        let horizon = [0, 1, 2].map(|c: usize| row.iter().map(|p| p[c]).sum::<f32>() / columns as f32);
        Self { light, ambient, horizon }
    }
}

/// Light on level ground.
fn hemisphere(light: &[[f32; 3]]) -> [f32; 3] {
    let [columns, rows] = SKY_SIZE;
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
    use std::f64::consts::PI;

    fn toward(altitude_deg: f64) -> [f64; 3] {
        let a = altitude_deg.to_radians();
        [0.0, libm::cos(a), libm::sin(a)]
    }

    const CLEAR: Air = Air { dust: 1.0 };

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
        let noon = toward(70.0);
        let white = |[r, _, b]: Rgb| r / b;
        let (low, high) = (CLEAR.sky([1.0, 0.0, 0.03], noon, SUN), CLEAR.sky([0.0, 0.0, 1.0], noon, SUN));
        assert!(white(low) > 1.5 * white(high), "{low:?} {high:?}");
        let evening = CLEAR.sunlight(toward(1.0));
        assert!(evening[0] > 2.0 * evening[2]);
        assert!(CLEAR.sunlight(toward(60.0)).iter().all(|&v| v > 0.6 * SUN && v < SUN));
        assert_eq!(CLEAR.sunlight(toward(-3.0)), [0.0; 3]);
    }

    #[test]
    fn a_sky_of_one_brightness_gives_pi_times_that() {
        let light = vec![[1.0; 3]; SKY_SIZE[0] * SKY_SIZE[1]];
        assert!(hemisphere(&light).iter().all(|&v| (f64::from(v) - PI).abs() < 1e-5));
    }

    #[test]
    fn the_air_gives_no_more_than_it_takes() {
        // What the sky gives level ground and what reaches it directly is less than what the sun gives.
        for altitude in [5.0, 30.0, 80.0] {
            let sun = toward(altitude);
            let sky = SkyTable::new(CLEAR, &[(sun, SUN)]);
            let direct = CLEAR.sunlight(sun);
            for c in 0..3 {
                let all = f64::from(sky.ambient[c]) + direct[c] * sun[2];
                assert!(all < SUN * sun[2] && all > 0.4 * SUN * sun[2], "{altitude} {c}: {all}");
            }
        }
    }

    #[test]
    fn the_day_ends_without_a_step() {
        let sky = |altitude: f64| {
            let sun = toward(altitude);
            let (a, b) = (CLEAR.sky([0.6, 0.0, 0.8], sun, SUN), CLEAR.sunlight(sun));
            [a[0], a[2], b[0]]
        };
        for k in -100..100 {
            let (here, next) = (sky(f64::from(k) * 0.1), sky(f64::from(k + 1) * 0.1));
            assert!(here.iter().zip(next).all(|(a, b)| (a - b).abs() < 0.05 * SUN), "{k}: {here:?} {next:?}");
        }
    }
}
