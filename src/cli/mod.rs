//! The command line: raw arguments become a validated command, the command is done by the rooms below, and what went
//! wrong becomes one line and an exit code.
//!
//! Exit codes: 0 done, 1 failed while running, 2 the request was wrong, 130 interrupted. This room simulates, draws and
//! writes nothing itself.

mod arguments;
mod command;
mod desktop;
mod export;
mod film;
mod grow;
mod output;
mod progress;
mod reference;
mod scene;
mod world;

use std::{
    path::PathBuf,
    process::ExitCode,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use crate::{job::JobError, recipe::RecipeError, world::World};

use command::Command;
use output::Output;

/// Why a command did not end well.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// The request was wrong.
    #[error("{0}")]
    Request(String),
    /// A job ended early.
    #[error(transparent)]
    Job(#[from] JobError),
    /// The recipe is wrong.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// Something of the system failed.
    #[error("{0}")]
    System(String),
    /// Whoever read our output has read enough.
    #[error("output closed")]
    Closed,
}

impl CliError {
    fn exit_code(&self) -> u8 {
        match self {
            CliError::Request(_) | CliError::Recipe(_) => 2,
            CliError::Job(job) if job.cancelled() => 130,
            CliError::Job(job) if job.refused() => 2,
            CliError::Job(_) | CliError::System(_) => 1,
            CliError::Closed => 0,
        }
    }
}

/// What the desktop application starts with.
pub struct AppStart {
    /// A world to show, with its name.
    pub world: Option<(String, World)>,
    /// Where to save a picture of the window before closing it, if only that is wanted.
    pub screenshot: Option<PathBuf>,
}

/// What opens the desktop application; it says in one line why it cannot. The application knows the command line, not
/// the other way round, so the binary brings the two together.
pub type OpenApp = fn(AppStart) -> Result<(), String>;

/// Runs the command line of this process; `app` opens the desktop application, in builds that have one.
pub fn main(app: Option<OpenApp>) -> ExitCode {
    std::panic::set_hook(Box::new(|info| output::complain(&describe_panic(info))));
    let code = std::panic::catch_unwind(|| match parse_and_run(app) {
        Ok(()) => 0,
        Err(error) => {
            match &error {
                CliError::Closed => {}
                CliError::Job(JobError::Stopped) => output::say(&error.to_string()),
                CliError::Job(job) if job.cancelled() => output::say("stopped; nothing was written"),
                error => output::complain(&error.to_string()),
            }
            error.exit_code()
        }
    });
    ExitCode::from(code.unwrap_or(1))
}

fn parse_and_run(app: Option<OpenApp>) -> Result<(), CliError> {
    let Some(command) = arguments::parse()? else { return Ok(()) };
    let command = match Command::validate(command)? {
        // It ends by its window, and by Ctrl-C at once.
        Command::App(raw) => return desktop::open(raw, app),
        command => command,
    };
    let mut output = Output::stdout();
    let cancel = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&cancel);
    // Where no handler can be set, Ctrl-C still ends the program, only less tidily.
    let _ = ctrlc::set_handler(move || {
        // Who asks twice does not want to wait, for another program either; the last checkpoint stands.
        if asked.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    match command {
        Command::Grow(grow) => grow::run(*grow, &cancel, &mut output),
        Command::Presets(name) => reference::presets(name.as_deref(), &mut output),
        Command::Params(what) => reference::params(&what, &mut output),
        Command::Inspect(inspect) => world::inspect(&inspect, &mut output),
        Command::Export(request) => export::run(&request, &mut output),
        Command::Render(picture) => world::render(&picture, &mut output),
        Command::Film { world, film } => film::replay(&world, &film, &cancel, &mut output),
        Command::App(raw) => desktop::open(raw, app),
    }
}

/// A panic in one line: what, and where in our own files.
fn describe_panic(info: &std::panic::PanicHookInfo) -> String {
    let payload = info.payload();
    let text = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
    let place = match info.location() {
        Some(at) if at.file().starts_with("src") => format!(" ({}:{})", at.file(), at.line()),
        _ => String::new(),
    };
    format!("internal error: {}{place}; please report it with the command you gave", text.unwrap_or("unknown"))
}
