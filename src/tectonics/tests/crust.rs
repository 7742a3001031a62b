//! What two plates make of their crust: collision, sea floor, arcs, and nothing where they slide.

use crate::{
    crust,
    tectonics::{
        params::PlatesParams,
        surface::{Detail, Surface},
        warp::Warp,
    },
    world::Layer,
};

use super::*;

const EAST: DVec2 = DVec2::X;
const AREA_M2: f64 = CELL_M * CELL_M;

/// Continents that meet over the middle, with sea floor behind them, so that what opens there is sea floor.
fn continents(east_m: f64) -> Rock {
    if east_m.abs() < 600e3 { land() } else { ocean() }
}

fn assert_books_close(run: &Simulation) {
    let books = run.books;
    let expected = books.start_m3 + books.made_m3 - books.sunk_m3;
    let moved = books.made_m3 + books.sunk_m3 + added_m3(run);
    assert!((run.crust_m3() - expected).abs() < 1e-6 * moved, "{} of {moved}", run.crust_m3() - expected);
}

/// Thickness that collision and accretion put on all cells, m³.
fn added_m3(run: &Simulation) -> f64 {
    run.plates.iter().flat_map(cells).map(|(_, rock)| rock.added_m as f64).sum::<f64>() * AREA_M2
}

fn land_cells(run: &Simulation) -> usize {
    run.plates.iter().flat_map(cells).filter(|(_, rock)| rock.kind > 0.5).count()
}

#[test]
fn what_collides_is_thickened_by_what_overlaps() {
    let start = simulation([EAST * 0.4, -EAST * 0.4], rules(5.0), continents);
    let before = land_cells(&start);
    let run = run(start);
    assert_books_close(&run);
    assert_eq!(run.books.sunk_m3, 0.0, "continents don't sink");
    // Every lost cell's own crust is on top of another one, or still waiting for its place.
    let lost_m3 = (before - land_cells(&run)) as f64 * AREA_M2 * LAND_M as f64;
    let thickened_m3 = added_m3(&run) + run.books.pending_m3;
    assert!((thickened_m3 / lost_m3 - 1.0).abs() < 1e-6, "{thickened_m3} of {lost_m3}");
    assert!(run.books.pending_m3 < 0.2 * lost_m3, "{} of {lost_m3} waits", run.books.pending_m3);
    // An overlap is exchanged once it is three cells wide, so up to that much is still doubled.
    let overlap_m2 = run.closings[0].closed_m * 2_000e3;
    let doubled_m2 = overlap_m2 - lost_m3 / LAND_M as f64;
    assert!(doubled_m2.abs() < 3.0 * CELL_M * 2_000e3, "{doubled_m2} of {overlap_m2}");
}

#[test]
fn two_parting_plates_leave_a_floor_of_the_right_age_and_depth() {
    let (myr, speed) = (10.0, 0.3);
    let run = run(simulation([EAST * -speed, EAST * speed], rules(myr), |_| ocean()));
    assert_books_close(&run);
    let m_per_myr = speed * KM_PER_MYR * 1e3;
    let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0.0);
    for plate in &run.plates {
        // Clear of the square's own north and south rims.
        for (cell, rock) in cells(plate).filter(|(_, rock)| rock.born_myr > 0.0) {
            let error_m = east_m(plate.center_m(cell)).abs() - m_per_myr * (run.time_myr - rock.born_myr as f64);
            (sum, worst, count) = (sum + error_m, worst.max(error_m.abs()), count + 1.0);
        }
    }
    // The whole strip is new floor but for the last gap, which is too narrow to be filled.
    let strip = 2.0 * m_per_myr * run.time_myr * 2_000e3 / AREA_M2;
    assert!((count - strip).abs() < 4.0 * CELL_M * 2_000e3 / AREA_M2, "{count} new cells of {strip}");
    // Gaps are filled three cells at a time, which then have one age.
    assert!((sum / count).abs() < 1.5 * CELL_M, "mean error {}", sum / count);
    assert!(worst < 3.0 * CELL_M, "worst error {worst}");
    assert_depth_follows_age(&run, 0.8 * m_per_myr * myr);
}

/// Mean depths of strips of floor up to `reach_m` from the ridge, on either side.
fn assert_depth_follows_age(run: &Simulation, reach_m: f64) {
    const STRIP_M: f64 = 30e3;
    let map = Grid::new(400, 400, 2_000e3, Edges::Open);
    let params = PlatesParams { ruggedness: 0.0, belt_km: 20.0, bend: 0.0, ..PlatesParams::default() };
    let warp = Warp::new(run.domain.map_m, 0.0, Key::new(1));
    let window = Surface::window(&run.domain, &params, &warp);
    let layers = Surface::of(run, &params, window).read(&warp, &Detail::new(map, &params, 0.0, Key::new(1)));
    let layer = |wanted: Layer| &layers.iter().find(|(layer, _)| *layer == wanted).unwrap().1;
    let (ground, age) = (layer(Layer::Bedrock), layer(Layer::CrustAge));
    // The stiff plate rounds the cusp at the ridge off, so the first strip is left out. Ages come in bands as wide as the
    // gaps that were filled, which a strip averages out.
    for strip in 1..(reach_m / STRIP_M) as usize {
        for side in [-1.0, 1.0] {
            let (mut depth, mut law) = (0.0, 0.0);
            let inside = |x: &usize| (side * east_m(map.center_m(*x, 0).into()) / STRIP_M).floor() == strip as f64;
            for (x, y) in (0..400).filter(inside).flat_map(|x| (0..400).map(move |y| (x, y))) {
                depth -= ground.at(x, y) as f64;
                law += 2500.0 + 350.0 * (age.at(x, y) as f64).sqrt();
            }
            assert!(law > 0.0 && (depth / law - 1.0).abs() < 0.01, "strip {strip}, {side}: {}", depth / law);
        }
    }
}

/// Mean of a part of the rock by distance inland of the trench, on the plate that overrides; 5 km a bin.
fn inland_profile(run: &Simulation, part: impl Fn(&Rock) -> f32) -> Vec<f64> {
    let over = &run.plates[1];
    let trench_m = over.pose.to_map(DVec2::new(-8.0 * 50e3, 0.0)).x;
    let mut sums = vec![0.0; 100];
    for (cell, rock) in cells(over) {
        let bin = ((over.center_m(cell).x - trench_m) / CELL_M).floor();
        if (0.0..100.0).contains(&bin) {
            sums[bin as usize] += part(rock) as f64 / 400.0;
        }
    }
    sums
}

fn mean_place_m(profile: &[f64]) -> f64 {
    let whole: f64 = profile.iter().sum();
    profile.iter().enumerate().map(|(i, v)| v * (i as f64 + 0.5) * CELL_M).sum::<f64>() / whole
}

#[test]
fn arcs_stand_inland_of_the_trench_where_they_should() {
    for arc_m in [110e3, 180e3] {
        let rules = rules(6.0);
        let rules = Rules { arc: Arc { offset_m: arc_m, ..rules.arc }, ..rules };
        let (spacing_m, half_width_m) = (rules.arc.spacing_m, rules.belt.half_width_m);
        let rock = |east_m: f64| if east_m > 0.0 { land() } else { ocean() };
        let run = run(simulation([EAST * 0.4, DVec2::ZERO], rules, rock));
        assert_books_close(&run);
        assert!(run.books.sunk_m3 > 0.0);
        let cones = inland_profile(&run, |rock| rock.edifice_m);
        // About 40 sites, each within a quarter of a spacing of the line: their mean is good to 1.4 km.
        assert!((mean_place_m(&cones) - arc_m).abs() < CELL_M, "{arc_m}: volcanoes at {}", mean_place_m(&cones));
        // The line that the table `arcs` shows is that of the last step, at most a cell on from where it raised them.
        let trench_m = run.plates[1].pose.to_map(DVec2::new(-8.0 * 50e3, 0.0)).x;
        let points = run.arc_points();
        assert!(points.len() > 40 && points.iter().all(|(_, at)| (at.x - trench_m - arc_m).abs() < 2.0 * CELL_M));
        // Volcanoes stand within a quarter of a spacing of it.
        let volcanoes = run.volcanoes();
        let near = |at: &DVec2| (at.x - trench_m - arc_m).abs() < spacing_m / 4.0 + 2.0 * CELL_M;
        assert!(volcanoes.len() > 10 && volcanoes.iter().all(near), "{volcanoes:?}");
        // A cone's Voronoi cell seldom reaches farther than three of its half widths from its site.
        let reach_m = spacing_m / 4.0 + CELL_M + 3.0 * 0.12 * spacing_m;
        let outside: f64 =
            (0..100).filter(|&i| ((i as f64 + 0.5) * CELL_M - arc_m).abs() > reach_m).map(|i| cones[i]).sum();
        assert!(outside < 0.01 * cones.iter().sum::<f64>(), "{arc_m}: {outside} outside");
        let ridge = inland_profile(&run, |rock| rock.added_m);
        let crest = (0..100).max_by(|&a, &b| ridge[a].total_cmp(&ridge[b])).unwrap();
        let crest_m = (crest as f64 + 0.5) * CELL_M;
        assert!((crest_m - arc_m).abs() < half_width_m, "{arc_m}: crest at {crest_m}");
        // What is accreted has a side: nothing to speak of on the plate that sinks.
        let under: f64 = cells(&run.plates[0]).map(|(_, rock)| rock.added_m as f64).sum();
        assert!(under * AREA_M2 < 0.01 * added_m3(&run));
    }
}

/// Largest and mean change of height by isostasy in the middle of the map, m.
fn change_m(run: &Simulation) -> (f64, f64) {
    let middle = |at_m: DVec2| (at_m.y - 1_000e3).abs() < 400e3 && east_m(at_m).abs() < 300e3;
    let start = crust::height_m(LAND_M as f64, 1.0, 500.0);
    let changes: Vec<f64> = run
        .plates
        .iter()
        .flat_map(|plate| cells(plate).filter(|(cell, _)| middle(plate.center_m(*cell))))
        .map(|(_, rock)| (crust::height_m(rock.thickness_m(), rock.kind as f64, 500.0) - start).abs())
        .collect();
    (changes.iter().fold(0.0, |a: f64, &b| a.max(b)), changes.iter().sum::<f64>() / changes.len() as f64)
}

#[test]
fn plates_that_slide_raise_nothing() {
    let grown = |west: DVec2| change_m(&run(simulation([west, -west], rules(5.0), continents)));
    let (convergent_most, convergent_mean) = grown(EAST * 0.4);
    let (shear_most, shear_mean) = grown(DVec2::Y * 0.4);
    assert!(convergent_most > 1_000.0, "{convergent_most}");
    assert!(shear_most < 0.01 * convergent_most, "{shear_most} of {convergent_most}");
    assert!(shear_mean < 0.01 * convergent_mean, "{shear_mean} of {convergent_mean}");
}
