//! Plates: rigid outlines, the borders on the ground by what they do, and motions.

use super::{
    View,
    shapes::{self, Line, Polygon},
};
use crate::{
    grid::{Field, contour_lines, for_each_row},
    world::{Kind, Layer, World},
};

/// A plate and its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The plate's number.
    pub plate: u32,
    /// Its middle, m.
    pub at_m: [f64; 2],
    /// Speed, mm/yr.
    pub speed_mm_per_yr: f64,
    /// Compass direction, deg.
    pub heading_deg: f64,
}

/// The outlines of the plates within the view.
pub fn outlines(world: &World, view: &View) -> Vec<(u32, Polygon)> {
    let Some(table) = world.table("plate_outlines") else { return Vec::new() };
    let column = |name: &str| table.numbers(name).unwrap_or_default();
    let (plate, x, y) = (column("plate"), column("x_km"), column("y_km"));
    let mut all = Vec::new();
    let mut from = 0;
    while from < plate.len().min(x.len()).min(y.len()) {
        let end = from + plate[from..].iter().take_while(|&&id| id == plate[from]).count();
        let line: Line = (from..end).map(|k| [x[k] * 1e3, y[k] * 1e3]).collect();
        let mut ring = shapes::cut_ring(&line, view);
        if shapes::area(&ring) < 0.0 {
            ring.reverse();
        }
        if ring.len() > 2 {
            all.push((plate[from] as u32, Polygon { outer: ring, holes: Vec::new() }));
        }
        from = end;
    }
    all
}

/// The motions of plates whose middle lies within the view.
pub fn motions(world: &World, view: &View) -> Vec<Motion> {
    let Some(table) = world.table("plates") else { return Vec::new() };
    let column = |name: &str| table.numbers(name).unwrap_or_default();
    let (id, x, y) = (column("id"), column("x_km"), column("y_km"));
    let (speed, heading) = (column("speed_mm_per_yr"), column("heading_deg"));
    let rows = [id, x, y, speed, heading].iter().map(|c| c.len()).min().unwrap_or(0);
    (0..rows)
        .map(|k| Motion {
            plate: id[k] as u32,
            at_m: [x[k] * 1e3, y[k] * 1e3],
            speed_mm_per_yr: speed[k],
            heading_deg: heading[k],
        })
        .filter(|motion| view.holds(motion.at_m))
        .collect()
}

/// The borders between plates on the ground, smooth, each with what it does.
pub fn borders(world: &World, view: &View) -> Vec<(&'static str, Line)> {
    let Some(plates) = world.layer(Layer::PlateId) else { return Vec::new() };
    let kinds = world.layer(Layer::BoundaryKind);
    let Kind::Class(names) = Layer::BoundaryKind.spec().kind else { return Vec::new() };
    let mut ids: Vec<u32> = plates.data.iter().map(|&id| id as u32).collect();
    ids.sort_unstable();
    ids.dedup();
    let mut all = Vec::new();
    for id in ids {
        let own = plates.map(|other| f32::from(other as u32 == id));
        for contour in contour_lines(&softened(own), 0.5) {
            let line = shapes::line_of(contour);
            for (kind, part) in parts(&line, id, plates, kinds) {
                let name = names.get(kind).copied().unwrap_or("none");
                let thinned = shapes::thin(&part, 0.1 * plates.grid.cell_m);
                all.extend(shapes::cut_line(&thinned, view).into_iter().map(|line| (name, line)));
            }
        }
    }
    all
}

/// Takes the stairs out of a raster of 0 and 1: four rounds of 1 2 1, both ways.
fn softened(mut field: Field<f32>) -> Field<f32> {
    let grid = field.grid;
    for _ in 0..4 {
        for across in [true, false] {
            let from = field.clone();
            for_each_row(&mut field.data, grid.width, |y, row| {
                let (north, here, south) = (from.row(grid.row(y, -1)), from.row(y), from.row(grid.row(y, 1)));
                for (x, out) in row.iter_mut().enumerate() {
                    let (a, b) =
                        if across { (here[grid.column(x, -1)], here[grid.column(x, 1)]) } else { (north[x], south[x]) };
                    *out = 0.25 * (a + b) + 0.5 * here[x];
                }
            });
        }
    }
    field
}

/// The parts of a plate's border along plates of higher number, cut where the kind changes; every border comes once.
fn parts(line: &[[f64; 2]], id: u32, plates: &Field<f32>, kinds: Option<&Field<f32>>) -> Vec<(usize, Line)> {
    let seen: Vec<Option<usize>> = line.iter().map(|&at| look(at, id, plates, kinds)).collect();
    let mut all: Vec<(usize, Line)> = Vec::new();
    let mut begin = 0;
    while begin < line.len() {
        let end = begin + seen[begin..].iter().take_while(|&&other| other == seen[begin]).count();
        if let Some(kind) = seen[begin] {
            // One point on, so that parts meet.
            all.push((kind, line[begin..(end + 1).min(line.len())].to_vec()));
        }
        begin = end;
    }
    all.retain(|(_, line)| line.len() > 1);
    all
}

/// What the border does at a place, if the plate beyond has a higher number.
fn look(at_m: [f64; 2], id: u32, plates: &Field<f32>, kinds: Option<&Field<f32>>) -> Option<usize> {
    const REACH: isize = 2;
    let grid = plates.grid;
    let cell = |m: f64, size: usize| ((m / grid.cell_m).max(0.0) as usize).min(size - 1);
    let (x, y) = (cell(at_m[0], grid.width), cell(at_m[1], grid.height));
    let mut votes = [0u32; 8];
    let mut others: Vec<(u32, f64)> = Vec::new();
    for dy in -REACH..=REACH {
        for dx in -REACH..=REACH {
            let (i, j) = (grid.column(x, dx), grid.row(y, dy));
            let other = plates.at(i, j) as u32;
            if other != id {
                let [cx, cy] = grid.center_m(i, j);
                others.push((other, libm::hypot(cx - at_m[0], cy - at_m[1])));
            }
            if let Some(kinds) = kinds {
                votes[(kinds.at(i, j) as usize).min(7)] += 1;
            }
        }
    }
    let nearest = others.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let kind = (1..votes.len()).rev().max_by_key(|&k| votes[k]).filter(|&k| votes[k] > 0).unwrap_or(0);
    (nearest > id).then_some(kind)
}
