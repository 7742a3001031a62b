//! Playback: where everyone was at any moment.

use std::path::Path;

use super::{BakeError, Frame, Header, Reader};

/// A particle at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// How many were born before it.
    pub id: u32,
    /// From the map's north-west corner to the east and to the south, and up from the world's datum, m.
    pub at_m: [f64; 3],
    /// Its temperature, °C; the header's columns say whether there is one, else it is 0.
    pub temperature_degc: f64,
    /// Since it was born, s; 0 where the header has no such column.
    pub age_s: f64,
}

/// What lies between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// Places in proportion to time.
    #[default]
    Linear,
    /// A cubic through both, with the speeds that the frames beside them give (Catmull and Rom).
    Hermite,
}

/// Plays a recording. Moments in order are read once; a jump unpacks the chunk it lands in.
pub struct Player {
    reader: Reader,
    /// What lies between two frames.
    pub between: Between,
    columns: [Option<usize>; 2],
    /// Chunks at hand with their numbers, the last used last.
    held: Vec<(usize, Vec<Frame>)>,
}

/// Chunks at hand: a frame and its neighbours may lie in two.
const HELD: usize = 2;

impl Player {
    /// Opens a recording.
    pub fn open(path: &Path) -> Result<Self, BakeError> {
        let reader = Reader::open(path)?;
        let columns = ["temperature", "age"].map(|name| reader.header().column(name));
        Ok(Self { reader, between: Between::Linear, columns, held: Vec::new() })
    }

    /// What the recording says of itself.
    pub fn header(&self) -> &Header {
        self.reader.header()
    }

    /// The particles at a moment, by number. Who is in the frame before it is there; who was born since comes with the next
    /// frame; who is gone by then stands still for so long.
    pub fn at(&mut self, time_s: f64) -> Result<Vec<Particle>, BakeError> {
        let (per_s, last_s) = (self.header().frames_per_s, self.header().last_s());
        if !(0.0..=last_s + super::SLACK_S).contains(&time_s) {
            return Err(BakeError::Outside { path: self.reader.path().to_owned(), time_s, last_s });
        }
        let frame = super::frames_by(time_s, per_s).saturating_sub(1);
        let share = ((time_s - super::due_s(frame, per_s)) * per_s).clamp(0.0, 1.0);
        let here = self.frame(frame)?;
        if share * (1.0 / per_s) <= super::SLACK_S || frame + 1 >= self.header().frames {
            return Ok((0..here.id.len()).map(|i| self.particle(&here, i)).collect());
        }
        let next = self.frame(frame + 1)?;
        let beside = match self.between {
            Between::Linear => [None, None],
            Between::Hermite => {
                let before = frame.checked_sub(1).map(|frame| self.frame(frame)).transpose()?;
                let after = (frame + 2 < self.header().frames).then(|| self.frame(frame + 2)).transpose()?;
                [before, after]
            }
        };
        let mut places = [Some(&next), beside[0].as_ref(), beside[1].as_ref()].map(|frame| frame.map(Places::of));
        let particles = here.id.iter().enumerate().map(|(i, &id)| {
            let own = self.particle(&here, i);
            let [to, before, after] = [0, 1, 2]
                .map(|k| places[k].as_mut().and_then(|places| places.find(id)).map(|(f, i)| self.particle(f, i)));
            to.map_or(own, |to| self.mean([own, to], [before, after], share))
        });
        Ok(particles.collect())
    }

    fn particle(&self, frame: &Frame, i: usize) -> Particle {
        let value = |column: Option<usize>| column.map_or(0.0, |column| frame.columns[column][i]);
        let [temperature_degc, age_s] = self.columns.map(value);
        Particle { id: frame.id[i], at_m: [0, 1, 2].map(|axis| frame.columns[axis][i]), temperature_degc, age_s }
    }

    /// A share of the way from one to the other.
    fn mean(&self, [from, to]: [Particle; 2], [before, after]: [Option<Particle>; 2], share: f64) -> Particle {
        let header = self.header();
        let extent_m = |axis: usize| if header.wraps && axis < 2 { header.extent_m[axis] } else { 0.0 };
        let at_m = [0, 1, 2].map(|axis| {
            let (extent, start) = (extent_m(axis), from.at_m[axis]);
            // The shorter way round, where there are two.
            let way =
                |at: f64| if extent > 0.0 { at - start - extent * ((at - start) / extent).round() } else { at - start };
            let end = way(to.at_m[axis]);
            let along = match self.between {
                Between::Linear => share * end,
                Between::Hermite => {
                    let slope_from = before.map_or(end, |before| 0.5 * (end - way(before.at_m[axis])));
                    let slope_to = after.map_or(end, |after| 0.5 * way(after.at_m[axis]));
                    let (s, t) = (share, 1.0 - share);
                    s * s * (3.0 - 2.0 * s) * end + s * t * (t * slope_from - s * slope_to)
                }
            };
            let at = start + along;
            if extent > 0.0 { at.rem_euclid(extent) } else { at }
        });
        let mean = |a: f64, b: f64| a + (b - a) * share;
        Particle {
            id: from.id,
            at_m,
            temperature_degc: mean(from.temperature_degc, to.temperature_degc),
            age_s: mean(from.age_s, to.age_s),
        }
    }

    fn frame(&mut self, frame: u64) -> Result<Frame, BakeError> {
        let chunk = self.reader.chunk_of(frame);
        let held = match self.held.iter().position(|(number, _)| *number == chunk) {
            Some(at) => self.held.remove(at),
            None => {
                if self.held.len() == HELD {
                    self.held.remove(0);
                }
                (chunk, self.reader.chunk(chunk)?.frames)
            }
        };
        let columns = self.header().columns.len();
        let found = held.1.get((frame - self.reader.first_of(chunk)) as usize).cloned();
        self.held.push(held);
        Ok(found.unwrap_or_else(|| Frame::empty(0.0, columns)))
    }
}

/// Ascending numbers looked up in ascending order.
struct Places<'a> {
    frame: &'a Frame,
    at: usize,
}

impl<'a> Places<'a> {
    fn of(frame: &'a Frame) -> Self {
        Self { frame, at: 0 }
    }

    fn find(&mut self, id: u32) -> Option<(&'a Frame, usize)> {
        while self.frame.id.get(self.at).is_some_and(|&other| other < id) {
            self.at += 1;
        }
        (self.frame.id.get(self.at) == Some(&id)).then_some((self.frame, self.at))
    }
}
