//! The surface at a step's end where lava is so deep that following it would take far shorter steps: one Newton step of
//! backward Euler on the fluxes, by conjugate gradients with the diagonal as preconditioner.
//!
//! ```text
//! d + Δt/l² Σ m (d − d') = Δt/l Σ q + risen,   d = change of the surface, m = ∂q/∂S of a face
//! ```

use super::rows::Rows;

/// Error, as a share of the surface's change, at which that is good enough: fluxes keep mass anyway. An error measured by
/// the right-hand side would not do: that is thousands of times what a pond's surface changes by.
const GOOD: f64 = 1e-3;
/// Rounds after which what there is has to do, and between two looks at the error.
const MOST_ROUNDS: usize = 400;
const LOOK: usize = 4;
/// Sum of the errors' squares that nobody sees, m².
const UNSEEN_M2: f64 = 1e-20;

/// What it works with.
#[derive(Clone, Debug)]
pub(super) struct Solver {
    /// Change of the surface, m.
    pub(super) change: Vec<f64>,
    /// What is not yet explained, m: the right-hand side before, the error after.
    pub(super) error: Vec<f64>,
    diagonal: Vec<f64>,
    way: Vec<f64>,
    steep: Vec<f64>,
}

impl Solver {
    pub(super) fn new(cells: usize) -> Self {
        let zero = || vec![0.0; cells];
        Self { change: zero(), error: zero(), diagonal: zero(), way: zero(), steep: zero() }
    }

    /// Solves for `change` with the right-hand side in `error`; `ease` are the east and south faces' derivatives times
    /// `Δt/l²`. Returns the rounds it took.
    pub(super) fn run(&mut self, rows: &Rows, ease: &[[f64; 2]], scale: f64) -> usize {
        let Self { change, error, diagonal, way, steep } = self;
        rows.each(diagonal, |x, y, value| {
            let i = y * rows.width + x;
            let [west, _, north, _] = rows.around(x, y);
            *value = 1.0 + scale * (ease[i][0] + ease[i][1] + ease[west][0] + ease[north][1]);
        });
        rows.each_two((&mut *change, &mut *way), |x, y, change, way| {
            let i = y * rows.width + x;
            (*change, *way) = (0.0, error[i] / diagonal[i]);
            0.0
        });
        let mut rest = rows.sum(way, |x, y, way| *way * error[y * rows.width + x]);
        let mut round = 0;
        while rest > 0.0 && round < MOST_ROUNDS {
            if round % LOOK == 0 && good(rows, change, error) {
                break;
            }
            round += 1;
            let bend = rows.sum(steep, |x, y, steep| {
                let i = y * rows.width + x;
                let [west, east, north, south] = rows.around(x, y);
                let here = way[i];
                let sides = [(ease[i][0], east), (ease[west][0], west), (ease[i][1], south), (ease[north][1], north)];
                let spread: f64 = sides.map(|(ease, there)| ease * (here - way[there])).iter().sum();
                *steep = here + scale * spread;
                here * *steep
            });
            let far = rest / bend;
            let before = rest;
            rest = rows.each_two((&mut *change, &mut *error), |x, y, change, error| {
                let i = y * rows.width + x;
                *change += far * way[i];
                *error -= far * steep[i];
                *error * *error / diagonal[i]
            });
            let turn = rest / before;
            rows.each(way, |x, y, way| {
                let i = y * rows.width + x;
                *way = error[i] / diagonal[i] + turn * *way;
            });
        }
        round
    }
}

/// Whether what is unexplained is little beside the change.
fn good(rows: &Rows, change: &[f64], error: &[f64]) -> bool {
    let excess = |x: usize, y: usize| {
        let i = y * rows.width + x;
        error[i] * error[i] - GOOD * GOOD * change[i] * change[i]
    };
    rows.total(excess) <= UNSEEN_M2
}
