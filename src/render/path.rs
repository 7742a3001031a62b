//! The camera's way through a film: around a point, over the land, or by keys; always above the ground, and smooth.

use glam::{DVec2, DVec3};

use super::{camera::Camera, land::Land, overview::Overview};
use crate::scene::{CameraParams, Movement};

/// Share of the film in which a movement comes up to its speed, and in which it ends.
const GENTLE: f64 = 0.12;
/// How far over the ground the eye is at least, in distances to its target.
const CLEARANCE: f64 = 0.02;
/// Width of what the camera takes for one piece of ground, in distances to its target.
const PIECE: f64 = 0.05;
/// Where a flight's eye begins and its target ends, before and behind the middle of the map, in its way across it.
const FLIGHT: f64 = 0.44;
/// Pictures of this shape show the usual orbit whole; narrower ones are taken from farther away.
const USUAL_ASPECT: f64 = 16.0 / 9.0;
/// Room around the map seen from the top.
const ROOM: f64 = 1.05;

/// Where a camera is to be before it has met the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stance {
    /// The point it looks at, east and north of the map's middle, m.
    target: DVec2,
    from_deg: f64,
    down_deg: f64,
    distance_m: f64,
    view_deg: f64,
}

impl Stance {
    /// As rows of numbers that can be passed between; distances by their logarithms.
    fn numbers(&self) -> [f64; 6] {
        let Self { target, from_deg, down_deg, distance_m, view_deg } = *self;
        [target.x, target.y, from_deg, down_deg, libm::log(distance_m), view_deg]
    }

    fn of([east, north, from_deg, down_deg, log_m, view_deg]: [f64; 6]) -> Self {
        Self { target: DVec2::new(east, north), from_deg, down_deg, distance_m: libm::exp(log_m), view_deg }
    }
}

/// A camera's way.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    movement: Movement,
    turn_deg: f64,
    extent_m: [f64; 2],
    start: Stance,
    /// Moments and stances of its keys.
    keys: Vec<(f64, Stance)>,
}

impl Path {
    /// The way of a camera over a map of this extent, m, for pictures of this size.
    pub fn new(camera: &CameraParams, extent_m: [f64; 2], size: [u32; 2]) -> Self {
        let side_m = extent_m[0].max(extent_m[1]);
        let aspect = f64::from(size[0].max(1)) / f64::from(size[1].max(1));
        let (from_deg, down_deg, distance, view_deg) = match camera.movement {
            Movement::Orbit | Movement::Still => (200.0, 28.0, Some(1.25 * (USUAL_ASPECT / aspect).max(1.0)), 35.0),
            Movement::Fly => (200.0, 14.0, Some(0.3), 45.0),
            Movement::Top => (180.0, 90.0, None, 15.0),
        };
        let view_deg = camera.view_deg.unwrap_or(view_deg);
        let half_m = ROOM * 0.5 * extent_m[1].max(extent_m[0] / aspect);
        let whole_m = half_m / libm::tan(0.5 * view_deg.to_radians());
        let place = |km: [f64; 2]| DVec2::new(km[0] * 1e3 - 0.5 * extent_m[0], 0.5 * extent_m[1] - km[1] * 1e3);
        let start = Stance {
            target: camera.target_km.map_or(DVec2::ZERO, place),
            from_deg: camera.from_deg.unwrap_or(from_deg),
            down_deg: camera.down_deg.unwrap_or(down_deg),
            distance_m: camera.distance.or(distance).map_or(whole_m, |sides| sides * side_m),
            view_deg,
        };
        let mut last = start;
        let keys = camera.keys.iter().map(|key| {
            last = Stance {
                target: key.target_km.map_or(last.target, place),
                from_deg: key.from_deg.unwrap_or(last.from_deg),
                down_deg: key.down_deg.unwrap_or(last.down_deg),
                distance_m: key.distance.map_or(last.distance_m, |sides| sides * side_m),
                view_deg: key.view_deg.unwrap_or(last.view_deg),
            };
            (key.at, last)
        });
        let keys = keys.collect();
        Self { movement: camera.movement, turn_deg: camera.turn_deg, extent_m, start, keys }
    }

    /// The camera over this land when a share of the film is over, 0 to 1.
    pub fn at(&self, share: f64, land: &Land) -> Camera {
        self.over(share, &land.overview(PIECE * self.nearest_m()))
    }

    fn nearest_m(&self) -> f64 {
        self.keys.iter().map(|(_, stance)| stance.distance_m).reduce(f64::min).unwrap_or(self.start.distance_m)
    }

    fn over(&self, share: f64, ground: &Overview) -> Camera {
        let stance = self.stance(share.clamp(0.0, 1.0));
        let DVec2 { x, y } = stance.target;
        let camera = Camera {
            target: DVec3::new(x, y, ground.mean_m(x, y)),
            from_deg: stance.from_deg,
            down_deg: stance.down_deg,
            distance_m: stance.distance_m,
            view_deg: stance.view_deg,
        }
        .limited();
        let clearance_m = CLEARANCE * stance.distance_m;
        let eye = camera.eye();
        let least_m = ground.top_m(eye.x, eye.y) + clearance_m;
        camera.above(0.0, |_, _| greater(eye.z, least_m, clearance_m))
    }

    fn stance(&self, share: f64) -> Stance {
        if !self.keys.is_empty() {
            return self.by_keys(share);
        }
        let mut stance = self.start;
        match self.movement {
            Movement::Top | Movement::Still => {}
            Movement::Orbit => {
                // Whole turns go on where they began.
                let whole = self.turn_deg % 360.0 == 0.0;
                stance.from_deg += self.turn_deg * if whole { share } else { gentle(share) };
            }
            Movement::Fly => {
                let from = stance.from_deg.to_radians();
                let toward = -DVec2::new(libm::sin(from), libm::cos(from));
                let [w, h] = self.extent_m;
                let along_m = (w * toward.x.abs()).hypot(h * toward.y.abs());
                let flat_m = stance.distance_m * libm::cos(stance.down_deg.to_radians());
                let last_m = FLIGHT * along_m;
                let first_m = (flat_m - last_m).min(last_m);
                let at_m = first_m + (last_m - first_m) * gentle(share);
                stance.target += toward * (at_m - stance.target.dot(toward));
            }
        }
        stance
    }

    fn by_keys(&self, share: f64) -> Stance {
        let times: Vec<f64> = self.keys.iter().map(|(at, _)| *at).collect();
        let rows: Vec<[f64; 6]> = self.keys.iter().map(|(_, stance)| stance.numbers()).collect();
        Stance::of(std::array::from_fn(|c| {
            let values: Vec<f64> = rows.iter().map(|row| row[c]).collect();
            between(&times, &values, share)
        }))
    }
}

/// The greater of two, rounded where they cross: never less than either, and exact where they are farther apart than
/// `width`.
fn greater(a: f64, b: f64, width: f64) -> f64 {
    let near = (1.0 - (a - b).abs() / width).max(0.0);
    a.max(b) + 0.25 * width * near * near
}

/// Time that comes up to its speed and slows down again; 0 and 1 stay.
fn gentle(t: f64) -> f64 {
    let ramp = |t: f64| 0.5 * t * t / (GENTLE * (1.0 - GENTLE));
    if t < GENTLE {
        ramp(t)
    } else if t > 1.0 - GENTLE {
        1.0 - ramp(1.0 - t)
    } else {
        (t - 0.5 * GENTLE) / (1.0 - GENTLE)
    }
}

/// A value between keys: cubic, through all of them, never beyond two neighbours (Fritsch and Carlson 1980, with the slopes
/// of Fritsch and Butland 1984), at rest at both ends.
fn between(times: &[f64], values: &[f64], at: f64) -> f64 {
    let last = times.len() - 1;
    if at <= times[0] || last == 0 {
        return values[0];
    }
    if at >= times[last] {
        return values[last];
    }
    let k = times.partition_point(|&time| time <= at) - 1;
    let span = |k: usize| times[k + 1] - times[k];
    let rise = |k: usize| (values[k + 1] - values[k]) / span(k);
    let slope = |k: usize| {
        if k == 0 || k == last || rise(k - 1) * rise(k) <= 0.0 {
            return 0.0;
        }
        let (before, after) = (2.0 * span(k) + span(k - 1), span(k) + 2.0 * span(k - 1));
        (before + after) / (before / rise(k - 1) + after / rise(k))
    };
    let h = span(k);
    let t = (at - times[k]) / h;
    let (t2, t3) = (t * t, t * t * t);
    values[k] * (2.0 * t3 - 3.0 * t2 + 1.0)
        + values[k + 1] * (3.0 * t2 - 2.0 * t3)
        + h * slope(k) * (t3 - 2.0 * t2 + t)
        + h * slope(k + 1) * (t3 - t2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Field, Grid, linear},
        render::Lie,
        scene::KeyParams,
    };

    const SIZE: [u32; 2] = [1280, 720];

    /// Spiky land, 100 km wide.
    fn spikes() -> (Field<f32>, Lie) {
        let grid = Grid::new(200, 120, 100_000.0, Edges::Open);
        let height = Field::from_fn(grid, |x, y| {
            let peak = if (x * 7 + y * 13) % 11 == 0 { 3000.0 } else { 0.0 };
            peak + 800.0 * libm::sin(x as f64 * 0.11) as f32
        });
        let range = height.range().unwrap();
        let lie = Lie {
            extent_m: grid.extent_m(),
            cell_m: grid.cell_m,
            sea_m: -100.0,
            range_m: [f64::from(range.0), f64::from(range.1)],
            exaggeration: 2.0,
            rim_at_sea: false,
        };
        (height, lie)
    }

    fn ground(height: &Field<f32>, lie: &Lie, east: f64, north: f64) -> f64 {
        let [w, h] = lie.extent_m;
        let at = [(east + 0.5 * w).clamp(0.0, w), (0.5 * h - north).clamp(0.0, h)];
        linear(height, at).max(lie.sea_m) * lie.exaggeration
    }

    fn key(at: f64, target_km: [f64; 2], distance: f64) -> KeyParams {
        KeyParams { at, target_km: Some(target_km), distance: Some(distance), ..KeyParams::default() }
    }

    fn low() -> CameraParams {
        let keys = vec![key(0.0, [10.0, 10.0], 0.05), key(0.4, [60.0, 30.0], 0.02), key(1.0, [90.0, 55.0], 0.3)];
        CameraParams { down_deg: Some(1.0), keys, ..CameraParams::default() }
    }

    #[test]
    fn the_overview_is_above_the_ground() {
        let (height, lie) = spikes();
        for wide_m in [10.0, 1700.0, 9000.0, 1e7] {
            let over = Overview::new(&height, &lie, wide_m);
            for k in 0..20_000 {
                let (east, north) = (f64::from(k % 163) * 700.0 - 57_000.0, f64::from(k / 163) * 600.0 - 36_000.0);
                let top = over.top_m(east, north);
                // Sums of f32 heights near 1e4 m.
                assert!(top >= ground(&height, &lie, east, north) - 0.01, "{wide_m} {east} {north}");
            }
        }
    }

    #[test]
    fn the_camera_stays_above_the_ground_and_moves_smoothly() {
        let (height, lie) = spikes();
        let fly =
            CameraParams { movement: Movement::Fly, down_deg: Some(2.0), distance: Some(0.05), ..Default::default() };
        for params in [low(), fly, CameraParams { down_deg: Some(-20.0), ..CameraParams::default() }] {
            let path = Path::new(&params, lie.extent_m, SIZE);
            let over = Overview::new(&height, &lie, PIECE * path.nearest_m());
            // The greatest change of its velocity from one of so many steps to the next.
            let bend = |steps: i32| {
                let share = |k: i32| f64::from(k) / f64::from(steps);
                let eyes: Vec<DVec3> = (0..=steps).map(|k| path.over(share(k), &over).eye()).collect();
                for (k, eye) in (0..).zip(&eyes) {
                    let least_m = CLEARANCE * path.stance(share(k)).distance_m;
                    let over_m = eye.z - ground(&height, &lie, eye.x, eye.y);
                    // Sums of f32 heights.
                    assert!(over_m > 0.99 * least_m, "{k}: {over_m} m, at least {least_m}");
                }
                eyes.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).length()).fold(0.0, f64::max)
            };
            // A quarter of the step: a sixteenth for a way that bends, a quarter for one with corners, all for one that
            // jumps.
            let (coarse, fine) = (bend(10_000), bend(40_000));
            assert!(fine < coarse / 10.0, "{fine} {coarse}");
        }
    }

    #[test]
    fn ends_are_exact() {
        let (height, lie) = spikes();
        let over = Overview::new(&Field::filled(height.grid, 0.0), &lie, 5000.0);
        let mut params = low();
        params.down_deg = Some(60.0);
        let path = Path::new(&params, lie.extent_m, SIZE);
        let first = path.over(0.0, &over);
        assert!((first.distance_m - 5000.0).abs() < 1e-6 && (first.target.x + 40_000.0).abs() < 1e-6);
        let end = path.over(1.0, &over);
        assert!((end.distance_m - 30_000.0).abs() < 1e-6 && (end.down_deg - 60.0).abs() < 1e-9);
        assert!((end.target.x - 40_000.0).abs() < 1e-6 && (end.target.y + 25_000.0).abs() < 1e-6);
        let orbit = Path::new(&CameraParams { turn_deg: -90.0, ..Default::default() }, lie.extent_m, SIZE);
        assert_eq!((orbit.over(0.0, &over).from_deg, orbit.over(1.0, &over).from_deg), (200.0, 110.0));
    }

    #[test]
    fn from_the_top_the_whole_map_is_seen() {
        let (height, lie) = spikes();
        let over = Overview::new(&height, &lie, 5000.0);
        let camera = Path::new(&CameraParams { movement: Movement::Top, ..Default::default() }, lie.extent_m, SIZE);
        let camera = camera.over(0.5, &over);
        let [w, h] = lie.extent_m;
        for corner in [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]] {
            let at = glam::DVec4::new(w * corner[0], h * corner[1], 0.0, 1.0);
            let seen = camera.view_projection(16.0 / 9.0) * at;
            let (x, y) = (seen.x / seen.w, seen.y / seen.w);
            assert!(x.abs() < 1.0 && y.abs() < 1.0 && x * corner[0] > 0.0 && y * corner[1] > 0.0, "{x} {y}");
        }
    }

    #[test]
    fn values_pass_between_keys_and_never_beyond() {
        let (times, values) = ([0.1, 0.2, 0.7, 0.9], [5.0, 1.0, 1.0, 9.0]);
        for (time, value) in times.iter().zip(values) {
            assert!((between(&times, &values, *time) - value).abs() < 1e-12);
        }
        assert_eq!((between(&times, &values, 0.0), between(&times, &values, 1.0)), (5.0, 9.0));
        let of = |k: i32| between(&times, &values, f64::from(k) * 1e-4);
        assert!((0..10_000).all(|k| (0.999_999..=9.000_001).contains(&of(k)) && (of(k) - of(k + 1)).abs() < 0.01));
        assert!(gentle(0.0) == 0.0 && (gentle(0.5) - 0.5).abs() < 1e-12 && gentle(1.0) == 1.0);
        assert!((0..1000).all(|k| gentle(f64::from(k) / 1e3) < gentle(f64::from(k + 1) / 1e3)));
        assert_eq!((greater(3.0, 1.0, 1.0), greater(1.0, 3.0, 1.0)), (3.0, 3.0));
        assert!((0..100).all(|k| greater(f64::from(k) * 0.1, 5.0, 2.0) >= 5.0f64.max(f64::from(k) * 0.1)));
    }
}
