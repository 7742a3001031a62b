//! Long profiles: the largest rivers of a world from their mouths up along their main stems.

use crate::{
    flow::{LENGTHS, ROOT, Router, opposite, outlets_but},
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
///
/// It is taken while solvers hold their own fields, so it keeps as few maps as it can: donors are looked for along the stems
/// alone, and what gathered is read there before the next thing gathers in its place.
pub fn main_stems(world: &World, most: usize) -> Vec<Vec<StemPoint>> {
    let (z, outlet) = ground(world);
    let mut router = Router::new(world.grid);
    router.route(&z, &outlet);
    drop(outlet);
    let mut area_m2 = world.catchment_sources_m2();
    router.descend(&mut area_m2, |_, area| *area);
    let mut stems = Vec::new();
    for mouth in largest_mouths(&router, &area_m2, most) {
        let stem = thinned(points(&router, mouth, &z, &area_m2));
        if !stem.is_empty() {
            stems.push(stem);
        }
    }
    drop((z, area_m2));
    let mut set = |discharge_m3_s: &dyn Fn(usize) -> f64| {
        for (i, point) in stems.iter_mut().flatten() {
            point.discharge_m3_s = discharge_m3_s(*i);
        }
    };
    match world.layer(Layer::Discharge) {
        Some(field) => set(&|i| field.data[i] as f64),
        None => {
            let mut water = world.water_sources_m3_s();
            router.descend(&mut water, |_, water| *water);
            set(&|i| water[i]);
        }
    }
    stems.into_iter().map(|stem| stem.into_iter().map(|(_, point)| point).collect()).collect()
}

/// Heights, m, and where water leaves.
fn ground(world: &World) -> (Vec<f64>, Vec<bool>) {
    let height = world.height();
    let outlet = outlets_but(&height, world.sea_level_m, &world.inflow_gates());
    (height.data.iter().map(|&z| z as f64).collect(), outlet)
}

/// The donor of a cell with the largest catchment; of equals the one further north-west.
fn main_donor(router: &Router, area_m2: &[f64], cell: usize) -> Option<usize> {
    let ways = router.ways();
    let donors = router.compass().around(cell).filter(|&(step, j)| ways[j] == opposite(step)).map(|(_, j)| j);
    donors.min_by(|&a, &b| area_m2[b].total_cmp(&area_m2[a]).then(a.cmp(&b)))
}

/// The last cells before the outlets of the largest rivers, the largest first. Of the streams that end in one cell the
/// largest is its river.
fn largest_mouths(router: &Router, area_m2: &[f64], most: usize) -> Vec<usize> {
    let ways = router.ways();
    let mut mouths: Vec<usize> = Vec::new();
    for mouth in (0..ways.len()).filter(|&i| ways[i] == ROOT).filter_map(|i| main_donor(router, area_m2, i)) {
        let larger = |&other: &usize| area_m2[other].total_cmp(&area_m2[mouth]).then(mouth.cmp(&other)).is_gt();
        let at = mouths.partition_point(larger);
        if at < most {
            mouths.insert(at, mouth);
            mouths.truncate(most);
        }
    }
    mouths
}

/// The cells of a stem with what is known of them, from the outlet to the divide; none where it is too short.
fn points(router: &Router, mouth: usize, z: &[f64], area_m2: &[f64]) -> Vec<(usize, StemPoint)> {
    let (ways, cell_m) = (router.ways(), router.grid().cell_m);
    let mut distance_m = 0.0;
    let mut stem = Vec::new();
    let mut next = Some(router.receiver(mouth));
    while let Some(i) = next {
        distance_m += LENGTHS.get(ways[i] as usize).map_or(0.0, |length| length * cell_m);
        stem.push((i, StemPoint { distance_m, height_m: z[i], area_m2: area_m2[i], discharge_m3_s: 0.0 }));
        next = if stem.len() == 1 { Some(mouth) } else { main_donor(router, area_m2, i) };
    }
    if stem.len() < LEAST_CELLS { Vec::new() } else { stem }
}

/// At most so many points, both ends among them.
fn thinned<T: Copy>(points: Vec<T>) -> Vec<T> {
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
