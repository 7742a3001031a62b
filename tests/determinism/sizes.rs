//! Another size is the same land, sharper or coarser (DESIGN.md's second promise).

use std::sync::atomic::AtomicBool;

use upthrust::{
    measure,
    recipe::{Overrides, Plan, Source, presets},
    timeline::Timeline,
    world::World,
};

use super::grown;

/// Cells a side to which heights are averaged before they are compared.
const BLOCKS: usize = 128;

/// Heights over the sea, averaged in blocks to 128 cells from west to east.
fn averaged(world: &World) -> Vec<f64> {
    let height = world.height();
    let block = world.grid.width / BLOCKS;
    let rows = world.grid.height / block;
    let mut sums = vec![0.0; BLOCKS * rows];
    for y in 0..rows * block {
        for x in 0..BLOCKS * block {
            sums[y / block * BLOCKS + x / block] += height.at(x, y) as f64 - world.sea_level_m;
        }
    }
    sums.iter().map(|sum| sum / (block * block) as f64).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| f(a - ma, b - mb)).sum::<f64>();
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

/// Land of both over land of either; 1 where there is none.
fn land_overlap(a: &[f64], b: &[f64]) -> f64 {
    let count = |f: &dyn Fn(bool, bool) -> bool| a.iter().zip(b).filter(|(a, b)| f(**a > 0.0, **b > 0.0)).count();
    let either = count(&|a, b| a || b);
    if either == 0 { 1.0 } else { count(&|a, b| a && b) as f64 / either as f64 }
}

fn assert_same_land(a: &World, b: &World, least_correlation: f64, what: &str) {
    let (high_a, high_b) = (averaged(a), averaged(b));
    let (correlation, overlap) = (correlation(&high_a, &high_b), land_overlap(&high_a, &high_b));
    println!("{what}: correlation {correlation:.4}, land overlap {overlap:.4}");
    assert!(correlation >= least_correlation, "{what}: heights correlate at {correlation:.4}");
    assert!(overlap >= 0.9, "{what}: land overlaps at {overlap:.4}");
}

#[test]
fn the_plates_make_the_same_land_at_every_size() {
    let worlds: Vec<_> = ["256", "512", "1024", "2048"].map(|size| (size, grown("collision", size, None))).into();
    for (i, (size, world)) in worlds.iter().enumerate() {
        for (finer, other) in &worlds[i + 1..] {
            assert_same_land(world, other, 0.95, &format!("collision at {size} and {finer}"));
        }
    }
}

/// Rivers that begin on a plain of noise find other ways over other cells, and a zoom goes where they went: what these
/// share at another size is their statistics, not their land.
const OF_RIVERS_ALONE: [&str; 5] = ["steady-state", "knickpoint", "hard-band", "continent-to-valley", "canyon"];
/// Parcels of water as large as half a cell: on cells half as large there are eight times as many, for twice as many steps.
const OF_PARTICLES: &str = "rainstorm";

/// Land of so much coast that cells twice as large already blur a tenth of it at 128 cells a side.
const OF_SMALL_ISLANDS: [&str; 4] = ["archipelago-arc", "fbm-rough", "small-islands", "hotspot-chain"];

#[test]
fn every_preset_is_the_same_land_at_another_size() {
    let excepted = |name: &str| OF_RIVERS_ALONE.contains(&name) || name == OF_PARTICLES;
    for preset in presets().iter().filter(|preset| !excepted(preset.name)) {
        let sizes = if OF_SMALL_ISLANDS.contains(&preset.name) { ["256", "512"] } else { ["128", "256"] };
        let [coarse, fine] = sizes.map(|size| grown(preset.name, size, None));
        assert_same_land(&coarse, &fine, 0.95, preset.name);
        if OF_GAMES.contains(&preset.name) {
            assert_drains(&fine, preset.name);
        }
    }
}

/// Valleys at the scale of games: what water made drains.
const OF_GAMES: [&str; 5] = ["badlands", "alpine-screes", "alpine-valley", "river-source", "volcanic-slope"];

/// Less than a pit in 10,000 cells of the ground as it is.
fn assert_drains(world: &World, what: &str) {
    let pits = measure::survey(world).pits.unwrap();
    let share = pits.per_10_000().unwrap();
    println!("{what}: {} pits and {} lakes", pits.pits, pits.lakes);
    assert!(share < 1.0, "{what}: {share} pits in 10,000 cells");
}

#[test]
fn a_canyon_drains() {
    assert_drains(&grown("canyon", "256", None), "canyon");
}

/// Heights of a window's cells averaged over the cells of the map it was cut from, beside that map's own: where a
/// cell lies whole in the window.
fn averaged_over(parent: &World, window: &World) -> (Vec<f64>, Vec<f64>) {
    let corner_m = |world: &World| {
        let last =
            |column: &str| world.table("windows").and_then(|t| t.numbers(column)?.last().copied()).unwrap_or(0.0);
        [1e3 * last("first_x_km"), 1e3 * last("first_y_km")]
    };
    let (from, to) = (corner_m(parent), corner_m(window));
    let (coarse, fine) = (parent.height(), window.height());
    let (cell_m, width) = (coarse.grid.cell_m, coarse.grid.width);
    let mut cells = vec![(0.0, 0u32); coarse.data.len()];
    for (i, &height) in fine.data.iter().enumerate() {
        let (x, y) = fine.grid.cell_of(i);
        let at_m = fine.grid.center_m(x, y);
        let [x, y] = [0, 1].map(|axis: usize| ((at_m[axis] + to[axis] - from[axis]) / cell_m) as usize);
        let (sum, count) = &mut cells[y * width + x];
        (*sum, *count) = (*sum + height as f64, *count + 1);
    }
    let whole = 0.9 * (cell_m / fine.grid.cell_m).powi(2);
    let inside = cells.iter().zip(&coarse.data).filter(|((_, count), _)| *count as f64 >= whole);
    inside.map(|(&(sum, count), &own)| (sum / count as f64, own as f64)).unzip()
}

/// A window goes on from its map: rivers carve it anew, and still it is that land.
#[test]
fn a_valley_matches_its_continent() {
    let source = Source::find("continent-to-valley").unwrap();
    let overrides = Overrides { size: Some("256".to_owned()), ..Overrides::default() };
    let plan = Plan::new(&source, &overrides).unwrap();
    let until = |stage: &str| {
        let last = plan.stages.iter().position(|s| s.label == stage);
        Timeline::new(&plan, &AtomicBool::new(false)).until(last).run(&mut [], &mut |_| ()).unwrap()
    };
    let [continent, range, valley] = ["plates", "waters", &plan.stages.last().unwrap().label].map(until);
    for (what, parent, window) in [("range", &continent, &range), ("valley", &range, &valley)] {
        let (carved, own) = averaged_over(parent, window);
        assert!(own.len() > 100, "{what}: {} cells", own.len());
        let correlation = correlation(&carved, &own);
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let spread = (own.iter().map(|z| (z - mean(&own)).powi(2)).sum::<f64>() / own.len() as f64).sqrt();
        let sunk = (mean(&own) - mean(&carved)) / spread;
        println!("{what}: correlation {correlation:.3}, mean lower by {sunk:.3} spreads of {spread:.0} m");
        assert!(correlation > 0.9 && sunk.abs() < 0.4, "{what}: {correlation:.3} {sunk:.3}");
        assert_drains(window, what);
    }
}

#[test]
fn a_thumbnail_shows_its_world() {
    for seed in 1..=24 {
        // A sheet has two dozen, and at full size each takes half a minute; one of them is compared with that.
        let full = if seed == 8 { "1024" } else { "256" };
        let [thumbnail, world] = ["128", full].map(|size| grown("collision", size, Some(seed)));
        assert_same_land(&thumbnail, &world, 0.9, &format!("seed {seed} at 128 and {full}"));
    }
}

#[test]
fn a_map_need_not_be_square() {
    for name in ["collision", "fbm-smooth", "diamond-square"] {
        let [coarse, fine] = ["256x128", "512x256"].map(|size| grown(name, size, None));
        assert_same_land(&coarse, &fine, 0.95, &format!("{name}, twice as wide as high"));
        let [coarse, fine] = ["128x256", "256x512"].map(|size| grown(name, size, None));
        assert_same_land(&coarse, &fine, 0.9, &format!("{name}, twice as high as wide"));
    }
}
