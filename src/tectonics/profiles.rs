//! Shapes that borders press into the ground beside them: trenches, forelands, rifts and valleys along faults.

use crate::grid::{Field, for_each_row, nearest_within};

use super::{
    border::BorderCell, params::PlatesParams, plate::Rock, simulation::Simulation, stretch::Meeting, window::Window,
};

/// No border.
const NOWHERE: u32 = u32::MAX;

/// Shapes that borders press into the ground beside them, m.
pub fn profiles<'a>(
    run: &Simulation,
    params: &PlatesParams,
    borders: &[BorderCell],
    window: &Window,
    ground: impl Fn(usize) -> (u8, &'a Rock) + Sync,
) -> Field<f32> {
    let square = run.domain.grid();
    let mut shape = Field::filled(window.grid, 0.0f32);
    let belt_m = params.belt_km * 1e3;
    for meeting in [Meeting::Subduction, Meeting::Collision, Meeting::Spreading, Meeting::Transform] {
        // The border at each cell, as its place in the list.
        let mut at = vec![NOWHERE; square.cells()];
        for (place, border) in borders.iter().enumerate().filter(|(_, border)| border.meeting == meeting) {
            at[border.cell] = place as u32;
        }
        if at.iter().all(|&place| place == NOWHERE) {
            continue;
        }
        let reach_m = reach_m(meeting, belt_m);
        let near = nearest_within(square, reach_m, |i| at[i] != NOWHERE);
        for_each_row(&mut shape.data, window.grid.width, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                let i = window.cell(x, y);
                let d = near.distance_m.data[i] as f64;
                if d > reach_m {
                    continue;
                }
                let border = &borders[at[near.index.data[i] as usize] as usize];
                // How long this border has been at work: full after 40 km.
                let moved = border.speed_m_per_yr * run.time_myr * 1e6;
                let strength = (moved / 40e3).min(1.0);
                let (plate, rock) = ground(window.grid.index(x, y));
                let under = plate as usize == border.under;
                *value += (strength * profile(meeting, d, under, rock, params, belt_m)) as f32;
            }
        });
    }
    shape
}

/// Distance beyond which a profile is less than a millimetre, m.
fn reach_m(meeting: Meeting, belt_m: f64) -> f64 {
    match meeting {
        Meeting::Subduction => 290e3,
        Meeting::Collision => 4.5 * belt_m,
        Meeting::Spreading => 140e3,
        Meeting::Transform => 30e3,
    }
}

fn profile(meeting: Meeting, d: f64, under: bool, rock: &Rock, params: &PlatesParams, belt_m: f64) -> f64 {
    // Less than a part in a thousand million is not worth an exponential.
    let bell = |x: f64, width: f64| if x.abs() > 4.6 * width { 0.0 } else { libm::exp(-(x / width) * (x / width)) };
    let land = rock.kind as f64;
    match meeting {
        // Trench with a steep inner and a gentle outer wall, then the outer rise.
        Meeting::Subduction if under => {
            (1.0 - land) * (350.0 * bell(d - 110e3, 45e3) - params.trench_m * bell(d, 38e3))
        }
        Meeting::Subduction => -0.8 * params.trench_m * bell(d, 16e3),
        // The foreland bends down under the range's weight, a belt's width before its front.
        Meeting::Collision if under => -550.0 * land * bell(d - 1.3 * belt_m, 0.8 * belt_m),
        Meeting::Collision => 0.0,
        // Graben and shoulders, in continents only: sea floor has its ridge from its age.
        Meeting::Spreading => land * (900.0 * bell(d - 42e3, 24e3) - 1300.0 * bell(d, 20e3)),
        // A valley along the fault.
        Meeting::Transform => -200.0 * bell(d, 7e3),
    }
}
