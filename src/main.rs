//! The `upthrust` command.

#[cfg(feature = "app")]
const APP: Option<upthrust::cli::OpenApp> = Some(upthrust::app::open);
#[cfg(not(feature = "app"))]
const APP: Option<upthrust::cli::OpenApp> = None;

fn main() -> std::process::ExitCode {
    upthrust::cli::main(APP)
}
