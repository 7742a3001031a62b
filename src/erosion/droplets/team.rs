//! Runs windows, several at once on a thread, a droplet of each in a lane.

use std::{
    ops::Range,
    sync::{Mutex, PoisonError},
};

use multiversion::multiversion;

use crate::grid::Edges;

use super::{
    super::bed::{Bed, Coast},
    kernel::{Kernel, Run},
    lanes::{Bounds, LANES, Lane, Lanes},
    step::Rules,
    walk::{Droplet, Law},
    window::{self, Piece, Window},
};

/// Windows that wait for a thread, the last first.
pub type Waiting<'a> = Mutex<Vec<&'a mut Window>>;

/// What a phase runs on.
#[derive(Clone, Copy)]
pub struct Phase<'a> {
    /// The ground, as it was before.
    pub bed: &'a Bed,
    /// What a step does.
    pub law: &'a Law,
    /// What a droplet works on.
    pub kernel: &'a Kernel,
    /// Cells that droplets keep from a cut.
    pub margin: usize,
}

/// A window that is being run, and how far.
struct Post<'a> {
    window: &'a mut Window,
    pieces: [Piece; 2],
    /// Where droplets may be.
    all: Bounds,
    /// The same of the rows that have been copied.
    near: Bounds,
    /// Droplets of its queue that have begun.
    begun: usize,
    /// Steps that the droplet in the lane had taken before.
    before: f32,
    /// Whether there is a droplet in the lane.
    busy: bool,
}

/// Windows at work on one thread.
struct Team<'a, 'b> {
    phase: Phase<'b>,
    waiting: &'b Waiting<'a>,
    posts: Lane<Option<Post<'a>>>,
    lanes: Lanes,
}

/// Runs windows until none waits, at most `width` of them at once: which does not matter to what they become.
#[multiversion(targets("x86_64+avx2"))]
pub fn run(phase: Phase, waiting: &Waiting, width: usize) {
    let grid = &phase.bed.grid;
    let rules = Rules { law: *phase.law, sea_m: phase.bed.sea_m, open: grid.edges == Edges::Open };
    let coast = phase.bed.coast();
    let mut team = Team { phase, waiting, posts: [const { None }; LANES], lanes: Lanes::default() };
    (0..LANES).for_each(|l| team.lanes.park(l));
    (0..width.min(LANES)).for_each(|l| team.relieve(l));
    while team.posts.iter().any(Option::is_some) {
        team.beat(&rules, coast);
    }
}

impl<'a> Team<'a, '_> {
    /// A step of all lanes.
    #[inline(always)]
    fn beat(&mut self, rules: &Rules, coast: Option<Coast>) {
        let mut here = self.lanes.here();
        for l in 0..LANES {
            if let Some(post) = &self.posts[l] {
                here.look(l, &post.window.ground);
            }
        }
        let heading = self.lanes.head(rules, &here);
        let mut there = self.lanes.there(&heading);
        for l in 0..LANES {
            if let Some(post) = &self.posts[l] {
                there.look(l, &post.window.ground);
            }
        }
        let deed = self.lanes.step(rules, &heading, &there);
        let mut added = Lane::<Run>::default();
        for (l, added) in added.iter_mut().enumerate() {
            if let Some(post) = &mut self.posts[l] {
                *added = deed.work(l, self.phase.kernel, &mut post.window.ground, coast);
                post.window.ground.pass(deed.cell(l), self.lanes.water[l]);
            }
        }
        self.lanes.go(&heading, &deed, &added);
        let outside = self.lanes.outside();
        for l in 0..LANES {
            let end = deed.end(l);
            if end.is_none() && outside >> l & 1 == 0 {
                continue;
            }
            let Some(post) = &mut self.posts[l] else { continue };
            if let Some(end) = end {
                let (at, drop) = (self.lanes.at(l), self.lanes.droplet(l));
                post.window.book(end, at, drop.load, &self.phase.bed.grid);
                post.leave(drop.steps);
            }
            self.relieve(l);
        }
    }

    /// Sees to it that a lane has a droplet that can take a step, if there is one.
    #[inline(never)]
    fn relieve(&mut self, l: usize) {
        let Phase { bed, kernel, margin, .. } = self.phase;
        loop {
            let Some(post) = &mut self.posts[l] else {
                let Some(window) = self.waiting.lock().unwrap_or_else(PoisonError::into_inner).pop() else {
                    return self.lanes.park(l);
                };
                self.posts[l] = Some(Post::open(window, bed, kernel, margin));
                continue;
            };
            if post.busy {
                let at = self.lanes.at(l);
                if post.near.holds(at) {
                    return;
                }
                if post.all.holds(at) {
                    post.window.ground.load(bed, post.pieces, at[1] as usize, margin);
                    post.near = bounds(post.pieces, &post.window.ground.loaded, margin);
                    return self.lanes.bound(l, &post.near, &post.window.ground);
                }
                let drop = self.lanes.droplet(l);
                post.window.later.push(Droplet { at: window::global(post.pieces, at, &bed.grid), ..drop });
                post.leave(drop.steps);
            } else if let Some(drop) = post.window.queue.get(post.begun) {
                self.lanes.put(l, window::local(post.pieces, drop.at, &bed.grid), drop);
                (post.before, post.busy) = (drop.steps, true);
                post.begun += 1;
            } else {
                post.window.queue.clear();
                self.posts[l] = None;
            }
        }
    }
}

impl<'a> Post<'a> {
    /// Opens a window.
    fn open(window: &'a mut Window, bed: &Bed, kernel: &Kernel, margin: usize) -> Self {
        let pieces = window.pieces;
        window.ground.open(bed, pieces, kernel.overhang());
        let of = |rows: Range<usize>| bounds(pieces, &rows, margin);
        let (all, near) = (of(0..pieces[1].size), of(0..0));
        Self { window, pieces, all, near, begun: 0, before: 0.0, busy: false }
    }

    /// A droplet has left the lane after so many steps of its way.
    fn leave(&mut self, steps: f32) {
        self.window.steps += (steps - self.before) as u64;
        self.busy = false;
    }
}

/// Where a droplet may be while only some rows of its window have been copied.
fn bounds(pieces: [Piece; 2], rows: &Range<usize>, margin: usize) -> Bounds {
    let sides = [&(0..pieces[0].size), rows];
    let low = |k: usize| if pieces[k].rim[0] && sides[k].start == 0 { 0.0 } else { (sides[k].start + margin) as f32 };
    let high = |k: usize| {
        let last = sides[k].end as f32 - 1.0;
        if pieces[k].rim[1] && sides[k].end == pieces[k].size { last } else { last - margin as f32 }
    };
    let rim = |k: usize| {
        let [low, high] = pieces[k].rim;
        let last = pieces[k].size as f32 - 1.0;
        [if low { 0.0 } else { f32::NEG_INFINITY }, if high { last } else { f32::INFINITY }]
    };
    Bounds {
        inner: [0, 1].map(|k| [low(k), high(k)]),
        rim: [0, 1].map(rim),
        most: pieces.map(|piece| piece.size.saturating_sub(2) as f32),
    }
}
