//! What stands beside, below or on the moving map: title, legend, caption, clock.
//!
//! Where the map leaves room on its right or below it, there is a sheet of paper; else words stand on the map.

use super::{
    super::{
        furniture::Legend,
        marks::{Canvas, Ink},
        text::{self, Align},
    },
    Words,
};

const PAPER: Ink = Ink::hex(0xfaf8f2);
const INK: Ink = Ink::hex(0x2d3438);
const FAINT: Ink = Ink::hex(0x6d7478);
const HALO: Ink = Ink::hex(0xfaf8f2).alpha(150);

/// Where words stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Room {
    Right,
    Below,
    OnTheMap,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Area {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// A line of words: where, how large, in what ink.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    area: Area,
    size_px: f32,
    ink: Ink,
}

/// The paper around the map.
pub struct Sheet {
    width: usize,
    room: Room,
    /// The picture without map and changing words.
    paper: Vec<u8>,
    title: Option<(String, Line)>,
    caption: Line,
    clock: Line,
}

impl Sheet {
    /// The paper of a film; `map` are the map's pixels in the upper left corner.
    pub fn new(size: [usize; 2], map: [usize; 2], title: Option<&str>, legend: &Legend) -> Self {
        let [width, height] = size;
        let u = width.min(height) as f32 / 720.0;
        let (right, below) = (width - map[0], height - map[1]);
        let room = if right as f32 >= 220.0 * u {
            Room::Right
        } else if below as f32 >= 52.0 * u {
            Room::Below
        } else {
            Room::OnTheMap
        };
        let mut canvas = Canvas::blank(width, height, PAPER);
        let line = |[x, y]: [f32; 2], wide: f32, size: f32, ink: Ink| Line {
            area: Area {
                x: x.round() as usize,
                y: y.round() as usize,
                width: (wide.round() as usize).min(width - (x.round() as usize).min(width)),
                height: ((1.5 * size).round() as usize).min(height - (y.round() as usize).min(height)),
            },
            size_px: size,
            ink,
        };
        let (w, h, left, top) = (width as f32, height as f32, map[0] as f32, map[1] as f32);
        let (title_line, caption, clock) = match room {
            Room::Right => {
                let (x, wide) = (left + 30.0 * u, right as f32 - 60.0 * u);
                let across = wide.min(460.0 * u);
                // Many names take many lines.
                let below = (legend.tall(across, 1.15 * u) + 20.0 * u).max(92.0 * u);
                legend.draw(&mut canvas, [x, h - below], across, 1.15 * u);
                (
                    line([x, 34.0 * u], wide, 30.0 * u, INK),
                    line([x, 84.0 * u], wide, 21.0 * u, FAINT),
                    line([x, h - below - 80.0 * u], wide, 34.0 * u, INK),
                )
            }
            Room::Below => {
                let (y, third) = (top + 0.5 * below as f32 - 17.0 * u, w / 3.0 - 20.0 * u);
                (
                    line([20.0 * u, y - 3.0 * u], third, 26.0 * u, INK),
                    line([w / 3.0 + 10.0 * u, y], third, 21.0 * u, FAINT),
                    line([2.0 * w / 3.0 + 10.0 * u, y - 3.0 * u], third, 26.0 * u, INK),
                )
            }
            Room::OnTheMap => {
                let y = h - 50.0 * u;
                (
                    line([20.0 * u, 14.0 * u], w - 40.0 * u, 26.0 * u, INK),
                    line([20.0 * u, y], 0.6 * w, 21.0 * u, INK),
                    line([0.7 * w, y], 0.3 * w - 20.0 * u, 26.0 * u, INK),
                )
            }
        };
        let title = title.map(|title| (title.to_owned(), title_line));
        let mut sheet = Self { width, room, paper: canvas.into_image().into_raw(), title: None, caption, clock };
        match title {
            // On paper it is written once.
            Some((title, line)) if room != Room::OnTheMap => {
                let mut paper = std::mem::take(&mut sheet.paper);
                sheet.put(&title, line, &mut paper);
                sheet.paper = paper;
            }
            title => sheet.title = title,
        }
        sheet
    }

    /// Lays the paper out.
    pub fn lay(&self, picture: &mut [u8]) {
        picture.copy_from_slice(&self.paper);
    }

    /// Writes what changes from picture to picture.
    pub fn write(&self, words: Words, picture: &mut [u8]) {
        if let Some((title, line)) = &self.title {
            self.put(title, *line, picture);
        }
        self.put(words.caption, self.caption, picture);
        self.put(words.clock, self.clock, picture);
    }

    fn put(&self, words: &str, line: Line, picture: &mut [u8]) {
        let Area { x, y, width, height } = line.area;
        if words.is_empty() || width == 0 || height == 0 {
            return;
        }
        let rows = (y..y + height).map(|row| (row * self.width + x) * 3);
        let bytes: Vec<u8> = rows.clone().flat_map(|at| picture[at..at + width * 3].iter().copied()).collect();
        let Some(image) = image::RgbImage::from_raw(width as u32, height as u32, bytes) else { return };
        let mut canvas = Canvas::from_image(&image);
        let size = line.size_px;
        let fitted = text::fitted(words, size, width as f32);
        let at = [2.0, 1.05 * size];
        match self.room {
            Room::OnTheMap => text::write_haloed(&mut canvas, &fitted, at, size, Align::Left, line.ink, HALO),
            _ => text::write(&mut canvas, &fitted, at, size, Align::Left, line.ink),
        }
        let written = canvas.into_image();
        for (at, row) in rows.zip(written.as_raw().chunks_exact(width * 3)) {
            picture[at..at + width * 3].copy_from_slice(row);
        }
    }
}
