//! A contact between two plates as the map sees it: a segment, and how fast the plates close, part or slide along it.

use glam::DVec2;

/// A two-point contact manifold in map metres and m/yr.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The two plates, the lower index first.
    pub plates: [usize; 2],
    /// Ends of the segment, midway between the plates' surfaces.
    pub ends_m: [DVec2; 2],
    /// The segment on the surface of either plate.
    pub surface_m: [[DVec2; 2]; 2],
    /// Unit normal from the first plate to the second.
    pub normal: DVec2,
    /// Velocity of the first plate relative to the second at the middle of the segment.
    pub relative_m_per_yr: DVec2,
    /// How deep the plates overlap (negative: apart), m.
    pub overlap_m: f64,
}

/// What a boundary does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Too slow to matter.
    Quiet,
    /// Plates close.
    Convergent,
    /// Plates part.
    Divergent,
    /// Plates slide past each other.
    Transform,
}

/// Slower than this a boundary is quiet, m/yr.
const QUIET_M_PER_YR: f64 = 0.2e-3;
/// Sine of the angle to the boundary above which closing or parting leads: 25 degrees.
const OBLIQUE: f64 = 0.42;

/// The kind of motion of plate A against plate B across a boundary whose unit normal points from A to B.
pub fn classify(relative_m_per_yr: DVec2, normal: DVec2) -> Motion {
    let speed = relative_m_per_yr.length();
    let closing = relative_m_per_yr.dot(normal);
    if speed < QUIET_M_PER_YR {
        Motion::Quiet
    } else if closing > OBLIQUE * speed {
        Motion::Convergent
    } else if closing < -OBLIQUE * speed {
        Motion::Divergent
    } else {
        Motion::Transform
    }
}

impl Contact {
    /// The same contact seen from the other plate.
    pub fn swapped(self) -> Self {
        Self {
            plates: [self.plates[1], self.plates[0]],
            surface_m: [self.surface_m[1], self.surface_m[0]],
            normal: -self.normal,
            relative_m_per_yr: -self.relative_m_per_yr,
            ..self
        }
    }

    /// Middle of the segment, m.
    pub fn middle_m(&self) -> DVec2 {
        (self.ends_m[0] + self.ends_m[1]) / 2.0
    }

    /// Length of the segment, m.
    pub fn length_m(&self) -> f64 {
        self.ends_m[0].distance(self.ends_m[1])
    }

    /// Speed at which the plates close (negative: part), m/yr.
    pub fn closing_m_per_yr(&self) -> f64 {
        self.relative_m_per_yr.dot(self.normal)
    }

    /// What the boundary does.
    pub fn motion(&self) -> Motion {
        classify(self.relative_m_per_yr, self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_are_told_apart() {
        let n = DVec2::X;
        let v = |x: f64, y: f64| DVec2::new(x, y) * 1e-3;
        assert_eq!(classify(v(10.0, 0.0), n), Motion::Convergent);
        assert_eq!(classify(v(-10.0, 3.0), n), Motion::Divergent);
        assert_eq!(classify(v(1.0, 10.0), n), Motion::Transform);
        assert_eq!(classify(DVec2::splat(0.7 * QUIET_M_PER_YR), n), Motion::Quiet);
        assert_eq!(classify(DVec2::splat(0.8 * QUIET_M_PER_YR), n), Motion::Convergent);
    }
}
