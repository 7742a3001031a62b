//! What happens to a particle that reaches the ground.

use crate::grid::{Foot, Mesh};

/// How particles meet the ground.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Radius of a particle, m.
    pub radius: f32,
    /// Speed off the ground over speed onto it.
    pub restitution: f32,
    /// Speed onto the ground below which nothing bounces, m/s.
    pub calm: f32,
    /// Friction over the thickness of a layer, 1/m.
    pub friction_per_m: f32,
    /// Centres nearer than this feel friction, m.
    pub layer: f32,
}

impl Touch {
    /// Moves a particle from `from` to `to`, stopped by the ground; gives where it is, its velocity and the ground there.
    #[inline(always)]
    pub fn land(
        &self,
        ground: &Mesh,
        from: [f32; 3],
        mut to: [f32; 3],
        mut v: [f32; 3],
        dt: f32,
    ) -> ([f32; 3], [f32; 3], Foot) {
        let mut foot = ground.foot(to[0], to[1]);
        let mut gap = foot.gap(to[2]);
        if gap < self.radius {
            // Out along the triangle, by as much as it came nearer, and slowly what is missing then: where the ground bends,
            // a triangle that it was never over may be nearer than a radius at once. Again where that led under the next one.
            let nearer: f32 = (0..3).map(|axis| (from[axis] - to[axis]) * foot.face[axis]).sum();
            let mut most = nearer.max(0.0) + self.calm * dt;
            for _ in 0..3 {
                let out = (self.radius - gap).min(most);
                most -= out;
                for (to, face) in to.iter_mut().zip(foot.face) {
                    *to += out * face;
                }
                foot = ground.foot(to[0], to[1]);
                gap = foot.gap(to[2]);
                if gap >= 0.9 * self.radius || most <= 0.0 {
                    break;
                }
            }
            if gap < 0.0 {
                // A notch or a wall: back to where it was, at rest, and out of ground that may have risen meanwhile.
                foot = ground.foot(from[0], from[1]);
                to = [from[0], from[1], from[2].max(foot.height)];
                v = [0.0; 3];
            }
            let n = foot.normal;
            let onto = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
            if onto < 0.0 {
                let back = if onto < -self.calm { 1.0 + self.restitution } else { 1.0 };
                for axis in 0..3 {
                    v[axis] -= back * onto * n[axis];
                }
            }
        }
        if gap < self.layer {
            // Quadratic friction on what goes along the ground, implicit: it brakes and never turns around.
            let n = foot.normal;
            let off = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
            let along = [0, 1, 2].map(|axis| v[axis] - off * n[axis]);
            let speed = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt();
            let left = 1.0 / (1.0 + self.friction_per_m * speed * dt);
            v = [0, 1, 2].map(|axis| off * n[axis] + left * along[axis]);
        }
        (to, v, foot)
    }
}
