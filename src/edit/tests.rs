//! Every format read back from files made by its own crate or by hand, and every way in which a file can be bad.

use std::io::Cursor;

use tiff::{encoder::TiffEncoder, tags::Tag};

use super::{Endian, ImportParams, NoData, SourceFormat};

const W: usize = 23;
const H: usize = 17;

fn height(x: usize, y: usize) -> f32 {
    (x as f32 * 0.7).sin() * 400.0 + y as f32 * 31.7 - 120.0
}

fn heights() -> Vec<f32> {
    (0..W * H).map(|i| height(i % W, i / W)).collect()
}

fn read(params: &ImportParams, name: &str, bytes: &[u8]) -> Vec<f32> {
    let map = params.read_bytes(name, bytes.to_vec()).unwrap();
    assert_eq!((map.width, map.height), (W, H));
    map.heights
}

fn refused(params: &ImportParams, name: &str, bytes: &[u8]) -> String {
    let line = params.read_bytes(name, bytes.to_vec()).unwrap_err().to_string();
    assert!(line.starts_with(name) && !line.contains('\n') && line.len() < 300, "{line}");
    line
}

fn says(name: &str, bytes: &[u8], what: &str) {
    let line = refused(&ImportParams::default(), name, bytes);
    assert!(line.contains(what), "{line}");
}

fn png(width: u32, height: u32, colour: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

fn gray16(values: &[u16]) -> Vec<u8> {
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    png(W as u32, H as u32, png::ColorType::Grayscale, png::BitDepth::Sixteen, &data)
}

type Float = tiff::encoder::colortype::Gray32Float;

type Tags<'a, 'w> = tiff::encoder::DirectoryEncoder<'a, &'w mut Cursor<Vec<u8>>, tiff::encoder::TiffKindStandard>;

fn tiff_float(tag: impl FnOnce(&mut Tags)) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<Float>(W as u32, H as u32).unwrap();
    tag(image.encoder());
    image.write_data(&heights()).unwrap();
    bytes.into_inner()
}

fn exr(names: &[&'static str]) -> Vec<u8> {
    use exr::prelude::*;
    let mut bytes = Cursor::new(Vec::new());
    let list = names.iter().map(|name| AnyChannel::new(*name, FlatSamples::F32(heights())));
    let channels = AnyChannels::sort(list.collect());
    let layer = Layer::new((W, H), LayerAttributes::named("heights"), Encoding::FAST_LOSSLESS, channels);
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn asc(cell: &str) -> String {
    let mut text = format!("ncols {W}\nnrows {H}\nxllcorner 7.0\nyllcorner 59.5\n{cell}\nNODATA_value -9999\n");
    for row in heights().chunks(W) {
        text += &row.iter().map(|v| v.to_string()).collect::<Vec<_>>().join(" ");
        text += "\r\n";
    }
    text
}

#[test]
fn whole_numbers_come_back_within_half_a_step() {
    let (low, high) = (-600.0f64, 1000.0f64);
    let params = ImportParams { low_m: Some(low), high_m: Some(high), ..Default::default() };
    let levels: Vec<u16> =
        heights().iter().map(|v| ((*v as f64 - low) / (high - low) * 65535.0).round() as u16).collect();
    let step = (high - low) / 65535.0;
    let near = |read: Vec<f32>, what: &str| {
        for (a, b) in read.iter().zip(heights()) {
            // Half a step, and the rounding of f32 at 1000 m.
            assert!((a - b).abs() as f64 <= 0.5 * step + 6.2e-5, "{what}: {a} {b}");
        }
    };
    near(read(&params, "a.png", &gray16(&levels)), "png");
    let rgb: Vec<u8> = levels.iter().flat_map(|v| [v.to_be_bytes(); 3].concat()).collect();
    near(read(&params, "a.png", &png(W as u32, H as u32, png::ColorType::Rgb, png::BitDepth::Sixteen, &rgb)), "rgb");
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<tiff::encoder::colortype::Gray16>(W as u32, H as u32, &levels).unwrap();
    near(read(&params, "a.TIF", bytes.get_ref()), "tiff");
    let size = Some([W as u32, H as u32]);
    let little: Vec<u8> = levels.iter().flat_map(|v| v.to_le_bytes()).collect();
    near(read(&ImportParams { size, ..params.clone() }, "a.r16", &little), "r16");
    let big: Vec<u8> = levels.iter().flat_map(|v| v.to_be_bytes()).collect();
    near(read(&ImportParams { size, endian: Endian::Big, ..params.clone() }, "a.raw", &big), "raw");
    let named = ImportParams { size, format: SourceFormat::R16, ..params };
    near(read(&named, "height.data", &little), "asked for");
}

#[test]
fn fractions_come_back_to_the_bit() {
    let params = ImportParams::default();
    assert_eq!(read(&params, "a.tiff", &tiff_float(|_| ())), heights());
    assert_eq!(read(&params, "a.exr", &exr(&["Y"])), heights());
    assert_eq!(read(&params, "a.exr", &exr(&["terrain"])), heights());
    assert_eq!(read(&params, "a.exr", &exr(&["R", "G", "B"])), heights());
    assert_eq!(read(&params, "a.asc", asc("cellsize 30").as_bytes()), heights());
    assert_eq!(read(&params, "a.asc", asc("cellsize 30").replace(['\r', '\n'], " ").as_bytes()), heights());
    let raw: Vec<u8> = heights().iter().flat_map(|v| v.to_le_bytes()).collect();
    let params = ImportParams { size: Some([W as u32, H as u32]), ..params };
    assert_eq!(read(&params, "a.r32", &raw), heights());
}

#[test]
fn fractions_of_one_can_be_given_heights() {
    let params = ImportParams { low_m: Some(100.0), high_m: Some(300.0), ..Default::default() };
    let raw: Vec<u8> = [0.0f32, 0.25, 0.5, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let map = params.read_bytes("a.r32", raw).unwrap();
    assert_eq!(map.heights, [100.0, 150.0, 200.0, 300.0]);
    // A sea floor that is only given its top.
    let params = ImportParams { high_m: Some(-200.0), ..Default::default() };
    let map = params.read_bytes("a.r32", [0.0f32, 1.0, 0.5, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect());
    assert_eq!(map.unwrap().heights, [-2200.0, -200.0, -1200.0, -200.0]);
}

#[test]
fn few_bits_are_spread_and_told() {
    let params = ImportParams { high_m: Some(255.0), ..Default::default() };
    let bytes: Vec<u8> = (0..W * H).map(|i| (i % 256) as u8).collect();
    let file = png(W as u32, H as u32, png::ColorType::Grayscale, png::BitDepth::Eight, &bytes);
    assert_eq!(read(&params, "a.png", &file), bytes.iter().map(|b| *b as f32).collect::<Vec<_>>());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    std::fs::write(&path, file).unwrap();
    let params = ImportParams { path: path.display().to_string(), ..params };
    let remarks = params.remarks(&params.probe().unwrap());
    assert!(remarks.len() == 1 && remarks[0].contains("8 bits hold 256 heights"), "{remarks:?}");
    let smooth = ImportParams { smooth: 1.0, ..params };
    assert!(smooth.remarks(&smooth.probe().unwrap()).is_empty());
}

#[test]
fn what_is_transparent_or_marked_has_no_height() {
    let data: Vec<u8> =
        (0..W * H).flat_map(|i| [if i == 40 { 250 } else { 100 }, if i == 40 { 0 } else { 255 }]).collect();
    let file = png(W as u32, H as u32, png::ColorType::GrayscaleAlpha, png::BitDepth::Eight, &data);
    let params = ImportParams { high_m: Some(255.0), ..Default::default() };
    assert!(read(&params, "a.png", &file).iter().all(|v| (v - 100.0).abs() < 1e-3));
    let strict = ImportParams { no_data: NoData::Refuse, ..params };
    assert!(refused(&strict, "a.png", &file).contains("1 cells have no height, the first at 17, 1"));
    let gdal = tiff_float(|tags| tags.write_tag(Tag::GdalNodata, "-120").unwrap());
    // Only the first cell is exactly -120 m; a membrane over it is the mean of its two neighbours.
    let want = 0.5 * (height(1, 0) + height(0, 1));
    assert!((read(&ImportParams::default(), "a.tif", &gdal)[0] - want).abs() < 1.0);
    assert!(
        refused(&ImportParams { no_data: NoData::Refuse, ..Default::default() }, "a.tif", &gdal).contains("1 cells")
    );
}

fn header(name: &str, bytes: &[u8]) -> super::Header {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    ImportParams { path: path.display().to_string(), ..Default::default() }.probe().unwrap()
}

fn scale(tags: &mut Tags, keys: &[u16]) {
    tags.write_tag(Tag::ModelPixelScaleTag, &[30.0f64, 20.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0f64, 0.0, 0.0, 5e5, 5e6, 0.0][..]).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
}

#[test]
fn files_tell_the_size_of_their_cells() {
    let metres = tiff_float(|tags| scale(tags, &[1, 1, 0, 1, 1024, 0, 1, 1]));
    let found = header("a.tif", &metres);
    assert_eq!((found.width, found.height, found.cell_m, found.metres), (W, H, Some([30.0, 20.0]), true));
    let feet = tiff_float(|tags| scale(tags, &[1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9002]));
    assert_eq!(header("a.tif", &feet).cell_m, Some([30.0 * 0.3048, 20.0 * 0.3048]));
    assert_eq!(header("a.tif", &tiff_float(|_| ())).cell_m, None);
    assert_eq!(header("a.asc", asc("cellsize 30").as_bytes()).cell_m, Some([30.0, 30.0]));
    assert_eq!(header("a.asc", asc("dx 30\ndy 20").as_bytes()).cell_m, Some([30.0, 20.0]));
    // An arc second at 60 degrees north is half as wide as it is long.
    let [x, y] = header("a.asc", asc("cellsize 0.0002777777778").as_bytes()).cell_m.unwrap();
    assert!((y - 30.887).abs() < 1e-3 && (x / y - 0.5).abs() < 0.01, "{x} {y}");
}

#[test]
fn names_must_not_contradict_contents() {
    let file = gray16(&vec![7; W * H]);
    says("a.tif", &file, "the name says TIFF, but the content is PNG; rename the file, or set format");
    says("a.r16", &file, "the name says raw 16-bit values, but the content is PNG");
    says("a.png", b"\xff\xd8\xff\xe0 and so on", "but the content is JPEG");
    says("a.png", b"no picture at all", "but the content is none of the formats that can be imported");
    says("a.hgt", b"PK\x03\x04 an archive", "but the content is a zip archive");
    says("a.dat", &file, "no heightmap of a known kind");
    let asked = ImportParams { format: SourceFormat::Exr, ..Default::default() };
    assert!(refused(&asked, "a.png", &file).contains("format says OpenEXR, but the content is PNG"));
}

#[test]
fn empty_cut_and_tiny_files_are_refused() {
    for name in ["a.png", "a.tif", "a.exr", "a.r16", "a.r32", "a.asc", "a.hgt"] {
        says(name, b"", "the file is empty");
    }
    let whole = [
        ("a.png", gray16(&(0..(W * H) as u16).map(|i| i.wrapping_mul(40503)).collect::<Vec<_>>())),
        ("a.tif", tiff_float(|_| ())),
        ("a.exr", exr(&["Y"])),
        ("a.asc", asc("cellsize 30").into_bytes()),
    ];
    for (name, bytes) in &whole {
        assert!(ImportParams::default().read_bytes(name, bytes.clone()).is_ok());
        // The ends of a PNG and of a text hold no height.
        for cut in (1..bytes.len() - 30).step_by(7) {
            refused(&ImportParams::default(), name, &bytes[..cut]);
        }
    }
    says("a.png", &png(1, 1, png::ColorType::Grayscale, png::BitDepth::Eight, &[9]), "1 x 1 is too small for a map");
    says("a.asc", b"ncols 1\nnrows 1\ncellsize 5\n7\n", "1 x 1 is too small for a map");
    says("a.r16", &[1, 2], "1 x 1 is too small for a map");
    says("a.r16", &[0; 14], "14 bytes are no square of 16-bit values; state its size = [width, height]");
    says("a.hgt", &[0; 200], "200 bytes are no SRTM tile");
    let sized = ImportParams { size: Some([4, 2]), ..Default::default() };
    assert!(refused(&sized, "a.r16", &[0; 14]).contains("are 16 bytes, but the file has 14"));
}

#[test]
fn huge_headers_are_refused_before_anything_is_decoded() {
    let mut file = gray16(&vec![7; W * H]);
    file[16..20].copy_from_slice(&60_000u32.to_be_bytes());
    file[20..24].copy_from_slice(&60_000u32.to_be_bytes());
    // The header's checksum, so that its size is what is looked at.
    let sum = crc(&file[12..29]);
    file[29..33].copy_from_slice(&sum.to_be_bytes());
    says("a.png", &file, "60000 x 60000 is too large; at most 16384 a side");
    // 16384 a side is allowed, but not in a hundred bytes.
    file[16..20].copy_from_slice(&16_384u32.to_be_bytes());
    file[20..24].copy_from_slice(&16_384u32.to_be_bytes());
    let sum = crc(&file[12..29]);
    file[29..33].copy_from_slice(&sum.to_be_bytes());
    says("a.png", &file, "the file is cut short");
    says("a.asc", b"ncols 60000\nnrows 60000\ncellsize 5\n7\n", "60000 x 60000 is too large");
    says("a.asc", b"ncols 9000\nnrows 9000\ncellsize 5\n7\n", "the file is cut short");
    says("a.asc", b"ncols 1e30\nnrows 2\n7\n", "ncols is 1000000");
    let mut tiff = tiff_float(|_| ());
    // One strip as high as the picture, or the header would contradict itself first.
    for (tag, value) in [(256u16, 60_000u32), (257, 60_000), (278, 60_000)] {
        let entry =
            (0..tiff.len() - 12).find(|&i| tiff[i..i + 2] == tag.to_le_bytes() && tiff[i + 4..i + 8] == [1, 0, 0, 0]);
        tiff[entry.unwrap() + 8..][..4].copy_from_slice(&value.to_le_bytes());
    }
    says("a.tif", &tiff, "60000 x 60000 is too large");
    let mut exr = exr(&["Y"]);
    let window = exr.windows(11).position(|w| w == b"dataWindow\0").unwrap() + 11 + b"box2i\0".len() + 4 + 8;
    exr[window..window + 4].copy_from_slice(&59_999i32.to_le_bytes());
    exr[window + 4..window + 8].copy_from_slice(&59_999i32.to_le_bytes());
    says("a.exr", &exr, "60000 x 60000 is too large");
}

/// The checksum of a PNG's chunk (ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ *byte as u32, |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

#[test]
fn heights_that_are_none_are_refused() {
    let raw = |value: f32| [value; 16].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    says("a.r32", &raw(f32::NAN), "no cell of it holds a height");
    says("a.r32", &raw(f32::NEG_INFINITY), "no cell of it holds a height");
    says("a.r32", &raw(-3.4028235e38), "no cell of it holds a height");
    says("a.r32", &raw(1e20), "are none of any land; is the byte order");
    says("a.asc", b"ncols 2\nnrows 2\ncellsize 5\n7 8 nine 10\n", "'nine' is no number");
    says("a.asc", b"ncols 2\nnrows 2\ncellsize 5\n7 8 9 10 11\n", "more than 2 x 2 values");
    says("a.asc", b"ncols 2\nnrows 2\ncellsize -5\n7 8 9 10\n", "its cellsize is no length");
    says("a.asc", format!("ncols {}", "9".repeat(5000)).as_bytes(), "is no number");
    let params = ImportParams { low_m: Some(10.0), high_m: Some(10.0), ..Default::default() };
    assert!(refused(&params, "a.png", &gray16(&vec![7; W * H])).contains("low_m = 10 must be below high_m = 10"));
    says("a.exr", &exr(&["u", "v"]), "which channel is the height? it has u, v; name one of them Y");
}

#[test]
fn tiles_have_voids() {
    let mut bytes: Vec<u8> = vec![250i16; 1201 * 1201].iter().flat_map(|v| v.to_be_bytes()).collect();
    bytes[2000..2002].copy_from_slice(&i16::MIN.to_be_bytes());
    let map = ImportParams::default().read_bytes("N46E007.hgt", bytes).unwrap();
    assert!(map.width == 1201 && map.heights.iter().all(|v| (v - 250.0).abs() < 1e-3));
}
