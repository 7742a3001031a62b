//! One step over the whole map, in a single pass and in place.
//!
//! The map is cut into bands of rows that know nothing of each other; what a band needs from beyond its rows (two rows to
//! either side) it works out for itself, with the same bits. Within a band rows follow each other through the stages, four
//! at a time, so that all that lies between stages stays in the nearest memory, and a row is written when nobody needs what
//! it was.

use multiversion::multiversion;
use rayon::prelude::*;

use super::{
    bench::{Bench, slot},
    faces::Faces,
    line::Line,
    rows::{Halo, Map, Rows, Still, bands},
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
    /// Water that dried up, or left ponds whose bed rose.
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

/// Takes a step, in as many bands as there are benches.
pub fn sweep(rules: &Rules, beat: &Beat, still: Still, rows: Rows, benches: &mut [(Halo, Bench)]) {
    bands(rules, still, rows, benches).into_par_iter().for_each(|(map, bench)| band(rules, beat, map, bench));
}

/// Takes the step for some rows, in the widest vectors that the processor has: the arithmetic is the same in all, and so are
/// the bits.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn band(rules: &Rules, beat: &Beat, mut map: Map, bench: &mut Bench) {
    let top = map.first as isize;
    let end = top + map.rows.books.len() as isize;
    for y in top - 2..end + 2 {
        bench.lines[slot(y)].load(rules, beat, &map.still, map.old(y), rules.row(y));
        if y > top - 2 {
            bench.push_north(rules, beat, &map, y);
        }
        if y >= top {
            bench.push_across(rules, beat, &map, y - 1);
            bench.ration(rules, beat, y - 1);
        }
        if y > top {
            bench.give_across(rules, y - 1);
            bench.give_north(rules, y - 1);
        }
        if y > top + 1 {
            row(rules, beat, &mut map, bench, y - 2);
        }
    }
}

/// Ends the step for row `y`, whose faces are done.
#[inline(always)]
fn row(rules: &Rules, beat: &Beat, map: &mut Map, bench: &mut Bench, y: isize) {
    let (w, h) = (rules.width, rules.height as isize);
    let (at, to) = (y as usize - map.first, (y as usize - map.first) * w);
    let Rows { values, rest, soft, books } = &mut map.rows;
    let three = |row: fn(&Line) -> &Vec<f32>| [-1, 0, 1].map(|step| row(&bench.lines[slot(y + step)]).as_slice());
    let line = &bench.lines[slot(y)];
    let (x, north, south) = (&bench.x[slot(y)], &bench.y[slot(y)], &bench.y[slot(y + 1)]);
    let (depth, load) = (&mut values.depth[to..][..w], &mut values.load[to..][..w]);
    let [out_x, out_y] = values.flux.each_mut().map(|all| &mut all[to..][..w]);
    let (bed, change) = (&mut bench.bed[..w], &mut values.change[to..][..w]);
    let ground = three(|l| &l.ground);
    let before = Before {
        ground,
        depth: &line.depth,
        act: &line.act,
        x: [&x.water, &x.load],
        north: [&north.water, &north.load],
        south: [&south.water, &south.load],
    };
    let soft = if soft.is_empty() { &mut bench.soft[..] } else { &mut soft[to..][..w] };
    let (speed2, dried, made) = (&mut bench.speed2[..], &mut bench.dried[..], &mut bench.made[..]);
    let (able, stands) = (&mut bench.able[..w], &mut bench.stands[..]);
    sediment::run(rules, beat, &before, depth, able, speed2, dried, made, stands, out_x, out_y);
    sediment::exchange(rules, beat, &before, [able, depth], soft, load, bed);
    if rules.softening > 0.0 {
        sediment::soften(rules, bed, soft);
    }
    if beat.slide > 0.0 {
        let (talus, rate) = (three(|l| &l.talus), three(|l| &l.rate));
        if rules.locked {
            slip::slide_locked(beat.slide, ground, talus, rate, three(|l| &l.room), bed);
        } else if map.still.rate.is_empty() {
            slip::slide(beat.slide, ground, talus, bed);
        } else {
            slip::slide_rated(beat.slide, ground, talus, rate, bed);
        }
    }
    if line.sea {
        sea::drop(rules, line, bed, load);
    }
    if rules.keep > 0.0 {
        sediment::keep_level(rules, &line.land[1..], &bench.stands, bed, depth, &mut bench.dried);
    }
    let (start, rest) = (&map.still.start[y as usize * w..][..w], &mut rest[to..][..w]);
    let rated = !map.still.rate.is_empty();
    if rated || rules.locked {
        // The row of capacities has served.
        bench.able.copy_from_slice(change);
    }
    sediment::lay(bed, change, rest);
    if rated {
        sediment::stay(&line.rate[1..], &bench.able, change, rest);
    }
    if rules.locked {
        sediment::hold(rules, start, &line.ground[1..], &bench.able, change, rest);
    }
    let came = |i: usize| beat.pace * ((x.water[i] - x.water[i + 1]) + (north.water[i] - south.water[i]));
    let water = [&bench.dried[..w], &bench.made[..w]];
    let drowned = sea::level(rules, line, [start, change], water, came, depth);
    if rules.mei {
        out_x.copy_from_slice(&x.ahead[..w]);
        out_y.copy_from_slice(&north.ahead[..w]);
        values.back[0][to..][..w].copy_from_slice(&x.back[..w]);
        values.back[1][to..][..w].copy_from_slice(&north.back[..w]);
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
    books[at] = Book {
        rained: line.rained,
        dried: if beat.dry_m + rules.keep > 0.0 { total(&bench.dried) } else { 0.0 },
        made: total(&bench.made),
        drowned: drowned.unwrap_or(0.0),
        spilt: over[0] * beat.pace as f64,
        rock_spilt: over[1] * beat.pace as f64,
        deepest,
        fastest2: greatest(&bench.speed2),
    };
}
