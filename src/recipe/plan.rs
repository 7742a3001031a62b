//! The validated recipe: a map, ordered stages, a scene.

use std::{collections::BTreeMap, path::Path};

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value as Json;

use crate::{
    grid::Grid,
    process::{Blend, Placement, ProcessError},
    scene::SceneParams,
    world::{Layer, Mask, open_picture},
};

use super::{
    FilmTime, Overrides, Size, Source, Stage, StageKind, WorldParams,
    error::{Problem, RecipeError},
    imports::Imports,
    near::nearest,
    scene,
    schema::{self, Checker},
    stages,
    tree::{self, Node, Place, Table, Value, quoted},
    world::MIN_SIDE,
};

/// A recipe that can be run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Short name, for folders.
    pub name: String,
    /// What finds the recipe again: the preset's name or the file's path.
    pub asked: String,
    /// Name for people.
    pub title: String,
    /// One line about it.
    pub description: String,
    /// The map.
    pub world: WorldParams,
    /// The stages, in order.
    pub stages: Vec<Stage>,
    /// How the world is to be seen: camera, light, water.
    pub scene: SceneParams,
    /// The recipe as it runs, flags included.
    pub text: String,
    /// What a person should know before it runs, a line each.
    pub notes: Vec<String>,
}

/// The keys that every stage knows.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "kind and id are read off the tree before; here they are described")]
pub(crate) struct CommonKeys {
    /// What the stage is.
    pub kind: String,
    /// Its own name; for --set, and for its random numbers.
    pub id: Option<String>,
    /// Whether it runs (default true).
    #[serde(default = "on")]
    pub enabled: bool,
    /// Where it acts, and how strongly: a layer, a range of one (`slope > 30`), or an image.
    pub mask: Option<String>,
    /// An expert's number of steps; with it, another size may give another land.
    #[schemars(range(min = 1, max = 1000000))]
    pub steps: Option<u64>,
    /// How long it takes in a film; 0 leaves it out.
    #[schemars(range(min = 0.0, max = 3600.0), extend("x-unit" = "s", "x-effect" = "a slower film"))]
    pub film_seconds: Option<f64>,
    /// Years that pass in a second of a film; instead of film_seconds.
    #[schemars(range(min = 0.001, max = 1e9), extend("x-unit" = "yr/s", "x-effect" = "a faster film"))]
    pub film_yr_per_s: Option<f64>,
    /// Seconds of the world that pass in a second of a film; instead of film_seconds.
    #[schemars(range(min = 0.001, max = 1e9), extend("x-unit" = "s/s", "x-effect" = "a faster film"))]
    pub film_s_per_s: Option<f64>,
    /// How its heights join what is there (default replace); base terrain only.
    #[serde(default)]
    pub blend: Blend,
}

fn on() -> bool {
    true
}

/// A Julian year.
const SECONDS_PER_YEAR: f64 = 365.25 * 86_400.0;

/// How a stage can be named.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StageKey {
    pub kind: String,
    pub id: Option<String>,
    /// Which of its kind, from 1.
    pub ordinal: usize,
    /// Whether it is the only one of its kind.
    pub only: bool,
}

impl StageKey {
    pub fn numbered(&self) -> String {
        format!("{}#{}", self.kind, self.ordinal)
    }

    /// The name for random numbers: it must not change when a stage is added behind or a stage of another kind anywhere.
    pub fn key(&self) -> String {
        self.id.clone().unwrap_or_else(|| self.numbered())
    }

    pub fn label(&self) -> String {
        match &self.id {
            Some(id) => id.clone(),
            None if self.only => self.kind.clone(),
            None => self.numbered(),
        }
    }
}

/// The names of a tree's stages; a stage without a readable kind has an empty one.
pub(crate) fn stage_keys(root: &Table) -> Vec<StageKey> {
    let Some(Node { value: Value::List(stages), .. }) = root.get("stage") else { return Vec::new() };
    let text = |node: &Node, key: &str| match &node.value {
        Value::Table(table) => match table.get(key).map(|node| &node.value) {
            Some(Value::Text(text)) => Some(text.clone()),
            _ => None,
        },
        _ => None,
    };
    let kinds: Vec<String> = stages.iter().map(|node| text(node, "kind").unwrap_or_default()).collect();
    let count = |kinds: &[String], kind: &str| kinds.iter().filter(|k| *k == kind).count();
    stages
        .iter()
        .enumerate()
        .map(|(i, node)| StageKey {
            kind: kinds[i].clone(),
            id: text(node, "id"),
            ordinal: count(&kinds[..=i], &kinds[i]),
            only: count(&kinds, &kinds[i]) == 1,
        })
        .collect()
}

/// Where the stages of a tree stand.
fn stage_places(root: &Table) -> Vec<Place> {
    match root.get("stage").map(|node| &node.value) {
        Some(Value::List(items)) => items.iter().map(|item| item.place.clone()).collect(),
        _ => Vec::new(),
    }
}

impl Plan {
    /// Validates a recipe with its overrides.
    pub fn new(source: &Source, overrides: &Overrides) -> Result<Self, RecipeError> {
        let mut root = tree::parse(&source.text, &source.file)?;
        overrides.apply(&mut root)?;
        let reader = Reader { file: &source.file, folder: &source.folder };
        reader.top(&root)?;
        let mut world: WorldParams = match root.get("world") {
            Some(node) => reader.section(node, "world", &schema::of::<WorldParams>())?,
            None => WorldParams::default(),
        };
        reader.sides(&world, &root)?;
        let stages = reader.stages(&root)?;
        let mut imports = Imports::find(&root, &stages, &source.file)?;
        imports.lay_out(&mut world, &root, &source.file)?;
        // A file can be a sliver too.
        reader.sides(&world, &root)?;
        let stages = reader.couple(&root, stages)?;
        let remarks = reader.fit(&root, &stages, world.grid())?;
        let text = |key: &str| match root.get(key).map(|node| &node.value) {
            Some(Value::Text(text)) => Some(text.clone()),
            _ => None,
        };
        let scene = scene::of(&reader, &root)?;
        Ok(Self {
            name: slug(&source.name),
            asked: source.file.clone(),
            title: world.name.clone().or(text("name")).unwrap_or_else(|| source.name.clone()),
            description: text("description").unwrap_or_default(),
            world,
            stages,
            scene,
            text: if overrides.is_empty() { source.text.clone() } else { tree::write(&root) },
            notes: imports.notes.into_iter().chain(remarks).collect(),
        })
    }

    /// The stages that run, with their place in the recipe.
    pub fn running(&self) -> impl Iterator<Item = (usize, &Stage)> {
        self.stages.iter().enumerate().filter(|(_, stage)| stage.enabled)
    }

    /// The same plan on a map whose longer side has `side` cells; stages that state their own number of cells have in
    /// proportion fewer.
    pub fn shrunk(&self, side: usize) -> Self {
        let mut small = self.clone();
        let [width, height] = self.world.size.cells();
        let longer = width.max(height);
        let shrink = |cells: usize| (cells * side / longer).clamp(MIN_SIDE, cells.max(MIN_SIDE));
        small.world.size = Size::Sides([shrink(width), shrink(height)]);
        for stage in small.stages.iter_mut().filter(|stage| stage.kind.kind == "zoom") {
            if let Some(cells) = stage.params["size"].as_u64() {
                stage.params["size"] = shrink(cells as usize).into();
            }
        }
        small
    }

    /// The same without what takes hours: its ground at about the same heights, in far less time.
    pub fn without_hours(mut self) -> Self {
        self.stages.iter_mut().filter(|stage| stage.takes_hours()).for_each(|stage| stage.enabled = false);
        self
    }

    /// The map with the most cells there is in the run.
    pub fn largest_grid(&self) -> Grid {
        let first = self.world.grid();
        self.grids().into_iter().fold(first, |most, grid| if grid.cells() > most.cells() { grid } else { most })
    }

    /// The map of each stage that runs, as it is when the stage is over; those that change it are asked.
    pub fn grids(&self) -> Vec<Grid> {
        let mut grid = self.world.grid();
        let after = |(_, stage): (usize, &Stage)| {
            grid = stage.build().map_or(grid, |process| process.grid_after(&grid));
            grid
        };
        self.running().map(after).collect()
    }

    /// The stage that a word means: its id, kind#ordinal, or its kind where that is the only one.
    pub fn find_stage(&self, name: &str) -> Option<usize> {
        let exact = self.stages.iter().position(|s| s.is_called(name) || s.coupled.iter().any(|c| c.is_called(name)));
        exact.or_else(|| {
            let mut of_kind = self.stages.iter().enumerate().filter(|(_, stage)| stage.kind.kind == name);
            of_kind.next().filter(|_| of_kind.next().is_none()).map(|(i, _)| i)
        })
    }

    /// The names of all stages, for messages.
    pub fn stage_names(&self) -> String {
        self.with_coupled().map(|stage| stage.label.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// All stages, each followed by those coupled to it.
    pub fn with_coupled(&self) -> impl Iterator<Item = &Stage> {
        self.stages.iter().flat_map(|stage| std::iter::once(stage).chain(&stage.coupled))
    }
}

/// A name that is safe in a path: letters, digits, `-`, `_`.
fn slug(name: &str) -> String {
    let kept: String = name.chars().map(|c| if c.is_alphanumeric() || c == '_' { c } else { '-' }).take(60).collect();
    let kept = kept.trim_matches('-');
    if kept.is_empty() { "world".to_owned() } else { kept.to_owned() }
}

/// Holds a recipe's tree against schemas.
pub(super) struct Reader<'a> {
    /// The recipe's name in messages.
    pub file: &'a str,
    /// The folder that its paths are relative to.
    pub folder: &'a Path,
}

impl Reader<'_> {
    pub fn error(&self, place: &Place, problem: Problem) -> RecipeError {
        RecipeError::new(self.file, place, problem)
    }

    fn checker(&self, within: String, lister: String) -> Checker<'_> {
        Checker { file: self.file, folder: self.folder, within, lister }
    }

    /// The keys outside all tables.
    fn top(&self, root: &Table) -> Result<(), RecipeError> {
        let text = serde_json::json!({ "type": "string" });
        let any = serde_json::json!({});
        let schema = serde_json::json!({
            "properties": { "name": text, "description": text, "world": any, "scene": any, "stage": any },
            "additionalProperties": false,
        });
        let checker = self.checker("the recipe".into(), "upthrust params".into());
        for entry in &root.entries {
            // Tables have their own check; here only the key counts.
            let inner = matches!(entry.key.as_str(), "world" | "scene" | "stage");
            let kept = if inner {
                Node { place: entry.place.clone(), value: Value::Switch(true) }
            } else {
                entry.node.clone()
            };
            let one = Table { entries: vec![tree::Entry { node: kept, ..entry.clone() }] };
            checker.table(&one, &entry.place, &schema)?;
        }
        Ok(())
    }

    /// A table of the recipe, checked.
    pub fn section<T: serde::de::DeserializeOwned>(
        &self,
        node: &Node,
        name: &str,
        schema: &Json,
    ) -> Result<T, RecipeError> {
        let Value::Table(table) = &node.value else {
            let (within, found) = ("the recipe".to_owned(), node.value.describe());
            let wanted = format!("a table, written [{name}]");
            return Err(self.error(&node.place, Problem::WrongType { key: name.to_owned(), within, wanted, found }));
        };
        let checked = self
            .checker(format!("[{name}]"), format!("upthrust params {}", name.split('.').next().unwrap_or(name)))
            .table(table, &node.place, schema)?;
        serde_json::from_value(checked).map_err(|e| self.error(&node.place, Problem::Unfit(e.to_string())))
    }

    /// A map's north-south side follows from its size; a sliver has no room for any stage.
    fn sides(&self, world: &WorldParams, root: &Table) -> Result<(), RecipeError> {
        let [w, h] = world.size.cells();
        if w.max(h) <= 64 * w.min(h) {
            return Ok(());
        }
        let place = match root.get("world").map(|node| &node.value) {
            Some(Value::Table(table)) => table.get("size").map_or(Place::File, |node| node.place.clone()),
            _ => Place::File,
        };
        let what = format!("'size' in [world] is {w} x {h}: one side may be at most 64 times the other");
        Err(self.error(&place, Problem::Unfit(what)))
    }

    fn stages(&self, root: &Table) -> Result<Vec<Stage>, RecipeError> {
        let keys = stage_keys(root);
        let refuse = |place: &Place, what: &str| self.error(place, Problem::Unfit(what.into()));
        let Some(node) = root.get("stage") else {
            return Err(refuse(&Place::File, "a recipe needs at least one [[stage]]"));
        };
        let Value::List(items) = &node.value else {
            return Err(refuse(&node.place, "stages are a list of tables: write [[stage]], not [stage]"));
        };
        let mut made = Vec::with_capacity(items.len());
        let mut ids: BTreeMap<String, String> = BTreeMap::new();
        let mut layers: Vec<Layer> = Vec::new();
        for (item, key) in items.iter().zip(&keys) {
            let Value::Table(table) = &item.value else {
                return Err(refuse(&item.place, "stages are a list of tables: write [[stage]]"));
            };
            let stage = self.stage(table, &item.place, key)?;
            self.take_id(table, key, &mut ids)?;
            self.build_once(&stage, table, &item.place, &mut layers)?;
            made.push(stage);
        }
        if made.iter().all(|stage| !stage.enabled) {
            return Err(refuse(&node.place, "no stage is enabled, so there is nothing to grow"));
        }
        Ok(made)
    }

    /// Puts the stages that ask for it behind those they step in turn with. Ones that are switched off stay where they are.
    fn couple(&self, root: &Table, stages: Vec<Stage>) -> Result<Vec<Stage>, RecipeError> {
        let places = stage_places(root);
        let mut made: Vec<Stage> = Vec::with_capacity(stages.len());
        for (index, stage) in stages.into_iter().enumerate() {
            if !stage.enabled || !stage.follows() {
                made.push(stage);
                continue;
            }
            match made.iter_mut().rev().find(|before| before.enabled) {
                Some(leader) if leader.kind.leads => leader.coupled.push(stage),
                _ => {
                    let what = format!(
                        "stage '{}': coupled = true steps in turn with plates, so the stage before it must be 'plates'",
                        stage.label
                    );
                    let place = places.get(index).cloned().unwrap_or(Place::File);
                    return Err(self.error(&place, Problem::Unfit(what)));
                }
            }
        }
        Ok(made)
    }

    /// Asks every stage that runs whether it goes together with the map as it is by then, and what should be known of it.
    fn fit(&self, root: &Table, stages: &[Stage], mut grid: Grid) -> Result<Vec<String>, RecipeError> {
        let mut notes = Vec::new();
        let places: BTreeMap<String, Place> =
            stage_keys(root).iter().map(StageKey::key).zip(stage_places(root)).collect();
        let all = stages.iter().flat_map(|stage| std::iter::once(stage).chain(&stage.coupled));
        for stage in all.filter(|stage| stage.enabled) {
            let place = places.get(&stage.key).unwrap_or(&Place::File);
            let unfit = |e: ProcessError| self.error(place, Problem::Unfit(format!("stage '{}': {e}", stage.label)));
            let process = stage.build().map_err(unfit)?;
            process.fit(&grid).map_err(unfit)?;
            notes.extend(process.remarks(&grid).iter().map(|remark| format!("stage '{}': {remark}", stage.label)));
            grid = process.grid_after(&grid);
        }
        Ok(notes)
    }

    fn kind(&self, table: &Table, place: &Place) -> Result<&'static StageKind, RecipeError> {
        let Some(node) = table.get("kind") else {
            return Err(self.error(place, Problem::MissingKey { key: "kind".into(), within: "this [[stage]]".into() }));
        };
        let kinds = || stages::all().iter().map(|stage| stage.kind);
        let Value::Text(kind) = &node.value else {
            let (within, found) = ("this [[stage]]".to_owned(), node.value.describe());
            let wanted = "the name of a stage in quotes".to_owned();
            return Err(self.error(&node.place, Problem::WrongType { key: "kind".into(), within, wanted, found }));
        };
        stages::find(kind).ok_or_else(|| {
            let hint = match nearest(kind, kinds()) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("there are: {}", kinds().collect::<Vec<_>>().join(", ")),
            };
            self.error(&node.place, Problem::UnknownKind { kind: kind.clone(), hint })
        })
    }

    fn stage(&self, table: &Table, place: &Place, key: &StageKey) -> Result<Stage, RecipeError> {
        let kind = self.kind(table, place)?;
        let within = format!("stage '{}'", key.label());
        let checker = self.checker(within, format!("upthrust params {}", kind.kind));
        let checked = checker.table(table, place, &with_common(kind))?;
        let (common, params) = split(checked);
        let unfit = |e: serde_json::Error| self.error(place, Problem::Unfit(e.to_string()));
        let common: CommonKeys = serde_json::from_value(common).map_err(unfit)?;
        let mask = common.mask.as_deref().map(|text| self.mask(text, table)).transpose()?;
        Ok(Stage {
            kind,
            key: key.key(),
            label: key.label(),
            enabled: common.enabled,
            placement: Placement { blend: common.blend, mask },
            steps: common.steps,
            film: self.film(&common, table)?,
            params,
            coupled: Vec::new(),
        })
    }

    fn film(&self, common: &CommonKeys, table: &Table) -> Result<Option<FilmTime>, RecipeError> {
        let times = [
            ("film_seconds", common.film_seconds.map(FilmTime::Seconds)),
            ("film_yr_per_s", common.film_yr_per_s.map(FilmTime::YearsPerSecond)),
            ("film_s_per_s", common.film_s_per_s.map(|s| FilmTime::YearsPerSecond(s / SECONDS_PER_YEAR))),
        ];
        let mut given = times.into_iter().filter_map(|(key, time)| time.map(|time| (key, time)));
        match (given.next(), given.next()) {
            (Some((first, _)), Some((second, _))) => {
                let place = table.get(second).map_or(Place::File, |node| node.place.clone());
                let what = format!("'{second}' and '{first}' both say how long the stage takes in a film; keep one");
                Err(self.error(&place, Problem::Unfit(what)))
            }
            (time, _) => Ok(time.map(|(_, time)| time)),
        }
    }

    fn mask(&self, text: &str, table: &Table) -> Result<Mask, RecipeError> {
        let place = table.get("mask").map_or(Place::File, |node| node.place.clone());
        let folder = if matches!(place, Place::Flag(_)) { Path::new("") } else { self.folder };
        let mask = Mask::parse(text, folder).map_err(|e| self.error(&place, Problem::Unfit(e.to_string())))?;
        match &mask {
            Mask::Image(path) if !path.is_file() => {
                let what = format!("mask: there is no file {} (paths are relative to the recipe)", quoted(text));
                Err(self.error(&place, Problem::Unfit(what)))
            }
            Mask::Image(path) => match open_picture(path) {
                Ok(_) => Ok(mask),
                Err(e) => Err(self.error(&place, Problem::Unfit(format!("mask: {e}")))),
            },
            _ => Ok(mask),
        }
    }

    fn take_id(&self, table: &Table, key: &StageKey, ids: &mut BTreeMap<String, String>) -> Result<(), RecipeError> {
        let (Some(id), Some(node)) = (&key.id, table.get("id")) else { return Ok(()) };
        let plain = !id.is_empty() && id.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
        if !plain || matches!(id.as_str(), "world" | "scene") {
            let what =
                format!("stage id {} must be of letters, digits, '-' and '_', and not 'world' or 'scene'", quoted(id));
            return Err(self.error(&node.place, Problem::Unfit(what)));
        }
        let here = match &node.place {
            Place::Line(line) => format!("line {line}"),
            _ => "the top".to_owned(),
        };
        match ids.insert(id.clone(), here) {
            Some(first) => Err(self.error(&node.place, Problem::DuplicateId { id: id.clone(), first })),
            None => Ok(()),
        }
    }

    /// Builds the process once to hear whether it accepts its parameters, and follows which layers there will be.
    fn build_once(
        &self,
        stage: &Stage,
        table: &Table,
        place: &Place,
        layers: &mut Vec<Layer>,
    ) -> Result<(), RecipeError> {
        let unfit = |e: ProcessError| self.error(place, Problem::Unfit(format!("stage '{}': {e}", stage.label)));
        let process = stage.build().map_err(unfit)?;
        if !stage.enabled {
            return Ok(());
        }
        let absent = |layer: Layer| !layer.derived() && !layers.contains(&layer);
        if let Some(&layer) = process.reads().iter().find(|layer| absent(**layer)) {
            let problem = Problem::AbsentLayer { stage: stage.label.clone(), layer: layer.name() };
            return Err(self.error(place, problem));
        }
        if let Some(Mask::Layer(layer) | Mask::Above(layer, _) | Mask::Below(layer, _)) = stage.placement.mask
            && absent(layer)
        {
            let place = table.get("mask").map_or(place, |node| &node.place);
            let what = format!(
                "mask of stage '{}' needs the layer '{}', which no earlier stage makes",
                stage.label,
                layer.name()
            );
            return Err(self.error(place, Problem::Unfit(what)));
        }
        layers.extend(process.writes());
        Ok(())
    }
}

/// A stage's own schema and the keys that every stage knows.
pub(crate) fn with_common(kind: &StageKind) -> Json {
    let mut merged = kind.schema.clone();
    let mut common = schema::of::<CommonKeys>();
    if !kind.blends
        && let Some(properties) = common["properties"].as_object_mut()
    {
        properties.remove("blend");
    }
    if !merged["properties"].is_object() {
        merged["properties"] = Json::Object(Default::default());
    }
    if let (Some(into), Some(from)) = (merged["properties"].as_object_mut(), common["properties"].as_object()) {
        for (key, value) in from {
            into.insert(key.clone(), value.clone());
        }
    }
    merged
}

/// The keys of every stage; no stage has a parameter of such a name.
pub(crate) const COMMON: [&str; 9] =
    ["kind", "id", "enabled", "mask", "steps", "film_seconds", "film_yr_per_s", "film_s_per_s", "blend"];

fn split(checked: Json) -> (Json, Json) {
    let Json::Object(all) = checked else { return (Json::Null, Json::Null) };
    let (common, own) = all.into_iter().partition(|(key, _)| COMMON.contains(&key.as_str()));
    (Json::Object(common), Json::Object(own))
}
