//! `upthrust inspect` and `upthrust render`: worlds that are there already.

use crate::{
    job::{self, Picture},
    measure,
};

use super::{CliError, arguments::RawInspect, output::Output};

/// Prints a world's numbers.
pub(crate) fn inspect(inspect: &RawInspect, output: &mut Output) -> Result<(), CliError> {
    let (world, _) = job::open_world(&inspect.world)?;
    let measured = measure::inspect(&world);
    let json = || serde_json::to_string_pretty(&measured).unwrap_or_default();
    if let Some(path) = &inspect.report {
        let as_json = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("json"));
        let text = if as_json { json() + "\n" } else { format!("{}\n", measured.to_string().trim_end()) };
        std::fs::write(path, text).map_err(|e| CliError::Request(format!("--report {}: {e}", path.display())))?;
    }
    output.line(if inspect.json { json() } else { measured.to_string() }.trim_end())
}

/// Draws a world.
pub(crate) fn render(picture: &Picture, output: &mut Output) -> Result<(), CliError> {
    let path = job::render(picture)?;
    output.line(&path.display().to_string())
}
