//! Every format written, read back by another decoder (or a plain reader of a dozen lines), and compared.

use std::path::Path;

use super::*;
use crate::grid::{Edges, Field, Grid};

const WIDTH: usize = 67;
const HEIGHT: usize = 41;

/// Heights of both signs with long binary fractions.
fn heights() -> Field<f32> {
    let grid = Grid::new(WIDTH, HEIGHT, WIDTH as f64 * 250.0, Edges::Open);
    Field::from_fn(grid, |x, y| ((x * 7919 + y * 104_729) % 65_521) as f32 / 7.0 - 4000.0)
}

fn raster(samples: Samples) -> Raster {
    Raster { lattice: Lattice::cells(&heights().grid), channels: 1, samples, levels: None }
}

fn floats() -> Raster {
    raster(Samples::F32(heights().data))
}

fn numbers() -> (Raster, Levels) {
    let levels = Levels::of(&heights()).unwrap();
    (Raster { levels: Some(levels), ..raster(Samples::U16(levels.to_u16(&heights()))) }, levels)
}

fn written(name: &str, raster: &Raster, layout: Layout) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    Format::of(&path).unwrap().write(raster, layout, &path).unwrap();
    (folder, path)
}

/// The numbers read back are heights to within half a step.
fn assert_heights(numbers: &[u16], levels: Levels) {
    let step_m = levels.span() / 65535.0;
    assert_eq!(numbers.len(), WIDTH * HEIGHT);
    for (number, height) in numbers.iter().zip(heights().data) {
        let read_m = levels.black + *number as f64 * step_m;
        assert!((read_m - height as f64).abs() <= step_m * 0.5001, "{read_m} {height}");
    }
}

#[test]
fn png_in_16_and_8_bits_and_in_colour() {
    let (raster, levels) = numbers();
    let (_folder, path) = written("a.png", &raster, Layout::default());
    let image::DynamicImage::ImageLuma16(read) = image::open(&path).unwrap() else { panic!("not 16-bit gray") };
    assert_eq!(read.dimensions(), (WIDTH as u32, HEIGHT as u32));
    assert_heights(read.as_raw(), levels);
    for (channels, color) in [(1, image::ColorType::L8), (3, image::ColorType::Rgb8), (4, image::ColorType::Rgba8)] {
        let bytes: Vec<u8> = (0..WIDTH * HEIGHT * channels).map(|i| (i * 31 % 251) as u8).collect();
        let raster = Raster { channels, samples: Samples::U8(bytes.clone()), ..floats() };
        let (_folder, path) = written("b.png", &raster, Layout::default());
        let read = image::open(&path).unwrap();
        assert_eq!((read.color(), read.as_bytes()), (color, bytes.as_slice()));
    }
}

fn tiff(path: &Path) -> tiff::decoder::Decoder<std::io::BufReader<File>> {
    tiff::decoder::Decoder::new(std::io::BufReader::new(File::open(path).unwrap())).unwrap()
}

#[test]
fn tiff_in_32_and_16_bits_knows_its_place() {
    use tiff::{decoder::DecodingResult, tags::Tag};
    let (_folder, path) = written("a.tif", &floats(), Layout::default());
    let mut read = tiff(&path);
    assert_eq!(read.dimensions().unwrap(), (WIDTH as u32, HEIGHT as u32));
    assert_eq!(read.get_tag_f64_vec(Tag::ModelPixelScaleTag).unwrap(), [250.0, 250.0, 0.0]);
    let north_m = HEIGHT as f64 * 250.0;
    assert_eq!(read.get_tag_f64_vec(Tag::ModelTiepointTag).unwrap(), [0.0, 0.0, 0.0, 0.0, north_m, 0.0]);
    let DecodingResult::F32(values) = read.read_image().unwrap() else { panic!("not floating point") };
    assert_eq!(values, heights().data);
    let (raster, levels) = numbers();
    let (_folder, path) = written("b.TIFF", &raster, Layout::default());
    let DecodingResult::U16(values) = tiff(&path).read_image().unwrap() else { panic!("not 16 bits") };
    assert_heights(&values, levels);
}

#[test]
fn exr_keeps_every_bit() {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let (_folder, path) = written("a.exr", &floats(), Layout::default());
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(&path)
        .unwrap();
    let channels = &image.layer_data.channel_data.list;
    assert_eq!(channels.len(), 1);
    assert!(channels[0].name.eq("Y"), "{:?}", channels[0].name);
    assert_eq!(channels[0].sample_data.values_as_f32().collect::<Vec<_>>(), heights().data);
}

#[test]
fn ascii_grid_keeps_every_bit() {
    let part = floats().part(3, 5, 60, 30);
    let (_folder, path) = written("a.asc", &part, Layout::default());
    let text = std::fs::read_to_string(&path).unwrap();
    let head: Vec<&str> = text.lines().take(5).collect();
    // The part's south edge lies 41 - 35 cells above the map's.
    assert_eq!(head, ["ncols 60", "nrows 30", "xllcorner 750", "yllcorner 1500", "cellsize 250"]);
    let values: Vec<f32> = text.lines().skip(5).flat_map(|line| line.split(' ')).map(|v| v.parse().unwrap()).collect();
    assert_eq!(Samples::F32(values), part.samples);
}

#[test]
fn bare_numbers_in_either_order() {
    let (raster, levels) = numbers();
    for big_endian in [false, true] {
        for south_first in [false, true] {
            let layout = Layout { big_endian, south_first };
            let (_folder, path) = written("a.r16", &raster, layout);
            let bytes = std::fs::read(&path).unwrap();
            let number = |two: &[u8]| {
                let two = [two[0], two[1]];
                if big_endian { u16::from_be_bytes(two) } else { u16::from_le_bytes(two) }
            };
            let mut rows: Vec<Vec<u16>> =
                bytes.chunks(WIDTH * 2).map(|row| row.chunks(2).map(number).collect()).collect();
            if south_first {
                rows.reverse();
            }
            assert_heights(&rows.concat(), levels);
        }
    }
    let (_folder, path) = written("a.r32", &floats(), Layout::default());
    let bytes = std::fs::read(&path).unwrap();
    let values: Vec<f32> = bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
    assert_eq!(values, heights().data);
}

#[test]
fn endings_are_found_in_any_case_and_only_once() {
    assert!(Format::of(Path::new("A.PNG")).is_some() && Format::of(Path::new("png")).is_none());
    let mut endings: Vec<&str> = FORMATS.iter().flat_map(|format| format.endings).copied().collect();
    let count = endings.len();
    endings.sort_unstable();
    endings.dedup();
    assert_eq!(endings.len(), count);
}
