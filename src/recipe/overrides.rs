//! What flags change in a recipe: laid over the tree before it is checked, so that the same checks hold for both.

use super::{
    error::{Problem, RecipeError},
    tree::{Entry, Node, Place, Table, Value, parse_flag_value},
};

/// Changes asked for on the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// `STAGE.PARAM=VALUE` texts.
    pub set: Vec<String>,
    /// The seed.
    pub seed: Option<u64>,
    /// `N` or `WxH`.
    pub size: Option<String>,
}

impl Overrides {
    /// Whether nothing is changed.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Lays the changes over a recipe's tree, `--set` first.
    pub(crate) fn apply(&self, root: &mut Table) -> Result<(), RecipeError> {
        for text in &self.set {
            set(root, text)?;
        }
        if let Some(seed) = self.seed {
            let place = Place::Flag("--seed".into());
            // A seed that a recipe could not state is refused by the range of the key.
            let value = i64::try_from(seed).map_or(Value::Number(seed as f64), Value::Whole);
            section(root, "world", &place)?.set("seed", Node { place, value });
        }
        if let Some(size) = &self.size {
            let place = Place::Flag("--size".into());
            section(root, "world", &place)?.set("size", parse_size(size, place.clone()));
        }
        Ok(())
    }
}

/// `1024` or `1024x512`; anything else stays text for the check to refuse.
fn parse_size(text: &str, place: Place) -> Node {
    let node = |value| Node { place: place.clone(), value };
    let whole = |text: &str| text.trim().parse::<i64>().ok().map(Value::Whole);
    let value = match text.split_once(['x', 'X']) {
        None => whole(text),
        Some((w, h)) => whole(w).zip(whole(h)).map(|(w, h)| Value::List(vec![node(w), node(h)])),
    };
    node(value.unwrap_or_else(|| Value::Text(text.to_owned())))
}

fn refuse(place: &Place, what: &str) -> RecipeError {
    RecipeError::new("", place, Problem::Unfit(what.to_owned()))
}

fn set(root: &mut Table, text: &str) -> Result<(), RecipeError> {
    const FORM: &str = "write STAGE.PARAM=VALUE, such as fbm.height_m=800 or world.extent_km=200";
    let flag = |what: &str| Place::Flag(format!("--set {what}"));
    let Some((target, value)) = text.split_once('=') else { return Err(refuse(&flag(text), FORM)) };
    let target = target.trim();
    let place = flag(target);
    let Some((owner, path)) = target.split_once('.').filter(|(owner, path)| !owner.is_empty() && !path.is_empty())
    else {
        return Err(refuse(&place, FORM));
    };
    let Place::Flag(label) = &place else { return Ok(()) };
    let node = parse_flag_value(value, label);
    let table =
        if matches!(owner, "world" | "scene") { section(root, owner, &place)? } else { stage(root, owner, &place)? };
    let keys: Vec<&str> = path.split('.').collect();
    put(table, &keys, node, &place)
}

/// Puts a value at a path of keys; tables on the way are made.
fn put(table: &mut Table, keys: &[&str], node: Node, place: &Place) -> Result<(), RecipeError> {
    match keys {
        [] => Ok(()),
        ["kind" | "id"] => Err(refuse(place, "a stage's kind and id are the recipe's own; change them in the file")),
        [key] => {
            table.set(key, node);
            Ok(())
        }
        [key, rest @ ..] => put(section(table, key, place)?, rest, node, place),
    }
}

/// The table at a key, made if it is not there.
fn section<'a>(table: &'a mut Table, key: &str, place: &Place) -> Result<&'a mut Table, RecipeError> {
    if table.get(key).is_none() {
        let node = Node { place: place.clone(), value: Value::Table(Table::default()) };
        // A new [world] stands where a reader looks for it: before the stages.
        let before = table.entries.iter().position(|entry| entry.key == "stage").unwrap_or(table.entries.len());
        table.entries.insert(before, Entry { key: key.to_owned(), place: place.clone(), node });
    }
    match table.get_mut(key).map(|node| &mut node.value) {
        Some(Value::Table(inner)) => Ok(inner),
        _ => Err(refuse(place, &format!("'{key}' is not a table, so nothing in it can be set"))),
    }
}

/// The stage a flag means: by id, by kind#ordinal, or by kind where there is one of it.
fn stage<'a>(root: &'a mut Table, name: &str, place: &Place) -> Result<&'a mut Table, RecipeError> {
    let keys = super::plan::stage_keys(root);
    let matches = |test: &dyn Fn(&super::plan::StageKey) -> bool| -> Vec<usize> {
        keys.iter().enumerate().filter(|(_, key)| test(key)).map(|(i, _)| i).collect()
    };
    let mut found = matches(&|key| key.id.as_deref() == Some(name));
    if found.is_empty() {
        found = matches(&|key| key.numbered() == name || key.kind == name);
    }
    let [index] = found[..] else {
        let known = if keys.is_empty() {
            "no stage".to_owned()
        } else {
            keys.iter().map(super::plan::StageKey::label).collect::<Vec<_>>().join(", ")
        };
        return Err(RecipeError::new("", place, Problem::NoSuchStage { name: name.to_owned(), known }));
    };
    match root.get_mut("stage").map(|node| &mut node.value) {
        Some(Value::List(stages)) => match stages.get_mut(index).map(|node| &mut node.value) {
            Some(Value::Table(table)) => Ok(table),
            _ => Err(refuse(place, "that stage is not a table")),
        },
        _ => Err(refuse(place, "this recipe has no [[stage]]")),
    }
}
