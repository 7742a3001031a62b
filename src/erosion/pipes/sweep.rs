//! One step over the whole map, in a single pass: old values are read, new ones written beside them.
//!
//! The map is cut into bands of rows that know nothing of each other; what a band needs from beyond its rows (two rows to
//! either side) it works out for itself, with the same bits. Within a band rows follow each other through the stages, four
//! at a time, so that all that lies between stages stays in the nearest memory.

use multiversion::multiversion;

use super::{
    bench::{Bench, slot},
    faces::Faces,
    line::Line,
    rules::{Beat, Rules},
    sea,
    sediment::{self, Before},
    slip,
    sums::{greatest, total},
};
use crate::grid::Edges;

/// What a row moved in a step, in metres a cell (or m²/s over the rim).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Book {
    pub rained: f64,
    pub dried: f64,
    /// Water that rounding made.
    pub made: f64,
    /// Water that went into the sea.
    pub drowned: f64,
    /// Water and sediment over the rim, m.
    pub spilt: f64,
    pub rock_spilt: f64,
    /// Greatest depth on land, m, and square of the greatest speed, m²/s².
    pub deepest: f32,
    pub fastest2: f32,
}

/// The map before a step.
#[derive(Clone, Copy)]
pub struct Old<'a> {
    pub start: &'a [f32],
    pub change: &'a [f32],
    pub depth: &'a [f32],
    pub load: &'a [f32],
    /// Fluxes at the west and north faces of cells: signed, or to the east and south.
    pub flux: [&'a [f32]; 2],
    /// Fluxes to the west and north where the two are apart.
    pub back: [&'a [f32]; 2],
    pub source: &'a [f32],
    pub rate: &'a [f32],
}

/// Row `y` of values by cell; nothing where there are none.
pub fn cut(all: &[f32], y: usize, width: usize) -> &[f32] {
    if all.is_empty() { all } else { &all[y * width..][..width] }
}

impl<'a> Old<'a> {
    /// Fluxes at the faces of row `y`, and those back where the two are apart.
    pub fn faces(&self, axis: usize, y: usize, width: usize) -> [&'a [f32]; 2] {
        [cut(self.flux[axis], y, width), cut(self.back[axis], y, width)]
    }
}

/// Rows of the map after a step.
pub struct New<'a> {
    pub change: &'a mut [f32],
    pub depth: &'a mut [f32],
    pub load: &'a mut [f32],
    pub flux: [&'a mut [f32]; 2],
    pub back: [&'a mut [f32]; 2],
    pub rest: &'a mut [f32],
    pub soft: &'a mut [f32],
    pub books: &'a mut [Book],
    pub benches: &'a mut [Bench],
}

impl<'a> New<'a> {
    /// Takes off the first rows, and half of the benches.
    fn split_off(&mut self, rows: usize, width: usize) -> Self {
        fn first<'a, T>(all: &mut &'a mut [T], n: usize) -> &'a mut [T] {
            all.split_off_mut(..n.min(all.len())).unwrap_or_default()
        }
        let (n, benches) = (rows * width, self.benches.len() / 2);
        Self {
            change: first(&mut self.change, n),
            depth: first(&mut self.depth, n),
            load: first(&mut self.load, n),
            flux: self.flux.each_mut().map(|all| first(all, n)),
            back: self.back.each_mut().map(|all| first(all, n)),
            rest: first(&mut self.rest, n),
            soft: first(&mut self.soft, n),
            books: first(&mut self.books, rows),
            benches: first(&mut self.benches, benches),
        }
    }
}

/// Takes a step, in as many bands as there are benches.
pub fn sweep(rules: &Rules, beat: &Beat, old: Old, new: New) {
    divide(rules, beat, old, new, 0);
}

fn divide(rules: &Rules, beat: &Beat, old: Old, mut new: New, first: usize) {
    let rows = new.books.len();
    if new.benches.len() <= 1 || rows < 2 {
        return band(rules, beat, old, new, first);
    }
    let upper = rows * (new.benches.len() / 2) / new.benches.len();
    let one = new.split_off(upper, rules.width);
    rayon::join(|| divide(rules, beat, old, one, first), || divide(rules, beat, old, new, first + upper));
}

/// Takes the step for some rows, in the widest vectors that the processor has: the arithmetic is the same in all, and so are
/// the bits.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn band(rules: &Rules, beat: &Beat, old: Old, mut new: New, first: usize) {
    let Some((bench, _)) = std::mem::take(&mut new.benches).split_first_mut() else { return };
    let (top, end) = (first as isize, (first + new.books.len()) as isize);
    for y in top - 2..end + 2 {
        bench.lines[slot(y)].load(rules, beat, &old, rules.row(y), &mut bench.made);
        if y > top - 2 {
            bench.push_north(rules, beat, &old, y);
        }
        if y >= top {
            bench.push_across(rules, beat, &old, y - 1);
            bench.ration(rules, beat, y - 1);
        }
        if y > top {
            bench.give_across(rules, y - 1);
            bench.give_north(rules, y - 1);
        }
        if y > top + 1 {
            row(rules, beat, &old, &mut new, bench, y - 2, first);
        }
    }
}

/// Ends the step for row `y`, whose faces are done.
#[inline(always)]
fn row(rules: &Rules, beat: &Beat, old: &Old, new: &mut New, bench: &mut Bench, y: isize, first: usize) {
    let (w, h) = (rules.width, rules.height as isize);
    let (from, to) = (y as usize * w, (y as usize - first) * w);
    let three = |row: fn(&Line) -> &Vec<f32>| [-1, 0, 1].map(|step| row(&bench.lines[slot(y + step)]).as_slice());
    let line = &bench.lines[slot(y)];
    let (x, north, south) = (&bench.x[slot(y)], &bench.y[slot(y)], &bench.y[slot(y + 1)]);
    let (depth, load) = (&mut new.depth[to..][..w], &mut new.load[to..][..w]);
    let [out_x, out_y] = new.flux.each_mut().map(|all| &mut all[to..][..w]);
    let (bed, change) = (&mut bench.bed[..w], &mut new.change[to..][..w]);
    let ground = three(|l| &l.ground);
    let before = Before {
        ground,
        depth: &line.depth,
        act: &line.act,
        load: &old.load[from..][..w],
        x: [&x.water, &x.load],
        north: [&north.water, &north.load],
        south: [&south.water, &south.load],
    };
    let soft = if new.soft.is_empty() { &mut bench.soft[..] } else { &mut new.soft[to..][..w] };
    let (speed2, dried, made) = (&mut bench.speed2[..], &mut bench.dried[..], &mut bench.made[..]);
    let able = &mut bench.able[..w];
    sediment::run(rules, beat, &before, depth, able, speed2, dried, made, out_x, out_y);
    sediment::exchange(rules, beat, &before, able, soft, load, bed);
    if rules.softening > 0.0 {
        sediment::soften(rules, bed, soft);
    }
    if beat.slide > 0.0 {
        if old.rate.is_empty() && !rules.locked {
            slip::slide(beat.slide, ground, three(|l| &l.talus), bed);
        } else {
            let (rate, room) = (three(|l| &l.rate), three(|l| &l.room));
            slip::slide_held(beat.slide, ground, three(|l| &l.talus), rate, room, bed);
        }
    }
    if line.sea {
        sea::drop(rules, line, bed, load);
    }
    sediment::lay(&old.change[from..][..w], bed, change, &mut new.rest[to..][..w]);
    let came = |i: usize| beat.pace * ((x.water[i] - x.water[i + 1]) + (north.water[i] - south.water[i]));
    let start = &old.start[from..][..w];
    let water = [&old.depth[from..][..w], &bench.dried[..w], &bench.made[..w]];
    let drowned = sea::level(rules, line, [start, change], water, came, depth);
    if rules.mei {
        out_x.copy_from_slice(&x.ahead[..w]);
        out_y.copy_from_slice(&north.ahead[..w]);
        new.back[0][to..][..w].copy_from_slice(&x.back[..w]);
        new.back[1][to..][..w].copy_from_slice(&north.back[..w]);
    }
    let mut over = [0.0; 2];
    if rules.edges == Edges::Open {
        let out = |pick: fn(&Faces) -> &Vec<f32>| {
            let ends = pick(x)[w] as f64 - pick(x)[0] as f64;
            let top = if y == 0 { total(&pick(north)[..w]) } else { 0.0 };
            let bottom = if y == h - 1 { total(&pick(south)[..w]) } else { 0.0 };
            ends - top + bottom
        };
        over = [out(|f| &f.water), out(|f| &f.load)];
    }
    let deepest = if drowned.is_none() { greatest(depth) } else { sea::deepest(rules, start, change, depth) };
    new.books[y as usize - first] = Book {
        rained: line.rained,
        dried: if beat.dry_m > 0.0 { total(&bench.dried) } else { 0.0 },
        made: total(&bench.made),
        drowned: drowned.unwrap_or(0.0),
        spilt: over[0] * beat.pace as f64,
        rock_spilt: over[1] * beat.pace as f64,
        deepest,
        fastest2: greatest(&bench.speed2),
    };
}
