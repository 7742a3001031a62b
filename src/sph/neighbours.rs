//! Lists of neighbours with a skin: made once, good for as long as nobody has moved by half of it.

use rayon::prelude::*;

use super::{
    Cells, Cloud, LANES, RUN,
    wide::{Reader, Work, widest},
};

/// For every particle the others within the support and the skin.
#[derive(Clone, Debug, Default)]
pub struct Lists {
    /// How far they reach, m.
    radius_m: f32,
    runs: Vec<Run>,
    /// Positions that they were made for.
    made_for: [Vec<f32>; 3],
}

/// The lists of [`RUN`] particles.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    /// Where each one's list begins, and the end of the last; multiples of [`LANES`].
    starts: Vec<u32>,
    /// Neighbours, filled up with the particle itself to whole lanes. All below the number of particles.
    list: Vec<u32>,
    near: Near,
}

/// What lies in and around a cell.
#[derive(Clone, Debug, Default)]
struct Near {
    cell: Option<[i32; 3]>,
    at: [Vec<f32>; 3],
    index: Vec<u32>,
    square: Vec<f32>,
    found: Vec<u32>,
}

impl Run {
    /// The list of the particle `k` of the run.
    #[inline(always)]
    pub(super) fn of(&self, k: usize) -> &[u32] {
        &self.list[self.starts[k] as usize..self.starts[k + 1] as usize]
    }
}

impl Lists {
    /// Makes the lists of particles that lie in the order of `cells`, whose cells are no smaller than `radius_m`.
    pub fn make(&mut self, cells: &Cells, cloud: &Cloud, radius_m: f32) {
        self.radius_m = radius_m;
        let n = cloud.len();
        self.runs.resize_with(n.div_ceil(RUN), Run::default);
        self.runs.par_iter_mut().enumerate().for_each(|(r, run)| {
            widest(Make { cells, cloud, radius_m, first: r * RUN, last: n.min((r + 1) * RUN), run });
        });
        for (made_for, now) in self.made_for.iter_mut().zip([&cloud.x, &cloud.y, &cloud.z]) {
            made_for.clone_from(now);
        }
    }

    /// The runs, [`RUN`] particles each.
    pub(super) fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Particles that there are lists for.
    pub fn particles(&self) -> usize {
        self.made_for[0].len()
    }

    /// The positions that the lists were made for.
    pub fn made_for(&self) -> [&[f32]; 3] {
        [0, 1, 2].map(|axis| &self.made_for[axis][..])
    }

    /// The neighbours of a particle, nearer than the radius when the lists were made.
    pub fn of(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        self.runs[i / RUN].of(i % RUN).iter().map(|&j| j as usize).filter(move |&j| j != i)
    }

    /// Entries in all lists.
    pub fn entries(&self) -> usize {
        self.runs.iter().map(|run| run.list.len()).sum()
    }
}

struct Make<'a> {
    cells: &'a Cells,
    cloud: &'a Cloud,
    radius_m: f32,
    first: usize,
    last: usize,
    run: &'a mut Run,
}

impl Work for Make<'_> {
    type Out = ();

    #[inline(always)]
    fn run<R: Reader>(self) {
        let Self { cells, cloud, radius_m, first, last, run } = self;
        let Run { starts, list, near } = run;
        starts.clear();
        starts.push(0);
        list.clear();
        near.cell = None;
        for i in first..last {
            let here = [cloud.x[i], cloud.y[i], cloud.z[i]];
            let cell = cells.cell(here);
            if near.cell != Some(cell) {
                near.fill(cells, cloud, cell);
            }
            near.measure(cells, here);
            let mut found = 0;
            // Written always, kept where it counts: no branch to guess.
            for (&j, &square) in near.index.iter().zip(&near.square) {
                near.found[found] = j;
                found += usize::from(square < radius_m * radius_m && j != i as u32);
            }
            list.extend_from_slice(&near.found[..found]);
            list.extend(std::iter::repeat_n(i as u32, found.next_multiple_of(LANES) - found));
            starts.push(list.len() as u32);
        }
    }
}

impl Near {
    /// Copies what lies in and around a cell side by side: the particles of a cell share it.
    #[inline(always)]
    fn fill(&mut self, cells: &Cells, cloud: &Cloud, cell: [i32; 3]) {
        self.cell = Some(cell);
        let [x, y, z] = &mut self.at;
        for values in [&mut *x, &mut *y, &mut *z] {
            values.clear();
        }
        self.index.clear();
        cells.around(cell, |range| {
            x.extend_from_slice(&cloud.x[range.clone()]);
            y.extend_from_slice(&cloud.y[range.clone()]);
            z.extend_from_slice(&cloud.z[range.clone()]);
            self.index.extend(range.map(|j| j as u32));
        });
        self.square.resize(self.index.len(), 0.0);
        self.found.resize(self.index.len() + 1, 0);
    }

    /// Squares of the distances to a place.
    #[inline(always)]
    fn measure(&mut self, cells: &Cells, here: [f32; 3]) {
        let domain = cells.domain;
        let n = self.index.len();
        let (x, y, z, square) = (&self.at[0][..n], &self.at[1][..n], &self.at[2][..n], &mut self.square[..n]);
        if domain.wrap_m.is_some() {
            for k in 0..n {
                let [dx, dy, dz] = domain.nearest([here[0] - x[k], here[1] - y[k], here[2] - z[k]]);
                square[k] = dx * dx + dy * dy + dz * dz;
            }
        } else {
            for k in 0..n {
                let (dx, dy, dz) = (here[0] - x[k], here[1] - y[k], here[2] - z[k]);
                square[k] = dx * dx + dy * dy + dz * dz;
            }
        }
    }
}
