//! The arguments as they are typed, before anything is believed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, error::ErrorKind};

use super::{CliError, output};

#[derive(Debug, Parser)]
#[command(name = "upthrust", version, about = "Grows a world from its plates", disable_help_subcommand = true)]
struct Raw {
    #[command(subcommand)]
    command: RawCommand,
}

/// A command as typed.
#[derive(Debug, Subcommand)]
pub(crate) enum RawCommand {
    /// Run a recipe (preset name or file) into a folder
    Grow(Box<RawGrow>),
    /// List the presets, or print one
    Presets {
        /// The preset to print
        name: Option<String>,
    },
    /// Every parameter: unit, range, default, what raising it does
    Params(RawParams),
    /// Numbers about a world, and how its landscape compares with Earth
    Inspect(RawInspect),
    /// Write a heightmap, a layer or a mesh for other programs; the ending gives the format
    Export(Box<RawExport>),
    /// A picture of a world
    Render(RawRender),
    /// Replay a kept timeline into a film
    Film(RawFilm),
    /// The desktop application
    #[command(hide = !cfg!(feature = "app"))]
    App(RawApp),
}

/// `grow` as typed.
#[derive(Debug, Default, Args)]
pub(crate) struct RawGrow {
    /// A preset's name, or a recipe file
    #[arg(default_value = super::command::DEFAULT_RECIPE)]
    pub recipe: String,
    /// The folder to make [default: a new one under worlds/]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Another seed than the recipe's
    #[arg(long, value_name = "N|random", allow_hyphen_values = true)]
    pub seed: Option<String>,
    /// Cells a side: sharper, the same land
    #[arg(long, value_name = "N|WxH", allow_hyphen_values = true)]
    pub size: Option<String>,
    /// Set a parameter; may be given several times
    #[arg(long, value_name = "STAGE.PARAM=VALUE", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// End after this stage
    #[arg(long, value_name = "STAGE")]
    pub until: Option<String>,
    /// Threads to use; the world is the same for any number [default: one a core]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Film the run: .mp4 .webm .mpg .mov .gif .png, or frames/%05d.png [default: a film in the world's folder]
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    pub video: Option<Option<PathBuf>>,
    #[command(flatten)]
    pub look: RawLook,
    /// Keep the run's heights (and other layers, named with commas) in its store, to be filmed later
    #[arg(long, value_name = "LAYERS", num_args = 0..=1, require_equals = true, default_missing_value = "height")]
    pub keep_timeline: Option<String>,
    /// Record the particles of each stage that has any (lava, rain_particles), into STAGE.upbake in the world's folder
    #[arg(long)]
    pub bake: bool,
    /// Frames of that to a second of the stage's own time [default: 30]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub bake_rate: Option<String>,
    /// Write numbered 16-bit heightmaps of the run into a new folder, all with one range
    #[arg(long, value_name = "DIR")]
    pub frames: Option<PathBuf>,
    /// A heightmap every so many steps [default: 1]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub every: Option<String>,
    /// Replace the world that --out names
    #[arg(long)]
    pub force: bool,
    /// Go on with the run that was stopped or killed
    #[arg(long)]
    pub resume: bool,
    /// Seconds between checkpoints, 0 for one after each step [default: 45]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub checkpoint_every: Option<String>,
    /// Print the folder, nothing else
    #[arg(long, short)]
    pub quiet: bool,
    /// Print the manifest as JSON
    #[arg(long)]
    pub json: bool,
    /// Seeds of a contact sheet, both ends included
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub seeds: Option<String>,
    /// Draw the seeds on one contact sheet (PNG) instead of growing a folder
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
}

/// What a film is to be like, as typed.
#[derive(Debug, Default, Args)]
pub(crate) struct RawLook {
    /// Frames a second of the film [default: 30]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub fps: Option<String>,
    /// Size of the film, pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub video_size: Option<String>,
    /// What the film shows: relief, a layer, scene (in space), or a layer's colours in space, scene:LAYER [default: relief]
    #[arg(long, value_name = "relief|LAYER|scene")]
    pub view: Option<String>,
    #[command(flatten)]
    pub scene: RawScene,
    /// Show the time in the film
    #[arg(long)]
    pub clock: bool,
    /// Leave out the smoke over vents that erupt
    #[arg(long)]
    pub no_smoke: bool,
    /// What ffmpeg is told besides, in one text
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub ffmpeg_args: Option<String>,
}

/// What is asked of a scene, as typed.
#[derive(Debug, Default, Args)]
pub(crate) struct RawScene {
    /// How a scene's camera moves, or a file of a camera and its keys
    #[arg(long, value_name = "orbit|fly|top|still|FILE")]
    pub camera: Option<String>,
    /// Solar time of a scene, or its first and last in a film
    #[arg(long, value_name = "H|A..B", allow_hyphen_values = true)]
    pub time_of_day: Option<String>,
    /// How carefully a scene is drawn [default: full, films normal]
    #[arg(long, value_name = "draft|normal|full")]
    pub quality: Option<String>,
    /// A file whose [scene] takes the place of the recipe's
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
}

/// `film` as typed.
#[derive(Debug, Args)]
pub(crate) struct RawFilm {
    /// The world's folder, or the store in it
    pub world: PathBuf,
    /// The film: .mp4 .webm .mpg .mov .gif .png, or frames/%05d.png
    pub file: PathBuf,
    #[command(flatten)]
    pub look: RawLook,
    /// Film the finished world for so long, with a camera that moves, instead of its growth (scenes)
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub seconds: Option<String>,
    /// Set a parameter of the scene; may be given several times
    #[arg(long, value_name = "scene.PARAM=VALUE", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// Replace the film that is there
    #[arg(long)]
    pub force: bool,
}

/// `params` as typed.
#[derive(Debug, Args)]
pub(crate) struct RawParams {
    /// A stage's kind, 'world' or 'scene'
    pub stage: Option<String>,
    /// Print the JSON schema of a recipe, for editors
    #[arg(long)]
    pub schema: bool,
    /// Print the page of all parameters
    #[arg(long, hide = true)]
    pub markdown: bool,
}

/// `inspect` as typed.
#[derive(Debug, Args)]
pub(crate) struct RawInspect {
    /// The world's folder, or the store in it; of several, how their numbers spread; or a recording of particles (.upbake)
    #[arg(required = true, value_name = "WORLD")]
    pub worlds: Vec<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Write a report too: .html a page with plots, .md with plots beside it, .json, else text
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
}

/// `export` as typed.
#[derive(Debug, Args)]
pub(crate) struct RawExport {
    /// The world's folder, or the store in it; or a recording of particles (.upbake)
    pub world: PathBuf,
    /// The file: .png .tif .exr .asc .r16 .raw .r32, meshes .glb .obj .stl, maps of lines .svg .geojson, particles .ply .csv
    pub file: PathBuf,
    /// A layer, normals (a normal map), weights (of sand, grass, rock and snow), or plumes (puffs of smoke, .ply .csv)
    #[arg(long, value_name = "NAME", default_value = "height")]
    pub layer: String,
    /// Size, order and the numbers to type as this program wants them: unreal, unity, godot, azgaar
    #[arg(long, value_name = "ENGINE")]
    pub engine: Option<String>,
    /// Cut out a square: its west edge, its north edge, its side
    #[arg(long, value_name = "X_KM,Y_KM,SIZE_KM", allow_hyphen_values = true)]
    pub window: Option<String>,
    /// Samples along the longer side, or along a tile [default: one a cell; meshes 512]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub size: Option<String>,
    /// What black and white stand for, m (or the layer's unit) [default: least and greatest]
    #[arg(long, value_name = "MIN..MAX", allow_hyphen_values = true)]
    pub range: Option<String>,
    /// Cut into N x N tiles that share their edges
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub tiles: Option<String>,
    /// Bits of a sample: 8 or 16 for .png, 16 or 32 for .tif [default: 16, .tif 32]
    #[arg(long, value_name = "8|16|32", allow_hyphen_values = true)]
    pub bits: Option<String>,
    /// Most significant byte first (.r16 .raw .r32)
    #[arg(long)]
    pub big_endian: bool,
    /// Southern row first (.r16 .raw .r32)
    #[arg(long, value_name = "y")]
    pub flip: Option<String>,
    /// Green of a normal map: up (OpenGL) or down (DirectX) [default: up, for unreal down]
    #[arg(long, value_name = "up|down")]
    pub normal_y: Option<String>,
    /// Metres between contours (.svg .geojson) [default: a round number, about a dozen on land]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub contours: Option<String>,
    /// The moment of a recording, since its stage began; of smoke, since the first left a vent [default: the last]
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub at: Option<String>,
    /// A new folder of files, such as points/%05d.ply, one for every so many seconds from --at or the beginning to the end
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub every: Option<String>,
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
}

/// `render` as typed.
#[derive(Debug, Args)]
pub(crate) struct RawRender {
    /// The world's folder, or the store in it
    pub world: PathBuf,
    /// The picture (PNG or JPEG)
    pub file: PathBuf,
    /// What to draw: relief, a layer, scene (in space), or a layer's colours in space, scene:LAYER
    #[arg(long, value_name = "relief|LAYER|scene", default_value = "relief")]
    pub view: String,
    /// Size of a scene's picture, pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<String>,
    #[command(flatten)]
    pub scene: RawScene,
    /// Set a parameter of the scene; may be given several times
    #[arg(long, value_name = "scene.PARAM=VALUE", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// Plate borders and motions over it
    #[arg(long)]
    pub overlay: bool,
    /// Smoke over the relief, where a vent erupts
    #[arg(long)]
    pub smoke: bool,
}

/// `app` as typed.
#[derive(Debug, Args)]
pub(crate) struct RawApp {
    /// The world to show: its folder, or the store in it
    pub world: Option<PathBuf>,
    /// Save a picture of the window (PNG) and close it
    #[arg(long, value_name = "FILE")]
    pub screenshot: Option<PathBuf>,
}

/// The command of this process; `None` if help or the version was asked for and printed.
pub(crate) fn parse() -> Result<Option<RawCommand>, CliError> {
    match Raw::try_parse() {
        Ok(raw) => Ok(Some(raw.command)),
        Err(error) => match error.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match error.print() {
                Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::System(e.to_string())),
                _ => Ok(None),
            },
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                output::say(&error.render().to_string());
                Err(CliError::Request("name a command, such as 'upthrust grow'".into()))
            }
            _ => Err(CliError::Request(one_line(&error))),
        },
    }
}

/// clap's message and its tip, without the usage.
fn one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let parts = text.split("\n\n").filter(|part| !part.trim_start().starts_with("Usage:"));
    let parts: Vec<String> = parts
        .filter(|part| !part.starts_with("For more information"))
        // Nobody who mistypes a flag means it as a value.
        .filter(|part| !part.contains("as a value, use '-- "))
        .map(|part| part.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|part| !part.is_empty())
        .collect();
    match parts.as_slice() {
        [] => "this command cannot be understood; see 'upthrust --help'".to_owned(),
        [only] => format!("{only}; see 'upthrust --help'"),
        [first, rest @ ..] => format!("{first} ({})", rest.join("; ").replace("tip: ", "")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_grammar_is_sound() {
        Raw::command().debug_assert();
    }

    #[test]
    fn messages_are_one_line() {
        let said = |args: &[&str]| one_line(&Raw::try_parse_from(args).unwrap_err());
        assert_eq!(
            said(&["upthrust", "grow", "--sizee", "3"]),
            "unexpected argument '--sizee' found (a similar argument exists: '--size')"
        );
        assert_eq!(
            said(&["upthrust", "render", "w"]),
            "the following required arguments were not provided: <FILE>; see 'upthrust --help'"
        );
        assert!(!said(&["upthrust", "growl"]).contains('\n'));
    }
}
