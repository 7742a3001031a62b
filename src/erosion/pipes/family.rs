//! The solver: its state, its steps, and what it gives to look at.

use crate::grid::{Grid, for_each_row, sum_f64};

use super::super::{
    bed::{Bed, Family, Moved, Part, Saved},
    leftover::lay_all,
};
use super::{
    advect::{Tracer, mend},
    bench::Bench,
    flow::{hi, lo},
    momentum::{self, Water},
    params::{Flux, PipesParams, Sediment},
    rows::{Halo, Row, Rows, Still},
    rules::{Beat, FROUDE, GRAVITY, PIPE_M, Rules, SLIDE, STILL_M, sources},
    sweep::{Book, sweep},
};

/// Rows that a band has at least: the four that it works out for its neighbours should not weigh much.
const BAND: usize = 16;

/// Shallow water in pipes between cells, with what it carries.
pub struct Pipes {
    params: PipesParams,
    grid: Grid,
    rules: Rules,
    source: Vec<f32>,
    /// Fastest that a cell's water rises by rain and springs, m/s.
    wettest: f32,
    /// Share of the stability limit that steps take.
    pub(super) courant: f64,
    pub(super) depth: Vec<f32>,
    pub(super) load: Vec<f32>,
    pub(super) flux: [Vec<f32>; 2],
    back: [Vec<f32>; 2],
    /// What is too little for the bed's `change` to hold, m.
    rest: Vec<f32>,
    soft: Vec<f32>,
    tracer: Option<Tracer>,
    /// Depth a step ago, and room for fluxes, where water carries momentum.
    past: Vec<f32>,
    carried: [Vec<f32>; 2],
    books: Vec<Book>,
    benches: Vec<(Halo, Bench)>,
    deepest: f32,
    fastest2: f32,
    substeps: u64,
}

impl Pipes {
    /// The solver over a bed; `rain` are weights of the rain by cell.
    pub fn new(params: PipesParams, bed: &Bed, rain: Option<&[f32]>) -> Self {
        let (grid, cells) = (bed.grid, bed.grid.cells());
        let mut rules = Rules::new(&params, &grid, bed.sea_m, bed.locked);
        rules.stay_clear(0.0, bed);
        let source = sources(&params, &grid, rain);
        let row = || vec![0.0f32; cells];
        let some = |wanted: bool| if wanted { row() } else { Vec::new() };
        let two = |wanted: bool| [some(wanted), some(wanted)];
        let mei = params.flux == Flux::Mei;
        let (soft, momentum) = (params.softening_per_m > 0.0, params.momentum && !mei);
        let depth = (0..cells).map(|i| hi(rules.sea_m - bed.height(i), 0.0)).collect();
        let mut pipes = Self {
            grid,
            source,
            wettest: 0.0,
            courant: 0.9,
            depth,
            load: row(),
            flux: two(true),
            back: two(mei),
            rest: row(),
            soft: if soft { vec![rules.rock_softness; cells] } else { Vec::new() },
            tracer: (params.sediment != Sediment::Flux).then(|| Tracer::new(cells)),
            past: some(momentum),
            carried: two(momentum),
            books: vec![Book::default(); grid.height],
            benches: Vec::new(),
            deepest: 0.0,
            fastest2: 0.0,
            substeps: 0,
            rules,
            params,
        };
        pipes.wettest = pipes.wettest(bed);
        pipes
    }

    /// Fastest that water on land rises by rain and springs, m/s: in the sea the level is fixed.
    fn wettest(&self, bed: &Bed) -> f32 {
        if self.source.is_empty() {
            return (self.params.rain_mm_per_h / 3.6e6) as f32;
        }
        let land = (0..self.source.len()).filter(|&i| bed.height(i) >= self.rules.sea_m);
        land.fold(0.0, |most, i| hi(self.source[i], most))
    }

    /// Where the sea's level in the world is `level_m`: what is locked keeps so far from it that no rounding crosses it.
    pub fn at_sea(mut self, level_m: f64, bed: &Bed) -> Self {
        self.rules.stay_clear(level_m, bed);
        self
    }

    /// With so much water on the land to begin with, m.
    pub fn on(mut self, water: &[f32]) -> Self {
        for (depth, &stands) in self.depth.iter_mut().zip(water) {
            *depth = hi(*depth, stands);
        }
        self.deepest = self.depth.iter().fold(0.0, |a, &b| hi(b, a));
        self
    }

    /// The step that keeps waves and water within a cell, s; `deepest` and `fastest2` as the last one left them.
    pub(super) fn limit(&self, raining: bool) -> f64 {
        let cell = self.grid.cell_m;
        let waves = if self.rules.mei { 2.0 } else { std::f64::consts::SQRT_2 };
        let at = |depth: f64| {
            let speed = (GRAVITY as f64 * depth.max(PIPE_M as f64)).sqrt();
            let free = self.courant * cell / (waves * speed);
            free.min(cell / (self.fastest2 as f64).sqrt().max(1e-12))
        };
        let rise = if raining { self.wettest as f64 } else { 0.0 };
        // Rain makes the water deeper before the step has begun.
        let first = at(self.deepest as f64).min((0.1 * self.deepest.max(0.01) as f64) / rise.max(1e-30));
        at(self.deepest as f64 + rise * first).min(first)
    }

    fn beat(&self, dt: f64, raining: bool) -> Beat {
        let (p, cell) = (&self.params, self.grid.cell_m);
        let wet = if raining { dt } else { 0.0 };
        let slides = p.slip_per_h / 3600.0 * p.morphological_factor * dt;
        Beat {
            dt: dt as f32,
            pace: (dt / cell) as f32,
            pull: (dt * GRAVITY as f64 / cell) as f32,
            drag: (4.0 * dt) as f32 * self.rules.rough,
            steep: (4.0 * dt / cell) as f32 / (FROUDE * FROUDE),
            fastest: (cell / dt) as f32,
            rain_m: (p.rain_mm_per_h / 3.6e6 * wet) as f32,
            source_s: wet as f32,
            dry_m: (p.evaporation_mm_per_h / 3.6e6 * dt) as f32,
            dissolve: (p.dissolve_per_s * dt).min(1.0) as f32,
            settle: (p.settle_per_s * dt).min(1.0) as f32,
            slide: slides.min(SLIDE as f64) as f32,
        }
    }

    /// One step of `dt` seconds.
    pub(super) fn substep(&mut self, bed: &mut Bed, dt: f64, raining: bool, moved: &mut Moved) {
        let beat = self.beat(dt, raining);
        let bands = (4 * rayon::current_num_threads()).min(self.grid.height / BAND).max(1);
        if self.benches.len() != bands {
            self.benches = (0..bands).map(|_| (Halo::default(), Bench::new(&self.rules))).collect();
        }
        if !self.past.is_empty() {
            self.carry(bed, &beat);
        }
        let still = Still { start: &bed.start, source: &self.source, rate: &bed.rate };
        let ([fx, fy], [bx, by]) = (&mut self.flux, &mut self.back);
        let values = Row {
            change: &mut bed.change[..],
            depth: &mut self.depth,
            load: &mut self.load,
            flux: [fx, fy],
            back: [bx, by],
        };
        let rows = Rows { values, rest: &mut self.rest, soft: &mut self.soft, books: &mut self.books };
        sweep(&self.rules, &beat, still, rows, &mut self.benches);
        self.trace(&beat);
        self.book(moved);
        self.substeps += 1;
    }

    /// Takes the fluxes' momentum along.
    fn carry(&mut self, bed: &Bed, beat: &Beat) {
        let (flux, depth) = ([&self.flux[0][..], &self.flux[1][..]], &self.depth);
        let water = Water { start: &bed.start, change: &bed.change, depth, past: &self.past, flux };
        for (axis, out) in self.carried.iter_mut().enumerate() {
            momentum::carry(&self.rules, beat, water, axis, out);
        }
        std::mem::swap(&mut self.flux, &mut self.carried);
        self.past.copy_from_slice(&self.depth);
    }

    /// Sediment by its own way, where it does not ride on the fluxes.
    fn trace(&mut self, beat: &Beat) {
        let Some(mut tracer) = self.tracer.take() else { return };
        let velocity = [0, 1].map(|axis| self.velocity(axis));
        tracer.velocity = velocity;
        let (depth, load, w) = (&self.depth, &self.load, self.grid.width);
        let wet = |i: usize| depth[i] > STILL_M;
        for_each_row(&mut tracer.value, w, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                let i = y * w + x;
                *value = if wet(i) { load[i] / depth[i] } else { 0.0 };
            }
        });
        let mut out = std::mem::take(&mut tracer.brought);
        tracer.run(&self.grid, beat.dt, self.params.sediment == Sediment::Maccormack, wet, &mut out);
        for_each_row(&mut out, w, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                let i = y * w + x;
                *out = if wet(i) { *out * depth[i] } else { load[i] };
            }
        });
        mend(w, load, &mut out);
        tracer.brought = std::mem::replace(&mut self.load, out);
        self.tracer = Some(tracer);
    }

    /// Takes locked ground out of the margin at the sea's level again; the land has the difference.
    fn clear(&self, bed: &mut Bed, sea: &[bool]) {
        let (level, margin) = (self.rules.sea_m, self.rules.margin_m);
        let mut over = 0.0;
        for i in 0..sea.len() {
            let old = bed.change[i];
            let kept = if sea[i] {
                lo(old, hi((level - margin) - bed.start[i], lo(old, 0.0)))
            } else {
                hi(old, lo((level + margin) - bed.start[i], hi(old, 0.0)))
            };
            over += f64::from(old) - f64::from(kept);
            bed.change[i] = kept;
        }
        let room = |i: usize| !sea[i] && bed.rate(i) > 0.0 && bed.height(i) > level + 2.0 * margin;
        let places: Vec<usize> = if over == 0.0 { Vec::new() } else { (0..sea.len()).filter(|&i| room(i)).collect() };
        let count = places.len();
        for (k, i) in places.into_iter().enumerate() {
            let old = bed.change[i];
            bed.change[i] = (f64::from(old) + over / (count - k) as f64) as f32;
            over -= f64::from(bed.change[i]) - f64::from(old);
        }
    }

    /// Looks for the greatest depth itself, after a test has set depths.
    #[cfg(test)]
    pub(super) fn look(&mut self) {
        self.deepest = self.depth.iter().fold(0.0, |a, &b| hi(b, a));
    }

    fn book(&mut self, moved: &mut Moved) {
        let area = self.grid.cell_area_m2();
        let (mut deepest, mut fastest2) = (0.0, 0.0);
        for book in &self.books {
            moved.water_in_m3 += area * (book.rained + book.made);
            moved.water_left_m3 += area * (book.dried + book.drowned + book.spilt);
            moved.rock_left_m3 += area * self.params.morphological_factor * book.rock_spilt;
            deepest = hi(book.deepest, deepest);
            fastest2 = hi(book.fastest2, fastest2);
        }
        (self.deepest, self.fastest2) = (deepest, fastest2);
    }

    /// Takes some steps in the rain, each as long as it may be; for measuring.
    pub fn run_steps(&mut self, bed: &mut Bed, count: u64) -> Moved {
        let mut moved = Moved::default();
        for _ in 0..count {
            let dt = self.limit(true);
            self.substep(bed, dt, true, &mut moved);
        }
        moved
    }

    /// The raster.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The sea's level, m; below everything without a sea.
    pub(super) fn sea_m(&self) -> f32 {
        self.rules.sea_m
    }

    /// One-sided fluxes to the west or north, where they are kept.
    pub(super) fn back(&self, axis: usize) -> &[f32] {
        &self.back[axis]
    }

    /// How easily the ground gives way, by cell; empty where it is as soft as the rock everywhere.
    pub fn softness(&self) -> &[f32] {
        &self.soft
    }

    /// Steps that it has taken on its own account.
    pub fn substeps(&self) -> u64 {
        self.substeps
    }
}

impl Family for Pipes {
    fn advance(&mut self, bed: &mut Bed, part: Part) -> Moved {
        let whole = 3600.0 * self.params.duration_h;
        let [mut now, end] = part.of(whole);
        let dries = whole * (1.0 - self.params.recession);
        let mut moved = Moved::default();
        self.wettest = self.wettest(bed);
        while now < end {
            let raining = now < dries;
            let stop = if raining { end.min(dries) } else { end };
            let limit = self.limit(raining);
            let dt = if limit >= stop - now { stop - now } else { limit };
            self.substep(bed, dt, raining, &mut moved);
            now = if dt >= stop - now { stop } else { now + dt };
        }
        moved
    }

    fn carried_m3(&self) -> f64 {
        let rock = self.params.morphological_factor * sum_f64(&self.load) + sum_f64(&self.rest);
        rock * self.grid.cell_area_m2()
    }

    fn settle(&mut self, bed: &mut Bed) -> Moved {
        let factor = self.rules.factor;
        let mut held: Vec<f32> = self.load.iter().zip(&self.rest).map(|(load, rest)| factor * load + rest).collect();
        let sea: Vec<bool> = (0..held.len()).map(|i| bed.height(i) < self.rules.sea_m).collect();
        lay_all(bed, &mut held);
        if bed.locked {
            self.clear(bed, &sea);
        }
        self.load.fill(0.0);
        self.rest.fill(0.0);
        for (i, _) in sea.iter().enumerate().filter(|(_, sea)| **sea) {
            // What rises out of the sea leaves its water there.
            self.depth[i] = hi(self.rules.sea_m - bed.height(i), 0.0);
        }
        Moved::default()
    }

    fn save(&self) -> Saved {
        let mut fields = vec![
            ("depth", self.depth.clone()),
            ("load", self.load.clone()),
            ("flux_x", self.flux[0].clone()),
            ("flux_y", self.flux[1].clone()),
            ("rest", self.rest.clone()),
        ];
        if !self.soft.is_empty() {
            fields.push(("soft", self.soft.clone()));
        }
        if !self.back[0].is_empty() {
            fields.push(("back_x", self.back[0].clone()));
            fields.push(("back_y", self.back[1].clone()));
        }
        if !self.past.is_empty() {
            fields.push(("past", self.past.clone()));
        }
        let mut blob = self.substeps.to_le_bytes().to_vec();
        blob.extend(self.deepest.to_le_bytes());
        blob.extend(self.fastest2.to_le_bytes());
        Saved { fields, blob }
    }

    fn restore(&mut self, field: &dyn Fn(&str) -> Option<Vec<f32>>, blob: &[u8]) -> Option<()> {
        let cells = self.grid.cells();
        let whole = |name: &str| field(name).filter(|values| values.len() == cells);
        let bytes: &[u8; 16] = blob.try_into().ok()?;
        let (depth, load, rest) = (whole("depth")?, whole("load")?, whole("rest")?);
        let flux = [whole("flux_x")?, whole("flux_y")?];
        let soft = if self.soft.is_empty() { Vec::new() } else { whole("soft")? };
        let back = if self.rules.mei { [whole("back_x")?, whole("back_y")?] } else { Default::default() };
        let past = if self.past.is_empty() { Vec::new() } else { whole("past")? };
        let (count, [deepest, fastest2]) = bytes.split_first_chunk::<8>().and_then(|(count, tail)| {
            let (a, tail) = tail.split_first_chunk::<4>()?;
            let (b, _) = tail.split_first_chunk::<4>()?;
            Some((u64::from_le_bytes(*count), [f32::from_le_bytes(*a), f32::from_le_bytes(*b)]))
        })?;
        (self.depth, self.load, self.rest, self.flux, self.soft, self.back) = (depth, load, rest, flux, soft, back);
        self.past = past;
        (self.substeps, self.deepest, self.fastest2) = (count, deepest, fastest2);
        Some(())
    }
}
