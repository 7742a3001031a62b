//! What time does to a volcano that its plate has carried off its source: it sinks with the cooling floor, and what rain and
//! waves reach is worn down to the depth where waves end.
//!
//! Sea floor sinks by `s·√t` (Parsons and Sclater 1977: 350 m in the first million years); a volcano's foot is held, so that its
//! heights sink in proportion to what they have above it. Above that depth `dz/dt = −(z − z_waves)/w`. Both together turn islands
//! into banks and flat-topped seamounts. The height above the foot after `t` is a function of that before alone,
//! monotonous, so it is worked out height by height.

/// Pieces of time; sinking and wear follow each other in each.
const PIECES: usize = 32;
/// Depth to which waves wear a bank, m: tops of guyots were planed some tens of metres to a hundred below the sea.
const WAVES_M: f64 = 80.0;
/// Most of its height that a volcano sinks.
const MOST: f64 = 0.9;

/// What has become of heights above a volcano's foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear {
    /// What each piece of time leaves of a height by sinking.
    sinks_to: [f64; PIECES],
    /// What each piece of time leaves of heights above that of wear.
    left: f64,
    /// Height above the volcano's foot to which it is worn, m.
    worn_to_m: f64,
}

impl Wear {
    /// The wear of an age (My) on a volcano `height_m` high, whose foot lies `depth_m` below the sea (above it: less than 0),
    /// where the floor sinks by `sinks_m`·√My and heights are worn to 1/e in `wear_myr`. `None` for one that is new.
    pub fn after(age_myr: f64, height_m: f64, depth_m: f64, sinks_m: f64, wear_myr: f64) -> Option<Self> {
        if age_myr <= 0.0 || height_m <= 0.0 {
            return None;
        }
        let sunk = (sinks_m * age_myr.sqrt() / height_m).min(MOST);
        let stands = |i: usize| 1.0 - sunk * (i as f64 / PIECES as f64).sqrt();
        let sinks_to = std::array::from_fn(|i| stands(i + 1) / stands(i));
        Some(Self {
            sinks_to,
            left: libm::exp(-age_myr / PIECES as f64 / wear_myr),
            worn_to_m: (depth_m - WAVES_M).max(0.0),
        })
    }

    /// What is left of a height above the foot, and its derivative by the height before.
    #[inline]
    pub fn on(&self, height_m: f64) -> (f64, f64) {
        let (mut z, mut by) = (height_m, 1.0);
        for share in self.sinks_to {
            z *= share;
            by *= share;
            if z > self.worn_to_m {
                z = self.worn_to_m + (z - self.worn_to_m) * self.left;
                by *= self.left;
            }
        }
        (z, by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alone_sinking_and_wear_have_their_closed_forms() {
        let sinks = Wear::after(4.0, 8000.0, 5000.0, 350.0, 1e12).unwrap();
        // 350·√4 = 700 m off the top, half of that off half the height.
        assert!((sinks.on(8000.0).0 - 7300.0).abs() < 1e-6 && (sinks.on(4000.0).0 - 3650.0).abs() < 1e-6);
        let wears = Wear::after(4.0, 8000.0, 5000.0, 0.0, 2.0).unwrap();
        assert!((wears.on(8000.0).0 - (4920.0 + 3080.0 * (-2.0f64).exp())).abs() < 1e-6);
        assert_eq!(wears.on(4919.0), (4919.0, 1.0));
        assert!(Wear::after(0.0, 8000.0, 5000.0, 350.0, 3.0).is_none());
    }

    #[test]
    fn islands_become_flat_seamounts() {
        let ages = [0.1, 1.0, 3.0, 10.0, 40.0, 100.0];
        let worn = ages.map(|age| Wear::after(age, 8000.0, 5000.0, 350.0, 3.0).unwrap());
        let tops = worn.map(|wear| wear.on(8000.0).0);
        assert!(tops.is_sorted_by(|a, b| a > b), "{tops:?}");
        assert!(tops[1] > 6500.0 && tops[4] < 5000.0, "{tops:?}");
        // What were 2000 m between a shoulder and the summit are a bank.
        let old = worn[4];
        assert!(old.on(8000.0).0 - old.on(6000.0).0 < 400.0, "{} {}", old.on(8000.0).0, old.on(6000.0).0);
    }

    #[test]
    fn it_keeps_order_never_raises_and_knows_its_slope() {
        for depth_m in [-300.0, 0.0, 2500.0, 5000.0] {
            let wear = Wear::after(7.0, 6000.0, depth_m, 350.0, 3.0).unwrap();
            let mut below = 0.0;
            for h in (0..600).map(|i| 10.0 * i as f64 + 5.0) {
                let (z, by) = wear.on(h);
                assert!(z >= below - 1e-9 && z <= h, "{h}: {z} after {below}");
                below = z;
                let measured = (wear.on(h + 1e-4).0 - wear.on(h).0) / 1e-4;
                assert!((measured - by).abs() < 1e-3, "{h}: {measured}, not {by}");
            }
        }
    }
}
