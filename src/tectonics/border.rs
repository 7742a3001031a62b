//! Borders as the tectonic raster shows them: which cells lie on one, what the plates do there, how far it is to each kind.

use glam::DVec2;
use rayon::prelude::*;

use super::{
    contact::{Motion, classify},
    simulation::Simulation,
    stretch::{Meeting, meeting},
};

/// Half width of the window from which a border cell's normal is taken, cells.
const WINDOW: isize = 6;

/// A cell on a border.
#[derive(Clone, Copy, Debug)]
pub struct BorderCell {
    /// Row-major index.
    pub cell: usize,
    /// The plate below, or simply the other one where none is.
    pub under: usize,
    /// What happens.
    pub meeting: Meeting,
    /// Speed that matters there: across the border, or along a transform, m/yr.
    pub speed_m_per_yr: f64,
}

/// Every cell whose eastern or southern neighbour belongs to another plate, in cell order.
///
/// `owner` has a plate everywhere: along a spreading border the plates themselves are a crack apart.
pub fn border_cells(run: &Simulation, owner: &[u8]) -> Vec<BorderCell> {
    let n = run.domain.cells;
    let row = |y: usize| {
        (0..n - 1).filter_map(move |x| {
            let a = owner[y * n + x];
            let b = [owner[y * n + x + 1], owner[(y + 1) * n + x]].into_iter().find(|&b| b != a)?;
            border_cell(run, owner, [x, y], [a as usize, b as usize])
        })
    };
    (0..n - 1).into_par_iter().flat_map_iter(row).collect()
}

fn border_cell(run: &Simulation, owner: &[u8], [x, y]: [usize; 2], [a, b]: [usize; 2]) -> Option<BorderCell> {
    let n = run.domain.cells as isize;
    let mut across = DVec2::ZERO;
    for dy in -WINDOW..=WINDOW {
        for dx in -WINDOW..=WINDOW {
            let (i, j) = (x as isize + dx, y as isize + dy);
            if i < 0 || j < 0 || i >= n || j >= n || dx * dx + dy * dy > WINDOW * WINDOW {
                continue;
            }
            let owner = owner[(j * n + i) as usize] as usize;
            let offset = DVec2::new(dx as f64, dy as f64);
            if owner == a {
                across -= offset;
            } else if owner == b {
                across += offset;
            }
        }
    }
    let normal = across.try_normalize()?;
    let at_m = run.domain.cell_center_m(x, y);
    let relative = run.engine.velocity_at(a, at_m) - run.engine.velocity_at(b, at_m);
    let cell = y * run.domain.cells + x;
    // Rock a few cells to either side, clear of the ragged rim.
    let aside = normal * (3.0 * run.domain.cell_m());
    let rock = |plate: usize, at: DVec2| run.plates[plate].owned_under(at).map(|i| run.plates[plate].rock[i]);
    let (_, under, meeting) = match classify(relative, normal) {
        Motion::Quiet => return None,
        Motion::Divergent => (a, b, Meeting::Spreading),
        Motion::Transform => (a, b, Meeting::Transform),
        Motion::Convergent => meeting((a, &rock(a, at_m - aside)?), (b, &rock(b, at_m + aside)?), &run.polarity),
    };
    let speed_m_per_yr = if meeting == Meeting::Transform { relative.length() } else { relative.dot(normal).abs() };
    Some(BorderCell { cell, under, meeting, speed_m_per_yr })
}
