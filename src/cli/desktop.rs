//! `upthrust app`: the world is opened here, so that a wrong path is a line on the terminal and not an empty window.

use crate::job;

use super::{AppStart, CliError, OpenApp, arguments::RawApp};

/// Opens the window, in builds that have one.
pub(crate) fn open(raw: RawApp, app: Option<OpenApp>) -> Result<(), CliError> {
    let Some(app) = app else {
        let what = "this build lacks the desktop application; build it with --features app";
        return Err(CliError::Request(what.into()));
    };
    let world = raw.world.map(|path| job::open_world(&path)).transpose()?;
    let world = world.map(|(world, provenance)| (provenance.name, world));
    app(AppStart { world, screenshot: raw.screenshot }).map_err(CliError::System)
}
