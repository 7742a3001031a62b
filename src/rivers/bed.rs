//! Shape of rivers, and the beds they have in the ground.
//!
//! Width and depth at bank-full flow follow the downstream hydraulic geometry of Leopold and Maddock (1953),
//! w = a·Q^0.5 and d = c·Q^0.4, with the constants that Moody and Troutman (2002) found over six decades of discharge:
//! a = 7.2 and c = 0.27 in m and m³/s (their exponents are 0.50 and 0.39).

use super::{hollows::least_fall_m, waters::Waters};

/// Width of a river of this bank-full discharge, m.
pub fn width_m(bankfull_m3_s: f64) -> f64 {
    7.2 * bankfull_m3_s.max(0.0).sqrt()
}

/// Depth of a river of this bank-full discharge, m.
pub fn depth_m(bankfull_m3_s: f64) -> f64 {
    if bankfull_m3_s > 0.0 { 0.27 * libm::pow(bankfull_m3_s, 0.39) } else { 0.0 }
}

/// The ground with beds in it, and the surface of water and ground.
pub struct Beds {
    /// Height of the ground, m.
    pub ground_m: Vec<f64>,
    /// The same with lakes on it, m.
    pub surface_m: Vec<f64>,
}

/// Cuts a bed of depth `cut_m` into every cell for which it is above 0. Beds fall all the way to the sea, a lake or the
/// rim, and never below them; a lake's level follows the bed of its outlet.
pub fn cut(waters: &Waters, z: &[f64], sea_m: f64, cut_m: impl Fn(usize) -> f64) -> Beds {
    let fall = least_fall_m(waters.way.grid);
    let mut ground_m = z.to_vec();
    let mut surface_m = z.to_vec();
    for &i in &waters.way.order {
        let (i, r) = (i as usize, waters.way.receiver[i as usize] as usize);
        let lake = waters.lake_of[i];
        if lake > 0 {
            let level_m = waters.lakes[lake as usize - 1].level_m;
            surface_m[i] =
                if r == i || waters.lakes[lake as usize - 1].closed { level_m } else { surface_m[r].max(z[i]) };
            continue;
        }
        // A rim cell's bed has the sea for its only floor.
        let floor_m = if r == i { sea_m } else { surface_m[r].max(sea_m) };
        let depth_m = cut_m(i);
        if depth_m > 0.0 {
            ground_m[i] = (z[i] - depth_m).max(floor_m + fall).min(z[i]);
        }
        surface_m[i] = ground_m[i];
    }
    Beds { ground_m, surface_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rivers_of_known_size() {
        // Mississippi at Vicksburg: bank-full about 40000 m³/s, 1000 to 1500 m wide and some 20 m deep.
        assert!((1000.0..1600.0).contains(&width_m(40_000.0)));
        assert!((13.0..22.0).contains(&depth_m(40_000.0)));
        assert_eq!((width_m(0.0), depth_m(0.0)), (0.0, 0.0));
    }
}
