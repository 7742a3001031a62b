//! `upthrust inspect` and `upthrust render`: worlds that are there already.

use crate::job::{self, Picture};

use super::{CliError, arguments::RawInspect, command::wrong, output::Output};

/// Prints the numbers of one world or of several.
pub(crate) fn inspect(inspect: &RawInspect, output: &mut Output) -> Result<(), CliError> {
    if let Some(recording) = inspect.worlds.iter().find(|path| job::is_recording(path)) {
        if inspect.worlds.len() > 1 || inspect.report.is_some() {
            let shown = recording.display();
            return wrong(format!("{shown}: a recording of particles is inspected alone, without --report"));
        }
        let inspected = job::inspect_recording(recording)?;
        return output.line(&if inspect.json { inspected.json() } else { inspected.text() });
    }
    let report = inspect.report.as_deref();
    let measured = job::Measured::of(&inspect.worlds, report)?;
    report.map_or(Ok(()), |file| measured.write(file))?;
    output.line(&if inspect.json { measured.json() } else { measured.text() })
}

/// Draws a world.
pub(crate) fn render(picture: &Picture, output: &mut Output) -> Result<(), CliError> {
    let path = job::render(picture)?;
    output.line(&path.display().to_string())
}
