//! Standard output that may close early, and lines on standard error.

use std::io::{self, Write};

use super::CliError;

/// Where results go.
pub(crate) struct Output {
    sink: Box<dyn Write>,
}

impl Output {
    pub fn stdout() -> Self {
        Self { sink: Box::new(io::stdout()) }
    }

    /// Writes a line; a reader that has closed its end is no failure of ours.
    pub fn line(&mut self, text: &str) -> Result<(), CliError> {
        let written = writeln!(self.sink, "{text}").and_then(|()| self.sink.flush());
        written.map_err(|error| match error.kind() {
            io::ErrorKind::BrokenPipe => CliError::Closed,
            _ => CliError::System(format!("cannot write the output: {error}")),
        })
    }
}

/// A line on standard error; if even that is closed there is nobody to tell.
pub(crate) fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// An error on standard error, always one line.
pub(crate) fn complain(text: &str) {
    say(&format!("error: {}", text.split_whitespace().collect::<Vec<_>>().join(" ")));
}
