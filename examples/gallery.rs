//! Draws `docs/gallery/`: every preset, the plates of `collision` in motion, and what else its world knows.
//!
//! `cargo run --release --example gallery` draws it all; names of pictures after `--` draw only those.

use std::{
    error::Error,
    fmt::Write as _,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use image::{RgbImage, codecs::jpeg::JpegEncoder};
use upthrust::{
    recipe::{self, Overrides, Plan, Preset},
    relief::{self, Options, View},
    timeline::{Moment, Sink, Timeline},
    world::{Layer, World},
};

/// Cells a side of the presets' worlds, and pixels of their maps.
const SIDE: usize = 512;
/// Cells a side of the worlds on sheets, and pixels of their panels.
const PANEL: usize = 320;
const PANELS: usize = 6;
const QUALITY: u8 = 85;
/// The repository stays small: a larger picture is encoded more coarsely.
const MOST_BYTES: usize = 190_000;
const LAYERS: [Layer; 5] = [Layer::PlateId, Layer::CrustAge, Layer::CrustThickness, Layer::Uplift, Layer::BoundaryKind];

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gallery");
    std::fs::create_dir_all(&folder)?;
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let wants = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    let page = Page { folder };
    for preset in recipe::presets() {
        if wants(preset.name) {
            page.draw(preset.name, &preset_picture(preset)?)?;
        }
    }
    if wants("plates-in-motion") {
        page.draw("plates-in-motion", &plates_in_motion()?)?;
    }
    if wants("layers") {
        page.draw("layers", &layers()?)?;
    }
    page.write_captions()
}

/// The folder of pictures.
struct Page {
    folder: PathBuf,
}

impl Page {
    fn draw(&self, name: &str, picture: &RgbImage) -> Outcome<()> {
        let encode = |quality: u8| -> Outcome<Vec<u8>> {
            let mut bytes = Vec::new();
            JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(picture)?;
            Ok(bytes)
        };
        let mut quality = QUALITY;
        let mut bytes = encode(quality)?;
        while bytes.len() > MOST_BYTES && quality > 50 {
            quality -= 5;
            bytes = encode(quality)?;
        }
        println!("{name}: {} x {}, {} kB", picture.width(), picture.height(), bytes.len() / 1000);
        Ok(std::fs::write(self.folder.join(name).with_extension("jpg"), bytes)?)
    }

    fn write_captions(&self) -> Outcome<()> {
        let mut text = String::from(
            "# Gallery\n\nEvery picture here is drawn by `cargo run --release --example gallery`; nothing is retouched.\n\n",
        );
        let sheets = [
            (
                "plates-in-motion",
                "Plates in motion",
                "Preset `collision` through its 10 million years. Red borders close between continents, purple ones with \
                 teeth swallow ocean floor, orange double lines spread, green ones slide. Arrows show where each plate \
                 goes, in mm a year.",
            ),
            (
                "layers",
                "What a world knows",
                "The same world at its end, layer by layer. Each is in `world.zarr`, and `upthrust render WORLD FILE \
                 --view LAYER` draws it.",
            ),
        ];
        for (name, title, caption) in sheets {
            writeln!(text, "## {title}\n\n![{title}]({name}.jpg)\n\n{caption}\n")?;
        }
        text += "## Presets\n\n";
        for preset in recipe::presets() {
            let (title, description) = preset.summary();
            let name = preset.name;
            writeln!(text, "### {title}\n\n![{title}]({name}.jpg)\n\n`upthrust grow {name}`: {description}.\n")?;
        }
        Ok(std::fs::write(self.folder.join("README.md"), text.trim_end().to_owned() + "\n")?)
    }
}

fn plan(preset: &Preset, side: usize) -> Outcome<Plan> {
    let overrides = Overrides { size: Some(side.to_string()), ..Overrides::default() };
    Ok(Plan::new(&preset.source(), &overrides)?)
}

fn grow(plan: &Plan, sinks: &mut [&mut dyn Sink]) -> Outcome<World> {
    let never = AtomicBool::new(false);
    Ok(Timeline::new(plan, &never).run(sinks, &mut |_| ())?)
}

fn collision() -> Outcome<Plan> {
    plan(recipe::find_preset("collision").ok_or("there is no preset 'collision'")?, PANEL)
}

fn preset_picture(preset: &Preset) -> Outcome<RgbImage> {
    let plan = plan(preset, SIDE)?;
    let world = grow(&plan, &mut [])?;
    let options = Options { title: Some(plan.title.clone()), max_px: SIDE, ..Options::default() };
    Ok(relief::map(&world, &View::Relief, &options)?)
}

/// Keeps the world as it is at the beginning and at even distances to the end.
#[derive(Default)]
struct Album {
    worlds: Vec<World>,
}

impl Sink for Album {
    fn wants(&mut self, moment: &Moment) -> bool {
        moment.done >= self.worlds.len() as f64 / (PANELS - 1) as f64
            || self.worlds.is_empty()
            || moment.stage_over() && self.worlds.len() < PANELS
    }

    fn take(&mut self, world: &World, _: &Moment) -> Result<(), String> {
        self.worlds.push(world.clone());
        Ok(())
    }
}

fn plates_in_motion() -> Outcome<RgbImage> {
    let mut album = Album::default();
    let last = grow(&collision()?, &mut [&mut album])?;
    let bare = Options { overlay: true, ..Options::bare(PANEL) };
    // One light for all, so that what changes is the land.
    let options = Options { exaggeration: Some(relief::exaggeration(&last, &bare)), ..bare };
    let panels = album.worlds.iter().map(|world| {
        let label = format!("{:.0} million years", world.time_yr / 1e6);
        Ok((label, relief::map(world, &View::Relief, &options)?))
    });
    Ok(relief::contact_sheet(&panels.collect::<Outcome<Vec<_>>>()?, PANELS / 2))
}

fn layers() -> Outcome<RgbImage> {
    let world = grow(&collision()?, &mut [])?;
    let options = Options { furniture: true, ..Options::bare(PANEL) };
    let views = std::iter::once(View::Relief).chain(LAYERS.map(View::Layer));
    let panels = views.map(|view| {
        let label = match view {
            View::Relief => "relief".to_owned(),
            View::Layer(layer) => layer.name().to_owned(),
        };
        Ok((label, relief::map(&world, &view, &options)?))
    });
    Ok(relief::contact_sheet(&panels.collect::<Outcome<Vec<_>>>()?, PANELS / 2))
}
