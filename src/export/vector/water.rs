//! Rivers and lakes from their tables.

use super::{
    View,
    shapes::{self, Line, Polygon},
};
use crate::world::{Table, World};

/// A river is cut into reaches where its discharge has grown by this much.
const GROWTH: f64 = 1.25;

/// A part of a river of about one discharge.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// The river's number, the largest is 1.
    pub river: u32,
    /// The reach's place in its river, from the head, 1.
    pub part: u32,
    /// Points downstream.
    pub line: Line,
    /// Discharge at the reach's end, m³/s.
    pub discharge_m3_s: f64,
    /// Width there, m.
    pub width_m: f64,
    /// Strahler's order.
    pub order: u32,
    /// What the river ends in: sea, lake, river, rim or sink.
    pub into: String,
    /// The number of that river or lake, else 0.
    pub into_id: u32,
}

/// A lake.
#[derive(Clone, Debug, PartialEq)]
pub struct Lake {
    /// Its number, the largest is 1.
    pub id: u32,
    /// Its water.
    pub shape: Vec<Polygon>,
    /// Height of its surface, m.
    pub level_m: f64,
    /// Greatest depth, m.
    pub depth_m: f64,
    /// Area of the whole lake, km².
    pub area_km2: f64,
}

/// The rivers of a world within the view, from the largest.
pub fn rivers(world: &World, view: &View) -> Vec<Reach> {
    world.table("rivers").and_then(|table| reaches(table, view)).unwrap_or_default()
}

fn reaches(table: &Table, view: &View) -> Option<Vec<Reach>> {
    let (id, x, y) = (table.numbers("river")?, table.numbers("x_km")?, table.numbers("y_km")?);
    let (discharge, width) = (table.numbers("discharge_m3_s")?, table.numbers("width_m")?);
    let (order, into, into_id) = (table.numbers("order")?, table.words("into")?, table.numbers("into_id")?);
    let mut all = Vec::new();
    let mut from = 0;
    while from < id.len() {
        let end = from + id[from..].iter().take_while(|&&other| other == id[from]).count();
        let (mut begin, mut part) = (from, 0);
        for k in from + 1..end {
            let grown = discharge[k] > GROWTH * discharge[begin] || order[k] != order[begin];
            if !grown && k + 1 < end {
                continue;
            }
            part += 1;
            let line: Line = (begin..=k).map(|k| [x[k] * 1e3, y[k] * 1e3]).collect();
            let cut = if view.whole() { vec![line] } else { shapes::cut_line(&line, view) };
            all.extend(cut.into_iter().map(|line| Reach {
                river: id[k] as u32,
                part,
                line,
                discharge_m3_s: discharge[k],
                width_m: width[k],
                order: order[begin] as u32,
                into: into[k].clone(),
                into_id: into_id[k] as u32,
            }));
            begin = k;
        }
        from = end;
    }
    Some(all)
}

/// The lakes of a world within the view, from the largest.
pub fn lakes(world: &World, view: &View) -> Vec<Lake> {
    let found = world.table("lake_outlines").zip(world.table("lakes"));
    found.and_then(|(outlines, lakes)| shapes_of(outlines, lakes, view)).unwrap_or_default()
}

fn shapes_of(outlines: &Table, lakes: &Table, view: &View) -> Option<Vec<Lake>> {
    let (level, depth, area) = (lakes.numbers("level_m")?, lakes.numbers("depth_m")?, lakes.numbers("area_km2")?);
    let ids = lakes.numbers("lake")?;
    let (id, ring) = (outlines.numbers("lake")?, outlines.numbers("ring")?);
    let (x, y) = (outlines.numbers("x_km")?, outlines.numbers("y_km")?);
    let mut rings: Vec<(f64, Line)> = Vec::new();
    let mut from = 0;
    while from < id.len() {
        let end = from + (from..id.len()).take_while(|&k| id[k] == id[from] && ring[k] == ring[from]).count();
        let line: Line = (from..end).map(|k| [x[k] * 1e3, y[k] * 1e3]).collect();
        rings.push((id[from], if view.whole() { line } else { shapes::cut_ring(&line, view) }));
        from = end;
    }
    let shape = |wanted: f64| {
        let own = rings.iter().filter(|(id, line)| *id == wanted && line.len() > 2);
        shapes::polygons(own.map(|(_, line)| line.clone()).collect(), 0.0)
    };
    let all = (0..ids.len()).map(|k| Lake {
        id: ids[k] as u32,
        shape: shape(ids[k]),
        level_m: level[k],
        depth_m: depth[k],
        area_km2: area[k],
    });
    Some(all.filter(|lake| !lake.shape.is_empty()).collect())
}
