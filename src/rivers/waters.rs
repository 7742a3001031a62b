//! Where water goes once the ground is levelled: lakes, discharge, the order of streams.

use crate::{
    flow::{Drainage, neighbours},
    grid::Grid,
};

use super::hollows::{Hollow, fill, hollows, under};

/// What the waters are found from.
pub struct Climate {
    /// What each cell sheds, m³/s; 0 in the sea.
    pub runoff_m3_s: Vec<f64>,
    /// What a cell of lake loses to the air, m³/s; 0 where lakes shed as the land does.
    pub loss_m3_s: f64,
}

/// Standing water.
#[derive(Clone, Debug, PartialEq)]
pub struct Lake {
    /// Its cells.
    pub cells: Vec<u32>,
    /// Its deepest cell.
    pub bottom: u32,
    /// Height of its surface, m.
    pub level_m: f64,
    /// Whether it loses to the air all that it is given.
    pub closed: bool,
    /// Whether no water comes to it at all: a hollow, and no lake.
    pub dry: bool,
}

/// Rivers and lakes cell by cell.
pub struct Waters {
    /// The way down from each cell.
    pub way: Drainage,
    /// The lakes, largest first; after them the hollows that are dry.
    pub lakes: Vec<Lake>,
    /// Which lake a cell lies in, numbered from 1; 0 on dry land.
    pub lake_of: Vec<u32>,
    /// A year's mean, m³/s.
    pub discharge_m3_s: Vec<f64>,
}

impl Waters {
    /// The waters on a ground that has been routed to its outlets. Where lakes fall below their brims, hollows of the ground
    /// that comes up are filled unless they are `worth` a lake.
    pub fn of(
        way: Drainage,
        z: &mut [f64],
        outlets: &[bool],
        climate: &Climate,
        worth: impl Fn(&Hollow) -> bool,
    ) -> Self {
        let grid = way.grid;
        let lakes = open(hollows(grid, z, &way.surface_m));
        let waters = Self::gather(way, lakes, climate);
        if climate.loss_m3_s <= 0.0 {
            return waters;
        }
        let closed = waters.closed(grid, z, climate);
        if closed.is_empty() {
            return waters;
        }
        // All of a closed lake is an end: it may have more bottoms than one.
        let mut ends = outlets.to_vec();
        closed.iter().flat_map(|lake| &lake.cells).for_each(|&i| ends[i as usize] = true);
        let mut kept = hollows(grid, z, &Drainage::of(grid, z, &ends).surface_m);
        kept.retain(worth);
        fill(grid, z, &under(&ends, &kept));
        let way = Drainage::of(grid, z, &ends);
        let lakes = open(hollows(grid, z, &way.surface_m)).into_iter().chain(closed).collect();
        Self::gather(way, lakes, climate)
    }

    fn gather(way: Drainage, mut lakes: Vec<Lake>, climate: &Climate) -> Self {
        // What comes to a lake comes from above: from itself or over its shore.
        let wet = way.accumulate(&climate.runoff_m3_s);
        lakes.iter_mut().for_each(|lake| lake.dry = lake.cells.iter().all(|&i| wet[i as usize] <= 0.0));
        drop(wet);
        lakes.sort_by_key(|lake| (lake.dry, std::cmp::Reverse(lake.cells.len()), lake.bottom));
        let mut lake_of = vec![0; way.len()];
        for (lake, id) in lakes.iter().zip(1..) {
            lake.cells.iter().for_each(|&i| lake_of[i as usize] = id);
        }
        let mut discharge_m3_s = climate.runoff_m3_s.clone();
        if climate.loss_m3_s > 0.0 {
            lakes.iter().flat_map(|lake| &lake.cells).for_each(|&i| discharge_m3_s[i as usize] = -climate.loss_m3_s);
        }
        for &i in way.order.iter().rev() {
            let (i, r) = (i as usize, way.receiver[i as usize] as usize);
            if r != i {
                // A lake gives nothing rather than less than nothing.
                let given = discharge_m3_s[i];
                discharge_m3_s[r] += if lake_of[i] == lake_of[r] { given } else { given.max(0.0) };
            }
        }
        Self { way, lakes, lake_of, discharge_m3_s }
    }

    /// The lakes that water comes to, largest first.
    pub fn wet_lakes(&self) -> impl Iterator<Item = &Lake> {
        self.lakes.iter().take_while(|lake| !lake.dry)
    }

    /// The lakes whose outflow would be negative, with the level at which gain and loss are even.
    fn closed(&self, grid: Grid, z: &[f64], climate: &Climate) -> Vec<Lake> {
        let leaves = |i: usize| {
            let r = self.way.receiver[i] as usize;
            (self.lake_of[r] != self.lake_of[i] || r == i).then_some(self.discharge_m3_s[i])
        };
        let mut closed = Vec::new();
        for lake in &self.lakes {
            let net: f64 = lake.cells.iter().filter_map(|&i| leaves(i as usize)).sum();
            // A puddle of one cell cannot shrink.
            if net >= 0.0 || lake.cells.len() < 2 {
                continue;
            }
            // Ground that falls dry sheds like the rest of the land.
            let count = lake.cells.len() as f64;
            let floor: f64 = lake.cells.iter().map(|&i| climate.runoff_m3_s[i as usize]).sum();
            let gain = net + climate.loss_m3_s * count + floor;
            let even = gain / (climate.loss_m3_s + floor / count);
            let wet = (even as usize).clamp(1, lake.cells.len() - 1);
            let mut heights: Vec<f64> = lake.cells.iter().map(|&i| z[i as usize]).collect();
            let (_, &mut level_m, _) = heights.select_nth_unstable_by(wet, f64::total_cmp);
            let cells = pool(grid, z, lake.bottom, level_m);
            closed.push(Lake { cells, bottom: lake.bottom, level_m, closed: true, dry: false });
        }
        closed.retain(|lake| lake.cells.len() > 1);
        closed
    }

    /// Strahler's order of all cells that carry `least`; 0 elsewhere.
    pub fn order(&self, least_m3_s: f64) -> Vec<u8> {
        let cells = self.way.len();
        // Greatest order among the donors, and whether two of them share it.
        let mut greatest = vec![(0u8, false); cells];
        let mut order = vec![0; cells];
        for &i in self.way.order.iter().rev() {
            let i = i as usize;
            if self.discharge_m3_s[i] < least_m3_s || self.discharge_m3_s[i] <= 0.0 {
                continue;
            }
            let (most, twice) = greatest[i];
            order[i] = most.max(1) + u8::from(twice);
            let r = self.way.receiver[i] as usize;
            if r != i {
                let (most, _) = greatest[r];
                match order[i].cmp(&most) {
                    std::cmp::Ordering::Greater => greatest[r] = (order[i], false),
                    std::cmp::Ordering::Equal => greatest[r].1 = true,
                    std::cmp::Ordering::Less => {}
                }
            }
        }
        order
    }

    /// Basins by the outlet that water ends in, numbered from the largest, 1; 0 where `land` does not hold.
    pub fn basins(&self, land: impl Fn(usize) -> bool) -> Vec<u32> {
        let mut outlet = self.way.basin();
        // A closed lake ends at each of its cells, and is one basin all the same.
        for end in &mut outlet {
            if let Some(lake) = self.lake_of[*end as usize].checked_sub(1) {
                *end = self.lakes[lake as usize].bottom;
            }
        }
        let mut size = vec![0u32; outlet.len()];
        (0..outlet.len()).filter(|&i| land(i)).for_each(|i| size[outlet[i] as usize] += 1);
        let mut ranked: Vec<u32> = (0..outlet.len() as u32).filter(|&i| size[i as usize] > 0).collect();
        ranked.sort_by_key(|&i| (std::cmp::Reverse(size[i as usize]), i));
        let mut number = vec![0; outlet.len()];
        ranked.iter().zip(1..).for_each(|(&i, id)| number[i as usize] = id);
        (0..outlet.len()).map(|i| if land(i) { number[outlet[i] as usize] } else { 0 }).collect()
    }
}

/// Hollows as lakes that stand at their brims.
fn open(hollows: Vec<Hollow>) -> Vec<Lake> {
    let lake = |h: Hollow| Lake { cells: h.cells, bottom: h.bottom, level_m: h.level_m, closed: false, dry: false };
    hollows.into_iter().map(lake).collect()
}

/// The cells below a level that hang together with a bottom.
fn pool(grid: Grid, z: &[f64], bottom: u32, level_m: f64) -> Vec<u32> {
    let mut cells = vec![bottom];
    let mut seen = std::collections::BTreeSet::from([bottom]);
    let mut next = 0;
    while let Some(&i) = cells.get(next) {
        next += 1;
        for (j, _) in neighbours(grid, i as usize) {
            if z[j] < level_m && seen.insert(j as u32) {
                cells.push(j as u32);
            }
        }
    }
    cells
}
