//! The five families of erosion with any parameters that their schemas allow, on any ground, through the steps that a
//! recipe takes: nothing is ever NaN, the books close, and coasts that are locked and cells that are masked stay.
//!
//! Every parameter of every family is sampled: numbers over their ranges, by their value or their power of ten, words and
//! switches among what there is. Only what a case may cost is bounded, by a shorter run of the same parameters.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use proptest::{
    collection::vec,
    prelude::*,
    test_runner::{TestCaseError, TestCaseResult},
};
use serde_json::{Map, Value};
use upthrust::{
    erosion::{HydraulicCellsParams, PipesParams, RainParticlesParams},
    grid::{Edges, Field, Grid},
    process::Context,
    recipe::{Overrides, Plan, Source, find_stage},
    world::{Layer, Matter, World},
};

/// Passes, iterations or sub-steps over the map that a case may cost.
const PASSES: f64 = 400.0;
/// Steps of single droplets and particles that it may cost.
const MOVES: f64 = 1e6;
/// Most parameters of a family.
const MOST: usize = 40;

/// A choice within a schema: how, and where between its ends.
type Pick = (u8, f64);

/// A number between two ends: one of them, by its value, or by its power of ten.
fn number(low: f64, high: f64, (how, share): Pick) -> f64 {
    // Seven powers of ten below the greatest, where the least is 0.
    let least = if low > 0.0 { low } else { 1e-7 * high };
    let value = match how {
        0 => low,
        1 => high,
        _ if how % 2 == 0 || low < 0.0 => low + share * (high - low),
        _ => least * (high / least).powf(share),
    };
    value.clamp(low, high)
}

/// A value that a schema allows; numbers without a range are places on the map.
fn value(schema: &Value, picks: &mut impl Iterator<Item = Pick>, extent_km: f64) -> Value {
    let pick = picks.next().unwrap_or((2, 0.5));
    let among = |count: usize| ((pick.1 * count as f64) as usize).min(count.saturating_sub(1));
    let words: Vec<&Value> = match (&schema["enum"], &schema["oneOf"]) {
        (Value::Array(words), _) => words.iter().collect(),
        (_, Value::Array(options)) => options.iter().map(|option| &option["const"]).collect(),
        _ => Vec::new(),
    };
    if !words.is_empty() {
        return words[among(words.len())].clone();
    }
    let [low, high] = ["minimum", "maximum"].map(|end| schema[end].as_f64());
    match schema["type"].as_str() {
        Some("boolean") => (pick.1 < 0.5).into(),
        Some("integer") => (number(low.unwrap(), high.unwrap(), pick).round() as i64).into(),
        Some("number") => number(low.unwrap_or(0.0), high.unwrap_or(extent_km), pick).into(),
        Some("array") => {
            let count = among(3);
            (0..count).map(|_| table(&schema["items"], picks, extent_km)).collect::<Vec<_>>().into()
        }
        other => panic!("no value of {other:?} can be sampled"),
    }
}

fn table(schema: &Value, picks: &mut impl Iterator<Item = Pick>, extent_km: f64) -> Value {
    let properties = schema["properties"].as_object().unwrap();
    let sampled = properties.iter().map(|(key, schema)| (key.clone(), value(schema, picks, extent_km)));
    Value::Object(sampled.collect())
}

/// The same parameters, brought to go together where a stage would refuse them out of hand: lengths in cells, and places on
/// the map.
fn together(kind: &str, mut params: Map<String, Value>, grid: &Grid) -> Map<String, Value> {
    let get = |key: &str| params[key].as_f64().unwrap();
    let side = grid.width.min(grid.height) as f64;
    let cell_m = grid.cell_m;
    let mut set: Vec<(&str, Value)> = Vec::new();
    match kind {
        "pipes" => {
            set.push(("deep_m", get("deep_m").max(get("shallow_m")).into()));
            // From 100,000 km to the map.
            for key in ["rain_x_km", "rain_y_km"] {
                set.push((key, (get(key) * 1e-8 * side * cell_m).into()));
            }
            if params["momentum"] == true {
                set.push(("flux", "signed".into()));
            }
            if params["lock"] == "coast" {
                set.push(("sea", true.into()));
            }
        }
        // From 10 km to a cell; less than a twentieth of one is half of it.
        "rain_particles" => {
            let cells = get("spacing_m") * 1e-4;
            set.push(("spacing_m", if cells < 0.05 { 0.0 } else { cells * cell_m }.into()));
        }
        "droplets" => {
            set.push(("path_m", get("path_m").clamp(4.0 * cell_m, 1e5 * cell_m).into()));
            set.push(("radius_m", get("radius_m").min((0.25 * side - 3.0).min(16.0) * cell_m).into()));
        }
        "hydraulic_cells" => {
            set.push(("duration_h", get("duration_h").max(cell_m / (3600.0 * get("flow_m_per_s"))).into()));
        }
        _ => {}
    }
    params.extend(set.into_iter().map(|(key, value)| (key.to_owned(), value)));
    params
}

/// The same parameters for as short a run as a case may cost.
fn bounded(kind: &str, mut params: Map<String, Value>, grid: &Grid) -> Map<String, Value> {
    let get = |key: &str| params[key].as_f64().unwrap();
    let whole = || Value::Object(params.clone());
    let (key, cost, least) = match kind {
        "thermal" => ("duration_yr", get("duration_yr") * get("rate_per_yr") / 0.11, 1e-3),
        "hydraulic_cells" => {
            let params: HydraulicCellsParams = serde_json::from_value(whole()).unwrap();
            ("duration_h", params.iterations(grid), 1e-3)
        }
        "pipes" => {
            let params: PipesParams = serde_json::from_value(whole()).unwrap();
            ("duration_h", params.sub_steps(grid), 0.0)
        }
        "rain_particles" => {
            let params: RainParticlesParams = serde_json::from_value(whole()).unwrap();
            ("duration_min", params.most_sub_steps(grid), 0.01)
        }
        "droplets" => {
            let path = (get("path_m") / grid.cell_m).clamp(1.0, 1e5);
            ("droplets_per_cell", PASSES * get("droplets_per_cell") * grid.cells() as f64 * path / MOVES, 1e-3)
        }
        other => panic!("'{other}' is no family of erosion"),
    };
    let shorter = (get(key) * (PASSES / cost).min(1.0)).max(least);
    params.insert(key.to_owned(), shorter.into());
    if kind == "rain_particles" {
        let most = params["particles"].as_f64().unwrap().min(MOVES / PASSES);
        params.insert("particles".to_owned(), most.into());
    }
    params
}

/// What a stage finds.
#[derive(Clone, Debug)]
struct Start {
    size: [usize; 2],
    edges: &'static str,
    cell_m: f64,
    base_m: f64,
    relief_m: f64,
    /// Flat, rough, a spike, or a pit.
    shape: u8,
    /// Whether there are hardness, sediment, water and rain, and a mask.
    besides: [bool; 5],
    steps: u64,
    seed: u64,
}

fn start() -> impl Strategy<Value = Start> {
    let size = [16usize..28, 16usize..28];
    let edges = prop::sample::select(vec!["open", "closed", "wrap"]);
    let land = (-1.0f64..4.0, prop_oneof![Just(0.0), 0.0f64..1e6], -3.0f64..6.0, 0u8..4);
    (size, edges, land, any::<[bool; 5]>(), 1u64..4, any::<u64>()).prop_map(
        |(size, edges, (cell_log, base_m, relief_log, shape), besides, steps, seed)| {
            let [cell_m, relief_m] = [cell_log, relief_log].map(|log| 10f64.powf(log));
            Start { size, edges, cell_m, base_m, relief_m, shape, besides, steps, seed }
        },
    )
}

impl Start {
    fn rim(&self) -> Edges {
        match self.edges {
            "open" => Edges::Open,
            "closed" => Edges::Closed,
            _ => Edges::Wrap,
        }
    }

    /// Numbers from 0 to 1 by cell.
    fn noise(&self, grid: &Grid, layer: u64) -> Field<f32> {
        Field::from_fn(*grid, |x, y| {
            let key = (x as u64 + 7919 * y as u64).wrapping_add(self.seed).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mixed = (key ^ (key >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9 + 2 * layer);
            (mixed >> 40) as f32 / (1u64 << 24) as f32
        })
    }

    fn world(&self, plan: &Plan) -> World {
        let grid = plan.world.grid();
        let mut world = World::new(grid, plan.world.sea_level_m);
        let (rough, odd) = (self.noise(&grid, 0), self.seed as usize % grid.cells());
        let shape = |i: usize| match self.shape {
            0 => 0.0,
            1 => f64::from(rough.data[i]),
            2 => f64::from(u8::from(i == odd)),
            _ => f64::from(u8::from(i != odd)),
        };
        let ground = (0..grid.cells()).map(|i| (self.base_m + self.relief_m * shape(i)) as f32).collect();
        world.set_layer(Layer::Bedrock, Field { grid, data: ground });
        let [hardness, sediment, water, rain, _] = self.besides;
        let mut lay = |wanted: bool, layer: Layer, most: f32, number: u64| {
            if wanted {
                world.set_layer(layer, self.noise(&grid, number).map(|v| (most * (1.5 * v - 0.25)).clamp(0.0, most)));
            }
        };
        lay(hardness, Layer::Hardness, 1.0, 1);
        lay(sediment, Layer::Sediment, 3.0, 2);
        lay(water, Layer::Water, 2.0, 3);
        lay(rain, Layer::Rain, 2000.0, 4);
        world
    }

    /// The recipe of a stage on this ground.
    fn text(&self, kind: &str, params: &Map<String, Value>) -> String {
        let [width, height] = self.size;
        let extent_km = 1e-3 * self.cell_m * width as f64;
        // A third of the relief is under the sea.
        let sea_m = (self.base_m + 0.3 * self.relief_m).clamp(-12_000.0, 12_000.0);
        let mask = if self.besides[4] { "mask = \"slope > 5\"\n" } else { "" };
        let set: String = params.iter().map(|(key, value)| format!("{key} = {}\n", toml(value))).collect();
        format!(
            "[world]\nsize = [{width}, {height}]\nextent_km = {extent_km:?}\nedges = '{}'\nsea_level_m = {sea_m:?}\n\
             [[stage]]\nkind = 'fbm'\n[[stage]]\nid = 'own'\nkind = '{kind}'\nsteps = {}\n{mask}{set}",
            self.edges, self.steps
        )
    }
}

fn toml(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Object(table) => {
            let entries: Vec<String> = table.iter().map(|(key, value)| format!("{key} = {}", toml(value))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        // Debug writes a float so that it reads back as one.
        Value::Number(number) if number.is_f64() => format!("{:?}", number.as_f64().unwrap()),
        other => other.to_string(),
    }
}

/// Runs one case to its end; what does not go together must be refused in one line that says where.
fn run(kind: &str, start: &Start, picks: &[Pick]) -> TestCaseResult {
    let schema = &find_stage(kind).unwrap().schema;
    let extent_km = 1e-3 * start.cell_m * start.size[0] as f64;
    let sampled = table(schema, &mut picks.iter().copied(), extent_km);
    let grid = Grid::new(start.size[0], start.size[1], 1e3 * extent_km, start.rim());
    let params = bounded(kind, together(kind, sampled.as_object().unwrap().clone(), &grid), &grid);
    let text = start.text(kind, &params);
    let source = Source { name: "case".into(), file: "case.toml".into(), folder: PathBuf::new(), text: text.clone() };
    let plan = match Plan::new(&source, &Overrides::default()) {
        Ok(plan) => plan,
        Err(refused) => {
            let line = refused.to_string();
            prop_assert!(line.starts_with("case.toml:") && !line.contains('\n'), "{line}\n{text}");
            return Err(TestCaseError::reject("refused"));
        }
    };
    let before = start.world(&plan);
    let mut world = before.clone();
    world.ledger.open("own", Matter::Rock, world.rock_m3());
    let stage = &plan.stages[1];
    let (stay, mut process) = (AtomicBool::new(false), stage.build().unwrap());
    let context = Context::new(start.seed, "own", &stay);
    loop {
        let step = process.step(&mut world, &context);
        prop_assert!(step.is_ok(), "{step:?}\n{text}");
        prop_assert!(world.first_non_finite().is_none(), "{:?}\n{text}", world.first_non_finite());
        if step.unwrap().finished() {
            break;
        }
    }
    world.ledger.close("own", Matter::Rock, world.rock_m3());
    books_close(&world, &before, &text)?;
    stays(kind, &plan, (&before, &world), &text)
}

/// What the books leave open is what single precision rounds: half a step of the greatest height a cell, in four layers.
fn books_close(world: &World, before: &World, text: &str) -> TestCaseResult {
    let area = world.grid.cell_area_m2() * world.grid.cells() as f64;
    let largest = [before, world].map(|world| world.height().range().unwrap());
    let largest = largest.into_iter().fold(1.0f32, |most, (low, high)| most.max(low.abs()).max(high.abs()));
    let rounding_m3 = 2.0 * f64::from(f32::EPSILON * largest) * area;
    for (_, matter, account) in world.ledger.accounts() {
        let moved = account.came_in_m3.abs() + account.left_m3.abs();
        // Water is booked step by step, its depths in single precision: 1e-4 of what ran, as in the unit tests of `pipes`.
        let [share, stock] = match matter {
            Matter::Water => [1e-4, 1e-6 * (account.start_m3 + account.end_m3)],
            _ => [1e-5, rounding_m3],
        };
        let off = account.residual_m3().abs();
        prop_assert!(off <= share * moved + stock, "{matter:?}: {off:e} of {moved:e}, {account:?}\n{text}");
    }
    Ok(())
}

/// Locked coasts and masked cells are as they were.
fn stays(kind: &str, plan: &Plan, (before, after): (&World, &World), text: &str) -> TestCaseResult {
    let stage = &plan.stages[1];
    let [was, is] = [before, after].map(World::height);
    let sea = plan.world.sea_level_m;
    if stage.params["lock"] == "coast" {
        let crossed = was.data.iter().zip(&is.data).filter(|(a, b)| (f64::from(**a) < sea) != (f64::from(**b) < sea));
        prop_assert_eq!(crossed.count(), 0, "{}\n{}", kind, text);
    }
    if let Some(mask) = &stage.placement.mask {
        let mask = mask.evaluate(before).unwrap();
        let masked = (0..mask.data.len()).filter(|&i| mask.data[i] == 0.0);
        let changed = masked.filter(|&i| was.data[i].to_bits() != is.data[i].to_bits());
        prop_assert_eq!(changed.count(), 0, "{}\n{}", kind, text);
    }
    Ok(())
}

macro_rules! families {
    ($($kind:ident)*) => {
        proptest! {
            #![proptest_config(ProptestConfig { cases: 64, max_global_rejects: 256, ..ProptestConfig::default() })]
            $(#[test]
            fn $kind(start in start(), picks in vec((0u8..16, 0.0f64..1.0), MOST)) {
                run(stringify!($kind), &start, &picks)?;
            })*
        }
    };
}

families! { thermal hydraulic_cells pipes rain_particles droplets }
