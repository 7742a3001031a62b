//! What a large run will cost, found by running it small.

use std::{sync::atomic::AtomicBool, time::Instant};

use crate::recipe::Plan;

use super::{JobError, grow::run};

/// Cells from which on a run is announced: 4096 x 4096.
const LARGE_CELLS: f64 = 4096.0 * 4096.0;
/// Longer sides of the two trial runs.
const TRIALS: [usize; 2] = [128, 256];
/// Seconds a million cells that storing and drawing take on two cores.
const WRITING_S_PER_MCELL: f64 = 0.35;
/// Fields of a map's size that solvers, checkpoints and writers hold besides the layers, at their peak: 19 were measured for
/// `pipes` at 8192 x 8192, 40 for carved plates at 1024 x 1024.
const WORKING_FIELDS: usize = 30;

/// Expected cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time.
    pub seconds: f64,
    /// Memory.
    pub bytes: f64,
}

/// The cost of a run, if it is large: a fixed part and a part in proportion to the cells, from two small runs.
pub fn estimate(plan: &Plan, cancel: &AtomicBool) -> Result<Option<Estimate>, JobError> {
    let cells = plan.largest_grid().cells() as f64;
    if cells < LARGE_CELLS {
        return Ok(None);
    }
    let mut seen = Vec::new();
    let mut fields = WORKING_FIELDS;
    for side in TRIALS {
        let small = plan.shrunk(side);
        let started = Instant::now();
        let (world, _) = run(&small, None, cancel, &mut |_| ())?;
        seen.push((small.largest_grid().cells() as f64, started.elapsed().as_secs_f64()));
        fields = WORKING_FIELDS + world.layers().count();
    }
    Ok(Some(Estimate { seconds: extrapolate(&seen, cells) + writing(cells), bytes: cells * 4.0 * fields as f64 }))
}

fn writing(cells: f64) -> f64 {
    cells * 1e-6 * WRITING_S_PER_MCELL
}

/// The line through two points (cells, seconds), never falling.
fn extrapolate(seen: &[(f64, f64)], cells: f64) -> f64 {
    match seen {
        [(few, short), (many, long)] if many > few => {
            let rate = ((long - short) / (many - few)).max(0.0);
            long + rate * (cells - many)
        }
        _ => seen.last().map_or(0.0, |(n, seconds)| seconds * cells / n),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_continued() {
        assert_eq!(extrapolate(&[(100.0, 2.0), (200.0, 3.0)], 1000.0), 11.0);
        assert_eq!(extrapolate(&[(100.0, 2.0), (200.0, 1.0)], 1000.0), 1.0);
    }
}
