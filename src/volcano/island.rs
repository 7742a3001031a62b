//! Islands: a cone with a flat core, fractal noise at two frequencies, and a belt of islets around.
//!
//! At a distance `r` from the middle, with `R` the radius, `f` the core, `S(t) = 3t² − 2t³`, and noises of unit standard
//! deviation: `h` in the core (`r < f·R`), then `h·(1 − S((r − f·R)/(R − f·R)))` to 0 at `R`, everywhere with `n·h·fbm(ν·x/R)`.
//! From `R` to `τ·R`, with `s = S((r − R)/(τ·R − R))`, the noise and the islets `i·n·h·(fbm(2ν·x/R) − c)·s` are both
//! multiplied by `1 − s`: only the tops of the finer noise come up. The sea floor sinks from 0 at `R` to its depth. All of it
//! is smooth in height and slope; `profile = "linear"`, a straight ramp, has an edge at `f·R` and `R`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{length_m, off_map_m, place_m};
use crate::{
    grid::{Field, Grid, for_each_row},
    noise::{Fbm, Octaves, Sampler, smoothstep},
    process::{Context, ProcessError, Shape},
};

/// Islands in a sea.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct IslandParams {
    /// Its middle, east and south of the map's north-west corner; the middle of the map if not given.
    #[schemars(extend("x-unit" = "km", "x-effect" = "moves it east and south"))]
    pub at_km: Option<[f64; 2]>,
    /// Radius, without the belt of islets; 30 % of the map's longer side if not given.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km", "x-effect" = "a larger island"))]
    pub radius_km: Option<f64>,
    /// Height of its core above 0.
    #[schemars(range(min = 0.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "a higher island"))]
    pub height_m: f64,
    /// Radius of the flat core, as a share of the island's.
    #[schemars(range(min = 0.0, max = 0.99), extend("x-unit" = "1", "x-effect" = "a tableland with steeper coasts"))]
    pub flat: f64,
    /// The way down from the core to the coast.
    #[schemars(extend("x-effect" = "smoothstep has no edges; linear is a straight ramp"))]
    pub profile: IslandProfile,
    /// Roughness: standard deviation of its fractal noise, as a share of the height.
    #[schemars(range(min = 0.0, max = 3.0), extend("x-unit" = "1", "x-effect" = "rougher land, a more ragged coast; from 1 on spikes"))]
    pub noise: f64,
    /// Waves of the noise over a radius.
    #[schemars(range(min = 0.1, max = 100.0), extend("x-unit" = "1", "x-effect" = "more and smaller hills and bays"))]
    pub noise_frequency: f64,
    /// Hurst exponent of the noise: 1 is smooth, 0.2 rough.
    #[schemars(range(min = 0.05, max = 1.2), extend("x-unit" = "1", "x-effect" = "smoother hills"))]
    pub hurst: f64,
    /// Where the belt of islets ends, in radii.
    #[schemars(range(min = 1.0, max = 20.0), extend("x-unit" = "1", "x-effect" = "a wider belt of islets"))]
    pub transition: f64,
    /// Height of the islets, over that of the noise.
    #[schemars(range(min = 0.0, max = 20.0), extend("x-unit" = "1", "x-effect" = "more and higher islets"))]
    pub islets: f64,
    /// Another island of the same kind: its noise is another.
    #[schemars(range(min = 0, max = 1000000), extend("x-effect" = "another island of the same kind"))]
    pub variant: u32,
    /// Depth of the sea floor below 0; 0 for land to add to what is there.
    #[schemars(range(min = 0.0, max = 12000.0), extend("x-unit" = "m", "x-effect" = "a deeper sea"))]
    pub depth_m: f64,
    /// Where the sea floor has that depth, in radii.
    #[schemars(range(min = 1.01, max = 50.0), extend("x-unit" = "1", "x-effect" = "a wider shelf"))]
    pub shelf: f64,
    /// Several islands: each has its place, and otherwise the stage's own values unless it gives its own.
    pub islands: Vec<IslandEntry>,
}

/// The way from an island's core to its coast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum IslandProfile {
    /// Level at both ends.
    #[default]
    Smoothstep,
    /// A straight ramp.
    Linear,
}

/// One of several islands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IslandEntry {
    /// Its middle, east and south of the map's north-west corner.
    #[schemars(extend("x-unit" = "km"))]
    pub at_km: [f64; 2],
    /// Radius.
    #[schemars(range(min = 0.001, max = 10000.0), extend("x-unit" = "km"))]
    pub radius_km: Option<f64>,
    /// Height of its core.
    #[schemars(range(min = 0.0, max = 12000.0), extend("x-unit" = "m"))]
    pub height_m: Option<f64>,
    /// Radius of the flat core, as a share of the island's.
    #[schemars(range(min = 0.0, max = 0.99), extend("x-unit" = "1"))]
    pub flat: Option<f64>,
}

impl Default for IslandParams {
    fn default() -> Self {
        Self {
            at_km: None,
            radius_km: None,
            height_m: 400.0,
            flat: 0.2,
            profile: IslandProfile::Smoothstep,
            noise: 0.25,
            noise_frequency: 2.0,
            hurst: 0.8,
            transition: 1.4,
            islets: 2.0,
            variant: 0,
            depth_m: 150.0,
            shelf: 2.0,
            islands: Vec::new(),
        }
    }
}

/// Radius, in the map's longer side.
const RADIUS: f64 = 0.3;
/// What the finer noise must exceed to make an islet, standard deviations: one place in nine does.
const RARE: f64 = 1.2;

impl Shape for IslandParams {
    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        for (i, isle) in self.isles(grid).iter().enumerate() {
            let who = if self.islands.is_empty() { String::new() } else { format!("islands[{}]: ", i + 1) };
            let [x, y] = isle.at_m.map(|m| m / 1e3);
            if !(x.abs() <= 1e6 && y.abs() <= 1e6) {
                return Err(ProcessError::Unfit(format!(
                    "{who}at_km must be two numbers of kilometres, at most a million"
                )));
            }
            if off_map_m(isle.at_m, grid) > isle.transition * isle.radius_m {
                let [w, h] = grid.extent_m().map(|m| m / 1e3);
                return Err(ProcessError::Unfit(format!(
                    "{who}at_km = [{x}, {y}] is so far off the map (0 to {w}, 0 to {h}) that nothing of it would be seen"
                )));
            }
        }
        Ok(())
    }

    fn heights(&self, ground: &Field<f32>, context: &Context) -> Result<Field<f32>, ProcessError> {
        let grid = ground.grid;
        let key = context.key.named("island").with(u64::from(self.variant));
        let noises = |(i, isle): (usize, Isle)| {
            let wave_m = isle.radius_m / self.noise_frequency;
            let noise = |name: &str, wave_m: f64| {
                Fbm::new(wave_m, self.hurst).octaves(key.with(i as u64).named(name), grid.cell_m)
            };
            (isle, [noise("hills", wave_m), noise("islets", 0.5 * wave_m)])
        };
        let isles: Vec<(Isle, [Octaves; 2])> = self.isles(&grid).into_iter().enumerate().map(noises).collect();
        let mut heights = Field::filled(grid, 0.0);
        for_each_row(&mut heights.data, grid.width, |y, row| {
            let mut isles: Vec<_> =
                isles.iter().map(|(isle, noises)| (isle, noises.each_ref().map(Octaves::sampler))).collect();
            for (x, height) in row.iter_mut().enumerate() {
                let at_m = grid.center_m(x, y);
                let highest = isles.iter_mut().map(|(isle, noises)| isle.height_m(noises, at_m)).reduce(f64::max);
                *height = highest.unwrap_or(0.0) as f32;
            }
        });
        Ok(heights)
    }
}

impl IslandParams {
    fn isles(&self, grid: &Grid) -> Vec<Isle> {
        let own = Isle {
            at_m: place_m(self.at_km, grid),
            radius_m: length_m(self.radius_km, RADIUS, grid),
            core_m: self.height_m,
            flat: self.flat,
            profile: self.profile,
            noise: self.noise,
            transition: self.transition,
            islets: self.islets,
            depth_m: self.depth_m,
            shelf: self.shelf,
        };
        if self.islands.is_empty() {
            return vec![own];
        }
        let listed = |entry: &IslandEntry| Isle {
            at_m: entry.at_km.map(|km| km * 1e3),
            radius_m: entry.radius_km.map_or(own.radius_m, |km| km * 1e3),
            core_m: entry.height_m.unwrap_or(own.core_m),
            flat: entry.flat.unwrap_or(own.flat),
            ..own
        };
        self.islands.iter().map(listed).collect()
    }
}

/// An island in metres.
#[derive(Clone, Copy, Debug)]
struct Isle {
    at_m: [f64; 2],
    radius_m: f64,
    core_m: f64,
    flat: f64,
    profile: IslandProfile,
    noise: f64,
    transition: f64,
    islets: f64,
    depth_m: f64,
    shelf: f64,
}

impl Isle {
    fn height_m(&self, [hills, islets]: &mut [Sampler; 2], at_m: [f64; 2]) -> f64 {
        let r = libm::hypot(at_m[0] - self.at_m[0], at_m[1] - self.at_m[1]) / self.radius_m;
        let rough_m = self.noise * self.core_m;
        let land_m = if r >= self.transition || rough_m == 0.0 {
            self.bare_m(r)
        } else if r < 1.0 {
            self.bare_m(r) + rough_m * hills.value(at_m)
        } else {
            let s = smoothstep((r - 1.0) / (self.transition - 1.0));
            rough_m * (hills.value(at_m) + self.islets * (islets.value(at_m) - RARE) * s) * (1.0 - s)
        };
        land_m - self.depth_m * smoothstep((r - 1.0) / (self.shelf - 1.0))
    }

    /// Height without noise and sea floor, at a distance in radii.
    fn bare_m(&self, r: f64) -> f64 {
        let t = ((r - self.flat) / (1.0 - self.flat)).clamp(0.0, 1.0);
        let down = match self.profile {
            IslandProfile::Smoothstep => smoothstep(t),
            IslandProfile::Linear => t,
        };
        self.core_m * (1.0 - down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{grid::Edges, noise::Key};

    fn isle(params: &IslandParams) -> Isle {
        params.isles(&Grid::new(64, 64, 1000.0, Edges::Open))[0]
    }

    /// The document's example scene.
    fn example() -> IslandParams {
        IslandParams {
            radius_km: Some(0.135),
            height_m: 30.0,
            transition: 1.2,
            islets: 1.0,
            depth_m: 0.0,
            ..IslandParams::default()
        }
    }

    fn noises(cell_m: f64) -> [Octaves; 2] {
        [("a", 60.0), ("b", 30.0)].map(|(name, wave)| Fbm::new(wave, 0.8).octaves(Key::new(3).named(name), cell_m))
    }

    #[test]
    fn without_noise_it_is_the_cone_with_a_flat_core() {
        let smooth = isle(&example());
        let linear = isle(&IslandParams { profile: IslandProfile::Linear, ..example() });
        for isle in [smooth, linear] {
            let halfway = 0.5 * (1.0 + isle.flat);
            assert_eq!([0.0, 0.1, 0.2].map(|r| isle.bare_m(r)), [30.0; 3]);
            assert!((isle.bare_m(halfway) - 15.0).abs() < 1e-12);
            assert_eq!([1.0, 1.1, 5.0].map(|r| isle.bare_m(r)), [0.0; 3]);
        }
        assert!((linear.bare_m(0.4) - 22.5).abs() < 1e-12);
        // 1 − S(1/4) = 27/32.
        assert!((smooth.bare_m(0.4) - 30.0 * 27.0 / 32.0).abs() < 1e-12);
    }

    #[test]
    fn height_and_slope_are_continuous_at_the_core_the_coast_and_the_end_of_the_belt() {
        let params = IslandParams { depth_m: 40.0, ..example() };
        let isle = isle(&params);
        let noises = noises(4.0);
        let mut noises = noises.each_ref().map(Octaves::sampler);
        // Middle of the map 500 m in both directions; outwards at an odd angle.
        let (sin, cos) = libm::sincos(0.7);
        let mut z = |r_m: f64| isle.height_m(&mut noises, [500.0 + r_m * cos, 500.0 + r_m * sin]);
        let step = 1e-3;
        for share in [0.2, 1.0, 1.2, 2.0] {
            let r = share * 135.0;
            assert!((z(r + 1e-9) - z(r - 1e-9)).abs() < 1e-6, "a step at {share}");
            let (before, after) = ((z(r) - z(r - step)) / step, (z(r + step) - z(r)) / step);
            // Two steps of 1 mm; curvature is below 6·30/(0.8·135)² = 0.02 of the shape and some 0.3 of the noise.
            assert!((after - before).abs() < 2e-3, "an edge at {share}: {before}, {after}");
        }
    }

    #[test]
    fn islets_come_up_in_the_belt_alone() {
        let params = IslandParams { transition: 3.0, islets: 3.0, ..example() };
        let isle = isle(&params);
        let noises = noises(1.0);
        let mut noises = noises.each_ref().map(Octaves::sampler);
        let mut stream = Key::new(8).stream();
        let (mut up, mut count) = (0, 0);
        for _ in 0..20_000 {
            let at = [stream.between(0.0, 1000.0), stream.between(0.0, 1000.0)];
            let r = libm::hypot(at[0] - 500.0, at[1] - 500.0) / 135.0;
            let z = isle.height_m(&mut noises, at);
            if (1.3..2.5).contains(&r) {
                count += 1;
                up += usize::from(z > 0.0);
            } else if r > 3.0 {
                assert_eq!(z, 0.0);
            }
        }
        let share = up as f64 / count as f64;
        assert!((0.03..0.5).contains(&share), "{share}");
    }

    #[test]
    fn what_is_off_the_map_or_no_place_is_refused() {
        let grid = Grid::new(64, 64, 1000.0, Edges::Open);
        let at = |at_km| IslandParams { at_km: Some(at_km), ..example() };
        assert!(at([1.1, 0.5]).fit(&grid).is_ok());
        for at_km in [[2.0, 0.5], [f64::NAN, 0.0], [f64::INFINITY, 0.0]] {
            let error = at(at_km).fit(&grid).unwrap_err().to_string();
            assert!(error.contains("at_km") && !error.contains('\n'), "{error}");
        }
        let entry = |x| IslandEntry { at_km: [x, 0.5], radius_km: None, height_m: None, flat: None };
        let several = IslandParams { islands: vec![entry(0.2), entry(9.0)], ..example() };
        assert!(several.fit(&grid).unwrap_err().to_string().starts_with("islands[2]: at_km"));
    }
}
