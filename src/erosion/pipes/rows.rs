//! The map as a step goes over it: what it has been is read, what it becomes is written in its place.
//!
//! The map is cut into bands of rows that are worked on side by side. A band reads two rows beyond either of its ends as they
//! were before the step; of those it has copies, its halo.

use rayon::prelude::*;

use super::{bench::Bench, rules::Rules, sweep::Book};

/// What a step changes, by cell: whole rows of the map, or one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row<T> {
    pub change: T,
    pub depth: T,
    pub load: T,
    /// Fluxes at the west and north faces of cells: signed, or to the east and south.
    pub flux: [T; 2],
    /// Fluxes to the west and north where the two are apart.
    pub back: [T; 2],
}

impl<T> Row<T> {
    /// `f` of each of them.
    #[inline(always)]
    fn map<U>(self, mut f: impl FnMut(T) -> U) -> Row<U> {
        Row {
            change: f(self.change),
            depth: f(self.depth),
            load: f(self.load),
            flux: self.flux.map(&mut f),
            back: self.back.map(&mut f),
        }
    }

    fn zip<U>(self, other: Row<U>) -> Row<(T, U)> {
        let ([fx, fy], [bx, by]) = (self.flux, self.back);
        let ([gx, gy], [cx, cy]) = (other.flux, other.back);
        Row {
            change: (self.change, other.change),
            depth: (self.depth, other.depth),
            load: (self.load, other.load),
            flux: [(fx, gx), (fy, gy)],
            back: [(bx, cx), (by, cy)],
        }
    }

    #[inline(always)]
    fn each_ref(&self) -> Row<&T> {
        let Self { change, depth, load, flux, back } = self;
        Row { change, depth, load, flux: flux.each_ref(), back: back.each_ref() }
    }

    fn each_mut(&mut self) -> Row<&mut T> {
        let Self { change, depth, load, flux, back } = self;
        Row { change, depth, load, flux: flux.each_mut(), back: back.each_mut() }
    }
}

impl<'a> Row<&'a [f32]> {
    /// Fluxes at the faces of an axis, and those back where the two are apart.
    pub fn faces(&self, axis: usize) -> [&'a [f32]; 2] {
        [self.flux[axis], self.back[axis]]
    }
}

/// What no step changes, by cell of the whole map.
#[derive(Clone, Copy)]
pub struct Still<'a> {
    pub start: &'a [f32],
    pub source: &'a [f32],
    pub rate: &'a [f32],
}

/// Rows of the map that a step writes to.
pub struct Rows<'a> {
    pub values: Row<&'a mut [f32]>,
    pub rest: &'a mut [f32],
    pub soft: &'a mut [f32],
    pub books: &'a mut [Book],
}

impl<'a> Rows<'a> {
    /// Takes off the first rows.
    fn split_off(&mut self, rows: usize, width: usize) -> Self {
        fn first<'a, T>(all: &mut &'a mut [T], n: usize) -> &'a mut [T] {
            all.split_off_mut(..n.min(all.len())).unwrap_or_default()
        }
        let n = rows * width;
        Self {
            values: self.values.each_mut().map(|all| first(all, n)),
            rest: first(&mut self.rest, n),
            soft: first(&mut self.soft, n),
            books: first(&mut self.books, rows),
        }
    }
}

/// The two rows before a band and the two behind it, as they were before the step.
#[derive(Clone, Debug, Default)]
pub struct Halo([Row<Vec<f32>>; 4]);

impl Halo {
    /// Copies the rows around those from `first` to before `end`.
    fn keep(&mut self, rules: &Rules, map: &Row<&mut [f32]>, [first, end]: [usize; 2]) {
        let at = [first as isize - 2, first as isize - 1, end as isize, end as isize + 1];
        for (kept, y) in self.0.iter_mut().zip(at) {
            let row = map.each_ref().map(|all| cut(all, rules.row(y), rules.width));
            kept.each_mut().zip(row).map(|(kept, row)| {
                kept.clear();
                kept.extend_from_slice(row);
            });
        }
    }
}

/// A band of the map, and what it needs to know of the rest.
pub struct Map<'a> {
    pub still: Still<'a>,
    pub rows: Rows<'a>,
    /// The map's row that its first is.
    pub first: usize,
    halo: &'a Halo,
    width: usize,
}

impl Map<'_> {
    /// Row `y` of the map as it is, if the step has not yet come to it: of the band, or up to two beyond its ends.
    #[inline(always)]
    pub fn old(&self, y: isize) -> Row<&[f32]> {
        let (at, rows) = (y - self.first as isize, self.rows.books.len() as isize);
        if (0..rows).contains(&at) {
            self.rows.values.each_ref().map(|all| cut(all, at as usize, self.width))
        } else {
            let beyond = if at < 0 { at + 2 } else { at - rows + 2 };
            self.halo.0[beyond as usize].each_ref().map(|all| all.as_slice())
        }
    }
}

/// Cuts the map into as many bands as there are benches.
pub fn bands<'a>(
    rules: &Rules,
    still: Still<'a>,
    mut rows: Rows<'a>,
    benches: &'a mut [(Halo, Bench)],
) -> Vec<(Map<'a>, &'a mut Bench)> {
    let (height, count) = (rows.books.len(), benches.len());
    let begin = |band: usize| height * band / count;
    let map = &rows.values;
    let halos = benches.par_iter_mut().enumerate();
    halos.for_each(|(band, (halo, _))| halo.keep(rules, map, [begin(band), begin(band + 1)]));
    let cut_off = |(band, (halo, bench)): (usize, &'a mut (Halo, Bench))| {
        let (first, width) = (begin(band), rules.width);
        let rows = rows.split_off(begin(band + 1) - first, width);
        (Map { still, rows, first, halo, width }, bench)
    };
    benches.iter_mut().enumerate().map(cut_off).collect()
}

/// Row `y` of values by cell; nothing where there are none.
pub fn cut(all: &[f32], y: usize, width: usize) -> &[f32] {
    if all.is_empty() { all } else { &all[y * width..][..width] }
}
