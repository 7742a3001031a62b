//! The `upthrust` command.

fn main() -> std::process::ExitCode {
    upthrust::cli::main()
}
