//! A recording being written: a few frames are held, the others are on the disk.

use std::{
    fs::{self, File},
    io::{self, BufReader, Write},
    path::{Path, PathBuf},
};

use super::{
    BakeError, Frame, Header,
    chunk::{self, sha256},
    read,
};

/// The mark of the end.
pub(super) const DONE: &[u8; 4] = b"DONE";
/// Bytes of the end: the mark, chunks, three counts and a hash.
pub(super) const END: usize = 4 + 4 + 3 * 8 + 32;
/// Places that are held before they are written: some 10 MB. A frame that has more is a chunk alone.
const MOST_PLACES: usize = 1 << 18;
/// Frames of a chunk, at most: to see one, all before it in its chunk have to be unpacked.
const MOST_FRAMES: usize = 64;

/// What a recording holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Chunks.
    pub chunks: u32,
    /// Frames.
    pub frames: u64,
    /// Places: a particle in a frame.
    pub places: u64,
    /// Most particles of a frame.
    pub most: u64,
}

/// Writes a recording. The file is whole after [`Writer::finish`], and no [`super::Reader`] takes it before. The place at which a
/// step of the stage ended can be gone on from ([`Writer::resume`]).
pub struct Writer {
    path: PathBuf,
    header: Header,
    file: File,
    held: Vec<Frame>,
    held_places: usize,
    totals: Totals,
    hashes: Vec<[u8; 32]>,
}

impl Writer {
    /// Begins a file, in place of one that is there.
    pub fn create(path: &Path, header: Header) -> Result<Self, BakeError> {
        let disk = |cause| BakeError::Disk { path: path.to_owned(), cause };
        header.check().map_err(|what| BakeError::Unfit { path: path.to_owned(), what })?;
        let bytes = header.bytes();
        let mut file = File::create(path).map_err(disk)?;
        file.write_all(&bytes).map_err(disk)?;
        let (held, totals, hashes) = (Vec::new(), Totals::default(), vec![sha256(&[&bytes])]);
        Ok(Self { path: path.to_owned(), header, file, held, held_places: 0, totals, hashes })
    }

    /// Goes on behind a step of the stage with a file that was begun for the same header; what lies behind that step is
    /// forgotten. `frames` are those that were due by then.
    pub fn resume(path: &Path, header: Header, step: u32, frames: u64) -> Result<Self, BakeError> {
        let disk = |cause| BakeError::Disk { path: path.to_owned(), cause };
        let unfit = |what: &str| BakeError::Unfit { path: path.to_owned(), what: what.to_owned() };
        let bytes = header.bytes();
        let mut file = BufReader::new(File::open(path).map_err(disk)?);
        if read::some(&mut file, bytes.len()).map_err(disk)? != bytes {
            return Err(unfit("the stopped run was baked otherwise"));
        }
        let (mut totals, mut hashes, mut whole) = (Totals::default(), vec![sha256(&[&bytes])], bytes.len() as u64);
        // What a kill has cut short, or a step that is done anew, ends what is kept.
        while let Some((head, frames)) = read::next(&mut file, &header).map_err(disk)? {
            if head.step > step || u64::from(head.first) != totals.frames {
                break;
            }
            whole += (chunk::HEAD + head.packed as usize) as u64;
            totals.count(&frames);
            hashes.push(head.sha256);
        }
        if totals.frames != frames {
            return Err(unfit("the stopped run has not left all frames up to here"));
        }
        let mut file = fs::OpenOptions::new().write(true).open(path).map_err(disk)?;
        file.set_len(whole).map_err(disk)?;
        io::Seek::seek(&mut file, io::SeekFrom::End(0)).map_err(disk)?;
        Ok(Self { path: path.to_owned(), header, file, held: Vec::new(), held_places: 0, totals, hashes })
    }

    /// The next frame, which belongs to this step of the stage, counted from 1.
    pub fn push(&mut self, frame: Frame, step: u32) -> Result<(), BakeError> {
        let next = self.totals.frames + self.held.len() as u64;
        let due_s = super::due_s(next, self.header.frames_per_s);
        let fits = frame.columns.len() == self.header.columns.len()
            && frame.columns.iter().all(|column| column.len() == frame.id.len())
            && frame.id.is_sorted_by(|a, b| a < b);
        if !fits || frame.time_s != due_s || next >= self.header.frames {
            return Err(self.unfit(format!("frame {next} is not what the header says")));
        }
        self.held_places += frame.id.len();
        self.held.push(frame);
        let full = self.held_places >= MOST_PLACES || self.held.len() >= MOST_FRAMES;
        if full { self.write(step) } else { Ok(()) }
    }

    /// A step of the stage is over: what was pushed is on the disk after this, also where the power fails.
    pub fn end_step(&mut self, step: u32) -> Result<(), BakeError> {
        self.write(step)?;
        self.file.sync_data().map_err(|cause| self.disk(cause))
    }

    fn write(&mut self, step: u32) -> Result<(), BakeError> {
        if self.held.is_empty() {
            return Ok(());
        }
        let frames = std::mem::take(&mut self.held);
        self.held_places = 0;
        let packed = chunk::pack(self.totals.frames as u32, step, &frames, self.header.columns.len());
        let (head, packed) = packed.map_err(|what| self.unfit(format!("frame {}: {what}", self.totals.frames)))?;
        let bytes = [&head.bytes()[..], &packed].concat();
        self.file.write_all(&bytes).map_err(|cause| self.disk(cause))?;
        self.totals.count(&frames);
        self.hashes.push(head.sha256);
        Ok(())
    }

    /// Ends the file; an error where frames are missing.
    pub fn finish(mut self) -> Result<Totals, BakeError> {
        self.write(u32::MAX)?;
        if self.totals.frames != self.header.frames {
            let (there, due) = (self.totals.frames, self.header.frames);
            return Err(self.unfit(format!("{there} of {due} frames came")));
        }
        let end = self.totals.bytes(&self.hashes);
        self.file.write_all(&end).and_then(|()| self.file.sync_all()).map_err(|cause| self.disk(cause))?;
        Ok(self.totals)
    }

    fn disk(&self, cause: io::Error) -> BakeError {
        BakeError::Disk { path: self.path.clone(), cause }
    }

    fn unfit(&self, what: String) -> BakeError {
        BakeError::Unfit { path: self.path.clone(), what }
    }
}

impl Totals {
    pub(super) fn count(&mut self, frames: &[Frame]) {
        self.chunks += 1;
        self.frames += frames.len() as u64;
        for frame in frames {
            self.places += frame.id.len() as u64;
            self.most = self.most.max(frame.id.len() as u64);
        }
    }

    /// The end of a file with these hashes of header and chunks.
    pub(super) fn bytes(&self, hashes: &[[u8; 32]]) -> Vec<u8> {
        let counts: Vec<u8> =
            [self.frames, self.places, self.most].iter().flat_map(|count| count.to_le_bytes()).collect();
        let hash = sha256(&[&self.chunks.to_le_bytes(), &counts, hashes.as_flattened()]);
        [&DONE[..], &self.chunks.to_le_bytes(), &counts, &hash].concat()
    }
}
