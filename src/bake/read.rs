//! A recording on the disk.

use std::{
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

use super::{
    BakeError, Frame, Header,
    chunk::{self, ChunkHead, sha256},
    header::{FORMAT, MAGIC, MOST_JSON},
    write::{DONE, END, Totals},
};

/// The ending of a recording's name.
pub const ENDING: &str = "upbake";
/// Bytes before the header's JSON.
const PREFIX: usize = 6 + 2 + 4 + 32;

/// Frames that are packed together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// The frames.
    pub frames: Vec<Frame>,
    /// What a column's values are whole numbers of, for each column: a value is off by half of that at most.
    pub units: Vec<f64>,
}

/// Where a chunk lies.
#[derive(Clone, Copy, Debug)]
struct Lies {
    head: ChunkHead,
    at: u64,
}

/// A recording that is whole as far as its heads say; the bytes of a chunk are looked at when it is read.
pub struct Reader {
    path: PathBuf,
    file: File,
    header: Header,
    totals: Totals,
    chunks: Vec<Lies>,
}

impl Reader {
    /// Opens a file and reads all but its frames.
    pub fn open(path: &Path) -> Result<Self, BakeError> {
        let disk = |cause| BakeError::Disk { path: path.to_owned(), cause };
        let mut file = File::open(path).map_err(disk)?;
        let length = file.metadata().map_err(disk)?.len();
        let header_bytes = header_bytes(path, &mut BufReader::new(&file))?;
        let header = parse(path, &header_bytes)?;
        let mut at = header_bytes.len() as u64;
        let (mut chunks, mut frames, mut hashes) = (Vec::<Lies>::new(), 0u64, vec![sha256(&[&header_bytes])]);
        let damaged = |chunks: usize, at: u64, what: &str| BakeError::Damaged {
            path: path.to_owned(),
            place: format!("chunk {}, at byte {at}", chunks + 1),
            what: what.to_owned(),
        };
        loop {
            file.seek(SeekFrom::Start(at)).map_err(disk)?;
            let bytes = some(&mut file, END.max(chunk::HEAD)).map_err(disk)?;
            if bytes.starts_with(DONE) {
                break;
            }
            let head = bytes.first_chunk().and_then(ChunkHead::read);
            let Some(head) = head else {
                let last = format!("it ends after frame {frames} of {}", header.frames);
                let what = if bytes.len() < END { &last } else { "there is no chunk" };
                return Err(damaged(chunks.len(), at, what));
            };
            let next = at + chunk::HEAD as u64 + u64::from(head.packed);
            if u64::from(head.first) != frames
                || head.frames == 0
                || frames + u64::from(head.frames) > header.frames
                || head.unpacked as usize > chunk::MOST_BYTES
            {
                return Err(damaged(chunks.len(), at, "its head makes no sense"));
            }
            if next > length {
                return Err(damaged(chunks.len(), at, &format!("it ends after frame {frames} of {}", header.frames)));
            }
            frames += u64::from(head.frames);
            hashes.push(head.sha256);
            chunks.push(Lies { head, at });
            at = next;
        }
        file.seek(SeekFrom::Start(at)).map_err(disk)?;
        let end = some(&mut file, END + 1).map_err(disk)?;
        let totals = totals(&end, chunks.len() as u32, &hashes).filter(|totals| totals.frames == frames);
        let Some(totals) = totals.filter(|_| frames == header.frames) else {
            let what = "its counts or hash do not fit".to_owned();
            return Err(BakeError::Damaged { path: path.to_owned(), place: format!("the end, at byte {at}"), what });
        };
        Ok(Self { path: path.to_owned(), file, header, totals, chunks })
    }

    /// What it says of itself.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// What it holds.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// Its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Chunks.
    pub fn chunks(&self) -> usize {
        self.chunks.len()
    }

    /// The chunk that a frame lies in; the last one's for those beyond the end.
    pub fn chunk_of(&self, frame: u64) -> usize {
        self.chunks.partition_point(|chunk| u64::from(chunk.head.first) <= frame).saturating_sub(1)
    }

    /// The first frame of a chunk.
    pub fn first_of(&self, chunk: usize) -> u64 {
        self.chunks.get(chunk).map_or(0, |chunk| u64::from(chunk.head.first))
    }

    /// A chunk's frames, after a look at its hash.
    pub fn chunk(&mut self, number: usize) -> Result<Chunk, BakeError> {
        let Some(&Lies { head, at }) = self.chunks.get(number) else { return Ok(Chunk::default()) };
        let disk = |cause| BakeError::Disk { path: self.path.clone(), cause };
        self.file.seek(SeekFrom::Start(at + chunk::HEAD as u64)).map_err(disk)?;
        let packed = some(&mut self.file, head.packed as usize).map_err(disk)?;
        let unpacked = if head.hash(&packed) == head.sha256 {
            chunk::unpack(&head, &packed, self.header.columns.len(), self.header.frames_per_s)
        } else {
            Err("its bytes are not those that were written".to_owned())
        };
        unpacked.map_err(|what| {
            let [first, last] = [head.first, head.first + (head.frames - 1)];
            let place = format!("chunk {} (frames {first} to {last}, at byte {at})", number + 1);
            BakeError::Damaged { path: self.path.clone(), place, what }
        })
    }
}

/// As many of so many bytes as there are.
pub(super) fn some(file: &mut impl Read, count: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(count as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The next chunk of a file, if there is a whole one.
pub(super) fn next(file: &mut impl Read, header: &Header) -> io::Result<Option<(ChunkHead, Vec<Frame>)>> {
    let bytes = some(file, chunk::HEAD)?;
    let head = bytes.first_chunk().and_then(ChunkHead::read);
    let Some(head) = head.filter(|head| head.unpacked as usize <= chunk::MOST_BYTES) else { return Ok(None) };
    let packed = some(file, head.packed as usize)?;
    if head.hash(&packed) != head.sha256 {
        return Ok(None);
    }
    let chunk = chunk::unpack(&head, &packed, header.columns.len(), header.frames_per_s);
    Ok(chunk.ok().map(|chunk| (head, chunk.frames)))
}

/// The bytes before the first chunk.
fn header_bytes(path: &Path, file: &mut impl Read) -> Result<Vec<u8>, BakeError> {
    let disk = |cause| BakeError::Disk { path: path.to_owned(), cause };
    let foreign = |what: String| BakeError::Foreign { path: path.to_owned(), what };
    let mut bytes = some(file, PREFIX).map_err(disk)?;
    if !bytes.starts_with(MAGIC) {
        return Err(foreign("this is no recording of particles".to_owned()));
    }
    let version = bytes.get(6..8).map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]));
    if version != FORMAT {
        let what = format!("a recording of version {version}, and this program reads version {FORMAT}");
        return Err(foreign(what));
    }
    let length = bytes.get(8..12).and_then(|bytes| bytes.try_into().ok()).map_or(0, u32::from_le_bytes);
    bytes.extend(some(file, length.min(MOST_JSON) as usize).map_err(disk)?);
    Ok(bytes)
}

fn parse(path: &Path, bytes: &[u8]) -> Result<Header, BakeError> {
    let damaged = |what: String| BakeError::Damaged { path: path.to_owned(), place: "the header".to_owned(), what };
    let json = bytes.get(PREFIX..).unwrap_or(&[]);
    let length = bytes.get(8..12).and_then(|bytes| bytes.try_into().ok()).map_or(0, u32::from_le_bytes);
    if json.len() != length as usize || bytes[12..PREFIX] != sha256(&[json]) {
        return Err(damaged("its bytes are not those that were written".to_owned()));
    }
    let header: Header = serde_json::from_slice(json).map_err(|e| damaged(e.to_string()))?;
    header.check().map_err(damaged)?;
    Ok(header)
}

/// What the end says, where it is the end of these chunks and nothing comes behind it.
fn totals(end: &[u8], chunks: u32, hashes: &[[u8; 32]]) -> Option<Totals> {
    let mut counts = end.get(8..32)?.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes));
    let totals = Totals { chunks, frames: counts.next()?, places: counts.next()?, most: counts.next()? };
    (totals.bytes(hashes) == end).then_some(totals)
}
