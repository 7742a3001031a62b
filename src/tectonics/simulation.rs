//! The run of the plates: bodies move, ownership follows, crust is made, lost, thickened and thinned.
//!
//! One geologic step is a few engine steps, so many that no two plates close more than about three and a half tectonic cells.
//! Crust is booked: what spreading, accretion and volcanoes make comes in, what sinks leaves, what collides is moved.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rayon::prelude::*;

use crate::{crust, noise::Key, rmp::Brush};

use super::{
    arc::{self, Arc},
    contact::Contact,
    domain::Domain,
    engine::{Engine, Grip},
    exchange::{self, Lost, Owners, Polarity},
    plate::{Plate, Rock},
    raise::{self, Belt, Line, Share, Work},
    stretch::{self, Meeting, Stretch},
};

/// Cells that two plates may close in one step at twice the plate speed; an exchange takes three.
const CELLS_PER_STEP: f64 = 3.5;
/// Height at which a volcano on sea floor grows no more, m.
const HIGHEST_VOLCANO_M: f32 = 3_500.0;
/// Height that a site has built up before it is a volcano, m.
const VOLCANO_M: f32 = 100.0;
/// How much lower it stays for each metre of crust that was added below it: high ground bears lower cones.
const VOLCANO_LOSS: f32 = 0.07;
/// Crust of gap cells beside a continent, as a share of the crust beside them.
const STRETCHED: f32 = 0.45;
/// Crust of a lower plate's ground that comes out again, as a share of the crust beside it.
const BARED: f32 = 0.85;
/// Continental crust thinner than this breaks: what opens beside it is ocean, m.
const BREAKING_M: f32 = 17_000.0;
/// Settings of a run in SI units and My.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Ranges.
    pub belt: Belt,
    /// Arcs.
    pub arc: Arc,
    /// Thickness that subduction adds over the length that closed, m.
    pub accretion_m: f64,
    /// Height a volcano gains while `speed` of convergence lasts a million years, m.
    pub volcano_m_per_myr: f64,
    /// Speed at which volcanoes grow at that rate, m/yr.
    pub speed_m_per_yr: f64,
    /// The fastest plate's own speed, m/yr.
    pub fastest_m_per_yr: f64,
    /// Length of the run, My.
    pub duration_myr: f64,
    /// Steps asked for, instead of as many as the speed needs.
    pub steps: Option<u64>,
}

/// What entered and left the crust, m³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Books {
    /// Crust when the run began.
    pub start_m3: f64,
    /// Made at ridges, by accretion and by volcanoes.
    pub made_m3: f64,
    /// Sunk below other plates.
    pub sunk_m3: f64,
    /// Waiting to be moved.
    pub pending_m3: f64,
    /// Worn off by others, less what they laid down.
    pub worn_m3: f64,
}

/// Convergence between two plates.
#[derive(Clone, Copy, Debug)]
pub struct Closing {
    /// The pair.
    pub plates: [usize; 2],
    /// Length closed (negative: opened) so far, m.
    pub closed_m: f64,
}

/// The plates in motion.
pub struct Simulation {
    /// The square.
    pub domain: Domain,
    /// The plates and their ground.
    pub plates: Vec<Plate>,
    /// Owners after the last step.
    pub owners: Owners,
    /// Who overrides whom.
    pub polarity: Polarity,
    /// Crust made and lost.
    pub books: Books,
    /// Convergence by pair, sorted.
    pub closings: Vec<Closing>,
    /// Closing stretches of the last step.
    pub stretches: Vec<Stretch>,
    /// The bodies.
    pub engine: Engine,
    /// My since the run began.
    pub time_myr: f64,
    rules: Rules,
    key: Key,
    /// Crust of continents that gave way, by loser and winner, waiting for a border to be raised along.
    pots: Vec<Pot>,
    grips: Vec<Grip>,
    step: u64,
    steps: u64,
    engine_steps: u64,
    /// Engine steps in all, and taken.
    in_all: u64,
    done: u64,
}

#[derive(Clone, Debug)]
struct Pot {
    loser: usize,
    winner: usize,
    volume_m3: f64,
    points: Vec<DVec2>,
}

/// New cells of a continent that is torn in one place.
#[derive(Clone, Debug, Default)]
struct Rift {
    volume_m3: f64,
    points: Vec<DVec2>,
}

impl Simulation {
    /// A run ready for its first step.
    pub fn new(domain: Domain, plates: Vec<Plate>, mut engine: Engine, rules: Rules, key: Key) -> Self {
        let polarity = Polarity::of(&plates);
        let owners = exchange::compose(&domain, &plates, &polarity);
        let books = Books { start_m3: plates.iter().map(Plate::crust_m3).sum(), ..Books::default() };
        // A plate moves a thirtieth of a unit an engine step at the plate speed; two that meet, twice that.
        let in_all = engine.fit(rules.duration_myr * 1e6);
        let cells_per_step = 2.0 * engine.step_yr() * rules.fastest_m_per_yr / domain.cell_m();
        let engine_steps = match rules.steps {
            Some(steps) => in_all.div_ceil(steps.max(1)),
            None => ((CELLS_PER_STEP / cells_per_step) as u64).max(1),
        };
        let engine_steps = engine_steps.min(in_all);
        let steps = in_all.div_ceil(engine_steps);
        let grips = vec![Grip::default(); plates.len() * plates.len()];
        Self {
            domain,
            plates,
            owners,
            polarity,
            books,
            closings: Vec::new(),
            stretches: Vec::new(),
            engine,
            time_myr: 0.0,
            rules,
            key,
            pots: Vec::new(),
            grips,
            step: 0,
            steps,
            engine_steps,
            in_all,
            done: 0,
        }
    }

    /// Steps the run takes in all.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Steps taken.
    pub fn steps_done(&self) -> u64 {
        self.step
    }

    /// Crust on all plates and on its way, m³.
    pub fn crust_m3(&self) -> f64 {
        self.plates.iter().map(Plate::crust_m3).sum::<f64>() + self.books.pending_m3
    }

    /// One geologic step.
    pub fn advance(&mut self) {
        let before = self.time_myr;
        let contacts = self.move_plates();
        let step_myr = self.time_myr - before;
        for (plate, pose) in (0..self.plates.len()).map(|p| (p, self.engine.pose(p))) {
            self.plates[plate].pose = pose;
        }
        self.owners = exchange::compose(&self.domain, &self.plates, &self.polarity);
        let lost = exchange::consume(&self.domain, &mut self.plates, &self.owners);
        self.collect(lost);
        self.fill_gaps();
        self.read_stretches(&contacts);
        self.raise(step_myr);
        self.erupt(step_myr);
        self.step += 1;
    }

    /// Runs the engine, adds up what each pair closed, and returns the last contacts.
    fn move_plates(&mut self) -> Vec<Contact> {
        let n = self.plates.len();
        let mut contacts = Vec::new();
        for _ in 0..self.engine_steps.min(self.in_all - self.done) {
            let grips = &self.grips;
            self.engine.step(|a, b| grips[a * n + b]);
            contacts = self.engine.contacts();
            for contact in &contacts {
                let closed = contact.closing_m_per_yr() * self.engine.step_yr();
                match self.closings.binary_search_by_key(&contact.plates, |c| c.plates) {
                    Ok(at) => self.closings[at].closed_m += closed,
                    Err(at) => self.closings.insert(at, Closing { plates: contact.plates, closed_m: closed }),
                }
            }
            self.done += 1;
        }
        self.time_myr = self.rules.duration_myr * (self.done as f64 / self.in_all as f64);
        contacts
    }

    /// Sorts lost crust: what sinks leaves the books, what is too light waits to be raised.
    fn collect(&mut self, lost: Vec<Lost>) {
        let area = self.domain.cell_m() * self.domain.cell_m();
        for cell in lost {
            let volume = cell.rock.thickness_m() * area;
            // Ocean floor sinks; arcs, plateaus and sediment on it are scraped off.
            let on_top = cell.rock.added_m + cell.rock.edifice_m - cell.rock.worn_m.min(0.0);
            let kept = if cell.rock.kind > 0.5 { volume.max(0.0) } else { on_top as f64 * area };
            self.books.sunk_m3 += volume - kept;
            if kept > 0.0 {
                self.books.pending_m3 += kept;
                let pot = self.pot(cell.loser, cell.winner);
                pot.volume_m3 += kept;
                pot.points.push(cell.at_m);
            }
        }
    }

    fn pot(&mut self, loser: usize, winner: usize) -> &mut Pot {
        let at = self.pots.iter().position(|p| (p.loser, p.winner) == (loser, winner)).unwrap_or_else(|| {
            self.pots.push(Pot { loser, winner, volume_m3: 0.0, points: Vec::new() });
            self.pots.len() - 1
        });
        &mut self.pots[at]
    }

    /// New crust in the gaps: ocean floor, or continent stretched out of the plate beside it.
    fn fill_gaps(&mut self) {
        let n = self.domain.cells;
        let mut rifts: BTreeMap<(usize, i64, i64), Rift> = BTreeMap::new();
        for gap in exchange::gaps(&self.domain, &self.owners) {
            let at_m = self.domain.cell_center_m(gap.cell % n, gap.cell / n);
            let rim_m = self.domain.cell_center_m(gap.rim % n, gap.rim / n);
            if let Some((plate, volume_m3)) = self.fill_gap(gap.plate, at_m, rim_m) {
                // One rift for each plate and neighbourhood: a plate may be torn on several sides.
                let block = (at_m / (4.0 * self.rules.belt.half_width_m)).floor();
                let rift = rifts.entry((plate, block.x as i64, block.y as i64)).or_default();
                rift.volume_m3 += volume_m3;
                rift.points.push(at_m);
            }
        }
        for (index, ((plate, ..), rift)) in rifts.into_iter().enumerate() {
            self.stretch_out(plate, index as u64, &rift);
        }
    }

    /// Gives a gap cell to a plate; returns which one, and the crust to be stretched into the cell, if it is continental.
    fn fill_gap(&mut self, beside: usize, at_m: DVec2, rim_m: DVec2) -> Option<(usize, f64)> {
        let area = self.domain.cell_m() * self.domain.cell_m();
        let rim = self.plates[beside].owned_under(rim_m).map(|c| self.plates[beside].rock[c]);
        // Ground that a plate lost below another one that has since moved on: no rift, the lower plate comes out again.
        let bared = self.plates.iter().position(|p| p.cell_under(at_m).is_some_and(|c| p.spent[c] && !p.owned[c]));
        let owner = bared.unwrap_or(beside);
        let plate = &mut self.plates[owner];
        let cell = plate.cell_under(at_m).filter(|&c| !plate.owned[c])?;
        match rim.filter(|r| r.kind > 0.5 && (bared.is_some() || r.crust_m > BREAKING_M)) {
            Some(rim) => {
                let crust_m = rim.crust_m * if bared.is_some() { BARED } else { STRETCHED };
                plate.take(cell, Rock { crust_m, kind: rim.kind, born_myr: rim.born_myr, ..Rock::default() });
                Some((owner, crust_m as f64 * area))
            }
            None => {
                let crust_m = crust::OCEAN_THICKNESS_M as f32;
                plate.take(cell, Rock { crust_m, born_myr: self.time_myr as f32, ..Rock::default() });
                self.books.made_m3 += crust_m as f64 * area;
                None
            }
        }
    }

    /// Takes the crust of new rift cells from the continent around them.
    fn stretch_out(&mut self, plate: usize, index: u64, rift: &Rift) {
        let path_m = raise::spine(&rift.points, self.rules.belt.half_width_m);
        let line = Line { path_m, lean: DVec2::ZERO, offset_m: 0.0, plates: [plate; 2], work: Work::Thin };
        let key = self.key.named("rift").with(self.step).with(index);
        let shares = raise::shares(&self.plates, &line, &self.rules.belt, key);
        let taken = self.apply(&shares, -rift.volume_m3, |rock| (&mut rock.crust_m, [raise::THINNEST_M, f32::MAX]));
        // What the draws could not find is booked as made: melt that fills the rift.
        self.books.made_m3 += rift.volume_m3 + taken;
    }

    fn read_stretches(&mut self, contacts: &[Contact]) {
        let n = self.plates.len();
        let piece = self.rules.belt.half_width_m;
        self.grips.fill(Grip::default());
        self.stretches.clear();
        for contact in contacts {
            let stretches = stretch::closing_stretches(contact, &self.plates, &self.polarity, piece);
            let [a, b] = contact.plates;
            self.grips[a * n + b] = stretch::grip(&stretches);
            self.stretches.extend(stretches);
        }
    }

    /// Raises ranges along closing borders: collided crust from the pots, accreted crust along subduction zones.
    fn raise(&mut self, step_myr: f64) {
        let mut jobs: Vec<(Line, f64, Option<Pot>)> = Vec::new();
        for pot in std::mem::take(&mut self.pots) {
            jobs.push((self.collision_line(&pot), pot.volume_m3, Some(pot)));
        }
        for s in self.stretches.iter().filter(|s| s.meeting == Meeting::Subduction) {
            let volume = s.closing_m_per_yr * step_myr * 1e6 * s.length_m() * self.rules.accretion_m;
            let path_m = s.ends_m.to_vec();
            let offset_m = 0.8 * self.rules.arc.offset_m;
            jobs.push((
                Line { path_m, lean: s.inland, offset_m, plates: [s.over; 2], work: Work::Thicken },
                volume,
                None,
            ));
        }
        let key = self.key.named("raise").with(self.step);
        let shares: Vec<Vec<Share>> = jobs
            .par_iter()
            .enumerate()
            .map(|(i, (line, ..))| raise::shares(&self.plates, line, &self.rules.belt, key.with(i as u64)))
            .collect();
        let thickest = self.rules.belt.thickest_m as f32;
        for ((_, volume, pot), shares) in jobs.into_iter().zip(&shares) {
            let put = self.apply(shares, volume, |rock| {
                let most = (thickest - rock.crust_m + rock.worn_m).max(0.0);
                (&mut rock.added_m, [0.0, most])
            });
            match pot {
                // What found no room waits for the next step.
                Some(pot) => {
                    self.books.pending_m3 -= put;
                    if volume - put > 0.0 {
                        self.pots.push(Pot { volume_m3: volume - put, ..pot });
                    }
                }
                None => self.books.made_m3 += put,
            }
        }
    }

    /// The border along which a pot is raised: the pair's colliding stretches, or the middle of what was lost.
    fn collision_line(&self, pot: &Pot) -> Line {
        let mut path_m: Vec<DVec2> = Vec::new();
        let mut lean = DVec2::ZERO;
        let pair = |s: &&Stretch| (s.over, s.under) == (pot.winner, pot.loser) && s.meeting == Meeting::Collision;
        for s in self.stretches.iter().filter(pair) {
            path_m.extend(s.ends_m);
            lean = s.inland;
        }
        if path_m.is_empty() {
            path_m = raise::spine(&pot.points, self.rules.belt.half_width_m);
        }
        Line { path_m, lean, offset_m: 0.0, plates: [pot.winner, pot.loser], work: Work::Thicken }
    }

    /// Adds `volume_m3` to a part of the rock by shares, within the part's limits; returns what the f32 state really took.
    fn apply(&mut self, shares: &[Share], volume_m3: f64, part: impl Fn(&mut Rock) -> (&mut f32, [f32; 2])) -> f64 {
        let area = self.domain.cell_m() * self.domain.cell_m();
        let time = self.time_myr as f32;
        let mut got = 0.0;
        for s in shares {
            let rock = &mut self.plates[s.plate].rock[s.cell];
            let (value, [least, most]) = part(rock);
            let old = *value;
            *value = ((old as f64 + volume_m3 * s.share / area) as f32).clamp(least.min(old), most.max(old));
            let gained = *value as f64 - old as f64;
            rock.note_rate(gained as f32, time);
            got += gained;
        }
        got * area
    }

    /// Points along the arcs of now, an eighth of the distance between volcanoes apart: the stretch and the place of each.
    pub fn arc_points(&self) -> Vec<(&Stretch, DVec2)> {
        let arc = &self.rules.arc;
        let points = |stretch| {
            let line = arc.line(stretch).unwrap_or_default();
            let pieces = (line[0].distance(line[1]) / (arc.spacing_m / 8.0)).ceil() as usize;
            (0..pieces).map(move |i| (stretch, line[0].lerp(line[1], (i as f64 + 0.5) / pieces as f64)))
        };
        self.stretches.iter().flat_map(points).collect()
    }

    /// The volcanoes that stand over a sinking plate now, each once, where they have built something.
    pub fn volcanoes(&self) -> Vec<DVec2> {
        let key = self.volcano_key();
        let mut seen = BTreeSet::new();
        let mut places = Vec::new();
        for stretch in &self.stretches {
            let plate = &self.plates[stretch.over];
            for (site, at_m) in arc::volcanoes(plate, stretch, &self.rules.arc, key.with(stretch.over as u64)) {
                let built = plate.owned_under(at_m).is_some_and(|i| plate.rock[i].edifice_m > VOLCANO_M);
                if built && seen.insert((stretch.over, site)) {
                    places.push(at_m);
                }
            }
        }
        places
    }

    /// What the places of volcanoes are drawn from.
    fn volcano_key(&self) -> Key {
        self.key.named("volcano sites")
    }

    /// Grows the volcanoes of all arcs.
    fn erupt(&mut self, step_myr: f64) {
        let key = self.key.named("erupt").with(self.step);
        let sites = self.volcano_key();
        let rules = &self.rules;
        let gains: Vec<Vec<Share>> = self
            .stretches
            .par_iter()
            .enumerate()
            .map_init(Brush::new, |brush, (i, s)| {
                let pace = (s.closing_m_per_yr / rules.speed_m_per_yr).min(2.0);
                let height_m = rules.volcano_m_per_myr * pace * step_myr;
                arc::cones(
                    &self.plates[s.over],
                    s,
                    &rules.arc,
                    height_m,
                    key.with(i as u64),
                    sites.with(s.over as u64),
                    brush,
                )
            })
            .collect();
        let area = self.domain.cell_m() * self.domain.cell_m();
        for gains in gains {
            self.books.made_m3 += self.apply(&gains, area, |rock| {
                let most = HIGHEST_VOLCANO_M - VOLCANO_LOSS * rock.added_m;
                (&mut rock.edifice_m, [0.0, most.max(0.0)])
            });
        }
    }
}
