//! Lists of neighbours with a skin: made once, good for as long as nobody has moved by half of it.

use rayon::prelude::*;

use super::{
    Cells, Cloud, LANES, RUN,
    cells::away,
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

/// The lists of [`RUN`] particles, and what making them needs.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    pub(super) rows: Rows,
    near: Near,
}

/// Neighbours of [`RUN`] particles or fewer, one list behind the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// Where each one's list begins, and the end of the last; multiples of [`LANES`].
    starts: Vec<u32>,
    /// Neighbours, filled up with the particle itself to whole lanes, and room behind the last.
    list: Vec<u32>,
}

impl Rows {
    /// Forgets all lists.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
    }

    /// The list of the particle `k` of the run.
    #[inline(always)]
    pub(super) fn of(&self, k: usize) -> &[u32] {
        &self.list[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Room for a list of up to `most`, and for eight more.
    #[inline(always)]
    pub(super) fn room(&mut self, most: usize) -> &mut [u32] {
        let (from, to) = (self.end(), self.end() + most + LANES);
        if self.list.len() < to {
            self.list.resize(2 * to, 0);
        }
        &mut self.list[from..to]
    }

    /// Keeps the first `found` of what was put into the room as the next particle's list, and fills it up with `own`.
    #[inline(always)]
    pub(super) fn keep(&mut self, found: usize, own: u32) {
        let (from, to) = (self.end() + found, self.end() + found.next_multiple_of(LANES));
        self.list[from..to].fill(own);
        self.starts.push(to as u32);
    }

    /// Where the last list ends.
    #[inline(always)]
    fn end(&self) -> usize {
        self.starts.last().map_or(0, |&end| end as usize)
    }
}

/// What lies in and around a cell, in whole lanes: filled up with places that are endlessly far.
#[derive(Clone, Debug, Default)]
struct Near {
    cell: Option<[i32; 3]>,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    index: Vec<u32>,
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
        self.runs[i / RUN].rows.of(i % RUN).iter().map(|&j| j as usize).filter(move |&j| j != i)
    }

    /// Entries in all lists.
    pub fn entries(&self) -> usize {
        self.runs.iter().map(|run| run.rows.end()).sum()
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
        let Run { rows, near } = run;
        rows.clear();
        near.cell = None;
        for i in first..last {
            let here = [cloud.x[i], cloud.y[i], cloud.z[i]];
            let cell = cells.cell(here);
            if near.cell != Some(cell) {
                near.fill(cells, cloud, cell);
            }
            let (to, own) = (rows.room(near.index.len()), i as u32);
            let found = match cells.domain.wrap_m {
                None => near.find::<R, false>([0.0; 2], here, radius_m, own, to),
                Some(wrap) => near.find::<R, true>(wrap, here, radius_m, own, to),
            };
            rows.keep(found, own);
        }
    }
}

impl Near {
    /// Copies what lies in and around a cell side by side: the particles of a cell share it.
    #[inline(always)]
    fn fill(&mut self, cells: &Cells, cloud: &Cloud, cell: [i32; 3]) {
        self.cell = Some(cell);
        let Self { x, y, z, index, .. } = self;
        for values in [&mut *x, &mut *y, &mut *z] {
            values.clear();
        }
        index.clear();
        cells.around(cell, |range| {
            x.extend_from_slice(&cloud.x[range.clone()]);
            y.extend_from_slice(&cloud.y[range.clone()]);
            z.extend_from_slice(&cloud.z[range.clone()]);
            index.extend(range.start as u32..range.end as u32);
        });
        let whole = index.len().next_multiple_of(LANES);
        for values in [x, y, z] {
            values.resize(whole, f32::INFINITY);
        }
        index.resize(whole, 0);
    }

    /// Puts those nearer than `radius` to the particle `but`, which is `here`, at the beginning of `to`, which has room for all
    /// and eight more; says how many they are.
    #[inline(always)]
    fn find<R: Reader, const WRAP: bool>(
        &self,
        [wx, wy]: [f32; 2],
        [x, y, z]: [f32; 3],
        radius: f32,
        but: u32,
        to: &mut [u32],
    ) -> usize {
        let (xs, ys, zs) = (self.x.as_chunks::<LANES>().0, self.y.as_chunks().0, self.z.as_chunks::<LANES>().0);
        let mut found = 0;
        for (((xs, ys), zs), index) in xs.iter().zip(ys).zip(zs).zip(self.index.as_chunks().0) {
            let ys: &[f32; LANES] = ys;
            let mut squares = [0.0; LANES];
            for l in 0..LANES {
                let (dx, dy) = (away::<WRAP>(x, xs[l], wx), away::<WRAP>(y, ys[l], wy));
                let dz = z - zs[l];
                squares[l] = dx * dx + dy * dy + dz * dz;
            }
            if let Some(to) = to[found..].first_chunk_mut() {
                // SAFETY: whoever runs this with a reader has looked whether the processor has what it needs.
                found += unsafe { R::pick(index, &squares, radius * radius, but, to) };
            }
        }
        found
    }
}
