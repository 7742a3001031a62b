//! Holds a tree against a JSON schema, before serde sees it, so that an error knows its file, line and key.
//!
//! Understands what schemars makes of our parameter structs: objects, lists, numbers with ranges, choices, optional
//! values, alternatives. What passes comes out as JSON with every number in the form its schema asks for.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value as Json, json};

use super::{
    error::{Problem, RecipeError},
    near::nearest,
    tree::{Node, Place, Table, Value},
};

/// The schema of a type, without references.
pub(crate) fn of<T: schemars::JsonSchema>() -> Json {
    let settings = schemars::generate::SchemaSettings::draft2020_12().with(|s| {
        s.inline_subschemas = true;
        s.meta_schema = None;
    });
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// Where messages place what they find.
#[derive(Clone, Debug)]
pub(crate) struct Checker<'a> {
    /// The recipe's name in messages.
    pub file: &'a str,
    /// The folder that paths in the recipe are relative to.
    pub folder: &'a Path,
    /// `stage 'thermal'`, `[world]`.
    pub within: String,
    /// The command that lists what there is.
    pub lister: String,
}

impl Checker<'_> {
    fn error(&self, place: &Place, problem: Problem) -> RecipeError {
        RecipeError::new(self.file, place, problem)
    }

    fn inside(&self, key: &str) -> Self {
        Self { within: format!("'{key}' of {}", self.within), ..self.clone() }
    }

    /// A table against an object schema.
    pub fn table(&self, table: &Table, place: &Place, schema: &Json) -> Result<Json, RecipeError> {
        let none = Map::new();
        let properties = schema["properties"].as_object().unwrap_or(&none);
        let closed = schema["additionalProperties"] == json!(false);
        let mut out = Map::new();
        for entry in &table.entries {
            let value = match properties.get(&entry.key) {
                Some(property) => self.value(&entry.key, &entry.node, property)?,
                None if closed => return Err(self.unknown(&entry.key, &entry.place, properties)),
                None => self.value(&entry.key, &entry.node, &schema["additionalProperties"])?,
            };
            out.insert(entry.key.clone(), value);
        }
        for key in schema["required"].as_array().into_iter().flatten().filter_map(Json::as_str) {
            if !out.contains_key(key) {
                let problem = Problem::MissingKey { key: key.to_owned(), within: self.within.clone() };
                return Err(self.error(place, problem));
            }
        }
        Ok(Json::Object(out))
    }

    fn unknown(&self, key: &str, place: &Place, known: &Map<String, Json>) -> RecipeError {
        let hint = match nearest(key, known.keys().map(String::as_str)) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!("`{}` lists what there is", self.lister),
        };
        self.error(place, Problem::UnknownKey { key: key.to_owned(), within: self.within.clone(), hint })
    }

    /// A value against the schema of its key.
    pub fn value(&self, key: &str, node: &Node, schema: &Json) -> Result<Json, RecipeError> {
        let options = alternatives(schema);
        if let [only] = options.as_slice() {
            return self.single(key, node, only);
        }
        // The alternative of the value's own type has the most to say about what is wrong.
        let mut told = None;
        for option in &options {
            match self.single(key, node, option) {
                Ok(value) => return Ok(value),
                Err(error) => {
                    if told.is_none() && !matches!(*error.problem, Problem::WrongType { .. }) {
                        told = Some(error);
                    }
                }
            }
        }
        Err(match told {
            Some(error) if options.iter().all(|o| o["type"] == "object") => error,
            _ => self.wrong(key, node, schema),
        })
    }

    fn wrong(&self, key: &str, node: &Node, schema: &Json) -> RecipeError {
        self.error(
            &node.place,
            Problem::WrongType {
                key: key.to_owned(),
                within: self.within.clone(),
                wanted: wanted(schema),
                found: node.value.describe(),
            },
        )
    }

    fn outside(&self, key: &str, node: &Node, schema: &Json, found: String) -> RecipeError {
        let (key, within, wanted) = (key.to_owned(), self.within.clone(), wanted(schema));
        self.error(&node.place, Problem::OutOfRange { key, within, wanted, found })
    }

    fn single(&self, key: &str, node: &Node, schema: &Json) -> Result<Json, RecipeError> {
        let types = types(schema);
        let allows = |name: &str| types.is_empty() || types.contains(&name);
        match &node.value {
            Value::Whole(n) if allows("integer") => {
                self.in_range(key, node, schema, *n as f64, n.to_string())?;
                Ok(json!(n))
            }
            Value::Whole(n) if allows("number") => {
                self.in_range(key, node, schema, *n as f64, n.to_string())?;
                Ok(json!(*n as f64))
            }
            Value::Number(n) if allows("number") => {
                if !n.is_finite() {
                    return Err(self.outside(key, node, schema, n.to_string()));
                }
                self.in_range(key, node, schema, *n, n.to_string())?;
                Ok(json!(n))
            }
            Value::Switch(on) if allows("boolean") => Ok(json!(on)),
            Value::Text(text) if allows("string") => self.text(key, node, schema, text),
            Value::Date(date) if types.is_empty() => Ok(json!(date)),
            Value::List(items) if allows("array") => self.list(key, node, schema, items),
            Value::Table(table) if allows("object") => self.inside(key).table(table, &node.place, schema),
            _ => Err(self.wrong(key, node, schema)),
        }
    }

    fn in_range(&self, key: &str, node: &Node, schema: &Json, n: f64, found: String) -> Result<(), RecipeError> {
        let bound = |name: &str| schema[name].as_f64();
        let fits = bound("minimum").is_none_or(|b| n >= b)
            && bound("maximum").is_none_or(|b| n <= b)
            && bound("exclusiveMinimum").is_none_or(|b| n > b)
            && bound("exclusiveMaximum").is_none_or(|b| n < b);
        if fits { Ok(()) } else { Err(self.outside(key, node, schema, found)) }
    }

    fn text(&self, key: &str, node: &Node, schema: &Json, text: &str) -> Result<Json, RecipeError> {
        let choices = choices(schema);
        if !choices.is_empty() && !choices.contains(&text) {
            return Err(self.outside(key, node, schema, super::tree::quoted(text)));
        }
        if schema["x-colour"] == json!(true) && !is_colour(text) {
            return Err(self.outside(key, node, schema, super::tree::quoted(text)));
        }
        // A sample that comes with the program needs no file; who reads it knows which there are.
        if schema["x-path"] != json!(true) || text.starts_with("sample:") {
            return Ok(json!(text));
        }
        // A path typed in a shell is relative to where it was typed.
        let folder = if matches!(node.place, Place::Flag(_)) { Path::new("") } else { self.folder };
        let path = folder.join(text);
        let found = std::path::absolute(&path).ok().filter(|path| path.is_file());
        let problem = || {
            let shown = super::tree::quoted(text);
            Problem::Unfit(format!(
                "'{key}' in {}: there is no file {shown} (paths are relative to the recipe)",
                self.within
            ))
        };
        let found: PathBuf = found.ok_or_else(|| self.error(&node.place, problem()))?;
        match found.to_str() {
            Some(path) => Ok(json!(path)),
            None => Err(self.error(&node.place, Problem::Unfit(format!("'{key}': the path is not valid UTF-8")))),
        }
    }

    fn list(&self, key: &str, node: &Node, schema: &Json, items: &[Node]) -> Result<Json, RecipeError> {
        let count = items.len() as u64;
        let short = schema["minItems"].as_u64().is_some_and(|least| count < least);
        let long = schema["maxItems"].as_u64().is_some_and(|most| count > most);
        if short || long {
            return Err(self.outside(key, node, schema, node.value.describe()));
        }
        let colours = schema["x-colour"] == json!(true);
        let of = |i: usize| match &schema["prefixItems"][i] {
            Json::Null if colours => json!({ "type": "string", "x-colour": true }),
            Json::Null => schema["items"].clone(),
            own => own.clone(),
        };
        let name = |i: usize| format!("{key}[{}]", i + 1);
        let values: Result<Vec<_>, _> =
            items.iter().enumerate().map(|(i, item)| self.value(&name(i), item, &of(i))).collect();
        let values = values?;
        let number = |i: usize| values.get(i).and_then(Json::as_f64);
        if schema["x-rising"] == json!(true) && number(0) >= number(1) {
            let shown = |i: usize| values[i].as_number().map(plain_number).unwrap_or_default();
            return Err(self.outside(key, node, schema, format!("[{}, {}]", shown(0), shown(1))));
        }
        Ok(Json::Array(values))
    }
}

/// Whether a text is a colour, "#rrggbb".
fn is_colour(text: &str) -> bool {
    text.strip_prefix('#').is_some_and(|code| code.len() == 6 && code.bytes().all(|b| b.is_ascii_hexdigit()))
}

/// The alternatives of a schema without `null`; choices between words stay one.
fn alternatives(schema: &Json) -> Vec<Json> {
    let Some(options) = schema["anyOf"].as_array().or(schema["oneOf"].as_array()) else {
        return vec![schema.clone()];
    };
    if !choices(schema).is_empty() {
        return vec![schema.clone()];
    }
    let present = options.iter().filter(|option| option["type"] != "null");
    // What stands beside the alternatives (unit, path mark) holds for each of them.
    present
        .map(|option| {
            let mut merged = option.clone();
            if let (Some(into), Some(from)) = (merged.as_object_mut(), schema.as_object()) {
                for (key, value) in from.iter().filter(|(key, _)| key.starts_with("x-")) {
                    into.entry(key.clone()).or_insert(value.clone());
                }
            }
            merged
        })
        .collect()
}

/// The types a schema allows, without `null`.
pub(crate) fn types(schema: &Json) -> Vec<&str> {
    match &schema["type"] {
        Json::String(one) => vec![one],
        Json::Array(many) => many.iter().filter_map(Json::as_str).filter(|name| *name != "null").collect(),
        _ if !choices(schema).is_empty() => vec!["string"],
        _ => Vec::new(),
    }
}

/// The words a schema offers, if it offers only words.
pub(crate) fn choices(schema: &Json) -> Vec<&str> {
    if let Some(word) = schema["const"].as_str() {
        return vec![word];
    }
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().filter_map(Json::as_str).collect();
    }
    let Some(options) = schema["anyOf"].as_array().or(schema["oneOf"].as_array()) else { return Vec::new() };
    let mut all = Vec::new();
    for option in options.iter().filter(|option| option["type"] != "null") {
        let words = choices(option);
        if words.is_empty() {
            return Vec::new();
        }
        all.extend(words);
    }
    all
}

/// What a schema asks for, in words.
pub(crate) fn wanted(schema: &Json) -> String {
    if let Some(own) = schema["x-wanted"].as_str() {
        return own.to_owned();
    }
    let words = choices(schema);
    if let [only] = words.as_slice() {
        return format!("'{only}'");
    }
    if !words.is_empty() {
        return format!("one of {}", words.join(", "));
    }
    let options = alternatives(schema);
    if options.len() > 1 {
        return options.iter().map(wanted).collect::<Vec<_>>().join(", or ");
    }
    let schema = &options[0];
    match types(schema).first().copied() {
        Some("integer") => join("a whole number", &range(schema)),
        Some("number") => join("a number", &range(schema)),
        Some("boolean") => "true or false".to_owned(),
        Some("string") if schema["x-path"] == json!(true) => "the path of a file".to_owned(),
        Some("string") if schema["x-colour"] == json!(true) => "a colour such as '#3fa7a5'".to_owned(),
        Some("string") => "a text in quotes".to_owned(),
        Some("array") => wanted_list(schema),
        Some("object") => "a table".to_owned(),
        _ => "a value".to_owned(),
    }
}

fn wanted_list(schema: &Json) -> String {
    let items = &schema["items"];
    if schema["x-colour"] == json!(true) {
        return format!("a list of {} colours such as '#3fa7a5'", schema["minItems"]);
    }
    if schema["x-rising"] == json!(true) {
        return format!("two numbers, the first below the second, each {}", range(items));
    }
    let item = match wanted(items).as_str() {
        "a value" => String::new(),
        "a number" => " numbers".to_owned(),
        item => format!(", each {item}"),
    };
    match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(a), Some(b)) if a == b => format!("a list of {a}{item}"),
        (Some(a), Some(b)) => format!("a list of {a} to {b}{item}"),
        (Some(a), None) => format!("a list of at least {a}{item}"),
        (None, Some(b)) => format!("a list of at most {b}{item}"),
        (None, None) if item == " numbers" => "a list of numbers".to_owned(),
        (None, None) => format!("a list{item}"),
    }
}

fn join(noun: &str, range: &str) -> String {
    if range.is_empty() { noun.to_owned() } else { format!("{noun} {range}") }
}

/// The range a schema allows, in words with the unit; empty if it allows all.
pub(crate) fn range(schema: &Json) -> String {
    let bound = |name: &str| schema[name].as_number().map(plain_number);
    let unit = match schema["x-unit"].as_str() {
        Some("1") | None => String::new(),
        Some(unit) => format!(" {unit}"),
    };
    let low = bound("minimum").map(|b| (b, "at least"));
    let low = low.or(bound("exclusiveMinimum").map(|b| (b, "above")));
    let high = bound("maximum").map(|b| (b, "at most"));
    let high = high.or(bound("exclusiveMaximum").map(|b| (b, "below")));
    match (low, high) {
        (Some((low, "at least")), Some((high, "at most"))) => format!("between {low} and {high}{unit}"),
        (Some((low, how)), Some((high, until))) => format!("{how} {low} and {until} {high}{unit}"),
        (Some((bound, how)), None) | (None, Some((bound, how))) => format!("{how} {bound}{unit}"),
        (None, None) => String::new(),
    }
}

/// A number as people write it: no `.0`, no exponent where a few digits do.
pub(crate) fn plain_number(n: &serde_json::Number) -> String {
    if let Some(n) = n.as_i64() {
        return n.to_string();
    }
    let n = n.as_f64().unwrap_or(f64::NAN);
    if n != 0.0 && (n.abs() >= 1e9 || n.abs() < 1e-4) { format!("{n:e}") } else { format!("{n}") }
}
