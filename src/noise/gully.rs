//! Gullies: noise whose valleys run down the slope that it is given, and branch.
//!
//! Each octave lays stripes along the line of steepest descent, as jittered patches of a cosine whose phase runs across
//! the slope, blended by compact windows. The slope it made joins the slope it was given before the next, finer octave,
//! so that side valleys leave the sides of main ones. It moves no water: it is a look, not erosion.

use super::Key;

/// Spurs and valleys over a slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gullies {
    /// Spacing of the widest valleys, m.
    pub wavelength_m: f64,
    /// Octaves, each half as wide.
    pub octaves: u32,
    /// Height of an octave as a share of its wavelength on a steep slope.
    pub relief: f64,
    /// Slope (rise over run) at which gullies have half of that height.
    pub half_slope: f64,
}

impl Gullies {
    /// Height to add at a point whose ground slopes by `slope`, as far as cells of `cell_m` resolve it; m.
    pub fn value(&self, key: Key, at_m: [f64; 2], slope: [f64; 2], cell_m: f64) -> f64 {
        let (mut height, mut slope) = (0.0, slope);
        let mut wavelength = self.wavelength_m;
        for octave in 0..self.octaves {
            // Fades out between four cells and two cells a wave.
            let seen = ((wavelength / cell_m - 2.0) / 2.0).clamp(0.0, 1.0);
            if seen == 0.0 {
                break;
            }
            let steep = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
            if steep > 0.0 {
                let amplitude = self.relief * wavelength * steep / (steep + self.half_slope) * seen;
                let across = [-slope[1] / steep, slope[0] / steep];
                let (wave, rise) = stripes(key.with(octave as u64), at_m, across, wavelength);
                height += amplitude * wave;
                let rise = amplitude * std::f64::consts::TAU / wavelength * rise;
                slope = [slope[0] + rise * across[0], slope[1] + rise * across[1]];
            }
            wavelength *= 0.5;
        }
        height
    }
}

/// A stripe pattern whose phase runs along the unit vector `across`: its value, -1 to 1, and its slope in units of the
/// wave number.
fn stripes(key: Key, at_m: [f64; 2], across: [f64; 2], wavelength_m: f64) -> (f64, f64) {
    let at = [at_m[0] / wavelength_m, at_m[1] / wavelength_m];
    let cell = [at[0].floor(), at[1].floor()];
    let (mut wave, mut rise, mut weight) = (0.0, 0.0, 0.0);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (ix, iy) = (cell[0] as i32 + dx, cell[1] as i32 + dy);
            let hash = key.lattice(ix, iy);
            let unit = |shift: u32| ((hash >> shift) & 0xF_FFFF) as f64 / (1u64 << 20) as f64;
            let (rx, ry) = (at[0] - ix as f64 - unit(0), at[1] - iy as f64 - unit(20));
            // Windows reach one wavelength: never past the neighbouring lattice cells.
            let inside = 1.0 - (rx * rx + ry * ry);
            if inside > 0.0 {
                let w = inside * inside * inside;
                let phase = std::f64::consts::TAU * (rx * across[0] + ry * across[1] + unit(40));
                let (sin, cos) = libm::sincos(phase);
                wave += w * cos;
                rise -= w * sin;
                weight += w;
            }
        }
    }
    // Where windows hardly overlap the pattern fades instead of jumping.
    let scale = 1.0 / weight.max(0.25);
    (wave * scale, rise * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GULLIES: Gullies = Gullies { wavelength_m: 8e3, octaves: 1, relief: 0.1, half_slope: 0.05 };

    #[test]
    fn valleys_run_down_the_slope() {
        // On a plane that falls to the east, heights change faster from north to south.
        let key = Key::new(5);
        let at = |x: f64, y: f64| GULLIES.value(key, [x, y], [-0.1, 0.0], 10.0);
        let (mut along, mut across) = (0.0, 0.0);
        for i in 0..4000 {
            let (x, y) = ((i % 63) as f64 * 1100.0, (i / 63) as f64 * 1300.0);
            along += (at(x + 400.0, y) - at(x, y)).powi(2);
            across += (at(x, y + 400.0) - at(x, y)).powi(2);
        }
        assert!(across > 3.0 * along, "{across} {along}");
    }

    #[test]
    fn flat_ground_has_none_and_coarse_cells_fade_them() {
        assert_eq!(GULLIES.value(Key::new(1), [3e3, 4e3], [0.0, 0.0], 10.0), 0.0);
        assert_eq!(GULLIES.value(Key::new(1), [3e3, 4e3], [0.1, 0.0], 5e3), 0.0);
        assert_ne!(GULLIES.value(Key::new(1), [3e3, 4e3], [0.1, 0.0], 500.0), 0.0);
    }

    #[test]
    fn the_surface_is_continuous() {
        let slope = [0.07, -0.03];
        for i in 0..20_000 {
            let at = [i as f64 * 13.7, i as f64 * 7.3];
            let step = GULLIES.value(Key::new(2), [at[0] + 0.5, at[1]], slope, 10.0)
                - GULLIES.value(Key::new(2), at, slope, 10.0);
            // Steepest possible: 2π·relief·the windows' own slope, over half a metre.
            assert!(step.abs() < 0.5 * 0.1 * 30.0, "{step}");
        }
    }
}
