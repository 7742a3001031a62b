//! The recipe as a tree of values that remember where they were written: the file's line, or the flag that set them.

use std::fmt::Write as _;

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::error::{Problem, RecipeError};

/// Where a value was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// A line of the recipe file, from 1.
    Line(usize),
    /// The whole file.
    File,
    /// A flag of the command line, as it was typed.
    Flag(String),
}

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub place: Place,
    pub value: Value,
}

/// The values TOML knows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Text(String),
    Whole(i64),
    Number(f64),
    Switch(bool),
    Date(String),
    List(Vec<Node>),
    Table(Table),
}

/// Keys and values in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table {
    pub entries: Vec<Entry>,
}

/// One key of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub key: String,
    pub place: Place,
    pub node: Node,
}

impl Table {
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries.iter_mut().find(|entry| entry.key == key).map(|entry| &mut entry.node)
    }

    /// Sets a key, in its old place if it is there.
    pub fn set(&mut self, key: &str, node: Node) {
        match self.entries.iter_mut().find(|entry| entry.key == key) {
            Some(entry) => {
                entry.place = node.place.clone();
                entry.node = node;
            }
            None => self.entries.push(Entry { key: key.to_owned(), place: node.place.clone(), node }),
        }
    }
}

impl Value {
    /// What the value is, in words.
    pub fn describe(&self) -> String {
        match self {
            Value::Text(text) => format!("the text {}", quoted(text)),
            Value::Whole(n) => format!("the number {n}"),
            Value::Number(n) => format!("the number {n}"),
            Value::Switch(on) => format!("{on}"),
            Value::Date(date) => format!("the date {date}"),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

/// At most this much of a wrong text is repeated in a message.
const QUOTE_CHARS: usize = 40;

/// A text on one line, shortened, in quotes.
pub(crate) fn quoted(text: &str) -> String {
    let mut short: String = text.chars().take(QUOTE_CHARS).flat_map(char::escape_debug).collect();
    if text.chars().count() > QUOTE_CHARS {
        short.push_str("...");
    }
    format!("'{short}'")
}

/// Parses a whole recipe; `file` is the name used in messages.
pub(crate) fn parse(text: &str, file: &str) -> Result<Table, RecipeError> {
    let lines = Lines::of(text);
    let root = DeTable::parse(text).map_err(|error| {
        let place = error.span().map_or(Place::File, |span| lines.place(span.start));
        RecipeError::new(file, &place, Problem::Syntax(one_line(error.message())))
    })?;
    table(root.into_inner(), &|at| lines.place(at))
        .map_err(|(place, what)| RecipeError::new(file, &place.unwrap_or(Place::File), Problem::Syntax(what)))
}

/// Parses the value of a flag: TOML if it is, else a plain word.
pub(crate) fn parse_flag_value(text: &str, flag: &str) -> Node {
    let place = Place::Flag(flag.to_owned());
    let value = DeValue::parse(text.trim()).ok().and_then(|v| value(v.into_inner(), &|_| place.clone()).ok());
    Node { place: place.clone(), value: value.unwrap_or_else(|| Value::Text(text.to_owned())) }
}

/// Where, once a node on the way out has said it, and why a value cannot be read.
type Unread = (Option<Place>, String);

fn table(source: DeTable<'_>, at: &dyn Fn(usize) -> Place) -> Result<Table, Unread> {
    let mut keyed: Vec<_> = source.into_iter().collect();
    keyed.sort_by_key(|(key, _)| key.span().start);
    let mut entries = Vec::with_capacity(keyed.len());
    for (key, item) in keyed {
        let place = at(key.span().start);
        entries.push(Entry { key: key.into_inner().into_owned(), place, node: node(item, at)? });
    }
    Ok(Table { entries })
}

fn node(source: Spanned<DeValue<'_>>, at: &dyn Fn(usize) -> Place) -> Result<Node, Unread> {
    let place = at(source.span().start);
    match value(source.into_inner(), at) {
        Ok(value) => Ok(Node { place, value }),
        Err((inner, what)) => Err((inner.or(Some(place)), what)),
    }
}

fn value(source: DeValue<'_>, at: &dyn Fn(usize) -> Place) -> Result<Value, Unread> {
    let unread = |what: String| (None, what);
    Ok(match source {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(n) => Value::Whole(
            i64::from_str_radix(n.as_str(), n.radix())
                .map_err(|_| unread(format!("the whole number {n} is too large")))?,
        ),
        DeValue::Float(n) => {
            Value::Number(n.as_str().replace('_', "").parse().map_err(|_| unread(format!("{n} is not a number")))?)
        }
        DeValue::Boolean(on) => Value::Switch(on),
        DeValue::Datetime(date) => Value::Date(date.to_string()),
        DeValue::Array(items) => {
            let mut list = Vec::with_capacity(items.len());
            for item in items {
                list.push(node(item, at)?);
            }
            Value::List(list)
        }
        DeValue::Table(inner) => Value::Table(table(inner, at)?),
    })
}

/// Offsets of line starts, so that a place is found without reading the text again.
struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    fn of(text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(i, _)| i + 1);
        Self { starts: std::iter::once(0).chain(breaks).collect() }
    }

    fn place(&self, offset: usize) -> Place {
        Place::Line(self.starts.partition_point(|&start| start <= offset))
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The tree as TOML: what was really run, flags included.
pub(crate) fn write(root: &Table) -> String {
    let mut out = String::new();
    write_table(&mut out, root, "");
    out.trim_start().to_owned()
}

/// Scalars first, then tables, so that every key stays with its own table.
fn write_table(out: &mut String, table: &Table, path: &str) {
    for entry in table.entries.iter().filter(|entry| !is_section(&entry.node.value)) {
        let _ = writeln!(out, "{} = {}", key_text(&entry.key), inline(&entry.node.value));
    }
    for entry in &table.entries {
        let name = if path.is_empty() { key_text(&entry.key) } else { format!("{path}.{}", key_text(&entry.key)) };
        match &entry.node.value {
            Value::Table(inner) => {
                let _ = writeln!(out, "\n[{name}]");
                write_table(out, inner, &name);
            }
            value @ Value::List(items) if is_section(value) => {
                for item in items {
                    let _ = writeln!(out, "\n[[{name}]]");
                    if let Value::Table(inner) = &item.value {
                        write_table(out, inner, &name);
                    }
                }
            }
            _ => {}
        }
    }
}

fn is_section(value: &Value) -> bool {
    match value {
        Value::Table(_) => true,
        Value::List(items) => !items.is_empty() && items.iter().all(|item| matches!(item.value, Value::Table(_))),
        _ => false,
    }
}

fn key_text(key: &str) -> String {
    let bare = !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
    if bare { key.to_owned() } else { toml::Value::String(key.to_owned()).to_string() }
}

fn inline(value: &Value) -> String {
    match value {
        Value::Text(text) => toml::Value::String(text.clone()).to_string(),
        Value::Whole(n) => n.to_string(),
        Value::Number(n) => toml::Value::Float(*n).to_string(),
        Value::Switch(on) => on.to_string(),
        Value::Date(date) => date.clone(),
        Value::List(items) => {
            let items: Vec<_> = items.iter().map(|item| inline(&item.value)).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(table) => {
            let pairs: Vec<_> =
                table.entries.iter().map(|e| format!("{} = {}", key_text(&e.key), inline(&e.node.value))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"x\"\n[world]\nseed = 4 # mine\nextent_km = 1e3\n\n[[stage]]\nkind = 'a'\npoints_km = [[1, 2.5],\n [3, 4]]\n[[stage.plate]]\nat_km = [1, 2]\n";

    #[test]
    fn places_are_lines() {
        let root = parse(TEXT, "t.toml").unwrap();
        let world = root.get("world").unwrap();
        let Value::Table(world) = &world.value else { panic!() };
        assert_eq!(world.get("seed").unwrap().place, Place::Line(3));
        let Value::List(stages) = &root.get("stage").unwrap().value else { panic!() };
        let Value::Table(stage) = &stages[0].value else { panic!() };
        let Value::List(points) = &stage.get("points_km").unwrap().value else { panic!() };
        assert_eq!(points[1].place, Place::Line(9));
    }

    #[test]
    fn what_is_written_reads_back() {
        let root = parse(TEXT, "t.toml").unwrap();
        let again = parse(&write(&root), "t.toml").unwrap();
        assert_eq!(write(&root), write(&again));
        assert!(write(&root).contains("[[stage.plate]]"));
    }

    #[test]
    fn syntax_errors_are_one_line_with_a_place() {
        let error = parse("a = 1\nb = \n", "t.toml").unwrap_err().to_string();
        assert!(error.starts_with("t.toml:2: ") && !error.contains('\n'), "{error}");
        let error = parse("a = 1\nb = 99999999999999999999", "t.toml").unwrap_err().to_string();
        assert_eq!(error, "t.toml:2: the whole number 99999999999999999999 is too large");
    }

    #[test]
    fn flag_values_are_toml_or_words() {
        let read = |text: &str| parse_flag_value(text, "--set a.b").value;
        assert_eq!(read("3"), Value::Whole(3));
        assert_eq!(read(" 2.5"), Value::Number(2.5));
        assert_eq!(read("true"), Value::Switch(true));
        assert_eq!(read("slope > 3"), Value::Text("slope > 3".into()));
        assert_eq!(read("\"7\""), Value::Text("7".into()));
        assert!(matches!(read("[1, 2]"), Value::List(_)));
    }
}
