//! Draws `docs/gallery/`: every preset, the plates of `collision` in motion, what else its world knows, its waters, a
//! continent and a valley in it, one start eroded five ways, lava hot and cold, films of a
//! canyon and of an eruption, and the report that sets the default world
//! beside Earth.
//!
//! `cargo run --release --example gallery` draws it all; names of pictures after `--` draw only those. Films need ffmpeg.

use std::{
    error::Error,
    fmt::Write as _,
    path::{Path, PathBuf},
    process::Command,
    sync::atomic::AtomicBool,
};

use image::{RgbImage, codecs::jpeg::JpegEncoder};
use upthrust::{
    job::{self, film::FilmRequest},
    measure::{
        self,
        report::{self, Subject},
    },
    recipe::{self, Overrides, Plan, Preset},
    relief::{self, Options, View},
    timeline::{self, Interest, Moment, Sink, Timeline},
    world::{Layer, World},
};

/// Cells a side of the presets' worlds, and pixels of their maps.
const SIDE: usize = 512;
/// Cells a side of the worlds on sheets, and pixels of their panels.
const PANEL: usize = 320;
const PANELS: usize = 6;
/// Cells below this width are chosen for particles, m.
const PARTICLES_M: f64 = 3.0;
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
    if wants("waters") {
        page.draw("waters", &waters()?)?;
    }
    if wants("three-scales") {
        page.draw("three-scales", &three_scales()?)?;
    }
    if wants("five-ways") {
        for (name, picture) in five_ways()? {
            page.draw(&name, &picture)?;
        }
    }
    if wants("fire") {
        page.draw("fire", &fire()?)?;
    }
    if wants("eruption-film") {
        page.film("eruption", "eruption-film")?;
    }
    if wants("canyon-film") {
        page.film("canyon", "canyon-film")?;
    }
    if wants("report") {
        page.report()?;
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

    /// A preset as it grows: a moving picture that pages show, small enough to be kept.
    fn film(&self, preset: &str, name: &str) -> Outcome<()> {
        let preset = recipe::find_preset(preset).ok_or_else(|| format!("there is no preset '{preset}'"))?;
        let folder = std::env::temp_dir().join(format!("upthrust-{name}-{}", std::process::id()));
        let film = folder.join("film.mp4");
        job::grow(&request(preset, &folder)?, &AtomicBool::new(false), &mut |_| ())?;
        let small = [
            "-vf",
            "fps=5,scale=560:-2:flags=lanczos",
            "-loop",
            "0",
            "-compression_level",
            "6",
            "-quality",
            "60",
            "-y",
        ];
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg.args(["-v", "error", "-i"]).arg(&film).args(small).arg(self.folder.join(name).with_extension("webp"));
        let done = ffmpeg.status()?;
        std::fs::remove_dir_all(&folder)?;
        if done.success() { Ok(()) } else { Err(format!("ffmpeg could not make {name}").into()) }
    }

    /// The default world beside Earth, with the plots in a folder of their own.
    fn report(&self) -> Outcome<()> {
        let plan = plan(recipe::find_preset("collision").ok_or("there is no preset 'collision'")?, SIDE)?;
        let survey = measure::survey(&grow(&plan, &mut [])?);
        let (text, plots) = report::markdown(&[Subject { name: "collision".to_owned(), survey }], "report_plots");
        let folder = self.folder.join("report_plots");
        std::fs::create_dir_all(&folder)?;
        for (name, svg) in plots {
            std::fs::write(folder.join(name), svg)?;
        }
        Ok(std::fs::write(self.folder.join("report.md"), text)?)
    }

    fn write_captions(&self) -> Outcome<()> {
        let mut text = String::from(
            "# Gallery\n\nEvery picture here is drawn by `cargo run --release --example gallery`; nothing is retouched. \
             Worlds in space are in [Scenes](../scene.md).\n\n",
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
            (
                "waters",
                "Rain, rivers, lakes and what grows",
                "The same continent and its weather. Westerly wind brings the rain; behind the ranges it is dry. Runoff \
                 feeds the rivers, drawn the wider the more they carry; lakes lie where the plates closed a basin.",
            ),
            (
                "three-scales",
                "From continent to valley",
                "Preset `continent-to-valley`: 1,000 km, then 64 km of it, then 5 km, each carved anew by the rivers \
                 that come in over its rim.",
            ),
            (
                "five-ways",
                "One start, eroded five ways",
                "Fractal hills a kilometre across, and what each family of erosion makes of them; in the second row \
                 what it wore off. [Erosion](../erosion.md) says which is for what.\n\n![How a year's rain runs over \
                 each](five-ways-flow.jpg)",
            ),
        ];
        for (name, title, caption) in sheets {
            writeln!(text, "## {title}\n\n![{title}]({name}.jpg)\n\n{caption}\n")?;
        }
        text += "## Fire\n\n![An island erupts](eruption-film.webp)\n\n`upthrust grow eruption --video eruption.mp4 --clock`: lava \
                 by its temperature, black below 500 °C, red at 900, yellow at 1200; what has frozen is dark and is ground \
                 from then on.\n\n![Lava hot, frozen, and eroded](fire.jpg)\n\nAbove, preset `eruption` as it runs and \
                 where it froze; below, the flows of `shield-flows` fresh, under ash and after three thousand years of \
                 rain, and how thick they lie.\n\n";
        text += "## A canyon\n\n![A canyon being cut](canyon-film.webp)\n\n`upthrust grow canyon --video canyon.mp4 --clock`: a \
                 third of a million years of rivers, then a flood, then slides.\n\n";
        text += "## Beside Earth\n\nThe default world's landscape, measured: [report](report.md), as `upthrust inspect WORLD \
                 --report FILE.md` writes it.\n\n";
        text += "## Presets\n\n";
        for preset in recipe::presets() {
            let (title, description) = preset.summary();
            let name = preset.name;
            writeln!(text, "### {title}\n\n![{title}]({name}.jpg)\n\n`upthrust grow {name}`: {description}.\n")?;
        }
        Ok(std::fs::write(self.folder.join("README.md"), text.trim_end().to_owned() + "\n")?)
    }
}

/// A preset at its own size with a small film in its folder.
fn request(preset: &Preset, folder: &Path) -> Outcome<job::Request> {
    Ok(job::Request {
        plan: Plan::new(&preset.source(), &Overrides::default())?,
        out: Some(folder.to_owned()),
        existing: job::Existing::Replace,
        checkpoint_every: timeline::EVERY,
        until: None,
        film: Some(FilmRequest {
            size: Some([1120, 630]),
            view: "relief".to_owned(),
            clock: true,
            smoke: true,
            ..FilmRequest::default()
        }),
        frames: None,
        bake_per_s: None,
        keep: None,
    })
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
    let own = Plan::new(&preset.source(), &Overrides::default())?.world.grid();
    // Particles suit the cells that they were chosen for.
    let plan = plan(preset, if own.cell_m < PARTICLES_M { own.width } else { SIDE })?;
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
    fn wants(&mut self, moment: &Moment) -> Interest {
        let due = moment.done >= self.worlds.len() as f64 / (PANELS - 1) as f64
            || self.worlds.is_empty()
            || moment.stage_over() && self.worlds.len() < PANELS;
        Interest::Whole.when(due)
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

fn waters() -> Outcome<RgbImage> {
    let side = PANEL + PANEL / 2;
    let plan = plan(recipe::find_preset("collision").ok_or("there is no preset 'collision'")?, side)?;
    let world = grow(&plan, &mut [])?;
    let options = Options { furniture: true, ..Options::bare(side) };
    let layers = [Layer::Rain, Layer::Discharge, Layer::Biome].map(|layer| (layer.name(), View::Layer(layer)));
    let panels = std::iter::once(("rivers and lakes", View::Relief)).chain(layers);
    let panels = panels.map(|(label, view)| Ok((label.to_owned(), relief::map(&world, &view, &options)?)));
    Ok(relief::contact_sheet(&panels.collect::<Outcome<Vec<_>>>()?, 2))
}

/// Keeps the world at the end of every stage.
#[derive(Default)]
struct Ends {
    worlds: Vec<World>,
}

impl Sink for Ends {
    fn wants(&mut self, moment: &Moment) -> Interest {
        Interest::Whole.when(moment.stage_over())
    }

    fn take(&mut self, world: &World, _: &Moment) -> Result<(), String> {
        self.worlds.push(world.clone());
        Ok(())
    }
}

/// An eruption as it runs and as it froze, and flows before and after rain.
fn fire() -> Outcome<RgbImage> {
    let preset = |name: &str| recipe::find_preset(name).ok_or_else(|| format!("there is no preset '{name}'"));
    let mut album = Album::default();
    let own = Plan::new(&preset("eruption")?.source(), &Overrides::default())?;
    let cold = grow(&own, &mut [&mut album])?;
    let hot = album.worlds.iter().rfind(|world| flows(world)).ok_or("nothing flows in the eruption's pictures")?;
    let mut ends = Ends::default();
    let worn = grow(&plan(preset("shield-flows")?, SIDE)?, &mut [&mut ends])?;
    // The last two stages are the ash and the rain.
    let fresh = ends.worlds.iter().rev().nth(2).ok_or("shield-flows has too few stages")?;
    let layer = View::Layer;
    let panels = [
        ("an island erupts", hot, View::Relief),
        ("temperature of what flows", hot, layer(Layer::MoltenTemperature)),
        ("temperature at which it froze", &cold, layer(Layer::LavaTemperature)),
        ("flows of a shield volcano", fresh, View::Relief),
        ("after ash and rain", &worn, View::Relief),
        ("thickness of lava", &worn, layer(Layer::Lava)),
    ];
    let options = Options { furniture: true, ..Options::bare(PANEL) };
    let panels = panels.map(|(label, world, view)| Ok((label.to_owned(), relief::map(world, &view, &options)?)));
    Ok(relief::contact_sheet(&panels.into_iter().collect::<Outcome<Vec<_>>>()?, PANELS / 2))
}

fn flows(world: &World) -> bool {
    world.layer(Layer::MoltenLava).is_some_and(|lava| lava.data.iter().any(|&depth| depth > 0.0))
}

/// Keeps the last world of every raster that a run goes through.
#[derive(Default)]
struct Scales {
    worlds: Vec<World>,
}

impl Sink for Scales {
    fn wants(&mut self, moment: &Moment) -> Interest {
        Interest::Whole.when(moment.stage_over())
    }

    fn take(&mut self, world: &World, _: &Moment) -> Result<(), String> {
        if self.worlds.last().is_some_and(|last| last.grid == world.grid) {
            self.worlds.pop();
        }
        self.worlds.push(world.clone());
        Ok(())
    }
}

fn three_scales() -> Outcome<RgbImage> {
    let mut scales = Scales::default();
    let preset = recipe::find_preset("continent-to-valley").ok_or("there is no preset 'continent-to-valley'")?;
    grow(&plan(preset, SIDE)?, &mut [&mut scales])?;
    let options = Options { furniture: true, ..Options::bare(SIDE) };
    let panels = scales.worlds.iter().map(|world| {
        let label = format!("{:.0} km", world.grid.extent_m()[0] / 1e3);
        Ok((label, relief::map(world, &View::Relief, &options)?))
    });
    let panels = panels.collect::<Outcome<Vec<_>>>()?;
    Ok(relief::contact_sheet(&panels, panels.len()))
}

/// The same hills as they were and after each family, and below what was worn off, a metre on the mean of the map; on
/// another sheet how rain would run; and a picture for each family of the hills before, after, and what was laid down.
fn five_ways() -> Outcome<Vec<(String, RgbImage)>> {
    const WAYS: [(&str, &str); 6] = [
        ("the start", ""),
        ("thermal", "talus_angle_deg = 25.0\nrock_angle_deg = 30.0\n"),
        ("hydraulic_cells", "morphological_factor = 28000.0\n"),
        ("pipes", "duration_h = 9.3\ntalus_angle_deg = 50.0\nwet_talus_angle_deg = 50.0\n"),
        ("rain_particles", "duration_min = 2.0\nmorphological_factor = 72.0\n"),
        ("droplets", "duration_yr = 5500.0\n"),
    ];
    let options = Options::bare(PANEL);
    let (mut above, mut below, mut flow, mut pictures) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    // The table of docs/erosion.md.
    println!("| stage | set | mean wear | greatest | median slope | over 35° | streams, km/km² | pits | time |");
    println!("|---|---|---:|---:|---:|---:|---:|---:|---:|");
    for (name, params) in WAYS {
        let eroded = !name.contains(' ');
        let stage = if eroded { format!("[[stage]]\nkind = '{name}'\n{params}") } else { String::new() };
        let plan = hills(&format!("{stage}[[stage]]\nkind = 'rivers'\ncarve = 0.0\n"))?;
        let never = AtomicBool::new(false);
        let (mut timeline, mut ends) = (Timeline::new(&plan, &never), Ends::default());
        let flowing = timeline.run(&mut [&mut ends], &mut |_| ())?;
        let record = timeline.records().iter().find(|record| record.kind == name);
        let [.., world, _] = &ends.worlds[..] else { return Err("the hills have too few stages".into()) };
        println!("{}", figures((name, params), world, &flowing, record.map_or(0.0, |record| record.seconds))?);
        let relief = relief::map(world, &View::Relief, &options)?;
        let (seen, label) = match world.layer(Layer::Wear).filter(|_| eroded) {
            Some(wear) => {
                let sum: f64 = wear.data.iter().map(|&v| v as f64).sum();
                let most = wear.range().map_or(0.0, |(_, most)| most);
                let mean = sum / wear.data.len() as f64;
                (Layer::Wear, format!("wear: mean {mean:.2} m, most {most:.0} m"))
            }
            None => (Layer::Slope, "slope".to_owned()),
        };
        above.push((name.to_owned(), relief.clone()));
        below.push((label, relief::map(world, &View::Layer(seen), &options)?));
        flow.push((format!("{name}: discharge"), relief::map(&flowing, &View::Layer(Layer::Discharge), &options)?));
        if eroded {
            let deposit = relief::map(world, &View::Layer(Layer::Deposit), &options)?;
            let before = ("before".to_owned(), above[0].1.clone());
            let panels = [before, ("after".to_owned(), relief), ("laid down".to_owned(), deposit)];
            pictures.push((format!("before-after-{name}"), relief::contact_sheet(&panels, panels.len())));
        }
    }
    above.append(&mut below);
    let sheets = [("five-ways", above), ("five-ways-flow", flow)];
    pictures.extend(sheets.map(|(name, panels)| (name.to_owned(), relief::contact_sheet(&panels, WAYS.len()))));
    Ok(pictures)
}

/// A row of the table: what a family wore off, and the land that it left.
fn figures((name, params): (&str, &str), world: &World, flowing: &World, seconds: f64) -> Outcome<String> {
    let survey = measure::survey(world);
    let (slopes, pits) = (survey.slopes?, survey.pits?);
    let median = slopes.percentiles_deg.iter().find(|(percent, _)| *percent == 50).map_or(0.0, |(_, slope)| *slope);
    // Bins of five degrees.
    let steep: f64 = slopes.histogram[7..].iter().sum();
    let wear = world.layer(Layer::Wear);
    let mean = wear.map_or(0.0, |wear| wear.data.iter().map(|&v| v as f64).sum::<f64>() / wear.data.len() as f64);
    let most = wear.and_then(|wear| wear.range()).map_or(0.0, |(_, most)| most);
    let set: Vec<String> = params.lines().map(|line| format!("`{}`", line.trim_end_matches(".0"))).collect();
    Ok(format!(
        "| {} | {} | {mean:.2} m | {most:.0} m | {median:.1}° | {:.1} % | {:.1} | {} | {seconds:.1} s |",
        if params.is_empty() { name.to_owned() } else { format!("`{name}`") },
        set.join(", "),
        100.0 * steep,
        streams(flowing),
        pits.pits
    ))
}

/// Streams that drain a hectare and more, km/km²: the least discharge is that of a single cell.
fn streams(world: &World) -> f64 {
    let Some(discharge) = world.layer(Layer::Discharge) else { return 0.0 };
    let one = discharge.data.iter().copied().filter(|&v| v > 0.0).fold(f32::INFINITY, f32::min);
    let hectare = one * (1e4 / world.grid.cell_area_m2()) as f32;
    let cells = discharge.data.iter().filter(|&&v| v >= hectare).count();
    1e3 * cells as f64 * world.grid.cell_m / (discharge.data.len() as f64 * world.grid.cell_area_m2())
}

/// Hills a kilometre across, and what a stage makes of them.
fn hills(stage: &str) -> Outcome<Plan> {
    const HILLS: &str = "[world]\nseed = 4\nextent_km = 1.0\nsea_level_m = -1000.0\n[[stage]]\nkind = 'fbm'\n\
                         height_m = 110.0\nbase_m = 300.0\nwavelength_km = 0.7\nhurst = 1.0\n";
    let source = recipe::Source {
        name: "five-ways".to_owned(),
        file: "five-ways".to_owned(),
        folder: PathBuf::new(),
        text: format!("{HILLS}{stage}"),
    };
    let overrides = Overrides { size: Some("256".to_owned()), ..Overrides::default() };
    Ok(Plan::new(&source, &overrides)?)
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
