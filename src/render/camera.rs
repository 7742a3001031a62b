//! The camera: it looks at a point from a side, from above, from a distance. Metres; x east, y north, z up, from the
//! middle of the map; heights are those that are drawn, with their exaggeration.
//!
//! Depth is reversed (1 at the near plane, 0 infinitely far), which keeps floating point as exact far away as near.

use glam::{DMat4, DVec3};

/// Where it looks from, and with which lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point it looks at, m.
    pub target: DVec3,
    /// The side it looks from: 0 north, 90 east.
    pub from_deg: f64,
    /// How far it looks down; negative looks up.
    pub down_deg: f64,
    /// Distance to the target, m.
    pub distance_m: f64,
    /// Angle of view, top to bottom.
    pub view_deg: f64,
}

/// It never looks straight down or up, where there is no upper side.
const STEEPEST_DEG: f64 = 89.9;
/// Angles of view that a lens has.
const LENSES_DEG: [f64; 2] = [2.0, 120.0];

impl Camera {
    /// The same within its limits: never upside down, with a lens that there is.
    pub fn limited(mut self) -> Self {
        self.down_deg = self.down_deg.clamp(-STEEPEST_DEG, STEEPEST_DEG);
        self.view_deg = self.view_deg.clamp(LENSES_DEG[0], LENSES_DEG[1]);
        self.distance_m = self.distance_m.max(1e-3);
        self
    }

    /// From the target to the eye, of length one.
    fn back(&self) -> DVec3 {
        let (from, down) = (self.from_deg.to_radians(), self.down_deg.to_radians());
        let flat = libm::cos(down);
        DVec3::new(libm::sin(from) * flat, libm::cos(from) * flat, libm::sin(down))
    }

    /// Where the eye is.
    pub fn eye(&self) -> DVec3 {
        self.target + self.back() * self.distance_m
    }

    /// The same camera with its eye at least `clearance_m` over the ground, of which `height` is told at a place: it moves up, still looking at
    /// the same point.
    pub fn above(mut self, clearance_m: f64, height: impl Fn(f64, f64) -> f64) -> Self {
        let eye = self.eye();
        let least = height(eye.x, eye.y) + clearance_m;
        if eye.z < least {
            let to = DVec3::new(eye.x, eye.y, least) - self.target;
            self.distance_m = to.length().max(1e-3);
            self.down_deg = libm::asin((to.z / self.distance_m).clamp(-1.0, 1.0)).to_degrees();
        }
        self.limited()
    }

    /// Moves sideways by shares of the picture's height: what was under the pointer stays there.
    pub fn pan(mut self, right: f64, up: f64) -> Self {
        let scale = 2.0 * self.distance_m * libm::tan(0.5 * self.view_deg.to_radians());
        let from = self.from_deg.to_radians();
        let (east, north) = (libm::sin(from), libm::cos(from));
        // Along the ground; upwards on the picture is away from the eye.
        let steep = libm::sin(self.down_deg.to_radians()).abs().max(0.2);
        let (right, away) = (-right * scale, -up * scale / steep);
        self.target += DVec3::new(-north * right - east * away, east * right - north * away, 0.0);
        self
    }

    /// Comes nearer (below 1) or goes away, towards a point that stays where it is on the picture.
    pub fn zoom(mut self, by: f64, toward: DVec3) -> Self {
        self.distance_m *= by;
        self.target = toward + (self.target - toward) * by;
        self.limited()
    }

    /// Turns around its target.
    pub fn orbit(mut self, clockwise_deg: f64, down_deg: f64) -> Self {
        self.from_deg = (self.from_deg + clockwise_deg).rem_euclid(360.0);
        self.down_deg += down_deg;
        self.limited()
    }

    /// Moves itself and its target forward along the ground.
    pub fn fly(mut self, forward_m: f64) -> Self {
        let from = self.from_deg.to_radians();
        self.target -= DVec3::new(libm::sin(from), libm::cos(from), 0.0) * forward_m;
        self
    }

    /// The nearest distance that is drawn, m.
    pub fn near_m(&self) -> f64 {
        (self.distance_m * 1e-3).clamp(0.01, 50.0)
    }

    /// From the map's metres to the camera's.
    pub fn view(&self) -> DMat4 {
        glam::dcamera::rh::view::look_at_mat4(self.eye(), self.target, DVec3::Z)
    }

    /// From the map's metres to the picture, for its width over its height.
    pub fn view_projection(&self, aspect: f64) -> DMat4 {
        let lens = glam::dcamera::rh::proj::directx::perspective_infinite_reverse(
            self.view_deg.to_radians(),
            aspect,
            self.near_m(),
        );
        lens * self.view()
    }

    /// Pixels that a metre takes at a distance of a metre, in a picture of this height.
    pub fn pixels_per_radian(&self, height_px: f64) -> f64 {
        0.5 * height_px / libm::tan(0.5 * self.view_deg.to_radians())
    }

    /// The direction in which a point of the picture lies: -1 to 1, to the right and up.
    pub fn ray(&self, at: [f64; 2], aspect: f64) -> DVec3 {
        let half = libm::tan(0.5 * self.view_deg.to_radians());
        let back = self.back();
        let right = DVec3::Z.cross(back).normalize_or(DVec3::X);
        let up = back.cross(right);
        (right * (at[0] * half * aspect) + up * (at[1] * half) - back).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec4;

    fn camera() -> Camera {
        Camera {
            target: DVec3::new(100.0, -50.0, 10.0),
            from_deg: 200.0,
            down_deg: 30.0,
            distance_m: 900.0,
            view_deg: 40.0,
        }
    }

    fn place(camera: &Camera, at: DVec3) -> DVec3 {
        let clip = camera.view_projection(16.0 / 9.0) * DVec4::new(at.x, at.y, at.z, 1.0);
        DVec3::new(clip.x, clip.y, clip.z) / clip.w
    }

    #[test]
    fn the_target_is_in_the_middle_and_depth_falls_with_distance() {
        let camera = camera();
        let middle = place(&camera, camera.target);
        assert!(middle.x.abs() < 1e-9 && middle.y.abs() < 1e-9);
        let depth = |share: f64| place(&camera, camera.eye() + (camera.target - camera.eye()) * share).z;
        assert!(depth(1e-3) < 1.001 && depth(1.0) < depth(0.5) && depth(1e6) > 0.0);
        // From the south-south-west, east is on the right.
        assert!(place(&camera, camera.target + DVec3::X * 10.0).x > 0.0);
        assert!(place(&camera, camera.target + DVec3::Z * 10.0).y > 0.0);
    }

    #[test]
    fn rays_meet_what_is_projected_there() {
        let camera = camera();
        let at = DVec3::new(180.0, 40.0, -20.0);
        let seen = place(&camera, at);
        let ray = camera.ray([seen.x, seen.y], 16.0 / 9.0);
        assert!((ray - (at - camera.eye()).normalize()).length() < 1e-9);
    }

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let mut camera = camera();
        camera.down_deg = 89.0;
        camera.target.z = 0.0;
        let moved = camera.pan(0.1, 0.2);
        // The picture is two units high.
        let seen = place(&moved, camera.target);
        assert!((seen.x * 16.0 / 9.0 - 0.2).abs() < 0.01 && (seen.y - 0.4).abs() < 0.01, "{seen}");
        let point = DVec3::new(150.0, 20.0, 0.0);
        let (before, after) = (place(&camera, point), place(&camera.zoom(0.4, point), point));
        assert!((before - after).truncate().length() < 1e-9);
    }

    #[test]
    fn the_eye_stays_above_the_ground_and_upright() {
        let low = Camera { down_deg: -20.0, ..camera() }.above(5.0, |_, _| 300.0);
        assert!((low.eye().z - 305.0).abs() < 1e-6);
        assert_eq!(camera().orbit(0.0, 500.0).down_deg, STEEPEST_DEG);
        let up = camera().orbit(77.0, 500.0).view().inverse().transform_vector3(DVec3::Y);
        assert!(up.z > 0.0);
    }
}
