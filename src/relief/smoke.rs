//! Smoke over the map: puffs as soft grey discs, seen from above.

use crate::{
    grid::Grid,
    world::{Plume, World},
};

/// How much of the ground a puff hides in its middle at most.
const DENSITY: f64 = 0.45;
/// Grey of a puff when it is born and when it is gone, sRGB.
const GREY: [f64; 2] = [214.0, 120.0];

/// A puff on a picture, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Disc {
    at: [f64; 2],
    radius: f64,
    /// How much it hides, 0 to 1.
    alpha: f64,
    grey: f64,
}

/// The smoke of a moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Smoke {
    discs: Vec<Disc>,
}

impl Smoke {
    /// The smoke over a world now, if any vent erupts.
    pub(super) fn of(world: &World, map: &Grid) -> Option<Self> {
        let plumes = world.plumes();
        let erupting = plumes.iter().any(|plume| plume.erupts(world.time_yr));
        erupting.then(|| Self::at(plumes.iter().map(|plume| (plume, 1.0)), world.time_yr, map)).flatten()
    }

    /// The smoke of plumes at a moment, each with a strength from 0 to 1; `map` are the picture's pixels over the ground.
    pub(super) fn at<'a>(plumes: impl Iterator<Item = (&'a Plume, f64)>, time_yr: f64, map: &Grid) -> Option<Self> {
        let disc = |puff: crate::world::Puff, strength: f64| Disc {
            at: [puff.at_m[0] / map.cell_m - 0.5, puff.at_m[1] / map.cell_m - 0.5],
            // A puff that is smaller than a pixel is a faint pixel.
            radius: (puff.radius_m / map.cell_m).max(1.0),
            alpha: DENSITY * strength * puff.opacity * (puff.radius_m / map.cell_m).min(1.0),
            grey: GREY[0] + (GREY[1] - GREY[0]) * puff.spent,
        };
        let discs: Vec<Disc> = plumes
            .flat_map(|(plume, strength)| plume.puffs(time_yr).into_iter().map(move |puff| (puff, strength)))
            .map(|(puff, strength)| disc(puff, strength))
            .filter(|disc| disc.alpha > 0.0)
            .collect();
        (!discs.is_empty()).then_some(Self { discs })
    }

    /// Lays a row of it over opaque pixels of `STEP` bytes that begin with red, green and blue.
    pub(super) fn lay<const STEP: usize>(&self, y: usize, row: &mut [u8]) {
        let width = row.len() / STEP;
        for disc in &self.discs {
            let dy = (y as f64 - disc.at[1]) / disc.radius;
            if dy.abs() >= 1.0 {
                continue;
            }
            let half = disc.radius * (1.0 - dy * dy).sqrt();
            // What lies west of the picture is at its first pixel and hides nothing there.
            let first = (disc.at[0] - half).ceil().max(0.0) as usize;
            let last = (disc.at[0] + half).floor();
            if last < 0.0 {
                continue;
            }
            for x in first..width.min(last as usize + 1) {
                let dx = (x as f64 - disc.at[0]) / disc.radius;
                let near = (1.0 - dx * dx - dy * dy).max(0.0);
                let alpha = disc.alpha * near * near;
                for byte in &mut row[x * STEP..][..3] {
                    *byte = (f64::from(*byte) + (disc.grey - f64::from(*byte)) * alpha + 0.5) as u8;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn plume() -> Plume {
        Plume {
            at_m: [50.0, 50.0, 0.0],
            along_m: [0.0; 2],
            radius_m: 10.0,
            begin_yr: 0.0,
            end_yr: 1.0,
            puffs_per_s: 20.0,
            rise_m_per_s: 5.0,
            slows_s: 10.0,
            swell: 0.1,
            wind_m_per_s: [100.0, 0.0],
            wind_at_m: 20.0,
            lasts_s: 10.0,
            seed: 3.0,
        }
    }

    #[test]
    fn smoke_is_thick_over_the_vent_drifts_downwind_and_is_nowhere_else() {
        let mut world = World::new(Grid::new(100, 100, 100.0, Edges::Open), 0.0);
        world.add_plumes(&[plume()]);
        assert_eq!(Smoke::of(&world, &world.grid), None, "no puff is there at the very beginning");
        world.time_yr = 1e-5;
        let smoke = Smoke::of(&world, &world.grid).unwrap();
        let rows: Vec<Vec<u8>> = (0..100)
            .map(|y| {
                let mut row = vec![0; 300];
                smoke.lay::<3>(y, &mut row);
                row
            })
            .collect();
        let at = |x: usize, y: usize| rows[y][3 * x];
        assert!(at(50, 50) > 100 && at(70, 50) > 20, "{} {}", at(50, 50), at(70, 50));
        assert_eq!([at(10, 50), at(50, 5), at(50, 95)], [0; 3]);
        assert!(rows.iter().flatten().all(|&byte| byte <= GREY[0] as u8));
        world.time_yr = 2.0;
        assert_eq!(Smoke::of(&world, &world.grid), None);
    }

    #[test]
    fn a_disc_beyond_the_rim_hides_nothing() {
        let far = Disc { at: [-30.0, 2.0], radius: 10.0, alpha: 1.0, grey: 200.0 };
        let mut row = [7; 12];
        Smoke { discs: vec![far, Disc { at: [900.0, 2.0], ..far }] }.lay::<4>(2, &mut row);
        assert_eq!(row, [7; 12]);
        Smoke { discs: vec![Disc { at: [1.0, 2.0], ..far }] }.lay::<4>(2, &mut row);
        assert_eq!((row[4], row[7]), (200, 7), "the fourth byte of a pixel stays");
    }
}
