//! One plate's ground in its own coordinates: a raster that moves rigidly, so that nothing smears as the plate drifts.

use glam::DVec2;

use crate::rmp::{Brush, Cell};

use super::{domain::Domain, engine::Pose};

/// The raster of a plate's body frame: cells `(i, j)` have their centres at `corner_m + (i + ½, j + ½)·cell_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Body coordinates of the raster's first corner, m.
    pub corner_m: DVec2,
    /// Cells along the body's x.
    pub width: usize,
    /// Cells along the body's y.
    pub height: usize,
    /// Side of a cell, m.
    pub cell_m: f64,
}

impl Frame {
    /// Body coordinates of a cell's centre, m.
    pub fn center_m(&self, index: usize) -> DVec2 {
        self.middle_m(index % self.width, index / self.width)
    }

    /// Body coordinates of the centre of the cell in a column and a row, m.
    pub fn middle_m(&self, i: usize, j: usize) -> DVec2 {
        self.corner_m + DVec2::new(i as f64 + 0.5, j as f64 + 0.5) * self.cell_m
    }

    /// Body coordinates to cell units.
    pub fn to_cells(self, body: DVec2) -> DVec2 {
        (body - self.corner_m) / self.cell_m
    }

    /// The cell of a column and a row.
    fn cell(&self, x: i64, y: i64) -> Option<usize> {
        let inside = (x as u64) < self.width as u64 && (y as u64) < self.height as u64;
        inside.then(|| y as usize * self.width + x as usize)
    }

    /// The cell that holds a point in cell units.
    pub fn cell_at(&self, at: DVec2) -> Option<usize> {
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < self.width as f64 && at.y < self.height as f64;
        inside.then(|| at.y as usize * self.width + at.x as usize)
    }
}

/// The crust of one cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rock {
    /// Thickness of the crust the cell was born with, stretched since, m.
    pub crust_m: f32,
    /// Thickness that collision and accretion added, m.
    pub added_m: f32,
    /// Height of volcanoes on top, m.
    pub edifice_m: f32,
    /// Thickness that was worn off, less than nothing where more was laid down, m.
    pub worn_m: f32,
    /// Continental share, 0 to 1.
    pub kind: f32,
    /// When the crust was made, My after the run's start (negative: before).
    pub born_myr: f32,
    /// Speed of thickening when it was last noted, smoothed over the last million years, m/My.
    pub rate_m_per_myr: f32,
    /// When that was, My after the run's start.
    pub rated_myr: f32,
}

/// How far back the speed of thickening is smoothed, My.
const RATE_MEMORY_MYR: f32 = 1.0;

impl Rock {
    /// Crust in the column, m.
    pub fn thickness_m(&self) -> f64 {
        self.crust_m as f64 + self.added_m as f64 + self.edifice_m as f64 - self.worn_m as f64
    }

    /// Speed of thickening now, m/My: what was noted has faded since.
    pub fn rate_at(&self, time_myr: f32) -> f32 {
        // Most ground was never thickened, the rest mostly just now, and an exponential is dear.
        if self.rate_m_per_myr == 0.0 || self.rated_myr == time_myr {
            return self.rate_m_per_myr;
        }
        self.rate_m_per_myr * libm::expf((self.rated_myr - time_myr) / RATE_MEMORY_MYR)
    }

    /// Notes a thickening.
    pub fn note_rate(&mut self, gained_m: f32, time_myr: f32) {
        self.rate_m_per_myr = self.rate_at(time_myr) + gained_m / RATE_MEMORY_MYR;
        self.rated_myr = time_myr;
    }
}

/// A plate: where it is, which cells are its own, and what they are made of.
#[derive(Clone, Debug)]
pub struct Plate {
    /// Body frame to map.
    pub pose: Pose,
    /// Its raster.
    pub frame: Frame,
    /// Which cells belong to the plate.
    pub owned: Vec<bool>,
    /// Their rock; default where not owned.
    pub rock: Vec<Rock>,
    /// Cells that it lost below another plate.
    pub spent: Vec<bool>,
    /// First and last + 1 column and row that were ever owned.
    span: [[usize; 2]; 2],
}

impl Plate {
    /// A plate that owns the tectonic cells for which `own(x, y)` holds, with room to grow by `reach_m` on all sides.
    pub fn new(
        domain: &Domain,
        pose: Pose,
        reach_m: f64,
        own: impl Fn(usize, usize) -> bool,
        rock: impl Fn(usize, usize) -> Rock,
    ) -> Self {
        let n = domain.cells;
        let (mut low, mut high) = ([n, n], [0, 0]);
        for y in 0..n {
            for x in 0..n {
                if own(x, y) {
                    low = [low[0].min(x), low[1].min(y)];
                    high = [high[0].max(x + 1), high[1].max(y + 1)];
                }
            }
        }
        // The raster may reach beyond the square: a plate that leaves the rim makes new crust behind it.
        let room = (reach_m / domain.cell_m()).ceil().min(n as f64) as usize;
        let low = low.map(|v| v.min(n - 1));
        let high = [0, 1].map(|axis| high[axis].max(low[axis] + 1));
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis] + 2 * room);
        let corner_cells = DVec2::new(low[0] as f64, low[1] as f64) - room as f64;
        let corner = domain.corner_m + corner_cells * domain.cell_m() - pose.at_m;
        let frame = Frame { corner_m: corner, width, height, cell_m: domain.cell_m() };
        let (owned, rocks) = (vec![false; width * height], vec![Rock::default(); width * height]);
        let mut plate = Self { pose, frame, spent: owned.clone(), owned, rock: rocks, span: [[width, 0], [height, 0]] };
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                if own(x, y) {
                    plate.take((y - low[1] + room) * width + x - low[0] + room, rock(x, y));
                }
            }
        }
        plate
    }

    /// Makes a cell the plate's own.
    pub fn take(&mut self, cell: usize, rock: Rock) {
        self.owned[cell] = true;
        self.rock[cell] = rock;
        for (span, at) in self.span.iter_mut().zip([cell % self.frame.width, cell / self.frame.width]) {
            *span = [span[0].min(at), span[1].max(at + 1)];
        }
    }

    /// Gives a cell up.
    pub fn give(&mut self, cell: usize) -> Rock {
        self.owned[cell] = false;
        self.spent[cell] = true;
        std::mem::take(&mut self.rock[cell])
    }

    /// Columns and rows that may hold owned cells.
    pub fn span(&self) -> [std::ops::Range<usize>; 2] {
        self.span.map(|[from, to]| from.min(to)..to)
    }

    /// The cell under a point of the map, owned or not.
    pub fn cell_under(&self, at_m: DVec2) -> Option<usize> {
        self.frame.cell_at(self.frame.to_cells(self.pose.to_body(at_m)))
    }

    /// The owned cell under a point of the map.
    pub fn owned_under(&self, at_m: DVec2) -> Option<usize> {
        self.cell_under(at_m).filter(|&i| self.owned[i])
    }

    /// Map position of a cell's centre, m.
    pub fn center_m(&self, index: usize) -> DVec2 {
        self.pose.to_map(self.frame.center_m(index))
    }

    /// Rock between cell centres, from the owned ones of the four around; `None` where none is owned.
    pub fn sample(&self, at_m: DVec2, time_myr: f32) -> Option<Rock> {
        let at = self.frame.to_cells(self.pose.to_body(at_m)) - 0.5;
        let base = at.floor();
        let f = at - base;
        let mut sum = [0.0f64; 7];
        let mut weight = 0.0;
        let (x, y) = (base.x as i64, base.y as i64);
        for (dx, dy, w) in
            [(0, 0, (1.0 - f.x) * (1.0 - f.y)), (1, 0, f.x * (1.0 - f.y)), (0, 1, (1.0 - f.x) * f.y), (1, 1, f.x * f.y)]
        {
            let cell = self.frame.cell(x.saturating_add(dx), y.saturating_add(dy));
            let Some(i) = cell.filter(|&i| self.owned[i]) else { continue };
            let r = &self.rock[i];
            for (s, v) in sum.iter_mut().zip([
                r.crust_m,
                r.added_m,
                r.edifice_m,
                r.worn_m,
                r.kind,
                r.born_myr,
                r.rate_at(time_myr),
            ]) {
                *s += w * v as f64;
            }
            weight += w;
        }
        (weight > 1e-9).then(|| {
            let [crust_m, added_m, edifice_m, worn_m, kind, born_myr, rate_m_per_myr] =
                sum.map(|s| (s / weight) as f32);
            Rock { crust_m, added_m, edifice_m, worn_m, kind, born_myr, rate_m_per_myr, rated_myr: time_myr }
        })
    }

    /// The owned cells below a cell of a mosaic, each with the share of it that is covered.
    pub fn cover(&self, mosaic: &Cell, brush: &mut Brush, mut put: impl FnMut(usize, f64)) {
        let frame = &self.frame;
        let outline: Vec<[f64; 2]> =
            mosaic.outline.iter().map(|&v| frame.to_cells(self.pose.to_body(v.into())).into()).collect();
        if !self.owns_any_around(&outline) {
            return;
        }
        brush.cover(&outline, frame.width, frame.height, |x, y, coverage| {
            let index = y * frame.width + x;
            if self.owned[index] {
                put(index, f64::from(coverage));
            }
        });
    }

    /// Whether a cell in the box around an outline is owned: looking is cheaper than covering.
    fn owns_any_around(&self, outline: &[[f64; 2]]) -> bool {
        let [xs, ys] = [0, 1].map(|axis| {
            let (low, high) = outline
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (v[axis].min(low), v[axis].max(high)));
            let span = &self.span[axis];
            (low.max(0.0) as usize).max(span[0])..(high.max(0.0).ceil() as usize).min(span[1])
        });
        let mut rows = ys.map(|y| y * self.frame.width);
        !xs.is_empty() && rows.any(|row| self.owned[row + xs.start..row + xs.end].contains(&true))
    }

    /// Volume of its crust, m³.
    pub fn crust_m3(&self) -> f64 {
        let sum: f64 = self.owned.iter().zip(&self.rock).filter(|(own, _)| **own).map(|(_, r)| r.thickness_m()).sum();
        sum * self.frame.cell_m * self.frame.cell_m
    }

    /// Corners of a box around its owned cells, map metres.
    pub fn bounds_m(&self) -> [DVec2; 2] {
        let [xs, ys] = self.span().map(|s| [s.start as f64, s.end as f64]);
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)]
            .map(|(i, j)| self.pose.to_map(self.frame.corner_m + DVec2::new(xs[i], ys[j]) * self.frame.cell_m));
        let fold = |f: fn(DVec2, DVec2) -> DVec2| corners[1..].iter().fold(corners[0], |a, &b| f(a, b));
        [fold(DVec2::min), fold(DVec2::max)]
    }
}
