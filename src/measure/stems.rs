//! Long profiles: the largest rivers of a world from their mouths up along their main stems.

use crate::{
    flow::{Drainage, outlets_but},
    world::{Layer, World},
};

/// Points a profile has at most.
const MOST_POINTS: usize = 250;
/// A river shorter than so many cells has no profile.
const LEAST_CELLS: usize = 8;

/// A place on a river.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StemPoint {
    /// Distance from the mouth along the river, m.
    pub distance_m: f64,
    /// Height of the ground, m.
    pub height_m: f64,
    /// Catchment, m².
    pub area_m2: f64,
    /// A year's mean, m³/s.
    pub discharge_m3_s: f64,
}

/// The main stems of the rivers with the largest catchments, the largest first, at most `most`; each from its mouth up to the
/// divide, always to where the larger catchment lies.
pub fn main_stems(world: &World, most: usize) -> Vec<Vec<StemPoint>> {
    let height = world.height();
    let outlet = outlets_but(&height, world.sea_level_m, &world.inflow_gates());
    let z: Vec<f64> = height.data.iter().map(|&z| z as f64).collect();
    let d = Drainage::of(world.grid, &z, &outlet);
    let sources = world.sources();
    let area_m2 = d.accumulate(&sources.area_m2);
    let discharge = match world.layer(Layer::Discharge) {
        Some(field) => field.data.iter().map(|&v| v as f64).collect(),
        None => d.accumulate(&sources.discharge_m3_s),
    };
    let mut donor: Vec<Option<usize>> = vec![None; d.len()];
    let mut mouths = Vec::new();
    for i in (0..d.len()).filter(|&i| !d.is_outlet(i)) {
        let r = d.receiver[i] as usize;
        if donor[r].is_none_or(|other| area_m2[i] > area_m2[other]) {
            donor[r] = Some(i);
        }
    }
    // Of the streams that end in one cell the largest is its river.
    mouths.extend((0..d.len()).filter(|&i| d.is_outlet(i)).filter_map(|i| donor[i]));
    // The largest first; of equals the one further north-west.
    mouths.sort_by(|&a, &b| area_m2[b].total_cmp(&area_m2[a]).then(a.cmp(&b)));
    let stem = |mouth: usize| -> Vec<StemPoint> {
        let mut distance_m = 0.0;
        let cells = std::iter::successors(Some(d.receiver[mouth] as usize), |&i| {
            if i == d.receiver[mouth] as usize { Some(mouth) } else { donor[i] }
        });
        cells
            .map(|i| {
                distance_m += d.step_m(i);
                StemPoint { distance_m, height_m: z[i], area_m2: area_m2[i], discharge_m3_s: discharge[i] }
            })
            .collect()
    };
    let long = |stem: &Vec<StemPoint>| stem.len() >= LEAST_CELLS;
    mouths.into_iter().take(most).map(stem).filter(long).map(thinned).collect()
}

/// At most so many points, both ends among them.
fn thinned(points: Vec<StemPoint>) -> Vec<StemPoint> {
    if points.len() <= MOST_POINTS {
        return points;
    }
    let last = points.len() - 1;
    (0..MOST_POINTS).map(|i| points[(i * last + (MOST_POINTS - 1) / 2) / (MOST_POINTS - 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Edges, Field, Grid};

    #[test]
    fn a_valley_is_followed_to_its_head() {
        // A trough that falls to the west; its mouth is the only place below the sea.
        let grid = Grid::new(400, 21, 40e3, Edges::Closed);
        let mut world = World::new(grid, 0.0);
        let height = |x: usize, y: usize| 0.5 * x as f32 - 0.25 + (y as f32 - 10.0).abs() * 3.0;
        world.set_layer(Layer::Bedrock, Field::from_fn(grid, height));
        let stems = main_stems(&world, 3);
        assert_eq!(stems.len(), 1);
        let stem = &stems[0];
        assert_eq!((stem.len(), stem[0].distance_m, stem[0].height_m), (MOST_POINTS, 0.0, -0.25));
        assert_eq!(stem[0].area_m2, 40e3 * 2.1e3);
        assert!(
            stem.is_sorted_by(|a, b| a.distance_m < b.distance_m && a.height_m < b.height_m && a.area_m2 > b.area_m2)
        );
        // 399 steps of 100 m along the trough, then up its side.
        assert!(stem.last().unwrap().distance_m >= 39_900.0, "{:?}", stem.last());
        assert!((stem[0].discharge_m3_s - 84e6 / (365.25 * 86_400.0)).abs() < 1e-9);
    }
}
