//! Rivers and lakes over the relief: tapered lines whose width follows a root of the discharge, and lakes as sheets of
//! still water. They are drawn once on a clear sheet of the picture's size, which map and film lay over the ground.
//!
//! A small picture shows fewer rivers: those that drain at least so many of its pixels.

use tiny_skia::{FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

use super::{frame::unit_of, marks::Ink};
use crate::{
    grid::Grid,
    world::{Table, World},
};

const RIVER: Ink = Ink::hex(0x35769e);
const LAKE: Ink = Ink::hex(0x8fc4d8);
const SHORE: Ink = Ink::hex(0x24455a).alpha(165);
/// Pixels of a side from which all rivers are drawn.
const ALL_PX: f64 = 1000.0;
/// Smallest lake that is drawn, pixels.
const LEAST_LAKE_PX: f64 = 3.0;

/// Rivers and lakes on a clear sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Waters {
    width: usize,
    /// Red, green, blue, already times alpha, and alpha.
    pixels: Vec<[u8; 4]>,
}

impl Waters {
    /// The waters of a world for a picture of these pixels; `None` where it has none.
    pub fn of(world: &World, pixels: &Grid) -> Option<Self> {
        let (rivers, lakes) = (world.table("rivers"), world.table("lake_outlines"));
        if rivers.is_none_or(|table| table.rows() == 0) && lakes.is_none_or(|table| table.rows() == 0) {
            return None;
        }
        let mut sheet = Pixmap::new(pixels.width as u32, pixels.height as u32)?;
        if let Some(lines) = rivers.and_then(|table| Lines::of(table, pixels)) {
            lines.draw(&mut sheet);
        }
        if let Some(table) = lakes {
            draw_lakes(table, pixels, &mut sheet);
        }
        let pixels = sheet.data().chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect();
        Some(Self { width: sheet.width() as usize, pixels })
    }

    /// Lays a row of the sheet over opaque pixels of `STEP` bytes that begin with red, green and blue.
    pub fn lay<const STEP: usize>(&self, y: usize, share: f32, row: &mut [u8]) {
        let strength = (share.clamp(0.0, 1.0) * 256.0) as u32;
        for (out, ink) in row.chunks_exact_mut(STEP).zip(&self.pixels[y * self.width..][..self.width]) {
            if ink[3] == 0 {
                continue;
            }
            let rest = 255 * 256 - ink[3] as u32 * strength;
            for c in 0..3 {
                out[c] = ((ink[c] as u32 * strength * 255 + out[c] as u32 * rest + 32_640) / 65_280) as u8;
            }
        }
    }
}

/// The rivers' points in pixels.
struct Lines<'a> {
    river: &'a [f64],
    at: [&'a [f64]; 2],
    discharge: &'a [f64],
    /// Pixels of a km.
    scale: f64,
    unit: f64,
    /// Least discharge that is drawn.
    least: f64,
}

impl<'a> Lines<'a> {
    fn of(table: &'a Table, pixels: &Grid) -> Option<Self> {
        let column = |name: &str| table.numbers(name);
        let (river, discharge) = (column("river")?, column("discharge_m3_s")?);
        let at = [column("x_km")?, column("y_km")?];
        let least = discharge.iter().copied().filter(|&q| q > 0.0).fold(f64::INFINITY, f64::min);
        let fewer = ALL_PX / pixels.width.max(pixels.height) as f64;
        let least = least * (fewer * fewer).max(1.0);
        Some(Self { river, at, discharge, scale: 1000.0 / pixels.cell_m, unit: unit_of(pixels) as f64, least })
    }

    fn draw(&self, sheet: &mut Pixmap) {
        let mut from = 0;
        while from < self.river.len() {
            let same = self.river[from..].iter().take_while(|&&id| id == self.river[from]).count();
            let line: Vec<usize> = (from..from + same).filter(|&k| self.discharge[k] >= self.least).collect();
            if let Some(strip) = self.strip(&line) {
                sheet.fill_path(&strip, &paint(RIVER), FillRule::Winding, Transform::identity(), None);
            }
            from += same;
        }
    }

    fn place(&self, k: usize) -> [f64; 2] {
        self.at.map(|axis| axis[k] * self.scale)
    }

    /// Width by the discharge, pixels: a head begins thin.
    fn width_px(&self, k: usize) -> f64 {
        let times = self.discharge[k] / self.least;
        let head = (0.45 + 0.8 * (times - 1.0)).clamp(0.45, 1.0);
        (0.85 * head * libm::pow(times, 0.26)).min(4.5) * self.unit
    }

    /// The band between both banks.
    fn strip(&self, line: &[usize]) -> Option<Path> {
        let places: Vec<[f64; 2]> = line.iter().map(|&k| self.place(k)).collect();
        let bank = |side: f64, n: usize| {
            let (a, b) = (places[n.saturating_sub(1)], places[(n + 1).min(places.len() - 1)]);
            let d = [b[0] - a[0], b[1] - a[1]];
            let length = libm::sqrt(d[0] * d[0] + d[1] * d[1]).max(1e-9);
            let half = 0.5 * side * self.width_px(line[n]);
            [places[n][0] - d[1] / length * half, places[n][1] + d[0] / length * half].map(|v| v as f32)
        };
        let mut points = (0..line.len()).map(|n| bank(1.0, n)).chain((0..line.len()).rev().map(|n| bank(-1.0, n)));
        let mut builder = PathBuilder::new();
        let [x, y] = points.next().filter(|_| line.len() > 1)?;
        builder.move_to(x, y);
        points.for_each(|[x, y]| builder.line_to(x, y));
        builder.close();
        builder.finish()
    }
}

fn draw_lakes(table: &Table, pixels: &Grid, sheet: &mut Pixmap) {
    let column = |name: &str| table.numbers(name).unwrap_or_default();
    let (lake, ring, x, y) = (column("lake"), column("ring"), column("x_km"), column("y_km"));
    let rows = lake.len().min(ring.len()).min(x.len()).min(y.len());
    let scale = 1000.0 / pixels.cell_m;
    let unit = unit_of(pixels);
    let stroke = Stroke { width: 0.8 * unit, line_join: LineJoin::Round, ..Stroke::default() };
    let mut from = 0;
    while from < rows {
        let mut builder = PathBuilder::new();
        let mut area_px = 0.0;
        let begin = from;
        while from < rows && lake[from] == lake[begin] {
            let points = (from..rows).take_while(|&k| lake[k] == lake[from] && ring[k] == ring[from]).count();
            let place = |k: usize| [x[k] * scale, y[k] * scale];
            for k in from..from + points {
                let (a, b) = (place(k), place(if k + 1 < from + points { k + 1 } else { from }));
                area_px += 0.5 * (a[0] * b[1] - b[0] * a[1]);
                let to = a.map(|v| v as f32);
                if k == from { builder.move_to(to[0], to[1]) } else { builder.line_to(to[0], to[1]) }
            }
            builder.close();
            from += points;
        }
        if area_px < LEAST_LAKE_PX {
            continue;
        }
        if let Some(path) = builder.finish() {
            sheet.fill_path(&path, &paint(LAKE), FillRule::EvenOdd, Transform::identity(), None);
            sheet.stroke_path(&path, &paint(SHORE), &stroke, Transform::identity(), None);
        }
    }
}

fn paint(ink: Ink) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(ink.0, ink.1, ink.2, ink.3);
    paint.anti_alias = true;
    paint
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Edges;

    fn world(discharge: Vec<f64>) -> World {
        let count = discharge.len();
        let mut world = World::new(Grid::new(64, 64, 64_000.0, Edges::Open), 0.0);
        world.set_table(
            Table::new("rivers")
                .number("river", "1", vec![1.0; count])
                .number("x_km", "km", (0..count).map(|k| 60.0 * k as f64 / (count - 1) as f64).collect())
                .number("y_km", "km", vec![32.0; count])
                .number("discharge_m3_s", "m3/s", discharge),
        );
        world
    }

    #[test]
    fn a_river_widens_downstream_and_small_pictures_leave_its_head_out() {
        let world = world((0..61).map(|k| 1.0 + k as f64 * 5.0).collect());
        let ink = |px: usize| {
            let waters = Waters::of(&world, &Grid::new(px, px, 64_000.0, Edges::Open)).unwrap();
            let column = |x: usize| (0..px).map(|y| waters.pixels[y * px + x][3] as f64 / 255.0).sum::<f64>();
            [1, 4, 8].map(|part| column(px * part / 10))
        };
        let [head, middle, mouth] = ink(1024);
        assert!(head > 0.4 && middle > head && mouth > middle, "{head} {middle} {mouth}");
        assert!(ink(100)[0] == 0.0 && ink(100)[2] > 0.4, "{:?}", ink(100));
    }

    #[test]
    fn laying_is_plain_blending() {
        let waters = Waters { width: 2, pixels: vec![[0; 4], [100, 0, 0, 128]] };
        let mut row = [10, 20, 30, 10, 20, 30];
        waters.lay::<3>(0, 1.0, &mut row);
        assert_eq!(row, [10, 20, 30, 105, 10, 15]);
        waters.lay::<3>(0, 0.0, &mut row);
        assert_eq!(row, [10, 20, 30, 105, 10, 15]);
    }

    #[test]
    fn a_world_without_rivers_has_none() {
        assert_eq!(
            Waters::of(&World::new(Grid::new(4, 4, 4.0, Edges::Open), 0.0), &Grid::new(4, 4, 4.0, Edges::Open)),
            None
        );
    }
}
