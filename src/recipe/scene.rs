//! `[scene]`: of a recipe, of a file of its own, of a recipe that a world remembers.

use std::path::Path;

use super::{
    Overrides, Source,
    error::{Problem, RecipeError},
    plan::Reader,
    schema,
    tree::{self, Entry, Node, Place, Table, Value},
};
use crate::scene::{CameraParams, SceneParams};

/// The scene that a recipe states, with `scene.PARAM=VALUE` texts laid over it. The rest of the recipe is not looked
/// at, so that its files may be gone. A file without any table of a recipe is the scene itself.
pub fn read_scene(source: &Source, set: &[String]) -> Result<SceneParams, RecipeError> {
    let mut root = tree::parse(&source.text, &source.file)?;
    if !root.entries.is_empty() && !["scene", "stage", "world"].iter().any(|key| root.get(key).is_some()) {
        let node = Node { place: Place::File, value: Value::Table(root) };
        root = Table { entries: vec![Entry { key: "scene".into(), place: Place::File, node }] };
    }
    if let Some(other) = set.iter().find(|text| !text.trim_start().starts_with("scene.")) {
        let place = Place::Flag(format!("--set {}", other.split('=').next().unwrap_or_default().trim()));
        let what = "the world is grown already; of the scene, write scene.PARAM=VALUE, such as scene.sky.exposure=1";
        return Err(RecipeError::new("", &place, Problem::Unfit(what.into())));
    }
    Overrides { set: set.to_vec(), ..Overrides::default() }.apply(&mut root)?;
    of(&Reader { file: &source.file, folder: &source.folder }, &root)
}

/// A camera in a file of its own: the keys of `[scene.camera]`.
pub fn read_camera(file: &Path) -> Result<CameraParams, RecipeError> {
    let source = Source::read(file)?;
    let root = tree::parse(&source.text, &source.file)?;
    let reader = Reader { file: &source.file, folder: &source.folder };
    keys_in_order(&reader, &root)?;
    let node = Node { place: Place::File, value: Value::Table(root) };
    reader.section(&node, "scene.camera", &schema::of::<CameraParams>())
}

/// The scene of a recipe's tree.
pub(super) fn of(reader: &Reader, root: &Table) -> Result<SceneParams, RecipeError> {
    let Some(node) = root.get("scene") else { return Ok(SceneParams::default()) };
    let scene = reader.section(node, "scene", &schema::of::<SceneParams>())?;
    if let Value::Table(table) = &node.value
        && let Some(Node { value: Value::Table(camera), .. }) = table.get("camera")
    {
        keys_in_order(reader, camera)?;
    }
    Ok(scene)
}

/// Refuses keys that go back in time.
fn keys_in_order(reader: &Reader, camera: &Table) -> Result<(), RecipeError> {
    let Some(Node { value: Value::List(keys), .. }) = camera.get("keys") else { return Ok(()) };
    let mut before = None;
    for key in keys {
        let Value::Table(table) = &key.value else { continue };
        let (at, place) = match table.get("at") {
            Some(Node { value: Value::Number(at), place }) => (*at, place),
            Some(Node { value: Value::Whole(at), place }) => (*at as f64, place),
            _ => (0.0, &key.place),
        };
        if before.is_some_and(|before| at <= before) {
            let what = format!("'at' of a key of the camera is {at}, and must lie behind that of the key before it");
            return Err(reader.error(place, Problem::Unfit(what)));
        }
        before = Some(at);
    }
    Ok(())
}
