//! Particles counted into cells, in memory.
//!
//! The table is a torus of a power of two of cells a side: far cells share an entry, which costs a look at a distance and
//! nothing else, and a world of any extent needs no more than a few entries a particle.

/// What space particles live in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Domain {
    /// Extents to the east and south after which the world comes again, m; endless without.
    pub wrap_m: Option<[f32; 2]>,
}

impl Domain {
    /// The nearest way between two places whose coordinates differ by `d`.
    #[inline(always)]
    pub fn nearest(&self, mut d: [f32; 3]) -> [f32; 3] {
        if let Some(wrap) = self.wrap_m {
            d[0] = shorter(d[0], wrap[0]);
            d[1] = shorter(d[1], wrap[1]);
        }
        d
    }
}

/// A difference less the extent of a world that wraps, where that is shorter. Odd: the way back is exactly its negative.
#[inline(always)]
fn shorter(d: f32, extent: f32) -> f32 {
    let over = if d > 0.5 * extent { extent } else { 0.0 };
    let under = if d < -0.5 * extent { extent } else { 0.0 };
    d - over + under
}

/// `a − b`, the shorter way around where the world wraps.
#[inline(always)]
pub(super) fn away<const WRAP: bool>(a: f32, b: f32, extent: f32) -> f32 {
    if WRAP { shorter(a - b, extent) } else { a - b }
}

/// Places in the table, each one once: a world that wraps may have a few cells more than the table, whose last and first cells
/// then share entries.
#[inline(always)]
fn once(places: &[u32; 3]) -> impl Iterator<Item = u32> {
    places.iter().enumerate().filter(|&(k, place)| !places[..k].contains(place)).map(|(_, &place)| place)
}

/// A table of cells no smaller than a radius, and where the particles of each begin in an order sorted by them.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// The domain they were counted in.
    pub domain: Domain,
    origin: [f32; 3],
    /// Cells per metre.
    per_m: [f32; 3],
    /// Cells until a wrapping world comes again; 0 where it does not.
    around: [i32; 3],
    bits: [u32; 3],
    starts: Vec<u32>,
    entry: Vec<u32>,
}

impl Cells {
    /// Counts particles into cells at least `radius` wide and gives the order sorted by cell, older places first.
    pub fn sort(&mut self, at: [&[f32]; 3], radius: f32, domain: Domain, order: &mut Vec<u32>) {
        let n = at[0].len();
        self.lay_out(at, radius, domain);
        let table = 1usize << self.bits.iter().sum::<u32>();
        self.starts.clear();
        self.starts.resize(table + 1, 0);
        self.entry.clear();
        for ((&x, &y), &z) in at[0].iter().zip(at[1]).zip(at[2]) {
            let cell = self.cell([x, y, z]);
            let entry = self.entry(cell);
            self.entry.push(entry);
            self.starts[entry as usize + 1] += 1;
        }
        for k in 0..table {
            self.starts[k + 1] += self.starts[k];
        }
        order.clear();
        order.resize(n, 0);
        for i in 0..n {
            let next = &mut self.starts[self.entry[i] as usize];
            order[*next as usize] = i as u32;
            *next += 1;
        }
        // Each start has moved to its end: the next one's start.
        self.starts.copy_within(0..table, 1);
        self.starts[0] = 0;
    }

    /// Chooses origin, cell sizes and the size of the table.
    fn lay_out(&mut self, at: [&[f32]; 3], radius: f32, domain: Domain) {
        let n = at[0].len();
        self.domain = domain;
        let mut want = [4.0f64; 3];
        for axis in 0..3 {
            let (low, high) =
                at[axis].iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)));
            let (low, high) = if n == 0 { (0.0, 0.0) } else { (low, high) };
            self.origin[axis] = low;
            self.per_m[axis] = 1.0 / radius;
            self.around[axis] = 0;
            let wrap = if axis < 2 { domain.wrap_m.map(|wrap| wrap[axis]) } else { None };
            if let Some(extent) = wrap {
                // Whole cells around. Fewer than three would meet the same neighbour twice.
                let cells = (extent / radius) as i32;
                self.origin[axis] = 0.0;
                if cells >= 3 {
                    self.around[axis] = cells;
                    self.per_m[axis] = cells as f32 / extent;
                }
            }
            want[axis] = ((high - self.origin[axis]) as f64 * self.per_m[axis] as f64 + 1.0).max(4.0);
        }
        let most = (4 * n).max(512) as f64;
        while want.iter().product::<f64>() > most {
            // The longest side is folded over itself.
            let longest = (0..3).fold(0, |a, b| if want[b] > want[a] { b } else { a });
            if want[longest] <= 4.0 {
                break;
            }
            want[longest] = (0.5 * want[longest]).max(4.0);
        }
        self.bits = want.map(|cells| (cells.min(1e6) as usize).next_power_of_two().trailing_zeros());
    }

    /// The cell of a place.
    #[inline(always)]
    pub(super) fn cell(&self, at: [f32; 3]) -> [i32; 3] {
        let mut cell = [0; 3];
        for axis in 0..3 {
            let place = (at[axis] - self.origin[axis]) * self.per_m[axis];
            let whole = place as i32;
            // The floor: truncation is towards 0.
            cell[axis] = if whole as f32 > place { whole - 1 } else { whole };
            if self.around[axis] > 0 {
                cell[axis] = cell[axis].rem_euclid(self.around[axis]);
            }
        }
        cell
    }

    #[inline(always)]
    fn entry(&self, cell: [i32; 3]) -> u32 {
        let [x, y, z] = [0, 1, 2].map(|axis| cell[axis] as u32 & ((1 << self.bits[axis]) - 1));
        (((y << self.bits[2]) | z) << self.bits[0]) | x
    }

    /// Particles, in sorted order, of the cell and of the 26 around it, and of those that share an entry with them: a range
    /// for each row of cells from west to east, or more where the table begins again within the row.
    #[inline(always)]
    pub(super) fn around(&self, cell: [i32; 3], mut each: impl FnMut(std::ops::Range<usize>)) {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| self.beside(cell[axis], axis));
        let first = xs[0];
        let in_a_row = xs == [first, first + 1, first + 2];
        let mut span = |from: u32, to: u32| {
            let range = self.starts[from as usize] as usize..self.starts[to as usize + 1] as usize;
            if !range.is_empty() {
                each(range);
            }
        };
        for y in once(&ys) {
            for z in once(&zs) {
                let row = ((y << self.bits[2]) | z) << self.bits[0];
                if in_a_row {
                    span(row | first, row | (first + 2));
                } else {
                    once(&xs).for_each(|x| span(row | x, row | x));
                }
            }
        }
    }

    /// Where the table has the cell before a place along an axis, its own and the next.
    #[inline(always)]
    fn beside(&self, at: i32, axis: usize) -> [u32; 3] {
        [-1, 0, 1].map(|step| {
            let to = at.wrapping_add(step);
            let to = if self.around[axis] > 0 { to.rem_euclid(self.around[axis]) } else { to };
            to as u32 & ((1 << self.bits[axis]) - 1)
        })
    }

    /// Whether a particle lies within `radius` of a place, no more than that of the cells; `at` is in sorted order.
    pub fn any_within(&self, at: [&[f32]; 3], place: [f32; 3], radius: f32) -> bool {
        let mut found = false;
        self.around(self.cell(place), |range| {
            for j in range {
                let [x, y, z] = self.domain.nearest([0, 1, 2].map(|axis| at[axis][j] - place[axis]));
                found |= x * x + y * y + z * z < radius * radius;
            }
        });
        found
    }
}
