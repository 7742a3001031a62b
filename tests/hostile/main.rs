//! Hostile bytes through the entry points of the fuzz targets, a few hundred of each kind: no panic, no hang, one line for
//! what is wrong, and no more memory than a file of that size can be worth.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    io::Cursor,
    sync::atomic::{AtomicUsize, Ordering},
    time::{Duration, Instant},
};

use proptest::{
    collection::vec,
    prelude::{Strategy, any, prop_oneof},
    sample::Index,
    test_runner::{Config, TestRng, TestRunner},
};
use upthrust::recipe::presets;

#[path = "../../fuzz/entry_points.rs"]
mod entry_points;
use entry_points::{NAMES, Shelf};

/// The system's allocator, with a note of the largest piece anybody asked for.
struct Watched;

static LARGEST: AtomicUsize = AtomicUsize::new(0);

#[global_allocator]
static ALLOCATOR: Watched = Watched;

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LARGEST.fetch_max(size, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Largest piece of memory that any of these small files may ask for: deflate at its best makes 64 KiB of values of one
/// KiB, and decoders keep a few buffers of fixed size.
const MOST_BYTES: usize = 64 << 20;
/// No file of a few KiB takes longer, on the slowest machine.
const MOST_TIME: Duration = Duration::from_secs(20);

/// Changes to a file.
#[derive(Clone, Debug)]
enum Change {
    Set(Index, u8),
    Flip(Index, u8),
    Cut(Index),
    Insert(Index, Vec<u8>),
    Remove(Index, Index),
    /// A field of four bytes, as sizes and offsets are.
    Word(Index, u32),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let at = any::<Index>;
    let word = prop_oneof![any::<u32>(), 0u32..70_000, Just32::strategy()];
    let change = prop_oneof![
        (at(), any::<u8>()).prop_map(|(i, v)| Change::Set(i, v)),
        (at(), 0u8..8).prop_map(|(i, bit)| Change::Flip(i, bit)),
        at().prop_map(Change::Cut),
        (at(), vec(any::<u8>(), 1..20)).prop_map(|(i, bytes)| Change::Insert(i, bytes)),
        (at(), at()).prop_map(|(i, j)| Change::Remove(i, j)),
        (at(), word).prop_map(|(i, v)| Change::Word(i, v)),
    ];
    vec(change, 1..6)
}

/// Words that sizes go wrong at.
struct Just32;

impl Just32 {
    fn strategy() -> impl Strategy<Value = u32> {
        proptest::sample::select(vec![0, 1, 16_384, 16_385, 0x7fff_ffff, 0x8000_0000, u32::MAX])
    }
}

fn changed(sound: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    for change in changes {
        if bytes.is_empty() {
            break;
        }
        let len = bytes.len();
        match change {
            Change::Set(i, v) => bytes[i.index(len)] = *v,
            Change::Flip(i, bit) => bytes[i.index(len)] ^= 1 << bit,
            Change::Cut(i) => bytes.truncate(i.index(len)),
            Change::Insert(i, more) => {
                let at = i.index(len);
                bytes.splice(at..at, more.iter().copied());
            }
            Change::Remove(i, j) => {
                let (a, b) = (i.index(len), j.index(len));
                bytes.drain(a.min(b)..a.max(b).min(a.min(b) + 64));
            }
            Change::Word(i, v) => {
                let at = i.index(len);
                let end = (at + 4).min(len);
                bytes[at..end].copy_from_slice(&v.to_le_bytes()[..end - at]);
            }
        }
    }
    bytes
}

fn feed(cases: u32, bytes: impl Strategy<Value = Vec<u8>>, to: impl Fn(&[u8])) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    // The same cases every time; the fuzz targets look for new ones.
    let rng = TestRng::deterministic_rng(config.rng_algorithm);
    let fed = TestRunner::new_with_rng(config, rng).run(&bytes, |bytes| {
        let began = Instant::now();
        to(&bytes);
        assert!(began.elapsed() < MOST_TIME, "{} bytes took {:?}", bytes.len(), began.elapsed());
        let largest = LARGEST.load(Ordering::Relaxed);
        assert!(largest <= MOST_BYTES, "{} bytes asked for {largest} bytes at once", bytes.len());
        Ok(())
    });
    fed.unwrap_or_else(|error| panic!("{error}"));
}

fn random() -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), 0..600)
}

#[test]
fn recipes() {
    feed(300, random(), entry_points::recipe);
    feed(300, "[a-z\\[\\]=\".0-9 \n#{},-]{0,300}".prop_map(String::into_bytes), entry_points::recipe);
    let texts: Vec<Vec<u8>> = presets().iter().map(|preset| preset.text.as_bytes().to_vec()).collect();
    let mutated = (proptest::sample::select(texts), changes()).prop_map(|(text, c)| changed(&text, &c));
    feed(600, mutated, entry_points::recipe);
}

/// A small sound file for each name, behind the byte that picks the name.
fn heightmaps() -> Vec<Vec<u8>> {
    let (w, h) = (20u32, 13u32);
    let values: Vec<u16> = (0..w * h).map(|i| (i * 40_503 % 65_536) as u16).collect();
    let floats: Vec<f32> = values.iter().map(|v| *v as f32 * 0.1 - 500.0).collect();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, w, h);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let raw16: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    encoder.write_header().unwrap().write_image_data(&raw16).unwrap();
    let mut tiff = Cursor::new(Vec::new());
    let mut encoder =
        tiff::encoder::TiffEncoder::new(&mut tiff).unwrap().with_compression(tiff::encoder::Compression::Lzw);
    encoder.write_image::<tiff::encoder::colortype::Gray32Float>(w, h, &floats).unwrap();
    let mut asc = format!("ncols {w}\nnrows {h}\nxllcorner 0\nyllcorner 0\ncellsize 30\nNODATA_value -9999\n");
    for row in floats.chunks(w as usize) {
        asc += &(row.iter().map(f32::to_string).collect::<Vec<_>>().join(" ") + "\n");
    }
    let raw32: Vec<u8> = floats[..256].iter().flat_map(|v| v.to_le_bytes()).collect();
    let files =
        [png, tiff.into_inner(), exr(w, h, floats), raw16[..512].to_vec(), raw32, asc.into_bytes(), vec![7; 400]];
    files.into_iter().enumerate().map(|(pick, file)| [vec![pick as u8], file].concat()).collect()
}

fn exr(w: u32, h: u32, floats: Vec<f32>) -> Vec<u8> {
    use exr::prelude::*;
    let channels = AnyChannels::sort(std::iter::once(AnyChannel::new("Y", FlatSamples::F32(floats))).collect());
    let size = (w as usize, h as usize);
    let layer = Layer::new(size, LayerAttributes::named("heights"), Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn heightmaps_of_any_kind() {
    for sound in heightmaps() {
        entry_points::import(&sound);
        let pick = sound[0];
        let kind = NAMES[pick as usize % NAMES.len()];
        println!("{kind}");
        feed(400, changes().prop_map(move |c| [vec![pick], changed(&sound[1..], &c)].concat()), entry_points::import);
        feed(100, random().prop_map(move |bytes| [vec![pick], bytes].concat()), entry_points::import);
    }
}

#[test]
fn stores() {
    let folder = tempfile::tempdir().unwrap();
    let shelf = Shelf::new(folder.path());
    let files = shelf.files.clone();
    let mutated = (any::<Index>(), changes()).prop_map(move |(i, c)| {
        let pick = i.index(files.len());
        [vec![pick as u8], changed(&files[pick].1, &c)].concat()
    });
    feed(400, mutated, |bytes| shelf.read_with(bytes));
    feed(100, random(), |bytes| shelf.read_with(bytes));
}
