//! ESRI ASCII grids: a few named numbers, then rows of heights as text, from the north.
//!
//! `ncols nrows xllcorner|xllcenter yllcorner|yllcenter cellsize [nodata_value]`; some programs write `dx dy` for cells that
//! are not square. The text is read number by number, however long its lines are.

use super::{DEGREE_M, Format, Header, Input, Sample, Scale, checked, damaged, io_problem};
use crate::edit::Problem;

/// No number in such a file is longer.
const LONGEST_WORD: usize = 64;
/// A cell size up to this, with corners that can be degrees, is one in degrees; no survey has cells of 5 cm.
const MOST_DEGREES: f64 = 0.05;

pub(super) fn header(input: &mut dyn Input, length: u64) -> Result<Header, Problem> {
    Ok(Text::new(input).table(length)?.header)
}

pub(super) fn heights(input: &mut dyn Input, header: &Header, scale: &Scale) -> Result<Vec<f32>, Problem> {
    let mut text = Text::new(input);
    let table = text.table(u64::MAX)?;
    let cells = header.width * header.height;
    let mut out = Vec::with_capacity(cells);
    let mut value = Some(table.first);
    while let Some(v) = value {
        if out.len() == cells {
            return Err(damaged(format!("it holds more than {} x {} values", header.width, header.height)));
        }
        out.push(if Some(v) == table.no_data { f32::NAN } else { scale.height(v) });
        value = match text.word()? {
            true => Some(text.number()?),
            false => None,
        };
    }
    Ok(out)
}

/// What stands before the heights.
struct Table {
    header: Header,
    no_data: Option<f64>,
    /// The first height, which ended the table.
    first: f64,
}

struct Text<'a> {
    input: &'a mut dyn Input,
    /// The word read last.
    word: Vec<u8>,
}

impl<'a> Text<'a> {
    fn new(input: &'a mut dyn Input) -> Self {
        Self { input, word: Vec::with_capacity(LONGEST_WORD) }
    }

    /// Reads the next word; false at the end of the file.
    fn word(&mut self) -> Result<bool, Problem> {
        self.word.clear();
        loop {
            let bytes = self.input.fill_buf().map_err(io_problem)?;
            if bytes.is_empty() {
                return Ok(!self.word.is_empty());
            }
            let mut used = 0;
            let mut whole = false;
            for &byte in bytes {
                used += 1;
                if !byte.is_ascii_whitespace() {
                    self.word.push(byte);
                } else if !self.word.is_empty() {
                    whole = true;
                    break;
                }
                if self.word.len() > LONGEST_WORD {
                    break;
                }
            }
            self.input.consume(used);
            if self.word.len() > LONGEST_WORD {
                return Err(damaged(format!("{} is no number", self.shown())));
            }
            if whole {
                return Ok(true);
            }
        }
    }

    fn shown(&self) -> String {
        let text: String = String::from_utf8_lossy(&self.word).chars().take(20).collect();
        format!("'{}'", text.escape_default())
    }

    /// The word as a number. Some languages write the fraction after a comma.
    fn number(&mut self) -> Result<f64, Problem> {
        for byte in self.word.iter_mut().filter(|byte| **byte == b',') {
            *byte = b'.';
        }
        let number = std::str::from_utf8(&self.word).ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| damaged(format!("{} is no number", self.shown())))
    }

    fn expect_number(&mut self) -> Result<f64, Problem> {
        if self.word()? { self.number() } else { Err(Problem::Truncated) }
    }

    /// Reads the named numbers and the first height.
    fn table(&mut self, length: u64) -> Result<Table, Problem> {
        let [mut columns, mut rows, mut cell_x, mut cell_y] = [None::<f64>; 4];
        let [mut south, mut west, mut no_data] = [None::<f64>; 3];
        let first = loop {
            if !self.word()? {
                return Err(Problem::Truncated);
            }
            let name = String::from_utf8_lossy(&self.word).to_ascii_lowercase();
            let slots: &mut [&mut Option<f64>] = match name.as_str() {
                "ncols" => &mut [&mut columns],
                "nrows" => &mut [&mut rows],
                "cellsize" => &mut [&mut cell_x, &mut cell_y],
                "dx" => &mut [&mut cell_x],
                "dy" => &mut [&mut cell_y],
                "xllcorner" | "xllcenter" => &mut [&mut west],
                "yllcorner" | "yllcenter" => &mut [&mut south],
                "nodata_value" => &mut [&mut no_data],
                _ => break self.number()?,
            };
            let value = self.expect_number()?;
            slots.iter_mut().for_each(|slot| **slot = Some(value));
        };
        let whole = |n: Option<f64>, name: &str| match n {
            Some(n) if (0.0..1e15).contains(&n) && n.fract() == 0.0 => Ok(n as u64),
            Some(n) => Err(damaged(format!("{name} is {n}"))),
            None => Err(damaged(format!("{name} is missing"))),
        };
        // A value takes two bytes: a digit and what parts it from the next.
        let (width, height) = checked(whole(columns, "ncols")?, whole(rows, "nrows")?, 2, length, 2)?;
        let cell_m = match (cell_x, cell_y) {
            (Some(x), Some(y)) if x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite() => {
                Some(in_metres([x, y], west, south, height))
            }
            (None, None) => None,
            _ => return Err(damaged("its cellsize is no length")),
        };
        let header = Header {
            format: Format::Asc,
            width,
            height,
            cell_m,
            sample: Sample::Fraction(32),
            metres: true,
            line: None,
        };
        Ok(Table { header, no_data, first })
    }
}

/// The format does not say whether its lengths are metres or degrees; their sizes do.
fn in_metres([x, y]: [f64; 2], west: Option<f64>, south: Option<f64>, rows: usize) -> [f64; 2] {
    let (west, south) = (west.unwrap_or(0.0), south.unwrap_or(0.0));
    let middle = south + 0.5 * y * rows as f64;
    if x > MOST_DEGREES || y > MOST_DEGREES || west.abs() > 360.0 || middle.abs() >= 90.0 {
        return [x, y];
    }
    [x * DEGREE_M * libm::cos(middle.to_radians()), y * DEGREE_M]
}
