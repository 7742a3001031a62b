//! What every parameter is, read off the schemas: tables for the command line and the docs, and one JSON schema of a
//! whole recipe for editors.

use std::fmt::Write as _;

use serde_json::{Value as Json, json};

use super::{
    StageKind, WorldParams,
    plan::with_common,
    schema::{self, choices, plain_number},
    stages,
};
use crate::scene::SceneParams;

/// One parameter, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its key; a key of a table in a list is written `plate[].at_km`.
    pub name: String,
    /// Its unit; empty where it has none.
    pub unit: String,
    /// What is allowed.
    pub range: String,
    /// Its default.
    pub default: String,
    /// What it is, in a sentence.
    pub about: String,
    /// What raising or choosing it does; empty where that means nothing.
    pub effect: String,
    /// Whether it is a number, so that it can be raised.
    pub number: bool,
}

/// The parameters of `[world]`.
pub fn world_parameters() -> Vec<Parameter> {
    let defaults = serde_json::to_value(WorldParams::default()).unwrap_or_default();
    rows(&schema::of::<WorldParams>(), &defaults, "")
}

/// The parameters of `[scene]`.
pub fn scene_parameters() -> Vec<Parameter> {
    let defaults = serde_json::to_value(SceneParams::default()).unwrap_or_default();
    rows(&schema::of::<SceneParams>(), &defaults, "")
}

/// A stage's own parameters.
pub fn parameters(kind: &StageKind) -> Vec<Parameter> {
    rows(&kind.schema, &kind.defaults, "")
}

fn rows(schema: &Json, defaults: &Json, prefix: &str) -> Vec<Parameter> {
    let mut out = Vec::new();
    for (key, property) in schema["properties"].as_object().into_iter().flatten() {
        let name = format!("{prefix}{key}");
        // A default shown is the struct's own; inside a list there is none but the schema's.
        let default = match defaults.get(key) {
            Some(value) => value,
            None => &property["default"],
        };
        out.push(Parameter {
            unit: unit(property),
            range: allowed(property),
            default: show(default),
            about: sentence(property["description"].as_str().unwrap_or_default()),
            effect: property["x-effect"].as_str().unwrap_or_default().to_owned(),
            number: schema::types(property).iter().any(|name| matches!(*name, "number" | "integer")),
            name: name.clone(),
        });
        if property["items"]["properties"].is_object() {
            out.extend(rows(&property["items"], &Json::Null, &format!("{name}[].")));
        } else if property["properties"].is_object() {
            out.extend(rows(property, default, &format!("{name}.")));
        }
    }
    out
}

fn unit(property: &Json) -> String {
    match property["x-unit"].as_str() {
        None | Some("1") => String::new(),
        Some(unit) => unit.to_owned(),
    }
}

/// What is allowed, without the unit, which has its own column.
fn allowed(property: &Json) -> String {
    let words = choices(property);
    if !words.is_empty() {
        return words.join(" | ");
    }
    let mut bare = property.clone();
    strip_units(&mut bare);
    let wanted = schema::wanted(&bare);
    for noun in ["a whole number ", "a number "] {
        if let Some(range) = wanted.strip_prefix(noun) {
            let kind = if noun.contains("whole") { "whole, " } else { "" };
            let range = range.strip_prefix("between ").map_or(range.to_owned(), |r| r.replace(" and ", " to "));
            return format!("{kind}{range}");
        }
    }
    wanted
}

fn strip_units(schema: &mut Json) {
    match schema {
        Json::Object(map) => {
            map.remove("x-unit");
            map.values_mut().for_each(strip_units);
        }
        Json::Array(items) => items.iter_mut().for_each(strip_units),
        _ => {}
    }
}

fn show(value: &Json) -> String {
    match value {
        Json::Null => "-".to_owned(),
        Json::String(text) => text.clone(),
        Json::Number(n) => plain_number(n),
        Json::Array(items) if items.is_empty() => "-".to_owned(),
        Json::Array(items) => format!("[{}]", items.iter().map(show).collect::<Vec<_>>().join(", ")),
        Json::Object(_) => "a table".to_owned(),
        Json::Bool(on) => on.to_string(),
    }
}

/// A doc comment on one line.
fn sentence(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `docs/parameters.md`: every parameter of every stage.
pub fn markdown() -> String {
    let mut out = String::from(
        "# Parameters\n\nEvery key that a recipe may hold. This page is made from the program itself: \
         `upthrust params --markdown > docs/parameters.md`.\n\n\
         A value is set in the recipe, or for one run with `--set STAGE.PARAM=VALUE` (`--set world.extent_km=200`). \
         Numbers may be whole where a fraction is allowed.\n",
    );
    out.push_str("\n## [world]\n\nThe map.\n\n");
    markdown_table(&mut out, &world_parameters());
    out.push_str("\n## [scene]\n\nHow the world is drawn in space: see [Scenes](scene.md).\n\n");
    markdown_table(&mut out, &scene_parameters());
    out.push_str("\n## Every stage\n\nKeys that each `[[stage]]` knows besides its own.\n\n");
    markdown_table(&mut out, &rows(&schema::of::<super::plan::CommonKeys>(), &Json::Null, ""));
    for kind in stages::all() {
        let _ = write!(out, "\n## {}\n\n{}: {}\n\n", kind.kind, kind.title, kind.about);
        markdown_table(&mut out, &parameters(kind));
    }
    out
}

fn markdown_table(out: &mut String, rows: &[Parameter]) {
    if rows.is_empty() {
        out.push_str("It has no parameters of its own.\n");
        return;
    }
    out.push_str("| key | unit | allowed | default | what it is | what a higher value, or a choice, does |\n|---|---|---|---|---|---|\n");
    for row in rows {
        let cells = [&format!("`{}`", row.name), &row.unit, &row.range, &row.default, &row.about, &row.effect];
        let cells: Vec<_> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
}

/// The JSON schema of a whole recipe, for completion in editors.
pub fn json_schema() -> Json {
    let stages: Vec<Json> = stages::all().iter().map(stage_schema).collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Upthrust recipe",
        "type": "object",
        "additionalProperties": false,
        "required": ["stage"],
        "properties": {
            "name": { "type": "string", "description": "Name for people." },
            "description": { "type": "string", "description": "One line about it." },
            "world": schema::of::<WorldParams>(),
            "scene": schema::of::<SceneParams>(),
            "stage": { "type": "array", "minItems": 1, "items": { "oneOf": stages } },
        },
    })
}

fn stage_schema(kind: &StageKind) -> Json {
    let mut schema = with_common(kind);
    schema["title"] = json!(kind.title);
    schema["description"] = json!(kind.about);
    schema["properties"]["kind"] = json!({ "const": kind.kind, "description": kind.about });
    let mut required: Vec<Json> = schema["required"].as_array().cloned().unwrap_or_default();
    required.push(json!("kind"));
    schema["required"] = Json::Array(required);
    schema
}
