//! The plates as tables: one row a plate, one row a corner of their outlines.

use glam::DVec2;

use crate::world::{Table, Vent};

use super::{simulation::Simulation, warp::Warp};

/// Motion of a plate at its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Speed, mm/yr.
    pub speed_mm_per_yr: f64,
    /// Compass direction, 0 north, 90 east, deg.
    pub heading_deg: f64,
}

impl Drift {
    /// From a velocity in m/yr, x to the east and y to the south.
    pub fn of(velocity_m_per_yr: DVec2) -> Self {
        let heading = libm::atan2(velocity_m_per_yr.x, -velocity_m_per_yr.y).to_degrees();
        Self { speed_mm_per_yr: velocity_m_per_yr.length() * 1e3, heading_deg: heading.rem_euclid(360.0) }
    }
}

/// Middle and area (m²) of a plate's ground, and the continental share of it.
pub fn middle(run: &Simulation, plate: usize) -> (DVec2, f64, f64) {
    let ground = &run.plates[plate];
    let (mut sum, mut land, mut count) = (DVec2::ZERO, 0.0, 0.0);
    for i in (0..ground.owned.len()).filter(|&i| ground.owned[i]) {
        sum += ground.frame.center_m(i);
        land += ground.rock[i].kind as f64;
        count += 1.0;
    }
    if count == 0.0 {
        return (ground.pose.at_m, 0.0, 0.0);
    }
    let area = ground.frame.cell_m * ground.frame.cell_m;
    (ground.pose.to_map(sum / count), count * area, land / count)
}

/// The table `plates`: where each plate is shown on the map, how it moves now and how it began to move.
pub fn plates(run: &Simulation, warp: &Warp, first: &[Drift]) -> Table {
    let rows: Vec<_> = (0..run.plates.len())
        .map(|p| {
            let (at_m, area_m2, land) = middle(run, p);
            (warp.shown_at(at_m), area_m2, land, Drift::of(run.engine.velocity_at(p, at_m)))
        })
        .collect();
    let numbers = |f: &dyn Fn(usize) -> f64| (0..rows.len()).map(f).collect::<Vec<_>>();
    let crust = |land: f64| {
        if land > 0.7 {
            "continental"
        } else if land < 0.3 {
            "oceanic"
        } else {
            "mixed"
        }
    };
    Table::new("plates")
        .number("id", "1", numbers(&|p| p as f64))
        .number("x_km", "km", numbers(&|p| rows[p].0.x * 1e-3))
        .number("y_km", "km", numbers(&|p| rows[p].0.y * 1e-3))
        .number("area_km2", "km2", numbers(&|p| rows[p].1 * 1e-6))
        .number("continental_share", "1", numbers(&|p| rows[p].2))
        .text("crust", rows.iter().map(|r| crust(r.2).to_owned()).collect())
        .number("speed_mm_per_yr", "mm/yr", numbers(&|p| rows[p].3.speed_mm_per_yr))
        .number("heading_deg", "deg", numbers(&|p| rows[p].3.heading_deg))
        .number("first_speed_mm_per_yr", "mm/yr", numbers(&|p| first[p].speed_mm_per_yr))
        .number("first_heading_deg", "deg", numbers(&|p| first[p].heading_deg))
}

/// The table `convergence`: what each pair of plates that touched closed (negative: opened), km.
pub fn convergence(run: &Simulation) -> Table {
    let numbers = |f: &dyn Fn(usize) -> f64| (0..run.closings.len()).map(f).collect::<Vec<_>>();
    Table::new("convergence")
        .number("plate_a", "1", numbers(&|i| run.closings[i].plates[0] as f64))
        .number("plate_b", "1", numbers(&|i| run.closings[i].plates[1] as f64))
        .number("closed_km", "km", numbers(&|i| run.closings[i].closed_m * 1e-3))
}

/// The table `arcs`: points along the lines where volcanoes stand behind a trench, and how fast the plates close there.
pub fn arcs(run: &Simulation, warp: &Warp) -> Table {
    let points: Vec<_> = run.arc_points().into_iter().map(|(stretch, at_m)| (stretch, warp.shown_at(at_m))).collect();
    let numbers = |f: &dyn Fn(usize) -> f64| (0..points.len()).map(f).collect::<Vec<_>>();
    Table::new("arcs")
        .number("plate", "1", numbers(&|i| points[i].0.over as f64))
        .number("x_km", "km", numbers(&|i| points[i].1.x * 1e-3))
        .number("y_km", "km", numbers(&|i| points[i].1.y * 1e-3))
        .number("closing_mm_per_yr", "mm/yr", numbers(&|i| points[i].0.closing_m_per_yr * 1e3))
}

/// Radius of the crater of an arc's volcano, m: small beside the cells of any map of plates.
const CRATER_M: f64 = 400.0;

/// The volcanoes of the arcs of now, as the map shows them.
pub fn vents(run: &Simulation, warp: &Warp) -> Vec<Vent> {
    let vent = |at_m| Vent { at_m: warp.shown_at(at_m).into(), radius_m: CRATER_M, age_yr: 0.0 };
    run.volcanoes().into_iter().map(vent).collect()
}

/// The table `plate_outlines`: the rigid outlines where they are now, as the map shows them.
pub fn outlines(run: &Simulation, warp: &Warp, bodies: &[Vec<DVec2>]) -> Table {
    const PIECES: usize = 12;
    let (mut id, mut x, mut y) = (Vec::new(), Vec::new(), Vec::new());
    for (plate, corners) in bodies.iter().enumerate() {
        for i in 0..corners.len() {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            for piece in 0..PIECES {
                let at_m = run.plates[plate].pose.to_map(a.lerp(b, piece as f64 / PIECES as f64));
                let shown = warp.shown_at(at_m);
                id.push(plate as f64);
                x.push(shown.x * 1e-3);
                y.push(shown.y * 1e-3);
            }
        }
    }
    Table::new("plate_outlines").number("plate", "1", id).number("x_km", "km", x).number("y_km", "km", y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_compass_directions() {
        for (v, heading) in [((0.0, -1.0), 0.0), ((1.0, 0.0), 90.0), ((0.0, 1.0), 180.0), ((-1.0, 0.0), 270.0)] {
            let drift = Drift::of(DVec2::new(v.0, v.1) * 0.02);
            assert!((drift.heading_deg - heading).abs() < 1e-9);
            assert!((drift.speed_mm_per_yr - 20.0).abs() < 1e-9);
        }
    }
}
