//! What a band of rows is worked on with: a few rows of cells and faces, small enough for the nearest memory.

use super::{
    faces::Faces,
    flow::{self, Sides, spill},
    line::{Line, close},
    rows::{Map, cut},
    rules::{Beat, Rules},
};
use crate::grid::Edges;

/// What a band works with: cells and faces of four rows, and what a row ends in.
#[derive(Clone, Debug)]
pub struct Bench {
    pub lines: [Line; 4],
    pub x: [Faces; 4],
    /// Faces to the north of the rows.
    pub y: [Faces; 4],
    /// Sediment that the water can carry, m.
    pub able: Vec<f32>,
    pub bed: Vec<f32>,
    pub speed2: Vec<f32>,
    pub dried: Vec<f32>,
    pub made: Vec<f32>,
    /// Share of the water that stands.
    pub stands: Vec<f32>,
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
            able: row(0.0),
            bed: row(0.0),
            speed2: row(0.0),
            dried: row(0.0),
            made: row(0.0),
            stands: row(0.0),
            soft: row(rules.rock_softness),
        }
    }

    /// Pushes the water over the faces to the north of row `y`.
    #[inline(always)]
    pub fn push_north(&mut self, rules: &Rules, beat: &Beat, map: &Map, y: isize) {
        let (w, h) = (rules.width, rules.height as isize);
        let (one, two) = (&self.lines[slot(y - 1)], &self.lines[slot(y)]);
        let faces = &mut self.y[slot(y)];
        let rim = rules.edges != Edges::Wrap && (y <= 0 || y >= h);
        if !rim {
            let both = |row: fn(&Line) -> &Vec<f32>| [&row(one)[1..], &row(two)[1..]];
            let sides = Sides {
                start: both(|l| &l.start),
                wet: both(|l| &l.wet),
                depth: both(|l| &l.depth),
                land: both(|l| &l.land),
                sea: one.sea || two.sea,
            };
            return faces.push(beat, rules.mei, sides, map.old(y).faces(1));
        }
        // Over an open rim the ground goes on as it falls from the next row inwards.
        let inner = rules.row(if y <= 0 { 1 } else { h - 2 });
        let (start, change) = (cut(map.still.start, inner, w), map.old(inner as isize).change);
        for x in 0..w {
            let out = if rules.edges == Edges::Open && (y == 0 || y == h) {
                let fall = start[x] + change[x] - two.ground[x + 1];
                spill(rules, two.depth[x + 1], fall) * two.land[x + 1]
            } else {
                0.0
            };
            faces.set(x, if y <= 0 { -out } else { out });
        }
    }

    /// Pushes the water over the faces in row `y`, from its west end to its east end.
    #[inline(always)]
    pub fn push_across(&mut self, rules: &Rules, beat: &Beat, map: &Map, y: isize) {
        let w = rules.width;
        let line = &self.lines[slot(y)];
        let faces = &mut self.x[slot(y)];
        let sides = Sides {
            start: [&line.start, &line.start[1..]],
            wet: [&line.wet, &line.wet[1..]],
            depth: [&line.depth, &line.depth[1..]],
            land: [&line.land, &line.land[1..]],
            sea: line.sea,
        };
        faces.push(beat, rules.mei, sides, map.old(y).faces(0));
        (faces.water[w], faces.ahead[w], faces.back[w]) = (faces.water[0], faces.ahead[0], faces.back[0]);
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
