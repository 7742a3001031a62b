//! A few frames as bytes, and back.

use sha2::{Digest, Sha256};

use super::{Chunk, Frame};

/// Whole numbers that a value can be, less one.
const STEPS: f64 = 65_535.0;
/// How hard Zstandard tries: beyond this files hardly get smaller.
const LEVEL: i32 = 6;
/// Bytes of a chunk unpacked, at most.
pub(super) const MOST_BYTES: usize = 1 << 30;
/// The mark of a chunk, and bytes of its head: the mark, five numbers and a hash.
pub(super) const MARK: &[u8; 4] = b"CHNK";
pub(super) const HEAD: usize = 4 + 5 * 4 + 32;

/// What stands before a chunk's packed bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChunkHead {
    pub first: u32,
    pub frames: u32,
    pub step: u32,
    pub packed: u32,
    pub unpacked: u32,
    pub sha256: [u8; 32],
}

impl ChunkHead {
    fn numbers(&self) -> [u8; 20] {
        let mut bytes = [0; 20];
        let numbers = [self.first, self.frames, self.step, self.packed, self.unpacked];
        for (bytes, number) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
            *bytes = number.to_le_bytes();
        }
        bytes
    }

    /// The hash that its numbers and these packed bytes have.
    pub fn hash(&self, packed: &[u8]) -> [u8; 32] {
        sha256(&[&self.numbers(), packed])
    }

    pub fn bytes(&self) -> Vec<u8> {
        [&MARK[..], &self.numbers(), &self.sha256].concat()
    }

    /// `None` without the mark.
    pub fn read(bytes: &[u8; HEAD]) -> Option<Self> {
        let (mark, rest) = bytes.split_first_chunk::<4>()?;
        let (numbers, sha256) = rest.split_first_chunk::<20>()?;
        let mut numbers = numbers.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
        let mut next = || numbers.next();
        let (first, frames, step, packed, unpacked) = (next()?, next()?, next()?, next()?, next()?);
        (mark == MARK).then_some(Self { first, frames, step, packed, unpacked, sha256: sha256.try_into().ok()? })
    }
}

/// The hash of several runs of bytes as if they were one.
pub(super) fn sha256(parts: &[&[u8]]) -> [u8; 32] {
    let mut sum = Sha256::new();
    parts.iter().for_each(|part| sum.update(part));
    sum.finalize().into()
}

/// Packs frames with so many columns: head and packed bytes.
pub(super) fn pack(first: u32, step: u32, frames: &[Frame], columns: usize) -> Result<(ChunkHead, Vec<u8>), String> {
    let raw = raw(frames, columns)?;
    if raw.len() > MOST_BYTES {
        return Err(format!("a frame of {} bytes is too large", raw.len()));
    }
    let packed = zstd::bulk::compress(&raw, LEVEL).map_err(|e| format!("cannot be packed: {e}"))?;
    let (frames, packed_bytes) = (frames.len() as u32, packed.len() as u32);
    let mut head = ChunkHead { first, frames, step, packed: packed_bytes, unpacked: raw.len() as u32, sha256: [0; 32] };
    head.sha256 = head.hash(&packed);
    Ok((head, packed))
}

/// Least value and unit of a column over all frames.
fn scale(frames: &[Frame], column: usize) -> Result<[f64; 2], String> {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in frames.iter().flat_map(|frame| &frame.columns[column]) {
        if !value.is_finite() {
            return Err("a particle's value is no number".to_owned());
        }
        (least, most) = (least.min(value), most.max(value));
    }
    // Without particles there is nothing to scale.
    if least > most { Ok([0.0, 0.0]) } else { Ok([least, (most - least) / STEPS]) }
}

fn whole(value: f64, [least, unit]: [f64; 2]) -> u16 {
    if unit > 0.0 { ((value - least) / unit).round().clamp(0.0, STEPS) as u16 } else { 0 }
}

/// Small differences of either sign as small numbers.
fn fold(difference: u16) -> u16 {
    (difference << 1) ^ (((difference as i16) >> 15) as u16)
}

fn unfold(folded: u16) -> u16 {
    (folded >> 1) ^ (folded & 1).wrapping_neg()
}

/// Hands out, for ascending numbers one after the other, the places that they have among other ascending numbers.
struct Before<'a> {
    id: &'a [u32],
    at: usize,
}

impl Before<'_> {
    fn place(&mut self, id: u32) -> Option<usize> {
        while self.at < self.id.len() && self.id[self.at] < id {
            self.at += 1;
        }
        (self.id.get(self.at) == Some(&id)).then_some(self.at)
    }
}

fn raw(frames: &[Frame], columns: usize) -> Result<Vec<u8>, String> {
    let scales = (0..columns).map(|column| scale(frames, column)).collect::<Result<Vec<_>, _>>()?;
    let mut raw: Vec<u8> = scales.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
    let mut before: (&[u32], Vec<Vec<u16>>) = (&[], vec![Vec::new(); columns]);
    for frame in frames {
        let n = frame.id.len();
        raw.extend((n as u32).to_le_bytes());
        let mut last = 0;
        for &id in &frame.id {
            raw.extend((id - last).to_le_bytes());
            last = id;
        }
        let mut now = Vec::with_capacity(columns);
        for ((values, &scale), old) in frame.columns.iter().zip(&scales).zip(&before.1) {
            let wholes: Vec<u16> = values.iter().map(|&value| whole(value, scale)).collect();
            let mut places = Before { id: before.0, at: 0 };
            let folded: Vec<u16> = (frame.id.iter().zip(&wholes))
                .map(|(&id, &now)| fold(now.wrapping_sub(places.place(id).map_or(0, |at| old[at]))))
                .collect();
            raw.extend(folded.iter().map(|&folded| folded as u8));
            raw.extend(folded.iter().map(|&folded| (folded >> 8) as u8));
            now.push(wholes);
        }
        before = (&frame.id, now);
    }
    Ok(raw)
}

/// Bytes that are read one after the other.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        self.0.split_off(..count)
    }

    fn whole(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    fn number(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.take(8)?.try_into().ok()?)).filter(|number| number.is_finite())
    }
}

/// The frames of a chunk whose hash is right; an error says what does not fit.
pub(super) fn unpack(head: &ChunkHead, packed: &[u8], columns: usize, per_s: f64) -> Result<Chunk, String> {
    let raw = zstd::bulk::decompress(packed, head.unpacked as usize).map_err(|e| format!("cannot be unpacked: {e}"))?;
    if raw.len() != head.unpacked as usize {
        return Err("it unpacks to another length".to_owned());
    }
    frames(&raw, head, columns, per_s).ok_or_else(|| "its frames do not fill it".to_owned())
}

fn frames(raw: &[u8], head: &ChunkHead, columns: usize, per_s: f64) -> Option<Chunk> {
    let mut bytes = Bytes(raw);
    let mut scales = Vec::with_capacity(columns);
    for _ in 0..columns {
        scales.push([bytes.number()?, bytes.number()?]);
    }
    let mut frames: Vec<Frame> = Vec::new();
    let mut before = vec![Vec::new(); columns];
    for k in 0..head.frames {
        let n = bytes.whole()? as usize;
        let (differences, mut last) = (bytes.take(n.checked_mul(4)?)?, 0u32);
        let mut id = Vec::with_capacity(n);
        for (i, bytes) in differences.as_chunks::<4>().0.iter().enumerate() {
            let more = u32::from_le_bytes(*bytes);
            last = last.checked_add(more).filter(|_| more > 0 || i == 0)?;
            id.push(last);
        }
        let old: &[u32] = frames.last().map_or(&[], |frame| &frame.id);
        let mut now = Vec::with_capacity(columns);
        for before in &before {
            let (low, high) = (bytes.take(n)?, bytes.take(n)?);
            let mut places = Before { id: old, at: 0 };
            let wholes = low.iter().zip(high).zip(&id).map(|((&low, &high), &id)| {
                let was: u16 = places.place(id).map_or(0, |at| before[at]);
                was.wrapping_add(unfold(u16::from_le_bytes([low, high])))
            });
            now.push(wholes.collect::<Vec<u16>>());
        }
        let value = |(wholes, [least, unit]): (&Vec<u16>, &[f64; 2])| {
            wholes.iter().map(|&whole| least + unit * f64::from(whole)).collect()
        };
        let values = now.iter().zip(&scales).map(value).collect();
        let time_s = super::due_s(u64::from(head.first) + u64::from(k), per_s);
        frames.push(Frame { time_s, id, columns: values });
        before = now;
    }
    let units = scales.iter().map(|[_, unit]| *unit).collect();
    bytes.0.is_empty().then_some(Chunk { frames, units })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_keeps_all_and_makes_small_ones_small() {
        assert!((0..=u16::MAX).all(|d| unfold(fold(d)) == d));
        assert_eq!([0u16, 1, 0xFFFF, 2, 0xFFFE].map(fold), [0, 2, 1, 4, 3]);
    }
}
