//! What a band of rows is worked on with: a few rows of cells and faces, small enough for the nearest memory.

use super::{
    flow::{self, Sides, spill},
    rules::{Beat, Rules},
    sediment,
    sweep::Old,
};
use crate::grid::Edges;

/// Lanes that sums and maxima run in, whatever the processor's own width.
const LANES: usize = 16;

/// Water shallower than this carries nothing on, m.
const DRY_M: f32 = 1e-7;

/// The sum of a row, in a fixed order.
#[inline(always)]
pub fn total(row: &[f32]) -> f64 {
    let mut sums = [0.0f64; LANES];
    let (whole, tail) = row.as_chunks::<LANES>();
    for chunk in whole {
        for i in 0..LANES {
            sums[i] += chunk[i] as f64;
        }
    }
    let mut sum = 0.0;
    for i in 0..LANES {
        sum += sums[i];
    }
    for &v in tail {
        sum += v as f64;
    }
    sum
}

/// The greatest of a row, and 0.
#[inline(always)]
pub fn greatest(row: &[f32]) -> f32 {
    let mut most = [0.0f32; LANES];
    let (whole, tail) = row.as_chunks::<LANES>();
    for chunk in whole {
        for i in 0..LANES {
            most[i] = flow::hi(chunk[i], most[i]);
        }
    }
    let mut all = 0.0;
    for &v in most.iter() {
        all = flow::hi(v, all);
    }
    for &v in tail {
        all = flow::hi(v, all);
    }
    all
}

/// A row of cells as it comes into a step, with a cell more at either end for what lies beyond the rim.
#[derive(Clone, Debug)]
pub struct Line {
    pub start: Vec<f32>,
    pub ground: Vec<f32>,
    pub depth: Vec<f32>,
    /// Change of the bed and depth.
    pub wet: Vec<f32>,
    /// Sediment in a volume of water.
    pub thick: Vec<f32>,
    /// 1 on land, 0 in the sea.
    pub land: Vec<f32>,
    /// Share of exchange with the bed: the rate, on land alone.
    pub act: Vec<f32>,
    pub rate: Vec<f32>,
    /// Way to the sea's level, m, where land stays land.
    pub room: Vec<f32>,
    /// Fall to a neighbour that the ground can have, m: less where it is wet.
    pub talus: Vec<f32>,
    /// Share of its outflow that a cell can give.
    pub share: Vec<f32>,
    pub sea: bool,
    pub rained: f64,
}

impl Line {
    fn new(width: usize) -> Self {
        let row = |value: f32| vec![value; width + 2];
        Self {
            start: row(0.0),
            ground: row(0.0),
            depth: row(0.0),
            wet: row(0.0),
            thick: row(0.0),
            land: row(1.0),
            act: row(1.0),
            rate: row(1.0),
            room: row(f32::MAX),
            talus: row(0.0),
            share: row(1.0),
            sea: false,
            rained: 0.0,
        }
    }

    /// Row `y` of the map, after the rain of this step.
    #[inline(always)]
    pub fn load(&mut self, rules: &Rules, beat: &Beat, old: &Old, y: usize, got: &mut [f32]) {
        let w = rules.width;
        fn cut(all: &[f32], y: usize, w: usize) -> &[f32] {
            if all.is_empty() { all } else { &all[y * w..][..w] }
        }
        let [start, change, depth] = [old.start, old.change, old.depth].map(|all| &all[y * w..][..w]);
        let (load, source, rate) = (cut(old.load, y, w), cut(old.source, y, w), cut(old.rate, y, w));
        let got = &mut got[..w];
        self.start[1..][..w].copy_from_slice(start);
        let (ground, wet) = (&mut self.ground[1..][..w], &mut self.wet[1..][..w]);
        let (deep, thick) = (&mut self.depth[1..][..w], &mut self.thick[1..][..w]);
        if source.is_empty() {
            got.fill(beat.rain_m);
        } else {
            for i in 0..w {
                got[i] = beat.source_s * source[i];
            }
        }
        gather(start, change, depth, load, got, deep, thick, wet, ground);
        // What the depths could hold of the rain is what has come.
        for i in 0..w {
            got[i] = deep[i] - depth[i];
        }
        let land = &mut self.land[1..][..w];
        let mut under = 0u32;
        for i in 0..w {
            let wet = ground[i] < rules.sea_m;
            land[i] = if wet { 0.0 } else { 1.0 };
            under += u32::from(wet);
        }
        self.sea = under > 0;
        if !rate.is_empty() {
            self.rate[1..][..w].copy_from_slice(rate);
        }
        let (act, rates) = (&mut self.act[1..][..w], &self.rate[1..][..w]);
        for i in 0..w {
            act[i] = land[i] * rates[i];
        }
        if rules.locked {
            let room = &mut self.room[1..][..w];
            (0..w).for_each(|i| room[i] = sediment::room(rules, ground[i]));
        }
        if beat.slide > 0.0 {
            let (deep, talus) = (&self.depth[1..][..w], &mut self.talus[1..][..w]);
            for i in 0..w {
                talus[i] = rules.talus_m - rules.slack_m * sediment::ramp(deep[i] * rules.per_film);
            }
        }
        self.rained = total(got);
        for row in [
            &mut self.start,
            &mut self.ground,
            &mut self.depth,
            &mut self.wet,
            &mut self.thick,
            &mut self.land,
            &mut self.rate,
            &mut self.room,
            &mut self.talus,
        ] {
            close(rules.edges, row);
        }
    }
}

/// What the faces of a row need; `rain` becomes what the depth really took of it. Its own function, so that the compiler
/// knows that none of the rows overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments)]
fn gather(
    start: &[f32],
    change: &[f32],
    depth: &[f32],
    load: &[f32],
    rain: &mut [f32],
    deep: &mut [f32],
    thick: &mut [f32],
    wet: &mut [f32],
    ground: &mut [f32],
) {
    let n = rain.len();
    let (start, change, depth, load) = (&start[..n], &change[..n], &depth[..n], &load[..n]);
    let (deep, thick, wet, ground) = (&mut deep[..n], &mut thick[..n], &mut wet[..n], &mut ground[..n]);
    for i in 0..n {
        let d = depth[i] + rain[i];
        rain[i] = d - depth[i];
        deep[i] = d;
        wet[i] = change[i] + d;
        ground[i] = start[i] + change[i];
        let c = load[i] * flow::inverse(flow::hi(d, DRY_M));
        thick[i] = if d > DRY_M { c } else { 0.0 };
    }
}

/// Fills in the cells beyond the ends of a row.
#[inline(always)]
pub fn close(edges: Edges, row: &mut [f32]) {
    let w = row.len() - 2;
    let (west, east) = if edges == Edges::Wrap { (row[w], row[1]) } else { (row[1], row[w]) };
    row[0] = west;
    row[w + 1] = east;
}

/// Fluxes over a row of faces.
#[derive(Clone, Debug)]
pub struct Faces {
    /// What passes in all.
    pub water: Vec<f32>,
    /// One-sided fluxes, where they are kept.
    pub ahead: Vec<f32>,
    pub back: Vec<f32>,
    pub load: Vec<f32>,
}

impl Faces {
    fn new(width: usize) -> Self {
        let row = || vec![0.0f32; width + 1];
        Self { water: row(), ahead: row(), back: row(), load: row() }
    }

    /// Fluxes over the `n` first faces after this step's push.
    #[inline(always)]
    pub fn push(&mut self, beat: &Beat, mei: bool, sides: Sides, n: usize) {
        if mei {
            flow::push_apart(beat, sides, &mut self.ahead[..n], &mut self.back[..n]);
        } else {
            flow::push(beat, sides, &mut self.water[..n]);
        }
    }

    /// Takes the old fluxes of `n` faces at `from`.
    #[inline(always)]
    pub fn take(&mut self, mei: bool, flux: &[f32], back: &[f32], from: usize, n: usize) {
        if mei {
            self.ahead[..n].copy_from_slice(&flux[from..][..n]);
            self.back[..n].copy_from_slice(&back[from..][..n]);
        } else {
            self.water[..n].copy_from_slice(&flux[from..][..n]);
        }
    }

    /// Sets one face to a flux that is known.
    #[inline(always)]
    pub fn set(&mut self, i: usize, flux: f32) {
        self.water[i] = flux;
        self.ahead[i] = flow::hi(flux, 0.0);
        self.back[i] = flow::hi(-flux, 0.0);
    }

    /// Gives what donors can: water and sediment.
    #[inline(always)]
    pub fn give(&mut self, mei: bool, share: [&[f32]; 2], thick: [&[f32]; 2], n: usize) {
        let (water, load) = (&mut self.water[..n], &mut self.load[..n]);
        if mei {
            flow::give_apart(share, thick, &mut self.ahead[..n], &mut self.back[..n], water, load);
        } else {
            flow::give(share, thick, water, load);
        }
    }
}

/// What a band works with: cells and faces of four rows, and what a row ends in.
#[derive(Clone, Debug)]
pub struct Bench {
    pub lines: [Line; 4],
    pub x: [Faces; 4],
    /// Faces to the north of the rows.
    pub y: [Faces; 4],
    pub bed: Vec<f32>,
    pub speed2: Vec<f32>,
    pub dried: Vec<f32>,
    pub made: Vec<f32>,
    pub soft: Vec<f32>,
}

impl Bench {
    pub fn new(rules: &Rules) -> Self {
        let w = rules.width;
        let row = |value: f32| vec![value; w];
        Self {
            lines: std::array::from_fn(|_| Line::new(w)),
            x: std::array::from_fn(|_| Faces::new(w)),
            y: std::array::from_fn(|_| Faces::new(w)),
            bed: row(0.0),
            speed2: row(0.0),
            dried: row(0.0),
            made: row(0.0),
            soft: row(rules.rock_softness),
        }
    }

    /// Pushes the water over the faces to the north of row `y`.
    #[inline(always)]
    pub fn push_north(&mut self, rules: &Rules, beat: &Beat, old: &Old, y: isize) {
        let (w, h) = (rules.width, rules.height as isize);
        let (one, two) = (&self.lines[slot(y - 1)], &self.lines[slot(y)]);
        let faces = &mut self.y[slot(y)];
        let rim = rules.edges != Edges::Wrap && (y <= 0 || y >= h);
        if !rim {
            faces.take(rules.mei, old.flux[1], old.back[1], rules.row(y) * w, w);
            let both = |row: fn(&Line) -> &Vec<f32>| [&row(one)[1..], &row(two)[1..]];
            let sides = Sides {
                start: both(|l| &l.start),
                wet: both(|l| &l.wet),
                depth: both(|l| &l.depth),
                land: both(|l| &l.land),
            };
            return faces.push(beat, rules.mei, sides, w);
        }
        // Over an open rim the ground goes on as it falls from the next row inwards.
        let inner = rules.row(if y <= 0 { 1 } else { h - 2 }) * w;
        for x in 0..w {
            let out = if rules.edges == Edges::Open && (y == 0 || y == h) {
                let fall = old.start[inner + x] + old.change[inner + x] - two.ground[x + 1];
                spill(rules, two.depth[x + 1], fall) * two.land[x + 1]
            } else {
                0.0
            };
            faces.set(x, if y <= 0 { -out } else { out });
        }
    }

    /// Pushes the water over the faces in row `y`, from its west end to its east end.
    #[inline(always)]
    pub fn push_across(&mut self, rules: &Rules, beat: &Beat, old: &Old, y: isize) {
        let w = rules.width;
        let line = &self.lines[slot(y)];
        let faces = &mut self.x[slot(y)];
        faces.take(rules.mei, old.flux[0], old.back[0], rules.row(y) * w, w);
        (faces.water[w], faces.ahead[w], faces.back[w]) = (faces.water[0], faces.ahead[0], faces.back[0]);
        let sides = Sides {
            start: [&line.start, &line.start[1..]],
            wet: [&line.wet, &line.wet[1..]],
            depth: [&line.depth, &line.depth[1..]],
            land: [&line.land, &line.land[1..]],
        };
        faces.push(beat, rules.mei, sides, w + 1);
        if rules.edges != Edges::Wrap {
            let out = |x: usize, inner: usize| {
                let fall = line.ground[inner] - line.ground[x];
                if rules.edges == Edges::Open { spill(rules, line.depth[x], fall) * line.land[x] } else { 0.0 }
            };
            let (west, east) = (out(1, 2.min(w)), out(w, (w - 1).max(1)));
            faces.set(0, -west);
            faces.set(w, east);
        }
    }

    /// What the cells of row `y` can give of their outflow.
    #[inline(always)]
    pub fn ration(&mut self, rules: &Rules, beat: &Beat, y: isize) {
        let w = rules.width;
        let (x, north, south) = (&self.x[slot(y)], &self.y[slot(y)], &self.y[slot(y + 1)]);
        let Line { depth, share, .. } = &mut self.lines[slot(y)];
        let (depth, out) = (&depth[1..][..w], &mut share[1..][..w]);
        if rules.mei {
            flow::ration_apart(beat.pace, depth, [&x.ahead, &south.ahead], [&x.back, &north.back], out);
        } else {
            flow::ration(beat.pace, depth, &x.water, [&north.water, &south.water], out);
        }
        close(rules.edges, share);
    }

    /// Gives water and sediment over the faces in row `y`.
    #[inline(always)]
    pub fn give_across(&mut self, rules: &Rules, y: isize) {
        let w = rules.width;
        let line = &self.lines[slot(y)];
        let faces = &mut self.x[slot(y)];
        faces.give(rules.mei, [&line.share, &line.share[1..]], [&line.thick, &line.thick[1..]], w + 1);
        if !rules.fluxed {
            // Sediment travels later, in its own way; over the rim it goes now.
            let inside = if rules.edges == Edges::Wrap { 0..w + 1 } else { 1..w };
            faces.load[inside].fill(0.0);
        }
    }

    /// Gives water and sediment over the faces to the north of row `y`.
    #[inline(always)]
    pub fn give_north(&mut self, rules: &Rules, y: isize) {
        let (w, h) = (rules.width, rules.height as isize);
        let (one, two) = (&self.lines[slot(y - 1)], &self.lines[slot(y)]);
        let faces = &mut self.y[slot(y)];
        faces.give(rules.mei, [&one.share[1..], &two.share[1..]], [&one.thick[1..], &two.thick[1..]], w);
        let rim = rules.edges != Edges::Wrap && (y == 0 || y == h);
        if !rules.fluxed && !rim {
            faces.load.fill(0.0);
        }
    }
}

/// Which of four rows row `y` is.
#[inline(always)]
pub fn slot(y: isize) -> usize {
    (y & 3) as usize
}
