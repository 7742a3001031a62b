//! Plates over the map: their borders by what they do, and their motions.
//!
//! Plate numbers are a raster, so borders would be stairs. Around a pixel the share of its own plate under a Gaussian
//! tells how far the border is (one half on it), which draws it smooth and of one width.

use super::{
    frame::Frame,
    furniture::Symbol,
    marks::{Canvas, Ink},
    swatches::BOUNDARIES,
    text::{self, Align},
};
use crate::{
    grid::{Field, for_each_row},
    world::{Layer, World},
};

const COLLISION: usize = 1;
const SUBDUCTION: usize = 2;
const SPREADING: usize = 3;
const CASING: Ink = Ink::hex(0xffffff);
const ARROW: Ink = Ink::hex(0x1d2328);

/// A border near a pixel.
#[derive(Clone, Copy, Default)]
struct Near {
    /// Distance, pixels.
    distance_px: f32,
    /// What the border does, plus one; 0 where there is no border near.
    kind: u8,
}

/// Draws borders and motions; returns what the legend shall explain.
pub fn draw(canvas: &mut Canvas, frame: &Frame, world: &World) -> Vec<Symbol> {
    let mut symbols = Vec::new();
    if let Some(plates) = world.layer(Layer::PlateId) {
        let plates = frame.nearest(plates);
        let kinds = world.layer(Layer::BoundaryKind).map(|field| frame.nearest(field));
        let near = borders(&plates, kinds.as_ref(), frame.unit());
        stroke(canvas, &near, frame.unit());
        teeth(canvas, frame, world, &near, &plates);
        symbols = legend(&near);
    }
    if motions(canvas, frame, world) {
        symbols
            .push(Symbol { name: "motion, mm/yr".to_owned(), draw: |c, [x, y], l, u| arrow(c, [x, y], [x + l, y], u) });
    }
    symbols
}

fn borders(plates: &Field<f32>, kinds: Option<&Field<f32>>, unit: f32) -> Field<Near> {
    let sigma = 1.6 * unit;
    let reach = (2.2 * sigma).ceil() as isize;
    let weight: Vec<f32> = (-reach..=reach).map(|d| libm::expf(-((d * d) as f32) / (2.0 * sigma * sigma))).collect();
    let grid = plates.grid;
    let mut near = Field::filled(grid, Near::default());
    for_each_row(&mut near.data, grid.width, |y, row| {
        let rows: Vec<usize> = (-reach..=reach).map(|d| grid.row(y, d)).collect();
        for (x, out) in row.iter_mut().enumerate() {
            let own = plates.at(x, y);
            let far = |d: isize| plates.at(grid.column(x, d), y) == own && plates.at(x, grid.row(y, d)) == own;
            let corner = |dx: isize, dy: isize| plates.at(grid.column(x, dx), grid.row(y, dy)) == own;
            let half = reach / 2;
            let inside = [-reach, -half, half, reach].into_iter().all(far)
                && [(-half, -half), (half, -half), (-half, half), (half, half)].into_iter().all(|(a, b)| corner(a, b));
            if inside {
                continue;
            }
            let (mut same, mut all) = (0.0f32, 0.0f32);
            let mut votes = [0u16; BOUNDARIES.len()];
            for (&j, wy) in rows.iter().zip(&weight) {
                for (d, wx) in (-reach..=reach).zip(&weight) {
                    let i = grid.column(x, d);
                    all += wx * wy;
                    same += if plates.at(i, j) == own { wx * wy } else { 0.0 };
                    if let Some(kinds) = kinds {
                        votes[(kinds.at(i, j) as usize).min(votes.len() - 1)] += 1;
                    }
                }
            }
            let share = same / all;
            if share < 0.995 {
                let kind = (1..votes.len()).rev().max_by_key(|&k| votes[k]).filter(|&k| votes[k] > 0).unwrap_or(0);
                // The inverse of the normal distribution near one half.
                *out = Near { distance_px: (share - 0.5).abs() * sigma * 2.507, kind: kind as u8 + 1 };
            }
        }
    });
    near
}

fn stroke(canvas: &mut Canvas, near: &Field<Near>, unit: f32) {
    for (i, near_here) in near.data.iter().enumerate().filter(|(_, n)| n.kind > 0) {
        let (x, y) = near.grid.cell_of(i);
        let (d, kind) = (near_here.distance_px, near_here.kind as usize - 1);
        let cover = |half: f32| (half + 0.5 - d).clamp(0.0, 1.0);
        let half = if kind == 0 { 0.6 * unit } else { 1.15 * unit };
        let (x, y) = (x as i64, y as i64);
        canvas.blend(x, y, CASING.alpha(120), cover(half + 0.9 * unit));
        let ink = if kind == 0 { Ink::hex(0x4a4f55).alpha(170) } else { Ink::hex(BOUNDARIES[kind]) };
        if kind == SPREADING {
            // A double line: the axis stays open.
            let ring = (0.55 * unit + 0.5 - (d - 1.35 * unit).abs()).clamp(0.0, 1.0);
            canvas.blend(x, y, ink, ring);
        } else {
            canvas.blend(x, y, ink, cover(half));
        }
    }
}

/// Triangles on subduction zones, pointing to the plate that rides over the other.
fn teeth(canvas: &mut Canvas, frame: &Frame, world: &World, near: &Field<Near>, plates: &Field<f32>) {
    let unit = frame.unit();
    let (spacing, size) = (17.0 * unit, 6.0 * unit);
    let rank = Rank::new(frame, world);
    let mut taken: Vec<[f32; 2]> = Vec::new();
    for (i, near_here) in near.data.iter().enumerate() {
        if near_here.kind as usize != SUBDUCTION + 1 || near_here.distance_px > 0.7 {
            continue;
        }
        let (x, y) = near.grid.cell_of(i);
        let at = [x as f32 + 0.5, y as f32 + 0.5];
        // Rows go down, so near ones are the last taken.
        let close = |p: &[f32; 2]| (p[0] - at[0]).powi(2) + (p[1] - at[1]).powi(2) < spacing * spacing;
        if taken.iter().any(close) {
            continue;
        }
        let Some(normal) = normal(plates, x, y, (4.0 * unit).ceil() as isize) else { continue };
        let side = |sign: f32| {
            let reach = sign * 7.0 * unit;
            rank.at(at[0] + normal[0] * reach, at[1] + normal[1] * reach)
        };
        let sign = if side(1.0) >= side(-1.0) { 1.0 } else { -1.0 };
        let [nx, ny] = normal.map(|v| v * sign);
        let base = |along: f32| [at[0] - ny * along * 0.62 * size, at[1] + nx * along * 0.62 * size];
        let tip = [at[0] + nx * size, at[1] + ny * size];
        canvas.polygon(&[base(-1.0), tip, base(1.0)], Ink::hex(BOUNDARIES[SUBDUCTION]));
        taken.push(at);
    }
}

/// Which of two plates rides over the other: the lighter crust, then the younger, then the higher ground.
struct Rank {
    fields: Vec<(Field<f32>, f32)>,
}

impl Rank {
    fn new(frame: &Frame, world: &World) -> Self {
        let ranked = [(Layer::CrustKind, 1e6), (Layer::CrustAge, -1e2), (Layer::Height, 1e-3)];
        let present = ranked.into_iter().filter_map(|(layer, weight)| Some((world.view(layer)?, weight)));
        Self { fields: present.map(|(field, weight)| (frame.continuous(&field), weight)).collect() }
    }

    fn at(&self, x: f32, y: f32) -> f32 {
        let value = |(field, weight): &(Field<f32>, f32)| {
            let clamp = |v: f32, size: usize| (v.max(0.0) as usize).min(size - 1);
            let v = field.at(clamp(x, field.grid.width), clamp(y, field.grid.height));
            // Crust is either kind; a smoothed border between them is not.
            if *weight > 1e5 { v.round() * weight } else { v * weight }
        };
        self.fields.iter().map(value).sum()
    }
}

/// The direction away from the own plate: minus the mean offset of its pixels.
fn normal(plates: &Field<f32>, x: usize, y: usize, reach: isize) -> Option<[f32; 2]> {
    let own = plates.at(x, y);
    let mut mean = [0.0f32; 2];
    for dy in -reach..=reach {
        for dx in -reach..=reach {
            if plates.at(plates.grid.column(x, dx), plates.grid.row(y, dy)) == own {
                mean = [mean[0] - dx as f32, mean[1] - dy as f32];
            }
        }
    }
    let length = (mean[0] * mean[0] + mean[1] * mean[1]).sqrt();
    (length > 0.0).then(|| mean.map(|v| v / length))
}

fn legend(near: &Field<Near>) -> Vec<Symbol> {
    let seen = |kind: usize| near.data.iter().any(|n| n.kind as usize == kind + 1);
    let symbol = |name: &str, draw| Symbol { name: name.to_owned(), draw };
    let mut symbols = Vec::new();
    if seen(COLLISION) {
        symbols.push(symbol("collision", |c, at, l, u| sample(c, at, l, 2.3 * u, COLLISION)));
    }
    if seen(SUBDUCTION) {
        symbols.push(symbol("subduction", |c, [x, y], l, u| {
            sample(c, [x, y], l, 2.3 * u, SUBDUCTION);
            for k in [0.25, 0.75] {
                let at = x + l * k;
                let triangle = [[at - 3.7 * u, y], [at, y - 6.0 * u], [at + 3.7 * u, y]];
                c.polygon(&triangle, Ink::hex(BOUNDARIES[SUBDUCTION]));
            }
        }));
    }
    if seen(SPREADING) {
        symbols.push(symbol("spreading", |c, [x, y], l, u| {
            for side in [-1.35, 1.35] {
                sample(c, [x, y + side * u], l, 1.1 * u, SPREADING);
            }
        }));
    }
    if seen(4) {
        symbols.push(symbol("transform", |c, at, l, u| sample(c, at, l, 2.3 * u, 4)));
    }
    symbols
}

fn sample(canvas: &mut Canvas, [x, y]: [f32; 2], length: f32, width: f32, kind: usize) {
    canvas.line(&[[x, y], [x + length, y]], width, Ink::hex(BOUNDARIES[kind]));
}

/// An arrow for every plate of the table whose middle lies on the map.
fn motions(canvas: &mut Canvas, frame: &Frame, world: &World) -> bool {
    let Some(table) = world.table("plates") else { return false };
    let column = |name: &str| table.numbers(name);
    let (Some(xs), Some(ys), Some(speeds), Some(headings)) =
        (column("x_km"), column("y_km"), column("speed_mm_per_yr"), column("heading_deg"))
    else {
        return false;
    };
    let unit = frame.unit();
    let fastest = speeds.iter().fold(0.0f64, |a, &b| a.max(b));
    let [wide, tall] = [frame.grid.width as f32, frame.grid.height as f32];
    let mut drawn = false;
    for i in 0..table.rows() {
        let at = [xs[i], ys[i]].map(|km| (km * 1000.0 / frame.grid.cell_m) as f32);
        let on_map = at[0] >= 0.0 && at[1] >= 0.0 && at[0] <= wide && at[1] <= tall;
        let moves = speeds[i] > 0.0 && fastest.is_finite() && headings[i].is_finite();
        if !(on_map && moves) {
            continue;
        }
        let length = (18.0 + 46.0 * (speeds[i] / fastest) as f32) * unit;
        let heading = headings[i].to_radians();
        let (dx, dy) = (libm::sin(heading) as f32 * length / 2.0, -libm::cos(heading) as f32 * length / 2.0);
        arrow(canvas, [at[0] - dx, at[1] - dy], [at[0] + dx, at[1] + dy], unit);
        let below = [at[0], at[1] + dy.abs() + 16.0 * unit];
        let speed = format!("{:.0}", speeds[i]);
        text::write_haloed(canvas, &speed, below, 12.5 * unit, Align::Middle, ARROW, CASING);
        drawn = true;
    }
    drawn
}

/// A cased arrow between two points.
fn arrow(canvas: &mut Canvas, from: [f32; 2], to: [f32; 2], unit: f32) {
    let d = [to[0] - from[0], to[1] - from[1]];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt().max(1e-3);
    let along = d.map(|v| v / length);
    let across = [-along[1], along[0]];
    let shape = |grow: f32| {
        let (shaft, head, wing) = (1.1 * unit + grow, 10.0 * unit + 1.6 * grow, 4.4 * unit + 1.5 * grow);
        let point = |a: f32, b: f32| [0, 1].map(|c| from[c] + along[c] * a + across[c] * b);
        let (back, neck, tip) = (-grow, (length - head + grow).max(0.0), length + 1.6 * grow);
        [
            point(back, -shaft),
            point(neck, -shaft),
            point(neck, -wing),
            point(tip, 0.0),
            point(neck, wing),
            point(neck, shaft),
            point(back, shaft),
        ]
    };
    canvas.polygon(&shape(1.2 * unit), CASING.alpha(215));
    canvas.polygon(&shape(0.0), ARROW);
}
