//! The arithmetic of a step, for all lanes at a time. Each lane is in another window, so that none has to wait for what
//! another does to the ground: one droplet after another is one long chain of roots, divisions and look-ups.

use super::{
    super::bed::Coast,
    ground::Ground,
    kernel::{Kernel, LAYS, Run, TAKES, Work},
    lanes::{LANES, Lane, Lanes},
    places::Places,
    walk::{End, Law, faster},
};

/// Slope below which ground has no line of fall.
const LEVEL: f32 = 1e-9;
/// Most of the height to where it came from that a droplet fills up.
const FILL: f32 = 0.5;
/// Share of its path after which a droplet's capacity begins to go to 0, so that it ends in a fan, not in a heap.
const WANES: f32 = 0.5;

/// A droplet goes on.
const ON: u32 = 0;
/// It works on the ground once more, and ends.
const LAST: u32 = 1;
/// It ends as it is.
const STILL: u32 = 2;
/// It leaves over the rim.
const LEFT: u32 = 3;

/// What is the same for all droplets of a phase.
#[derive(Clone, Copy)]
pub struct Rules {
    /// What a step does.
    pub law: Law,
    /// The sea, m.
    pub sea_m: f32,
    /// Whether droplets leave over the rim.
    pub open: bool,
}

/// Where droplets head.
#[derive(Default)]
pub struct Heading {
    /// Height where they are, m.
    here_m: Lane,
    to: [Lane; 2],
    /// How those end that have no step to take.
    ends: Lane<u32>,
}

/// What droplets do to the ground, and how they end.
#[derive(Default)]
pub struct Deed {
    amount: Lane,
    bound_m: Lane,
    manner: [Lane; 2],
    cell: [Lane<i32>; 2],
    place: Lane<i32>,
    ends: Lane<u32>,
}

impl Lanes {
    /// Places of the droplets.
    #[inline(always)]
    pub fn here(&self) -> Places {
        Places::of(&self.at, self)
    }

    /// Places that they head for.
    #[inline(always)]
    pub fn there(&self, heading: &Heading) -> Places {
        Places::of(&heading.to, self)
    }

    /// Turns droplets into the line of fall.
    #[inline(always)]
    pub fn head(&mut self, rules: &Rules, here: &Places) -> Heading {
        let law = rules.law;
        let mut heading = Heading::default();
        for l in 0..LANES {
            let (here_m, fall) = (here.height(l), here.fall(l));
            let steep = (fall[0] * fall[0] + fall[1] * fall[1]).sqrt();
            let turned = (1.0 - law.kept_way) / steep;
            let turns = steep * law.per_cell > LEVEL;
            // Written out: a closure handed to `map` is not always drawn into the loop.
            let (east, south) = (self.way[0][l], self.way[1][l]);
            let east = if turns { east * law.kept_way - fall[0] * turned } else { east };
            let south = if turns { south * law.kept_way - fall[1] * turned } else { south };
            let norm = (east * east + south * south).sqrt();
            let (east, south) = (east / norm, south / norm);
            (self.way[0][l], self.way[1][l]) = (east, south);
            let (x, y) = (self.at[0][l] + east, self.at[1][l] + south);
            let (x, beyond_x) = self.keep(0, l, x);
            let (y, beyond_y) = self.keep(1, l, y);
            let stays = (x - self.at[0][l]).abs() + (y - self.at[1][l]).abs() < 0.01;
            let blocked = if rules.open {
                LEFT
            } else if stays {
                STILL
            } else {
                ON
            };
            let drowned = (here_m < rules.sea_m) | (self.steps[l] >= law.path);
            let ends = if beyond_x | beyond_y { blocked } else { ON };
            let ends = if norm < 1e-6 { STILL } else { ends };
            heading.ends[l] = if drowned { LAST } else { ends };
            (heading.to[0][l], heading.to[1][l]) = (x, y);
            heading.here_m[l] = here_m;
        }
        heading
    }

    /// A coordinate, or the map's rim where it is beyond; whether it is.
    #[inline(always)]
    fn keep(&self, k: usize, l: usize, v: f32) -> (f32, bool) {
        let [low, high] = [self.rim[k][0][l], self.rim[k][1][l]];
        let (beyond_low, beyond_high) = (v < low, v > high);
        let kept = if beyond_high { high } else { v };
        (if beyond_low { low } else { kept }, beyond_low | beyond_high)
    }

    /// Takes the step, and says what it does to the ground where it began.
    #[inline(always)]
    pub fn step(&mut self, rules: &Rules, heading: &Heading, there: &Places) -> Deed {
        let law = rules.law;
        let mut deed = Deed::default();
        for l in 0..LANES {
            let (here_m, next_m, from_m) = (heading.here_m[l], there.height(l), self.from_m[l]);
            let (ends, load) = (heading.ends[l], self.load[l] as f32);
            let down = here_m - next_m;
            let speed2 = faster(self.speed2[l], down, &law);
            let water = self.water[l] * law.kept_water;
            let steps = self.steps[l] + if ends == ON { 1.0 } else { 0.0 };
            let slope = down * law.per_cell;
            let sine = (slope / (1.0 + slope * slope).sqrt()).max(law.least_sine);
            let wanes = ((1.0 - steps / law.path) / (1.0 - WANES)).min(1.0);
            let spare = law.capacity * water * wanes * sine * speed2.sqrt() - load;
            let fill_m = FILL * (from_m - here_m);
            // A delta, or the end of a fan.
            let last_m = if here_m < rules.sea_m { rules.sea_m } else { here_m.max(here_m + fill_m) };
            // What lies before a rise is filled up to it.
            let rises = down <= 0.0;
            let lays = spare < 0.0;
            let (amount, bound_m) =
                if lays { (-spare * law.laid, here_m + fill_m.max(0.0)) } else { (spare * law.taken, next_m) };
            let (amount, bound_m) = if rises { (load, next_m) } else { (amount, bound_m) };
            let (amount, bound_m) = if ends == LAST { (load, last_m) } else { (amount, bound_m) };
            deed.amount[l] = amount;
            deed.bound_m[l] = bound_m;
            let takes = !(lays | rises | (ends == LAST));
            for k in 0..2 {
                deed.manner[k][l] = if takes { TAKES[k] } else { LAYS[k] };
            }
            let stops = rises & (speed2 <= 0.0);
            deed.ends[l] = if ends == ON && stops { LAST } else { ends };
            self.speed2[l] = speed2;
            self.water[l] = water;
            self.steps[l] = steps;
        }
        for l in 0..LANES {
            let (cell, place) = Kernel::place([self.at[0][l], self.at[1][l]]);
            (deed.cell[0][l], deed.cell[1][l]) = (cell[0], cell[1]);
            deed.place[l] = place;
        }
        deed
    }

    /// Goes on to where those droplets head that have not ended.
    #[inline(always)]
    pub fn go(&mut self, heading: &Heading, deed: &Deed, added: &Lane<Run>) {
        for (l, added) in added.iter().enumerate() {
            self.load[l] -= added.iter().sum::<f32>() as f64;
            let on = deed.ends[l] == ON;
            for k in 0..2 {
                self.at[k][l] = if on { heading.to[k][l] } else { self.at[k][l] };
            }
            self.from_m[l] = heading.here_m[l];
        }
    }
}

impl Deed {
    /// Does what a lane's droplet does to the ground, if it does not end without; what was added.
    #[inline(always)]
    pub fn work(&self, l: usize, kernel: &Kernel, ground: &mut Ground, coast: Option<Coast>) -> Run {
        if self.ends[l] >= STILL {
            return Run::default();
        }
        let work = Work {
            cell: [self.cell[0][l] as usize, self.cell[1][l] as usize],
            place: self.place[l] as usize,
            amount: self.amount[l],
            bound_m: self.bound_m[l],
            part: self.manner[0][l],
            sign: self.manner[1][l],
        };
        kernel.work(ground, &work, coast)
    }

    /// The cell that a lane's droplet was in.
    #[inline(always)]
    pub fn cell(&self, l: usize) -> [usize; 2] {
        [self.cell[0][l] as usize, self.cell[1][l] as usize]
    }

    /// How a lane's droplet ends, if it does.
    #[inline(always)]
    pub fn end(&self, l: usize) -> Option<End> {
        match self.ends[l] {
            ON => None,
            LEFT => Some(End::Left),
            _ => Some(End::Still),
        }
    }
}
