//! A row of cells as a step begins: what its faces need to know.

use std::hint::select_unpredictable;

use super::{
    flow::hi,
    rows::{Row, Still, cut},
    rules::{Beat, Rules},
    sediment,
    sums::total,
};
use crate::grid::Edges;

/// Water shallower than this carries nothing on, m.
const DRY_M: f32 = 1e-7;

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
    /// What the depths could hold of the rain, m; as wide as the map.
    pub rain: Vec<f32>,
    pub sea: bool,
    pub rained: f64,
}

impl Line {
    pub fn new(width: usize) -> Self {
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
            rain: vec![0.0; width],
            sea: false,
            rained: 0.0,
        }
    }

    /// Row `y` of the map, after the rain of this step.
    #[inline(always)]
    pub fn load(&mut self, rules: &Rules, beat: &Beat, still: &Still, old: Row<&[f32]>, y: usize) {
        let w = rules.width;
        let [start, source, rate] = [still.start, still.source, still.rate].map(|all| cut(all, y, w));
        let got = &mut self.rain[..w];
        let heights = (&mut self.start[1..][..w], &mut self.ground[1..][..w], &mut self.wet[1..][..w]);
        let water = (&mut self.depth[1..][..w], &mut self.thick[1..][..w]);
        let before = [start, old.change, old.depth, old.load];
        let sea = if source.is_empty() {
            gather(before, |_| beat.rain_m, rules.sea_m, got, heights.0, heights.1, heights.2, water.0, water.1)
        } else {
            let rain = |i: usize| beat.source_s * source[i];
            gather(before, rain, rules.sea_m, got, heights.0, heights.1, heights.2, water.0, water.1)
        };
        if !rate.is_empty() {
            self.rate[1..][..w].copy_from_slice(rate);
        }
        // Most rows are all land, and have been.
        if sea || self.sea || !rate.is_empty() {
            let (land, act) = (&mut self.land[1..][..w], &mut self.act[1..][..w]);
            let (ground, rates) = (&self.ground[1..][..w], &self.rate[1..][..w]);
            for i in 0..w {
                land[i] = if ground[i] < rules.sea_m { 0.0 } else { 1.0 };
                act[i] = land[i] * rates[i];
            }
        }
        self.sea = sea;
        if rules.locked {
            let (ground, room) = (&self.ground[1..][..w], &mut self.room[1..][..w]);
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

/// What the faces of a row need, and whether any of its cells is in the sea; `got` becomes what the depths could hold of
/// the rain. Single slices, so that the compiler knows that none of the rows overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments)]
fn gather(
    before: [&[f32]; 4],
    rain: impl Fn(usize) -> f32,
    sea_m: f32,
    got: &mut [f32],
    begin: &mut [f32],
    ground: &mut [f32],
    wet: &mut [f32],
    deep: &mut [f32],
    thick: &mut [f32],
) -> bool {
    let n = got.len();
    let [start, change, depth, load] = before;
    let (start, change, depth, load) = (&start[..n], &change[..n], &depth[..n], &load[..n]);
    let (begin, ground, wet) = (&mut begin[..n], &mut ground[..n], &mut wet[..n]);
    let (deep, thick) = (&mut deep[..n], &mut thick[..n]);
    let mut under = 0u32;
    for i in 0..n {
        let d = depth[i] + rain(i);
        let z = start[i] + change[i];
        got[i] = d - depth[i];
        deep[i] = d;
        begin[i] = start[i];
        ground[i] = z;
        wet[i] = change[i] + d;
        let c = load[i] / hi(d, DRY_M);
        // Not an `if`: what is read only where it is needed is slow to read.
        thick[i] = select_unpredictable(d > DRY_M, c, 0.0);
        under |= u32::from(z < sea_m);
    }
    under > 0
}

/// Fills in the cells beyond the ends of a row.
#[inline(always)]
pub fn close(edges: Edges, row: &mut [f32]) {
    let w = row.len() - 2;
    let (west, east) = if edges == Edges::Wrap { (row[w], row[1]) } else { (row[1], row[w]) };
    row[0] = west;
    row[w + 1] = east;
}
