//! The sheet itself: molten depth and heat on cells, stepped in time.
//!
//! Its raster is a torus. A map that does not wrap has a ring of cells around it: where its rim is open the ground goes on as
//! it falls, and what comes there is gone; where it is closed they are walls.

use super::{
    faces::{FILM_M, Side, face, tilt},
    law::Law,
    rows::Rows,
    solve::Solver,
};
use crate::grid::{Edges, Grid};

/// Share of a cell's lava, at most, that leaves it in a step.
const GIVE: f64 = 1.0 / 3.0;
/// Greatest `Δt Σ m/l²` of a cell at which surfaces need not be solved for.
const FOLLOWED: f64 = 0.5;
/// Share of a vent's depth by which it may rise in a step.
const RISE: f64 = 0.1;
/// Height of the walls around a closed map, m.
const WALL_M: f64 = 1e9;

/// What happened to the lava, summed over the map: m·cells, and m·J/kg·cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Books {
    /// Came out of vents.
    pub(super) erupted: f64,
    /// Left over the rim.
    pub(super) left: f64,
    /// Froze.
    pub(super) frozen: f64,
    /// Heat that came with what came out, left over the rim, and left with what froze.
    pub(super) heat_in: f64,
    pub(super) heat_left: f64,
    pub(super) heat_frozen: f64,
    /// Heat that air, sea and ground took.
    pub(super) heat_lost: f64,
}

/// Lava on a map.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) rows: Rows,
    pub(super) cell_m: f64,
    /// Cells of the ring around the map: 1, or 0 where it wraps.
    ring: usize,
    pub(super) sea_m: f64,
    /// Top of the ground, m.
    pub(super) bed: Vec<f64>,
    /// Depth of what flows, m.
    pub(super) molten: Vec<f64>,
    /// Its enthalpy, m·J/kg.
    pub(super) heat: Vec<f64>,
    /// What has frozen, m.
    pub(super) frozen: Vec<f64>,
    pub(super) books: Books,
    sides: Vec<Side>,
    /// Flux over a cell's east and south faces, m²/s, and its derivative by the slope, m²/s.
    flux: Vec<[f64; 2]>,
    ease: Vec<[f64; 2]>,
    /// Share of what wants to leave a cell that can; then what froze of it in the step, m.
    pub(super) share: Vec<f64>,
    solver: Solver,
    spare: [Vec<f64>; 2],
}

/// What comes out of a cell in a second, m.
pub(super) type Source<'a> = &'a [(usize, f64)];

impl Sheet {
    /// A map without lava; `bed` is the height of the ground, row by row.
    pub(super) fn new(grid: &Grid, bed: impl Fn(usize, usize) -> f64 + Sync + Send, sea_m: f64) -> Self {
        let ring = usize::from(grid.edges != Edges::Wrap);
        let (w, h) = (grid.width + 2 * ring, grid.height + 2 * ring);
        let zero = || vec![0.0; w * h];
        let mut sheet = Self {
            rows: Rows::new(w, h, std::iter::empty()),
            cell_m: grid.cell_m,
            ring,
            sea_m,
            bed: zero(),
            molten: zero(),
            heat: zero(),
            frozen: zero(),
            books: Books::default(),
            sides: vec![Side::default(); w * h],
            flux: vec![[0.0; 2]; w * h],
            ease: vec![[0.0; 2]; w * h],
            share: zero(),
            solver: Solver::new(w * h),
            spare: [zero(), zero()],
        };
        let inner = |at: usize, size: usize| at.clamp(ring, size - 1 - ring) - ring;
        // A cell further in, for the fall towards the rim.
        let next = |at: usize, size: usize| match at {
            0 if ring > 0 => 1.min(size - 1 - 2 * ring),
            at if at + 1 == size && ring > 0 => (size - 1 - 2 * ring).saturating_sub(1),
            at => at - ring,
        };
        crate::grid::map_cells(&mut sheet.bed, w, |x, y| {
            let (ix, iy) = (inner(x, w), inner(y, h));
            let here = bed(ix, iy);
            let outside = ix + ring != x || iy + ring != y;
            match grid.edges {
                Edges::Closed if outside => WALL_M,
                Edges::Open if outside => here.min(2.0 * here - bed(next(x, w), next(y, h))),
                _ => here,
            }
        });
        sheet
    }

    /// The sheet's cell of a map's cell.
    pub(super) fn cell(&self, grid: &Grid, i: usize) -> usize {
        let (x, y) = grid.cell_of(i);
        (y + self.ring) * self.rows.width + x + self.ring
    }

    /// Puts lava on cells: cell, depth in m, and heat in m·J/kg. Cells that will be fed are put as well, with nothing.
    pub(super) fn put(&mut self, cells: &[(usize, f64, f64)]) {
        for &(i, depth, heat) in cells {
            (self.molten[i], self.heat[i]) = (self.molten[i] + depth, self.heat[i] + heat);
        }
        self.rows = Rows::new(self.rows.width, self.rows.height, cells.iter().map(|cell| cell.0));
    }

    /// One step in time, at most so long, while this comes out; returns how long, s.
    pub(super) fn advance(&mut self, law: &Law, source: Source, most_s: f64) -> f64 {
        let molten = &self.molten;
        self.rows.grow(|i| molten[i] > 0.0);
        self.look(law);
        self.fluxes(law);
        let dt = self.limit_s(law, source).min(most_s);
        let stiff = self.pour(law, source, dt);
        if stiff {
            self.solve(source, dt);
        }
        self.carry(dt);
        self.drain();
        self.cool(law, dt);
        dt
    }

    /// Notes how every cell looks to its faces.
    fn look(&mut self, law: &Law) {
        let Self { rows, bed, molten, heat, sides, .. } = self;
        rows.each(sides, |x, y, side| {
            let i = y * rows.width + x;
            let flow = if molten[i] > 0.0 { law.flow(heat[i] / molten[i]) } else { Default::default() };
            let [west, east, north, south] = rows.around(x, y).map(|there| molten[there]);
            let tilt = [tilt(west, molten[i], east), tilt(north, molten[i], south)];
            *side = Side { bed: bed[i], surface: bed[i] + molten[i], flow, tilt };
        });
    }

    fn fluxes(&mut self, law: &Law) {
        let Self { rows, sides, flux, ease, cell_m, .. } = self;
        // What has not been looked at is dry: its bed.
        let side = |i: usize| -> Side { sides[i] };
        rows.each_two((flux, ease), |x, y, flux, ease| {
            let i = y * rows.width + x;
            let [west, east, north, south] = rows.around(x, y);
            let here = side(i);
            let (mut fluxes, mut eases) = ([0.0; 2], [0.0; 2]);
            for (axis, there) in [east, south].into_iter().enumerate() {
                let far = side(there);
                if here.flow.fluidity == 0.0 && far.flow.fluidity == 0.0 {
                    continue;
                }
                let (tx, ty) = (there % rows.width, there / rows.width);
                let around = rows.around(tx, ty);
                let [a, b, c, d] =
                    if axis == 0 { [north, south, around[2], around[3]] } else { [west, east, around[0], around[1]] };
                let felt = |k: usize, from: &Side| sides[k].felt_from(from.surface);
                let turn = felt(a, &here) - felt(b, &here) + felt(c, &far) - felt(d, &far);
                [fluxes[axis], eases[axis]] = face(law, [&here, &far], axis, 0.25 * turn / *cell_m, *cell_m);
            }
            (*flux, *ease) = (fluxes, eases);
            0.0
        });
    }

    /// The longest step in which no cell gives too much and no vent rises too high, s.
    fn limit_s(&self, law: &Law, source: Source) -> f64 {
        let Self { rows, flux, molten, cell_m, .. } = self;
        let haste = rows.max(|x, y| {
            let i = y * rows.width + x;
            if molten[i] < FILM_M { 0.0 } else { self.leaving(flux, x, y) / (molten[i] * cell_m) }
        });
        let flow = if haste > 0.0 { GIVE / haste } else { f64::INFINITY };
        let fill = |&(i, rise): &(usize, f64)| law.pile_m(rise, *cell_m).max(RISE * molten[i]) / rise;
        source.iter().filter(|(_, rise)| *rise > 0.0).map(fill).fold(flow, f64::min)
    }

    /// What wants to leave a cell, m²/s.
    #[inline(always)]
    fn leaving(&self, flux: &[[f64; 2]], x: usize, y: usize) -> f64 {
        let i = y * self.rows.width + x;
        let [west, _, north, _] = self.rows.around(x, y);
        flux[i][0].max(0.0) + flux[i][1].max(0.0) + (-flux[west][0]).max(0.0) + (-flux[north][1]).max(0.0)
    }

    /// Lets lava out of the vents; whether the surface has to be solved for.
    fn pour(&mut self, law: &Law, source: Source, dt: f64) -> bool {
        for &(i, rise) in source {
            self.molten[i] += rise * dt;
            self.heat[i] += rise * dt * law.fresh;
            self.books.erupted += rise * dt;
            self.books.heat_in += rise * dt * law.fresh;
        }
        let Self { rows, ease, cell_m, .. } = self;
        let stiff = rows.max(|x, y| {
            let i = y * rows.width + x;
            let [west, _, north, _] = rows.around(x, y);
            ease[i][0] + ease[i][1] + ease[west][0] + ease[north][1]
        });
        stiff * dt / (*cell_m * *cell_m) > FOLLOWED
    }

    /// Fluxes as they are at the step's end.
    fn solve(&mut self, source: Source, dt: f64) {
        let Self { rows, flux, ease, cell_m, solver, .. } = self;
        rows.each(&mut solver.error, |x, y, error| {
            let i = y * rows.width + x;
            let [west, _, north, _] = rows.around(x, y);
            *error = (flux[west][0] - flux[i][0] + flux[north][1] - flux[i][1]) * dt / *cell_m;
        });
        for &(i, rise) in source {
            solver.error[i] += rise * dt;
        }
        solver.run(rows, ease, dt / (*cell_m * *cell_m));
        let change = &solver.change;
        rows.each(flux, |x, y, flux| {
            let i = y * rows.width + x;
            let [_, east, _, south] = rows.around(x, y);
            flux[0] += ease[i][0] * (change[i] - change[east]) / *cell_m;
            flux[1] += ease[i][1] * (change[i] - change[south]) / *cell_m;
        });
    }

    /// Moves lava and its heat over the faces: from each donor as much as it has.
    fn carry(&mut self, dt: f64) {
        let mut share = std::mem::take(&mut self.share);
        let pace = dt / self.cell_m;
        self.rows.each(&mut share, |x, y, share| {
            let wanted = self.leaving(&self.flux, x, y) * pace;
            let there = self.molten[y * self.rows.width + x];
            *share = if wanted > there { there / wanted } else { 1.0 };
        });
        let [mut molten, mut heat] = std::mem::take(&mut self.spare);
        let Self { rows, flux, .. } = &*self;
        rows.each_two((&mut molten, &mut heat), |x, y, new, new_heat| {
            let i = y * rows.width + x;
            let [west, east, north, south] = rows.around(x, y);
            // Into the cell: positive from the west and the north, negative from the east and the south.
            let faces = [(flux[west][0], west), (-flux[i][0], east), (flux[north][1], north), (-flux[i][1], south)];
            let (mut depth, mut warmth) = (0.0, 0.0);
            let own = if self.molten[i] > 0.0 { self.heat[i] / self.molten[i] } else { 0.0 };
            for (into, there) in faces {
                if into > 0.0 {
                    let moved = into * share[there] * pace;
                    depth += moved;
                    warmth +=
                        if self.molten[there] > 0.0 { moved * (self.heat[there] / self.molten[there]) } else { 0.0 };
                } else {
                    let moved = into * share[i] * pace;
                    depth += moved;
                    warmth += moved * own;
                }
            }
            let left = self.molten[i] + depth;
            // Rounding may leave less than nothing of a cell that gave all.
            (*new, *new_heat) = if left > 1e-15 * self.molten[i] { (left, self.heat[i] + warmth) } else { (0.0, 0.0) };
            0.0
        });
        std::mem::swap(&mut self.molten, &mut molten);
        std::mem::swap(&mut self.heat, &mut heat);
        self.spare = [molten, heat];
        self.share = share;
    }

    /// Takes out what has come over the rim.
    fn drain(&mut self) {
        if self.ring == 0 {
            return;
        }
        let (w, h) = (self.rows.width, self.rows.height);
        let Self { rows, molten, heat, books, .. } = self;
        for y in (0..h).filter(|&y| !rows.span(y).is_empty()) {
            let inside = y > 0 && y + 1 < h;
            for x in rows.span(y).filter(|&x| !inside || x == 0 || x + 1 == w) {
                let i = y * w + x;
                books.left += std::mem::take(&mut molten[i]);
                books.heat_left += std::mem::take(&mut heat[i]);
            }
        }
    }
}
