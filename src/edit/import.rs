//! The stage `import`: a heightmap file becomes bedrock.
//!
//! Read, filled, smoothed if asked for, all at the file's own cells, then brought to the map's.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    EditError, Problem,
    fill::fill,
    read::{self, Header, Heightmap, Scale},
    sidecar::Sidecar,
    unstep::unstep,
};
use crate::{
    grid::{Edges, Field, Grid, Points, resample},
    process::{Context, Placement, Process, ProcessError, State, Step},
    world::{Layer, World},
};

/// Height of white where neither file nor recipe states one, m.
const WHITE_M: f64 = 2000.0;

/// A heightmap from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ImportParams {
    /// The heightmap: .png .tif .exr .r16 .r32 .raw .asc .hgt, or `sample:my-heights.png`.
    #[schemars(extend("x-path" = true, "x-effect" = "another land"))]
    pub path: String,
    /// What the file is; auto goes by its name and checks the content.
    #[schemars(extend("x-effect" = "for files whose name does not tell"))]
    pub format: SourceFormat,
    /// Cells of a raw file, [west-east, north-south]; a square if not given.
    #[schemars(inner(range(min = 2, max = 16384)), extend("x-unit" = "cells", "x-effect" = "cuts the same bytes into other rows"))]
    pub size: Option<[u32; 2]>,
    /// Order of the bytes in a raw file.
    #[schemars(extend("x-effect" = "little is usual; big is what old Macintoshes wrote"))]
    pub endian: Endian,
    /// Height of black (of 0 in a file of fractions), if neither the file nor an export's FILE.json beside it states it: 0, or 2000 m below a white under the sea.
    #[schemars(range(min = -12000.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "higher lowlands"))]
    pub low_m: Option<f64>,
    /// Height of white (of 1 in a file of fractions), if neither the file nor an export's FILE.json beside it states it: 2000 m above black.
    #[schemars(range(min = -12000.0, max = 20000.0), extend("x-unit" = "m", "x-effect" = "higher mountains"))]
    pub high_m: Option<f64>,
    /// How far a height may move to take out the stairs of few bits, in half steps of the file: 1 is enough for 8 bits.
    #[schemars(range(min = 0.0, max = 8.0), extend("x-unit" = "1", "x-effect" = "smoother slopes, less detail"))]
    pub smooth: f64,
    /// What to do about cells without a height.
    #[schemars(extend("x-effect" = "fill: a membrane between their neighbours; refuse: an error"))]
    pub no_data: NoData,
}

/// What an imported file is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SourceFormat {
    /// By its name.
    #[default]
    Auto,
    /// PNG, 8 or 16 bits.
    Png,
    /// TIFF or GeoTIFF.
    Tiff,
    /// OpenEXR.
    Exr,
    /// Raw 16-bit whole numbers.
    R16,
    /// Raw 32-bit fractions, in metres.
    R32,
    /// ESRI ASCII grid.
    Asc,
    /// SRTM tile.
    Hgt,
}

/// Order of bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Endian {
    /// Least byte first.
    #[default]
    Little,
    /// Greatest byte first.
    Big,
}

/// What happens to cells without a height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum NoData {
    /// They are filled smoothly from their neighbours.
    #[default]
    Fill,
    /// The file is refused.
    Refuse,
}

impl Default for ImportParams {
    fn default() -> Self {
        Self {
            path: "sample:my-heights.png".to_owned(),
            format: SourceFormat::Auto,
            size: None,
            endian: Endian::Little,
            low_m: None,
            high_m: None,
            smooth: 0.0,
            no_data: NoData::Fill,
        }
    }
}

impl ImportParams {
    /// The stage as a process.
    pub fn process(self, placement: Placement) -> Box<dyn Process> {
        Box::new(Import { params: self, placement, findings: Vec::new() })
    }

    /// What the file says of itself; reads no heights.
    pub fn probe(&self) -> Result<Header, EditError> {
        self.named(&self.path, || {
            let said = Sidecar::beside(&self.path);
            let told = self.told(said.as_ref());
            let mut source = read::open(&self.path)?;
            let mut header = read::header(&mut source, &told)?;
            let said = said.filter(|said| said.fits(header.width, header.height));
            told.scale(&header, said.as_ref())?;
            header.cell_m = header.cell_m.or(said.map(|said| said.cell_m()));
            Ok(header)
        })
    }

    /// The same with what a sidecar says of a raw file, which says nothing itself.
    fn told(&self, said: Option<&Sidecar>) -> Self {
        let Some(said) = said else { return self.clone() };
        let endian = if said.big_endian() { Endian::Big } else { self.endian };
        Self { size: self.size.or(Some(said.size)), endian, ..self.clone() }
    }

    /// The file's heights at its own cells, filled and smoothed as asked for.
    pub fn read(&self) -> Result<Heightmap, EditError> {
        self.named(&self.path, || self.decode(read::open(&self.path)?, Sidecar::beside(&self.path)))
    }

    /// The same from bytes at hand, under a name whose ending tells the format.
    pub fn read_bytes(&self, name: &str, bytes: Vec<u8>) -> Result<Heightmap, EditError> {
        self.named(name, || self.decode(read::Source::bytes(name, bytes), None))
    }

    fn named<T>(&self, file: &str, read: impl FnOnce() -> Result<T, Problem>) -> Result<T, EditError> {
        read().map_err(|problem| EditError { file: file.to_owned(), problem })
    }

    fn decode(&self, mut source: read::Source, said: Option<Sidecar>) -> Result<Heightmap, Problem> {
        let told = self.told(said.as_ref());
        let header = read::header(&mut source, &told)?;
        let said = said.filter(|said| said.fits(header.width, header.height));
        let scale = told.scale(&header, said.as_ref())?;
        let mut map = read::heights(&mut source, &header, &scale, &told)?;
        if said.is_some_and(|said| said.south_first()) {
            map.heights = map.heights.chunks_exact(map.width).rev().flatten().copied().collect();
        }
        let holes = map.heights.iter().filter(|v| v.is_nan()).count();
        if holes == map.heights.len() {
            return Err(Problem::NoHeights);
        }
        if holes > 0 {
            if self.no_data == NoData::Refuse {
                let first = map.heights.iter().position(|v| v.is_nan()).unwrap_or(0);
                return Err(Problem::Holes(holes, first % map.width, first / map.width));
            }
            fill(&mut map.heights, map.width, map.height);
            map.filled = holes;
        }
        if self.smooth > 0.0 && map.step_m > 0.0 {
            unstep(&mut map.heights, map.width, 0.5 * map.step_m * self.smooth as f32);
        }
        Ok(map)
    }

    /// Which height a value of the file stands for.
    fn scale(&self, header: &Header, said: Option<&Sidecar>) -> Result<Scale, Problem> {
        let stated = header.metres && self.low_m.is_none() && self.high_m.is_none();
        if stated {
            let [low_m, per_value_m] = header.line.unwrap_or([0.0, 1.0]);
            return Ok(Scale { black: 0.0, low_m, per_value_m, step_m: header.sample.step() * per_value_m.abs() });
        }
        let (black, white) = header.sample.ends();
        let said = said.filter(|_| !header.metres);
        let high_m = self.high_m.or(said.and_then(|said| said.white_m));
        let low_m = self.low_m.or(said.and_then(|said| said.black_m)).unwrap_or(match high_m {
            Some(high_m) if high_m <= 0.0 => high_m - WHITE_M,
            _ => 0.0,
        });
        let high_m = high_m.unwrap_or(low_m + WHITE_M);
        if low_m >= high_m {
            return Err(Problem::Levels(low_m, high_m));
        }
        let per_value_m = (high_m - low_m) / (white - black);
        Ok(Scale { black, low_m, per_value_m, step_m: header.sample.step() * per_value_m })
    }

    /// What a person should know before the run, a line each.
    pub fn remarks(&self, header: &Header) -> Vec<String> {
        let mut remarks = Vec::new();
        if header.sample.bits() <= 8 && self.smooth == 0.0 {
            remarks.push(format!(
                "{}: 8 bits hold 256 heights, which show as stairs on slopes; smooth = 1 takes them out",
                self.path
            ));
        }
        // Of its own sample the program knows.
        if self.path.starts_with("sample:") {
            return remarks;
        }
        let said = Sidecar::beside(&self.path).filter(|said| said.fits(header.width, header.height));
        let levels = said.as_ref().filter(|_| !header.metres).and_then(|said| Some((said.black_m?, said.white_m?)));
        if let Some((black_m, white_m)) = levels.filter(|_| self.low_m.is_none() && self.high_m.is_none()) {
            remarks.push(format!(
                "{0}: black is {black_m:.1} m and white {white_m:.1} m, as {0}.json beside it says (low_m, high_m)",
                self.path
            ));
        } else if !header.metres && self.low_m.is_none() && self.high_m.is_none() {
            remarks.push(format!(
                "{}: the file does not say how high it is; black is taken for 0 m and white for {WHITE_M} m (low_m, high_m)",
                self.path
            ));
        }
        remarks
    }
}

/// What a person should know of heights once they are read, a line each.
fn findings(map: &Heightmap) -> Vec<String> {
    let [filled, all] = [map.filled, map.heights.len()];
    let share = 100.0 * filled as f64 / all as f64;
    let infinite = if map.infinite > 0 { format!(", {} of them infinite,", map.infinite) } else { String::new() };
    let line =
        || format!("{filled} of {all} cells ({share:.2} %) had no height{infinite} and were filled in (no_data)");
    Vec::from_iter((filled > 0).then(line))
}

/// Heights at the cells of a world.
fn over(map: Heightmap, grid: Grid) -> Field<f32> {
    // Cells of one unit: only the numbers of cells matter for bringing one raster to another.
    let edges = if grid.edges == Edges::Wrap { Edges::Wrap } else { Edges::Open };
    let own = Grid { width: map.width, height: map.height, cell_m: 1.0, edges };
    let heights = Field { grid: own, data: map.heights };
    Field { grid, data: resample(&heights, grid.width, grid.height, Points::Centres) }
}

struct Import {
    params: ImportParams,
    placement: Placement,
    findings: Vec<String>,
}

impl Process for Import {
    fn writes(&self) -> &'static [Layer] {
        &[Layer::Bedrock]
    }

    fn findings(&self) -> Vec<String> {
        self.findings.clone()
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        context.check()?;
        let ground = self.placement.over(world)?;
        let map = self.params.read().map_err(EditError::into_process)?;
        self.findings = findings(&map);
        let heights = over(map, world.grid);
        context.check()?;
        ground.put(&heights, world, context);
        Ok(Step::WHOLE)
    }

    fn save(&self) -> State {
        State::default()
    }

    fn restore(&mut self, _state: State, _context: &Context) -> Result<(), ProcessError> {
        Ok(())
    }
}
