//! Scripted physics: two plates whose meeting has a known outcome.
//!
//! The stage is a square of 2,000 km in 400 cells, halved by a border from north to south. A unit of the engine is 50 km
//! and the plate speed 50 mm/yr, so that an engine second is a million years.

mod carved;
mod crust;
mod motion;
mod painted;

use glam::DVec2;

use crate::{
    grid::{Edges, Grid},
    noise::Key,
};

use super::{
    arc::Arc,
    domain::Domain,
    engine::{Drive, Engine, Settings, Style},
    mantle::Mantle,
    partition::Polygon,
    plate::{Plate, Rock},
    raise::Belt,
    simulation::{Rules, Simulation},
};

const SPEED_MM_PER_YR: f64 = 50.0;
const KM_PER_MYR: f64 = SPEED_MM_PER_YR;
const CELL_M: f64 = 5e3;
/// Continental crust of the scripted plates, m.
const LAND_M: f32 = 35_000.0;

pub(in crate::tectonics) fn domain() -> Domain {
    Domain::around(&Grid::new(64, 64, 2_000e3, Edges::Open), 1.0, 400)
}

pub(in crate::tectonics) fn settings() -> Settings {
    Settings { speed_mm_per_yr: SPEED_MM_PER_YR, resistance: 0.0, slab_pull: 0.0, style: Style::Overriding }
}

/// Two bodies that touch along x = 0, clear of the beams by a few units.
pub(in crate::tectonics) fn halves() -> [Polygon; 2] {
    let body = |x: [f64; 2]| {
        vec![DVec2::new(x[0], -17.0), DVec2::new(x[1], -17.0), DVec2::new(x[1], 17.0), DVec2::new(x[0], 17.0)]
    };
    [body([-16.0, 0.0]), body([0.0, 16.0])]
}

/// The western and the eastern half, each driven by a velocity of its own in units of the plate speed.
pub(in crate::tectonics) fn pair(drives: [DVec2; 2], settings: Settings) -> Engine {
    let still = Mantle::new(0.0, Key::new(0));
    Engine::new(domain(), &halves(), drives.map(Drive::Own).to_vec(), still, settings).unwrap()
}

fn land() -> Rock {
    Rock { crust_m: LAND_M, kind: 1.0, born_myr: -500.0, ..Rock::default() }
}

fn ocean() -> Rock {
    Rock { crust_m: crate::crust::OCEAN_THICKNESS_M as f32, born_myr: -60.0, ..Rock::default() }
}

fn rules(duration_myr: f64) -> Rules {
    Rules {
        belt: Belt { half_width_m: 45e3, octaves: 3, gain: 0.6, thickest_m: 70e3 },
        arc: Arc { offset_m: 150e3, spacing_m: 60e3 },
        accretion_m: 10e3,
        volcano_m_per_myr: 200.0,
        speed_m_per_yr: SPEED_MM_PER_YR * 1e-3,
        fastest_m_per_yr: SPEED_MM_PER_YR * 1e-3,
        duration_myr,
        steps: None,
    }
}

/// A run of two halves that own the whole square; `rock` is given the distance from their border to the east, m.
fn simulation(drives: [DVec2; 2], rules: Rules, rock: impl Fn(f64) -> Rock) -> Simulation {
    let domain = domain();
    let engine = pair(drives, settings());
    let half = domain.cells / 2;
    let plates = (0..2)
        .map(|p| {
            let own = |x: usize, _: usize| usize::from(x >= half) == p;
            let rock = |x: usize, y: usize| rock(east_m(domain.cell_center_m(x, y)));
            Plate::new(&domain, engine.pose(p), 2e6, own, rock)
        })
        .collect();
    Simulation::new(domain, plates, engine, rules, Key::new(5))
}

fn run(mut simulation: Simulation) -> Simulation {
    for _ in 0..simulation.steps() {
        simulation.advance();
    }
    simulation
}

/// Distance of a point of the map from the first border, to the east, m.
fn east_m(at_m: DVec2) -> f64 {
    at_m.x - 1_000e3
}

/// Owned cells of a plate.
fn cells(plate: &Plate) -> impl Iterator<Item = (usize, &Rock)> {
    plate.rock.iter().enumerate().filter(|&(cell, _)| plate.owned[cell])
}
